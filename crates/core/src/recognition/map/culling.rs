//! Keyframes and anchors go: what followed from them goes with them.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::index::MapIndex;
use super::recorder::{Decided, Recorder};
use crate::domain::bow::BowVector;
use crate::domain::change::{Change, Merge, MergeCause};
use crate::domain::event::{Event, EventKind};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, PointId, SessionSeq};

/// Culls a keyframe: its covisibility and its observations go, with the last observation the anchor, and
/// with the last observer the map point. Its bag of words says which postings go.
pub fn cull_keyframe(index: &mut MapIndex, keyframe: KeyframeSeq, bow: Arc<BowVector>) -> Decided {
    let mut record = Recorder::new(index);
    let points = points_of(record.index(), keyframe);
    let seen: Vec<AnchorSeq> = record.index().anchors_seen_by(keyframe).collect();
    record.touch(seen.iter().copied());
    let mut event = Event::of(EventKind::KeyframeRemoved);
    event.keyframe = record.index().keyframe(keyframe).map(|culled| culled.id.clone());
    record.emit(event);
    record.apply(vec![Change::KeyframeRemoved(keyframe, bow)]);
    for anchor in seen {
        if record.index().anchor(anchor).is_some_and(|anchor| anchor.observations.is_empty()) {
            remove_anchor(&mut record, anchor);
        }
    }
    if let Some((session, points)) = points {
        let index = record.index();
        let forgotten = points.into_iter().filter(|id| is_orphan(index, session, *id)).collect::<Box<[_]>>();
        if !forgotten.is_empty() {
            record.apply(vec![Change::PointsForgotten(session, forgotten)]);
        }
    }
    record.finish()
}

/// Returns the session of a keyframe, and the map points that it or its detections name.
fn points_of(index: &MapIndex, keyframe: KeyframeSeq) -> Option<(SessionSeq, BTreeSet<PointId>)> {
    let culled = index.keyframe(keyframe)?;
    let mut points: BTreeSet<PointId> = culled.observes.iter().collect();
    points.extend(index.detections_of(keyframe).flat_map(|(_, seen)| seen.map_points.iter()));
    Some((culled.session, points))
}

/// Whether the map point has a position, and no observer that would miss it. As in SLAM, where a point that nobody observes is culled;
/// one that was sent before anybody observed it waits for its first observer.
pub(in crate::recognition) fn is_orphan(index: &MapIndex, session: SessionSeq, id: PointId) -> bool {
    index.points().position(session, id).is_some()
        && !index.points().is_observed(session, id)
        && index.holders().of(session, id).next().is_none()
}

/// Deletes an object with all its anchors; its detections stay with their keyframes and feed nothing.
pub fn delete_object(index: &mut MapIndex, root: AnchorSeq) -> Decided {
    let members = index.objects().get(root).map(|object| object.members.clone()).unwrap_or_default();
    let mut record = Recorder::new(index);
    record.apply(members.into_iter().map(Change::AnchorRemoved).collect());
    record.finish()
}

/// Removes one anchor. Where it held others together, they stay together: its neighbours are
/// linked to the oldest of them, by the same causes.
fn remove_anchor(record: &mut Recorder<'_>, anchor: AnchorSeq) {
    let mut neighbours: Vec<(AnchorSeq, MergeCause)> = record
        .index()
        .objects()
        .links(anchor)
        .map(|merge| (if merge.into == anchor { merge.from } else { merge.into }, merge.cause.clone()))
        .collect();
    neighbours.sort();
    let mut changes = vec![Change::AnchorRemoved(anchor)];
    if let Some(((oldest, first_cause), others)) = neighbours.split_first() {
        for (other, cause) in others.iter().filter(|(other, _)| other != oldest) {
            // Both links held the two together; the loop is the one that may be revoked.
            let cause = if *cause == MergeCause::Covisible { first_cause } else { cause };
            changes.push(Change::Merged(Merge { into: *oldest, from: *other, cause: cause.clone() }));
            record.touch([*other]);
        }
        record.touch([*oldest]);
    }
    record.apply(changes);
}
