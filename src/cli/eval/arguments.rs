//! The arguments of `revisit eval`.

use std::path::PathBuf;

use clap::{ArgGroup, Args, Subcommand, ValueEnum};

use crate::hotel::method::Method;
use crate::hotel::scoring::paper::{PrintedSequence, SEQUENCES};
use crate::hotel::sensing::noise::NoiseKind;

/// Run an experiment.
#[derive(Args, Debug)]
pub struct EvalArgs {
    #[command(subcommand)]
    pub(super) experiment: Experiment,
}

#[derive(Debug, Subcommand)]
pub(super) enum Experiment {
    Hotel(HotelArgs),
}

/// Drive a robot through simulated hotels, and score the loops it is told.
///
/// A robot with a camera, odometry and a pose graph of its own drives through rooms that are furnished alike. At each
/// keyframe it asks a server, over HTTP, whether it is a loop, and closes loops in the way of its arm. The truth comes from the
/// simulator and never reaches the server. The server has a database of its own that is thrown away.
///
/// Without options: the paper's twelve sequences. Tables II and III beside the printed figures, Figure 6, and a
/// precision-recall curve. With --worlds: random hotels.
///
/// ARMS. "Ours": the defaults; the robot closes what it is told. "Paper's letter": the same server with every switch of ours
/// off, in a robot that closes loops as ORB-SLAM3 does, into which the paper's method is built: 50 and 80 of the map points
/// around the candidate must be seen where the transformation has them, and three keyframes must agree. "BoW + Sim3": the
/// same robot without anchors; the best three candidates of bag of words. "Words alone": the likest keyframe, at thresholds
/// that are chosen with the truth in hand. --worlds drives the first two, renumbered the first.
/// "Ours monocular", with --noise none and in hotel v2: the defaults on a map that is not metric, for a robot with one camera and no
/// depth. Its unit of length is its own and drifts, its map points are triangulated, and its loops have a scale.
///
/// WORLDS. The twelve sequences and the seeds from 0 on are for development: the method was tuned on the first of them.
/// Seeds from 1,000,000 on (--held-out) are for reporting, and nothing is tuned on them. The seed draws the floor plan, the
/// furniture, the rooms' numbers, the paintings, the tour and the drift of odometry.
///
/// SCORES. By query: each keyframe's answer; right within 1 m and 30 degrees of the keyframe that it names, neither right
/// nor wrong if it is no such pair and the two see 25 of the same points. Keyframes of one robot that share 15 tracked points
/// are no loop. By visit, the paper's unit: a stay in a room has one answer, the loop with the most inliers that any of its
/// keyframes got, of those that the robot took; it is recalled if any was right.
///
/// NOISE. reader: 15 % of the readings have a wrong character or lack one, and 4 % of the plates are read as another number
/// all through a visit. missed: 35 % of the detections are missed, one door in ten has no plate. repeated: the same exit
/// sign, floor number and painting hang at every door. wording: one thing is described in other words each time. fleet: two
/// robots, each with a frame of its own, in one map. mixed: all of it but the second robot; readings and detections fail
/// about half as often. "Pooled" leaves mixed out.
///
/// HOTEL V2. With --worlds or --world, --hotel v2 draws three floors that are alike, with the same six prints on the walls of
/// each; a robot drives on each floor and a fourth on the lowest, through half of the first one's rooms, all at the same
/// time in one map. Plates and exit signs are read by an OCR that misses, cuts and misreads as the one of the recording floors
/// did, tells no plate from other text, and reads text where there is none. It takes no --noise.
#[derive(Args, Clone, Debug)]
#[command(group(ArgGroup::new("random").args(["worlds", "world"]).multiple(true)))]
pub(super) struct HotelArgs {
    /// Only these of the paper's sequences, as SE1-00 or SE2-05, with commas between them
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with_all = ["worlds", "world", "record"], value_parser = sequence)]
    pub(super) sequences: Vec<PrintedSequence>,
    /// Number of random worlds under each kind of noise, instead of the paper's sequences; at most 1,000
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000))]
    pub(super) worlds: Option<u64>,
    /// With --worlds: those that are kept for reporting, seeds from 1,000,000 on; nothing is tuned on them
    #[arg(long, requires = "worlds")]
    pub(super) held_out: bool,
    /// none, reader, missed, repeated, wording, fleet, mixed, renumbered (eight rounds, between which door numbers change);
    /// all, which is the default, is reader to mixed, a row each
    #[arg(long, value_name = "LEVEL", value_parser = noise_kinds)]
    pub(super) noise: Option<NoiseKinds>,
    /// The generator of random worlds, with --worlds or --world; v1 if not given
    #[arg(long, value_enum, value_name = "GENERATOR", conflicts_with = "sequences", requires = "random")]
    pub(super) hotel: Option<Generator>,
    /// This one random world, with what was answered at each keyframe that was wrong or missed
    #[arg(long, value_name = "SEED", conflicts_with = "worlds", value_parser = clap::value_parser!(u64).range(..1_000))]
    pub(super) world: Option<u64>,
    /// With --world: the arm that is explained: ours, monocular or paper
    #[arg(long, value_name = "ARM", requires = "world", default_value = "ours", value_parser = arm)]
    pub(super) arm: Method,
    /// Write a tour as a recording for `revisit replay` instead of driving it: that of --world, or of SE2 00 (.ndjson, .gz
    /// or .zst)
    #[arg(long, value_name = "FILE", conflicts_with = "worlds")]
    pub(super) record: Option<PathBuf>,
    /// Folder for figures, trajectories and results.json, and for each world as it is driven (worlds.ndjson)
    #[arg(long, value_name = "FOLDER", default_value = "hotel-results")]
    pub(super) output: PathBuf,
    /// With --worlds: take up the run whose --output this was, with the same build; worlds that were driven are not driven
    /// again
    #[arg(long, value_name = "FOLDER", requires = "worlds", conflicts_with = "output")]
    pub(super) resume: Option<PathBuf>,
    /// Number of sequences or worlds to run in parallel
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u16).range(1..=64))]
    pub(super) jobs: u16,
}

fn sequence(name: &str) -> Result<PrintedSequence, String> {
    let wanted = name.to_uppercase().replace('-', " ");
    let found = SEQUENCES.into_iter().find(|sequence| sequence.name() == wanted);
    found.ok_or_else(|| String::from("SE1-00 to SE1-05 and SE2-00 to SE2-05"))
}

fn arm(name: &str) -> Result<Method, String> {
    let found = Method::OF_WORLDS.into_iter().find(|arm| arm.name() == name);
    found.ok_or_else(|| format!("one of {}", Method::OF_WORLDS.map(Method::name).join(", ")))
}

/// The generator that draws the worlds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Generator {
    /// One floor, a reader that is perfect but for --noise
    V1,
    /// Three floors that are alike, and a reader with the limits of a real one
    V2,
}

impl HotelArgs {
    /// Returns the kinds of trouble that are driven.
    pub(super) fn kinds(&self) -> Vec<NoiseKind> {
        match (self.hotel, &self.noise) {
            (Some(Generator::V2), _) => vec![NoiseKind::SecondHotel],
            (_, Some(kinds)) => kinds.0.clone(),
            (_, None) => NoiseKind::TROUBLES.to_vec(),
        }
    }
}

/// The kinds of noise that `--noise` names.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NoiseKinds(Vec<NoiseKind>);

fn noise_kinds(name: &str) -> Result<NoiseKinds, String> {
    if name == "all" {
        return Ok(NoiseKinds(NoiseKind::TROUBLES.to_vec()));
    }
    let has_noise = |kind: &NoiseKind| *kind != NoiseKind::SecondHotel;
    let names: Vec<&str> = NoiseKind::ALL.into_iter().filter(has_noise).map(NoiseKind::name).collect();
    let kind = NoiseKind::of_name(name).filter(has_noise);
    Ok(NoiseKinds(vec![kind.ok_or_else(|| format!("one of {}, all", names.join(", ")))?]))
}
