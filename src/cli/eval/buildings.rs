//! `revisit eval buildings`: small buildings of many kinds, half of them for reporting only.

use std::path::PathBuf;

use clap::Args;
use futures_util::{StreamExt as _, TryStreamExt as _};

use super::files;
use crate::buildings::kind::Kind;
use crate::buildings::play::{Played, play, recording};
use crate::buildings::tables;
use crate::cli::failure::Failure;
use crate::cli::output::write_out;
use crate::cli::serve::own_server;
use crate::client::Client;
use crate::hotel::method::Method;
use crate::hotel::seeds::{BLOCK_MAX, BLOCK_WORLDS, WorldSet};

/// Drive robots through small simulated buildings of many kinds, and score the loops that the server reports.
///
/// Each kind has one property that deceives place recognition. Half of the kinds are for tuning (wings, notices, windows,
/// copied_wings, pictures, misread, lift, bare); --held-out plays the other half (floor_letters, brands, directories,
/// mirrored_wings, railings, cloned_starts, stretched, photographs), which are for reporting, never for tuning. The robots
/// close every loop that they are told.
///
/// SCORES. An answer is right if the named keyframe is of another visit, within 2.5 m and 45 degrees. It is near, and neither
/// right nor wrong, if the two see one physical sign from at most 10 m apart on one floor and wing. Otherwise it is wrong. A visit
/// is a piece of corridor of 7 m, or a room; its first answer counts. After the drives, POST /v1/locate is asked on two
/// more: where robots have been, and where none has.
#[derive(Args, Clone, Debug)]
pub(super) struct BuildingsArgs {
    /// Number of worlds of each kind
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u64).range(1..=BLOCK_WORLDS))]
    worlds: u64,
    /// Play the kinds for reporting, with the seeds of this block (0 if none is named)
    #[arg(long, value_name = "BLOCK", num_args = 0..=1, default_missing_value = "0", value_parser = clap::value_parser!(u64).range(..=BLOCK_MAX))]
    held_out: Option<u64>,
    /// Play these kinds alone, comma-separated
    #[arg(long, value_name = "KINDS", value_delimiter = ',', value_parser = kind, conflicts_with = "held_out")]
    kinds: Vec<Kind>,
    /// The arm: ours or paper
    #[arg(long, value_name = "ARM", default_value = "ours", value_parser = arm)]
    arm: Method,
    /// Write the worlds as recordings for `revisit replay` into this folder, and play none
    #[arg(long, value_name = "FOLDER")]
    record: Option<PathBuf>,
    /// Write each query and answer into this file, as JSON
    #[arg(long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Number of worlds to play in parallel
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u16).range(1..=64))]
    jobs: u16,
}

fn kind(name: &str) -> Result<Kind, String> {
    let found = Kind::from_name(name).filter(|kind| !kind.is_held_out());
    found.ok_or_else(|| format!("one of {}", Kind::NAMES[..Kind::TUNING.len()].join(", ")))
}

fn arm(name: &str) -> Result<Method, String> {
    let found = Method::from_name(name).filter(|arm| [Method::Ours, Method::Paper].contains(arm));
    found.ok_or_else(|| "ours or paper".to_owned())
}

/// Plays or records the worlds.
pub(super) async fn run(args: &BuildingsArgs) -> Result<(), Failure> {
    let kinds: Vec<Kind> = match args.held_out {
        Some(_) => Kind::HELD_OUT.to_vec(),
        None if args.kinds.is_empty() => Kind::TUNING.to_vec(),
        None => args.kinds.clone(),
    };
    let set = WorldSet::of_block(args.held_out);
    let worlds =
        kinds.iter().flat_map(|kind| set.seeds().take(args.worlds as usize).map(|seed| (*kind, seed)));
    let worlds: Vec<(Kind, u64)> = worlds.collect();
    if let Some(folder) = &args.record {
        std::fs::create_dir_all(folder)?;
        for (kind, seed) in worlds {
            let file = folder.join(format!("{}-{seed}.ndjson", kind.as_str()));
            files::write_recording(&file, recording(kind, seed, args.arm))?;
        }
        return Ok(());
    }
    let server = own_server().await?;
    let client = &Client::new(server.url())?;
    let played: Vec<Played> = futures_util::stream::iter(worlds)
        .map(async |(kind, seed)| play(client, kind, seed, args.arm).await)
        .buffered(usize::from(args.jobs))
        .try_collect()
        .await?;
    if let Some(file) = &args.output {
        std::fs::write(file, serde_json::to_vec(&played)?)?;
    }
    let what = args
        .held_out
        .map_or_else(|| "for tuning".to_owned(), |block| format!("for reporting, block {block}"));
    let mut text = format!(
        "{} worlds of each kind {what}, {}\n\n{}\n",
        args.worlds,
        args.arm.words(),
        tables::loops(&kinds, &played)
    );
    // What the kinds for reporting are deceived by is not for whoever tunes the method.
    if args.held_out.is_none() {
        text.push_str(&tables::causes(&played));
        text.push('\n');
    }
    Ok(write_out(&format!("{text}{}", tables::reliability(&played)))?)
}
