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

use super::commit_queue::{Counters, Message, Queued};
use super::health::{Disk, Health};
use super::job::Job;
use super::lanes::Lanes;
use super::transaction::Transaction;
use super::write;
use crate::store::StoreError;
use crate::store::files::disk_reserve::Reserve;
use crate::store::rows::map_rows;
use crate::store::slices::background::Slices;

/// How often a disk that is not well is tried.
const TRY_AGAIN_EVERY: Duration = Duration::from_millis(500);

/// The writer's own side of the queue.
pub(in crate::store) struct Writer {
    pub pool: SqlitePool,
    pub reserve: Reserve,
    pub counters: Arc<Counters>,
    pub health: Health,
    /// Whether this process is the one that serves, and does the background work.
    pub serves: bool,
}

impl Writer {
    /// Commits until the queue is closed.
    pub(in crate::store) async fn run(self, mut queue: mpsc::UnboundedReceiver<Message>) {
        self.keep_reserve(self.reserve.bytes()).await;
        let mut slices = if self.serves { Slices::resume(&self.pool).await } else { Slices::none() };
        let (mut lanes, mut closing) = (Lanes::default(), None);
        let mut tried = Instant::now();
        loop {
            let mut next = if lanes.is_empty() && closing.is_none() {
                let received = match self.wakes_at(&slices, tried) {
                    Some(at) => tokio::time::timeout_at(at, queue.recv()).await.ok(),
                    None => Some(queue.recv().await),
                };
                match received {
                    Some(None) => return,
                    message => message.flatten(),
                }
            } else {
                None
            };
            // Nothing is taken behind the wish to close.
            while closing.is_none() {
                match next.take().or_else(|| queue.try_recv().ok()) {
                    Some(Message::Job(queued)) => lanes.push(*queued),
                    Some(Message::Settle(settled)) => lanes.settle(settled),
                    Some(Message::Close(closed)) => closing = Some(closed),
                    None => break,
                }
            }
            let group = lanes.take();
            if !group.is_empty() {
                if self.serves && group.iter().any(|queued| queued.job.leaves_slices()) {
                    slices.add();
                }
                self.commit_group(group).await;
                slices.beside_client();
            }
            lanes.answer_settled();
            if lanes.is_empty()
                && let Some(closed) = closing.take()
            {
                queue.close();
                self.checkpoint().await;
                self.pool.close().await;
                let _ = closed.send(());
                return;
            }
            if self.health.disk() != Disk::Well && tried.elapsed() >= TRY_AGAIN_EVERY {
                self.try_disk().await;
                tried = Instant::now();
            }
            self.do_slice(&mut slices, lanes.is_empty() && queue.is_empty()).await;
        }
    }

    /// When there is something to do though no message comes.
    fn wakes_at(&self, slices: &Slices, tried: Instant) -> Option<Instant> {
        let try_disk = (self.health.disk() != Disk::Well).then_some(tried + TRY_AGAIN_EVERY);
        let slice = match self.health.disk() {
            Disk::Failing => None,
            disk => slices.due(disk == Disk::Full),
        };
        try_disk.into_iter().chain(slice).min()
    }

    /// Does a slice of the background work, if one is due.
    async fn do_slice(&self, slices: &mut Slices, is_idle: bool) {
        let is_full = match self.health.disk() {
            Disk::Failing => return,
            disk => disk == Disk::Full,
        };
        let due = if is_idle { slices.due(is_full) } else { slices.overdue(is_full) };
        if due.is_none_or(|due| due > Instant::now()) {
            return;
        }
        if is_full {
            self.release_reserve().await;
        }
        self.counters.transactions.fetch_add(1, Ordering::Relaxed);
        if let Err(error) = slices.run(&self.pool, is_full).await {
            warn!(%error, "a slice of a deletion or correction did not commit; it is tried again");
            self.health.learn(&error);
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
        if let Err(error) = write::execute(&mut transaction, jobs).await {
            transaction.roll_back().await;
            return Err(error);
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
        match map_rows::rewrite_event_number(&mut transaction).await {
            Ok(()) => transaction.commit().await,
            Err(error) => {
                transaction.roll_back().await;
                Err(error)
            }
        }
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

impl Queued {
    /// It will never be on disk, and neither will what was planned upon it.
    fn fail(self, error: StoreError) {
        if self.job.is_planned_upon() {
            self.broken.store(true, Ordering::Release);
        }
        (self.done)(Err(error));
    }
}
