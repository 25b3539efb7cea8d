//! The handle to a runner in the background.

use std::sync::Mutex;
use std::time::Duration;

use tokio::sync::Notify;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

use crate::engine::lock::lock;

/// Questions under way when the server stops may finish within this time. Answers so far are kept anyway.
const DRAIN: Duration = Duration::from_secs(8);

/// The handle to a runner; by default, to one that does not run yet.
#[derive(Debug, Default)]
pub(in crate::engine) struct Background {
    /// Notified when there may be work.
    pub(super) wake: Notify,
    /// Cancelled at shutdown.
    pub(super) stop: CancellationToken,
    running: Mutex<Option<JoinHandle<()>>>,
}

impl Background {
    /// Starts the runner, which ends after [`Self::stop`].
    pub fn start(&self, runner: impl Future<Output = ()> + Send + 'static) {
        *lock(&self.running) = Some(tokio::spawn(runner));
    }

    /// Looks for work now.
    pub fn wake(&self) {
        self.wake.notify_one();
    }

    /// Begins nothing more, and lets the questions under way finish.
    pub async fn stop(&self) {
        self.stop.cancel();
        let running = lock(&self.running).take();
        if let Some(mut running) = running
            && tokio::time::timeout(DRAIN, &mut running).await.is_err()
        {
            running.abort();
        }
    }
}
