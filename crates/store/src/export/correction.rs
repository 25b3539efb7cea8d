//! Corrections as they were sent, and one of what was set while the map kept no history.

use std::collections::BTreeMap;

use revisit_core::domain::change::Change;
use revisit_core::domain::ids::{KeyframeSeq, PointId, SessionSeq};
use revisit_core::domain::recorded::Recorded;
use revisit_core::domain::request::PoseCorrection;
use revisit_core::geometry::{Point3, Pose};

use super::history::Untold;
use super::operation_reader::{Export, Step};
use crate::StoreError;

/// Values of one correction that an export adds.
const CORRECTED_AT_ONCE: usize = 10_000;

impl Export {
    /// Begins with what a version said: poses and points that it set are a correction, unless it says them itself.
    pub(super) async fn reach(
        &mut self,
        changes: Vec<Change>,
        is_keyframe: bool,
    ) -> Result<Step, StoreError> {
        // A keyframe says its own points, what changes observations moves none, and a merge says how it moves them.
        let says = |change: &Change| {
            matches!(
                change,
                Change::ObservationsSent(_) | Change::SessionsMerged(_) | Change::MergeRevoked(_)
            )
        };
        let says_itself = is_keyframe || changes.iter().any(says);
        let (mut poses, mut points) = (Vec::new(), Vec::new());
        for change in changes {
            match change {
                Change::PoseSet(keyframe, pose) => poses.push((keyframe, pose.without_scale())),
                Change::PointSet(session, id, at) => points.push((session, id, at)),
                change => self.changes.push_back(change),
            }
        }
        if says_itself { Ok(Step::LeftOut) } else { self.correction(poses, points).await }
    }

    /// Ends with one more correction of each session whose poses or points were set while the map kept no history.
    pub(super) async fn last_correction(&mut self) -> Result<Step, StoreError> {
        if self.history.is_whole {
            return Ok(Step::End);
        }
        self.history.is_whole = true;
        let mut of_sessions: BTreeMap<SessionSeq, Vec<Untold>> = BTreeMap::new();
        for untold in self.history.untold(&mut self.db).await? {
            let session = match &untold {
                Untold::Pose(keyframe, _) => self.named(*keyframe).await?.map(|(session, _)| session),
                Untold::Point(session, ..) => Some(*session),
            };
            of_sessions.entry(session.unwrap_or(SessionSeq(0))).or_default().push(untold);
        }
        for untold in of_sessions.into_values() {
            for some in untold.chunks(CORRECTED_AT_ONCE) {
                let pose = |untold: &Untold| match untold {
                    Untold::Pose(keyframe, pose) => Some((*keyframe, *pose)),
                    Untold::Point(..) => None,
                };
                let point = |untold: &Untold| match untold {
                    Untold::Point(session, id, at) => Some((*session, *id, *at)),
                    Untold::Pose(..) => None,
                };
                let poses = some.iter().filter_map(pose).collect();
                let points = some.iter().filter_map(point).collect();
                if let Step::Operation(correction) = self.correction(poses, points).await? {
                    self.pending.push_back(*correction);
                }
            }
        }
        Ok(Step::LeftOut)
    }

    /// Returns the keyframes and points of a correction that are still there.
    async fn correction(
        &mut self,
        poses: Vec<(KeyframeSeq, Pose)>,
        points: Vec<(SessionSeq, PointId, Point3)>,
    ) -> Result<Step, StoreError> {
        let mut session = points.first().map(|(session, ..)| *session);
        let mut keyframes = Vec::with_capacity(poses.len());
        for (keyframe, pose) in poses {
            if let Some((of, id)) = self.named(keyframe).await? {
                session = Some(of);
                keyframes.push((id, pose));
            }
        }
        let map_points: Vec<_> = points.into_iter().map(|(_, id, at)| (id, at)).collect();
        let Some(session) = session.filter(|session| self.begun.contains(session)) else {
            return Ok(Step::LeftOut);
        };
        if keyframes.is_empty() && map_points.is_empty() {
            return Ok(Step::LeftOut);
        }
        self.introduced.add(session, map_points.iter().map(|(id, _)| *id));
        let session = self.session(session)?.clone();
        Ok(Step::of(Recorded::Poses(PoseCorrection { session, keyframes, map_points })))
    }
}
