//! Body memory: a limit on the total memory of large request bodies.
//!
//! One body is limited by [`limits::BODY_BYTES`], but its decoded form is larger, and many may arrive concurrently. A
//! large body therefore reserves memory first, and is rejected if none is left. Small ones are not counted: the
//! connection limit bounds their number.

use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::api::decoding::syntax::tokens_at_most;
use crate::api::limits;
use crate::http::problem::Problem;

/// Unit in which memory is counted, in bytes.
const UNIT: usize = 1 << 10;

/// The memory that large bodies share.
#[derive(Clone, Debug)]
pub struct BodyMemory {
    free: Arc<Semaphore>,
    /// Permits to decode a large body; each keeps a core busy.
    readers: Arc<Semaphore>,
}

/// The memory of one body, until this is dropped.
#[derive(Debug, Default)]
pub struct HeldMemory(Option<OwnedSemaphorePermit>);

impl BodyMemory {
    /// Creates a shared memory of this many MiB.
    pub fn new(mebibytes: usize) -> Self {
        let units = mebibytes.saturating_mul((1 << 20) / UNIT).min(Semaphore::MAX_PERMITS);
        let cores = std::thread::available_parallelism().map_or(2, usize::from);
        Self { free: Arc::new(Semaphore::new(units)), readers: Arc::new(Semaphore::new(cores)) }
    }

    /// Reserves more memory for a body, or fails if none is left.
    pub fn take(&self, held: &mut HeldMemory, bytes: usize) -> Result<(), Problem> {
        let units = u32::try_from(bytes.div_ceil(UNIT)).unwrap_or(u32::MAX);
        let Ok(permit) = self.free.clone().try_acquire_many_owned(units) else {
            return Err(Problem::overloaded("other large bodies use all of the memory for bodies"));
        };
        match &mut held.0 {
            Some(have) => have.merge(permit),
            none => *none = Some(permit),
        }
        Ok(())
    }

    /// Waits for a permit to decode a large body.
    pub async fn turn(&self) -> Option<OwnedSemaphorePermit> {
        self.readers.clone().acquire_owned().await.ok()
    }
}

/// Returns the maximum size to which a compressed body may expand, in bytes.
pub fn becomes_at_most(compressed: usize) -> usize {
    limits::INFLATED_FREE_BYTES.saturating_add(compressed.saturating_mul(limits::INFLATED_FOLD))
}

/// Returns the memory of a body beside its text, in bytes, as a document and decoded.
pub fn decoded_bytes(text: &[u8]) -> usize {
    /// A value of the document, and what it is decoded into with the spare capacity of its list.
    const VALUE: usize = 64;
    VALUE * tokens_at_most(text) + text.len()
}
