//! The arguments of `revisit replay`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::BoolishValueParser;

use super::overrides::Overrides;

/// The format of a recording, below the options of `--help`.
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
    /// Each session's frame in a common one: checks the transformations of the loops found
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
