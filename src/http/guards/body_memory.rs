//! BodyMemory: how much of it large bodies may take together, while they are received and read.
//!
//! One body is bounded by [`limits::BODY_BYTES`], but what it becomes is larger, and many may come at once. So a large
//! one asks for memory before it takes any, and is refused where others have it. Small ones are not counted: their
//! number is bounded by that of connections.

use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::api::decoding::json_footprint::JsonFootprint;
use crate::api::limits;
use crate::http::problem::Problem;

/// Counted in units of so many bytes.
const UNIT: usize = 1 << 10;

/// The memory that large bodies share.
#[derive(Clone, Debug)]
pub struct BodyMemory {
    free: Arc<Semaphore>,
    /// At most so many large bodies are read into what they mean at once; each keeps a core busy.
    readers: Arc<Semaphore>,
}

/// What one body has taken, until this is dropped.
#[derive(Debug, Default)]
pub struct HeldMemory(Option<OwnedSemaphorePermit>);

impl BodyMemory {
    /// So many MiB.
    pub fn new(mebibytes: usize) -> Self {
        let units = mebibytes.saturating_mul((1 << 20) / UNIT).min(Semaphore::MAX_PERMITS);
        let cores = std::thread::available_parallelism().map_or(2, usize::from);
        Self { free: Arc::new(Semaphore::new(units)), readers: Arc::new(Semaphore::new(cores)) }
    }

    /// Takes more for a body, if there is any.
    pub fn take(&self, held: &mut HeldMemory, bytes: usize) -> Result<(), Problem> {
        let units = u32::try_from(bytes.div_ceil(UNIT)).unwrap_or(u32::MAX);
        let Ok(permit) = self.free.clone().try_acquire_many_owned(units) else {
            return Err(Problem::overloaded("other large bodies take all the memory there is for them"));
        };
        match &mut held.0 {
            Some(have) => have.merge(permit),
            none => *none = Some(permit),
        }
        Ok(())
    }

    /// Waits for a turn to read a large body.
    pub async fn turn(&self) -> Option<OwnedSemaphorePermit> {
        self.readers.clone().acquire_owned().await.ok()
    }
}

/// What a body may become that took so many bytes on the wire, in bytes of memory.
pub fn becomes_at_most(compressed: usize) -> usize {
    limits::INFLATED_FREE_BYTES.saturating_add(compressed.saturating_mul(limits::INFLATED_FOLD))
}

/// What the values of a body take in memory beside its text.
pub fn tree_bytes(survey: JsonFootprint) -> usize {
    /// A value, and what a list keeps free for its growth.
    const VALUE: usize = 96;
    /// A member's name and its place in the object.
    const MEMBER: usize = 96;
    VALUE * survey.values + MEMBER * survey.members + survey.text_bytes
}
