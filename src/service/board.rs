//! Board: what the worker knows of one map's work.

use std::collections::{HashMap, HashSet, VecDeque};
use std::time::Duration;

use tokio::time::Instant;

use crate::recognition::lacking::{Lack, Settled};

/// A job that keeps failing is tried again after at most so long.
pub(super) const PAUSE_MAX: Duration = Duration::from_hours(1);

/// A pause doubles this often, and no more.
const DOUBLINGS_MAX: u32 = 12;

/// It is only memory: a new process finds the same work again.
#[derive(Default)]
pub(super) struct Board {
    /// Jobs to be handed out.
    pub found: VecDeque<Lack>,
    /// Jobs that somebody does.
    pub under_way: HashSet<Lack>,
    /// Failed jobs, each with the moment until which it is left alone, and how often it failed.
    pub paused: HashMap<Lack, (Instant, u32)>,
    /// Texts of which nothing is open.
    pub settled: Settled,
    /// Does the map say that it waits for a model that is away?
    pub told_away: bool,
    /// The version at which everything lacking was found.
    pub looked_at: Option<u64>,
    /// Not looked at again before.
    pub look_again_at: Option<Instant>,
}

impl Board {
    /// Is there anything that a model has not given yet?
    pub fn waits(&self) -> bool {
        !(self.found.is_empty() && self.under_way.is_empty() && self.paused.is_empty())
    }

    /// What is under way, or has failed lately.
    pub fn left_alone(&self, now: Instant) -> HashSet<Lack> {
        let paused = self.paused.iter().filter(|(_, (until, _))| *until > now).map(|(lack, _)| lack);
        paused.chain(&self.under_way).cloned().collect()
    }

    /// Leaves a failed job alone for a while; longer each time, if it counts.
    pub fn pause(&mut self, lack: Lack, first: Duration, counts: bool) {
        let tries = self.paused.get(&lack).map_or(0, |(_, tries)| *tries);
        let pause = first.saturating_mul(1 << tries.min(DOUBLINGS_MAX)).min(PAUSE_MAX);
        self.paused.insert(lack, (Instant::now() + pause, tries + u32::from(counts)));
    }
}
