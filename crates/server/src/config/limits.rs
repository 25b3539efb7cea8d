//! Limits: the concurrency, the memory and the timeouts of the server.

use std::time::Duration;

use clap::Args;
use rustix::process::{Resource, getrlimit, setrlimit};

use super::flags::{number, parsed};

/// Limits of concurrency, memory and time.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Limits")]
pub struct LimitArgs {
    /// Maximum open connections. A new one evicts the connection that has been idle longest; if all are active, it
    /// receives 503 and is closed
    #[arg(long, env = "REVISIT_MAX_CONNECTIONS", value_name = "N", default_value_t = 1024, value_parser = positive)]
    pub max_connections: usize,
    /// Maximum open event streams per key, or in total without keys; further ones receive 429 (503 without keys)
    /// [default: a quarter of --max-connections]
    #[arg(long, env = "REVISIT_MAX_STREAMS", value_name = "N", value_parser = positive)]
    pub max_streams: Option<usize>,
    /// Maximum requests in flight, not counting those whose body is still arriving. Further ones receive 503 at once.
    /// Above half of it, background work pauses; reads may use three quarters, and so may writes [default: 256 per
    /// core]
    #[arg(long, env = "REVISIT_MAX_REQUESTS", value_name = "N", value_parser = positive)]
    pub max_requests: Option<usize>,
    /// Memory for large request bodies, in MiB; a body that does not fit receives 503
    #[arg(long, env = "REVISIT_MAX_BODY_MEMORY", value_name = "MIB", default_value_t = 512, value_parser = positive)]
    pub max_body_memory: usize,
    /// Memory for large responses not yet received by their clients, in MiB. If a new one does not fit, the connection
    /// stalled longest is closed; if none is stalled, the request receives 503
    #[arg(long, env = "REVISIT_MAX_ANSWER_MEMORY", value_name = "MIB", default_value_t = 128, value_parser = positive)]
    pub max_answer_memory: usize,
    /// Timeout for a request's head, and for the start of its body, in seconds
    #[arg(long, env = "REVISIT_HEADER_TIMEOUT", value_name = "S", default_value = "5", value_parser = seconds)]
    pub header_timeout: Duration,
    /// Timeout of an idle connection, in seconds
    #[arg(long, env = "REVISIT_KEEP_ALIVE", value_name = "S", default_value = "75", value_parser = seconds)]
    pub keep_alive: Duration,
    /// Timeout of a client that sends nothing of a body, receives nothing of a response, or acknowledges nothing, in
    /// seconds
    #[arg(long, env = "REVISIT_STALL_TIMEOUT", value_name = "S", default_value = "30", value_parser = seconds)]
    pub stall_timeout: Duration,
    /// Minimum average rate of a body, in bytes per second; time in which the server is not ready to receive is not
    /// counted
    #[arg(long, env = "REVISIT_MIN_BODY_RATE", value_name = "BYTES", default_value_t = 1024, value_parser = positive)]
    pub min_body_rate: usize,
    /// Seconds to keep serving after SIGTERM while `/readyz` returns 503, so that load balancers notice before
    /// connections are refused
    #[arg(long, env = "REVISIT_DRAIN", value_name = "S", default_value = "0", value_parser = seconds_or_none)]
    pub drain: Duration,
}

/// Raises the process's limit of open files to its maximum, and returns it. Many systems default to 1024, and each
/// connection needs one. The caller reports a limit below the number of connections.
pub fn raise_open_files() -> Option<u64> {
    let mut limit = getrlimit(Resource::Nofile);
    if limit.current != limit.maximum {
        limit.current = limit.maximum;
        // Where that is forbidden, the current limit applies.
        let _ = setrlimit(Resource::Nofile, limit);
    }
    getrlimit(Resource::Nofile).current
}

/// Returns the number of cores that this process may use.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(2, usize::from)
}

impl LimitArgs {
    /// Returns the maximum streams per key and of all keys together. A stream holds its connection indefinitely, so
    /// half of the connections is left to requests.
    pub fn streams(&self) -> (usize, usize) {
        let of_a_key = self.max_streams.unwrap_or((self.max_connections / 4).max(1));
        (of_a_key, of_a_key.max(self.max_connections / 2))
    }

    /// Returns the maximum requests in flight. A core answers about 600 mixed requests per second. With 256 of them,
    /// the last waits for less than the second after which a rejected client retries.
    pub fn requests(&self) -> usize {
        self.max_requests.unwrap_or(256 * cores())
    }

    /// Parses these flags, as a command line would give them; for tests and benchmarks.
    pub fn of<T: AsRef<str>>(flags: &[T]) -> Result<Self, clap::Error> {
        parsed(flags)
    }
}

fn positive(text: &str) -> Result<usize, String> {
    number(text, 1..=1 << 30, "a whole number from 1 to 1073741824")
}

fn seconds(text: &str) -> Result<Duration, String> {
    number(text, 0.001..=86_400.0, "seconds, from 0.001 to 86400").map(Duration::from_secs_f64)
}

fn seconds_or_none(text: &str) -> Result<Duration, String> {
    if text == "0" { Ok(Duration::ZERO) } else { seconds(text) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rejects_limits_that_would_serve_no_request() {
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
