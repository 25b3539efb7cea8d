//! Slices: the writer's background work, in short transactions between those of its clients.
//!
//! | work | file |
//! |---|---|
//! | removing the rows of deleted maps | [`super::deletion`] |
//! | bringing deferred changes into their rows | [`super::fold`] |
//!
//! A slice works in steps of a few rows until its time is over, because a row's cost is not known before: a pose costs many
//! times what a map point does. Its sync costs the same for a few rows as for many. After a slice the writer rests for a
//! multiple of the time that it took, so that a client's job mostly finds it free.

use std::sync::Arc;
use std::time::Duration;

use tokio::time::Instant;

use super::{deletion, fold};
use crate::StoreError;
use crate::copies::copied_rows;
use crate::log::log_rows;
use crate::postgres::leases::Leases;
use crate::sql::Pool;
use crate::sql::transaction::Transaction;

/// The time after which a slice begins no further step.
const SLICE: Duration = Duration::from_millis(5);

/// How many times its own time the writer rests after a slice if no client wrote lately, ...
const REST_ALONE: u32 = 1;

/// ... if one did, ...
const REST_BESIDE: u32 = 4;

/// ... and while jobs wait.
const REST_BUSY: u32 = 10;

/// How long a client's job counts as lately done.
const LATELY: Duration = Duration::from_secs(1);

/// The longest rest after a slice, however long it took.
const REST_MAX: Duration = Duration::from_secs(1);

/// After a failed slice, the next attempt is made after this time.
const RETRY: Duration = Duration::from_secs(1);

/// Rows of a step of deletion, which passes the tables that are empty already each time, ...
const DELETED_AT_ONCE: u32 = 1024;

/// ... and changes of a step of folding.
const FOLDED_AT_ONCE: usize = 128;

/// Which work a slice does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Work {
    Deletion,
    Fold,
}

/// The background work that is left, and its pace.
#[derive(Debug)]
pub(crate) struct Slices {
    /// Whether there may be work of each kind.
    deletion: bool,
    fold: bool,
    /// The kind whose turn it is if there is work of both.
    turn: Work,
    ended: Instant,
    rest: Duration,
    client_at: Option<Instant>,
    /// The leases of a server among others: it folds what is deferred in its own maps only.
    leases: Option<Arc<Leases>>,
    /// Whether slices must keep pace with clients.
    is_behind: bool,
}

impl Slices {
    /// None, for a writer beside the one that serves.
    pub(crate) fn none() -> Self {
        Self {
            deletion: false,
            fold: false,
            turn: Work::Fold,
            ended: Instant::now(),
            rest: Duration::ZERO,
            client_at: None,
            leases: None,
            is_behind: false,
        }
    }

    /// Continues what an earlier process has left.
    pub(crate) async fn resume(pool: &Pool) -> Self {
        let cleaned = async {
            let mut transaction = Transaction::write(pool).await?;
            let removed = async {
                log_rows::remove_uncommitted(&mut transaction).await?;
                copied_rows::remove_incomplete(&mut transaction).await
            };
            let removed = removed.await;
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
    pub(crate) fn add(&mut self) {
        (self.deletion, self.fold) = (true, true);
    }

    /// Returns those of a server among others. What one of them left half done goes when its maps are taken, and its copies when it
    /// is gone.
    pub(crate) fn among_others(leases: Arc<Leases>) -> Self {
        let mut this = Self { leases: Some(leases), ..Self::none() };
        this.add();
        this
    }

    /// A client's job was done.
    pub(crate) fn beside_client(&mut self) {
        self.client_at = Some(Instant::now());
    }

    /// When the next slice is due if no job waits; `None` without work. On a full disk only what frees space is done.
    pub(crate) fn due(&self, disk_is_full: bool) -> Option<Instant> {
        let is_beside = self.client_at.is_some_and(|at| at.elapsed() < LATELY);
        self.after(if is_beside { REST_BESIDE } else { REST_ALONE }, disk_is_full)
    }

    /// When the next slice is due though jobs wait.
    pub(crate) fn overdue(&self, disk_is_full: bool) -> Option<Instant> {
        self.after(REST_BUSY, disk_is_full)
    }

    fn after(&self, rest: u32, disk_is_full: bool) -> Option<Instant> {
        let rest = if self.is_behind || disk_is_full { REST_ALONE } else { rest };
        self.next(disk_is_full).map(|_| self.ended + self.rest * rest)
    }

    fn next(&self, disk_is_full: bool) -> Option<Work> {
        match (self.deletion, self.fold && !disk_is_full) {
            (true, true) => Some(self.turn),
            (true, false) => Some(Work::Deletion),
            (false, true) => Some(Work::Fold),
            (false, false) => None,
        }
    }

    /// Does one slice, in a transaction of its own.
    pub(crate) async fn run(&mut self, pool: &Pool, disk_is_full: bool) -> Result<(), StoreError> {
        let Some(work) = self.next(disk_is_full) else { return Ok(()) };
        self.turn = if work == Work::Fold { Work::Deletion } else { Work::Fold };
        let began = Instant::now();
        let result = slice(pool, work, self.leases.as_deref()).await;
        self.ended = Instant::now();
        let took = self.ended - began;
        self.rest = if result.is_ok() { took.min(REST_MAX) } else { RETRY };
        let more = if work == Work::Fold { &mut self.fold } else { &mut self.deletion };
        let done = result?;
        *more = done.more;
        self.is_behind = done.is_behind;
        Ok(())
    }
}

/// A slice that is on disk.
struct Done {
    /// Whether there may be more to do.
    more: bool,
    /// Whether slices fall behind the clients.
    is_behind: bool,
}

async fn slice(pool: &Pool, work: Work, leases: Option<&Leases>) -> Result<Done, StoreError> {
    let mut transaction = Transaction::write(pool).await?;
    let began = Instant::now();
    let done = async {
        let mut more = true;
        let mut folded = None;
        if let (Work::Fold, Some(leases)) = (work, leases) {
            folded = fold::next_map(&mut transaction, &leases.maps()).await?;
            match folded {
                Some(map) => leases.fence(&mut transaction, &[map]).await?,
                None => more = false,
            }
        }
        while more && began.elapsed() < SLICE {
            more = match work {
                Work::Deletion => deletion::remove_rows(&mut transaction, DELETED_AT_ONCE).await?,
                Work::Fold => fold::fold(&mut transaction, folded, FOLDED_AT_ONCE).await?,
            };
        }
        // Another map may have its turn next.
        let more = more || folded.is_some();
        Ok(Done { more, is_behind: fold::is_behind(&mut transaction).await? })
    };
    match done.await {
        Ok(done) => transaction.commit().await.map(|()| done),
        Err(error) => {
            transaction.roll_back().await;
            Err(error)
        }
    }
}
