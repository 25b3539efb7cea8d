//! The worker's loop: finds description tasks map by map, begins jobs, and applies their answers.
//!
//! Maps take turns. A model that is away is not asked, and the maps that wait for it record so.

mod looking;
#[cfg(test)]
mod tests;

use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use tokio::time::Instant;

use super::backlog::{Backlog, PAUSE_MAX};
use super::running_jobs::{Done, Jobs, named};
use super::unexamined::UnexaminedMaps;
use crate::domain::ids::MapId;
use crate::engine::lock::lock;
use crate::engine::maps::live::LiveMap;
use crate::engine::maps::pinned::PinnedMap;
use crate::engine::{Service, ServiceError};
use crate::llm::Models;
use crate::llm::embeddings::Embeddings as ModelEmbeddings;
use crate::llm::port::Fault;
use crate::recognition::anchors::description_tasks::DescriptionTask;
use crate::store::MapKey;

/// Rest before new jobs are taken where requests are shed.
const REST: Duration = Duration::from_millis(250);

/// The worker's loop and its state.
pub(in crate::engine) struct Round {
    service: Service,
    models: Arc<Models>,
    /// The backlogs by the map's key: another map of the same name shares nothing with it.
    boards: HashMap<MapKey, Backlog>,
    jobs: Jobs,
    /// When to try again, while a model is away.
    resume_at: Option<Instant>,
    was_away: bool,
    /// Maps that may have work from before a restart or from a write before they left memory.
    unexamined: UnexaminedMaps,
    /// Counts the jobs begun: the maps take turns.
    turn: usize,
}

impl Round {
    /// Creates a loop that has seen no map yet.
    pub fn new(service: Service, models: Arc<Models>) -> Self {
        Self {
            service,
            models,
            boards: HashMap::new(),
            jobs: Jobs::default(),
            resume_at: None,
            was_away: false,
            unexamined: UnexaminedMaps::default(),
            turn: 0,
        }
    }

    /// Runs rounds until the worker is stopped.
    pub async fn run(mut self) {
        self.list_unexamined().await;
        let worker = self.service.worker.clone();
        while !worker.background.stop.is_cancelled() {
            let next_look = self.hand_out().await;
            let open: usize = self.boards.values().map(|b| b.found.len() + b.under_way.len()).sum();
            worker.open_jobs.store(open as u64, Ordering::Relaxed);
            let later = next_look.unwrap_or_else(|| Instant::now() + PAUSE_MAX);
            tokio::select! {
                () = worker.background.stop.cancelled() => {}
                () = worker.background.wake.notified() => {}
                () = tokio::time::sleep_until(later) => {}
                Some(Ok(done)) = self.jobs.join_next() => self.finished(done).await,
            }
        }
        while self.jobs.join_next().await.is_some() {}
    }

    /// Lists maps that may have work from before a restart, though no client has asked for them yet. They are looked at one by
    /// one, and do not stay in memory for it.
    async fn list_unexamined(&mut self) {
        match self.service.store.maps_with_crops().await {
            Ok(maps) => maps.into_iter().for_each(|map| self.unexamined.add(map)),
            Err(error) => tracing::error!(%error, "the maps with crops cannot be listed"),
        }
    }

    /// Begins as many jobs as may run, map by map, and returns when to look again if nothing wakes it before.
    async fn hand_out(&mut self) -> Option<Instant> {
        let now = Instant::now();
        let mut in_memory = HashSet::new();
        let written = std::mem::take(&mut *lock(&self.service.worker.written));
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

    /// Marks the maps that were written to, so that they are looked at whether they are still in memory or not.
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

    async fn tell_away(&self, live: &Arc<LiveMap>, away: bool) {
        if let Err(error) = self.service.tell_away(live, away).await {
            tracing::debug!(map = %live.id, %error, "could not tell that a model is away or back");
        }
    }

    fn begin(&mut self, key: MapKey, map: PinnedMap, lack: DescriptionTask) {
        let (service, models) = (self.service.clone(), self.models.clone());
        let asked = lack.clone();
        let job = async move {
            match service.live_pinned_in_background(&map).await {
                Ok(live) => service.give(&live, &models, asked).await,
                // The map is gone, and the question with it.
                Err(ServiceError::NotFound(_)) => Ok(()),
                Err(error) => Err(error.into()),
            }
        };
        self.jobs.spawn(named(key, lack, job));
    }

    async fn finished(&mut self, Done { map, lack, result }: Done) {
        let Some(board) = self.boards.get_mut(&map) else { return };
        board.under_way.remove(&lack);
        if result.is_ok() {
            board.paused.remove(&lack);
        }
        if matches!(lack, DescriptionTask::Embedding { .. }) {
            // It changes no map, and others can be found with it. Nor does it say anything of the other models.
            board.looked_at = None;
            if let Err(fault) = result {
                board.pause(lack, self.models.pause, !matches!(fault, Fault::Away | Fault::Spent));
            }
            return;
        }
        if result.is_ok() {
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

    /// Asks again at once what a model failed to answer, because it is back.
    fn resume(&mut self) {
        let now = Instant::now();
        for (until, _) in self.boards.values_mut().flat_map(|board| board.paused.values_mut()) {
            *until = now;
        }
    }

    /// Records at once, in every map that waits, that a model is away.
    async fn tell_all_waiting(&mut self) {
        // A map that is not in memory is told when it is loaded.
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
    a.into_iter().chain(b).min()
}

impl From<ServiceError> for Fault {
    fn from(error: ServiceError) -> Self {
        Self::Store(error.to_string())
    }
}
