//! One writer with group commit: jobs that arrive together share one transaction, and one fsync.
//!
//! A job is acknowledged after COMMIT has returned, with `synchronous=FULL`. If a group fails, each of its
//! jobs is tried alone, so that one bad job cannot take the others with it; a job that fails alone
//! marks its map's line of jobs as broken, since what was planned after it was planned upon it.
//!
//! If it was the disk that failed, it is no job's fault and nothing is tried again: the whole group is refused, and what
//! comes after it, until a commit of the writer's own has passed. That commit also takes the place in the write-ahead
//! log where the failed one may stand. On a full disk what frees space is tried all the same, with the reserve's space.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use sqlx::sqlite::SqlitePool;
use tokio::sync::{mpsc, oneshot};
use tokio::time::Instant;
use tracing::{error, warn};

use super::StoreError;
use super::health::{Disk, Health};
use super::lock::DatabaseLock;
use super::reserve::Reserve;
use super::transaction::Transaction;
use super::write::{self, Job};

/// How often a disk that is not well is tried.
const TRY_AGAIN_EVERY: Duration = Duration::from_millis(500);

/// At most so many jobs share one transaction.
const MAX_GROUP: usize = 256;

/// A line of jobs of one map: they were planned one upon the other.
pub type Line = Arc<AtomicBool>;

struct Queued {
    job: Job,
    /// True once a job of this line has failed.
    broken: Line,
    done: Done,
}

/// Called by the writer when a job is on disk, or will never be: even if nobody waits any more.
type Done = Box<dyn FnOnce(Result<(), StoreError>) + Send + Sync>;

enum Message {
    Job(Box<Queued>),
    /// Answered once everything queued before it is settled.
    Settle(oneshot::Sender<()>),
    Close(oneshot::Sender<()>),
}

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

#[derive(Debug, Default)]
struct Counters {
    jobs: AtomicU64,
    transactions: AtomicU64,
    waiting: AtomicU64,
}

/// The handle to the one writer.
#[derive(Clone, Debug)]
pub struct Committer {
    queue: mpsc::UnboundedSender<Message>,
    counters: Arc<Counters>,
    health: Health,
}

impl Committer {
    /// Starts the writer on its own connection.
    pub(super) fn start(pool: SqlitePool, reserve: Reserve, lock: Option<Arc<DatabaseLock>>) -> Self {
        // Unbounded, because whoever plans holds the map's lock and must not wait here; the service
        // bounds how many requests plan at once.
        let (queue, jobs) = mpsc::unbounded_channel();
        let counters = Arc::new(Counters::default());
        let health = Health::default();
        let writer = Writer { pool, reserve, counters: counters.clone(), health: health.clone() };
        tokio::spawn(async move {
            writer.run(jobs).await;
            // Nobody else may write before the last job has.
            drop(lock);
        });
        Self { queue, counters, health }
    }

    /// Why a write need not be decided now, if the disk is known to take none.
    pub fn refuses(&self, frees_space: bool) -> Option<StoreError> {
        self.health.refuses(frees_space)
    }

    /// Waits until whatever is queued now is on disk, or never will be.
    pub async fn settled(&self) {
        let (settled, heard) = oneshot::channel();
        if self.queue.send(Message::Settle(settled)).is_ok() {
            let _ = heard.await;
        }
    }

    /// Queues a job behind those of its line. `done` hears when it is on disk.
    pub fn submit(
        &self,
        job: Job,
        line: &Line,
        done: impl FnOnce(Result<(), StoreError>) + Send + Sync + 'static,
    ) {
        self.counters.waiting.fetch_add(1, Ordering::Relaxed);
        let queued = Box::new(Queued { job, broken: line.clone(), done: Box::new(done) });
        if let Err(mpsc::error::SendError(Message::Job(queued))) = self.queue.send(Message::Job(queued)) {
            (queued.done)(Err(StoreError::Closed));
        }
    }

    /// Commits a job that belongs to no line, and waits until it is on disk.
    pub async fn commit(&self, job: Job) -> Result<(), StoreError> {
        let (committed, heard) = oneshot::channel();
        self.submit(job, &Line::default(), move |result| drop(committed.send(result)));
        heard.await.unwrap_or(Err(StoreError::Closed))
    }

    /// Queues a job that belongs to no line; it is written behind.
    pub fn submit_alone(&self, job: Job) {
        self.submit(job, &Line::default(), drop);
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
    pub(super) async fn close(&self) {
        let (closed, heard) = oneshot::channel();
        if self.queue.send(Message::Close(closed)).is_ok() {
            let _ = heard.await;
        }
    }
}

/// The writer's own side of the queue.
struct Writer {
    pool: SqlitePool,
    reserve: Reserve,
    counters: Arc<Counters>,
    health: Health,
}

impl Writer {
    async fn run(self, mut queue: mpsc::UnboundedReceiver<Message>) {
        self.keep_reserve().await;
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
            if !self.keep_reserve().await {
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

    /// False if the disk has not got the space, or nothing beside it.
    async fn keep_reserve(&self) -> bool {
        let reserve = self.reserve.clone();
        let kept = tokio::task::spawn_blocking(move || reserve.keep() && reserve.is_room());
        kept.await.unwrap_or(true)
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

#[cfg(test)]
mod tests {
    use sqlx::sqlite::{SqliteConnectOptions, SqlitePoolOptions};

    use super::*;
    use crate::model::map::MapProperties;
    use crate::store::schema;

    const ROOM_FOR_ANYTHING: i64 = 1 << 30;

    /// A writer on a database that SQLite itself keeps small, as a full disk does.
    async fn cramped(folder: &tempfile::TempDir) -> (SqlitePool, Committer) {
        let path = folder.path().join("cramped.db");
        let options = SqliteConnectOptions::new().filename(&path).create_if_missing(true);
        let options = options.journal_mode(sqlx::sqlite::SqliteJournalMode::Wal);
        let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await.expect("a pool");
        schema::migrate(&pool).await.expect("a schema");
        let committer = Committer::start(pool.clone(), Reserve::beside(&path), None);
        (pool, committer)
    }

    async fn pages_at_most(pool: &SqlitePool, pages: i64) {
        let pragma = sqlx::AssertSqlSafe(format!("pragma max_page_count = {pages}"));
        sqlx::query(pragma).execute(pool).await.expect("a pragma");
    }

    fn map(key: i64) -> Job {
        let properties = MapProperties { description: "x".repeat(4000), ..MapProperties::default() };
        let id = format!("map-{key}").parse().expect("an id");
        Job::CreateMap { key, id, properties: Box::new(properties), digest: [0; 32], owner: None }
    }

    #[tokio::test]
    async fn writes_go_on_when_a_full_disk_has_room_again_and_deletes_never_stop() {
        let folder = tempfile::tempdir().expect("a folder");
        let (pool, committer) = cramped(&folder).await;
        pages_at_most(&pool, 1).await; // Not below what there is.
        let mut key = 0;
        let refused = loop {
            key += 1;
            match committer.commit(map(key)).await {
                Ok(()) => assert!(key < 1000, "the disk never gets full"),
                Err(error) => break error,
            }
        };
        assert!(matches!(refused, StoreError::DiskFull), "{refused}");
        assert!(matches!(committer.refuses(false), Some(StoreError::DiskFull)));
        assert!(committer.refuses(true).is_none(), "deletes are tried");
        committer.commit(Job::DeleteMap(1)).await.expect("a delete on a full disk");
        pages_at_most(&pool, ROOM_FOR_ANYTHING).await;
        while committer.refuses(false).is_some() {
            tokio::task::yield_now().await; // The writer tries by itself.
        }
        committer.commit(map(key)).await.expect("a write, without a restart");
    }

    #[tokio::test]
    async fn a_verdict_that_is_not_kept_breaks_no_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let (pool, committer) = cramped(&folder).await;
        committer.commit(map(1)).await.expect("a map");
        pages_at_most(&pool, 1).await;
        let line = Line::default();
        let (committed, heard) = oneshot::channel();
        let body = bytes::Bytes::from(vec![b'x'; 1 << 20]);
        let job = Job::KeepQuery { map: 1, id: "q-1".to_owned(), kept: 1, body };
        committer.submit(job, &line, move |result| drop(committed.send(result)));
        assert!(matches!(heard.await, Ok(Err(StoreError::DiskFull))));
        assert!(!line.load(Ordering::Acquire), "the map need not be loaded anew");
    }
}
