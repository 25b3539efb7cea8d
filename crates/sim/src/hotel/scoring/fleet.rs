//! Fleet: how well the server's frames put robots with frames of their own into one.
//!
//! A robot's true frame is the one in which its trajectory fits the truth best, as evo aligns it: its own drift is not the frames'
//! error. Robots on different floors must not be joined.

use serde::{Deserialize, Serialize};

use super::absolute_pose_error::{alignment, centres, rmse_after_alignment};
use super::score::median;
use crate::api::frames::FramesView;
use crate::geometry::absolute_orientation::Scale;
use crate::geometry::{Point3, Sim3};
use crate::hotel::robot::message;
use crate::hotel::run::{Course, RunResult, session};

/// The robots of one world in one frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FleetResult {
    /// Of each pair of joined robots on one floor, the error of the transformation between their frames: in metres, in the middle of the
    /// second one's tour, and in degrees.
    pub pairs: Vec<(f64, f64)>,
    /// Pairs on one floor that no loop joins.
    pub apart: usize,
    /// Joined pairs on different floors.
    pub wrongly_joined: usize,
    /// Confirmed loops that the server suspects, and all between robots.
    pub suspects: (usize, usize),
    /// Position error of the joined robots after one alignment for all, in metres: with their own frames, and ...
    pub separate_m: f64,
    /// ... in the server's frame; and ...
    pub joined_m: f64,
    /// ... after an alignment for each robot, which no common frame can be better than.
    pub alone_m: f64,
}

/// A robot in the server's frame.
struct Framed {
    reference_from_session: Sim3,
    estimated: Vec<Point3>,
    truth: Vec<Point3>,
}

impl FleetResult {
    /// Compares the frames at the end of a run with the truth.
    pub fn of(frames: &FramesView, course: &Course, driven: &RunResult) -> Self {
        let journeys = &course.journeys;
        let framed = |robot: usize| {
            let frame = frames.frames.iter().find(|frame| frame.session == session(robot))?;
            Some(Framed {
                reference_from_session: message::rigid(frame.reference_from_session.as_ref()?)?,
                estimated: centres(&driven.poses[robot]),
                truth: centres(&journeys[robot].true_poses()),
            })
        };
        let framed: Vec<Option<Framed>> = (0..journeys.len()).map(framed).collect();
        let mut result = Self { suspects: (frames.suspects.len(), frames.loops), ..Self::default() };
        for a in 0..journeys.len() {
            for b in a + 1..journeys.len() {
                let same_floor = journeys[a].storey() == journeys[b].storey();
                match (&framed[a], &framed[b]) {
                    (Some(a), Some(b)) if same_floor => result.pairs.extend(pair_error(a, b)),
                    (Some(_), Some(_)) => result.wrongly_joined += 1,
                    _ => result.apart += usize::from(same_floor),
                }
            }
        }
        let joined: Vec<Framed> = framed.into_iter().flatten().collect();
        (result.separate_m, result.joined_m, result.alone_m) = position_errors(&joined);
        result
    }
}

/// Returns how far the frames are off between two robots, in metres and degrees; none if a tour is too straight to tell.
fn pair_error(a: &Framed, b: &Framed) -> Option<(f64, f64)> {
    let world_from = |of: &Framed| alignment(&of.estimated, &of.truth, Scale::Fixed);
    let true_a_from_b = world_from(a)?.inverse().after(&world_from(b)?);
    let a_from_b = a.reference_from_session.inverse().after(&b.reference_from_session);
    let middle =
        b.estimated.iter().fold(Point3::origin(), |sum, at| sum + at.coords) / b.estimated.len() as f64;
    let off_m = (a_from_b.transform(&middle) - true_a_from_b.transform(&middle)).norm();
    let off_deg = a_from_b.rotation().angle_to(true_a_from_b.rotation()).to_degrees();
    Some((off_m, off_deg))
}

/// Returns the position errors of robots after one alignment, each in its own frame and all in the server's; and after one each.
fn position_errors(framed: &[Framed]) -> (f64, f64, f64) {
    let truths: Vec<Point3> = framed.iter().flat_map(|of| of.truth.iter().copied()).collect();
    let of_all = |place: fn(&Framed, &Point3) -> Point3| {
        let estimated: Vec<Point3> =
            framed.iter().flat_map(|of| of.estimated.iter().map(move |at| place(of, at))).collect();
        rmse_after_alignment(&estimated, &truths, Scale::Fixed).unwrap_or(f64::NAN)
    };
    let alone = framed.iter().map(|of| {
        let rmse = rmse_after_alignment(&of.estimated, &of.truth, Scale::Fixed).unwrap_or(f64::NAN);
        rmse * rmse * of.estimated.len() as f64
    });
    let alone_m = (alone.sum::<f64>() / truths.len() as f64).sqrt();
    (of_all(|_, at| *at), of_all(|of, at| of.reference_from_session.transform(at)), alone_m)
}

/// Returns the figures of the fleets of all worlds, as text; empty if no world has several robots.
pub fn table<'r>(results: impl Iterator<Item = &'r FleetResult>) -> String {
    let results: Vec<&FleetResult> = results.collect();
    if results.is_empty() {
        return String::new();
    }
    let pairs = || results.iter().flat_map(|of| &of.pairs);
    let off_m: Vec<f64> = pairs().map(|(off_m, _)| *off_m).collect();
    let off_deg: Vec<f64> = pairs().map(|(_, off_deg)| *off_deg).collect();
    let worst = |figures: &[f64]| figures.iter().copied().fold(f64::NAN, f64::max);
    let sum = |of: fn(&FleetResult) -> usize| results.iter().map(|result| of(result)).sum::<usize>();
    let with_pairs = || results.iter().filter(|of| !of.pairs.is_empty());
    let mean = |of: fn(&FleetResult) -> f64| {
        with_pairs().map(|result| of(result)).sum::<f64>() / with_pairs().count() as f64
    };
    format!(
        "\nfleets in one frame: {} pairs of robots joined, {} of one floor not, {} of two floors wrongly; off by {:.3} m and {:.2} degrees at the median,\n\
         {:.2} m and {:.1} degrees at worst; {} of {} confirmed loops between robots suspected\n\
         positions of the joined robots after one alignment (evo_ape -a), on average: {:.2} m with frames of their own, {:.3} m in the server's;\n\
         {:.3} m after an alignment for each robot\n",
        off_m.len(),
        sum(|of| of.apart),
        sum(|of| of.wrongly_joined),
        median(off_m.clone()).unwrap_or(f64::NAN),
        median(off_deg.clone()).unwrap_or(f64::NAN),
        worst(&off_m),
        worst(&off_deg),
        sum(|of| of.suspects.0),
        sum(|of| of.suspects.1),
        mean(|of| of.separate_m),
        mean(|of| of.joined_m),
        mean(|of| of.alone_m),
    )
}
