//! A server with the vocabulary of the simulated hotel.

use std::net::SocketAddr;
use std::path::Path;

use super::failure::Failure;
use super::replay::OwnServer;
use super::serve::{LOCAL, server_in};
use crate::hotel::building::texture::Patterns;

/// Starts a server with the vocabulary of the simulated hotel, on a temporary database.
pub async fn hotel_server() -> Result<OwnServer, Failure> {
    let directory = tempfile::tempdir()?;
    hotel_server_in(directory.path(), LOCAL).await.map(|server| server.with(directory))
}

/// Starts it with its data in this folder.
pub async fn hotel_server_in(folder: &Path, listen: SocketAddr) -> Result<OwnServer, Failure> {
    let vocabulary = tokio::task::spawn_blocking(|| Patterns::new().vocabulary()).await??;
    server_in(folder, Some(vocabulary), listen).await
}
