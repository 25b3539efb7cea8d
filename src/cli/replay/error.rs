//! Why a replay failed.

use std::error::Error;
use std::io;
use std::path::PathBuf;

use super::recording::LineError;
use crate::client::ClientError;

/// Why a replay came to no score, or to an incomplete one.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The file of frames is none.
    #[error("{0}")]
    Frames(String),
    /// No server to play against.
    #[error("cannot start a server to replay against: {0}")]
    OwnServer(Box<dyn Error + Send + Sync>),
    /// The server's address is wrong.
    #[error(transparent)]
    Address(ClientError),
    /// A line is no operation.
    #[error(transparent)]
    Line(#[from] LineError),
    /// A line of the recording was refused, or not answered.
    #[error("line {line}, {what}: {source}")]
    Refused {
        /// Counted from 1.
        line: u64,
        /// Which operation.
        what: String,
        /// The server's error.
        source: ClientError,
    },
    /// A map of the recording's name holds something else.
    #[error(
        "line {line}: {server} has a map {map:?} with other content already; replay beside it with \
         --map-prefix (say, --map-prefix again-), or delete it first\n{source}"
    )]
    MapExists {
        /// Counted from 1.
        line: u64,
        /// The map.
        map: String,
        /// The server.
        server: String,
        /// The server's error.
        source: ClientError,
    },
    /// The replay went on past refused lines.
    #[error("{failed} of the recording's lines were refused: the score is that of the others")]
    Incomplete {
        /// The number of lines.
        failed: u64,
    },
    /// The score cannot be written.
    #[error("cannot write the score: {0}")]
    Output(#[from] io::Error),
}
