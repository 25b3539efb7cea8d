//! Slices: the writer's background work, in short transactions between those of its clients.
//!
//! | work | file |
//! |---|---|
//! | removing the rows of deleted maps | [`super::deletion`] |
//! | bringing deferred changes into their rows | [`super::fold`] |
//!
//! How much a slice does follows from how long the last one took. While clients' jobs wait, slices are rare; while
//! none do, the writer rests after a slice for as long as it took, so that a job that arrives mostly finds it free.

use std::time::Duration;

use sqlx::sqlite::SqlitePool;
use tokio::time::Instant;

use super::StoreError;
use super::transaction::Transaction;
use super::{deferred, deletion, fold};

/// How long a slice is meant to take.
const SLICE: Duration = Duration::from_millis(8);

/// The share of time that slices get while clients' jobs wait: one part in this many.
const SHARE: u32 = 10;

/// The longest rest after a slice, however long it took.
const REST_MAX: Duration = Duration::from_secs(1);

/// After a failed slice, the next attempt is made after this time.
const RETRY: Duration = Duration::from_secs(1);

/// Rows of the first slice.
const FIRST_ROWS: u32 = 64;

/// Rows of the largest slice.
const MAX_ROWS: u32 = 8192;

/// Which work a slice does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Work {
    Deletion,
    Fold,
}

/// The background work that is left, and its pace.
#[derive(Debug)]
pub(super) struct Slices {
    /// Whether there may be work of each kind, and how many rows its next slice takes.
    deletion: (bool, u32),
    fold: (bool, u32),
    /// The kind whose turn it is if there is work of both.
    turn: Work,
    ended: Instant,
    rest: Duration,
    /// Whether slices must keep pace with clients.
    is_behind: bool,
}

impl Slices {
    /// None, for a writer beside the one that serves.
    pub(super) fn none() -> Self {
        Self {
            deletion: (false, FIRST_ROWS),
            fold: (false, FIRST_ROWS),
            turn: Work::Fold,
            ended: Instant::now(),
            rest: Duration::ZERO,
            is_behind: false,
        }
    }

    /// Continues what an earlier process has left.
    pub(super) async fn resume(pool: &SqlitePool) -> Self {
        let cleaned = async {
            let mut transaction = Transaction::write(pool).await?;
            let removed = deferred::remove_uncommitted(&mut transaction).await;
            transaction.commit().await?;
            removed
        };
        if let Err(error) = cleaned.await {
            // On a full disk they stay until the next start.
            tracing::warn!(%error, "staged changes of an earlier process stay in the database");
        }
        let mut this = Self::none();
        this.add();
        this
    }

    /// There may be work now.
    pub(super) fn add(&mut self) {
        (self.deletion.0, self.fold.0) = (true, true);
    }

    /// When the next slice is due if no job waits; `None` without work. On a full disk only what frees space is done.
    pub(super) fn due(&self, disk_is_full: bool) -> Option<Instant> {
        self.next(disk_is_full).map(|_| self.ended + self.rest)
    }

    /// When the next slice is due though jobs wait.
    pub(super) fn overdue(&self, disk_is_full: bool) -> Option<Instant> {
        let share = if self.is_behind { 1 } else { SHARE };
        self.next(disk_is_full).map(|_| self.ended + self.rest * share)
    }

    fn next(&self, disk_is_full: bool) -> Option<Work> {
        match (self.deletion.0, self.fold.0 && !disk_is_full) {
            (true, true) => Some(self.turn),
            (true, false) => Some(Work::Deletion),
            (false, true) => Some(Work::Fold),
            (false, false) => None,
        }
    }

    /// Does one slice, in a transaction of its own.
    pub(super) async fn run(&mut self, pool: &SqlitePool, disk_is_full: bool) -> Result<(), StoreError> {
        let Some(work) = self.next(disk_is_full) else { return Ok(()) };
        self.turn = if work == Work::Fold { Work::Deletion } else { Work::Fold };
        let rows = if work == Work::Fold { self.fold.1 } else { self.deletion.1 };
        let began = Instant::now();
        let result = slice(pool, work, rows).await;
        self.ended = Instant::now();
        let took = self.ended - began;
        self.rest = if result.is_ok() { took.min(REST_MAX) } else { RETRY };
        let state = if work == Work::Fold { &mut self.fold } else { &mut self.deletion };
        state.1 = sized(rows, took);
        let (more, is_behind) = result?;
        state.0 = more;
        self.is_behind = is_behind;
        Ok(())
    }
}

/// How many rows the next slice takes, after one that took this long.
fn sized(rows: u32, took: Duration) -> u32 {
    if took > SLICE {
        (rows / 2).max(1)
    } else if took < SLICE / 2 {
        (rows * 2).min(MAX_ROWS)
    } else {
        rows
    }
}

/// Does one slice. Returns whether there may be more to do, and whether slices fall behind the clients.
async fn slice(pool: &SqlitePool, work: Work, rows: u32) -> Result<(bool, bool), StoreError> {
    let mut transaction = Transaction::write(pool).await?;
    let done = async {
        let more = match work {
            Work::Deletion => deletion::remove_slice(&mut transaction, rows).await?,
            Work::Fold => fold::fold_slice(&mut transaction, rows).await?,
        };
        Ok((more, fold::is_behind(&mut transaction).await?))
    };
    match done.await {
        Ok(done) => transaction.commit().await.map(|()| done),
        Err(error) => {
            transaction.roll_back().await;
            Err(error)
        }
    }
}
