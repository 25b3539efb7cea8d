//! The handle to the runner of jobs that ask models again. [`super::judgement_runner`] is the runner.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

/// Questions under way when the server stops may finish within this time.
const DRAIN: Duration = Duration::from_secs(8);

/// The handle to the runner; by default, to one that does not run yet.
#[derive(Debug, Default)]
pub(in crate::engine) struct Rejudging {
    /// Held while a job is started, so that one job of a map runs at a time.
    pub starting: tokio::sync::Mutex<()>,
    /// Notified when there may be a job.
    pub(super) wake: Notify,
    /// Cancelled at shutdown.
    pub(super) stop: CancellationToken,
    running: Mutex<Option<JoinHandle<()>>>,
}

impl Rejudging {
    /// Starts the runner, which ends after [`Self::stop`].
    pub fn start(&self, runner: impl Future<Output = ()> + Send + 'static) {
        *self.lock() = Some(tokio::spawn(runner));
    }

    /// Looks for jobs now.
    pub fn wake(&self) {
        self.wake.notify_one();
    }

    /// Begins nothing more, and lets the questions under way finish.
    pub async fn stop(&self) {
        self.stop.cancel();
        let running = self.lock().take();
        if let Some(mut running) = running
            && tokio::time::timeout(DRAIN, &mut running).await.is_err()
        {
            running.abort();
        }
    }

    fn lock(&self) -> MutexGuard<'_, Option<JoinHandle<()>>> {
        // Holds one value that is replaced as a whole.
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
