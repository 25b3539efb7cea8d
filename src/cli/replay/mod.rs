//! Replay: sends a recording to a server, and scores the loops that it reports (`docs/recordings.md`).
//!
//! | file | concept |
//! |---|---|
//! | `recording` | parses a file into operations, line by line |
//! | `overrides` | settings of the recording's maps, changed for this replay |
//! | `play` | turns operations into requests and keeps the answers |
//! | `answered` | one query: ground truth, answer and reasons |
//! | `frames` | errors of the transformations |
//! | `score` | precision and recall, of the service and of BoW alone |
//! | `latency` | percentiles |
//! | `report` | all results, as the JSON object |
//! | `table` | the report for a person to read |

mod answered;
mod arguments;
mod frames;
mod latency;
mod overrides;
mod own_server;
mod play;
mod recording;
mod report;
pub(in crate::cli) mod score;
mod table;
#[cfg(test)]
mod tests;

use crate::cli::failure::Failure;
use crate::cli::output::{progress_bar, write_out};
use crate::client::Client;
use frames::Frames;
use play::Player;
use recording::Recording;
use report::Report;

pub use arguments::ReplayArgs;
pub use overrides::Overrides;
pub use own_server::OwnServer;
pub use recording::{LineError, count_operations};

/// Runs `revisit replay`; `own_server` starts a server on a temporary database, if one is needed.
pub async fn run<S>(args: ReplayArgs, own_server: S) -> Result<(), Failure>
where
    S: AsyncFnOnce() -> Result<OwnServer, Failure>,
{
    let report = replay(&args, own_server).await?;
    let text = if args.json { format!("{}\n", report.to_json()) } else { report.to_string() };
    write_out(&text).map_err(|error| format!("cannot write the score: {error}"))?;
    match report.failed {
        0 => Ok(()),
        failed => {
            let lines = "of the recording's lines were rejected: the score covers only the others";
            Err(format!("{failed} {lines}").into())
        }
    }
}

async fn replay<S>(args: &ReplayArgs, own_server: S) -> Result<Report, Failure>
where
    S: AsyncFnOnce() -> Result<OwnServer, Failure>,
{
    // Counts the bytes of the file.
    let progress = progress_bar("");
    let recording = Recording::open(&args.file, &progress)
        .map_err(|error| format!("cannot read {}: {error}", args.file.display()))?;
    let frames = args.frames.as_deref().map(Frames::read).transpose()?;
    // Kept to the end, because dropping it stops the server.
    let own_server = match &args.server {
        Some(_) => None,
        None => Some(
            (own_server().await)
                .map_err(|error| format!("cannot start a server to replay against: {error}"))?,
        ),
    };
    let client = connect(args, own_server.as_ref())?;
    let player = Player::new(client, args, progress.clone(), frames.unwrap_or_default());
    let played = player.play(recording).await;
    progress.finish_and_clear();
    Ok(Report::new(args, played?))
}

fn connect(args: &ReplayArgs, own_server: Option<&OwnServer>) -> Result<Client, Failure> {
    Ok(match own_server {
        Some(own_server) => Client::new(own_server.url())?,
        None => Client::new(args.server.as_deref().unwrap_or_default())?.with_key(args.key.clone()),
    })
}
