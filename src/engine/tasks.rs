//! Tasks that a request waits for.

use tokio::task::spawn_blocking;
use tracing::Instrument as _;

use super::error::{Result, ServiceError};
use crate::config::logging::{in_part, in_span};

/// Does work that blocks or computes, off the async threads.
pub(in crate::engine) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T> {
    spawn_blocking(in_span(work)).await.map_err(ServiceError::panicked)
}

/// Does the same as a part of the request's trace.
pub(in crate::engine) async fn blocking_part<T: Send + 'static>(
    name: &'static str,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T> {
    spawn_blocking(in_part(name, work)).await.map_err(ServiceError::panicked)
}

/// Does work that goes to its end also when its client has gone.
pub(in crate::engine) async fn to_its_end<T: Send + 'static>(
    work: impl Future<Output = T> + Send + 'static,
) -> Result<T> {
    tokio::spawn(work.in_current_span()).await.map_err(ServiceError::panicked)
}
