//! Looking: finds the description tasks of one map, in memory or not.

use std::collections::HashSet;
use std::sync::Arc;

use tokio::time::Instant;

use super::{REST, Round};
use crate::engine::ServiceError;
use crate::engine::descriptions::backlog::Backlog;
use crate::engine::maps::live::LiveMap;
use crate::llm::embeddings::Embeddings as ModelEmbeddings;
use crate::recognition::anchors::description_tasks::{DescriptionTask, DescriptionTasks};
use crate::recognition::anchors::find_description_tasks::find_description_tasks;
use crate::recognition::anchors::pairs::Embeddings;
use crate::store::MapKey;

/// Description tasks that one look takes.
const BATCH: usize = 32;

/// After a look, the map rests for this many times as long as the look took.
const PAUSE_PER_LOOK: u32 = 20;

impl Round {
    /// Looks at one map that is not in memory and may have work. It does so only while jobs are free, so that maps are loaded no
    /// faster than their work is done. Returns when there may be another one.
    pub(super) async fn look_at_absent(&mut self, in_memory: &HashSet<MapKey>) -> Option<Instant> {
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

    /// Whether a map in memory has changed since the last look, or does not know yet that a model is away or back.
    pub(super) fn wants_look(&self, live: &LiveMap, now: Instant) -> bool {
        if live.is_release() {
            return false;
        }
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
            || board.told_away != (board.waits() && self.service.must_wait(live))
    }

    /// Returns the embeddings, while they can be had; else words choose as they do without them.
    fn embeddings_at_hand(&self) -> Option<&ModelEmbeddings> {
        self.models.embeddings.as_ref().filter(|embeddings| embeddings.away_for().is_none())
    }

    /// Finds the description tasks of a map, and records whether the map waits for a model.
    pub(super) async fn look(&mut self, live: &Arc<LiveMap>) {
        let roles = self.models.roles();
        let models_away = self.service.must_wait(live);
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
            let found =
                find_description_tasks(&state.index, roles, embeddings, &mut settled, BATCH, passed_over);
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
}
