//! The matches of one text: listed as long as they are few.

use std::collections::BTreeMap;

use super::text_id::TextId;
use crate::semantics::Source;

/// A SimilarityLevel, and who judged.
pub(super) type Verdict = (u8, Source);

/// The other texts that match a text. Beyond a bound there is no list, since n texts that all match each other would
/// list n² of them: such a text is crowded, and its matches are found by judging anew. A crowded text stays so as long as
/// it is carried. This is about keeping alone: no answer tells a crowded text from another.
#[derive(Clone, Debug)]
pub(super) enum Matches {
    /// Every text that matches, crowded ones among them.
    Listed(BTreeMap<TextId, Verdict>),
    /// Too many to be listed.
    Crowded,
}

impl Matches {
    /// No text matches.
    pub(super) fn none() -> Self {
        Self::Listed(BTreeMap::new())
    }

    /// Returns the list, unless the text is crowded.
    pub(super) fn listed(&self) -> Option<&BTreeMap<TextId, Verdict>> {
        match self {
            Self::Listed(list) => Some(list),
            Self::Crowded => None,
        }
    }

    /// Whether there is no list.
    pub(super) fn is_crowded(&self) -> bool {
        matches!(self, Self::Crowded)
    }

    /// This text matches, and at most `max` are listed.
    pub(super) fn insert(&mut self, other: TextId, verdict: Verdict, max: usize) {
        let Self::Listed(list) = self else { return };
        list.insert(other, verdict);
        if list.len() > max {
            *self = Self::Crowded;
        }
    }

    /// This text matches no longer.
    pub(super) fn remove(&mut self, other: TextId) {
        if let Self::Listed(list) = self {
            list.remove(&other);
        }
    }
}
