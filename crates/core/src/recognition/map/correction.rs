//! The client has optimised its map: poses and map points move, anchors' boxes follow.

use std::collections::HashSet;

use super::index::MapIndex;
use super::recorder::{Decided, Recorder};
use crate::domain::change::Change;
use crate::domain::counted::counted;
use crate::domain::event::{Event, EventKind};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, PointId, SessionSeq};
use crate::geometry::{Point3, Pose, Sim3};

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
    let scale = |keyframe| record.index().keyframe(keyframe).map_or(1.0, |keyframe| keyframe.scale);
    changes.extend(
        correction.poses.iter().map(|(seq, pose)| Change::PoseSet(*seq, Sim3::scaled(*pose, scale(*seq)))),
    );
    let points = correction.map_points.iter();
    changes.extend(points.map(|(id, position)| Change::PointSet(session, *id, *position)));
    record.touch(touched(record.index(), session, correction));
    record.apply(changes);
    let mut event = Event::of(EventKind::PosesCorrected);
    event.session = record.index().sessions().get(session.index()).cloned();
    let [poses, points] = [correction.poses.len(), correction.map_points.len()];
    event.detail = Some(format!("{}, {}", counted(poses, "keyframe"), counted(points, "map point")));
    record.emit(event);
    record.finish()
}

/// Returns the anchors of which a position or a map point moves.
fn touched(index: &MapIndex, session: SessionSeq, correction: &Correction) -> HashSet<AnchorSeq> {
    let is_moved = |seq: &KeyframeSeq, pose: &Pose| {
        index.keyframe(*seq).is_some_and(|keyframe| keyframe.map_from_camera != *pose)
    };
    let moved = correction.poses.iter().filter(|(seq, pose)| is_moved(seq, pose));
    let mut touched: HashSet<AnchorSeq> = moved.flat_map(|(seq, _)| index.anchors_placed_by(*seq)).collect();
    let moved = correction.map_points.iter();
    touched.extend(moved.flat_map(|(id, _)| index.holders().of(session, *id)));
    touched
}
