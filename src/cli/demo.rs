//! `revisit demo`: the paper's experiment on one sequence, printed as it runs.

use std::fs;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;

use super::failure::Failure;
use super::hotel_server::hotel_server_in;
use super::output::write_out;
use super::replay::OwnServer;
use super::serve::LOCAL;
use super::signals::stop_on_signal;
use crate::api::loops::LoopBody;
use crate::api::release::ReleaseBody;
use crate::client::{Client, ClientError};
use crate::config::listen;
use crate::domain::verdict::Decision;
use crate::hotel::building::texture::Patterns;
use crate::hotel::method::Method;
use crate::hotel::rng::SeededRng;
use crate::hotel::robot::client::Robot;
use crate::hotel::route::tour;
use crate::hotel::run::{self, AnsweredQuery, RunResult, drive};
use crate::hotel::scenario::Scenario;
use crate::hotel::scoring::explain::keyframe_id;
use crate::hotel::scoring::paper::FIGURE_6;
use crate::hotel::scoring::results::SequenceResult;
use crate::hotel::scoring::tables;
use crate::hotel::sensing::noise::NoiseKind;
use crate::hotel::sequence::Sequence;

/// The map that is kept for inspection.
const MAP: &str = "hotel";
/// The arms that run after ours, with their descriptions.
const OTHERS: [(Method, &str); 2] = [
    (Method::Paper, "the paper's exact method, its loops confirmed as in ORB-SLAM3"),
    (Method::BagOfWords, "bag of words and Sim3 without signs, loops confirmed the same way"),
];
/// Consecutive rejections per printed line; one line each would be hundreds.
const REJECTIONS_EVERY: usize = 25;
/// Consecutive loops per printed line.
const LOOPS_EVERY: usize = 6;
/// Keyframes of the second robot, its drift in metres, and its loops that are confirmed.
const SECOND_KEYFRAMES: usize = 120;
const SECOND_DRIFT_M: f64 = 0.3;
const SECOND_CONFIRMED: usize = 4;
/// The release of the map.
const RELEASE: &str = "monday";
/// Time without a line after which progress is printed.
const SILENCE_MAX: Duration = Duration::from_secs(3);
/// The instructions for the user's own data; `tests/it/readme.rs` runs its curls.
const YOUR_OWN_DATA: &str = include_str!("your_own_data.txt");

/// Watch a robot in a hotel whose rooms all look alike.
///
/// Starts a server on a temporary database and drives the robot of the paper's sequence SE2 00 three times. The runs
/// use our method, the paper's exact method, and bag of words with Sim3 alone; their answers are printed. Afterwards
/// it prints how to send your own data, and the server stays up until Ctrl-C.
#[derive(Args, Debug)]
pub struct DemoArgs {
    /// Exit when the drive is over
    #[arg(long)]
    exit: bool,
    /// Address of this machine to listen on; by default a free port
    #[arg(long, value_name = "ADDR", value_parser = listen::address)]
    listen: Option<SocketAddr>,
    /// A new folder that keeps the data
    #[arg(long, value_name = "FOLDER")]
    keep: Option<PathBuf>,
}

/// Runs `demo`.
pub async fn run(args: DemoArgs) -> Result<(), Failure> {
    write_out("Starting a server on a new database, and building a hotel ...\n")?;
    let server = server(&args).await?;
    write_out("Recording what the robot's camera sees on its way through the hotel ...\n\n")?;
    let client = Client::new(server.url())?;
    let (scenario, second) = tokio::task::spawn_blocking(move || {
        let scenario = Scenario::of_paper(&FIGURE_6, &Patterns::new());
        let second = second_tour(&scenario);
        (scenario, second)
    })
    .await?;
    let rooms: Vec<&str> =
        scenario.tours[0].iter().map(|room| scenario.floors[0].numbers[*room].as_str()).collect();
    write_out(&format!(
        "A hotel of 24 rooms that are furnished alike, around a corridor of 100 m. A robot drives to rooms {}\n\
         ({} keyframes) and queries at each: is this a loop? Viewer: {}/\n\n",
        rooms.join(", "),
        scenario.course.order.len(),
        server.url()
    ))?;
    let progress = Progress::new(scenario.course.order.len());
    let mut teller = Teller { scenario: &scenario, progress, rejections: 0, loops: 0 };
    let ours = drive(&client, MAP, Method::Ours, &scenario.course, |asked| teller.hear(asked)).await?;
    let met = second_robot(&client, &second).await?;
    write_out(&met)?;
    let mut drives = vec![ours];
    for (arm, method) in OTHERS {
        write_out(&format!("\nThe same tour again, with {method} ...\n"))?;
        let map = format!("{MAP}-{}", arm.as_str());
        let mut progress = Progress::new(scenario.course.order.len());
        let driven =
            drive(&client, &map, arm, &scenario.course, |asked| progress.count(asked, false)).await?;
        drives.push(driven);
    }
    let odometry = run::odometry(&scenario.course);
    let results = [SequenceResult::of(FIGURE_6, &scenario.course, &odometry, &drives)];
    let (table_2, caveats) = (tables::table_2(&results), tables::caveats(&results));
    write_out(&format!("\n{table_2}\n{caveats}\n{}\n", tables::table_3(&results)))?;
    if args.exit {
        return Ok(write_out(YOUR_OWN_DATA)?);
    }
    write_out(&next_steps(server.url(), &drives[0]))?;
    write_out(YOUR_OWN_DATA)?;
    write_out(&match &args.keep {
        None => String::from("Ctrl-C stops this server and deletes its database.\n"),
        Some(folder) => format!("Ctrl-C stops this server. Its data stays:\n{}\n", serve_again(folder)),
    })?;
    stop_on_signal()?.cancelled().await;
    Ok(())
}

/// Records the tour of a second robot, along the first one's way.
fn second_tour(scenario: &Scenario) -> Sequence {
    let rooms = &scenario.tours[0];
    let mut rng = SeededRng::new(2, "second robot");
    let mut stops = tour(&scenario.floors[0].plan, &rooms[..rooms.len().min(2)], &mut rng);
    stops.truncate(SECOND_KEYFRAMES);
    Sequence::record(&scenario.floors[0], &stops, NoiseKind::None.noise(), SECOND_DRIFT_M, 2)
}

/// Drives a second robot, which knows nothing of the first one, and confirms some of its loops with it: the two share a frame from
/// then on. Publishes the map. Returns what happened.
async fn second_robot(client: &Client, tour: &Sequence) -> Result<String, Failure> {
    let mut robot = Robot::new(client, MAP, Method::Ours, run::session(1));
    let (mut loops, mut confirmed) = (0, 0);
    for step in &tour.steps {
        let answer = robot.ask(step).await?;
        let (Some(keyframe), Some(place)) = (&answer.keyframe, answer.best_transform()) else { continue };
        if !place.0.starts_with(&format!("{}-", run::session(0))) {
            continue;
        }
        if loops % LOOPS_EVERY == 0 && confirmed < SECOND_CONFIRMED {
            let id = format!("met-{confirmed}");
            let body =
                LoopBody::found(&id, keyframe, place.0, answer.id.clone()).map_err(ClientError::from)?;
            client.post_loop(MAP, &body).await?;
            confirmed += 1;
        }
        loops += 1;
    }
    robot.finish().await?;
    client.publish_release(MAP, RELEASE, &ReleaseBody::default()).await?;
    Ok(format!(
        "\nA second robot wakes in one of the rooms and drives {} keyframes: {loops} are loops with the first one's, {confirmed} of them \
         confirmed. The map is published as the release `{RELEASE}`.\n",
        tour.steps.len()
    ))
}

/// Starts the server of the demo.
async fn server(args: &DemoArgs) -> Result<OwnServer, Failure> {
    let listen = args.listen.unwrap_or(LOCAL);
    if !listen.ip().is_loopback() {
        return Err(format!(
            "other machines can reach {listen}, and the demo has no keys: give 127.0.0.1:{}",
            listen.port()
        )
        .into());
    }
    let Some(folder) = &args.keep else {
        let directory = tempfile::tempdir()?;
        return Ok(hotel_server_in(directory.path(), listen).await?.with(directory));
    };
    fs::create_dir(folder)
        .map_err(|error| format!("--keep takes a new folder: {}: {error}", folder.display()))?;
    hotel_server_in(folder, listen).await
}

/// Returns the command that serves what was kept.
fn serve_again(folder: &Path) -> String {
    let folder = folder.display();
    format!("revisit serve --database sqlite://{folder}/revisit.db --vocabulary {folder}/hotel.voc")
}

/// Prints the progress of a run after each silence.
struct Progress {
    keyframes: usize,
    asked: usize,
    loops: usize,
    last_line: Instant,
}

impl Progress {
    fn new(keyframes: usize) -> Self {
        Self { keyframes, asked: 0, loops: 0, last_line: Instant::now() }
    }

    /// Counts one answer; `is_told` is whether a line was printed for it.
    fn count(&mut self, asked: &AnsweredQuery, is_told: bool) {
        self.asked += 1;
        self.loops += usize::from(asked.answer.verdict.0 == Decision::Loop);
        let was_silent = !is_told && self.last_line.elapsed() >= SILENCE_MAX;
        if was_silent {
            let Self { keyframes, asked, loops, .. } = self;
            // A closed standard output does not end the run: the tables follow.
            let _ = write_out(&format!("  {asked} of {keyframes} keyframes, {loops} answered with a loop\n"));
        }
        if is_told || was_silent {
            self.last_line = Instant::now();
        }
    }
}

/// Prints a selection of the answers.
struct Teller<'a> {
    scenario: &'a Scenario,
    progress: Progress,
    rejections: usize,
    loops: usize,
}

impl Teller<'_> {
    fn hear(&mut self, asked: &AnsweredQuery) {
        let contradicts = asked.answer.leading().and_then(|candidate| candidate.anchors.as_ref());
        let contradicts = contradicts.is_some_and(|anchors| !anchors.contradictions.is_empty());
        let is_told = match asked.answer.verdict.0 {
            Decision::Loop => {
                self.loops += 1;
                self.loops % LOOPS_EVERY == 1
            }
            Decision::NoLoop if contradicts => {
                self.rejections += 1;
                self.rejections % REJECTIONS_EVERY == 1
            }
            _ => false,
        };
        if is_told {
            // As in `Progress`.
            let _ = write_out(&format!("{}\n", self.scenario.said(asked)));
        }
        self.progress.count(asked, is_told);
    }
}

fn next_steps(url: &str, ours: &RunResult) -> String {
    let found = ours.asked.iter().rev().find(|asked| asked.answer.verdict.0 == Decision::Loop);
    let keyframe = found.map_or_else(|| String::from("kf-0"), |asked| keyframe_id(asked.keyframe));
    let query = found.map_or("q", |asked| asked.answer.id.as_str());
    format!(
        "The server stays up. Open {url}/ in a browser, or query it:\n\n\
         curl -s {url}/v1/maps/{MAP}\n\
         curl -s '{url}/v1/maps/{MAP}/anchors?class=door_number&limit=3'\n\
         curl -s {url}/v1/maps/{MAP}/keyframes/{keyframe}/local-anchor-map\n\
         curl -s {url}/v1/maps/{MAP}/loop-queries/{query}\n\n"
    )
}
