//! Replay: plays a recording against a server, and scores the loops it answers (`docs/recordings.md`).
//!
//! | file | concept |
//! |---|---|
//! | `recording` | a file becomes operations, line by line |
//! | `overrides` | settings of the recording's maps, changed for this replay |
//! | `play` | operations become requests, answers are kept |
//! | `answered` | one query: what is true, what was answered, and why |
//! | `frames` | how far transformations are from the true ones |
//! | `score` | precision and recall, of the service and of BoW alone |
//! | `latency` | percentiles |
//! | `report` | everything learnt, as the JSON object |
//! | `table` | the same for a person to read |

mod answered;
mod frames;
mod latency;
mod overrides;
mod play;
mod recording;
mod report;
pub(in crate::cli) mod score;
mod table;
#[cfg(test)]
mod tests;

use std::any::Any;
use std::error::Error;
use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use clap::builder::BoolishValueParser;
use indicatif::{ProgressBar, ProgressStyle};

use crate::client::{Client, ClientError};
use frames::Frames;
use play::Player;
use recording::Recording;
use report::Report;

pub use overrides::{Overrides, Setting};
pub use recording::{LineError, count_operations};

/// What a recording is, below the options of `--help`.
const FORMAT: &str = include_str!("format.txt");

/// Play a recording and score the loops found.
///
/// Without --server the recording is played against a server of its own, on a database that is thrown away. What a recording
/// is stands below the options.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = FORMAT)]
pub struct ReplayArgs {
    /// The recording: NDJSON, plain or compressed with gzip or zstd; `-` is standard input
    pub file: PathBuf,
    /// Play against this server instead of one of its own
    #[arg(long, env = "REVISIT_SERVER", value_name = "URL")]
    pub server: Option<String>,
    /// API key for --server
    #[arg(long, env = "REVISIT_KEY", value_name = "SECRET", hide_env_values = true)]
    pub key: Option<String>,
    /// Put this before every map id, to replay beside a map that is there already
    #[arg(long, env = "REVISIT_MAP_PREFIX", value_name = "PREFIX", default_value = "")]
    pub map_prefix: String,
    /// Let every query wait this long for descriptions that a model still owes
    #[arg(long, env = "REVISIT_MAX_WAIT_MS", value_name = "MS")]
    pub max_wait_ms: Option<u64>,
    /// Which settings to change
    #[command(flatten)]
    pub overrides: Overrides,
    /// Where each session's frame lies in a common one: checks the transformations of the loops found
    #[arg(long, env = "REVISIT_FRAMES", value_name = "FILE")]
    pub frames: Option<PathBuf>,
    /// One line for every query with a true loop that was not accepted: why not
    #[arg(long, env = "REVISIT_EXPLAIN", value_parser = BoolishValueParser::new())]
    pub explain: bool,
    /// Go on when the server refuses a line; the exit code still says so
    #[arg(long, env = "REVISIT_KEEP_GOING", value_parser = BoolishValueParser::new())]
    pub keep_going: bool,
    /// One JSON object on standard output instead of the table
    #[arg(long, env = "REVISIT_JSON", value_parser = BoolishValueParser::new())]
    pub json: bool,
}

/// A server that runs as long as this value lives.
pub struct OwnServer {
    url: String,
    _running: Box<dyn Any + Send>,
}

impl OwnServer {
    /// Returns the server at `url`; dropping `running` stops it and removes its database.
    pub fn new(url: impl Into<String>, running: impl Send + 'static) -> Self {
        Self { url: url.into(), _running: Box::new(running) }
    }

    /// Where it listens.
    pub fn url(&self) -> &str {
        &self.url
    }
}

/// Why a replay came to no score, or to an incomplete one.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system says.
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
        /// What the server said.
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
        /// What the server said.
        source: ClientError,
    },
    /// The replay went on past refused lines.
    #[error("{failed} of the recording's lines were refused: the score is that of the others")]
    Incomplete {
        /// How many.
        failed: u64,
    },
    /// The score cannot be written.
    #[error("cannot write the score: {0}")]
    Output(#[from] io::Error),
}

/// Runs `revisit replay`; `own_server` starts a server on a temporary database, if one is needed.
pub async fn run<S>(args: ReplayArgs, own_server: S) -> Result<(), ReplayError>
where
    S: AsyncFnOnce() -> Result<OwnServer, Box<dyn Error + Send + Sync>>,
{
    let report = replay(&args, own_server).await?;
    let text = if args.json { format!("{}\n", report.to_json()) } else { report.to_string() };
    write_out(&text)?;
    match report.failed {
        0 => Ok(()),
        failed => Err(ReplayError::Incomplete { failed }),
    }
}

async fn replay<S>(args: &ReplayArgs, own_server: S) -> Result<Report, ReplayError>
where
    S: AsyncFnOnce() -> Result<OwnServer, Box<dyn Error + Send + Sync>>,
{
    let progress = progress_bar();
    let recording = open(args, &progress)?;
    let frames = args.frames.as_deref().map(Frames::read).transpose().map_err(ReplayError::Frames)?;
    // Kept to the end: dropping it stops the server.
    let own_server = match &args.server {
        Some(_) => None,
        None => Some(own_server().await.map_err(ReplayError::OwnServer)?),
    };
    let client = connect(args, own_server.as_ref())?;
    let player = Player::new(client, args, progress.clone(), frames.unwrap_or_default());
    let played = player.play(recording).await;
    progress.finish_and_clear();
    Ok(Report::new(args, played?))
}

/// Shown on standard error, and only on a terminal; counts the bytes of the file.
fn progress_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::no_length().with_style(style)
}

fn open(args: &ReplayArgs, progress: &ProgressBar) -> Result<Recording, ReplayError> {
    Recording::open(&args.file, progress)
        .map_err(|source| ReplayError::Open { path: args.file.clone(), source })
}

fn connect(args: &ReplayArgs, own_server: Option<&OwnServer>) -> Result<Client, ReplayError> {
    let url = own_server.map(|server| server.url.as_str());
    let url = url.or(args.server.as_deref()).unwrap_or_default();
    let client = Client::new(url).map_err(ReplayError::Address)?;
    Ok(match (&args.key, own_server) {
        (Some(key), None) => client.with_key(key),
        _ => client,
    })
}

/// Returns a reader that has seen enough (`revisit replay ... | head`) is no error.
fn write_out(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}
