//! The server's vocabulary with its name: it computes the bags of words of keyframes.

use std::path::PathBuf;

use super::error::{Result, ServiceError};
use super::tasks::blocking;
use crate::domain::invalid::FieldError;
use crate::domain::keyframe::NewKeyframe;
use crate::vocabulary::Vocabulary;

/// A vocabulary with its name, taken once.
#[derive(Debug)]
pub(super) struct NamedVocabulary {
    pub name: Box<str>,
    pub vocabulary: Vocabulary,
}

impl NamedVocabulary {
    /// Loads a vocabulary; a million words take a moment, off the async threads.
    pub async fn load(path: PathBuf) -> Result<Self> {
        let loaded = blocking(move || {
            let vocabulary =
                Vocabulary::load(&path).map_err(|error| format!("{}: {error}", path.display()))?;
            Ok(Self { name: vocabulary.fingerprint().to_string().into(), vocabulary })
        });
        loaded.await?.map_err(ServiceError::Internal)
    }

    /// Computes the bag of words of a keyframe from its features, if it has any.
    pub fn compute_bow(&self, mut keyframe: NewKeyframe) -> Result<NewKeyframe> {
        let Some(features) = &keyframe.features else { return Ok(keyframe) };
        let invalid = |detail: String| FieldError::new("/features/descriptor_bytes", detail);
        let transformed =
            self.vocabulary.transform_features(features).map_err(|error| invalid(error.to_string()))?;
        keyframe.bow = transformed.words.to_bow().map_err(|error| invalid(error.to_string()))?;
        keyframe.vocabulary = Some(self.name.clone());
        Ok(keyframe)
    }
}
