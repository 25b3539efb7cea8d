//! Erasures: keyframes leave their map, its releases and the disk for good. A job for each, one at a time, which survives restarts.
//!
//! 1. The keyframes are deleted from the map and from each release, with the loops that name them.
//! 2. What rows still say of them is removed ([`crate::store`], traces), and the maps are loaded anew.
//! 3. The database's file is written anew, and its log is cut to nothing. All writes wait for that, so it takes a hundredth of the time
//!    at most: what is asked for before the next time shares it.
//!
//! A step that fails is tried again; a step that is repeated does no harm.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Duration;

use tokio::runtime::Handle;
use tokio::time::{Instant, sleep, sleep_until};

use crate::domain::change::{Change, Keyframe, Loop};
use crate::domain::erasure::{Erasure, MergedInVersion, NewErasure, with_merged};
use crate::domain::ids::{BackupId, KeyframeId, KeyframeSeq, LoopId, MapId, PointId, SessionId};
use crate::domain::invalid::FieldError;
use crate::engine::error::refuse;
use crate::engine::keys::keyring::now;
use crate::engine::maps::live::{Decision, LiveMap, State};
use crate::engine::maps::write_path::Manner;
use crate::engine::tasks::blocking_part;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::anchors::loop_closure::revoke_loop;
use crate::recognition::map::culling::cull_keyframe;
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::recorder::{Decided, Recorder};
use crate::store::{ErasureStep, Job, MapKey, OpenErasure, StoreError};

/// A failed attempt is repeated after this time, and after twice as long the next time, ...
const RETRY_FIRST: Duration = Duration::from_secs(1);

/// ... up to this.
const RETRY_LAST: Duration = Duration::from_mins(10);

/// The time after which it is looked again whether older versions are read still, or changes wait for their rows.
const LOOK_AGAIN: Duration = Duration::from_millis(100);

/// The rest after the file was written anew, in times of how long that took: who erases often delays one write of others in a hundred.
const REST: u32 = 100;

/// After what took less there is none: others hardly notice it.
const UNNOTICED: Duration = Duration::from_millis(100);

/// Keyframes that one look finds.
const FOUND_AT_ONCE: usize = 1000;

impl Service {
    /// Asks for an erasure, which begins at once in the background. What is asked for is on disk when this returns.
    pub async fn erase(&self, map: &MapId, asked: NewErasure) -> Result<Erasure> {
        let _owned = self.own(map).await?;
        let key = self.key_of(map).await?;
        let asked = match asked {
            NewErasure::Sessions(sessions) => {
                NewErasure::Sessions(self.whole_sessions(key, &sessions).await?)
            }
            keyframes @ NewErasure::Keyframes(_) => keyframes,
        };
        let number = {
            let _asking = self.asking.lock().await;
            let number = self.store.next_erasure(key).await?;
            let job = Job::Erase(key, number, ErasureStep::Begin(asked, now()));
            self.store.committer().commit(job).await?;
            number
        };
        tracing::info!(%map, number, "an erasure was asked for");
        self.erase_in_background();
        self.erasure_of(map, key, number).await
    }

    /// Returns sessions with all that merged into them in any version of the map. Refuses those that are a part of another one in any:
    /// there they cannot be told from it. Refuses the frame of a plan, too.
    async fn whole_sessions(&self, map: MapKey, sessions: &[SessionId]) -> Result<Vec<SessionId>> {
        let merges = self.store.merges_of_versions(map).await?;
        let all = with_merged(sessions, &merges);
        let mut faults = BTreeMap::new();
        for MergedInVersion { release, session, into } in &merges {
            let Some(at) = all.get(session).filter(|_| !all.contains_key(into)) else { continue };
            let (place, cure) = match release {
                None => (String::from("by now"), ""),
                Some(release) => (format!("in release {release}"), ", or delete the release"),
            };
            let detail = format!("session {session} is a part of session {into} {place}");
            let fault = FieldError::new(format!("/sessions/{at}"), detail).got(&sessions[*at]);
            let limit = format!("{into}, which is erased with what merged into it{cure}");
            faults.entry(*at).or_insert_with(|| fault.limit(limit));
        }
        for (release, session) in self.store.frames_of_plans(map).await? {
            let Some(at) = all.get(&session) else { continue };
            let place = release.map_or_else(String::new, |release| format!(" in release {release}"));
            let detail = format!("prior anchors{place} have their places in the frame of session {session}");
            let fault = FieldError::new(format!("/sessions/{at}"), detail).got(&sessions[*at]);
            let limit =
                "a session without prior anchors: delete these, and the release that has some, before";
            faults.entry(*at).or_insert_with(|| fault.limit(limit));
        }
        refuse(faults.into_values().collect())?;
        Ok(all.into_keys().cloned().collect())
    }

    /// Returns an erasure, and the backups that were taken before it was done: they still hold what it erased.
    pub async fn erasure(&self, map: &MapId, number: u64) -> Result<(Erasure, Vec<BackupId>)> {
        let erasure = self.erasure_of(map, self.key_of(map).await?, number).await?;
        let backups = self.backups.as_ref().map(|folder| folder.list()).transpose()?.unwrap_or_default();
        let is_older = |created| erasure.ended.is_none_or(|ended| created <= ended);
        let older = backups.into_iter().filter(|backup| is_older(backup.created)).map(|backup| backup.id);
        let older = older.collect();
        Ok((erasure, older))
    }

    async fn erasure_of(&self, map: &MapId, key: MapKey, number: u64) -> Result<Erasure> {
        let found = self.store.erasure(key, number).await?;
        found.ok_or_else(|| ServiceError::NotFound(format!("there is no erasure e-{number} of map {map}")))
    }

    /// Works on the erasures that are not done, until there is none.
    pub(in crate::engine) fn erase_in_background(&self) {
        let (service, closing) = (self.clone(), self.closing.clone());
        tokio::spawn(closing.run_until_cancelled_owned(async move {
            let mut rewritable = service.erasing.lock().await;
            let mut rest = RETRY_FIRST;
            loop {
                match service.erase_next(&mut rewritable).await {
                    Ok(true) => rest = RETRY_FIRST,
                    Ok(false) => break,
                    Err(error) => {
                        tracing::warn!(%error, "an erasure did not go on; it is tried again");
                        sleep(rest).await;
                        rest = (2 * rest).min(RETRY_LAST);
                    }
                }
            }
        }));
    }

    /// Goes on with the erasures of maps that came to this server, if nothing is being erased.
    pub(in crate::engine) async fn take_erasures_on(&self) -> Result<()> {
        if self.erasing.try_lock().is_ok() && !self.erasures_here().await?.is_empty() {
            self.erase_in_background();
        }
        Ok(())
    }

    /// Returns the erasures that are not done, of the maps that are this server's or should be.
    async fn erasures_here(&self) -> Result<Vec<OpenErasure>> {
        let mut here = Vec::new();
        for erasure in self.store.open_erasures().await? {
            if self.is_here(&erasure.map).await {
                here.push(erasure);
            }
        }
        Ok(here)
    }

    /// Has this server own a map, where others could: what is written of it would be refused. To be held until that is on disk.
    pub(in crate::engine) async fn own(&self, map: &MapId) -> Result<Option<Arc<LiveMap>>> {
        if self.store.is_shared() { self.live_in_background(map).await.map(Some) } else { Ok(None) }
    }

    /// Does all that is asked for by now, and rewrites the file once, or waits until it may. Returns whether there was anything.
    async fn erase_next(&self, rewritable: &mut Option<Instant>) -> Result<bool> {
        let open = self.erasures_here().await?;
        if open.is_empty() {
            return Ok(false);
        }
        let (mut removed, mut failed) = (Vec::new(), None);
        for erasure in open {
            let result = match &erasure.asked {
                Some(asked) => self.remove(&erasure, asked).await,
                None => Ok(()),
            };
            match result {
                // The map was deleted meanwhile.
                Ok(()) | Err(ServiceError::NotFound(_)) => removed.push(erasure),
                // A damaged map keeps none of the others from their turn.
                Err(error) => failed = Some(error),
            }
        }
        if let Some(at) = rewritable.take_if(|_| !removed.is_empty()) {
            sleep_until(at).await;
            // What was asked for meanwhile is removed first.
            return Ok(true);
        }
        if !removed.is_empty() {
            let took = self.rewrite().await?;
            *rewritable = (took > UNNOTICED).then(|| Instant::now() + REST * took);
        }
        for erasure in &removed {
            let owned = match self.own(&erasure.map).await {
                // Its erasures went with it.
                Err(ServiceError::NotFound(_)) => continue,
                owned => owned?,
            };
            if owned.is_some_and(|live| live.key != erasure.key) {
                continue;
            }
            self.step(erasure, ErasureStep::Done(now())).await?;
            tracing::info!(map = %erasure.map, number = erasure.number, "an erasure is done");
        }
        failed.map_or(Ok(true), Err)
    }

    /// Makes the database's file and its log anew, without what was deleted from them. Returns how long writes waited for it.
    async fn rewrite(&self) -> Result<Duration> {
        // Rows of deleted maps go in slices; those of later ones have no end.
        let deleted = self.store.deleted_maps().await?;
        while self.store.deleted_maps().await?.iter().any(|key| deleted.contains(key)) {
            sleep(LOOK_AGAIN).await;
        }
        let of_file = self.store.committer().renew_file().await?;
        loop {
            match self.store.committer().renew_log().await {
                Err(StoreError::Busy) => sleep(LOOK_AGAIN).await,
                of_log => return Ok(of_file + of_log?),
            }
        }
    }

    /// Removes what is asked from the map and its releases, and every trace of it.
    async fn remove(&self, erasure: &OpenErasure, asked: &NewErasure) -> Result<()> {
        // A copy under way would have it from its snapshot.
        let _no_copy = self.copying.write().await;
        let live = self.live(&erasure.map).await?;
        if live.key != erasure.key {
            return Err(ServiceError::no_map(&erasure.map));
        }
        let mut maps = vec![live.clone()];
        for (id, key) in self.store.release_maps(live.key).await? {
            match self.live(&id).await {
                // It was deleted meanwhile.
                Err(ServiceError::NotFound(_)) => {}
                release => maps.extend(Some(release?).filter(|release| release.key == key)),
            }
        }
        if !erasure.is_counted {
            self.count(erasure, asked, &maps).await?;
        }
        for live in &maps {
            self.remove_from(live, asked).await?;
        }
        let sessions = match asked {
            NewErasure::Keyframes(_) => Vec::new(),
            NewErasure::Sessions(sessions) => sessions.clone(),
        };
        // The map itself comes last: while it is in memory, what is written of its releases is not refused.
        for live in maps.into_iter().rev() {
            while self.store.has_deferred_changes(live.key).await? {
                sleep(LOOK_AGAIN).await;
            }
            let step = ErasureStep::RemoveTraces(live.key, sessions.clone());
            let job = Job::Erase(erasure.key, erasure.number, step);
            let (changing, store, runtime) = (live.clone(), self.store.clone(), Handle::current());
            let change = move || changing.change_rows(&store, &runtime, job);
            // Those who come meanwhile wait, and find the map as it is then.
            let _lane = live.lane.lock().await;
            blocking_part("erase", change).await??;
            self.registry.forget_over(&live.id);
        }
        if let Some(models) = &self.models {
            models.note_erasure();
        }
        let _owned = self.own(&erasure.map).await?;
        self.step(erasure, ErasureStep::Removed).await
    }

    async fn step(&self, erasure: &OpenErasure, step: ErasureStep) -> Result<()> {
        Ok(self.store.committer().commit(Job::Erase(erasure.key, erasure.number, step)).await?)
    }

    /// Counts what is to be removed, before the first of it is: an erasure may be broken off, and go on elsewhere.
    async fn count(&self, erasure: &OpenErasure, asked: &NewErasure, maps: &[Arc<LiveMap>]) -> Result<()> {
        let (mut keyframes, mut releases) = (0, Vec::new());
        for live in maps {
            let asked = asked.clone();
            let count = move |state: &State| Ok(keyframes_of(&state.index, &asked).count() as u64);
            let found = self.read(live, count).await?.1;
            if live.key == erasure.key {
                keyframes = found;
            } else if found > 0 {
                releases.push(live.key);
            }
        }
        self.step(erasure, ErasureStep::Count(keyframes, releases)).await
    }

    /// Deletes the keyframes, the loops that name them, and the positions of their sessions' map points.
    async fn remove_from(&self, live: &Arc<LiveMap>, asked: &NewErasure) -> Result<()> {
        // What a robot sends meanwhile stays, so that there is an end.
        let end = self.read(live, |state: &State| Ok(state.index.next_keyframe())).await?.1;
        loop {
            let wanted = asked.clone();
            let look = move |state: &State| Ok(found(&state.index, &wanted, end));
            let (keyframes, loops) = self.read(live, look).await?.1;
            if keyframes.is_empty() && loops.is_empty() {
                break;
            }
            for id in loops {
                let revoke = move |index: &mut MapIndex| {
                    let is_there = index.loops().contains_key(&id);
                    Ok(Decision::of((), is_there.then(|| revoke_loop(index, &id).1)))
                };
                self.begin(live, Manner::Erasing, revoke).await?.committed().await?;
            }
            for (seq, id) in keyframes {
                let Some(bow) = self.store.bow(live.key, seq).await? else { continue };
                let cull = move |index: &mut MapIndex| {
                    // Somebody else may have deleted it meanwhile, and given its name to another.
                    let is_there = index.keyframe_seq(&id) == Some(seq);
                    Ok(Decision::of((), is_there.then(|| cull_keyframe(index, seq, Arc::new(bow)))))
                };
                self.begin(live, Manner::Erasing, cull).await?.committed().await?;
                self.features.forget(live.key, seq).await;
            }
        }
        if let NewErasure::Sessions(sessions) = asked.clone() {
            let forget = move |index: &mut MapIndex| Ok(Decision::of((), forget_points(index, &sessions)));
            self.begin(live, Manner::Erasing, forget).await?.committed().await?;
        }
        Ok(())
    }
}

/// Forgets the positions of map points that no keyframe is left to observe: a correction, or a keyframe that did not observe them,
/// had brought them. `None` where there are none.
fn forget_points(index: &mut MapIndex, sessions: &[SessionId]) -> Option<Decided> {
    let is_left = |session| index.keyframes().any(|keyframe| keyframe.session == session);
    let gone = sessions.iter().filter_map(|id| index.session(id)).filter(|session| !is_left(*session));
    let points = |session| -> Box<[PointId]> {
        index.points().placed(session).into_iter().map(|(id, _)| id).collect()
    };
    let forgotten = gone.map(|session| Change::PointsForgotten(session, points(session)));
    let is_any = |change: &Change| matches!(change, Change::PointsForgotten(_, points) if !points.is_empty());
    let changes = forgotten.filter(is_any).collect();
    recorded(index, changes)
}

/// Applies changes, if there are any.
pub(super) fn recorded(index: &mut MapIndex, changes: Vec<Change>) -> Option<Decided> {
    if changes.is_empty() {
        return None;
    }
    let mut record = Recorder::new(index);
    record.apply(changes);
    Some(record.finish())
}

/// Returns the keyframes of a map that are to be deleted.
fn keyframes_of<'a>(
    index: &'a MapIndex,
    asked: &'a NewErasure,
) -> Box<dyn Iterator<Item = &'a Keyframe> + 'a> {
    match asked {
        NewErasure::Keyframes(ids) => {
            // A client may name one twice.
            let named: BTreeSet<KeyframeSeq> = ids.iter().filter_map(|id| index.keyframe_seq(id)).collect();
            Box::new(named.into_iter().filter_map(|seq| index.keyframe(seq)))
        }
        NewErasure::Sessions(ids) => {
            let sessions: BTreeSet<_> = ids.iter().filter_map(|id| index.session(id)).collect();
            Box::new(index.keyframes().filter(move |keyframe| sessions.contains(&keyframe.session)))
        }
    }
}

/// Returns the keyframes before one, and the loops, that are to be deleted from a map.
fn found(
    index: &MapIndex,
    asked: &NewErasure,
    end: KeyframeSeq,
) -> (Vec<(KeyframeSeq, KeyframeId)>, Vec<LoopId>) {
    let before = keyframes_of(index, asked).filter(|keyframe| keyframe.seq < end);
    let keyframes: Vec<(KeyframeSeq, KeyframeId)> =
        before.take(FOUND_AT_ONCE).map(|keyframe| (keyframe.seq, keyframe.id.clone())).collect();
    let named: BTreeSet<&KeyframeId> = match asked {
        // A loop keeps the names of keyframes that were deleted before.
        NewErasure::Keyframes(ids) => ids.iter().collect(),
        NewErasure::Sessions(_) => keyframes.iter().map(|(_, id)| id).collect(),
    };
    let names = |of: &Loop| named.contains(&of.keyframe_id) || named.contains(&of.candidate_id);
    let loops = index.loops().values().filter(|of| names(of)).map(|of| of.id.clone()).collect();
    (keyframes, loops)
}
