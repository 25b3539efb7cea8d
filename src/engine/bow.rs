//! Words out of features: the server's vocabulary, and the rule that a map's words belong to one.

use std::path::PathBuf;
use std::sync::Arc;

use tokio::task::spawn_blocking;

use super::{Service, ServiceError};
use crate::config::logging::in_span;
use crate::domain::invalid::FieldError;
use crate::domain::keyframe::NewKeyframe;
use crate::recognition::anchors::ingest::other_vocabulary;
use crate::recognition::map::index::MapIndex;
use crate::vocabulary::Vocabulary;

/// A vocabulary with its name, taken once.
#[derive(Debug)]
pub(super) struct NamedVocabulary {
    pub name: Box<str>,
    pub vocabulary: Vocabulary,
}

/// Loads a vocabulary; a million words take a moment, off the async threads.
pub(super) async fn load(path: PathBuf) -> Result<NamedVocabulary, ServiceError> {
    let loaded = spawn_blocking(move || {
        let vocabulary = Vocabulary::load(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(NamedVocabulary { name: vocabulary.fingerprint().to_string().into(), vocabulary })
    });
    loaded.await.map_err(ServiceError::panicked)?.map_err(ServiceError::Internal)
}

impl Service {
    /// Computes the bag of words of a keyframe that came with features and without words, if the server has a
    /// vocabulary.
    pub(super) async fn compute_bow(&self, keyframe: NewKeyframe) -> Result<NewKeyframe, ServiceError> {
        let Some(vocabulary) = self.vocabulary.clone() else { return Ok(keyframe) };
        if keyframe.vocabulary.is_some() || keyframe.features.is_none() {
            return Ok(keyframe);
        }
        spawn_blocking(in_span(move || compute(&vocabulary, keyframe)))
            .await
            .map_err(ServiceError::panicked)?
    }

    /// Returns the server's vocabulary: its fingerprint, and how many words it has.
    pub fn vocabulary(&self) -> Option<(&str, usize)> {
        self.vocabulary.as_ref().map(|named| (&*named.name, named.vocabulary.word_count()))
    }
}

fn compute(named: &Arc<NamedVocabulary>, mut keyframe: NewKeyframe) -> Result<NewKeyframe, ServiceError> {
    let Some(features) = &keyframe.features else { return Ok(keyframe) };
    let invalid =
        |detail: String| ServiceError::Invalid(vec![FieldError::new("/features/descriptor_bytes", detail)]);
    let transformed =
        named.vocabulary.transform_features(features).map_err(|error| invalid(error.to_string()))?;
    keyframe.bow = transformed.words.to_bow().map_err(|error| invalid(error.to_string()))?;
    keyframe.vocabulary = Some(named.name.clone());
    Ok(keyframe)
}

/// Refuses a keyframe whose words belong to another vocabulary than the map's.
pub(super) fn check_vocabulary(index: &MapIndex, keyframe: &NewKeyframe) -> Result<(), ServiceError> {
    let Some(ours) = other_vocabulary(index, keyframe) else { return Ok(()) };
    let theirs = keyframe.vocabulary.as_deref().unwrap_or_default();
    let detail = format!(
        "the words of this map belong to vocabulary {ours}, those of the keyframe to {theirs}; one number would mean \
         two things. Use one vocabulary for a map, and name it in bow.vocabulary where the client computes the words"
    );
    Err(ServiceError::Conflict { code: "other_vocabulary", detail })
}
