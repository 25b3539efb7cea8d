//! The queue between those who submit jobs and the one writer.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use tokio::sync::oneshot;

use crate::StoreError;
use crate::jobs::job::Job;

/// A line of jobs of one map: they were planned one upon the other.
pub type PoisonFlag = Arc<AtomicBool>;

/// A job that waits.
pub(crate) struct Queued {
    pub job: Job,
    /// True once a job of this line has failed.
    pub broken: PoisonFlag,
    pub done: Done,
}

/// Called by the writer when a job is on disk, or will never be: even if nobody waits any more.
pub(crate) type Done = Box<dyn FnOnce(Result<(), StoreError>) + Send + Sync>;

/// A message to the writer.
pub(crate) enum Message {
    /// Jobs that come together, so that they share a group.
    Jobs(Vec<Queued>),
    /// Answered once everything queued before it is settled.
    Settle(oneshot::Sender<()>),
    /// Answered once the disk was tried again, if it was full.
    TryDisk(oneshot::Sender<()>),
    /// There may be background work: a map was taken over.
    Look,
    /// The database's file or its log is made anew, after everything queued before. Answered with how long jobs waited for it.
    Renew(Renewal, oneshot::Sender<Result<Duration, StoreError>>),
    Close(oneshot::Sender<()>),
}

/// A file that is made anew, so that no byte of deleted rows is left in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Renewal {
    /// The database's file: all that it holds is written once more.
    File,
    /// The write-ahead log: it is brought into the file and cut to nothing.
    Log,
}

/// The counters behind [`crate::CommitStats`].
#[derive(Debug, Default)]
pub(crate) struct Counters {
    pub jobs: AtomicU64,
    pub transactions: AtomicU64,
    pub waiting: AtomicU64,
}

impl fmt::Debug for Queued {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Queued").field("job", &self.job).finish_non_exhaustive()
    }
}

impl Queued {
    /// It will never be on disk, and neither will what was planned upon it.
    pub(crate) fn fail(self, error: StoreError) {
        if self.job.is_planned_upon() {
            self.broken.store(true, Ordering::Release);
        }
        (self.done)(Err(error));
    }
}
