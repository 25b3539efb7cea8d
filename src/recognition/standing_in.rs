//! Where a model is missed: the verdicts in which the built-in judge stood in for one that is away.

use super::anchor_map::{LocalAnchor, LocalAnchorMap};
use super::comparison::same_relative_place;
use super::index::MapIndex;
use crate::model::anchor::AnchorState;
use crate::semantics::{self, Route};

/// Would a model that is away have had a say in the comparison of two local anchor maps?
///
/// It would about anchors that nothing has described, and about texts at one relative place that the built-in judge
/// leaves open.
pub fn model_is_missed(index: &MapIndex, query: &LocalAnchorMap, candidate: &LocalAnchorMap) -> bool {
    if !index.model_away() {
        return false;
    }
    let is_pending = |anchor: &LocalAnchor| anchor.state == AnchorState::Pending;
    let settings = &index.properties().settings;
    query.anchors.iter().chain(&candidate.anchors).any(is_pending)
        || query.valid().any(|ours| {
            candidate.valid().any(|theirs| {
                ours.class == theirs.class
                    && same_relative_place(ours, theirs, settings)
                    && is_open(index, ours, theirs)
            })
        })
}

fn is_open(index: &MapIndex, ours: &LocalAnchor, theirs: &LocalAnchor) -> bool {
    let (Some(a), Some(b)) = (ours.text.as_deref(), theirs.text.as_deref()) else { return false };
    matches!(semantics::route_similarity(a, b), Route::Open(_))
        && index.verdicts().similarity(&ours.class, a, b).is_none()
}
