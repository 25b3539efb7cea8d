//! Corrected poses and map points, after the client's own optimisation.

use crate::domain::ids::MapId;
use crate::domain::invalid::FieldError;
use crate::domain::request::PoseCorrection;
use crate::engine::limits::quota::check_points;
use crate::engine::maps::live::Decision;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::map::correction::{Correction, correct};
use crate::recognition::map::index::MapIndex;

impl Service {
    /// Applies a correction, all of it or nothing; anchors' boxes follow.
    pub async fn correct_poses(&self, map: &MapId, correction: PoseCorrection) -> Result<u64> {
        let live = self.live(map).await?;
        let room = self.room(live.owner).await?;
        let decide = move |index: &mut MapIndex| {
            let session = index.session(&correction.session).ok_or_else(|| {
                let detail = "no keyframe of this session is in the map";
                ServiceError::Invalid(vec![FieldError::new("/session", detail).got(&correction.session)])
            })?;
            let mut errors = Vec::new();
            let mut poses = Vec::new();
            for (number, (id, pose)) in correction.keyframes.iter().enumerate() {
                let known = index.keyframe_seq(id).and_then(|seq| index.keyframe(seq));
                match known.filter(|keyframe| keyframe.session == session) {
                    Some(keyframe) => poses.push((keyframe.seq, *pose)),
                    None => errors.push(
                        FieldError::new(
                            format!("/keyframes/ids/{number}"),
                            "there is no such keyframe in this session",
                        )
                        .got(id),
                    ),
                }
            }
            if !errors.is_empty() {
                return Err(ServiceError::Invalid(errors));
            }
            check_points(&room, index, session, &correction.map_points)?;
            let correction = Correction { poses, map_points: correction.map_points };
            Ok(Decision::Changed((), correct(index, session, &correction), None))
        };
        Ok(self.change(&live, decide).await?.1)
    }
}
