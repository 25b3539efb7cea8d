//! The arguments of `revisit eval`.

use std::path::PathBuf;

use super::buildings::BuildingsArgs;
use clap::{ArgGroup, Args, Subcommand, ValueEnum};

use crate::cli::failure::Failure;
use crate::domain::location::ASKED_KEYFRAMES_MAX;
use crate::hotel::method::Method;
use crate::hotel::restart::world::KEYFRAMES_OF_A_RESTART;
use crate::hotel::scoring::paper::{PrintedSequence, SEQUENCES};
use crate::hotel::seeds::{BLOCK_MAX, BLOCK_WORLDS, WorldSet};
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
    Buildings(BuildingsArgs),
}

/// Drive a robot through simulated hotels, and score the loops that the server reports.
///
/// A robot with a camera, odometry and its own pose graph drives through rooms that are furnished alike. At each
/// keyframe it queries a server over HTTP for loops, and closes loops by the rule of its arm. The ground truth comes
/// from the simulator and never reaches the server. The server runs on its own temporary database.
///
/// Without options: the paper's twelve sequences. Prints Tables II and III beside the published figures, Figure 6, and
/// a precision-recall curve. With --worlds: random hotels.
///
/// ARMS. "Ours": the defaults; the robot closes every reported loop. "Paper's letter": the same server with all of our
/// extensions off, in a robot that closes loops as ORB-SLAM3 does, on which the paper's method is built. Of the map
/// points around the candidate, 50 and 80 must be seen where the transformation has them, and three keyframes must
/// agree. "BoW + Sim3": the same robot without anchors; the best three bag-of-words candidates. "Words alone": the
/// most similar keyframe, at thresholds chosen by the ground truth. --worlds runs the first two, renumbered the first.
/// "Ours monocular", with --noise none and in hotel v2: the defaults on a map that is not metric, for a robot with one
/// camera and no depth. Its unit of length is arbitrary and drifts, its map points are triangulated, and its loops
/// have a scale.
///
/// WORLDS. The twelve sequences and the seeds from 0 on are for development: the method was tuned on the first of
/// them. Seeds from 1,000,000 on (--held-out) are for reporting, never for tuning, in blocks of 100: block B begins at
/// 1,000,000 + 100 B. The seed determines the floor plan, the furniture, the room numbers, the paintings, the tour and the drift of odometry.
///
/// SCORES. By query: the answer of each keyframe. It is correct within 1 m and 30 degrees of the named keyframe.
/// Otherwise it is neither correct nor wrong if the two keyframes see 25 of the same points. Keyframes of one robot
/// that share 15 tracked points are not a loop. By visit, the paper's unit: a stay in a room has one answer, the loop
/// with the most inliers that the robot accepted at any of its keyframes. A visit is recalled if any of its loops was
/// correct.
///
/// NOISE. reader: 15 % of the readings have a wrong or missing character, and 4 % of the plates are read as another
/// number throughout a visit. missed: 35 % of the detections are missed, one door in ten has no plate. repeated: the
/// same exit sign, floor number and painting hang at every door. wording: an object's description is worded
/// differently each time. fleet: two robots, each with its own frame, in one map. mixed: all of these without the
/// second robot; readings and detections fail about half as often. "Pooled" excludes mixed.
///
/// HOTEL V2. With --worlds or --world, --hotel v2 generates three identical-looking floors, with the same six prints
/// on the walls of each. One robot drives on each floor and a fourth on the lowest, through half of the first one's
/// rooms, all concurrently in one map. Plates and exit signs are read by an OCR with the error rates of the one used
/// for the recording floors: it misses, cuts and misreads. It does not distinguish plates from other text, and reads
/// text where there is none. It takes no --noise.
///
/// LOCATE. --locate maps three identical-looking floors of hotel v2, each with one robot and as a map of its own. Another
/// robot then wakes up at random places of its own tour, half of whose rooms are those of the map, drives on for twelve
/// keyframes (--restart-keyframes), and asks POST /v1/locate where the first one was. An answer is right on the right floor, and in the right room or within 3 m.
/// Restarts where no robot stood before are counted apart.
#[derive(Args, Clone, Debug)]
#[command(group(ArgGroup::new("random").args(["worlds", "world"]).multiple(true)))]
pub(super) struct HotelArgs {
    /// Run only these of the paper's sequences, comma-separated, such as SE1-00 or SE2-05
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with_all = ["worlds", "world", "record"], value_parser = sequence)]
    pub(super) sequences: Vec<PrintedSequence>,
    /// Number of random worlds for each kind of noise, instead of the paper's sequences; at most 1,000, held out 100
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000))]
    pub(super) worlds: Option<u64>,
    /// With --worlds: use the held-out worlds of this block (0 if none is named), seeds from 1,000,000 + 100 BLOCK on,
    /// which are never used for tuning
    #[arg(long, value_name = "BLOCK", requires = "worlds", num_args = 0..=1, default_missing_value = "0", value_parser = clap::value_parser!(u64).range(..=BLOCK_MAX))]
    pub(super) held_out: Option<u64>,
    /// Ask where a robot is that wakes up at random places, on three floors that look alike: 60 restarts a world, against a
    /// map of each floor. --worlds says how many worlds; default 1
    #[arg(long, conflicts_with_all = ["sequences", "world", "record", "noise", "hotel", "resume"])]
    pub(super) locate: bool,
    /// With --locate: number of keyframes of a restart
    #[arg(long, value_name = "N", requires = "locate", default_value_t = KEYFRAMES_OF_A_RESTART, value_parser = clap::value_parser!(u16).range(1..=ASKED_KEYFRAMES_MAX as i64))]
    pub(super) restart_keyframes: u16,
    /// none, reader, missed, repeated, wording, fleet, mixed or renumbered (eight rounds, between which door numbers
    /// change); all, the default, is reader to mixed, a row each
    #[arg(long, value_name = "LEVEL", value_parser = noise_kinds)]
    pub(super) noise: Option<NoiseKinds>,
    /// The generator of random worlds, with --worlds or --world; default v1
    #[arg(long, value_enum, value_name = "GENERATOR", conflicts_with = "sequences", requires = "random")]
    pub(super) hotel: Option<Generator>,
    /// Run this one random world, and explain the answer at each keyframe that was wrong or missed
    #[arg(long, value_name = "SEED", conflicts_with = "worlds", value_parser = clap::value_parser!(u64).range(..1_000))]
    pub(super) world: Option<u64>,
    /// With --world: the arm to explain: ours, monocular or paper
    #[arg(long, value_name = "ARM", requires = "world", default_value = "ours", value_parser = arm)]
    pub(super) arm: Method,
    /// Write a tour as a recording for `revisit replay` instead of driving it: that of --world, or of SE2 00 (.ndjson,
    /// .gz or .zst)
    #[arg(long, value_name = "FILE", conflicts_with = "worlds")]
    pub(super) record: Option<PathBuf>,
    /// Folder for figures, trajectories, results.json and the result of each completed world (worlds.ndjson)
    #[arg(long, value_name = "FOLDER", default_value = "hotel-results")]
    pub(super) output: PathBuf,
    /// With --worlds: resume the run in this --output folder, with the same build; completed worlds are skipped
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
    let found = Method::OF_WORLDS.into_iter().find(|arm| arm.as_str() == name);
    found.ok_or_else(|| format!("one of {}", Method::OF_WORLDS.map(Method::as_str).join(", ")))
}

/// The generator that draws the worlds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Generator {
    /// One floor, and a perfect reader except for --noise
    V1,
    /// Three identical-looking floors, and a reader with the limits of a real one
    V2,
}

impl HotelArgs {
    /// Returns the set of the random worlds; refuses more of them than a held-out block has.
    pub(super) fn world_set(&self) -> Result<WorldSet, Failure> {
        if self.held_out.is_some() && self.worlds.is_some_and(|count| count > BLOCK_WORLDS) {
            return Err(format!("--held-out takes at most {BLOCK_WORLDS} worlds: a block has no more").into());
        }
        Ok(WorldSet::of_block(self.held_out))
    }

    /// Returns the kinds of noise to run.
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
    let names: Vec<&str> = NoiseKind::ALL.into_iter().filter(has_noise).map(NoiseKind::as_str).collect();
    let kind = NoiseKind::from_name(name).filter(has_noise);
    Ok(NoiseKinds(vec![kind.ok_or_else(|| format!("one of {}, all", names.join(", ")))?]))
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct OnlyEval {
        #[command(flatten)]
        eval: EvalArgs,
    }

    fn hotel(line: &str) -> Result<HotelArgs, clap::Error> {
        let parsed =
            OnlyEval::try_parse_from(["revisit", "hotel"].into_iter().chain(line.split_whitespace()))?;
        let Experiment::Hotel(args) = parsed.eval.experiment else { panic!("another experiment") };
        Ok(args)
    }

    #[test]
    fn held_out_names_a_block_or_means_the_first_one() {
        for (line, set) in [
            ("--worlds 100", WorldSet::Development),
            ("--worlds 100 --held-out", WorldSet::HeldOut(0)),
            ("--worlds 3 --held-out --noise none", WorldSet::HeldOut(0)),
            ("--held-out 1 --worlds 3 --noise none", WorldSet::HeldOut(1)),
            ("--locate --worlds 3 --held-out=12", WorldSet::HeldOut(12)),
        ] {
            assert_eq!(hotel(line).unwrap().world_set().unwrap(), set, "{line}");
        }
    }

    #[test]
    fn a_block_has_a_hundred_worlds_and_is_a_number() {
        assert_eq!(hotel("--worlds 101").unwrap().world_set().unwrap(), WorldSet::Development);
        assert!(hotel("--worlds 101 --held-out 1").unwrap().world_set().is_err());
        for line in [
            "--held-out",
            "--worlds 3 --held-out x",
            "--worlds 3 --held-out -1",
            "--worlds 3 --held-out 10000",
        ] {
            assert!(hotel(line).is_err(), "{line}");
        }
    }
}
