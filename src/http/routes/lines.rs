//! Lines: a streamed body cut at its newlines, no line longer than memory should hold.

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

/// What is compressed well is inflated without ever waiting; after so many bytes others get their turn.
const YIELD_BYTES: usize = 256 << 10;
/// What is read of the rest once a body is given up.
const DISCARDED_BYTES: usize = 16 << 20;
/// Lines up to this take memory without asking.
const UNCOUNTED_BYTES: usize = 256 << 10;

/// One line of the body.
#[derive(Debug, PartialEq, Eq)]
pub enum Line {
    /// Its bytes, without the newline.
    Text(Bytes),
    /// It had more than [`LINE_BYTES`], or became more than the few bytes may that it came as, and was passed over.
    TooLong,
}

/// The lines of a body, as they arrive.
pub struct Lines {
    body: Body,
    buffer: BytesMut,
    /// How much of the buffer is known to have no newline.
    searched: usize,
    /// Is the line at hand too long already?
    skipping: bool,
    /// Has there been a long line?
    is_long: bool,
    taken: usize,
    unyielded: usize,
    memory: BodyMemory,
    held: HeldMemory,
    compressed: Option<Compressed>,
}

/// How much of a compressed body has arrived.
struct Compressed {
    arrived: Arc<AtomicUsize>,
    /// And had, when the line at hand began.
    before: usize,
}

impl Lines {
    /// The lines of this body. They share the memory of large bodies.
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

    /// What the line last read may become in memory, if it came compressed.
    pub fn becomes_at_most(&self) -> Option<usize> {
        let Compressed { arrived, before } = self.compressed.as_ref()?;
        Some(becomes_at_most(arrived.load(Ordering::Relaxed).saturating_sub(*before)))
    }

    /// The next line; an error ends the body.
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

    /// Throws away some of what follows, so that a client that is still sending gets to see the answer.
    pub async fn discard(&mut self) {
        let mut left = DISCARDED_BYTES;
        while left > 0 {
            let Some(Ok(frame)) = self.body.frame().await else { return };
            left = left.saturating_sub(frame.data_ref().map_or(0, Bytes::len));
        }
    }

    /// The line at the front of the buffer, if its newline is there.
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

    /// What follows the last newline.
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

    /// Takes in more of the body; `false` at its end.
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

    /// A long line gets all the room that a line may have, once and for the rest of the body.
    fn make_room(&mut self, more: usize) -> Result<(), Problem> {
        let needed = self.buffer.len() + more;
        if needed > self.buffer.capacity() && needed > UNCOUNTED_BYTES {
            // What is split off for lines comes out of the same room and is given back with them.
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
