//! Limits: how much the server takes on at once, and how long it waits for a client.

use std::time::Duration;

use clap::{Args, Parser};
use rustix::process::{Resource, getrlimit, setrlimit};

/// How much at once, and how patient.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Limits")]
pub struct LimitArgs {
    /// Connections open at once. One more takes the place of the one that has waited longest for its client's next
    /// request; if all are at work it is answered 503 and closed
    #[arg(long, env = "REVISIT_MAX_CONNECTIONS", value_name = "N", default_value_t = 1024, value_parser = positive)]
    pub max_connections: usize,
    /// Streams of events that one key may listen to at once, or everybody together while there is no key; one more is
    /// answered 429 (503 without keys) [default: a quarter of --max-connections]
    #[arg(long, env = "REVISIT_MAX_STREAMS", value_name = "N", value_parser = positive)]
    pub max_streams: Option<usize>,
    /// Requests worked on at once; one whose body is still arriving does not count. One more is answered 503 at once.
    /// From half of them on background work rests; reads may take three quarters of them, and so may writes
    /// [default: 256 for each core]
    #[arg(long, env = "REVISIT_MAX_REQUESTS", value_name = "N", value_parser = positive)]
    pub max_requests: Option<usize>,
    /// Memory for large bodies that are being received and read, in MiB; one that does not fit is answered 503
    #[arg(long, env = "REVISIT_MAX_BODY_MEMORY", value_name = "MIB", default_value_t = 512, value_parser = positive)]
    pub max_body_memory: usize,
    /// Memory for large answers that their clients have not taken yet, in MiB. Where one more does not fit, the connection
    /// of which nothing was taken for longest is closed; if all are being taken it is answered 503
    #[arg(long, env = "REVISIT_MAX_ANSWER_MEMORY", value_name = "MIB", default_value_t = 128, value_parser = positive)]
    pub max_answer_memory: usize,
    /// How long a client may take to send a request's head, and to begin with its body, in seconds
    #[arg(long, env = "REVISIT_HEADER_TIMEOUT", value_name = "S", default_value = "5", value_parser = seconds)]
    pub header_timeout: Duration,
    /// How long a connection may stay open without a request, in seconds
    #[arg(long, env = "REVISIT_KEEP_ALIVE", value_name = "S", default_value = "75", value_parser = seconds)]
    pub keep_alive: Duration,
    /// How long a client may send nothing of a body, take nothing of an answer, or leave what it was sent unacknowledged,
    /// in seconds
    #[arg(long, env = "REVISIT_STALL_TIMEOUT", value_name = "S", default_value = "30", value_parser = seconds)]
    pub stall_timeout: Duration,
    /// The least average rate of a body, in bytes a second; time in which the server is not ready for more is not counted
    #[arg(long, env = "REVISIT_MIN_BODY_RATE", value_name = "BYTES", default_value_t = 1024, value_parser = positive)]
    pub min_body_rate: usize,
    /// How long to go on after SIGTERM while `/readyz` says no, in seconds: for balancers that must notice before
    /// connections are refused
    #[arg(long, env = "REVISIT_DRAIN", value_name = "S", default_value = "0", value_parser = seconds_or_none)]
    pub drain: Duration,
}

/// Lets this process open as many files as it may: many systems give 1024 unless asked, and each connection is one.
/// How many that are; fewer than connections are wanted is for the caller to tell.
pub fn raise_open_files() -> Option<u64> {
    let mut limit = getrlimit(Resource::Nofile);
    if limit.current != limit.maximum {
        limit.current = limit.maximum;
        // Where that is forbidden, what there is has to do.
        let _ = setrlimit(Resource::Nofile, limit);
    }
    getrlimit(Resource::Nofile).current
}

#[derive(Parser)]
struct OnlyLimits {
    #[command(flatten)]
    limits: LimitArgs,
}

impl LimitArgs {
    /// Streams that one key may listen to, and all keys together: each keeps a connection for as long as its client
    /// likes, and half of the connections is left to those who ask something.
    pub fn streams(&self) -> (usize, usize) {
        let of_a_key = self.max_streams.unwrap_or((self.max_connections / 4).max(1));
        (of_a_key, of_a_key.max(self.max_connections / 2))
    }

    /// Requests worked on at once. A core answers some 600 mixed requests a second, so 256 of them keep the last one waiting
    /// for less than the second after which a refused client comes back.
    pub fn requests(&self) -> usize {
        let cores = std::thread::available_parallelism().map_or(2, usize::from);
        self.max_requests.unwrap_or(256 * cores)
    }

    /// These flags, as a command line would give them; for tests and benchmarks.
    pub fn of<T: AsRef<str>>(flags: &[T]) -> Result<Self, clap::Error> {
        let line = std::iter::once("revisit").chain(flags.iter().map(AsRef::as_ref));
        OnlyLimits::try_parse_from(line).map(|parsed| parsed.limits)
    }
}

fn positive(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(number) if (1..=1 << 30).contains(&number) => Ok(number),
        _ => Err("expected a whole number from 1 to 1073741824".to_owned()),
    }
}

fn seconds(text: &str) -> Result<Duration, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.001..=86_400.0).contains(&seconds) => Ok(Duration::from_secs_f64(seconds)),
        _ => Err("expected seconds, from 0.001 to 86400".to_owned()),
    }
}

fn seconds_or_none(text: &str) -> Result<Duration, String> {
    if text == "0" { Ok(Duration::ZERO) } else { seconds(text) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_serve_nobody_is_refused() {
        assert!(LimitArgs::of::<&str>(&[]).is_ok());
        for flags in [
            ["--max-connections", "0"],
            ["--max-requests", "-1"],
            ["--max-streams", "0"],
            ["--header-timeout", "0"],
            ["--keep-alive", "NaN"],
            ["--min-body-rate", "fast"],
        ] {
            assert!(LimitArgs::of(&flags).is_err(), "{flags:?}");
        }
    }
}
