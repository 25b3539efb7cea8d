//! Command line: the subcommands and their dispatch.

use clap::{CommandFactory as _, Parser, Subcommand};

use super::failure::Failure;
use super::{backup, check, completions, copy, export, health, keys, openapi, replay, serve, vocabulary};
#[cfg(feature = "hotel")]
use super::{demo, eval};

/// Revisit: semantic place recognition. "Is this keyframe a loop?"
///
/// A SLAM client sends keyframes over HTTP, with the texts it has read on doors and signs. It queries whether a
/// keyframe shows a known place. Start with `revisit serve` and open its address in a browser.
///
/// Most flags are also environment variables, which --help lists.
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
    Demo(demo::DemoArgs),
    #[cfg(feature = "hotel")]
    Eval(eval::EvalArgs),
    Openapi(openapi::OpenapiArgs),
    Vocabulary(vocabulary::VocabularyArgs),
    Keys(keys::KeysArgs),
    Backup(backup::BackupArgs),
    Restore(backup::RestoreArgs),
    Copy(copy::CopyArgs),
    Check(check::CheckArgs),
    Export(export::ExportArgs),
    Health(health::HealthArgs),
    Completions(completions::CompletionsArgs),
}

impl Cli {
    /// Runs the subcommand.
    pub async fn run(self) -> Result<(), Failure> {
        match self.command {
            Command::Serve(args) => serve::run(*args).await,
            Command::Replay(args) => replay::run(args, serve::own_server).await,
            #[cfg(feature = "hotel")]
            Command::Demo(args) => demo::run(args).await,
            #[cfg(feature = "hotel")]
            Command::Eval(args) => eval::run(args).await,
            Command::Openapi(args) => openapi::run(&args),
            Command::Vocabulary(args) => vocabulary::run(args).await,
            Command::Keys(args) => keys::run(args).await,
            Command::Backup(args) => backup::run(args).await,
            Command::Restore(args) => backup::run_restore(args).await,
            Command::Copy(args) => copy::run(args).await,
            Command::Check(args) => check::run(args).await,
            Command::Export(args) => export::run(args).await,
            Command::Health(args) => health::run(args).await,
            Command::Completions(args) => completions::run(&args, Self::command()),
        }
    }
}
