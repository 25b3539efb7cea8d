//! Quota: does what a request brings fit into its map, and into what the key that made the map may hold?

use std::time::Duration;

use moka::sync::Cache;

use crate::config::quotas::Quotas;
use crate::domain::change::{KeyframeUpdate, ObservationUpdate};
use crate::domain::ids::{KeyframeSeq, PointId, SessionSeq};
use crate::domain::key::KeySeq;
use crate::domain::keyframe::NewKeyframe;
use crate::domain::prior::NewPrior;
use crate::domain::session_merge::{Renumbering, SessionMergeRequest};
use crate::engine::{Result, ServiceError};
use crate::geometry::Point3;
use crate::recognition::map::index::{MapIndex, POINT_BYTES};
use crate::store::Store;

/// Keys whose bytes are remembered.
const REMEMBERED: u64 = 10_000;

/// The time for which the bytes of a key's maps are remembered: it may hold more than its limit by what it writes meanwhile.
const LASTS: Duration = Duration::from_secs(1);

/// The limits within which a map may grow.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct Room {
    /// Of each map.
    pub quotas: Quotas,
    /// Of all maps that the key made which made this one, if it has a limit.
    pub of_key: Option<KeyRoom>,
}

/// The bytes that the maps of a key hold, with their releases, and may hold.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct KeyRoom {
    /// Bytes that they hold.
    pub holds: u64,
    /// Bytes that they may hold.
    pub most: u64,
}

impl KeyRoom {
    /// Refuses what would take them beyond the limit.
    pub fn check(self, more: u64) -> Result<()> {
        if self.holds.saturating_add(more) <= self.most {
            return Ok(());
        }
        Err(ServiceError::MapFull(format!(
            "the maps of the key that made this one hold {} bytes with their releases, and may hold {}; delete some, or ask the \
             operator",
            self.holds, self.most
        )))
    }
}

/// The bytes of the maps that each key made, as they were on disk a moment ago.
#[derive(Clone, Debug)]
pub(in crate::engine) struct KeyBytes(Cache<KeySeq, u64>);

impl Default for KeyBytes {
    fn default() -> Self {
        Self(Cache::builder().max_capacity(REMEMBERED).time_to_live(LASTS).build())
    }
}

impl KeyBytes {
    /// Returns the bytes of the maps that a key made, with their releases.
    pub async fn of(&self, store: &Store, key: KeySeq) -> Result<u64> {
        if let Some(known) = self.0.get(&key) {
            return Ok(known);
        }
        let bytes = store.made_by(key).await?.bytes;
        self.0.insert(key, bytes);
        Ok(bytes)
    }
}

/// Refuses a keyframe that would take its map beyond a quota.
pub(in crate::engine) fn check_keyframe(room: &Room, index: &MapIndex, keyframe: &NewKeyframe) -> Result<()> {
    fits(room.quotas.map_max_keyframes, "keyframes", index.keyframe_count() as u64, 1)?;
    if !keyframe.detections.is_empty() {
        fits(room.quotas.map_max_anchors, "anchors", index.objects().len() as u64, 1)?;
    }
    let session = index.session(&keyframe.session);
    let of_session = session.map_or(keyframe.session.as_str().len() as u64, |_| 0);
    check_bytes(room, index, keyframe.bytes() + of_session + new_points(index, session, &keyframe.map_points))
}

/// Refuses map points that are new and would take their map beyond its quota; moving those it has goes on.
pub(in crate::engine) fn check_points(
    room: &Room,
    index: &MapIndex,
    session: SessionSeq,
    points: &[(PointId, Point3)],
) -> Result<()> {
    check_bytes(room, index, new_points(index, Some(session), points))
}

/// Refuses lists of points and edges that would take their map beyond its quota. Those that are shorter than before are taken.
pub(in crate::engine) fn check_observations(
    room: &Room,
    index: &MapIndex,
    update: &ObservationUpdate,
) -> Result<()> {
    let more = |of: &KeyframeUpdate| {
        let known = index.keyframe(of.keyframe).map_or(0, |known| known.observes.len());
        of.observes.as_ref().map_or(0, |list| list.len().saturating_sub(known)) + of.covisible.len()
    };
    let numbers: usize = update.keyframes.iter().map(more).sum();
    check_bytes(room, index, (numbers * size_of::<PointId>()) as u64)
}

/// Refuses a merge of sessions that would take its map beyond a quota: other numbers of map points are kept beside those sent.
pub(in crate::engine) fn check_merge(
    room: &Room,
    index: &MapIndex,
    request: &SessionMergeRequest,
    keyframes: &[KeyframeSeq],
) -> Result<()> {
    if request.map_points == Renumbering::Same {
        return Ok(());
    }
    let observed = keyframes.iter().filter_map(|seq| index.keyframe(*seq)).map(|of| of.observes.len());
    check_bytes(room, index, (2 * observed.sum::<usize>() * size_of::<PointId>()) as u64)
}

/// Refuses a prior anchor that would take its map beyond a quota.
pub(in crate::engine) fn check_prior(room: &Room, index: &MapIndex, prior: &NewPrior) -> Result<()> {
    fits(room.quotas.map_max_anchors, "anchors", index.objects().len() as u64, 1)?;
    let of_frame = index.session(&prior.frame).map_or(prior.frame.as_str().len() as u64, |_| 0);
    check_bytes(room, index, prior.bytes() + of_frame)
}

/// Refuses a release that would take its map, with the bytes of those that it has, beyond a quota: each is a copy.
pub(in crate::engine) fn check_release(room: &Room, index: &MapIndex, of_releases: u64) -> Result<()> {
    let (bytes, with_releases) = (index.bytes(), index.bytes() + of_releases);
    fits(room.quotas.map_max_bytes, "bytes with its releases", with_releases, bytes)?;
    room.of_key.map_or(Ok(()), |of_key| of_key.check(bytes))
}

/// Refuses what would take a map beyond its quota, in bytes.
pub(in crate::engine) fn check_bytes(room: &Room, index: &MapIndex, more: u64) -> Result<()> {
    if more == 0 {
        return Ok(());
    }
    fits(room.quotas.map_max_bytes, "bytes", index.bytes(), more)?;
    room.of_key.map_or(Ok(()), |of_key| of_key.check(more))
}

/// Returns what the points that have no position yet will take, in bytes.
fn new_points(index: &MapIndex, session: Option<SessionSeq>, points: &[(PointId, Point3)]) -> u64 {
    let is_known = |id| session.is_some_and(|session| index.points().position(session, id).is_some());
    points.iter().filter(|(id, _)| !is_known(*id)).count() as u64 * POINT_BYTES
}

fn fits(quota: Option<u64>, what: &str, holds: u64, more: u64) -> Result<()> {
    let Some(most) = quota.filter(|most| holds + more > *most) else { return Ok(()) };
    Err(ServiceError::MapFull(format!(
        "the map holds {holds} {what}, and may hold {most}; delete some, or ask the operator"
    )))
}
