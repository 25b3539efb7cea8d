//! Lines: a streamed body split at newlines, with a limit on the length of a line.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use axum::body::Body;
use axum::body::HttpBody as _;
use bytes::{Buf as _, Bytes, BytesMut};
use http_body_util::BodyExt as _;

use crate::api::limits::{BULK_BYTES, LINE_BYTES};
use crate::http::extract::body_errors::unreadable;
use crate::http::extract::decompression::Encoding;
use crate::http::guards::body_memory::{BodyMemory, HeldMemory, becomes_at_most};
use crate::http::problem::{Kind, Problem};

/// Bytes after which inflating yields: highly compressed input never waits for the client.
const YIELD_BYTES: usize = 256 << 10;
/// Maximum bytes discarded after a body is rejected.
const DISCARDED_BYTES: usize = 16 << 20;
/// Lines up to this size are not counted.
const UNCOUNTED_BYTES: usize = 256 << 10;

/// One line of the body.
#[derive(Debug, PartialEq, Eq)]
pub enum Line {
    /// Its bytes, without the newline.
    Text(Bytes),
    /// A skipped line that was longer than [`LINE_BYTES`], or expanded too much.
    TooLong,
}

/// The lines of a body, as they arrive.
pub struct Lines {
    body: Body,
    buffer: BytesMut,
    /// Length of the buffer known to contain no newline.
    searched: usize,
    /// Whether the current line is already too long.
    skipping: bool,
    /// Whether there was a long line.
    is_long: bool,
    taken: usize,
    unyielded: usize,
    memory: BodyMemory,
    held: HeldMemory,
    compressed: Option<Compressed>,
}

/// The compressed bytes received.
struct Compressed {
    arrived: Arc<AtomicUsize>,
    /// The count at the start of the current line.
    before: usize,
}

impl Lines {
    /// Returns the lines of this body. They use the shared memory of large bodies.
    pub fn of(body: Body, encoding: Encoding, memory: BodyMemory) -> Result<Self, Problem> {
        let mut held = HeldMemory::default();
        let (body, compressed) = if encoding == Encoding::Identity {
            (body, None)
        } else {
            memory.take(&mut held, encoding.stream_bytes())?;
            let (body, arrived) = encoding.stream(body);
            (body, Some(Compressed { arrived, before: 0 }))
        };
        Ok(Self {
            body,
            buffer: BytesMut::new(),
            searched: 0,
            skipping: false,
            is_long: false,
            taken: 0,
            unyielded: 0,
            memory,
            held,
            compressed,
        })
    }

    /// Returns the maximum size in memory of the line last read, if it was compressed.
    pub fn becomes_at_most(&self) -> Option<usize> {
        let Compressed { arrived, before } = self.compressed.as_ref()?;
        Some(becomes_at_most(arrived.load(Ordering::Relaxed).saturating_sub(*before)))
    }

    /// Returns the next line; an error ends the body.
    pub async fn next(&mut self) -> Result<Option<Line>, Problem> {
        if let Some(Compressed { arrived, before }) = &mut self.compressed {
            *before = arrived.load(Ordering::Relaxed);
        }
        loop {
            if let Some(line) = self.complete() {
                return Ok(Some(line));
            }
            if !self.fill().await? {
                return Ok(self.rest());
            }
        }
    }

    /// Discards some of the rest, so that a client that is still sending receives the response.
    pub async fn discard(&mut self) {
        let mut left = DISCARDED_BYTES;
        while left > 0 {
            let Some(Ok(frame)) = self.body.frame().await else { return };
            left = left.saturating_sub(frame.data_ref().map_or(0, Bytes::len));
        }
    }

    /// Returns the first line of the buffer, if it is complete.
    fn complete(&mut self) -> Option<Line> {
        let newline = self.buffer[self.searched..].iter().position(|&byte| byte == b'\n');
        let Some(at) = newline.map(|at| at + self.searched) else {
            self.searched = self.buffer.len();
            if self.searched > self.becomes_at_most().unwrap_or(LINE_BYTES).min(LINE_BYTES) {
                self.skipping = true;
                self.buffer.clear();
                self.searched = 0;
            }
            return None;
        };
        let text = self.buffer.split_to(at).freeze();
        self.buffer.advance(1);
        self.searched = 0;
        Some(self.line(text))
    }

    /// Returns the text after the last newline.
    fn rest(&mut self) -> Option<Line> {
        if self.buffer.is_empty() && !self.skipping {
            return None;
        }
        self.searched = 0;
        let text = self.buffer.split().freeze();
        Some(self.line(text))
    }

    fn line(&mut self, text: Bytes) -> Line {
        let too_long = std::mem::take(&mut self.skipping) || text.len() > LINE_BYTES;
        if too_long { Line::TooLong } else { Line::Text(text) }
    }

    /// Reads more of the body; returns `false` at its end.
    async fn fill(&mut self) -> Result<bool, Problem> {
        if self.body.is_end_stream() {
            return Ok(false);
        }
        if self.unyielded > YIELD_BYTES {
            self.unyielded = 0;
            tokio::task::yield_now().await;
        }
        let Some(frame) = self.body.frame().await else { return Ok(false) };
        if let Ok(data) = frame.map_err(|error| unreadable(&error))?.into_data() {
            self.taken += data.len();
            self.unyielded += data.len();
            if self.taken > BULK_BYTES {
                return Err(Problem::new(
                    Kind::TOO_LARGE,
                    format!("a bulk request has at most {BULK_BYTES} bytes"),
                ));
            }
            self.make_room(data.len())?;
            self.buffer.extend_from_slice(&data);
        }
        Ok(true)
    }

    /// Reserves the maximum length of a line for a long line, once and for the rest of the body.
    fn make_room(&mut self, more: usize) -> Result<(), Problem> {
        let needed = self.buffer.len() + more;
        if needed > self.buffer.capacity() && needed > UNCOUNTED_BYTES {
            // Lines split off use the same memory and release it with them.
            if !self.is_long {
                self.memory.take(&mut self.held, LINE_BYTES)?;
                self.is_long = true;
            }
            self.buffer.reserve((LINE_BYTES + UNCOUNTED_BYTES).saturating_sub(self.buffer.len()).max(more));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    async fn lines(chunks: &'static [&'static str]) -> Vec<Line> {
        let stream =
            futures_util::stream::iter(chunks.iter().map(|chunk| Ok::<_, std::io::Error>(chunk.as_bytes())));
        let body = Body::from_stream(stream);
        let mut lines = Lines::of(body, Encoding::Identity, BodyMemory::new(64)).expect("memory");
        let mut all = Vec::new();
        while let Some(line) = lines.next().await.expect("a whole body") {
            all.push(line);
        }
        all
    }

    fn text(text: &'static str) -> Line {
        Line::Text(Bytes::from_static(text.as_bytes()))
    }

    #[tokio::test]
    async fn lines_are_whole_however_they_arrive() {
        assert_eq!(lines(&["a\n\nb", "c", "\nd"]).await, [text("a"), text(""), text("bc"), text("d")]);
        assert_eq!(lines(&["a\n"]).await, [text("a")]);
        assert_eq!(lines(&[]).await, []);
    }

    #[tokio::test]
    async fn a_line_too_long_is_passed_over_and_the_next_one_read() {
        static LONG: std::sync::LazyLock<String> =
            std::sync::LazyLock::new(|| "x".repeat(LINE_BYTES / 2 + 1));
        static CHUNKS: std::sync::LazyLock<Vec<&str>> =
            std::sync::LazyLock::new(|| vec![&LONG, &LONG, "x\nb\n", &LONG, &LONG]);
        assert_eq!(lines(&CHUNKS).await, [Line::TooLong, text("b"), Line::TooLong]);
    }
}
