//! Common to the keyframes of a map: words of one vocabulary, which are computed out of features for those without, and
//! global descriptors that can all be compared.

use super::tasks::blocking;
use super::{Result, Service, ServiceError};
use crate::domain::global_descriptor::{GlobalDescriptor, GlobalForm};
use crate::domain::keyframe::NewKeyframe;
use crate::recognition::anchors::ingest::other_vocabulary;
use crate::recognition::map::index::MapIndex;

impl Service {
    /// Computes the bag of words of a keyframe that came with features and without words, if the server has a
    /// vocabulary.
    pub(super) async fn compute_bow(&self, keyframe: NewKeyframe) -> Result<NewKeyframe> {
        let Some(vocabulary) = self.vocabulary.clone() else { return Ok(keyframe) };
        if keyframe.vocabulary.is_some() || keyframe.features.is_none() {
            return Ok(keyframe);
        }
        blocking(move || vocabulary.compute_bow(keyframe)).await?
    }

    /// Returns the server's vocabulary: its fingerprint, and how many words it has.
    pub fn vocabulary(&self) -> Option<(&str, usize)> {
        self.vocabulary.as_ref().map(|named| (&*named.name, named.vocabulary.word_count()))
    }
}

/// Refuses a keyframe whose words belong to another vocabulary than the map's.
pub(super) fn check_vocabulary(index: &MapIndex, keyframe: &NewKeyframe) -> Result<()> {
    let Some(ours) = other_vocabulary(index.vocabulary(), keyframe) else { return Ok(()) };
    let theirs = keyframe.vocabulary.as_deref().unwrap_or_default();
    let detail = format!(
        "the words of this map belong to vocabulary {ours}, those of the keyframe to {theirs}; one number would mean \
         two things. Use one vocabulary for a map, and name it in bow.vocabulary where the client computes the words"
    );
    Err(ServiceError::Conflict { code: "other_vocabulary", detail })
}

/// Refuses a global descriptor that cannot be compared with those of the map.
pub(super) fn check_global_descriptor(index: &MapIndex, descriptor: Option<&GlobalDescriptor>) -> Result<()> {
    let (Some(theirs), Some(ours)) = (descriptor, index.globals().form()) else { return Ok(()) };
    if theirs.is_of(ours) {
        return Ok(());
    }
    let detail = format!(
        "the global descriptors of this map are {}, that of the keyframe (/global_descriptor) is {}; they cannot be \
         compared. Use one model for a map, in one encoding and size",
        named(ours),
        named(&theirs.form())
    );
    Err(ServiceError::Conflict { code: "other_global_descriptor", detail })
}

fn named(form: &GlobalForm) -> String {
    let GlobalForm { model, encoding, bytes } = form;
    format!("of model {model}, {}, {bytes} bytes", encoding.as_str())
}
