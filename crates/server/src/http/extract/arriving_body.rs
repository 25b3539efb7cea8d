//! Arriving body: a request body kept within limits, or discarded once it is rejected.

use axum::http::HeaderMap;
use axum::http::header::CONTENT_LENGTH;
use bytes::{Bytes, BytesMut};

use super::body_errors::too_large;
use crate::api::limits;
use crate::http::guards::body_memory::{BodyMemory, HeldMemory};
use crate::http::problem::Problem;

/// Bodies up to this size are not counted; most keyframes are smaller.
const UNCOUNTED_BYTES: usize = 256 << 10;

/// Bytes beyond the limit that are read and discarded, so that the client receives the response: closing with unread
/// bytes would reset the connection.
const DISCARDED_BYTES: usize = 4 * limits::BODY_BYTES;

/// A request body being received.
pub(super) struct Arriving {
    bytes: BytesMut,
    announced: usize,
    held: HeldMemory,
    counted: usize,
    refused: Option<Problem>,
    discarded: usize,
}

impl Arriving {
    /// Creates a body with this announced length.
    pub fn new(announced: usize) -> Self {
        let refused = (announced > limits::BODY_BYTES).then(too_large);
        Self {
            bytes: BytesMut::new(),
            announced,
            held: HeldMemory::default(),
            counted: 0,
            refused,
            discarded: 0,
        }
    }

    /// Stores a piece, or discards it once the body is certain to be rejected. Returns `false` if reading on is
    /// useless.
    pub fn take(&mut self, piece: &[u8], memory: &BodyMemory) -> bool {
        if self.refused.is_none() {
            self.refused = self.make_room(piece.len(), memory).err();
        }
        if self.refused.is_none() {
            self.bytes.extend_from_slice(piece);
            return true;
        }
        self.bytes = BytesMut::new();
        self.held = HeldMemory::default();
        self.discarded += piece.len();
        self.discarded <= DISCARDED_BYTES
    }

    fn make_room(&mut self, more: usize, memory: &BodyMemory) -> Result<(), Problem> {
        let needed = self.bytes.len() + more;
        if needed > limits::BODY_BYTES {
            return Err(too_large());
        }
        if needed <= self.bytes.capacity() {
            return Ok(());
        }
        // The announced length is trusted only up to a multiple of the bytes received.
        let room = (2 * needed).max(self.announced.min(16 * needed)).min(limits::BODY_BYTES);
        if room > UNCOUNTED_BYTES {
            memory.take(&mut self.held, room - self.counted)?;
            self.counted = room;
        }
        self.bytes.reserve(room - self.bytes.len());
        Ok(())
    }

    /// Returns the whole body, or the reason for its rejection.
    pub fn whole(self) -> Result<(Bytes, HeldMemory), Problem> {
        match self.refused {
            Some(problem) => Err(problem),
            None => Ok((self.bytes.freeze(), self.held)),
        }
    }
}

/// Returns the announced length; 0 without one.
pub(super) fn announced(headers: &HeaderMap) -> usize {
    headers.get(CONTENT_LENGTH).and_then(|value| value.to_str().ok()?.parse().ok()).unwrap_or(0)
}
