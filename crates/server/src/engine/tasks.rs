//! Tasks that a request waits for.

use tokio::task::{JoinHandle, spawn_blocking};
use tracing::Instrument as _;

use super::error::{Result, ServiceError};
use crate::config::logging::{in_part, in_span};

/// Does work that blocks or computes, off the async threads.
pub(in crate::engine) fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> impl Future<Output = Result<T>> {
    ended(spawn_blocking(in_span(work)))
}

/// Does the same as a part of the request's trace.
pub(in crate::engine) fn blocking_part<T: Send + 'static>(
    name: &'static str,
    work: impl FnOnce() -> T + Send + 'static,
) -> impl Future<Output = Result<T>> {
    ended(spawn_blocking(in_part(name, work)))
}

/// Does work that goes to its end also when its client has gone.
pub(in crate::engine) fn to_its_end<T: Send + 'static>(
    work: impl Future<Output = T> + Send + 'static,
) -> impl Future<Output = Result<T>> {
    ended(tokio::spawn(work.in_current_span()))
}

async fn ended<T>(task: JoinHandle<T>) -> Result<T> {
    task.await.map_err(ServiceError::panicked)
}
