//! One writer with group commit: jobs that arrive together share one transaction, and one fsync.
//!
//! A job is acknowledged after COMMIT has returned, with `synchronous=FULL`. If a group fails, each of its
//! jobs is tried alone, so that one bad job cannot take the others with it; a job that fails alone
//! marks its map's line of jobs as broken, since what was planned after it was planned upon it.
//! The other end of the [`super::queue`] is [`super::group_commit`].

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use tokio::sync::{mpsc, oneshot};

use super::health::{Disk, Health};
use super::held::Held;
use super::queue::{Counters, Message, PoisonFlag, Queued, Renewal};
use super::staging;
use crate::StoreError;
use crate::jobs::job::Job;

/// Figures of the committer since it started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CommitStats {
    /// Jobs committed.
    pub jobs: u64,
    /// Transactions they took.
    pub transactions: u64,
    /// Jobs waiting now.
    pub waiting: u64,
}

/// The handle to the one writer.
#[derive(Clone, Debug)]
pub struct Committer {
    held: Held,
    counters: Arc<Counters>,
    health: Health,
}

impl Committer {
    /// Returns a handle to a writer that takes from this queue.
    pub(crate) fn to(queue: mpsc::UnboundedSender<Message>, counters: Arc<Counters>, health: Health) -> Self {
        Self { held: Held::before(queue), counters, health }
    }

    /// Returns the state of the disk.
    pub fn disk(&self) -> Disk {
        self.health.disk()
    }

    /// Why a write need not be decided now, if the disk is known to take none.
    pub fn refuses(&self, frees_space: bool) -> Option<StoreError> {
        self.health.refuses(frees_space)
    }

    /// Returns why a write need not be decided now. A full disk is tried first: it may have room again.
    pub async fn refuses_now(&self, frees_space: bool) -> Option<StoreError> {
        let error = self.refuses(frees_space)?;
        if self.disk() != Disk::Full {
            return Some(error);
        }
        let (tried, heard) = oneshot::channel();
        if self.held.send_message(Message::TryDisk(tried)) {
            let _ = heard.await;
        }
        self.refuses(frees_space)
    }

    /// Waits until whatever is queued now is on disk, or never will be.
    pub async fn settled(&self) {
        let (settled, heard) = oneshot::channel();
        if self.held.send_message(Message::Settle(settled)) {
            let _ = heard.await;
        }
    }

    /// Has the writer look for background work that another server left.
    pub fn look_for_work(&self) {
        self.held.send_message(Message::Look);
    }

    /// Writes the database's file anew, without what was deleted from it. Jobs wait meanwhile, seconds for each gigabyte: returns
    /// how long.
    pub async fn renew_file(&self) -> Result<Duration, StoreError> {
        self.renew(Renewal::File).await
    }

    /// Brings the write-ahead log into the file and cuts it to nothing; [`StoreError::Busy`] while somebody reads an older version.
    /// Returns how long jobs waited.
    pub async fn renew_log(&self) -> Result<Duration, StoreError> {
        self.renew(Renewal::Log).await
    }

    async fn renew(&self, renewal: Renewal) -> Result<Duration, StoreError> {
        let (renewed, heard) = oneshot::channel();
        if !self.held.send_message(Message::Renew(renewal, renewed)) {
            return Err(StoreError::Closed);
        }
        heard.await.unwrap_or(Err(StoreError::Closed))
    }

    /// Queues a job behind those of its line, a large one in parts. `done` hears when it is on disk.
    pub fn submit(
        &self,
        job: Job,
        line: &PoisonFlag,
        done: impl FnOnce(Result<(), StoreError>) + Send + Sync + 'static,
    ) {
        self.held.send(self.queued(job, line, done));
    }

    /// Queues a job like [`Self::submit`], but more may follow soon: it waits for them a moment, and shares a sync with them.
    pub fn submit_held(
        &self,
        job: Job,
        line: &PoisonFlag,
        done: impl FnOnce(Result<(), StoreError>) + Send + Sync + 'static,
    ) {
        let mut jobs = self.queued(job, line, done);
        match (jobs.pop(), jobs.is_empty()) {
            (Some(only), true) => self.held.hold(only),
            // A large job shares its sync with nobody.
            (last, _) => {
                jobs.extend(last);
                self.held.send(jobs);
            }
        }
    }

    /// Has the writer commit what is held: somebody waits for it.
    pub fn commit_held(&self) {
        self.held.release();
    }

    /// Returns the parts of a job, of which the last is answered.
    fn queued(
        &self,
        job: Job,
        line: &PoisonFlag,
        done: impl FnOnce(Result<(), StoreError>) + Send + Sync + 'static,
    ) -> Vec<Queued> {
        let mut parts = staging::staged(job);
        let Some(last) = parts.pop() else { return Vec::new() };
        let part = |job| Queued { job, broken: line.clone(), done: Box::new(drop) };
        let mut queued: Vec<Queued> = parts.into_iter().map(part).collect();
        queued.push(Queued { job: last, broken: line.clone(), done: Box::new(done) });
        self.counters.waiting.fetch_add(queued.len() as u64, Ordering::Relaxed);
        queued
    }

    /// Commits a job that belongs to no line, and waits until it is on disk.
    pub async fn commit(&self, job: Job) -> Result<(), StoreError> {
        let (committed, heard) = oneshot::channel();
        self.submit(job, &PoisonFlag::default(), move |result| drop(committed.send(result)));
        heard.await.unwrap_or(Err(StoreError::Closed))
    }

    /// Queues a job that belongs to no line; it is written behind.
    pub fn submit_alone(&self, job: Job) {
        self.submit(job, &PoisonFlag::default(), drop);
    }

    /// Figures since the start.
    pub fn stats(&self) -> CommitStats {
        CommitStats {
            jobs: self.counters.jobs.load(Ordering::Relaxed),
            transactions: self.counters.transactions.load(Ordering::Relaxed),
            waiting: self.counters.waiting.load(Ordering::Relaxed),
        }
    }

    /// Finishes what is queued and stops.
    pub(crate) async fn close(&self) {
        let (closed, heard) = oneshot::channel();
        if self.held.send_message(Message::Close(closed)) {
            let _ = heard.await;
        }
    }
}
