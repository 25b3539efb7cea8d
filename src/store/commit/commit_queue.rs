//! One writer with group commit: jobs that arrive together share one transaction, and one fsync.
//!
//! A job is acknowledged after COMMIT has returned, with `synchronous=FULL`. If a group fails, each of its
//! jobs is tried alone, so that one bad job cannot take the others with it; a job that fails alone
//! marks its map's line of jobs as broken, since what was planned after it was planned upon it.
//! The other end of the queue is [`super::group_commit`].

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use sqlx::sqlite::SqlitePool;
use tokio::sync::{mpsc, oneshot};

use super::group_commit::Writer;
use super::health::Health;
use super::job::Job;
use crate::store::StoreError;
use crate::store::files::disk_reserve::Reserve;
use crate::store::files::lock::DatabaseLock;
use crate::store::slices::deferred;

/// A line of jobs of one map: they were planned one upon the other.
pub type PoisonFlag = Arc<AtomicBool>;

/// A job that waits.
pub(in crate::store) struct Queued {
    pub job: Job,
    /// True once a job of this line has failed.
    pub broken: PoisonFlag,
    pub done: Done,
}

/// Called by the writer when a job is on disk, or will never be: even if nobody waits any more.
pub(in crate::store) type Done = Box<dyn FnOnce(Result<(), StoreError>) + Send + Sync>;

/// What the writer is told.
pub(in crate::store) enum Message {
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
pub(in crate::store) struct Counters {
    pub jobs: AtomicU64,
    pub transactions: AtomicU64,
    pub waiting: AtomicU64,
}

/// The handle to the one writer.
#[derive(Clone, Debug)]
pub struct Committer {
    queue: mpsc::UnboundedSender<Message>,
    counters: Arc<Counters>,
    health: Health,
}

impl Committer {
    /// Starts the writer on its own connection, in a thread of its own.
    ///
    /// A group is a chain of statements, each of which wakes the writer when it is done. On the runtime that answers
    /// requests each of these waits behind the requests' tasks, so that a busy server committed slowly.
    pub(in crate::store) fn start(
        pool: SqlitePool,
        reserve: Reserve,
        lock: Option<Arc<DatabaseLock>>,
    ) -> Result<Self, StoreError> {
        let failed = |error: std::io::Error| StoreError::Database(format!("the writer's thread: {error}"));
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().map_err(failed)?;
        // Unbounded, because whoever plans holds the map's lock and must not wait here; the service
        // bounds how many requests plan at once.
        let (queue, jobs) = mpsc::unbounded_channel();
        let counters = Arc::new(Counters::default());
        let health = Health::default();
        let writer = Writer {
            pool,
            reserve,
            counters: counters.clone(),
            health: health.clone(),
            serves: lock.is_some(),
        };
        let run = move || {
            runtime.block_on(writer.run(jobs));
            // Nobody else may write before the last job has.
            drop(lock);
        };
        std::thread::Builder::new().name("writer".to_owned()).spawn(run).map_err(failed)?;
        Ok(Self { queue, counters, health })
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

    /// Queues a job behind those of its line, a large one in parts. `done` hears when it is on disk.
    pub fn submit(
        &self,
        job: Job,
        line: &PoisonFlag,
        done: impl FnOnce(Result<(), StoreError>) + Send + Sync + 'static,
    ) {
        let mut jobs = deferred::staged(job);
        let Some(last) = jobs.pop() else { return };
        for part in jobs {
            self.queue_up(Queued { job: part, broken: line.clone(), done: Box::new(drop) });
        }
        self.queue_up(Queued { job: last, broken: line.clone(), done: Box::new(done) });
    }

    fn queue_up(&self, queued: Queued) {
        self.counters.waiting.fetch_add(1, Ordering::Relaxed);
        let message = Message::Job(Box::new(queued));
        if let Err(mpsc::error::SendError(Message::Job(queued))) = self.queue.send(message) {
            (queued.done)(Err(StoreError::Closed));
        }
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
    pub(in crate::store) async fn close(&self) {
        let (closed, heard) = oneshot::channel();
        if self.queue.send(Message::Close(closed)).is_ok() {
            let _ = heard.await;
        }
    }
}

#[cfg(test)]
mod tests {
    use sqlx::sqlite::{SqliteConnectOptions, SqlitePoolOptions};

    use super::*;
    use crate::domain::map::MapProperties;
    use crate::store::files::schema;

    const ROOM_FOR_ANYTHING: i64 = 1 << 30;

    /// A writer on a database that SQLite itself keeps small, as a full disk does.
    async fn cramped(folder: &tempfile::TempDir) -> (SqlitePool, Committer) {
        let path = folder.path().join("cramped.db");
        let options = SqliteConnectOptions::new().filename(&path).create_if_missing(true);
        let options = options.journal_mode(sqlx::sqlite::SqliteJournalMode::Wal);
        let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await.expect("a pool");
        schema::migrate(&pool).await.expect("a schema");
        let committer = Committer::start(pool.clone(), Reserve::beside(&path), None).expect("a writer");
        (pool, committer)
    }

    async fn pages_at_most(pool: &SqlitePool, pages: i64) {
        let pragma = sqlx::AssertSqlSafe(format!("pragma max_page_count = {pages}"));
        sqlx::query(pragma).execute(pool).await.expect("a pragma");
    }

    fn map(key: i64) -> Job {
        let properties = MapProperties { description: "x".repeat(4000), ..MapProperties::default() };
        let id = format!("map-{key}").parse().expect("an id");
        Job::CreateMap { id, properties: Box::new(properties), digest: [0; 32], owner: None }
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
        sqlx::query("pragma user_version = 77").execute(&pool).await.expect("a pragma");
        pages_at_most(&pool, ROOM_FOR_ANYTHING).await;
        while committer.refuses(false).is_some() {
            tokio::task::yield_now().await; // The writer tries by itself.
        }
        committer.commit(map(key)).await.expect("a write, without a restart");
        let events: i64 = sqlx::query_scalar("pragma user_version").fetch_one(&pool).await.expect("a pragma");
        assert_eq!(events, 77, "numbers of events are not given again");
    }

    #[tokio::test]
    async fn a_verdict_that_is_not_kept_breaks_no_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let (pool, committer) = cramped(&folder).await;
        committer.commit(map(1)).await.expect("a map");
        pages_at_most(&pool, 1).await;
        let line = PoisonFlag::default();
        let (committed, heard) = oneshot::channel();
        let body = bytes::Bytes::from(vec![b'x'; 1 << 20]);
        let job = Job::KeepQuery { map: 1, id: "q-1".to_owned(), kept: 1, body };
        committer.submit(job, &line, move |result| drop(committed.send(result)));
        assert!(matches!(heard.await, Ok(Err(StoreError::DiskFull))));
        assert!(!line.load(Ordering::Acquire), "the map need not be loaded anew");
    }
}
