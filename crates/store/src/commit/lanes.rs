//! Fair queue of jobs: one lane for each line, and each lane in turn gives one job to a group.
//!
//! Jobs of one line keep their order. A map with thousands of jobs that wait thus delays another map's job by one group,
//! and a group is bounded by what it will cost as well as by its number of jobs.

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

use tokio::sync::oneshot;

use super::queue::Queued;

/// Most jobs that share one transaction.
const MAX_GROUP: usize = 256;

/// The cost of a group, in microseconds of a slow core: what a job that comes too late for it waits. One job may cost more.
const GROUP_COST_US: u64 = 12_000;

/// The same where no other line has jobs: 64 heavy lines of a bulk upload share a sync. A job that comes meanwhile waits longer,
/// and a disk that syncs slowly is not asked to more often than it can.
const LONE_COST_US: u64 = 48_000;

/// Jobs that wait, by line.
#[derive(Default)]
pub(crate) struct Lanes {
    jobs: HashMap<usize, VecDeque<(u64, Queued)>>,
    /// The lanes that have jobs, in the order of their turns.
    turns: VecDeque<usize>,
    /// The number of the next job.
    next: u64,
    /// Answered when no job below the number waits.
    settling: Vec<(u64, oneshot::Sender<()>)>,
}

impl Lanes {
    pub(crate) fn is_empty(&self) -> bool {
        self.turns.is_empty()
    }

    /// Adds a job behind those of its line.
    pub(crate) fn push(&mut self, queued: Queued) {
        // The line lives as long as a job of it.
        let line = Arc::as_ptr(&queued.broken).addr();
        let lane = self.jobs.entry(line).or_default();
        if lane.is_empty() {
            self.turns.push_back(line);
        }
        lane.push_back((self.next, queued));
        self.next += 1;
    }

    /// Takes the next group: one job of each lane in turn.
    pub(crate) fn take(&mut self) -> Vec<Queued> {
        let (mut group, mut cost) = (Vec::new(), 0);
        let cost_max = if self.turns.len() == 1 { LONE_COST_US } else { GROUP_COST_US };
        while let Some(line) = self.turns.pop_front() {
            let Some(lane) = self.jobs.get_mut(&line) else { continue };
            let next = lane.front().map_or(0, |(_, queued)| queued.job.cost_us());
            if !group.is_empty() && (cost + next > cost_max || group.len() == MAX_GROUP) {
                self.turns.push_front(line);
                break;
            }
            cost += next;
            group.extend(lane.pop_front().map(|(_, queued)| queued));
            if lane.is_empty() {
                self.jobs.remove(&line);
            } else {
                self.turns.push_back(line);
            }
        }
        group
    }

    /// Answers once the jobs that wait now have been taken.
    pub(crate) fn settle(&mut self, settled: oneshot::Sender<()>) {
        self.settling.push((self.next, settled));
    }

    /// Answers those whose jobs have all been taken, and are done.
    pub(crate) fn answer_settled(&mut self) {
        let fronts = self.jobs.values().filter_map(|lane| lane.front());
        let oldest = fronts.map(|(number, _)| *number).min().unwrap_or(self.next);
        for (before, settled) in std::mem::take(&mut self.settling) {
            if before <= oldest {
                let _ = settled.send(());
            } else {
                self.settling.push((before, settled));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commit::queue::PoisonFlag;
    use crate::jobs::job::Job;

    fn queued(line: &PoisonFlag, map: i64) -> Queued {
        Queued { job: Job::DeleteMap(map), broken: line.clone(), done: Box::new(drop) }
    }

    fn taken(group: &[Queued]) -> Vec<i64> {
        let map = |queued: &Queued| match queued.job {
            Job::DeleteMap(map) => map,
            _ => unreachable!("only deletions were queued"),
        };
        group.iter().map(map).collect()
    }

    #[test]
    fn a_line_of_a_thousand_jobs_delays_another_line_by_one_group() {
        let (long, short) = (PoisonFlag::default(), PoisonFlag::default());
        let mut lanes = Lanes::default();
        (0..1000).for_each(|number| lanes.push(queued(&long, number)));
        lanes.push(queued(&short, 5000));
        assert_eq!(taken(&lanes.take())[..3], [0, 5000, 1]);
        let mut rest = Vec::new();
        while !lanes.is_empty() {
            rest.extend(taken(&lanes.take()));
        }
        assert!(rest.is_sorted(), "a line keeps its order: {rest:?}");
    }

    #[test]
    fn a_lone_line_fills_a_group_that_two_lines_may_not() {
        let (long, short) = (PoisonFlag::default(), PoisonFlag::default());
        let first_group_of = |lines: &[&PoisonFlag]| {
            let mut lanes = Lanes::default();
            for line in lines {
                (0..1000).for_each(|number| lanes.push(queued(line, number)));
            }
            lanes.take().len()
        };
        let cost_us = queued(&long, 0).job.cost_us() as usize;
        assert_eq!(first_group_of(&[&long]), MAX_GROUP);
        assert_eq!(first_group_of(&[&long, &short]), GROUP_COST_US as usize / cost_us);
    }

    #[test]
    fn settling_waits_for_the_jobs_before_it_and_not_for_those_after_it() {
        let (a, b) = (PoisonFlag::default(), PoisonFlag::default());
        let mut lanes = Lanes::default();
        lanes.push(queued(&a, 1));
        let (settled, mut answer) = oneshot::channel();
        lanes.settle(settled);
        for number in 0..1000 {
            lanes.push(queued(&b, number));
        }
        lanes.answer_settled();
        assert!(answer.try_recv().is_err());
        lanes.take();
        lanes.answer_settled();
        assert!(!lanes.is_empty());
        assert!(answer.try_recv().is_ok());
    }
}
