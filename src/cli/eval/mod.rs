//! `revisit eval hotel`: the paper's experiment (§VI-A), and the same under noise.
//!
//! | file | concept |
//! |---|---|
//! | `arguments` | flags and their meaning |
//! | `buildings` | small buildings of many kinds |
//! | `sequences` | the paper's twelve sequences: Tables II and III |
//! | `worlds` | random worlds under noise |
//! | `record` | a tour as a recording |
//! | `restarts` | a robot that wakes up and asks where it is |
//! | `curve` | an arm's curve of precision over recall |
//! | `files` | figures, trajectories, recordings and JSON |
//! | `driven_worlds` | incremental results, so that a run can be resumed |
//! | `words_alone` | bag of words without geometry, beside the arms |
//! | `progress` | progress display |

mod arguments;
mod buildings;
mod curve;
mod driven_worlds;
mod files;
mod progress;
mod record;
mod restarts;
mod sequences;
mod words_alone;
mod worlds;

use super::failure::Failure;
use super::hotel_server::hotel_server;
use crate::client::Client;
use arguments::{Experiment, Generator};

pub use arguments::EvalArgs;

/// Runs `eval`.
pub async fn run(args: EvalArgs) -> Result<(), Failure> {
    let args = match args.experiment {
        Experiment::Hotel(args) => args,
        Experiment::Buildings(args) => return buildings::run(&args).await,
    };
    if args.hotel == Some(Generator::V2) && args.noise.is_some() {
        return Err("--hotel v2 takes no --noise: it has its own disturbances".into());
    }
    if let Some(file) = args.record.clone() {
        return tokio::task::spawn_blocking(move || record::run(&args, &file)).await?;
    }
    let server = hotel_server().await?;
    let client = Client::new(server.url())?;
    if args.locate {
        return restarts::run(&args, &client, args.worlds.unwrap_or(1)).await;
    }
    match (args.world, args.worlds) {
        (Some(seed), _) => worlds::explain(&args, &client, seed).await,
        (None, Some(count)) => worlds::run(&args, &client, count).await,
        (None, None) => sequences::run(&args, &client).await,
    }
}
