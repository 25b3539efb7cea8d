//! Logging: to standard error, as text or as JSON, filtered by target.

use std::io::IsTerminal as _;

use clap::{Args, ValueEnum};
use tracing_subscriber::Layer as _;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::{SubscriberInitExt as _, TryInitError};

use super::traces::{self, Traces};

/// The default filter.
const DEFAULT: &str = "info,sqlx=warn";

/// The filter and the format of the log.
#[derive(Args, Clone, Debug)]
pub struct LogArgs {
    /// Log filter: a level (error, warn, info, debug, trace), or levels by target, such as `info,sqlx=warn`
    #[arg(long = "log", env = "REVISIT_LOG", value_name = "LEVEL", default_value = DEFAULT, value_parser = filter)]
    pub filter: Targets,
    /// Log format
    #[arg(long = "log-format", env = "REVISIT_LOG_FORMAT", value_enum, default_value_t = LogFormat::Text)]
    pub format: LogFormat,
}

/// The format of a log line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    /// Text for people
    Text,
    /// One JSON object per line
    Json,
}

/// Parses a filter. `Targets` would take a word that is not a level for the name of a target, and log nothing else.
fn filter(text: &str) -> Result<Targets, String> {
    let text = if text.trim().is_empty() { DEFAULT } else { text };
    let is_level = |level: &str| level.parse::<LevelFilter>().is_ok();
    for part in text.split(',') {
        let level = part.rsplit_once('=').map_or(part, |(_, level)| level).trim();
        if !is_level(level) {
            return Err(format!("{part:?} has no level: off, error, warn, info, debug or trace"));
        }
    }
    text.parse().map_err(|error: tracing_subscriber::filter::ParseError| error.to_string())
}

/// Starts logging, and traces where there is a collector; once per process.
pub fn start(args: &LogArgs, traces: &Traces) -> Result<(), TryInitError> {
    let to_stderr = tracing_subscriber::fmt::layer().with_writer(std::io::stderr);
    let layer = match args.format {
        LogFormat::Text => to_stderr.with_ansi(std::io::stderr().is_terminal()).boxed(),
        LogFormat::Json => to_stderr.json().flatten_event(true).boxed(),
    };
    let shown = args.filter.clone().with_target(traces::TARGET, LevelFilter::OFF);
    tracing_subscriber::registry()
        .with(layer.with_filter(shown))
        .with(traces.layer(traces::TARGET))
        .try_init()
}

/// Carries the current span to another thread, so that log lines there include its request.
pub fn in_span<T>(work: impl FnOnce() -> T) -> impl FnOnce() -> T {
    let span = tracing::Span::current();
    move || span.in_scope(work)
}

/// Does the same within a child span of the request's trace.
pub fn in_part<T>(name: &'static str, work: impl FnOnce() -> T) -> impl FnOnce() -> T {
    let part = traces::part(name);
    in_span(move || part.in_scope(work))
}
