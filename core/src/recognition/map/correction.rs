//! The client has optimised its map: poses and map points move, anchors' boxes follow.

use std::collections::HashSet;

use super::index::MapIndex;
use super::recorder::{Decided, Recorder};
use crate::domain::anchor::Observation;
use crate::domain::change::Change;
use crate::domain::counted::counted;
use crate::domain::event::{Event, EventKind};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, PointId, SessionSeq};
use crate::geometry::{Point3, Pose};

/// Corrected poses and map points of one session, by dense number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correction {
    /// The keyframes and their new `map_from_camera`.
    pub poses: Vec<(KeyframeSeq, Pose)>,
    /// The map points and their new positions, in the session's frame.
    pub map_points: Vec<(PointId, Point3)>,
}

/// Applies a correction.
pub fn correct(index: &mut MapIndex, session: SessionSeq, correction: &Correction) -> Decided {
    let mut record = Recorder::new(index);
    let mut changes = Vec::new();
    for (keyframe, pose) in &correction.poses {
        changes.extend(moved_positions(record.index(), *keyframe, pose));
        changes.push(Change::PoseSet(*keyframe, *pose));
    }
    let points = correction.map_points.iter();
    changes.extend(points.map(|(id, position)| Change::PointSet(session, *id, *position)));
    record.touch(touched(record.index(), session, correction, &changes));
    record.apply(changes);
    let mut event = Event::of(EventKind::PosesCorrected);
    event.session = record.index().sessions().get(session.index()).cloned();
    let [poses, points] = [correction.poses.len(), correction.map_points.len()];
    event.detail = Some(format!("{}, {}", counted(poses, "keyframe"), counted(points, "map point")));
    record.emit(event);
    record.finish()
}

/// Returns an observation known by its `position` alone moves rigidly with its keyframe: what the camera saw does not
/// change.
fn moved_positions(index: &MapIndex, keyframe: KeyframeSeq, now: &Pose) -> Vec<Change> {
    let Some(before) = index.keyframe(keyframe).map(|keyframe| keyframe.map_from_camera) else {
        return Vec::new();
    };
    if before == *now {
        return Vec::new();
    }
    let moved = |(anchor, seen): (AnchorSeq, &Observation)| {
        let moved = now.transform(&before.inverse_transform(&seen.position_in_session?));
        Some(Change::PositionSet(anchor, keyframe, seen.detection, moved))
    };
    index.detections_of(keyframe).filter_map(moved).collect()
}

/// Returns the anchors of which a position or a map point moves.
fn touched(
    index: &MapIndex,
    session: SessionSeq,
    correction: &Correction,
    changes: &[Change],
) -> HashSet<AnchorSeq> {
    let mut touched: HashSet<AnchorSeq> = changes
        .iter()
        .filter_map(|change| match change {
            Change::PositionSet(anchor, ..) => Some(*anchor),
            _ => None,
        })
        .collect();
    let moved = correction.map_points.iter();
    touched.extend(moved.flat_map(|(id, _)| index.holders().of(session, *id)));
    touched
}
