//! `revisit eval hotel`: the paper's experiment (§VI-A), and the same under noise.
//!
//! | file | concept |
//! |---|---|
//! | `sequences` | the paper's twelve sequences: Tables II and III |
//! | `worlds` | random worlds under noise |
//! | `record` | a tour as a recording |
//! | `files` | figures, trajectories and JSON |

mod files;
mod record;
mod sequences;
mod worlds;

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};

use super::Failure;
use super::serve::hotel_server;
use crate::client::Client;
use crate::hotel::arm::Arm;
use crate::hotel::noise::NoiseKind;
use crate::hotel::paper::{PrintedSequence, SEQUENCES};

/// Run an experiment.
#[derive(Args, Debug)]
pub struct EvalArgs {
    #[command(subcommand)]
    experiment: Experiment,
}

#[derive(Debug, Subcommand)]
enum Experiment {
    Hotel(HotelArgs),
}

/// Drive a robot through simulated hotels, and score the loops it is told.
///
/// Without options: the paper's twelve sequences with three methods (ours, the paper's to the letter, bag of words and
/// Sim3 without anchors), Tables II and III beside the printed figures, Figure 6 and a precision-recall curve.
/// With --worlds: random hotels under noise. A server of its own on a database that is thrown away answers over HTTP; the
/// truth comes from the simulator and never reaches it.
#[derive(Args, Clone, Debug)]
struct HotelArgs {
    /// Only these of the paper's sequences, as SE1-00 or SE2-05, with commas between them
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with_all = ["worlds", "world", "record"], value_parser = sequence)]
    sequences: Vec<PrintedSequence>,
    /// So many random worlds under each kind of noise, instead of the paper's sequences; at most 1,000
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000))]
    worlds: Option<u64>,
    /// With --worlds: those that are kept for reporting, seeds from 1,000,000 on; nothing is tuned on them
    #[arg(long, requires = "worlds")]
    held_out: bool,
    /// none, reader, missed, repeated, wording, fleet, mixed (reader to wording at once), renumbered (eight rounds, between
    /// which door numbers change); all is reader, missed, repeated, wording and fleet, one at a time, pooled
    #[arg(long, value_name = "LEVEL", default_value = "all", value_parser = noise_kinds)]
    noise: NoiseKinds,
    /// This one random world, with what was answered at each keyframe that was wrong or missed
    #[arg(long, value_name = "SEED", conflicts_with = "worlds", value_parser = clap::value_parser!(u64).range(..1_000))]
    world: Option<u64>,
    /// Write a tour as a recording for `revisit replay` instead of driving it: that of --world, or of SE2 00 (.ndjson, .gz
    /// or .zst)
    #[arg(long, value_name = "FILE", conflicts_with = "worlds")]
    record: Option<PathBuf>,
    /// Where figures, trajectories and results.json go
    #[arg(long, value_name = "FOLDER", default_value = "hotel-results")]
    output: PathBuf,
    /// Drive so many sequences or worlds at a time
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u16).range(1..=64))]
    jobs: u16,
}

fn sequence(name: &str) -> Result<PrintedSequence, String> {
    let wanted = name.to_uppercase().replace('-', " ");
    let found = SEQUENCES.into_iter().find(|sequence| sequence.name() == wanted);
    found.ok_or_else(|| String::from("SE1-00 to SE1-05 and SE2-00 to SE2-05"))
}

/// What `--noise` names.
#[derive(Clone, Debug, PartialEq)]
struct NoiseKinds(Vec<NoiseKind>);

fn noise_kinds(name: &str) -> Result<NoiseKinds, String> {
    if name == "all" {
        return Ok(NoiseKinds(NoiseKind::TROUBLES.to_vec()));
    }
    let names: Vec<&str> = NoiseKind::ALL.into_iter().map(NoiseKind::name).collect();
    let kind = NoiseKind::of_name(name).ok_or_else(|| format!("one of {}, all", names.join(", ")))?;
    Ok(NoiseKinds(vec![kind]))
}

/// The arms that drive through random worlds: bag of words alone is lost in each of them.
const WORLD_ARMS: [Arm; 2] = [Arm::Ours, Arm::Paper];

/// Runs it.
pub async fn run(args: EvalArgs) -> Result<(), Failure> {
    let Experiment::Hotel(args) = args.experiment;
    if let Some(file) = args.record.clone() {
        return tokio::task::spawn_blocking(move || record::run(&args, &file)).await?;
    }
    let server = hotel_server().await?;
    let client = Client::new(server.url())?;
    match (args.world, args.worlds) {
        (Some(seed), _) => worlds::explain(&args, &client, seed).await,
        (None, Some(count)) => worlds::run(&args, &client, count).await,
        (None, None) => sequences::run(&args, &client).await,
    }
}

/// A bar that counts keyframes.
fn progress_bar(keyframes: u64) -> ProgressBar {
    let bar = ProgressBar::new(keyframes);
    let style = ProgressStyle::with_template("{msg:28} {wide_bar} {percent:>3} % {eta:>5} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(250));
    bar
}
