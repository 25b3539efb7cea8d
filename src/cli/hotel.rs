//! The subcommands of the simulated hotel.

use clap::Subcommand;

use super::failure::Failure;
use super::{demo, eval};

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
