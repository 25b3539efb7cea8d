//! Corrections: what the client's map did to poses, points and edges after it had sent the keyframes.

use super::named::{keyframe_of_session, no_keyframe_of_map, session_of_body};
use crate::domain::change::{KeyframeUpdate, ObservationUpdate};
use crate::domain::ids::{KeyframeSeq, MapId, SessionSeq};
use crate::domain::invalid::FieldError;
use crate::domain::request::{ChangedKeyframe, ChangedObservations, PoseCorrection};
use crate::engine::error::refuse;
use crate::engine::limits::quota::{check_observations, check_points};
use crate::engine::maps::live::Decision;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::anchors::observations::{
    CHANGED_PAIRS_MAX, ObservationsChanged, TooManyPairs, change_observations, keyframes_of,
};
use crate::recognition::map::correction::{Correction, correct};
use crate::recognition::map::index::MapIndex;

/// Keyframes of which one request may change what they observe: each is a row, and all are written in one transaction.
pub const CHANGED_KEYFRAMES_MAX: usize = 10_000;

/// The effect of changed observations, or of a merge of sessions, on a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChangedCounts {
    /// Keyframes that observe other points now, or have other declared neighbours; or that moved.
    pub keyframes: usize,
    /// Map points that are gone, fused or culled; or that moved.
    pub map_points: usize,
    /// Anchors that turned out to be one with another.
    pub merged: usize,
}

impl Service {
    /// Applies what the client's map did, all of it or nothing; covisibility, anchors and association follow.
    pub async fn change_observations(
        &self,
        map: &MapId,
        changed: ChangedObservations,
    ) -> Result<(ChangedCounts, u64)> {
        let live = self.live(map).await?;
        let room = self.room(live.owner).await?;
        let decide = move |index: &mut MapIndex| {
            let session = session_of_body(index, &changed.session)?;
            let update = by_number(index, session, changed)?;
            let count = keyframes_of(index, &update).len();
            if count > CHANGED_KEYFRAMES_MAX {
                let detail = format!("{count} keyframes observe these map points; send them in parts");
                let limit = format!("{CHANGED_KEYFRAMES_MAX} keyframes");
                return Err(FieldError::new("/replaced", detail).limit(limit).into());
            }
            check_observations(&room, index, &update)?;
            let changed = change_observations(index, update).map_err(too_many_pairs)?;
            let ObservationsChanged { keyframes, map_points, merged, decided } = changed;
            Ok(Decision::Changed(ChangedCounts { keyframes, map_points, merged }, decided, None))
        };
        self.change(&live, decide).await
    }

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

fn too_many_pairs(TooManyPairs(pairs): TooManyPairs) -> ServiceError {
    let detail = "these changes concern too many pairs of keyframes that observe the same map points; send them in parts";
    let fault = FieldError::new("/replaced", detail).got(format!("{pairs} pairs"));
    fault.limit(format!("{CHANGED_PAIRS_MAX} pairs")).into()
}

/// Finds the keyframes of a request, or every one that is not there.
fn by_number(
    index: &MapIndex,
    session: SessionSeq,
    changed: ChangedObservations,
) -> Result<ObservationUpdate> {
    let mut errors = Vec::new();
    let mut keyframes = Vec::with_capacity(changed.keyframes.len());
    for (number, ChangedKeyframe { keyframe: id, observes, covisible }) in
        changed.keyframes.into_iter().enumerate()
    {
        let own = keyframe_of_session(index, session, &id, || format!("/keyframes/{number}/keyframe"));
        let own = own.map_err(|fault| errors.push(fault)).ok();
        let mut others: Vec<(KeyframeSeq, u32)> = Vec::with_capacity(covisible.len());
        for (place, (other, shared)) in covisible.iter().enumerate() {
            match index.keyframe_seq(other) {
                Some(seq) => others.push((seq, *shared)),
                None => errors.push(no_keyframe_of_map(
                    format!("/keyframes/{number}/covisible/{place}/keyframe"),
                    other,
                )),
            }
        }
        keyframes.extend(own.map(|keyframe| KeyframeUpdate { keyframe, observes, covisible: others }));
    }
    refuse(errors)?;
    Ok(ObservationUpdate { session, replaced: changed.replaced, removed: changed.removed, keyframes })
}
