//! One writer with group commit: jobs that arrive together share one transaction, and one fsync.
//!
//! A job is acknowledged after COMMIT has returned, with `synchronous=FULL`. If a group fails, each of its
//! jobs is tried alone, so that one bad job cannot take the others with it; a job that fails alone
//! marks its map's line of jobs as broken, since what was planned after it was planned upon it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use sqlx::sqlite::SqlitePool;
use tokio::sync::{mpsc, oneshot};
use tracing::{error, warn};

use super::StoreError;
use super::lock::DatabaseLock;
use super::write::{self, Job};

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
}

impl Committer {
    /// Starts the writer on its own connection.
    pub(super) fn start(pool: SqlitePool, lock: Option<Arc<DatabaseLock>>) -> Self {
        // Unbounded, because whoever plans holds the map's lock and must not wait here; the service
        // bounds how many requests plan at once.
        let (queue, jobs) = mpsc::unbounded_channel();
        let counters = Arc::new(Counters::default());
        let running = run(pool, jobs, counters.clone());
        tokio::spawn(async move {
            running.await;
            // Nobody else may write before the last job has.
            drop(lock);
        });
        Self { queue, counters }
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

async fn run(pool: SqlitePool, mut queue: mpsc::UnboundedReceiver<Message>, counters: Arc<Counters>) {
    while let Some(first) = queue.recv().await {
        let mut group = Vec::new();
        let mut closing = None;
        let mut next = Some(first);
        while let Some(message) = next {
            match message {
                Message::Job(queued) => group.push(*queued),
                Message::Close(closed) => {
                    closing = Some(closed);
                    break;
                }
            }
            next = if group.len() < MAX_GROUP { queue.try_recv().ok() } else { None };
        }
        commit_group(&pool, group, &counters).await;
        if let Some(closed) = closing {
            queue.close();
            checkpoint(&pool).await;
            pool.close().await;
            let _ = closed.send(());
            return;
        }
    }
}

/// Brings the log into the database, unless somebody still reads (a backup): then the next start does.
async fn checkpoint(pool: &SqlitePool) {
    let Ok(mut db) = pool.acquire().await else { return };
    let settled = async {
        sqlx::query("pragma busy_timeout = 0").execute(&mut *db).await?;
        sqlx::query("pragma wal_checkpoint(truncate)").execute(&mut *db).await
    };
    if let Err(error) = settled.await {
        warn!(%error, "the write-ahead log stays beside the database until the next start");
    }
}

async fn commit_group(pool: &SqlitePool, group: Vec<Queued>, counters: &Counters) {
    let size = group.len() as u64;
    let (void, group): (Vec<_>, Vec<_>) =
        group.into_iter().partition(|queued| queued.broken.load(Ordering::Acquire));
    for queued in void {
        (queued.done)(Err(StoreError::Superseded));
    }
    if group.is_empty() {
        counters.waiting.fetch_sub(size, Ordering::Relaxed);
        return;
    }
    counters.transactions.fetch_add(1, Ordering::Relaxed);
    let result = commit(pool, group.iter().map(|queued| &queued.job)).await;
    match result {
        Ok(()) => {
            counters.jobs.fetch_add(group.len() as u64, Ordering::Relaxed);
            for queued in group {
                (queued.done)(Ok(()));
            }
        }
        Err(error) => {
            warn!(%error, jobs = group.len(), "a group did not commit; trying its jobs one by one");
            for queued in group {
                commit_alone(pool, queued, counters).await;
            }
        }
    }
    counters.waiting.fetch_sub(size, Ordering::Relaxed);
}

async fn commit_alone(pool: &SqlitePool, queued: Queued, counters: &Counters) {
    let result = if queued.broken.load(Ordering::Acquire) {
        Err(StoreError::Superseded)
    } else {
        counters.transactions.fetch_add(1, Ordering::Relaxed);
        commit(pool, std::iter::once(&queued.job)).await
    };
    match &result {
        Ok(()) => {
            counters.jobs.fetch_add(1, Ordering::Relaxed);
        }
        Err(StoreError::Superseded) => {}
        Err(error) => {
            error!(%error, "a job did not commit");
            queued.broken.store(true, Ordering::Release);
        }
    }
    (queued.done)(result);
}

async fn commit(pool: &SqlitePool, jobs: impl Iterator<Item = &Job>) -> Result<(), StoreError> {
    let mut transaction = pool.begin_with("begin immediate").await?;
    for job in jobs {
        write::execute(&mut transaction, job).await?;
    }
    transaction.commit().await?;
    Ok(())
}
