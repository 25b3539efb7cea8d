//! Command line: one thin file per subcommand.

mod backup;
mod check;
mod command_line;
mod completions;
mod compressed_file;
mod copy;
#[cfg(feature = "hotel")]
mod demo;
#[cfg(feature = "hotel")]
mod eval;
mod export;
mod failure;
mod health;
#[cfg(feature = "hotel")]
mod hotel_server;
mod keys;
mod openapi;
mod output;
pub mod replay;
mod serve;
mod signals;
mod vocabulary;

pub use command_line::Cli;
pub use failure::Failure;
