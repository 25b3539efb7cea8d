//! Output files of an experiment: figures as SVG, trajectories in TUM format, recordings, all results as JSON.

use std::fs::{self, File};
use std::io::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use super::curve::curve;
use crate::cli::compressed_file::{CompressedFile, ZSTD_LEVEL};
use crate::cli::failure::Failure;
use crate::geometry::absolute_orientation::Scale;
use crate::geometry::{Point3, Pose};
use crate::hotel::figures::{Panel, precision_recall, trajectories};
use crate::hotel::method::Method;
use crate::hotel::run::RunResult;
use crate::hotel::scenario::Scenario;
use crate::hotel::scoring::absolute_pose_error::{alignment, centres};
use crate::hotel::scoring::paper::FIGURE_6;
use crate::hotel::scoring::results::{SequenceResult, WorldResult};
use crate::hotel::scoring::score::Outcome;
use crate::hotel::scoring::tum;

/// One sequence, run by every arm.
pub(super) struct Driven12 {
    /// Its figures.
    pub result: SequenceResult,
    /// Its world and ground truth.
    pub scenario: Scenario,
    /// The arms at the end of their runs.
    pub arms: Vec<RunResult>,
    /// Odometry alone.
    pub odometry: Vec<Vec<Pose>>,
}

/// Writes all results of the paper's sequences.
pub(super) fn write_sequences(folder: &Path, drives: &[Driven12]) -> Result<(), Failure> {
    let tum_folder = folder.join("trajectories");
    fs::create_dir_all(&tum_folder)?;
    for driven in drives {
        let name = driven.result.sequence.replace(' ', "-");
        let truth = driven.scenario.course.journeys[0].true_poses();
        fs::write(tum_folder.join(format!("{name}-truth.tum")), tum::trajectory(&truth))?;
        fs::write(tum_folder.join(format!("{name}-odometry.tum")), tum::trajectory(&driven.odometry[0]))?;
        for arm in &driven.arms {
            let file = tum_folder.join(format!("{name}-{}.tum", arm.arm.as_str()));
            fs::write(file, tum::trajectory(&arm.poses[0]))?;
        }
    }
    if let Some(shown) = drives.iter().find(|driven| driven.result.printed == FIGURE_6) {
        fs::write(folder.join("figure6.svg"), trajectories(&panels(shown))?)?;
    }
    let of_arm = |arm: Method| -> Vec<&RunResult> {
        drives.iter().flat_map(|driven| &driven.arms).filter(|driven| driven.arm == arm).collect()
    };
    let curves: Vec<_> = Method::OF_SEQUENCES.into_iter().filter_map(|arm| curve(&of_arm(arm))).collect();
    fs::write(folder.join("precision-recall.svg"), precision_recall(&curves)?)?;
    let results: Vec<&SequenceResult> = drives.iter().map(|driven| &driven.result).collect();
    write_json(folder, &json!({"sequences": results}))
}

/// Writes the lines of a recording into a file, compressed according to its name.
pub(super) fn write_recording(file: &Path, lines: Vec<Value>) -> Result<(), Failure> {
    let mut out = CompressedFile::new(File::create(file)?, file, ZSTD_LEVEL)?;
    for line in lines {
        writeln!(out, "{line}")?;
    }
    out.finish()?;
    Ok(())
}

/// Writes all results of random worlds, and the block if they are held out.
pub(super) fn write_worlds(
    folder: &Path,
    held_out: Option<u64>,
    results: &[WorldResult],
) -> Result<(), Failure> {
    fs::create_dir_all(folder)?;
    write_json(folder, &json!({"held_out_block": held_out, "worlds": results}))
}

fn write_json(folder: &Path, results: &Value) -> Result<(), Failure> {
    Ok(fs::write(folder.join("results.json"), format!("{results:#}\n"))?)
}

fn panels(driven: &Driven12) -> Vec<Panel> {
    let arm = |arm: Method| driven.arms.iter().find(|driven| driven.arm == arm);
    let mut panels = Vec::new();
    if let Some(bow) = arm(Method::BagOfWords) {
        panels.push(panel(driven, "(a) bag of words + Sim3, no anchors", &bow.poses[0], Some(bow)));
    }
    panels.push(panel(driven, "(b) odometry alone", &driven.odometry[0], None));
    if let Some(ours) = arm(Method::Ours) {
        panels.push(panel(driven, "(c) ours", &ours.poses[0], Some(ours)));
    }
    panels
}

fn panel(driven: &Driven12, title: &str, poses: &[Pose], arm: Option<&RunResult>) -> Panel {
    let truth = centres(&driven.scenario.course.journeys[0].true_poses());
    let estimate = centres(poses);
    let laid_over: Vec<Point3> = match alignment(&estimate, &truth, Scale::Fixed) {
        Some(truth_from_estimate) => {
            estimate.iter().map(|point| truth_from_estimate.transform(point)).collect()
        }
        None => estimate,
    };
    let flat = |points: &[Point3]| points.iter().map(|point| [point.x, point.y]).collect();
    let off_m = laid_over.iter().zip(&truth).map(|(a, b)| (a - b).norm_squared()).sum::<f64>();
    let off_m = (off_m / truth.len() as f64).sqrt();
    let loops: Vec<(usize, usize, bool)> = arm.map_or_else(Vec::new, |arm| {
        let answered = arm
            .asked
            .iter()
            .filter_map(|asked| Some((asked.keyframe.1, asked.accepted?.1, asked.scored.outcome)));
        answered.map(|(from, to, outcome)| (from, to, outcome != Outcome::Wrong)).collect()
    });
    let wrong = loops.iter().filter(|(.., is_right)| !is_right).count();
    let told =
        if arm.is_some() { format!(", {} loops, {wrong} of them wrong", loops.len()) } else { String::new() };
    Panel {
        title: title.to_owned(),
        caption: format!("{}: off by {off_m:.2} m{told}", driven.result.sequence),
        truth: flat(&truth),
        estimate: flat(&laid_over),
        loops,
        walls: driven.scenario.floors[0].plan.walls.clone(),
    }
}
