//! Command line: one thin file for each subcommand.

mod backup;
mod check;
mod completions;
#[cfg(feature = "hotel")]
mod demo;
#[cfg(feature = "hotel")]
mod eval;
mod export;
mod health;
#[cfg(feature = "hotel")]
mod hotel;
mod keys;
mod openapi;
pub mod replay;
mod serve;
mod vocabulary;

use std::error::Error;
use std::io::{self, Write as _};

use clap::{Parser, Subcommand};
use tokio::signal::unix::{SignalKind, signal};
use tokio_util::sync::CancellationToken;

/// Revisit: semantic place recognition. "Is this keyframe a loop?"
///
/// A SLAM client sends keyframes over HTTP, with the texts it has read on doors and signs, and asks whether it has
/// been there before. Start with `revisit serve` and open its address in a browser.
///
/// Most flags are also environment variables, as --help tells of each.
#[derive(Debug, Parser)]
#[command(name = "revisit", version)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Serve(Box<serve::ServeArgs>),
    Replay(replay::ReplayArgs),
    #[cfg(feature = "hotel")]
    #[command(flatten)]
    Hotel(hotel::HotelCommand),
    Openapi(openapi::OpenapiArgs),
    Vocabulary(vocabulary::VocabularyArgs),
    Keys(keys::KeysArgs),
    Backup(backup::BackupArgs),
    Restore(backup::RestoreArgs),
    Check(check::CheckArgs),
    Export(export::ExportArgs),
    Health(health::HealthArgs),
    Completions(completions::CompletionsArgs),
}

/// Why a subcommand failed, for a person.
pub type Failure = Box<dyn Error + Send + Sync>;

impl Cli {
    /// Runs the subcommand.
    pub async fn run(self) -> Result<(), Failure> {
        match self.command {
            Command::Serve(args) => serve::run(*args).await,
            Command::Replay(args) => Ok(replay::run(args, serve::own_server).await?),
            #[cfg(feature = "hotel")]
            Command::Hotel(command) => command.run().await,
            Command::Openapi(args) => openapi::run(&args),
            Command::Vocabulary(args) => vocabulary::run(args).await,
            Command::Keys(args) => keys::run(args).await,
            Command::Backup(args) => backup::run(args).await,
            Command::Restore(args) => backup::run_restore(args).await,
            Command::Check(args) => check::run(args).await,
            Command::Export(args) => export::run(args).await,
            Command::Health(args) => health::run(args).await,
            Command::Completions(args) => completions::run(&args),
        }
    }
}

/// Writes to standard output. A reader that has seen enough (`revisit openapi | head`) is no error.
fn write_out(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// Cancelled by the first SIGTERM or SIGINT.
fn stop_on_signal() -> Result<CancellationToken, Failure> {
    let (mut term, mut int) = (signal(SignalKind::terminate())?, signal(SignalKind::interrupt())?);
    let stopping = CancellationToken::new();
    let token = stopping.clone();
    tokio::spawn(async move {
        tokio::select! {
            _ = term.recv() => {}
            _ = int.recv() => {}
        }
        tracing::info!("stopping");
        token.cancel();
    });
    Ok(stopping)
}
