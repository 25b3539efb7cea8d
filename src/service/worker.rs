//! The worker: asks models for what anchors lack, in the background, and brings their verdicts home (§IV-A.3).
//!
//! What is lacking is a question to each map's index, so a crash loses nothing; what was answered is on disk before it
//! is used, so nothing is paid twice. Maps take turns. A model that is away is left alone, and the maps that wait for it
//! say so.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tokio::sync::{Notify, mpsc};
use tokio::task::JoinHandle;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

use super::board::{Board, PAUSE_MAX};
use super::jobs::{Done, Jobs};
use super::live::{Decision, LiveMap};
use super::{Service, ServiceError};
use crate::model::ids::{KeyframeId, MapId};
use crate::models::Models;
use crate::models::port::Fault;
use crate::recognition::lacking::{Lack, lacking};
use crate::recognition::learning::learn_away;
use crate::store::MapKey;

/// How many things lacking are looked up at once.
const BATCH: usize = 32;

/// Looking takes at most this share of the time, however fast a map grows.
const PAUSE_PER_LOOK: u32 = 20;

/// Jobs under way when the server stops may finish within this time; what they learned so far is kept anyway.
const DRAIN: Duration = Duration::from_secs(8);

/// How long it takes no new jobs when it finds the server under pressure.
const REST: Duration = Duration::from_millis(250);

/// Triggered loop checks that wait to be taken; more are passed over.
const TRIGGERS_WAITING: usize = 256;

/// A keyframe to be asked about, because a model has found that it sees something seen before.
pub type Trigger = (MapId, KeyframeId);

/// The handle to the worker.
#[derive(Debug)]
pub(super) struct Worker {
    wake: Arc<Notify>,
    stop: CancellationToken,
    open_jobs: Arc<AtomicU64>,
    running: std::sync::Mutex<Option<JoinHandle<()>>>,
    triggers: std::sync::Mutex<Option<mpsc::Receiver<Trigger>>>,
    pub trigger: mpsc::Sender<Trigger>,
}

impl Worker {
    pub fn new() -> Arc<Self> {
        let (trigger, triggers) = mpsc::channel(TRIGGERS_WAITING);
        Arc::new(Self {
            wake: Arc::default(),
            stop: CancellationToken::new(),
            open_jobs: Arc::default(),
            running: std::sync::Mutex::default(),
            triggers: std::sync::Mutex::new(Some(triggers)),
            trigger,
        })
    }

    /// Starts looking for work, until [`Self::stop`].
    pub fn start(&self, service: Service, models: Arc<Models>) {
        let round = Round {
            service,
            models,
            wake: self.wake.clone(),
            stop: self.stop.clone(),
            open_jobs: self.open_jobs.clone(),
            boards: HashMap::new(),
            jobs: Jobs::default(),
            resume_at: None,
            was_away: false,
            turn: 0,
        };
        *lock(&self.running) = Some(tokio::spawn(round.run()));
    }

    /// Something changed: there may be work.
    pub fn wake(&self) {
        self.wake.notify_one();
    }

    /// Jobs found and not done.
    pub fn open_jobs(&self) -> u64 {
        self.open_jobs.load(Ordering::Relaxed)
    }

    /// Keyframes to be asked about that nobody has taken yet.
    pub fn triggers_waiting(&self) -> u64 {
        (TRIGGERS_WAITING - self.trigger.capacity().min(TRIGGERS_WAITING)) as u64
    }

    /// The keyframes to be asked about; whoever comes first gets them.
    pub fn take_triggers(&self) -> Option<mpsc::Receiver<Trigger>> {
        lock(&self.triggers).take()
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
    stop: CancellationToken,
    open_jobs: Arc<AtomicU64>,
    /// By the map's key: another map of the same name has nothing of it.
    boards: HashMap<MapKey, Board>,
    jobs: Jobs,
    /// While a model is away: when to try again.
    resume_at: Option<Instant>,
    was_away: bool,
    /// Whose turn it is.
    turn: usize,
}

impl Round {
    async fn run(mut self) {
        self.load_maps().await;
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

    /// What was left undone before a restart is found in maps that nobody has asked for yet.
    async fn load_maps(&self) {
        match self.service.store.maps_with_crops().await {
            Ok(maps) => {
                for map in maps {
                    if self.stop.is_cancelled() {
                        return;
                    }
                    let _ = self.service.live(&map).await;
                }
            }
            Err(error) => tracing::error!(%error, "the maps with crops cannot be listed"),
        }
    }

    /// Gives jobs to the free hands, each map in its turn; when there may be more, if nobody wakes us.
    async fn hand_out(&mut self) -> Option<Instant> {
        let maps = self.service.registry.in_memory();
        self.boards.retain(|key, _| maps.iter().any(|live| live.key == *key));
        let mut next_look = None;
        for live in &maps {
            let look_at = self.look(live).await;
            next_look = earlier(next_look, look_at);
        }
        let now = Instant::now();
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
        let mut idle = 0;
        while self.jobs.len() < hands && idle < maps.len() {
            let live = &maps[self.turn % maps.len()];
            self.turn = self.turn.wrapping_add(1);
            let Some(board) = self.boards.get_mut(&live.key) else {
                idle += 1;
                continue;
            };
            match board.found.pop_front() {
                Some(lack) => {
                    idle = 0;
                    board.under_way.insert(lack.clone());
                    self.begin(live, lack);
                }
                None => idle += 1,
            }
        }
        next_look
    }

    /// Looks what a map lacks, if it has changed; and tells the map whether it waits for a model.
    async fn look(&mut self, live: &Arc<LiveMap>) -> Option<Instant> {
        let roles = self.models.roles();
        let models_away = self.models.is_away() || self.is_spent_for(live);
        let board = self.boards.entry(live.key).or_default();
        let now = Instant::now();
        if !board.found.is_empty() {
            return None;
        }
        let next_due = board.paused.values().map(|(until, _)| *until).filter(|until| *until > now).min();
        let due = board.paused.values().any(|(until, _)| *until <= now);
        let same = board.looked_at == Some(live.newest_version());
        if same && !due && board.told_away == (models_away && board.waits()) {
            return next_due;
        }
        if let Some(again) = board.look_again_at.filter(|again| now < *again) {
            return earlier(next_due, Some(again));
        }
        let mut settled = std::mem::take(&mut board.settled);
        let left_alone: HashSet<Lack> = board.left_alone(now);
        let looked = self.service.look(live, move |state| {
            let passed_over = |lack: &Lack| left_alone.contains(lack);
            let found = lacking(&state.index, roles, &mut settled, BATCH, passed_over);
            Ok((state.version, found, settled, state.index.model_away()))
        });
        let Ok((_, (version, found, settled, told_away))) = looked.await else { return next_due };
        let board = self.boards.entry(live.key).or_default();
        board.settled = settled;
        // A full batch means that there is more at this version.
        board.looked_at = (found.len() < BATCH).then_some(version);
        board.look_again_at = Some(Instant::now() + now.elapsed() * PAUSE_PER_LOOK);
        // What was due and is lacking no more is done.
        board.paused.retain(|lack, (until, _)| *until > now || found.contains(lack));
        board.found.extend(found);
        board.told_away = models_away && board.waits();
        let away = board.told_away;
        if away != told_away {
            self.tell_away(live, away).await;
        }
        next_due
    }

    /// Has the key that pays for this map spent its day's budget?
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

    fn begin(&mut self, live: &Arc<LiveMap>, lack: Lack) {
        let (service, models) = (self.service.clone(), self.models.clone());
        let job = {
            let (live, lack) = (live.clone(), lack.clone());
            async move { service.give(&live, &models, lack).await }
        };
        self.jobs.begin(live.key, lack, job);
    }

    async fn finished(&mut self, Done { map, lack, result }: Done) {
        let Some(board) = self.boards.get_mut(&map) else { return };
        board.under_way.remove(&lack);
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
        for live in self.service.registry.in_memory() {
            let Some(board) = self.boards.get_mut(&live.key) else { continue };
            if board.waits() && !board.told_away {
                board.told_away = true;
                self.tell_away(&live, true).await;
            }
        }
    }
}

fn earlier(a: Option<Instant>, b: Option<Instant>) -> Option<Instant> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

impl Service {
    /// The keyframes to be asked about because of what models have found; whoever comes first gets them.
    pub fn take_triggers(&self) -> Option<mpsc::Receiver<Trigger>> {
        self.worker.take_triggers()
    }

    pub(super) fn trigger(&self, map: &MapId, keyframes: Vec<KeyframeId>) {
        for keyframe in keyframes {
            // Full: who wants to know asks.
            let _ = self.worker.trigger.try_send((map.clone(), keyframe));
        }
    }
}

impl From<ServiceError> for Fault {
    fn from(error: ServiceError) -> Self {
        Self::Store(error.to_string())
    }
}
