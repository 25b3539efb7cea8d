//! Semantic anchor matching: which anchors of the map are the same object (§IV-C.2).
//!
//! Two anchors of one class match when their descriptions are identical or their SimilarityLevel
//! is at least the setting's; [`crate::recognition::map::index::TextIndex`] keeps the matches. If their keyframes are covisible and
//! their boxes close, they are merged at once (here); if not, the robot has come back, and
//! loop detection is triggered (§III). The paper leaves "close" open: boxes that touch, or centres
//! within `association_position_radius_m`, in a frame both have (M5).

use std::collections::BTreeSet;

use crate::domain::change::{Merge, MergeCause};
use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::recognition::map::index::{MapIndex, MergedAnchor, Shape};

/// Returns the first object that `root` must be merged with, among those that the keyframes covisible with `around`
/// see.
pub fn covisible_merge(index: &MapIndex, root: AnchorSeq, around: &BTreeSet<KeyframeSeq>) -> Option<Merge> {
    let object = index.objects().get(root)?;
    let text = index.texts().of(root)?;
    let nearby = index.objects_seen_by_any(&index.covisibility().around(around));
    let twin = nearby.into_iter().filter(|other| *other != root).find(|other| {
        index.texts().of(*other).is_some_and(|theirs| index.texts().level(text, theirs).is_some())
            && index.objects().get(*other).is_some_and(|other| close(index, object, other))
    })?;
    Some(Merge { into: root.min(twin), from: root.max(twin), cause: MergeCause::Covisible })
}

/// Whether the two boxes touch, or their centres are near, in a frame that both have. Where nothing measured a distance no
/// place can be compared: then the same number in covisible keyframes is the same plate.
fn close(index: &MapIndex, a: &MergedAnchor, b: &MergedAnchor) -> bool {
    let radius_m = index.properties().settings.association_position_radius_m;
    let is_numbered = |object: &MergedAnchor| {
        object.description.as_ref().is_some_and(|description| description.text.has_own_name())
    };
    let near = |of_a: &Shape, of_b: &Shape| {
        let Some((box_a, box_b)) = of_a.aabb.zip(of_b.aabb) else { return false };
        let is_guessed = of_a.range_assumed || of_b.range_assumed;
        (is_guessed && is_numbered(a) && is_numbered(b))
            || box_a.touches(&box_b)
            || (box_a.centre() - box_b.centre()).norm() <= radius_m
    };
    a.shapes
        .iter()
        .filter_map(|(session, shape)| Some((shape, b.shapes.get(session)?)))
        .any(|(of_a, of_b)| near(of_a, of_b))
}

/// Returns the objects that match `root` though no keyframe of theirs is covisible with one of its own: the robot has
/// come back. Oldest first. A sign that only a plan shows was not seen before.
pub fn revisits(index: &MapIndex, root: AnchorSeq) -> impl Iterator<Item = AnchorSeq> + '_ {
    let near = neighbourhood(index, root);
    let was_seen = |other: &AnchorSeq| index.anchor(*other).is_some_and(|anchor| anchor.prior.is_none());
    matches(index, root).filter(was_seen).filter(move |other| near.binary_search(other).is_err())
}

/// Returns the objects that match `root`, covisible or not; oldest first within each text.
pub fn matches(index: &MapIndex, root: AnchorSeq) -> impl Iterator<Item = AnchorSeq> + '_ {
    let texts = index.texts();
    texts
        .of(root)
        .into_iter()
        .filter(move |text| texts.with_itself(texts.text(*text).1).is_some())
        .flat_map(move |text| texts.matching(text))
        .flat_map(move |text| texts.objects(text))
        .filter(move |other| *other != root)
}

/// Returns the objects that keyframes covisible with an object's own keyframes see, ascending.
pub fn neighbourhood(index: &MapIndex, root: AnchorSeq) -> Vec<AnchorSeq> {
    let Some(object) = index.objects().get(root) else { return Vec::new() };
    index.objects_seen_by_any(&index.covisibility().around(&index.keyframes_of(object)))
}
