//! The subcommands that simulate: what they are, and the server that they talk to.

use clap::Subcommand;

use super::replay::OwnServer;
use super::serve::temporary_server;
use super::{Failure, demo, eval};
use crate::hotel::building::texture::Patterns;

/// The subcommands of the simulated hotel.
#[derive(Debug, Subcommand)]
pub enum HotelCommand {
    Demo(demo::DemoArgs),
    Eval(eval::EvalArgs),
}

impl HotelCommand {
    /// Runs the subcommand.
    pub async fn run(self) -> Result<(), Failure> {
        match self {
            Self::Demo(args) => demo::run(args).await,
            Self::Eval(args) => eval::run(args).await,
        }
    }
}

/// Starts a server with the vocabulary of the simulated hotel, on a database that goes with it.
pub async fn hotel_server() -> Result<OwnServer, Failure> {
    let vocabulary = tokio::task::spawn_blocking(|| Patterns::new().vocabulary()).await??;
    temporary_server(Some(vocabulary)).await
}
