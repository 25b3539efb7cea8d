//! The worker: asks models for what anchors lack, in the background, and brings their verdicts home (§IV-A.3).
//!
//! What is lacking is a question to each map's index, so a crash loses nothing; what was answered is on disk before it
//! is used, so nothing is paid twice. Maps take turns. A model that is away is left alone, and the maps that wait for it
//! say so.

#[cfg(test)]
mod tests;

use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tokio::sync::Notify;
use tokio::task::JoinHandle;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

use super::backlog::{Backlog, PAUSE_MAX};
use super::running_jobs::{Done, Jobs};
use crate::domain::ids::MapId;
use crate::engine::descriptions::unexamined::UnexaminedMaps;
use crate::engine::maps::live::{Decision, LiveMap};
use crate::engine::maps::pinned::PinnedMap;
use crate::engine::{Service, ServiceError};
use crate::llm::Models;
use crate::llm::embeddings::Embeddings as ModelEmbeddings;
use crate::llm::port::Fault;
use crate::recognition::anchors::apply_model_answer::learn_away;
use crate::recognition::anchors::description_tasks::{DescriptionTask, DescriptionTasks, lacking};
use crate::recognition::anchors::pairs::Embeddings;
use crate::store::MapKey;

/// How many things lacking are looked up at once.
const BATCH: usize = 32;

/// Looking takes at most this share of the time, however fast a map grows.
const PAUSE_PER_LOOK: u32 = 20;

/// Jobs under way when the server stops may finish within this time; what they learned so far is kept anyway.
const DRAIN: Duration = Duration::from_secs(8);

/// How long it takes no new jobs when it finds the server under pressure.
const REST: Duration = Duration::from_millis(250);

/// The maps that were written to since the last round, each with the newest version that was decided.
type WrittenMaps = std::sync::Mutex<HashMap<MapKey, (MapId, u64)>>;

/// The handle to the worker.
#[derive(Debug)]
pub(in crate::engine) struct Worker {
    wake: Arc<Notify>,
    written: Arc<WrittenMaps>,
    stop: CancellationToken,
    open_jobs: Arc<AtomicU64>,
    running: std::sync::Mutex<Option<JoinHandle<()>>>,
}

impl Worker {
    pub fn new() -> Arc<Self> {
        Arc::new(Self {
            wake: Arc::default(),
            written: Arc::default(),
            stop: CancellationToken::new(),
            open_jobs: Arc::default(),
            running: std::sync::Mutex::default(),
        })
    }

    /// Starts looking for work, until [`Self::stop`].
    pub fn start(&self, service: Service, models: Arc<Models>) {
        *lock(&self.running) = Some(tokio::spawn(self.round(service, models).run()));
    }

    fn round(&self, service: Service, models: Arc<Models>) -> Round {
        Round {
            service,
            models,
            wake: self.wake.clone(),
            written: self.written.clone(),
            stop: self.stop.clone(),
            open_jobs: self.open_jobs.clone(),
            boards: HashMap::new(),
            jobs: Jobs::default(),
            resume_at: None,
            was_away: false,
            unexamined: UnexaminedMaps::default(),
            turn: 0,
        }
    }

    /// Notes that a map was written to, and wakes the worker. The map is named because it may leave memory before the
    /// next round, which would not find it there.
    pub fn note_write(&self, live: &LiveMap) {
        lock(&self.written).insert(live.key, (live.id.clone(), live.newest_version()));
        self.wake();
    }

    /// Something changed: there may be work.
    pub fn wake(&self) {
        self.wake.notify_one();
    }

    /// Jobs found and not done.
    pub fn open_jobs(&self) -> u64 {
        self.open_jobs.load(Ordering::Relaxed)
    }

    /// Takes no more jobs, and lets those under way finish.
    pub async fn stop(&self) {
        self.stop.cancel();
        let running = lock(&self.running).take();
        if let Some(running) = running {
            let _ = running.await;
        }
    }
}

fn lock<T>(mutex: &std::sync::Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    // Each holds one value that is replaced as a whole.
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

struct Round {
    service: Service,
    models: Arc<Models>,
    wake: Arc<Notify>,
    written: Arc<WrittenMaps>,
    stop: CancellationToken,
    open_jobs: Arc<AtomicU64>,
    /// By the map's key: another map of the same name has nothing of it.
    boards: HashMap<MapKey, Backlog>,
    jobs: Jobs,
    /// While a model is away: when to try again.
    resume_at: Option<Instant>,
    was_away: bool,
    /// Maps that may have work from before a restart or from a write before they left memory.
    unexamined: UnexaminedMaps,
    /// Whose turn it is.
    turn: usize,
}

impl Round {
    async fn run(mut self) {
        self.list_unexamined().await;
        while !self.stop.is_cancelled() {
            let next_look = self.hand_out().await;
            let open: usize = self.boards.values().map(|b| b.found.len() + b.under_way.len()).sum();
            self.open_jobs.store(open as u64, Ordering::Relaxed);
            let (wake, stop) = (self.wake.clone(), self.stop.clone());
            let later = next_look.unwrap_or_else(|| Instant::now() + PAUSE_MAX);
            tokio::select! {
                () = stop.cancelled() => {}
                () = wake.notified() => {}
                () = tokio::time::sleep_until(later) => {}
                Some(done) = self.jobs.next() => self.finished(done).await,
            }
        }
        let drained = async { while self.jobs.next().await.is_some() {} };
        if tokio::time::timeout(DRAIN, drained).await.is_err() {
            self.jobs.abort_all();
        }
    }

    /// What was left undone before a restart is found in maps that no client has asked for yet. They are looked at one by
    /// one, and do not stay in memory for it.
    async fn list_unexamined(&mut self) {
        match self.service.store.maps_with_crops().await {
            Ok(maps) => maps.into_iter().for_each(|map| self.unexamined.add(map)),
            Err(error) => tracing::error!(%error, "the maps with crops cannot be listed"),
        }
    }

    /// Gives jobs to the free hands, each map in its turn; when there may be more, if nobody wakes us.
    async fn hand_out(&mut self) -> Option<Instant> {
        let now = Instant::now();
        let mut in_memory = HashSet::new();
        let written = std::mem::take(&mut *lock(&self.written));
        let wanted = self.service.registry.in_memory(|live| {
            in_memory.insert(live.key);
            self.wants_look(live, now)
        });
        self.note_written(written, &in_memory);
        // A map with work keeps its board when it leaves memory.
        self.boards
            .retain(|key, board| in_memory.contains(key) || board.waits() || board.looked_at.is_none());
        for live in wanted {
            self.look(&live).await;
        }
        let now = Instant::now();
        let next_look = self.boards.values().filter_map(|board| board.next_look(now)).min();
        let embeddings_back = self.models.embeddings.as_ref().and_then(ModelEmbeddings::away_for);
        let next_look = earlier(next_look, embeddings_back.map(|left| now + left));
        if self.service.pressure.is_high() {
            return earlier(next_look, Some(now + REST));
        }
        if let Some(resume_at) = self.resume_at {
            if now < resume_at {
                return earlier(next_look, Some(resume_at));
            }
            if !self.jobs.is_empty() {
                return next_look;
            }
        }
        // One question tells whether a model is back.
        let away = self.models.is_away();
        let hands = if away { 1 } else { self.models.jobs_at_once };
        self.resume_at = None;
        let mut ready: Vec<MapKey> =
            self.boards.iter().filter(|(_, board)| !board.found.is_empty()).map(|(key, _)| *key).collect();
        ready.sort_unstable();
        while self.jobs.len() < hands && !ready.is_empty() {
            self.turn = self.turn.wrapping_add(1);
            let key = ready[self.turn % ready.len()];
            match self.boards.get_mut(&key).and_then(|board| Some((board.found.pop_front()?, board))) {
                Some((lack, board)) => {
                    board.under_way.insert(lack.clone());
                    let map = board.map.clone();
                    self.begin(key, map, lack);
                }
                None => ready.retain(|other| *other != key),
            }
        }
        if self.jobs.len() < hands {
            return earlier(next_look, self.look_at_absent(&in_memory).await);
        }
        next_look
    }

    /// Has the maps that were written to looked at, whether they are still in memory or not.
    fn note_written(&mut self, written: HashMap<MapKey, (MapId, u64)>, in_memory: &HashSet<MapKey>) {
        for (key, (map, version)) in written {
            match self.boards.get_mut(&key) {
                // It may leave memory before it may be looked at again; the board stays with it.
                Some(board) if board.looked_at.is_none_or(|seen| seen < version) => board.looked_at = None,
                Some(_) => {}
                None if in_memory.contains(&key) => {}
                None => self.unexamined.add(map),
            }
        }
    }

    /// Looks at one map that is not in memory and may have work: for free hands only, so that maps come to memory no faster
    /// than their work is done. Returns when there may be another one.
    async fn look_at_absent(&mut self, in_memory: &HashSet<MapKey>) -> Option<Instant> {
        let now = Instant::now();
        let is_absent = |(key, board): &(&MapKey, &Backlog)| !in_memory.contains(key) && board.is_due(now);
        let due = self.boards.iter().find(is_absent).map(|(key, board)| (*key, board.map.clone()));
        if let Some((key, map)) = due {
            match self.service.live_pinned_in_background(&map).await {
                Ok(live) => self.look(&live).await,
                Err(ServiceError::NotFound(_)) => drop(self.boards.remove(&key)),
                Err(_) => {
                    if let Some(board) = self.boards.get_mut(&key) {
                        board.look_again_at = Some(Instant::now() + REST);
                    }
                }
            }
            return Some(Instant::now());
        }
        let Some(unexamined) = self.unexamined.take(now) else { return self.unexamined.next_due(now) };
        match self.service.live_in_background(&unexamined.map).await {
            Ok(live) => self.look(&live).await,
            // A damaged map is not repaired while the server runs.
            Err(ServiceError::NotFound(_) | ServiceError::Damaged(_)) => {}
            Err(error) => {
                tracing::debug!(map = %unexamined.map, %error, "a map could not be looked at; it is tried again");
                self.unexamined.put_back(unexamined, Instant::now());
            }
        }
        Some(Instant::now())
    }

    /// Whether a map in memory has changed since the last look, or must hear that a model is away or back.
    fn wants_look(&self, live: &LiveMap, now: Instant) -> bool {
        let Some(board) = self.boards.get(&live.key) else { return true };
        if !board.found.is_empty() || !board.may_look(now) {
            return false;
        }
        let has_changed = board.looked_at != Some(live.newest_version());
        let is_over = board.paused.values().any(|(until, _)| *until <= now);
        let chosen_otherwise = board.by_embeddings != self.embeddings_at_hand().is_some();
        has_changed
            || is_over
            || chosen_otherwise
            || board.told_away != (board.waits() && self.is_away_for(live))
    }

    /// Returns the embeddings, while they can be had; else words choose as they do without them.
    fn embeddings_at_hand(&self) -> Option<&ModelEmbeddings> {
        self.models.embeddings.as_ref().filter(|embeddings| embeddings.away_for().is_none())
    }

    /// Whether the models are away as far as this map is concerned.
    fn is_away_for(&self, live: &LiveMap) -> bool {
        self.models.is_away() || self.is_spent_for(live)
    }

    /// Looks what a map lacks, and tells the map whether it waits for a model.
    async fn look(&mut self, live: &Arc<LiveMap>) {
        let roles = self.models.roles();
        let models_away = self.is_away_for(live);
        let at_hand = self.embeddings_at_hand().cloned();
        let board = self.boards.entry(live.key).or_insert_with(|| Backlog::of(live));
        let now = Instant::now();
        if !board.found.is_empty() {
            return;
        }
        let was_by_embeddings = std::mem::replace(&mut board.by_embeddings, at_hand.is_some());
        let mut settled = std::mem::take(&mut board.settled);
        if board.by_embeddings && !was_by_embeddings {
            // What words settled may be chosen otherwise.
            settled.clear();
        }
        let left_alone: HashSet<DescriptionTask> = board.left_alone(now);
        let looked = self.service.look(live, move |state| {
            let passed_over = |lack: &DescriptionTask| left_alone.contains(lack);
            let embeddings = at_hand.as_ref().map(|embeddings| embeddings as &dyn Embeddings);
            let found = lacking(&state.index, roles, embeddings, &mut settled, BATCH, passed_over);
            Ok((state.version, found, settled, state.index.model_away()))
        });
        let looked = looked.await;
        let board = self.boards.entry(live.key).or_insert_with(|| Backlog::of(live));
        let Ok((_, (version, lacking, settled, told_away))) = looked else {
            board.look_again_at = Some(Instant::now() + REST);
            return;
        };
        let DescriptionTasks { found, is_all } = lacking;
        board.settled = settled;
        board.looked_at = is_all.then_some(version);
        board.look_again_at = Some(Instant::now() + now.elapsed() * PAUSE_PER_LOOK);
        // What was due and is lacking no more is done.
        board.paused.retain(|lack, (until, _)| *until > now || found.contains(lack));
        board.found.extend(found);
        board.told_away = models_away && board.waits();
        let away = board.told_away;
        if away != told_away {
            self.tell_away(live, away).await;
        }
    }

    /// Whether the key that pays for this map has spent its day's budget.
    fn is_spent_for(&self, live: &LiveMap) -> bool {
        let payer = self.service.payer(live.owner);
        payer.is_some_and(|payer| self.models.budget().is_spent_for(&payer))
    }

    async fn tell_away(&self, live: &Arc<LiveMap>, away: bool) {
        let told = self.service.change(live, move |index| {
            Ok(match learn_away(index, away) {
                Some(decided) => Decision::Changed((), decided, None),
                None => Decision::Unchanged(()),
            })
        });
        if let Err(error) = told.await {
            tracing::debug!(map = %live.id, %error, "could not tell that a model is away or back");
        }
    }

    fn begin(&mut self, key: MapKey, map: PinnedMap, lack: DescriptionTask) {
        let (service, models) = (self.service.clone(), self.models.clone());
        let asked = lack.clone();
        self.jobs.begin(key, lack, async move {
            match service.live_pinned_in_background(&map).await {
                Ok(live) => service.give(&live, &models, asked).await,
                // The map is gone, and the question with it.
                Err(ServiceError::NotFound(_)) => Ok(()),
                Err(error) => Err(error.into()),
            }
        });
    }

    async fn finished(&mut self, Done { map, lack, result }: Done) {
        let Some(board) = self.boards.get_mut(&map) else { return };
        board.under_way.remove(&lack);
        if matches!(lack, DescriptionTask::Embedding { .. }) {
            // It changes no map, and others can be found with it. Nor does it say anything of the other models.
            board.looked_at = None;
            match result {
                Ok(()) => drop(board.paused.remove(&lack)),
                Err(fault) => {
                    board.pause(lack, self.models.pause, !matches!(fault, Fault::Away | Fault::Spent));
                }
            }
            return;
        }
        if result.is_ok() {
            board.paused.remove(&lack);
            if self.was_away && !self.models.is_away() {
                self.was_away = false;
                self.resume();
            }
            return;
        }
        // While the model is away it is not the question's fault.
        let is_away = self.models.is_away();
        board.pause(lack, self.models.pause, !is_away);
        if is_away {
            self.was_away = true;
            self.resume_at = Some(Instant::now() + self.models.pause);
            self.tell_all_waiting().await;
        }
    }

    /// A model is back: what it failed to answer is asked again at once.
    fn resume(&mut self) {
        let now = Instant::now();
        for (until, _) in self.boards.values_mut().flat_map(|board| board.paused.values_mut()) {
            *until = now;
        }
    }

    /// A model has gone: every map that waits for it says so at once, not when it is next looked at.
    async fn tell_all_waiting(&mut self) {
        // One that is not in memory hears it when it comes back.
        let waits = |live: &LiveMap| {
            self.boards.get(&live.key).is_some_and(|board| board.waits() && !board.told_away)
        };
        for live in self.service.registry.in_memory(waits) {
            let Some(board) = self.boards.get_mut(&live.key) else { continue };
            board.told_away = true;
            self.tell_away(&live, true).await;
        }
    }
}

fn earlier(a: Option<Instant>, b: Option<Instant>) -> Option<Instant> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

impl From<ServiceError> for Fault {
    fn from(error: ServiceError) -> Self {
        Self::Store(error.to_string())
    }
}
