//! One frame for all sessions of a map: computed by the server that owns the map, and kept with its version.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use tokio::time::{Instant, sleep_until};

use super::named::no_keyframe_of_session;
use crate::domain::event::{Event, EventKind};
use crate::domain::fleet_frames::{FleetFrames, FramedSession, Suspect};
use crate::domain::ids::{LoopId, MapId, SessionId, SessionSeq};
use crate::domain::report::{FrameReport, FramesReport};
use crate::engine::limits::concurrency_limit::Wait;
use crate::engine::limits::shared_turns::Tenant;
use crate::engine::maps::live::{LiveMap, State};
use crate::engine::tasks::blocking;
use crate::engine::{Result, Service, ServiceError};
use crate::geometry::Pose;
use crate::recognition::frames::fleet::{fleet_frames, measured};
use crate::recognition::map::index::MapIndex;
use crate::store::Job;

/// Loops that must hold at both ends of a suspect before a server revokes it by itself.
const VOTES_MIN: usize = 2;

/// The rest in the background after frames were computed, in times of how long that took.
const REST: u32 = 10;

impl Service {
    /// Returns where the sessions of a map lie to a reference, by default the oldest of those that most sessions are joined with.
    pub async fn frames(&self, map: &MapId, reference: Option<SessionId>) -> Result<FramesReport> {
        let live = self.live(map).await?;
        let (version, frames) = self.current_frames(&live).await?;
        let named = move |index: &MapIndex| report(index, version, &frames, reference.as_ref());
        Ok(self.read(&live, move |state| named(&state.index)).await?.1)
    }

    /// Brings the frames of a map up to date in the background, after a loop was confirmed or revoked, with some rest between: loops that
    /// come meanwhile share the next time. Dropped under load: whoever reads them brings them up to date.
    pub(in crate::engine) fn frame_behind(&self, live: &Arc<LiveMap>) {
        if self.pressure.is_high() {
            return;
        }
        let (service, live) = (self.clone(), live.clone());
        if live.frames_due.swap(true, Ordering::AcqRel) {
            return;
        }
        tokio::spawn(async move {
            // By itself: the lock must not be held meanwhile.
            let rested = live.frames_checked.lock().await.rested;
            if let Some(rested) = rested {
                sleep_until(rested).await;
            }
            live.frames_due.store(false, Ordering::Release);
            let Some(_slot) = service.triggers.slot() else { return };
            // The map may be deleted by now, or thrown out of memory.
            let framed = async {
                let (_, frames) = service.current_frames(&live).await?;
                service.revoke_suspects(&live, &frames).await
            };
            if let Err(error) = framed.await {
                tracing::debug!(%error, "frames were not computed");
            }
        });
    }

    /// Revokes a loop that contradicts the others, where the map's settings say so. Then the frames are computed again.
    async fn revoke_suspects(&self, live: &Arc<LiveMap>, frames: &Arc<FleetFrames>) -> Result<()> {
        let is_set = |state: &State| Ok(state.index.properties().settings.revoke_suspects);
        if frames.suspects.is_empty() || !self.read(live, is_set).await?.1 {
            return Ok(());
        }
        let known = frames.clone();
        let first = move |state: &State| Ok(outvoted(&state.index, &known));
        // One at a time: without it the others may agree.
        let Some(id) = self.read(live, first).await?.1 else { return Ok(()) };
        match Box::pin(self.revoke_loop(&live.id, &id)).await {
            Ok(_) => tracing::info!(map = %live.id, %id, "a suspect was revoked"),
            // Its client was faster.
            Err(ServiceError::NotFound(_)) => {}
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// Returns the frames as they are kept, if they are still those of the map; else computes and keeps them, and tells of new suspects.
    /// Runs in a task of its own: a client that leaves must not unlock the frames while they are on their way to the disk.
    async fn current_frames(&self, live: &Arc<LiveMap>) -> Result<(u64, Arc<FleetFrames>)> {
        let (service, live) = (self.clone(), live.clone());
        let framing = async move { service.checked_frames(&live).await };
        tokio::spawn(framing).await.map_err(ServiceError::panicked)?
    }

    async fn checked_frames(&self, live: &Arc<LiveMap>) -> Result<(u64, Arc<FleetFrames>)> {
        let mut checked = live.frames_checked.lock().await;
        let kept = self.store.frames(live.key).await?;
        if let Some((version, frames)) = &kept
            && checked.version == live.newest_version()
        {
            return Ok((*version, Arc::new(frames.clone())));
        }
        // Nobody who writes waits for more than the reading.
        let (version, facts) = self.read(live, |state| Ok(measured(&state.index))).await?;
        let tenant = live.owner.map_or(Tenant::Map(live.key), Tenant::Key);
        let turn = self.reads.enter_after(tenant, Wait::UNBOUNDED).await?;
        let started = Instant::now();
        let computed = blocking(move || fleet_frames(&facts)).await?;
        drop(turn);
        checked.rested = Some(Instant::now() + REST * started.elapsed());
        if let Some((kept_at, frames)) = kept.as_ref().filter(|(_, frames)| *frames == computed) {
            checked.version = version;
            return Ok((*kept_at, Arc::new(frames.clone())));
        }
        let suspects = kept.iter().flat_map(|(_, frames)| &frames.suspects);
        let known: BTreeSet<&LoopId> = suspects.map(|suspect| &suspect.loop_id).collect();
        let new = computed.suspects.iter().filter(|suspect| !known.contains(&suspect.loop_id));
        let events: Vec<Event> = new.map(|suspect| suspected(suspect, version)).collect();
        let frames = Arc::new(computed);
        let job = Job::KeepFrames { map: live.key, version, frames: frames.clone() };
        if let Err(error) = self.store.committer().commit(job).await {
            // As on a full disk: reads go on, and the next one tries to keep them again.
            tracing::warn!(%error, "the frames of a map were not kept");
            return Ok((version, frames));
        }
        checked.version = version;
        if !events.is_empty() {
            live.tell(&self.store, events);
        }
        Ok((version, frames))
    }
}

/// Returns the first suspect that two loops or more speak against: where one stands against one, nobody can tell which is wrong.
fn outvoted(index: &MapIndex, frames: &FleetFrames) -> Option<LoopId> {
    let votes = |keyframe| {
        let session = index.keyframe(keyframe)?.session;
        let framed = frames.sessions.iter().find(|of| of.session == session)?;
        Some((framed.root, framed.loops))
    };
    let is_outvoted = |suspect: &&Suspect| {
        let Some(closed) = index.loops().get(&suspect.loop_id) else { return false };
        // Within one session the robot's own tracking speaks against it.
        let ends = votes(closed.keyframe).zip(votes(closed.candidate));
        suspect.cycle.is_empty()
            || ends.is_some_and(|(one, other)| one.0 == other.0 && one.1.min(other.1) >= VOTES_MIN)
    };
    frames.suspects.iter().find(is_outvoted).map(|suspect| suspect.loop_id.clone())
}

fn suspected(suspect: &Suspect, version: u64) -> Event {
    let mut event = Event::of(EventKind::LoopSuspected);
    event.map_version = version;
    event.loop_id = Some(suspect.loop_id.clone());
    let cycle: Vec<&str> = suspect.cycle.iter().map(LoopId::as_str).collect();
    let against = if cycle.is_empty() {
        "the robot's own tracking".to_owned()
    } else {
        format!("loops {}", cycle.join(", "))
    };
    event.detail = Some(format!("{:.1} m and {:.2} rad off from {against}", suspect.off_m, suspect.off_rad));
    event
}

fn report(
    index: &MapIndex,
    version: u64,
    frames: &FleetFrames,
    reference: Option<&SessionId>,
) -> Result<FramesReport> {
    let reference = match reference {
        Some(id) => Some(chosen(index, frames, id)?),
        None => default_reference(frames),
    };
    let name = |session: SessionSeq| index.sessions()[session.index()].clone();
    let place = |of: &FramedSession| -> Option<Pose> {
        let reference = reference.filter(|reference| reference.root == of.root)?;
        if reference.session == of.session {
            return Some(Pose::identity());
        }
        Some(reference.root_from_session.inverse().after(&of.root_from_session))
    };
    let frame = |of: &FramedSession| FrameReport {
        session: name(of.session),
        reference_from_session: place(of),
        residual_m: of.residual_m,
        loops: of.loops,
    };
    Ok(FramesReport {
        version,
        reference: reference.map(|of| name(of.session)),
        frames: frames.sessions.iter().map(frame).collect(),
        suspects: frames.suspects.clone(),
        loops: frames.loops,
        left_out: frames.left_out,
    })
}

fn chosen<'f>(index: &MapIndex, frames: &'f FleetFrames, id: &SessionId) -> Result<&'f FramedSession> {
    let session = index.session(id);
    let found = frames.sessions.iter().find(|of| Some(of.session) == session);
    found.ok_or_else(|| no_keyframe_of_session("?reference", id))
}

/// Returns the oldest session of those that most are joined with.
fn default_reference(frames: &FleetFrames) -> Option<&FramedSession> {
    let joined = |root: SessionSeq| frames.sessions.iter().filter(|of| of.root == root).count();
    let roots = frames.sessions.iter().filter(|of| of.root == of.session);
    roots.rev().max_by_key(|of| joined(of.session))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use tokio::time::Instant;

    use crate::domain::ids::MapId;
    use crate::domain::map::MapProperties;
    use crate::engine::{Service, ServiceOptions};

    #[tokio::test]
    async fn who_reads_frames_does_not_wait_for_the_rest_of_those_that_are_computed_behind() {
        let folder = tempfile::tempdir().unwrap();
        let database = format!("sqlite://{}/test.db", folder.path().display());
        let service = Service::open(ServiceOptions::for_tests(database)).await.unwrap();
        let map: MapId = "hotel".parse().unwrap();
        service.put_map(map.clone(), MapProperties::default(), None).await.unwrap();
        let live = service.live(&map).await.unwrap();
        live.frames_checked.lock().await.rested = Some(Instant::now() + Duration::from_hours(1));
        service.frame_behind(&live);
        // It begins to rest.
        tokio::task::yield_now().await;
        let read = tokio::time::timeout(Duration::from_mins(1), service.frames(&map, None));
        read.await.expect("an answer at once").unwrap();
        service.close().await;
    }
}
