//! Results: an experiment's figures, for tables and as JSON.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::explain::keyframe_id;
use super::fleet::FleetResult;
use super::paper::PrintedSequence;
use super::score::{Counts, Outcome, by_query, by_visit, confidence_interval, median, share};
use crate::api::verdict::CandidateView;
use crate::geometry::Pose;
use crate::geometry::absolute_orientation::Scale;
use crate::hotel::building::renumbering::{Round, Signs};
use crate::hotel::method::Method;
use crate::hotel::run::{AnsweredQuery, Course, RunResult, absolute_pose_error_m};
use crate::hotel::sensing::monocular::ScaleError;
use crate::hotel::sensing::noise::NoiseKind;

/// The true distance, in metres, below which the two keyframes of a wrong loop count as near each other.
pub const NEAR_M: f64 = 3.0;

/// A share with the figures behind it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// The numerator.
    pub part: u64,
    /// The denominator.
    pub whole: u64,
    /// Their quotient; 1 if the denominator is 0.
    pub share: f64,
    /// Wilson's interval at 95 %.
    pub confidence_interval: (f64, f64),
}

/// Precision and recall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Correct answers of all answers.
    pub precision: Share,
    /// Correct answers of all queries with a true loop.
    pub recall: Share,
}

/// One arm on one sequence or world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArmResult {
    /// `ours`, `paper` or `bow`.
    pub arm: Method,
    /// By query.
    pub by_query: Accuracy,
    /// By visit, the paper's unit.
    pub by_visit: Accuracy,
    /// RMSE of the positions after alignment, in metres; NaN (`null`) where they cannot be aligned.
    #[serde(deserialize_with = "nan_of_null")]
    pub absolute_pose_error_m: f64,
    /// The relative error of its lengths along the way, if the robot is monocular.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale_error: Option<ScaleError>,
    /// The number of pose graph optimisations.
    pub optimised: usize,
    /// The keyframes whose answer was wrong.
    pub wrong: Vec<String>,
    /// Those of them taken less than [`NEAR_M`] from the place of the wrong candidate.
    pub wrong_near: usize,
    /// The keyframes with a true loop and no answer.
    pub missed: Vec<String>,
    /// The reason codes of their true candidates, with the number of queries that each decided.
    pub lost_by: BTreeMap<String, u64>,
}

/// One sequence of the paper.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SequenceResult {
    /// `SE1 00`.
    pub sequence: String,
    /// The number of keyframes.
    pub keyframes: usize,
    /// Odometry alone, in metres.
    pub odometry_m: f64,
    /// The arms.
    pub arms: Vec<ArmResult>,
    /// The confusion of bag of words and Sim3.
    pub confusion: Confusion,
    /// The paper's figures for it.
    #[serde(skip)]
    pub printed: PrintedSequence,
}

impl SequenceResult {
    /// Returns the results of the arms on a course; `odometry` are the robots' poses by it alone.
    pub fn of(
        printed: PrintedSequence,
        course: &Course,
        odometry: &[Vec<Pose>],
        drives: &[RunResult],
    ) -> Self {
        let bag_of_words = drives.iter().find(|driven| driven.arm == Method::BagOfWords);
        Self {
            sequence: printed.name(),
            keyframes: course.order.len(),
            odometry_m: absolute_pose_error_m(&course.journeys, odometry, Scale::Fixed),
            arms: drives.iter().map(ArmResult::of).collect(),
            confusion: bag_of_words.map(Confusion::of).unwrap_or_default(),
            printed,
        }
    }
}

/// The median figures of correct and wrong loops of the arm without anchors. Except for their count, they cover loops
/// that the keyframe itself proposed, not an earlier one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Confusion {
    /// Wrong loops.
    pub wrong: usize,
    /// Their bag-of-words score.
    pub score_of_wrong: f64,
    /// Their inliers.
    pub inliers_of_wrong: f64,
    /// The score of correct loops.
    pub score_of_right: f64,
    /// Their inliers.
    pub inliers_of_right: f64,
}

/// One random world under one kind of noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorldResult {
    /// The kind of noise.
    pub noise: NoiseKind,
    /// The world's number.
    pub seed: u64,
    /// The number of keyframes of its tours.
    pub keyframes: usize,
    /// The arms.
    pub arms: Vec<ArmResult>,
    /// Our robots in one frame, if there are several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fleet: Option<FleetResult>,
    /// Our results by round, if door numbers change.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rounds: Vec<Round>,
    /// The signs of its map at the end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signs: Option<Signs>,
}

fn nan_of_null<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

impl Accuracy {
    /// Computes the accuracy of some counts.
    pub fn of(counts: &Counts) -> Self {
        Self {
            precision: Share::of(counts.right, counts.accepted),
            recall: Share::of(counts.found, counts.with_truth),
        }
    }

    /// Returns its counts.
    pub fn counts(&self) -> Counts {
        Counts {
            accepted: self.precision.whole,
            right: self.precision.part,
            with_truth: self.recall.whole,
            found: self.recall.part,
        }
    }
}

impl Share {
    fn of(part: u64, whole: u64) -> Self {
        Self { part, whole, share: share(part, whole), confidence_interval: confidence_interval(part, whole) }
    }
}

impl Confusion {
    /// Returns the results of a run.
    pub fn of(driven: &RunResult) -> Self {
        let typical = |outcome: Outcome, of: fn(&CandidateView) -> f64| {
            let answers = driven.asked.iter().filter(|asked| asked.scored.outcome == outcome);
            // A loop confirmed by later keyframes need not be among the last one's candidates.
            let accepted = |asked: &AnsweredQuery| Some(keyframe_id(asked.accepted?));
            let figures = answers.filter_map(|asked| asked.answer.candidate(&accepted(asked)?).map(of));
            median(figures.collect()).unwrap_or(0.0)
        };
        let inliers: fn(&CandidateView) -> f64 = |candidate| candidate.inliers().unwrap_or(0) as f64;
        Self {
            wrong: driven.asked.iter().filter(|asked| asked.scored.outcome == Outcome::Wrong).count(),
            score_of_wrong: typical(Outcome::Wrong, CandidateView::bow_score),
            inliers_of_wrong: typical(Outcome::Wrong, inliers),
            score_of_right: typical(Outcome::Right, CandidateView::bow_score),
            inliers_of_right: typical(Outcome::Right, inliers),
        }
    }
}

impl ArmResult {
    /// Computes the confusion in a run.
    pub fn of(driven: &RunResult) -> Self {
        let scored = driven.scored();
        let with =
            |outcome: Outcome| driven.asked.iter().filter(move |asked| asked.scored.outcome == outcome);
        let ids = |outcome: Outcome| with(outcome).map(|asked| keyframe_id(asked.keyframe)).collect();
        let is_near = |asked: &&AnsweredQuery| asked.apart_m.is_some_and(|apart_m| apart_m < NEAR_M);
        let mut lost_by = BTreeMap::new();
        for code in driven.asked.iter().filter_map(|asked| asked.lost_by.clone()) {
            *lost_by.entry(code).or_default() += 1;
        }
        Self {
            arm: driven.arm,
            by_query: Accuracy::of(&by_query(&scored)),
            by_visit: Accuracy::of(&by_visit(&scored)),
            absolute_pose_error_m: driven.absolute_pose_error_m,
            scale_error: driven.scale_error,
            optimised: driven.closed,
            wrong: ids(Outcome::Wrong),
            wrong_near: with(Outcome::Wrong).filter(is_near).count(),
            missed: ids(Outcome::Missed),
            lost_by,
        }
    }
}

/// Pools an arm's counts over several results, by query and by visit.
pub fn pooled<'a>(results: impl Iterator<Item = &'a [ArmResult]>, arm: Method) -> [Counts; 2] {
    results.flatten().filter(|result| result.arm == arm).fold([Counts::default(); 2], |sum, result| {
        [sum[0].plus(result.by_query.counts()), sum[1].plus(result.by_visit.counts())]
    })
}
