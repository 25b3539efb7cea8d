//! Writer: takes jobs from the queue, as many as wait, and commits them ([`super::group`]).
//!
//! Once a disk has failed, jobs are refused until a commit of the writer's own has passed. That commit also takes the place
//! in the write-ahead log where the failed one may stand. On a full disk what frees space is tried all the same, with the
//! reserve's space.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use tokio::sync::{mpsc, oneshot};
use tokio::time::Instant;
use tracing::warn;

use super::commit_queue::Committer;
use super::health::{Disk, Health};
use super::lanes::Lanes;
use super::own_disk::OwnDisk;
use super::queue::{Counters, Message, Renewal};
use super::renewal::renew;
use crate::StoreError;
use crate::files::lock::DatabaseLock;
use crate::postgres::leases::Leases;
use crate::rows::map_rows;
use crate::slices::background::Slices;
use crate::sql::Pool;
use crate::sql::transaction::Transaction;

/// How often a disk that is not well is tried.
const TRY_AGAIN_EVERY: Duration = Duration::from_millis(500);

/// The least time between two tries when somebody wants to write.
const TRY_AGAIN_AFTER: Duration = Duration::from_millis(50);

/// Starts a writer on its own connection, in a thread of its own.
///
/// A group is a chain of statements, each of which wakes the writer when it is done. On the runtime that answers
/// requests each of these waits behind the requests' tasks, so that a busy server committed slowly.
pub(crate) fn start(pool: Pool, disk: Option<OwnDisk>, served: Served) -> Result<Committer, StoreError> {
    let failed = |error: std::io::Error| StoreError::Database(format!("the writer's thread: {error}"));
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(failed)?;
    // Unbounded, because whoever plans holds the map's lock and must not wait here; the service
    // bounds how many requests plan at once.
    let (queue, jobs) = mpsc::unbounded_channel();
    let counters = Arc::new(Counters::default());
    let health = Health::default();
    let serves = !matches!(served, Served::Beside);
    let leases = if let Served::Shared(leases) = &served { Some(leases.clone()) } else { None };
    let writer = Writer { pool, disk, leases, counters: counters.clone(), health: health.clone(), serves };
    let run = move || {
        runtime.block_on(writer.run(jobs));
        // Nobody else may write before the last job has.
        drop(served);
    };
    std::thread::Builder::new().name("writer".to_owned()).spawn(run).map_err(failed)?;
    Ok(Committer::to(queue, counters, health))
}

/// By what right a writer writes.
#[derive(Debug)]
pub(crate) enum Served {
    /// The database's file is this process's, which keeps its lock.
    Alone { _lock: Arc<DatabaseLock> },
    /// Another process serves it: only short writes are made beside it, and no background work.
    Beside,
    /// The database is a server's, which other processes write to, too: each to the maps that it owns.
    Shared(Arc<Leases>),
}

/// The writer's own side of the queue.
pub(super) struct Writer {
    pub(super) pool: Pool,
    disk: Option<OwnDisk>,
    pub(super) leases: Option<Arc<Leases>>,
    pub(super) counters: Arc<Counters>,
    pub(super) health: Health,
    /// Whether this process is the one that serves, and does the background work.
    serves: bool,
}

impl Writer {
    /// Commits until the queue is closed.
    async fn run(self, mut queue: mpsc::UnboundedReceiver<Message>) {
        if let Some(disk) = &self.disk {
            disk.keep_reserve().await;
        }
        let mut slices = match &self.leases {
            Some(leases) => Slices::among_others(leases.clone()),
            None if self.serves => Slices::resume(&self.pool).await,
            None => Slices::none(),
        };
        let (mut lanes, mut renewals, mut closing) = (Lanes::default(), Vec::new(), None);
        let (mut tried, mut who_wants) = (Instant::now(), Vec::new());
        loop {
            let mut next = if lanes.is_empty() && closing.is_none() {
                let received = match self.wakes_at(&slices, tried + rest(&who_wants)) {
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
                    Some(Message::Jobs(jobs)) => {
                        for queued in jobs {
                            lanes.push(queued);
                        }
                    }
                    Some(Message::Settle(settled)) => lanes.settle(settled),
                    Some(Message::TryDisk(wants)) => who_wants.push(wants),
                    Some(Message::Look) => slices.add(),
                    Some(Message::Renew(renewal, renewed)) => renewals.push((renewal, renewed)),
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
            if lanes.is_empty() {
                for (renewal, renewed) in renewals.drain(..) {
                    let _ = renewed.send(self.renew(renewal).await);
                }
            }
            if lanes.is_empty()
                && let Some(closed) = closing.take()
            {
                queue.close();
                if let Some(disk) = &self.disk {
                    disk.checkpoint().await;
                }
                self.pool.close().await;
                let _ = closed.send(());
                return;
            }
            let is_due = self.health.disk() != Disk::Well && tried.elapsed() >= rest(&who_wants);
            if is_due {
                self.try_disk().await;
                tried = Instant::now();
            }
            if is_due || self.health.disk() == Disk::Well {
                for wants in who_wants.drain(..) {
                    let _ = wants.send(());
                }
            }
            self.do_slice(&mut slices, lanes.is_empty() && queue.is_empty()).await;
        }
    }

    /// When there is something to do though no message comes.
    fn wakes_at(&self, slices: &Slices, try_at: Instant) -> Option<Instant> {
        let try_disk = (self.health.disk() != Disk::Well).then_some(try_at);
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

    /// Makes the file or the log anew, and returns how long that took; a database server does so by itself.
    async fn renew(&self, renewal: Renewal) -> Result<Duration, StoreError> {
        let Some(disk) = &self.disk else { return Ok(Duration::ZERO) };
        let started = Instant::now();
        renew(disk.writer(), renewal).await?;
        Ok(started.elapsed())
    }

    pub(super) async fn release_reserve(&self) {
        if let Some(disk) = &self.disk {
            disk.release_reserve().await;
        }
    }

    /// Looks whether a disk that was full or failed is well again.
    async fn try_disk(&self) {
        if self.health.disk() == Disk::Full
            && let Some(disk) = &self.disk
            && !disk.make_room().await
        {
            return;
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
}

/// Returns how long a disk that takes no writes is left alone.
fn rest(who_wants: &[oneshot::Sender<()>]) -> Duration {
    if who_wants.is_empty() { TRY_AGAIN_EVERY } else { TRY_AGAIN_AFTER }
}

#[cfg(test)]
mod tests {
    use revisit_core::domain::map::MapProperties;
    use sqlx::sqlite::{SqliteConnectOptions, SqlitePool, SqlitePoolOptions};
    use tokio::sync::oneshot;

    use super::*;
    use crate::commit::queue::PoisonFlag;
    use crate::files::disk_reserve::Reserve;
    use crate::files::schema;
    use crate::jobs::job::Job;
    use crate::test_database::a_line;

    const ROOM_FOR_ANYTHING: i64 = 1 << 30;

    /// Returns a writer on a database that SQLite itself keeps small, as a full disk does.
    async fn cramped(folder: &tempfile::TempDir) -> (SqlitePool, Committer) {
        let path = folder.path().join("cramped.db");
        let options = SqliteConnectOptions::new().filename(&path).create_if_missing(true);
        let options = options.journal_mode(sqlx::sqlite::SqliteJournalMode::Wal);
        let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await.expect("a pool");
        schema::migrate(&pool).await.expect("a schema");
        let disk = OwnDisk::of(pool.clone(), Reserve::beside(&path));
        let committer = start(pool.clone().into(), Some(disk), Served::Beside).expect("a writer");
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
        sqlx::query("update counters set last = 77 where name = 'event'")
            .execute(&pool)
            .await
            .expect("a number");
        pages_at_most(&pool, ROOM_FOR_ANYTHING).await;
        assert!(committer.refuses(false).is_some(), "it has not been tried again yet");
        assert!(committer.refuses_now(false).await.is_none(), "who wants to write has it tried");
        committer.commit(map(key)).await.expect("a write, without a restart");
        let events: i64 = sqlx::query_scalar("select last from counters where name = 'event'")
            .fetch_one(&pool)
            .await
            .expect("a number");
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
        let job = Job::KeepQuery { map: 1, id: "q-1".to_owned(), kept: 1, line: a_line(), body };
        committer.submit(job, &line, move |result| drop(committed.send(result)));
        assert!(matches!(heard.await, Ok(Err(StoreError::DiskFull))));
        assert!(!line.load(Ordering::Acquire), "the map need not be loaded anew");
    }
}
