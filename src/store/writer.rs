//! Writer: takes jobs from the queue, as many as wait, and commits them.
//!
//! If it was the disk that failed, it is no job's fault and nothing is tried again: the whole group is refused, and what
//! comes after it, until a commit of the writer's own has passed. That commit also takes the place in the write-ahead
//! log where the failed one may stand. On a full disk what frees space is tried all the same, with the reserve's space.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use sqlx::sqlite::SqlitePool;
use tokio::sync::mpsc;
use tokio::time::Instant;
use tracing::{error, warn};

use super::StoreError;
use super::committer::{Counters, Message, Queued};
use super::health::{Disk, Health};
use super::job::Job;
use super::reserve::Reserve;
use super::transaction::Transaction;
use super::write;

/// At most so many jobs share one transaction.
const MAX_GROUP: usize = 256;

/// How often a disk that is not well is tried.
const TRY_AGAIN_EVERY: Duration = Duration::from_millis(500);

/// The writer's own side of the queue.
pub(super) struct Writer {
    pub pool: SqlitePool,
    pub reserve: Reserve,
    pub counters: Arc<Counters>,
    pub health: Health,
}

impl Writer {
    /// Commits until the queue is closed.
    pub(super) async fn run(self, mut queue: mpsc::UnboundedReceiver<Message>) {
        self.keep_reserve(self.reserve.bytes()).await;
        let mut tried = Instant::now();
        loop {
            let first = if self.health.disk() == Disk::Well {
                queue.recv().await
            } else {
                if tried.elapsed() >= TRY_AGAIN_EVERY {
                    self.try_disk().await;
                    tried = Instant::now();
                }
                match tokio::time::timeout_at(tried + TRY_AGAIN_EVERY, queue.recv()).await {
                    Ok(first) => first,
                    Err(_) => continue,
                }
            };
            let Some(first) = first else { return };
            let (group, last) = gather(first, &mut queue);
            self.commit_group(group).await;
            match last {
                Some(Message::Settle(settled)) => drop(settled.send(())),
                Some(Message::Close(closed)) => {
                    queue.close();
                    self.checkpoint().await;
                    self.pool.close().await;
                    let _ = closed.send(());
                    return;
                }
                Some(Message::Job(_)) | None => {}
            }
        }
    }

    /// Brings the log into the database, unless somebody still reads (a backup): then the next start does.
    async fn checkpoint(&self) {
        let Ok(mut db) = self.pool.acquire().await else { return };
        let settled = async {
            sqlx::query("pragma busy_timeout = 0").execute(&mut *db).await?;
            sqlx::query("pragma wal_checkpoint(truncate)").execute(&mut *db).await
        };
        if let Err(error) = settled.await {
            warn!(%error, "the write-ahead log stays beside the database until the next start");
        }
    }

    async fn commit_group(&self, group: Vec<Queued>) {
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
            Err(error @ StoreError::Disk(_)) => {
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

    async fn commit(&self, jobs: impl Iterator<Item = &Job>) -> Result<(), StoreError> {
        self.counters.transactions.fetch_add(1, Ordering::Relaxed);
        let result = self.transact(jobs).await;
        if let Err(error) = &result {
            self.health.learn(error);
        }
        result
    }

    async fn transact(&self, jobs: impl Iterator<Item = &Job>) -> Result<(), StoreError> {
        let mut transaction = Transaction::write(&self.pool).await?;
        for job in jobs {
            if let Err(error) = write::execute(&mut transaction, job).await {
                transaction.roll_back().await;
                return Err(error);
            }
        }
        transaction.commit().await
    }

    /// Looks whether a disk that was full or failed is well again.
    async fn try_disk(&self) {
        if self.health.disk() == Disk::Full {
            // Gives back to the disk what deletes left in the log.
            self.empty_log().await;
            // A database that has as much free within needs no more for itself: only its log must fit beside it.
            let enough = self.reserve.bytes().saturating_sub(self.free_within().await);
            if !self.keep_reserve(enough).await {
                return;
            }
        }
        match self.write_something().await {
            Ok(()) => self.health.set(Disk::Well),
            Err(error) => self.health.learn(&error),
        }
    }

    /// Writes a page and syncs it. A failed commit's place in the log is this one's: what was refused cannot come back.
    async fn write_something(&self) -> Result<(), StoreError> {
        let mut transaction = Transaction::write(&self.pool).await?;
        if let Err(error) = sqlx::query("pragma user_version = 1").execute(&mut *transaction).await {
            transaction.roll_back().await;
            return Err(error.into());
        }
        transaction.commit().await
    }

    /// What deletes have freed within the database's file, in bytes.
    async fn free_within(&self) -> u64 {
        let select = "select freelist_count * page_size from pragma_freelist_count, pragma_page_size";
        let free: Result<i64, _> = sqlx::query_scalar(select).fetch_one(&self.pool).await;
        free.map_or(0, i64::unsigned_abs)
    }

    /// False if the disk has not got the space, or nothing beside it.
    async fn keep_reserve(&self, enough: u64) -> bool {
        let reserve = self.reserve.clone();
        tokio::task::spawn_blocking(move || reserve.keep(enough)).await.unwrap_or(true)
    }

    async fn release_reserve(&self) {
        let reserve = self.reserve.clone();
        let _ = tokio::task::spawn_blocking(move || reserve.release()).await;
        self.empty_log().await;
    }

    /// Brings the write-ahead log into the database's file, and frees its space.
    async fn empty_log(&self) {
        if let Err(error) = sqlx::query("pragma wal_checkpoint(truncate)").execute(&self.pool).await {
            tracing::debug!(%error, "the write-ahead log stays as it is");
        }
    }
}

/// The jobs that wait, up to a group; a message of another kind ends them.
fn gather(first: Message, queue: &mut mpsc::UnboundedReceiver<Message>) -> (Vec<Queued>, Option<Message>) {
    let mut group = Vec::new();
    let mut next = Some(first);
    while let Some(message) = next {
        match message {
            Message::Job(queued) => group.push(*queued),
            other => return (group, Some(other)),
        }
        next = if group.len() < MAX_GROUP { queue.try_recv().ok() } else { None };
    }
    (group, None)
}

impl Queued {
    /// It will never be on disk, and neither will what was planned upon it.
    fn fail(self, error: StoreError) {
        if self.job.is_planned_upon() {
            self.broken.store(true, Ordering::Release);
        }
        (self.done)(Err(error));
    }
}
