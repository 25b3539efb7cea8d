//! Staging: a batch whose poses and points would keep the writer busy becomes several jobs ([`crate::loading::deferred`]).

use std::borrow::Cow;

use revisit_core::domain::change::Change;

use crate::jobs::cost;
use crate::jobs::job::Job;
use crate::log::log_rows::FIRST_PART;
use crate::log::parts::{self, can_wait};
use crate::sizes::sizes;

/// Returns the jobs that stage a batch's large changes, if it has any, and the one that commits it.
pub(crate) fn staged(job: Job) -> Vec<Job> {
    let Job::Change(mut batch) = job else { return vec![job] };
    let cost: u64 = batch.changes.iter().filter(|change| can_wait(change)).map(cost::of_change).sum();
    if cost <= sizes().direct_us {
        return vec![Job::Change(batch)];
    }
    let frees_space = Job::batch_frees_space(&batch);
    let (map, version) = (batch.map, batch.version);
    let former = std::mem::take(&mut batch.former);
    let (waiting, rest): (Vec<Change>, Vec<Change>) =
        std::mem::take(&mut batch.changes).into_iter().partition(can_wait);
    batch.changes = rest;
    let mut parts = parts::moved(waiting.into_iter().map(Cow::Owned), !former.is_empty());
    parts.extend(parts::replaced(former));
    // Who follows the map would be told a part of it only.
    batch.is_followed = false;
    let stage = |(number, part)| Job::Stage { map, version, number, part, frees_space };
    let mut jobs: Vec<Job> = (FIRST_PART + 1..).zip(parts).map(stage).collect();
    jobs.push(Job::ChangeStaged { batch, frees_space });
    jobs
}
