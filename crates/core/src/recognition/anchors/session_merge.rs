//! Merge of sessions: the client's two maps became one, as ORB-SLAM3's Atlas merges them (M59).
//!
//! Keyframes keep their ids. They and their points and anchors move into the other session's frame, and covisibility and
//! association follow as for changed observations ([`super::observations`]). A merge can be revoked until something is
//! written in one of the two sessions.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use super::ingest::session_of;
use super::observations::{
    Becomes, ObservationsChanged, associate_anew, now, points_of_detections, with_bytes,
};
use crate::domain::change::{Change, Merge, MergeCause, PointsOfKeyframe, Renamed};
use crate::domain::event::{Event, EventKind};
use crate::domain::former::FormerValues;
use crate::domain::ids::{AnchorSeq, KeyframeSeq, PointId, SessionId, SessionSeq};
use crate::domain::invalid::FieldError;
use crate::domain::session_merge::{MergeUndo, Renumbering, SessionMerge, SessionMergeRequest};
use crate::recognition::map::index::{MapIndex, OpenMerge};
use crate::recognition::map::recorder::{Decided, Recorder};

/// Finds the faults that only the map can tell: a session without keyframes, a plan's frame, or a map point whose number would be
/// too large.
pub fn merge_faults(index: &MapIndex, request: &SessionMergeRequest) -> Vec<FieldError> {
    let mut faults = Vec::new();
    if request.session == request.into {
        let detail = "a session does not merge into itself";
        faults.push(FieldError::new("/into", detail).got(&request.into).limit("another session"));
    }
    if index.session(&request.into).is_some_and(|into| index.priors().is_frame(into)) {
        let detail = "this session is the frame of a plan, and no robot drives it";
        faults.push(
            FieldError::new("/into", detail).got(&request.into).limit("a session without prior anchors"),
        );
    }
    if let (Some(session), Renumbering::Offset(offset)) =
        (index.session(&request.session), &request.map_points)
    {
        let is_too_large = |id: &PointId| id.checked_add(*offset).is_none_or(|id| id < 0);
        if let Some(id) = numbers_of(index, session).iter().find(|id| is_too_large(id)) {
            let detail = format!("map point {id} would get a number below zero or too large");
            faults.push(FieldError::new("/map_points/offset", detail).got(offset));
        }
    }
    faults
}

/// Returns the keyframes of a session.
pub fn keyframes_of_session(index: &MapIndex, session: SessionSeq) -> Vec<KeyframeSeq> {
    index.keyframes().filter(|keyframe| keyframe.session == session).map(|keyframe| keyframe.seq).collect()
}

/// Returns the numbers of a session's map points: those with a position, those observed, and those of its detections.
fn numbers_of(index: &MapIndex, session: SessionSeq) -> BTreeSet<PointId> {
    let mut numbers: BTreeSet<PointId> =
        index.points().placed(session).into_iter().map(|(id, _)| id).collect();
    for keyframe in index.keyframes().filter(|keyframe| keyframe.session == session) {
        numbers.extend(keyframe.observes.iter());
        numbers.extend(index.detections_of(keyframe.seq).flat_map(|(_, seen)| seen.map_points.iter()));
    }
    numbers
}

/// Merges a session into another one; [`merge_faults`] finds no fault with it.
pub fn merge_sessions(
    index: &mut MapIndex,
    session: SessionSeq,
    request: &SessionMergeRequest,
) -> ObservationsChanged {
    let mut record = Recorder::keeping_former(index);
    let index = record.index();
    let mut changes = Vec::new();
    let into = session_of(index, &request.into, &mut changes);
    let merge = SessionMerge {
        session,
        into,
        next_keyframe: index.next_keyframe(),
        into_from_session: request.into_from_session,
        map_points: request.map_points.clone(),
    };
    let becomes = becomes(index, &merge);
    let keyframes = keyframes_of_session(index, session);
    let named = MergeUndo::naming(session, into, merge.next_keyframe);
    let mut undo = MergeUndo { keyframes: keyframes.clone(), ..named };
    renumber(index, &becomes, &mut undo, &mut changes);
    let moved = keyframes.iter().filter_map(|seq| index.keyframe(*seq));
    changes.extend(moved.map(|keyframe| {
        Change::PoseSet(keyframe.seq, merge.into_from_session.after(&keyframe.similarity()))
    }));
    let map_points = move_points(index, &merge, &becomes, &mut changes);
    changes.push(Change::SessionsMerged(Box::new(merge)));
    let anchors: BTreeSet<AnchorSeq> = keyframes.iter().flat_map(|seq| index.anchors_seen_by(*seq)).collect();
    record.touch(anchors);
    record.apply(changes);
    record.emit(told(EventKind::SessionsMerged, &request.session, &request.into));
    let looked_at = covisible_with_others(record.index(), &keyframes);
    let first = record.changes().len();
    let merged = associate_anew(&mut record, looked_at);
    let linked = record.changes()[first..].iter().filter_map(|change| match change {
        Change::Merged(merge) if merge.cause == MergeCause::Covisible => Some((merge.into, merge.from)),
        _ => None,
    });
    undo.merges = linked.collect();
    record.keep_undo(undo);
    ObservationsChanged { keyframes: keyframes.len(), map_points, merged, decided: record.finish() }
}

fn told(kind: EventKind, session: &SessionId, into: &SessionId) -> Event {
    let mut event = Event::of(kind);
    (event.session, event.into) = (Some(session.clone()), Some(into.clone()));
    event
}

/// Returns the number that each map point gets, for those that get another one.
fn becomes(index: &MapIndex, merge: &SessionMerge) -> Becomes {
    if merge.map_points == Renumbering::Same {
        return HashMap::new();
    }
    let number = merge.map_points.number();
    let numbered = numbers_of(index, merge.session).into_iter().map(|id| (id, number(id)));
    numbered.filter(|(old, new)| old != new).map(|(old, new)| (old, Some(new))).collect()
}

/// Gives the map points of keyframes and detections their new numbers, and keeps the old ones.
fn renumber(index: &MapIndex, becomes: &Becomes, undo: &mut MergeUndo, changes: &mut Vec<Change>) {
    if becomes.is_empty() {
        return;
    }
    for (anchor, keyframe, detection, points) in points_of_detections(index, undo.session, becomes) {
        let seen = index.observation(anchor, (keyframe, detection));
        undo.detections.extend(seen.map(|seen| (keyframe, detection, seen.map_points.clone())));
        changes.push(Change::PointsOfDetectionSet(anchor, keyframe, detection, points));
    }
    for keyframe in &undo.keyframes {
        let Some(stored) = index.keyframe(*keyframe) else { continue };
        if !stored.observes.iter().any(|id| becomes.contains_key(&id)) {
            continue;
        }
        let before = stored.renamed.clone().unwrap_or_default();
        let number = |id: PointId| becomes.get(&id).copied().flatten().unwrap_or(id);
        let mut pairs: BTreeMap<PointId, PointId> =
            before.pairs.iter().map(|(sent, id)| (*sent, number(*id))).collect();
        // Which points the features were sent with is not known here: each observed one may be.
        for id in stored.observes.iter().filter(|_| !before.is_complete) {
            pairs.entry(id).or_insert_with(|| number(id));
        }
        let renamed = Renamed { pairs: pairs.into_iter().collect(), is_complete: true };
        let observes = now(stored.observes.iter(), becomes);
        let points = with_bytes(stored, observes, stored.declared.clone(), renamed);
        changes.push(Change::PointsOfKeyframeSet(Box::new(points)));
        undo.points.push(PointsOfKeyframe {
            keyframe: *keyframe,
            observes: stored.observes.clone(),
            declared: stored.declared.clone(),
            renamed: before,
            bytes: stored.bytes,
        });
    }
}

/// Brings the map points into the other frame. One whose number is taken there is that one, which keeps its position.
fn move_points(
    index: &MapIndex,
    merge: &SessionMerge,
    becomes: &Becomes,
    changes: &mut Vec<Change>,
) -> usize {
    let placed = index.points().placed(merge.session);
    if placed.is_empty() {
        return 0;
    }
    let mut taken = HashSet::new();
    for (id, at) in &placed {
        let number = becomes.get(id).copied().flatten().unwrap_or(*id);
        if index.points().position(merge.into, number).is_none() && taken.insert(number) {
            changes.push(Change::PointSet(merge.into, number, merge.into_from_session.transform(at)));
        }
    }
    changes.push(Change::PointsForgotten(merge.session, placed.iter().map(|(id, _)| *id).collect()));
    placed.len()
}

/// Returns the younger of each pair of a keyframe that moved and a covisible one that was of the session already.
fn covisible_with_others(index: &MapIndex, moved: &[KeyframeSeq]) -> BTreeSet<KeyframeSeq> {
    let of_merge: HashSet<KeyframeSeq> = moved.iter().copied().collect();
    let pairs = moved.iter().flat_map(|keyframe| {
        let others = index.covisibility().neighbours(*keyframe).filter(|other| !of_merge.contains(other));
        others.map(|other| other.max(*keyframe)).collect::<Vec<_>>()
    });
    pairs.collect()
}

/// Takes the merge of a session back, by what it kept: the values that it replaced among them.
pub fn revoke_merge(index: &mut MapIndex, undo: MergeUndo, former: &FormerValues) -> Decided {
    let mut record = Recorder::keeping_former(index);
    let index = record.index();
    let mut changes = Vec::new();
    for (keyframe, detection, points) in &undo.detections {
        let anchor = index.fed_by((*keyframe, *detection));
        changes.extend(
            anchor.map(|anchor| Change::PointsOfDetectionSet(anchor, *keyframe, *detection, points.clone())),
        );
    }
    changes.extend(undo.points.iter().map(|points| Change::PointsOfKeyframeSet(Box::new(points.clone()))));
    changes.extend(former.poses.iter().map(|(keyframe, pose)| Change::PoseSet(*keyframe, *pose)));
    let brought: Box<[PointId]> = former.points.iter().map(|(_, id, _)| *id).collect();
    if !brought.is_empty() {
        changes.push(Change::PointsForgotten(undo.into, brought));
    }
    let back = former.forgotten.iter().map(|(session, id, at)| Change::PointSet(*session, *id, *at));
    changes.extend(back);
    let parted = undo.merges.iter().map(|(into, from)| Merge {
        into: *into,
        from: *from,
        cause: MergeCause::Covisible,
    });
    changes.extend(parted.map(Change::Parted));
    let anchors: BTreeSet<AnchorSeq> =
        undo.keyframes.iter().flat_map(|keyframe| index.anchors_seen_by(*keyframe)).collect();
    let name = |session: SessionSeq| index.sessions()[session.index()].clone();
    let event = told(EventKind::MergeRevoked, &name(undo.session), &name(undo.into));
    changes.push(Change::MergeRevoked(Box::new(undo)));
    record.touch(anchors);
    record.apply(changes);
    record.emit(event);
    record.finish()
}

/// Returns the merge of a session that can be revoked, if it is the one that this undoes.
pub fn is_open(index: &MapIndex, undo: &MergeUndo) -> bool {
    let open = OpenMerge { into: undo.into, next_keyframe: undo.next_keyframe };
    index.open_merges().of(undo.session) == Some(open)
}

#[cfg(test)]
mod tests;
