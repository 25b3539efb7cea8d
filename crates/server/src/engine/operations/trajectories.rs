//! Trajectories: the poses of a map's sessions, read for tools that compare and optimise them.

use std::collections::HashSet;

use super::named::find_session;
use crate::domain::change::{Keyframe, Loop};
use crate::domain::ids::{KeyframeId, MapId, SessionId, SessionSeq};
use crate::domain::trajectory::{SessionTrack, TrackedPose, TrajectoryReport};
use crate::engine::maps::live::State;
use crate::engine::{Result, Service};
use crate::recognition::map::index::MapIndex;

impl Service {
    /// Returns the trajectories of a map, or of one of its sessions with the loops within it.
    pub async fn trajectory(&self, map: &MapId, session: Option<SessionId>) -> Result<TrajectoryReport> {
        let live = self.live(map).await?;
        let look = move |state: &State| {
            let only = session.as_ref().map(|id| find_session(&state.index, id)).transpose()?;
            Ok((tracks(&state.index, only), loops(&state.index, only)))
        };
        let (map_version, (sessions, loops)) = self.read(&live, look).await?;
        Ok(TrajectoryReport { map_version, sessions, loops, is_in_one_frame: false, unjoined: Vec::new() })
    }

    /// Returns the same in the frame of one session; sessions that nothing joins with it are named instead.
    pub async fn trajectory_of_fleet(
        &self,
        map: &MapId,
        session: Option<SessionId>,
        reference: Option<SessionId>,
    ) -> Result<TrajectoryReport> {
        let frames = self.frames(map, reference).await?;
        let mut report = self.trajectory(map, session).await?;
        let mut unjoined = Vec::new();
        report.sessions.retain_mut(|track| {
            let frame = frames.frames.iter().find(|frame| frame.session == track.session);
            let Some(reference_from_session) = frame.and_then(|frame| frame.reference_from_session) else {
                unjoined.push(track.session.clone());
                return false;
            };
            for pose in &mut track.keyframes {
                pose.map_from_camera = reference_from_session.after(&pose.map_from_camera);
            }
            true
        });
        let there: HashSet<&KeyframeId> =
            report.sessions.iter().flat_map(|track| &track.keyframes).map(|pose| &pose.keyframe).collect();
        report.loops.retain(|of| there.contains(&of.keyframe_id) && there.contains(&of.candidate_id));
        Ok(TrajectoryReport { is_in_one_frame: true, unjoined, ..report })
    }
}

fn tracks(index: &MapIndex, only: Option<SessionSeq>) -> Vec<SessionTrack> {
    let mut by_session: Vec<Vec<&Keyframe>> = vec![Vec::new(); index.sessions().len()];
    for keyframe in index.keyframes().filter(|keyframe| only.is_none_or(|only| keyframe.session == only)) {
        by_session[keyframe.session.index()].push(keyframe);
    }
    let mut tracks = Vec::new();
    for (session, mut keyframes) in index.sessions().iter().zip(by_session) {
        // Robots may send late what they saw early. The sort keeps the order of arrival within one stamp.
        keyframes.sort_by_key(|keyframe| (keyframe.stamp.sec, keyframe.stamp.nanosec));
        if !keyframes.is_empty() {
            let keyframes = keyframes.into_iter().map(pose).collect();
            tracks.push(SessionTrack { session: session.clone(), keyframes });
        }
    }
    tracks
}

fn pose(keyframe: &Keyframe) -> TrackedPose {
    TrackedPose {
        keyframe: keyframe.id.clone(),
        stamp: keyframe.stamp,
        map_from_camera: keyframe.map_from_camera,
    }
}

/// Returns the loops whose two keyframes are there, and of one session if only that was asked for.
fn loops(index: &MapIndex, only: Option<SessionSeq>) -> Vec<Loop> {
    let is_there =
        |seq| index.keyframe(seq).is_some_and(|keyframe| only.is_none_or(|only| keyframe.session == only));
    let closed = index.loops().values();
    closed.filter(|closed| is_there(closed.keyframe) && is_there(closed.candidate)).cloned().collect()
}
