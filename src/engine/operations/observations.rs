//! Observations that change: what the client's map did to points and edges after it had sent the keyframes.

use crate::domain::change::{KeyframeUpdate, ObservationUpdate};
use crate::domain::ids::{KeyframeId, KeyframeSeq, MapId, SessionSeq};
use crate::domain::invalid::FieldError;
use crate::domain::request::{ChangedKeyframe, ChangedObservations};
use crate::engine::limits::quota::check_observations;
use crate::engine::maps::live::Decision;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::anchors::observations::{
    CHANGED_PAIRS_MAX, TooManyPairs, change_observations, keyframes_of,
};
use crate::recognition::map::index::MapIndex;

/// Keyframes of which one request may change what they observe: each is a row, and all are written in one transaction.
pub const CHANGED_KEYFRAMES_MAX: usize = 10_000;

/// The effect of changed observations on a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChangedCounts {
    /// Keyframes that observe other points now, or have other declared neighbours.
    pub keyframes: usize,
    /// Map points that are gone, fused or culled.
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
            let session = index.session(&changed.session).ok_or_else(|| {
                let detail = "no keyframe of this session is in the map";
                ServiceError::Invalid(vec![FieldError::new("/session", detail).got(&changed.session)])
            })?;
            let update = by_number(index, session, changed).map_err(ServiceError::Invalid)?;
            let count = keyframes_of(index, &update).len();
            if count > CHANGED_KEYFRAMES_MAX {
                let detail = format!("{count} keyframes observe these map points; send them in parts");
                let limit = format!("{CHANGED_KEYFRAMES_MAX} keyframes");
                return Err(ServiceError::Invalid(vec![FieldError::new("/replaced", detail).limit(limit)]));
            }
            check_observations(&room, index, &update)?;
            let changed = change_observations(index, update).map_err(too_many_pairs)?;
            let counts = ChangedCounts {
                keyframes: changed.keyframes,
                map_points: changed.map_points,
                merged: changed.merged,
            };
            Ok(Decision::Changed(counts, changed.decided, None))
        };
        self.change(&live, decide).await
    }
}

fn too_many_pairs(TooManyPairs(pairs): TooManyPairs) -> ServiceError {
    let detail = "these changes concern too many pairs of keyframes that observe the same map points; send them in parts";
    let fault = FieldError::new("/replaced", detail).got(format!("{pairs} pairs"));
    ServiceError::Invalid(vec![fault.limit(format!("{CHANGED_PAIRS_MAX} pairs"))])
}

/// Finds the keyframes of a request, or every one that is not there.
fn by_number(
    index: &MapIndex,
    session: SessionSeq,
    changed: ChangedObservations,
) -> Result<ObservationUpdate, Vec<FieldError>> {
    let mut errors = Vec::new();
    let mut keyframes = Vec::with_capacity(changed.keyframes.len());
    for (number, ChangedKeyframe { keyframe: id, observes, covisible }) in
        changed.keyframes.into_iter().enumerate()
    {
        let known = index.keyframe_seq(&id).and_then(|seq| index.keyframe(seq));
        let own = known.filter(|keyframe| keyframe.session == session).map(|keyframe| keyframe.seq);
        if own.is_none() {
            let pointer = format!("/keyframes/{number}/keyframe");
            errors.push(FieldError::new(pointer, "there is no such keyframe in this session").got(&id));
        }
        let mut others: Vec<(KeyframeSeq, u32)> = Vec::with_capacity(covisible.len());
        for (place, (other, shared)) in covisible.iter().enumerate() {
            let other: &KeyframeId = other;
            match index.keyframe_seq(other) {
                Some(seq) => others.push((seq, *shared)),
                None => errors.push(
                    FieldError::new(
                        format!("/keyframes/{number}/covisible/{place}/keyframe"),
                        "there is no such keyframe in the map",
                    )
                    .got(other),
                ),
            }
        }
        keyframes.extend(own.map(|keyframe| KeyframeUpdate { keyframe, observes, covisible: others }));
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    Ok(ObservationUpdate { session, replaced: changed.replaced, removed: changed.removed, keyframes })
}
