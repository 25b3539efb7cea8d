//! A group of jobs: all in one transaction, or each in its own if that fails.
//!
//! If it was the disk that failed, it is no job's fault and nothing is tried again: the whole group is refused.

use std::collections::BTreeSet;
use std::sync::atomic::Ordering;

use tracing::{error, warn};

use super::group_commit::Writer;
use super::health::Disk;
use super::queue::Queued;
use super::write;
use crate::StoreError;
use crate::jobs::job::Job;
use crate::map_key::MapKey;
use crate::sql::Connection;
use crate::sql::transaction::Transaction;

impl Writer {
    /// Commits a group that the lanes gave, and tells whoever waits for a job of it.
    pub(super) async fn commit_group(&self, group: Vec<Queued>) {
        let size = group.len() as u64;
        let mut ready = Vec::new();
        for queued in group {
            if queued.broken.load(Ordering::Acquire) {
                (queued.done)(Err(StoreError::Superseded));
            } else if let Some(error) = self.health.refuses(queued.job.frees_space()) {
                queued.fail(error);
            } else {
                ready.push(queued);
            }
        }
        if !ready.is_empty() {
            self.commit_ready(ready).await;
        }
        self.counters.waiting.fetch_sub(size, Ordering::Relaxed);
    }

    async fn commit_ready(&self, group: Vec<Queued>) {
        if self.health.disk() == Disk::Full {
            // Only what frees space came this far.
            self.release_reserve().await;
        }
        match self.commit(group.iter().map(|queued| &queued.job)).await {
            Ok(()) => self.committed(group),
            Err(error @ (StoreError::Disk(_) | StoreError::Away(_))) => {
                error!(%error, jobs = group.len(), "the disk failed a group");
                for queued in group {
                    queued.fail(error.clone());
                }
            }
            Err(error) => {
                warn!(%error, jobs = group.len(), "a group did not commit; trying its jobs one by one");
                for queued in group {
                    self.commit_alone(queued).await;
                }
            }
        }
    }

    async fn commit_alone(&self, queued: Queued) {
        if queued.broken.load(Ordering::Acquire) {
            return (queued.done)(Err(StoreError::Superseded));
        }
        if let Some(error) = self.health.refuses(queued.job.frees_space()) {
            return queued.fail(error);
        }
        if self.health.disk() == Disk::Full {
            self.release_reserve().await;
        }
        match self.commit(std::iter::once(&queued.job)).await {
            Ok(()) => self.committed(vec![queued]),
            Err(error) => {
                error!(%error, "a job did not commit");
                queued.fail(error);
            }
        }
    }

    fn committed(&self, group: Vec<Queued>) {
        self.counters.jobs.fetch_add(group.len() as u64, Ordering::Relaxed);
        for queued in group {
            (queued.done)(Ok(()));
        }
    }

    async fn commit<'j>(&self, jobs: impl Iterator<Item = &'j Job> + Clone) -> Result<(), StoreError> {
        self.counters.transactions.fetch_add(1, Ordering::Relaxed);
        let result = self.transact(jobs).await;
        if let Err(error) = &result {
            self.health.learn(error);
        }
        result
    }

    async fn transact<'j>(&self, jobs: impl Iterator<Item = &'j Job> + Clone) -> Result<(), StoreError> {
        let mut transaction = Transaction::write(&self.pool).await?;
        if let Err(error) = self.execute(&mut transaction, jobs).await {
            transaction.roll_back().await;
            return Err(error);
        }
        transaction.commit().await
    }

    async fn execute<'j>(
        &self,
        db: &mut Connection,
        jobs: impl Iterator<Item = &'j Job> + Clone,
    ) -> Result<(), StoreError> {
        if let Some(leases) = &self.leases {
            let maps: BTreeSet<MapKey> = jobs.clone().filter_map(Job::fenced_map).collect();
            leases.fence(db, &maps.into_iter().collect::<Vec<_>>()).await?;
        }
        write::execute(db, jobs).await
    }
}
