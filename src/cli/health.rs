//! `revisit health`: checks whether a running server is ready, for containers without another HTTP client.

use clap::Args;

use super::failure::Failure;
use super::output::write_out;
use crate::config::tls;

/// Check whether a running server is ready.
///
/// Exits with 1 if it is not, or does not respond.
#[derive(Args, Debug)]
pub struct HealthArgs {
    /// The server's address
    #[arg(long, env = "REVISIT_URL", value_name = "URL", default_value = "http://127.0.0.1:7878")]
    url: String,
    /// Timeout for the response, in milliseconds
    #[arg(long, env = "REVISIT_HEALTH_TIMEOUT_MS", value_name = "MS", default_value_t = 3_000)]
    timeout_ms: u64,
}

/// Runs `health`.
pub async fn run(args: HealthArgs) -> Result<(), Failure> {
    let url = format!("{}/readyz", args.url.trim_end_matches('/'));
    let client = tls::client_for(&url).no_proxy().timeout(std::time::Duration::from_millis(args.timeout_ms));
    let answer = client
        .build()?
        .get(&url)
        .send()
        .await
        .map_err(|error| format!("{url}: {}", tls::cause_of(&error)))?;
    match answer.status() {
        status if status.is_success() => Ok(write_out("ready\n")?),
        status => Err(format!("{url}: {status}").into()),
    }
}
