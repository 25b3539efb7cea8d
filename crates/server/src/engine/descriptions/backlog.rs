//! Backlog: what the worker knows of one map's work.

use std::collections::{HashMap, HashSet, VecDeque};
use std::time::Duration;

use tokio::time::Instant;

use crate::engine::maps::live::LiveMap;
use crate::engine::maps::pinned::PinnedMap;
use crate::recognition::anchors::description_tasks::DescriptionTask;
use crate::recognition::anchors::pairs::Settled;

/// A job that keeps failing is tried again after at most so long.
pub(in crate::engine) const PAUSE_MAX: Duration = Duration::from_hours(1);

/// A pause doubles this often, and no more.
const DOUBLINGS_MAX: u32 = 12;

/// It is only memory: a new process finds the same work again. It may outlive its map's being in memory, as long as
/// there is work.
pub(in crate::engine) struct Backlog {
    /// The map.
    pub map: PinnedMap,
    /// Jobs to be handed out.
    pub found: VecDeque<DescriptionTask>,
    /// Jobs that somebody does.
    pub under_way: HashSet<DescriptionTask>,
    /// Failed jobs, each with the moment until which it is left alone, and how often it failed.
    pub paused: HashMap<DescriptionTask, (Instant, u32)>,
    /// Texts of which nothing is open.
    pub settled: Settled,
    /// Could embeddings choose the pairs when it was last looked at?
    pub by_embeddings: bool,
    /// Whether the map says that it waits for a model that is away.
    pub told_away: bool,
    /// The version at which everything lacking was found.
    pub looked_at: Option<u64>,
    /// Not looked at again before.
    pub look_again_at: Option<Instant>,
}

impl Backlog {
    /// Returns a board on which nothing is noted yet.
    pub fn of(live: &LiveMap) -> Self {
        Self {
            map: PinnedMap { id: live.id.clone(), key: live.key },
            found: VecDeque::new(),
            under_way: HashSet::new(),
            paused: HashMap::new(),
            settled: Settled::default(),
            by_embeddings: false,
            told_away: false,
            looked_at: None,
            look_again_at: None,
        }
    }

    /// Whether the map must be looked at though nothing has changed it: there was more at its version, or a pause is over.
    pub fn is_due(&self, now: Instant) -> bool {
        let is_idle = self.found.is_empty() && self.under_way.is_empty();
        let is_over = self.paused.values().any(|(until, _)| *until <= now);
        self.may_look(now) && (is_over || (is_idle && self.looked_at.is_none()))
    }

    /// Whether enough time has passed since the last look.
    pub fn may_look(&self, now: Instant) -> bool {
        self.look_again_at.is_none_or(|again| again <= now)
    }

    /// Returns when it may have to be looked at again, if nothing changes.
    pub fn next_look(&self, now: Instant) -> Option<Instant> {
        let pauses = self.paused.values().map(|(until, _)| *until);
        pauses.chain(self.look_again_at).filter(|at| *at > now).min()
    }

    /// Whether there is anything that a model has not given yet.
    pub fn waits(&self) -> bool {
        !(self.found.is_empty() && self.under_way.is_empty() && self.paused.is_empty())
    }

    /// Returns what is under way, or has failed lately.
    pub fn left_alone(&self, now: Instant) -> HashSet<DescriptionTask> {
        let paused = self.paused.iter().filter(|(_, (until, _))| *until > now).map(|(lack, _)| lack);
        paused.chain(&self.under_way).cloned().collect()
    }

    /// Leaves a failed job alone for a while; longer each time, if it counts.
    pub fn pause(&mut self, lack: DescriptionTask, first: Duration, counts: bool) {
        let tries = self.paused.get(&lack).map_or(0, |(_, tries)| *tries);
        let pause = first.saturating_mul(1 << tries.min(DOUBLINGS_MAX)).min(PAUSE_MAX);
        self.paused.insert(lack, (Instant::now() + pause, tries + u32::from(counts)));
    }
}
