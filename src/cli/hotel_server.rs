//! A server with the vocabulary of the simulated hotel.

use super::failure::Failure;
use super::replay::OwnServer;
use super::serve::temporary_server;
use crate::hotel::building::texture::Patterns;

/// Starts a server with the vocabulary of the simulated hotel, on a temporary database.
pub async fn hotel_server() -> Result<OwnServer, Failure> {
    let vocabulary = tokio::task::spawn_blocking(|| Patterns::new().vocabulary()).await??;
    temporary_server(Some(vocabulary)).await
}
