//! Where a model is missed: the verdicts in which the built-in judge stood in for one that is away, and those that a
//! description still to come could turn.

use crate::domain::anchor::{AnchorState, Observation};
use crate::recognition::loops::anchor_map::{LocalAnchor, LocalAnchorMap};
use crate::recognition::loops::comparison::Comparison;
use crate::recognition::loops::equation_1::same_relative_place;
use crate::recognition::loops::equation_2;
use crate::recognition::map::index::MapIndex;
use crate::semantics::{self, Route};

/// Would a model that is away have had a say in the comparison of two local anchor maps?
///
/// It would about crops that it has not looked at, and about texts at one relative place that the built-in judge
/// leaves open.
pub fn model_is_missed(index: &MapIndex, query: &LocalAnchorMap, candidate: &LocalAnchorMap) -> bool {
    if !index.model_away() {
        return false;
    }
    let settings = &index.properties().settings;
    awaited(index, query, candidate) > 0
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

/// Returns how many anchors of two local anchor maps wait for a model that reads their crops.
pub fn awaited(index: &MapIndex, query: &LocalAnchorMap, candidate: &LocalAnchorMap) -> usize {
    query.anchors.iter().chain(&candidate.anchors).filter(|anchor| is_awaited(index, anchor)).count()
}

/// A comparison if every crop that waits to be described turned out to speak against it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstCase {
    /// How many anchors wait.
    pub awaited: usize,
    /// S of Eq. (2), with each of them valid and matched by nothing.
    pub similarity: f64,
}

/// Returns what two places that agree may come to once every crop around them is described; `None` if none waits.
///
/// A plate that nobody has read yet may read 910 where 901 hung: that a model is slow or fails must not make a loop.
pub fn worst_case(
    index: &MapIndex,
    query: &LocalAnchorMap,
    candidate: &LocalAnchorMap,
    comparison: &Comparison<'_>,
) -> Option<WorstCase> {
    let waiting =
        || query.anchors.iter().chain(&candidate.anchors).filter(|anchor| is_awaited(index, anchor));
    let awaited = waiting().count();
    if awaited == 0 {
        return None;
    }
    let total = waiting().fold(comparison.total_weight, |sum, anchor| sum + anchor.weight);
    let similarity = equation_2::similarity(comparison.agreeing_weight(), total);
    Some(WorstCase { awaited, similarity })
}

/// Whether nothing has described this anchor, and there is a crop that a model has not looked at.
fn is_awaited(index: &MapIndex, anchor: &LocalAnchor) -> bool {
    let unread = |seen: &Observation| seen.crop_area_px.is_some() && seen.crop_reading.is_none();
    let object = anchor.name.object().and_then(|root| index.objects().get(root));
    anchor.state == AnchorState::Pending
        && object.is_some_and(|object| {
            index.anchors_of(object).flat_map(|anchor| anchor.observations.values()).any(unread)
        })
}
