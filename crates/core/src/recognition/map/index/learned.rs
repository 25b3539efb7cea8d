//! Knowledge of a map about its building: its numbering, and the views that it has twice (M20, M16).

use super::map_index::MapIndex;
use super::objects::{Certainty, MergedAnchor};
use crate::domain::anchor::AnchorState;
use crate::domain::change::Twins;
use crate::domain::ids::AnchorSeq;
use crate::domain::map::{Learned, NamedTwins};
use crate::semantics;

impl MapIndex {
    /// Returns the pairs of keyframes that show one view in two places, ascending.
    pub fn twins(&self) -> impl Iterator<Item = &Twins> {
        self.twins.iter().filter(|twins| self.are_twins(twins))
    }

    /// Returns the pairs that are kept, also those that are none at present because a sign changed.
    pub fn kept_twins(&self) -> impl Iterator<Item = &Twins> {
        self.twins.iter()
    }

    /// Whether both keyframes are there, and the two signs still exclude each other.
    pub fn are_twins(&self, twins: &Twins) -> bool {
        let are_there = self.keyframe(twins.keyframe).and(self.keyframe(twins.candidate)).is_some();
        let signs = self.sign(twins.anchor).zip(self.sign(twins.candidate_anchor));
        let texts = signs.and_then(|(a, b)| a.description.as_ref().zip(b.description.as_ref()));
        let differ = texts.is_some_and(|(a, b)| semantics::is_conflict(&a.text, &b.text));
        are_there && differ
    }

    /// Returns the object of a sign that takes part in comparisons, read alike twice or described.
    fn sign(&self, anchor: AnchorSeq) -> Option<&MergedAnchor> {
        let object = self.object_of(anchor)?;
        let is_known = |object: &&MergedAnchor| {
            let certainty = object.description.as_ref().map(|description| description.certainty);
            object.state == AnchorState::Valid && certainty > Some(Certainty::ReadOnce)
        };
        Some(object).filter(is_known)
    }

    /// Its knowledge of its building, by the names that clients know.
    pub fn learned(&self) -> Learned {
        let named = |twins: &Twins| {
            Some(NamedTwins {
                keyframe: self.keyframe(twins.keyframe)?.id.clone(),
                candidate: self.keyframe(twins.candidate)?.id.clone(),
                anchor: self.objects.root(twins.anchor)?,
                candidate_anchor: self.objects.root(twins.candidate_anchor)?,
            })
        };
        Learned { numbering: self.readings.learned(), twins: self.twins().filter_map(named).collect() }
    }
}
