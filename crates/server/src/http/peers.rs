//! Peers: connections to the other servers that share the database.

use std::sync::OnceLock;
use std::time::Duration;

use axum::http::HeaderName;

use crate::config::tls;

/// The header with the secret of the server that a request was sent on to.
pub const FORWARDED: HeaderName = HeaderName::from_static("x-revisit-forwarded");

/// Longest time until a connection to another server is there: they are near.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);

/// Clients to the other servers: connections are kept open.
#[derive(Debug, Default)]
pub struct Peers {
    client: OnceLock<reqwest::Client>,
}

impl Peers {
    /// Returns a client for the address of another server.
    pub fn client(&self, address: &str) -> Result<&reqwest::Client, reqwest::Error> {
        if let Some(client) = self.client.get() {
            return Ok(client);
        }
        let client = tls::client_for(address)
            .connect_timeout(CONNECT_TIMEOUT)
            .redirect(reqwest::redirect::Policy::none())
            .no_proxy()
            .build()?;
        Ok(self.client.get_or_init(|| client))
    }
}
