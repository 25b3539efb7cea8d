//! Lines: a streamed body cut at its newlines, no line longer than memory should hold.

use axum::body::Body;
use axum::body::HttpBody as _;
use bytes::{Buf as _, Bytes, BytesMut};
use http_body_util::BodyExt as _;

use crate::http::body::unreadable;
use crate::http::problem::{Kind, Problem};
use crate::wire::limits::{BULK_BYTES, LINE_BYTES};

/// One line of the body.
#[derive(Debug, PartialEq, Eq)]
pub enum Line {
    /// Its bytes, without the newline.
    Text(Bytes),
    /// It had more than [`LINE_BYTES`] and was passed over.
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
    taken: usize,
}

impl Lines {
    /// The lines of this body.
    pub fn of(body: Body) -> Self {
        Self { body, buffer: BytesMut::new(), searched: 0, skipping: false, taken: 0 }
    }

    /// The next line; an error ends the body.
    pub async fn next(&mut self) -> Result<Option<Line>, Problem> {
        loop {
            if let Some(line) = self.complete() {
                return Ok(Some(line));
            }
            if !self.fill().await? {
                return Ok(self.rest());
            }
        }
    }

    /// The line at the front of the buffer, if its newline is there.
    fn complete(&mut self) -> Option<Line> {
        let newline = self.buffer[self.searched..].iter().position(|&byte| byte == b'\n');
        let Some(at) = newline.map(|at| at + self.searched) else {
            self.searched = self.buffer.len();
            if self.searched > LINE_BYTES {
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
        let Some(frame) = self.body.frame().await else { return Ok(false) };
        if let Ok(data) = frame.map_err(|error| unreadable(&error))?.into_data() {
            self.taken += data.len();
            if self.taken > BULK_BYTES {
                return Err(Problem::new(
                    Kind::TOO_LARGE,
                    format!("a bulk request has at most {BULK_BYTES} bytes"),
                ));
            }
            self.buffer.extend_from_slice(&data);
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    async fn lines(chunks: &'static [&'static str]) -> Vec<Line> {
        let stream =
            futures_util::stream::iter(chunks.iter().map(|chunk| Ok::<_, std::io::Error>(chunk.as_bytes())));
        let mut lines = Lines::of(Body::from_stream(stream));
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
