//! Observations that change: the client's map fused or culled points, or found edges, after it had sent the keyframes (M57).
//!
//! Observed points, covisibility, boxes and positions are afterwards what they were had the keyframes
//! been sent so, in whatever order keyframes and changes came. Anchors are told apart on arrival, so association follows
//! as far as it can:
//!
//! - A detection that founded an anchor, and would have been one more sight of an object that a keyframe now covisible had
//!   seen, joins that object: the two anchors are linked, as a covisible merge links them (§IV-C.2).
//! - What was recognised as one object stays one, though its keyframes are covisible no more, or its points are other ones.
//! - A detection that joined another object meanwhile stays with it, though the one it would have joined fits better; and two
//!   anchors that one keyframe saw both stay two.
//! - A detection that was ignored on arrival stays so, and one that loses its last map point keeps its anchor.

mod newly_covisible;

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use self::newly_covisible::CovisibleBefore;
use super::association::late_sight;
use super::ingest::{merge_all, names, tell_described, tell_revisits};
use crate::domain::change::{
    Change, Declared, Keyframe, KeyframeUpdate, ObservationUpdate, PointsOfKeyframe, Renamed,
};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, PointId, SessionSeq};
use crate::recognition::map::culling::is_orphan;
use crate::recognition::map::index::{Anchor, MapIndex};
use crate::recognition::map::recorder::{Decided, Recorder};

/// Pairs of keyframes, summed over the map points whose observers one request changes: what it costs to find who is covisible
/// afterwards. A point that ten thousand keyframes see, fused into another one, has as many. In this crate's own tests a small map has too many.
pub const CHANGED_PAIRS_MAX: u64 = if cfg!(test) { 50_000 } else { 200_000_000 };

/// Bytes of a number on disk, as a map's quota counts them.
const NUMBER: usize = size_of::<f64>();

/// The effect of changed observations, or of a merge of sessions, on a map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObservationsChanged {
    /// The keyframes that observe other points now, or have other declared neighbours; of a merge, those that moved.
    pub keyframes: usize,
    /// The map points that are gone, fused or culled; of a merge, those with a position that moved.
    pub map_points: usize,
    /// The anchors that turned out to be one with another.
    pub merged: usize,
    /// The changes and events. That the client said it is one of them, though everything was so already.
    pub decided: Decided,
}

/// The map points that go, each with the one that it becomes, if any.
pub(super) type Becomes = HashMap<PointId, Option<PointId>>;

/// A change concerns more pairs of keyframes than one request may.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyPairs(pub u64);

/// Applies what the client's map did to its points and edges, or nothing if that is too much for one request.
pub fn change_observations(
    index: &mut MapIndex,
    update: ObservationUpdate,
) -> Result<ObservationsChanged, TooManyPairs> {
    let becomes = becomes(&update);
    let mut record = Recorder::new(index);
    let index = record.index();
    let keyframes: Vec<PointsOfKeyframe> = keyframes_of(index, &update)
        .into_iter()
        .filter_map(|keyframe| points_of_keyframe(index, keyframe, listed(&update, keyframe), &becomes))
        .collect();
    let before = CovisibleBefore::of(index, update.session, &keyframes);
    let pairs = before.pairs(&keyframes);
    if pairs > CHANGED_PAIRS_MAX {
        return Err(TooManyPairs(pairs));
    }
    let detections = points_of_detections(index, update.session, &becomes);
    let placed = placed(index, &update, &becomes);
    let has_position = |id: &PointId| index.points().position(update.session, *id).is_some();
    let mut forgotten: Vec<PointId> = becomes.keys().copied().filter(has_position).collect();
    forgotten.sort_unstable();
    let gone = gone(index, &update, &becomes);
    let lost = lost(index, &keyframes, &becomes);
    let session = update.session;
    let mut seen_anew: BTreeSet<KeyframeSeq> = detections.iter().map(|(_, keyframe, ..)| *keyframe).collect();
    for (id, _) in &placed {
        for anchor in index.holders().of(session, *id) {
            seen_anew.extend(index.anchor(anchor).into_iter().flat_map(Anchor::keyframes));
        }
    }
    let mut touched: BTreeSet<AnchorSeq> = detections.iter().map(|(anchor, ..)| *anchor).collect();
    touched.extend(placed.iter().flat_map(|(id, _)| index.holders().of(session, *id)));

    let changed = keyframes.len();
    let mut changes = vec![Change::ObservationsSent(Box::new(update))];
    changes.extend(detections.into_iter().map(|(anchor, keyframe, detection, points)| {
        Change::PointsOfDetectionSet(anchor, keyframe, detection, points)
    }));
    changes.extend(keyframes.into_iter().map(|of| Change::PointsOfKeyframeSet(Box::new(of))));
    changes.extend(placed.into_iter().map(|(id, at)| Change::PointSet(session, id, at)));
    if !forgotten.is_empty() {
        changes.push(Change::PointsForgotten(session, forgotten.into()));
    }
    record.touch(touched);
    record.apply(changes);
    let index = record.index();
    let orphans: Box<[PointId]> = lost.into_iter().filter(|id| is_orphan(index, session, *id)).collect();
    if !orphans.is_empty() {
        record.apply(vec![Change::PointsForgotten(session, orphans)]);
    }
    let mut looked_at = with_younger_neighbours(record.index(), seen_anew);
    before.add_younger(record.index(), &mut looked_at);
    let merged = associate_anew(&mut record, looked_at);
    Ok(ObservationsChanged { keyframes: changed, map_points: gone, merged, decided: record.finish() })
}

/// Returns the keyframes that observe a point that goes, or that the client speaks of, ascending.
pub fn keyframes_of(index: &MapIndex, update: &ObservationUpdate) -> BTreeSet<KeyframeSeq> {
    let replaced = update.replaced.iter().map(|(old, _)| *old);
    let going = replaced.chain(update.removed.iter().copied());
    let observers = index.points().sharing(update.session, going).into_iter().map(|(keyframe, _)| keyframe);
    observers.chain(update.keyframes.iter().map(|of| of.keyframe)).collect()
}

fn listed(update: &ObservationUpdate, keyframe: KeyframeSeq) -> Option<&KeyframeUpdate> {
    update.keyframes.iter().find(|of| of.keyframe == keyframe)
}

/// Follows every point that goes to the one that stays in the end.
fn becomes(update: &ObservationUpdate) -> Becomes {
    let next: HashMap<PointId, PointId> = update.replaced.iter().copied().collect();
    let mut becomes: Becomes = update.removed.iter().map(|id| (*id, None)).collect();
    for (old, _) in &update.replaced {
        let (mut way, mut at) = (Vec::new(), *old);
        let end = loop {
            match (becomes.get(&at), next.get(&at)) {
                (Some(end), _) => break *end,
                (None, Some(after)) if way.len() < next.len() => {
                    way.push(at);
                    at = *after;
                }
                _ => break Some(at),
            }
        };
        becomes.extend(way.into_iter().map(|id| (id, end)));
    }
    becomes
}

/// Returns the points as they are now, ascending.
pub(super) fn now(points: impl Iterator<Item = PointId>, becomes: &Becomes) -> Vec<PointId> {
    let now = points.filter_map(|id| becomes.get(&id).copied().unwrap_or(Some(id)));
    now.collect::<BTreeSet<PointId>>().into_iter().collect()
}

/// Returns what a keyframe observes now, if that is not what it did.
fn points_of_keyframe(
    index: &MapIndex,
    keyframe: KeyframeSeq,
    listed: Option<&KeyframeUpdate>,
    becomes: &Becomes,
) -> Option<PointsOfKeyframe> {
    let stored = index.keyframe(keyframe)?;
    let said = listed.and_then(|of| of.observes.clone());
    let observes = said.unwrap_or_else(|| now(stored.observes.iter(), becomes));
    let renamed = renamed(stored, &observes, becomes);
    let mut declared = stored.declared.clone().map(Vec::from);
    for (other, shared) in listed.into_iter().flat_map(|of| &of.covisible) {
        let declared = declared.get_or_insert_default();
        match declared.iter_mut().find(|(known, _)| known == other) {
            Some((_, known)) => *known = *shared,
            None => declared.push((*other, *shared)),
        }
    }
    if stored.observes.iter().eq(observes.iter().copied())
        && declared.as_deref() == stored.declared.as_deref()
        && renamed == stored.renamed.clone().unwrap_or_default()
    {
        return None;
    }
    Some(with_bytes(stored, observes, declared.map(Into::into), renamed))
}

/// Returns the points that features were sent with and that are others now.
fn renamed(stored: &Keyframe, observes: &[PointId], becomes: &Becomes) -> Renamed {
    let before = stored.renamed.clone().unwrap_or_default();
    let mut pairs: BTreeMap<PointId, PointId> = BTreeMap::new();
    for (sent, id) in &before.pairs {
        pairs.extend(becomes.get(id).copied().unwrap_or(Some(*id)).map(|id| (*sent, id)));
    }
    for id in stored.observes.iter().filter(|_| !before.is_complete) {
        if let Some(Some(into)) = becomes.get(&id) {
            pairs.entry(id).or_insert(*into);
        }
    }
    pairs.retain(|sent, id| (before.is_complete || sent != id) && observes.binary_search(id).is_ok());
    Renamed { pairs: pairs.into_iter().collect(), ..before }
}

/// Returns what a keyframe observes now, with what it takes on disk.
pub(super) fn with_bytes(
    stored: &Keyframe,
    observes: Vec<PointId>,
    declared: Declared,
    renamed: Renamed,
) -> PointsOfKeyframe {
    let bytes = |observes: usize, declared: usize, renamed: usize| {
        ((observes + declared + 2 * renamed) * NUMBER) as u64
    };
    let before = stored.renamed.as_ref().map_or(0, |renamed| renamed.pairs.len());
    let bytes = (stored.bytes
        + bytes(observes.len(), declared.as_deref().map_or(0, <[_]>::len), renamed.pairs.len()))
    .saturating_sub(bytes(stored.observes.len(), stored.declared().len(), before));
    PointsOfKeyframe { keyframe: stored.seq, observes: observes.into(), declared, renamed, bytes }
}

/// Returns the detections that have other points now, each with them.
pub(super) fn points_of_detections(
    index: &MapIndex,
    session: SessionSeq,
    becomes: &Becomes,
) -> Vec<(AnchorSeq, KeyframeSeq, u16, Box<[PointId]>)> {
    let holders = becomes.keys().flat_map(|id| index.holders().of(session, *id));
    let mut changed = Vec::new();
    for seq in holders.collect::<BTreeSet<AnchorSeq>>() {
        let Some(anchor) = index.anchor(seq) else { continue };
        for observation in anchor.observations.values() {
            let is_of_session = index.session_of(observation.keyframe) == Some(session);
            if is_of_session && observation.map_points.iter().any(|id| becomes.contains_key(id)) {
                let points = now(observation.map_points.iter().copied(), becomes).into();
                changed.push((seq, observation.keyframe, observation.detection, points));
            }
        }
    }
    changed
}

/// Returns the points that stay and get a position from those that go: one that has its own keeps it.
fn placed(
    index: &MapIndex,
    update: &ObservationUpdate,
    becomes: &Becomes,
) -> Vec<(PointId, crate::geometry::Point3)> {
    let position = |id: PointId| index.points().position(update.session, id);
    let mut placed = Vec::new();
    let mut are_placed = HashSet::new();
    for (old, _) in &update.replaced {
        let Some(Some(into)) = becomes.get(old) else { continue };
        if let Some(at) = position(*old).filter(|_| position(*into).is_none())
            && are_placed.insert(*into)
        {
            placed.push((*into, at));
        }
    }
    placed
}

/// Counts the points that go and were there.
fn gone(index: &MapIndex, update: &ObservationUpdate, becomes: &Becomes) -> usize {
    let session = update.session;
    let is_known = |id: &PointId| {
        index.points().position(session, *id).is_some()
            || index.points().is_observed(session, *id)
            || index.holders().of(session, *id).next().is_some()
    };
    becomes.keys().filter(|id| is_known(id)).count()
}

/// Returns the points that a keyframe observes no longer though they do not go.
fn lost(index: &MapIndex, keyframes: &[PointsOfKeyframe], becomes: &Becomes) -> BTreeSet<PointId> {
    let of_keyframe = |of: &PointsOfKeyframe| {
        let now: HashSet<PointId> = of.observes.iter().collect();
        let before = index.keyframe(of.keyframe).into_iter().flat_map(|stored| stored.observes.iter());
        before.filter(|id| !now.contains(id) && !becomes.contains_key(id)).collect::<Vec<_>>()
    };
    keyframes.iter().flat_map(of_keyframe).collect()
}

/// Returns these keyframes, of which a detection has other points, and all younger ones that are covisible with one of them: of
/// each a detection may be one more sight of something.
fn with_younger_neighbours(index: &MapIndex, seen_anew: BTreeSet<KeyframeSeq>) -> BTreeSet<KeyframeSeq> {
    let graph = index.covisibility();
    let mut open: BTreeSet<KeyframeSeq> = graph.around(&seen_anew).into_iter().collect();
    open.retain(|keyframe| !seen_anew.contains(keyframe));
    let mut found = seen_anew.clone();
    for keyframe in seen_anew {
        // Where many see one place, the first of them brings nearly all.
        if open.last().is_none_or(|last| *last < keyframe) {
            break;
        }
        for other in graph.neighbours(keyframe).filter(|other| *other > keyframe) {
            open.remove(&other);
            found.insert(other);
        }
    }
    found
}

/// Associates anew what these keyframes founded, and merges what matches and is covisible. Returns how many anchors became
/// one with another.
pub(super) fn associate_anew(record: &mut Recorder<'_>, keyframes: BTreeSet<KeyframeSeq>) -> usize {
    let objects_before = record.index().objects().len();
    let seen = |index: &MapIndex| -> BTreeSet<AnchorSeq> {
        keyframes.iter().flat_map(|keyframe| index.objects_seen_by(*keyframe)).collect()
    };
    let names_before = names(record.index(), &seen(record.index()));
    let mut open = keyframes.clone();
    while let Some(keyframe) = open.pop_first() {
        while let Some(merge) = late_sight(record.index(), keyframe) {
            let into = merge.into;
            let why = "their keyframes share map points by now, and one lies within the other";
            record.merge(merge, |event| event.detail = Some(why.into()));
            // The object is larger now: what later keyframes founded may be one more sight of it.
            let index = record.index();
            let around = index.object_of(into).map(|of| index.covisibility().around(&index.keyframes_of(of)));
            open.extend(around.into_iter().flatten().filter(|other| *other > keyframe));
        }
    }
    let now_seen = seen(record.index());
    let changed = tell_described(record, &now_seen, &names_before);
    for root in &changed {
        merge_all(record, *root, MapIndex::keyframes_of);
    }
    for keyframe in &keyframes {
        for root in record.index().objects_seen_by(*keyframe) {
            merge_all(record, root, |_, _| BTreeSet::from([*keyframe]));
        }
    }
    tell_revisits(record, None, &changed);
    objects_before - record.index().objects().len()
}

#[cfg(test)]
mod tests;
