//! Corrected poses and map points, after the client's own optimisation.

use super::named::{keyframe_of_session, session_of_body};
use crate::domain::ids::MapId;
use crate::domain::request::PoseCorrection;
use crate::engine::error::refuse;
use crate::engine::limits::quota::check_points;
use crate::engine::maps::live::Decision;
use crate::engine::{Result, Service};
use crate::recognition::map::correction::{Correction, correct};
use crate::recognition::map::index::MapIndex;

impl Service {
    /// Applies a correction, all of it or nothing; anchors' boxes follow.
    pub async fn correct_poses(&self, map: &MapId, correction: PoseCorrection) -> Result<u64> {
        let live = self.live(map).await?;
        let room = self.room(live.owner).await?;
        let decide = move |index: &mut MapIndex| {
            let session = session_of_body(index, &correction.session)?;
            let mut errors = Vec::new();
            let mut poses = Vec::new();
            for (number, (id, pose)) in correction.keyframes.iter().enumerate() {
                match keyframe_of_session(index, session, id, || format!("/keyframes/ids/{number}")) {
                    Ok(keyframe) => poses.push((keyframe, *pose)),
                    Err(fault) => errors.push(fault),
                }
            }
            refuse(errors)?;
            check_points(&room, index, session, &correction.map_points)?;
            let correction = Correction { poses, map_points: correction.map_points };
            Ok(Decision::Changed((), correct(index, session, &correction), None))
        };
        Ok(self.change(&live, decide).await?.1)
    }
}
