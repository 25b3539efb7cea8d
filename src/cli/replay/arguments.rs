//! The arguments of `revisit replay`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::BoolishValueParser;

use super::overrides::Overrides;

/// The format of a recording, below the options of `--help`.
const FORMAT: &str = include_str!("format.txt");

/// Replay a recording and score the reported loops.
///
/// Without --server, the recording is sent to a server started for it on a temporary database. The format of a
/// recording is described below the options.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = FORMAT)]
pub struct ReplayArgs {
    /// The recording: NDJSON, plain or compressed with gzip or zstd; `-` is standard input
    pub file: PathBuf,
    /// Replay against this server instead of a temporary one
    #[arg(long, env = "REVISIT_SERVER", value_name = "URL")]
    pub server: Option<String>,
    /// API key for --server
    #[arg(long, env = "REVISIT_KEY", value_name = "SECRET", hide_env_values = true)]
    pub key: Option<String>,
    /// Prefix every map id, to replay beside an existing map
    #[arg(long, env = "REVISIT_MAP_PREFIX", value_name = "PREFIX", default_value = "")]
    pub map_prefix: String,
    /// Maximum time each query waits for pending model descriptions
    #[arg(long, env = "REVISIT_MAX_WAIT_MS", value_name = "MS")]
    pub max_wait_ms: Option<u64>,
    /// The settings to change.
    #[command(flatten)]
    pub overrides: Overrides,
    /// Each session's frame in a common one; checks the transformations of the reported loops
    #[arg(long, env = "REVISIT_FRAMES", value_name = "FILE")]
    pub frames: Option<PathBuf>,
    /// Print one line for every true loop that was not accepted, with the reason
    #[arg(long, env = "REVISIT_EXPLAIN", value_parser = BoolishValueParser::new())]
    pub explain: bool,
    /// Continue when the server rejects a line; the exit code still reports it
    #[arg(long, env = "REVISIT_KEEP_GOING", value_parser = BoolishValueParser::new())]
    pub keep_going: bool,
    /// Print one JSON object on standard output instead of the table
    #[arg(long, env = "REVISIT_JSON", value_parser = BoolishValueParser::new())]
    pub json: bool,
}
