//! Random worlds under noise, one table row for each kind; or one world, explained.

use futures_util::{StreamExt as _, TryStreamExt as _};

use super::arguments::HotelArgs;
use super::driven_worlds::DrivenWorlds;
use super::files;
use super::progress::Progress;
use crate::cli::failure::Failure;
use crate::cli::output::write_out;
use crate::client::{AnchorSearch, Client, Page};
use crate::hotel::building::renumbering::{Signs, by_round};
use crate::hotel::building::texture::Patterns;
use crate::hotel::method::Method;
use crate::hotel::run::drive;
use crate::hotel::scenario::Scenario;
use crate::hotel::scoring::fleet::{self, FleetResult};
use crate::hotel::scoring::results::{ArmResult, WorldResult};
use crate::hotel::scoring::score::Outcome;
use crate::hotel::scoring::tables::{self, pooled_worlds};
use crate::hotel::sensing::noise::NoiseKind;

/// Runs the worlds under each kind of noise, and prints and writes the results.
pub(super) async fn run(args: &HotelArgs, client: &Client, count: u64) -> Result<(), Failure> {
    let kinds = &args.kinds();
    let set = args.world_set()?;
    let of =
        |kind: &NoiseKind| set.seeds().take(count as usize).map(|seed| (*kind, seed)).collect::<Vec<_>>();
    let worlds: Vec<(NoiseKind, u64)> = kinds.iter().flat_map(of).collect();
    let folder = args.resume.as_deref().unwrap_or(&args.output);
    let driven = DrivenWorlds::open(folder, args.resume.is_some())?;
    let left = driven.left(&worlds);
    let progress = Progress::new(left.iter().map(|(kind, _)| arms_of(*kind).len()).sum());
    let now: Vec<WorldResult> = futures_util::stream::iter(left)
        .map(async |(kind, seed)| {
            let result = drive_world(client, kind, seed, &progress).await?;
            driven.keep(&result)?;
            Ok::<_, Failure>(result)
        })
        .buffered(usize::from(args.jobs))
        .try_collect()
        .await?;
    progress.finish();
    let results = driven.all(now, &worlds);
    files::write_worlds(folder, args.held_out, &results)?;
    let table = tables::noise_table(&results, &Method::OF_WORLDS);
    let monocular = tables::monocular(&results);
    let failures = tables::failures(&results, args.held_out.is_some());
    let losses = tables::losses(pooled_worlds(&results).map(|result| result.arms.as_slice()));
    let rounds = tables::rounds(&results);
    let fleets = fleet::table(results.iter().filter_map(|result| result.fleet.as_ref()));
    Ok(write_out(&format!(
        "{count} {set} for each kind of noise\n\n{table}{monocular}\n{failures}\n{losses}{rounds}{fleets}"
    ))?)
}

/// Returns the arms that run under a kind of noise: the paper does not cover changed numbers, and eight rounds take
/// long.
fn arms_of(kind: NoiseKind) -> &'static [Method] {
    match kind {
        NoiseKind::Renumbered => &[Method::Ours],
        NoiseKind::None | NoiseKind::SecondHotel => &Method::OF_WORLDS,
        _ => &[Method::Ours, Method::Paper],
    }
}

async fn drive_world(
    client: &Client,
    kind: NoiseKind,
    seed: u64,
    progress: &Progress,
) -> Result<WorldResult, Failure> {
    let scenario = world(kind, seed).await?;
    let (mut arms, mut fleet, mut rounds, mut signs) = (Vec::new(), None, Vec::new(), None);
    for arm in arms_of(kind).iter().copied() {
        let name = format!("world {seed}, {}, {}", kind.words(), arm.words());
        let mut shown = progress.drive(name, scenario.course.order.len());
        let map = format!("{}-{seed}-{}", kind.as_str(), arm.as_str());
        let driven = drive(client, &map, arm, &scenario.course, |_| shown.keyframe()).await?;
        shown.end();
        arms.push(ArmResult::of(&driven));
        if arm == Method::Ours && scenario.course.journeys.len() > 1 {
            fleet = Some(FleetResult::of(&client.frames(&map, None).await?, &scenario.course, &driven));
        }
        if arm == Method::Ours && kind == NoiseKind::Renumbered {
            rounds = by_round(&driven, &scenario.course.journeys[0], &scenario.floors[0], &scenario.eras);
            signs = Some(count_signs(client, &map, &scenario).await?);
        }
        client.delete_map(&map).await?;
    }
    Ok(WorldResult { noise: kind, seed, keyframes: scenario.course.order.len(), arms, fleet, rounds, signs })
}

/// Counts the final states of the signs of a map.
async fn count_signs(client: &Client, map: &str, scenario: &Scenario) -> Result<Signs, Failure> {
    let mut anchors = Vec::new();
    let mut search =
        AnchorSearch { page: Page { limit: Some(1000), cursor: None }, ..AnchorSearch::default() };
    loop {
        let part = client.list_anchors(map, &search).await?;
        anchors.extend(part.items);
        search.page.cursor = part.next_cursor;
        if search.page.cursor.is_none() {
            break;
        }
    }
    let told = anchors.iter().map(|anchor| {
        let description = anchor.description.as_deref().unwrap_or_default();
        (anchor.state.0.as_str(), anchor.class.as_str(), description)
    });
    Ok(Signs::count(told, &scenario.floors[0], &scenario.eras))
}

/// Explains one world: prints an arm's answers wherever it was wrong or missed a loop.
pub(super) async fn explain(args: &HotelArgs, client: &Client, seed: u64) -> Result<(), Failure> {
    for kind in &args.kinds() {
        let scenario = world(*kind, seed).await?;
        let tours = scenario.tours.iter().enumerate();
        let rooms: Vec<String> = tours.map(|(robot, tour)| tour_text(&scenario, robot, tour)).collect();
        write_out(&format!("world {seed} under {}: rooms {}\n", kind.words(), rooms.join("; and ")))?;
        let map = format!("{}-{seed}", kind.as_str());
        let mut lines = Vec::new();
        let driven = drive(client, &map, args.arm, &scenario.course, |asked| {
            if matches!(asked.scored.outcome, Outcome::Wrong | Outcome::Missed) {
                lines.push(scenario.judged(asked));
            }
        })
        .await?;
        client.delete_map(&map).await?;
        let result = ArmResult::of(&driven);
        let text = format!(
            "{}\n{} of {} answers right, {} of {} true loops found\n\n",
            lines.join("\n"),
            result.by_query.precision.part,
            result.by_query.precision.whole,
            result.by_query.recall.part,
            result.by_query.recall.whole
        );
        write_out(&text)?;
    }
    Ok(())
}

async fn world(kind: NoiseKind, seed: u64) -> Result<Scenario, Failure> {
    let random = move || Scenario::random(seed, kind, &Patterns::new());
    Ok(tokio::task::spawn_blocking(random).await?)
}

fn tour_text(scenario: &Scenario, robot: usize, tour: &[usize]) -> String {
    let floor = scenario.floor_of(robot);
    let numbers: Vec<&str> = tour.iter().map(|room| floor.numbers[*room].as_str()).collect();
    numbers.join(", ")
}
