//! Replay errors.

use std::error::Error;
use std::io;
use std::path::PathBuf;

use super::recording::LineError;
use crate::client::ClientError;

/// The reason why a replay has no score, or an incomplete one.
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
    /// The file of frames is invalid.
    #[error("{0}")]
    Frames(String),
    /// No server to replay against.
    #[error("cannot start a server to replay against: {0}")]
    OwnServer(Box<dyn Error + Send + Sync>),
    /// The server's address is invalid.
    #[error(transparent)]
    Address(ClientError),
    /// A line is not an operation.
    #[error(transparent)]
    Line(#[from] LineError),
    /// A line of the recording was rejected, or got no response.
    #[error("line {line}, {what}: {source}")]
    Refused {
        /// Counted from 1.
        line: u64,
        /// The operation.
        what: String,
        /// The server's error.
        source: ClientError,
    },
    /// A map with the recording's name has other content.
    #[error(
        "line {line}: {server} already has a map {map:?} with other content; replay beside it with \
         --map-prefix (such as --map-prefix again-), or delete it first\n{source}"
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
    /// The replay continued past rejected lines.
    #[error("{failed} of the recording's lines were rejected: the score covers only the others")]
    Incomplete {
        /// The number of lines.
        failed: u64,
    },
    /// The score cannot be written.
    #[error("cannot write the score: {0}")]
    Output(#[from] io::Error),
}
