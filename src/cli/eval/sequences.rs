//! The paper's twelve sequences, with every arm: Tables II and III.

use futures_util::{StreamExt as _, TryStreamExt as _};

use super::arguments::HotelArgs;
use super::files::{self, Driven12};
use super::progress::Progress;
use super::words_alone::words_alone;
use crate::cli::failure::Failure;
use crate::cli::output::write_out;
use crate::client::Client;
use crate::hotel::building::texture::Patterns;
use crate::hotel::method::Method;
use crate::hotel::run::{self, drive};
use crate::hotel::scenario::Scenario;
use crate::hotel::scoring::paper::{PrintedSequence, SEQUENCES};
use crate::hotel::scoring::results::SequenceResult;
use crate::hotel::scoring::tables;

/// Runs the selected sequences, by default all twelve, prints the tables and writes the files.
pub(super) async fn run(args: &HotelArgs, client: &Client) -> Result<(), Failure> {
    let asked = if args.sequences.is_empty() { SEQUENCES.to_vec() } else { args.sequences.clone() };
    let progress = Progress::new(asked.len() * Method::OF_SEQUENCES.len());
    let drives: Vec<Driven12> = futures_util::stream::iter(asked)
        .map(|printed| drive_sequence(client, printed, &progress))
        .buffered(usize::from(args.jobs))
        .try_collect()
        .await?;
    progress.finish();
    let results: Vec<SequenceResult> = drives.iter().map(|driven| driven.result.clone()).collect();
    files::write_sequences(&args.output, &drives)?;
    let text = format!(
        "{}\n{}\n{}\n{}\n{}\n{}\nwritten to {}: figure6.svg, precision-recall.svg, trajectories/*.tum, results.json\n",
        tables::table_2(&results),
        tables::caveats(&results),
        words_alone(&drives),
        tables::confusion(&results),
        tables::table_3(&results),
        tables::losses(results.iter().map(|result| result.arms.as_slice())),
        args.output.display()
    );
    Ok(write_out(&text)?)
}

async fn drive_sequence(
    client: &Client,
    printed: PrintedSequence,
    progress: &Progress,
) -> Result<Driven12, Failure> {
    let scenario =
        tokio::task::spawn_blocking(move || Scenario::of_paper(&printed, &Patterns::new())).await?;
    let odometry = run::odometry(&scenario.course);
    let mut arms = Vec::new();
    for arm in Method::OF_SEQUENCES {
        let mut shown =
            progress.drive(format!("{}, {}", printed.name(), arm.words()), scenario.course.order.len());
        let map = format!("{}-{}", printed.name().replace(' ', "-"), arm.as_str());
        arms.push(drive(client, &map, arm, &scenario.course, |_| shown.keyframe()).await?);
        client.delete_map(&map).await?;
        shown.end();
    }
    let result = SequenceResult::of(printed, &scenario.course, &odometry, &arms);
    Ok(Driven12 { result, scenario, arms, odometry })
}
