//! Run: one arm on recorded journeys, with its answers compared with the truth.

use std::collections::HashMap;

use super::method::Method;
use super::robot::client::{DriveError, Robot};
use super::robot::loop_closing::{LoopClosing, find};
use super::robot::message;
use super::route::Place;
use super::scoring::absolute_pose_error::{centres, rmse_after_alignment};
use super::scoring::score::{Outcome, Scored};
use super::scoring::truth::{Answerable, KeyframeIndex, answers, apart_m};
use super::sensing::monocular::{self, ScaleError};
use super::sequence::{Sequence, by_odometry};
use crate::api::verdict::{CandidateView, LoopAnswer};
use crate::client::Client;
use crate::domain::reason::ReasonCode;
use crate::geometry::absolute_orientation::Scale;
use crate::geometry::{Pose, Sim3};

/// Journeys with their truth, shared by every arm.
#[derive(Clone, Debug)]
pub struct Course {
    /// One per robot.
    pub journeys: Vec<Sequence>,
    /// The keyframes of all robots in temporal order, taking turns.
    pub order: Vec<KeyframeIndex>,
    /// The truth for each of them.
    pub answers: Vec<Answerable>,
    /// The first visit to each room of each floor: its robot and visit number.
    first_stays: HashMap<(usize, Place), (usize, usize)>,
}

impl Course {
    /// Creates a course. Robots drive concurrently, keyframe by keyframe.
    pub fn new(journeys: Vec<Sequence>) -> Self {
        let longest = journeys.iter().map(|journey| journey.steps.len()).max().unwrap_or(0);
        let order: Vec<KeyframeIndex> = (0..longest)
            .flat_map(|number| (0..journeys.len()).map(move |robot| (robot, number)))
            .filter(|(robot, number)| *number < journeys[*robot].steps.len())
            .collect();
        let answers = answers(&journeys, &order);
        let mut first_stays = HashMap::new();
        for (robot, number) in &order {
            let stop = journeys[*robot].steps[*number].stop;
            if stop.place != Place::Corridor {
                first_stays.entry((stop.storey, stop.place)).or_insert((*robot, stop.visit));
            }
        }
        Self { journeys, order, answers, first_stays }
    }

    /// Whether a robot, this one or another, had visited this keyframe's room before.
    fn is_revisit(&self, keyframe: KeyframeIndex) -> bool {
        let stop = self.journeys[keyframe.0].steps[keyframe.1].stop;
        let stay = (keyframe.0, stop.visit);
        self.first_stays.get(&(stop.storey, stop.place)).is_some_and(|first| *first != stay)
    }
}

/// One query with its answer.
#[derive(Clone, Debug)]
pub struct AnsweredQuery {
    /// The keyframe.
    pub keyframe: KeyframeIndex,
    /// The keyframe with which the robot accepts a loop.
    pub accepted: Option<KeyframeIndex>,
    /// The true distance between the two, in metres.
    pub apart_m: Option<f64>,
    /// The candidate that the arm ranks first, whether or not it passed the threshold.
    pub ranked: Option<Ranked>,
    /// The answer of bag of words alone.
    pub words: WordsAlone,
    /// Its score.
    pub scored: Scored,
    /// For a missed loop, the reason of the true candidate that came farthest.
    pub lost_by: Option<String>,
    /// The server's answer.
    pub answer: LoopAnswer,
}

/// The candidate that an arm ranks first, for its curve of precision over recall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranked {
    /// The score for ranking: S of Eq. (2), or inliers without anchors.
    pub score: f64,
    /// Whether it is the same place.
    pub is_right: bool,
}

/// The answer of bag of words alone: the candidate with the most similar words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WordsAlone {
    /// A candidate that is neither correct nor wrong.
    Unscored,
    /// No candidate.
    Nothing,
    /// A candidate, with the score of its words.
    Names(Ranked),
}

/// An arm at the end of its run.
#[derive(Clone, Debug)]
pub struct RunResult {
    /// The arm.
    pub arm: Method,
    /// Every query, in order.
    pub asked: Vec<AnsweredQuery>,
    /// Each robot's own pose estimates of its keyframes, in its own frame.
    pub poses: Vec<Vec<Pose>>,
    /// RMSE of the positions after alignment, in metres, over all robots; aligned by scale, too, if the robot is
    /// monocular.
    pub absolute_pose_error_m: f64,
    /// The relative error of its lengths along the way, if the robot is monocular.
    pub scale_error: Option<ScaleError>,
    /// The number of pose graph optimisations.
    pub closed: usize,
}

impl RunResult {
    /// Returns the scored queries.
    pub fn scored(&self) -> Vec<Scored> {
        self.asked.iter().map(|asked| asked.scored).collect()
    }
}

/// Runs an arm on a course, in its own map. `told` receives each answer.
pub async fn drive(
    client: &Client,
    map: &str,
    arm: Method,
    course: &Course,
    mut told: impl FnMut(&AnsweredQuery),
) -> Result<RunResult, DriveError> {
    client.put_map(map, &message::map(arm, "the simulated hotel")).await?;
    let without_depth: Vec<Sequence> = if arm.is_monocular() {
        course.journeys.iter().map(monocular::without_depth).collect()
    } else {
        Vec::new()
    };
    let journeys = if arm.is_monocular() { &without_depth } else { &course.journeys };
    let mut robots: Vec<Robot<'_>> =
        (0..journeys.len()).map(|number| Robot::new(client, map, arm, session(number))).collect();
    let mut closing: Vec<LoopClosing> = robots.iter().map(|_| LoopClosing::of(arm)).collect();
    let mut asked = Vec::with_capacity(course.order.len());
    for (keyframe, answerable) in course.order.iter().zip(&course.answers) {
        let step = &journeys[keyframe.0].steps[keyframe.1];
        let answer = robots[keyframe.0].ask(step).await?;
        let taken = closing[keyframe.0].hear(&robots, *keyframe, &answer);
        let accepted = taken.as_ref().map(|taken| taken.candidate);
        let inliers = taken.as_ref().map_or(0, |taken| taken.inliers);
        robots[keyframe.0].close(taken.and_then(|taken| taken.to_close)).await?;
        let outcome = outcome(accepted, answerable);
        let has_truth = !answerable.truth.is_empty();
        let visit = (step.stop.place != Place::Corridor).then_some((keyframe.0, step.stop.visit));
        let is_revisit = course.is_revisit(*keyframe);
        let scored = Scored { visit, is_revisit, has_truth, outcome, inliers };
        let ranked = ranked(arm, &answer, answerable, &robots);
        let lost_by = (outcome == Outcome::Missed).then(|| lost_by(&answer, answerable, &robots));
        let apart_m = accepted.map(|other| apart_m(step, &course.journeys[other.0].steps[other.1]));
        let words = words_alone(&answer, answerable, &robots);
        let this =
            AnsweredQuery { keyframe: *keyframe, accepted, apart_m, ranked, words, scored, lost_by, answer };
        told(&this);
        asked.push(this);
    }
    for robot in &mut robots {
        robot.finish().await?;
    }
    let frames = || robots.iter().map(|robot| robot.slam_map().frames().iter());
    let poses: Vec<Vec<Pose>> = frames().map(|frames| frames.map(Sim3::without_scale).collect()).collect();
    let scales: Vec<Vec<f64>> = frames().map(|frames| frames.map(Sim3::scale).collect()).collect();
    let alignment = if arm.is_monocular() { Scale::Free } else { Scale::Fixed };
    Ok(RunResult {
        arm,
        asked,
        absolute_pose_error_m: absolute_pose_error_m(journeys, &poses, alignment),
        scale_error: arm.is_monocular().then(|| ScaleError::of(journeys, &scales)),
        closed: robots.iter().map(Robot::closed).sum(),
        poses,
    })
}

/// Returns the robots' poses by odometry alone.
pub fn odometry(course: &Course) -> Vec<Vec<Pose>> {
    course.journeys.iter().map(|journey| by_odometry(&journey.steps)).collect()
}

/// Returns the RMSE of the robots' positions, each aligned with its own truth, in metres.
pub fn absolute_pose_error_m(journeys: &[Sequence], poses: &[Vec<Pose>], scale: Scale) -> f64 {
    let squared = journeys.iter().zip(poses).map(|(journey, poses)| {
        let rmse = rmse_after_alignment(&centres(poses), &centres(&journey.true_poses()), scale);
        rmse.map_or(f64::NAN, |rmse| rmse * rmse)
    });
    (squared.sum::<f64>() / journeys.len() as f64).sqrt()
}

/// Returns the session of a robot, which its keyframe ids start with.
pub fn session(robot: usize) -> String {
    if robot == 0 { "kf".to_owned() } else { format!("kf{}", robot + 1) }
}

fn ranked(arm: Method, answer: &LoopAnswer, answerable: &Answerable, robots: &[Robot<'_>]) -> Option<Ranked> {
    let score = |candidate: &CandidateView| match arm {
        Method::BagOfWords => candidate.inliers().unwrap_or(0) as f64,
        Method::Ours | Method::OursMonocular | Method::Paper => candidate.similarity().unwrap_or(0.0),
    };
    // Accepted candidates are ranked by the server's answer, confirmed or not; below the threshold, those rejected by
    // it alone.
    let threshold =
        if arm == Method::BagOfWords { ReasonCode::TooFewInliers } else { ReasonCode::ScoreBelowThreshold };
    let is_near =
        |candidate: &&CandidateView| candidate.reason.as_ref().is_some_and(|r| r.code.0 == threshold);
    let first = match answer.place() {
        Some(place) => place,
        None => answer.candidates.iter().filter(is_near).max_by(|a, b| score(a).total_cmp(&score(b)))?,
    };
    let keyframe = find(robots, &first.keyframe)?;
    let is_right = answerable.truth.contains(&keyframe);
    (is_right || !answerable.ignore.contains(&keyframe)).then(|| Ranked { score: score(first), is_right })
}

fn words_alone(answer: &LoopAnswer, answerable: &Answerable, robots: &[Robot<'_>]) -> WordsAlone {
    let by_words = answer.candidates.iter().filter(|candidate| candidate.bow_score() > 0.0);
    let best = by_words.rev().max_by(|a, b| a.bow_score().total_cmp(&b.bow_score()));
    let Some((candidate, keyframe)) = best.and_then(|best| Some((best, find(robots, &best.keyframe)?)))
    else {
        return WordsAlone::Nothing;
    };
    match answerable.truth.contains(&keyframe) {
        false if answerable.ignore.contains(&keyframe) => WordsAlone::Unscored,
        is_right => WordsAlone::Names(Ranked { score: candidate.bow_score(), is_right }),
    }
}

/// Returns the reason code of the first true candidate, which is the best of those that failed. It is `not_confirmed`
/// if the server accepted it, `not_a_candidate` if the answer has none.
fn lost_by(answer: &LoopAnswer, answerable: &Answerable, robots: &[Robot<'_>]) -> String {
    let is_right = |candidate: &&CandidateView| {
        find(robots, &candidate.keyframe).is_some_and(|key| answerable.truth.contains(&key))
    };
    let right = answer.candidates.iter().find(is_right);
    match right.map(|candidate| candidate.reason.as_ref()) {
        None => String::from("not_a_candidate"),
        Some(None) => String::from("not_confirmed"),
        Some(Some(reason)) => reason.code.0.as_str().to_owned(),
    }
}

fn outcome(accepted: Option<KeyframeIndex>, answerable: &Answerable) -> Outcome {
    match accepted {
        None if answerable.truth.is_empty() => Outcome::RightlyNone,
        None => Outcome::Missed,
        Some(other) if answerable.truth.contains(&other) => Outcome::Right,
        Some(other) if answerable.ignore.contains(&other) => Outcome::Unscored,
        Some(_) => Outcome::Wrong,
    }
}
