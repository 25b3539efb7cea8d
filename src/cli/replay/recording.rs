//! Recording: parses a file of one JSON object per line into operations, without holding it in memory.

use std::fs::File;
use std::io::{self, BufRead, Read};
use std::path::Path;

use indicatif::ProgressBar;
use serde::Deserialize;
use serde_json::{Map, Value};

use crate::api::decoding::syntax::{utf_16, without_mark};
use crate::vocabulary::decompressed;

/// Maximum length of a line; a keyframe is about 100 kB.
const MAX_LINE_BYTES: u64 = 64 * 1024 * 1024;

/// The operations of a recording, in order; ends after the first invalid line.
pub(super) struct Recording {
    reader: Box<dyn BufRead + Send>,
    max_line_bytes: u64,
    line: u64,
    map: Option<String>,
    broken: bool,
}

/// One operation, and its line.
#[derive(Debug, PartialEq)]
pub(super) struct Line {
    /// Counted from 1.
    pub number: u64,
    /// The map it belongs to.
    pub map: String,
    /// The operation.
    pub op: Op,
}

/// An operation, with the body as the API document defines it.
#[derive(Debug, Deserialize, PartialEq)]
#[serde(tag = "op", rename_all = "lowercase")]
pub(super) enum Op {
    /// Declare a map; the lines after it belong to it.
    Map {
        id: String,
        #[serde(default)]
        body: Body,
    },
    /// Store a keyframe.
    Keyframe { id: String, body: Body },
    /// Ask whether a keyframe is a loop.
    Query {
        keyframe: String,
        #[serde(default)]
        body: Body,
        /// The true keyframes; none: the ground truth is unknown.
        truth: Option<Vec<String>>,
        /// The keyframes that are neither correct nor wrong.
        #[serde(default)]
        ignore: Vec<String>,
    },
    /// Close a loop.
    Loop { body: Body },
    /// Correct poses.
    Poses { body: Body },
    /// Change what keyframes observe.
    Observations { body: Body },
    #[serde(rename = "merge_sessions")]
    MergeSessions { session: String, body: Body },
    /// Put a prior anchor.
    Anchor { id: String, body: Body },
    /// Describe the anchor of a detection by hand.
    Description { keyframe: String, detection: usize, body: Body },
    /// Import a model verdict.
    Judgement { body: Body },
    /// Remove a keyframe, the anchor of one of its detections, a prior anchor, or a loop.
    Delete(Deleted),
}

/// The target of a `delete` line: `{"keyframe"}`, `{"keyframe","detection"}`, `{"anchor"}`, `{"loop"}` or `{"session"}`.
#[derive(Debug, Deserialize, PartialEq)]
#[serde(try_from = "DeletedAsWritten")]
pub(super) enum Deleted {
    /// A keyframe.
    Keyframe(String),
    /// The anchor of a detection.
    Anchor { keyframe: String, detection: usize },
    /// A prior anchor.
    Prior(String),
    /// A loop, to be revoked.
    Loop(String),
    /// A session, whose merge is to be revoked.
    Merge(String),
}

#[derive(Deserialize)]
struct DeletedAsWritten {
    keyframe: Option<String>,
    detection: Option<usize>,
    anchor: Option<String>,
    #[serde(rename = "loop")]
    closed: Option<String>,
    session: Option<String>,
}

impl TryFrom<DeletedAsWritten> for Deleted {
    type Error = &'static str;

    fn try_from(written: DeletedAsWritten) -> Result<Self, Self::Error> {
        let DeletedAsWritten { keyframe, detection, anchor, closed, session } = written;
        match (keyframe, detection, anchor, closed, session) {
            (Some(keyframe), None, None, None, None) => Ok(Self::Keyframe(keyframe)),
            (Some(keyframe), Some(detection), None, None, None) => Ok(Self::Anchor { keyframe, detection }),
            (None, None, Some(prior), None, None) => Ok(Self::Prior(prior)),
            (None, None, None, Some(closed), None) => Ok(Self::Loop(closed)),
            (None, None, None, None, Some(session)) => Ok(Self::Merge(session)),
            _ => Err(
                "a delete line needs a keyframe, a keyframe and a detection, a prior anchor, a loop, or a session",
            ),
        }
    }
}

/// A JSON object.
pub(super) type Body = Map<String, Value>;

/// A line as written.
#[derive(Deserialize)]
struct Written {
    map: Option<String>,
    #[serde(flatten)]
    op: Op,
}

/// A line that is not an operation.
#[derive(Debug, thiserror::Error)]
#[error("line {line}: {fault}")]
pub struct LineError {
    line: u64,
    fault: Fault,
}

#[derive(Debug, thiserror::Error)]
enum Fault {
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    #[error("longer than {0} bytes")]
    TooLong(u64),
    #[error("not an operation: {0}")]
    Malformed(String),
    #[error("belongs to no map: it has no \"map\", and no map line comes before it")]
    NoMap,
}

impl Recording {
    /// Opens a file (`-`: standard input), and reports to `progress` how much is read.
    pub fn open(path: &Path, progress: &ProgressBar) -> io::Result<Self> {
        if path == Path::new("-") {
            return Self::new(progress.wrap_read(io::stdin()), MAX_LINE_BYTES);
        }
        let file = File::open(path)?;
        progress.set_length(file.metadata()?.len());
        Self::new(progress.wrap_read(file), MAX_LINE_BYTES)
    }

    /// Reads plain NDJSON, gzip or zstd, detected by their first bytes.
    fn new(bytes: impl Read + Send + 'static, max_line_bytes: u64) -> io::Result<Self> {
        Ok(Self { reader: decompressed(bytes)?, max_line_bytes, line: 0, map: None, broken: false })
    }

    fn next_line(&mut self) -> Result<Option<Line>, Fault> {
        let mut text = Vec::new();
        loop {
            text.clear();
            self.line += 1;
            // One byte beyond the limit distinguishes a line that fits from one that does not.
            let mut bounded = self.reader.by_ref().take(self.max_line_bytes + 1);
            let length = bounded.read_until(b'\n', &mut text)?;
            if length == 0 {
                return Ok(None);
            }
            let content = text.strip_suffix(b"\n").unwrap_or(&text);
            if content.len() as u64 > self.max_line_bytes {
                return Err(Fault::TooLong(self.max_line_bytes));
            }
            if !content.trim_ascii().is_empty() {
                return self.parse(content).map(Some);
            }
        }
    }

    fn parse(&mut self, text: &[u8]) -> Result<Line, Fault> {
        if let Some(told) = utf_16(text) {
            return Err(Fault::Malformed(told.to_owned()));
        }
        let Written { map, op } =
            serde_json::from_slice(without_mark(text)).map_err(|error| malformed(&error))?;
        let map = match &op {
            Op::Map { id, .. } => {
                self.map = Some(id.clone());
                id.clone()
            }
            _ => map.or_else(|| self.map.clone()).ok_or(Fault::NoMap)?,
        };
        Ok(Line { number: self.line, map, op })
    }
}

impl Iterator for Recording {
    type Item = Result<Line, LineError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.broken {
            return None;
        }
        let line = self.next_line().map_err(|fault| {
            self.broken = true;
            LineError { line: self.line, fault }
        });
        line.transpose()
    }
}

/// Returns the fault without `serde_json`'s "line 1", which would mislead; the column helps.
fn malformed(error: &serde_json::Error) -> Fault {
    let message = error.to_string();
    let what = message.split(" at line ").next().unwrap_or_default();
    Fault::Malformed(match error.column() {
        0 => what.to_owned(),
        column => format!("{what} (column {column})"),
    })
}

/// Returns the number of operations in these bytes, all parsed; for tools that check a recording, and for fuzzing.
pub fn count_operations(bytes: impl Read + Send + 'static) -> io::Result<usize> {
    let mut recording = Recording::new(bytes, MAX_LINE_BYTES)?;
    recording.try_fold(0, |count, line| line.map(|_| count + 1)).map_err(io::Error::other)
}

#[cfg(test)]
mod tests;
