//! Monocular: a tour as seen by a robot with one camera and no depth.
//!
//! | | |
//! |---|---|
//! | unit | arbitrary: the median depth of the first keyframe (as for ORB-SLAM's first map) |
//! | drift of scale | a random walk of the unit's logarithm ([`super::odometry::scale_drift`]) |
//! | motions | odometry's, in that unit |
//! | map points | triangulated from their own keypoints ([`super::triangulation`]), so that points without parallax have no position |
//!
//! Triangulation uses the camera's true motion between observations, up to the unit. This is better than any bundle
//! adjustment, and flatters the results.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::triangulation::triangulate;
use crate::domain::keyframe::Keypoint;
use crate::geometry::{Point3, Pose};
use crate::hotel::scoring::score::median;
use crate::hotel::sequence::{Placed, Sequence, Step};

/// A point is placed again each time its parallax has grown by this factor, similar to bundle adjustment.
const PLACED_ANEW: f64 = 2.0;

/// The relative error of a monocular robot's lengths along its way: the standard deviation of its unit's logarithm
/// over the keyframes, as root mean square over robots.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScaleError {
    /// By odometry alone.
    pub odometry: f64,
    /// After the loops that it closed.
    pub corrected: f64,
}

impl ScaleError {
    /// Computes the error of robots on their tours, from the final scales of their keyframes.
    pub fn of(journeys: &[Sequence], scales: &[Vec<f64>]) -> Self {
        let variances = |corrects: bool| -> f64 {
            let of_robot = |(journey, scales): (&Sequence, &Vec<f64>)| {
                let log = |(drift, scale): (&f64, &f64)| drift + if corrects { scale.ln() } else { 0.0 };
                variance(&journey.scale_drift.iter().zip(scales).map(log).collect::<Vec<f64>>())
            };
            journeys.iter().zip(scales).map(of_robot).sum()
        };
        let root_mean = |corrects: bool| (variances(corrects) / journeys.len().max(1) as f64).sqrt();
        Self { odometry: root_mean(false), corrected: root_mean(true) }
    }
}

fn variance(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len().max(1) as f64
}

/// A map point during a tour.
struct Track {
    first: (usize, Keypoint),
    /// The parallax of its last placement, in radians; 0 before.
    parallax_rad: f64,
}

/// Returns the units per metre of a robot without depth, at each keyframe.
pub fn units_per_metre(journey: &Sequence) -> Vec<f64> {
    let features = journey.steps.iter().take(1).flat_map(|step| &step.features);
    let median_m = median(features.map(|feature| feature.in_camera.z).collect()).unwrap_or(1.0);
    journey.scale_drift.iter().map(|drift| drift.exp() / median_m).collect()
}

/// Returns the same tour without depth.
pub fn without_depth(journey: &Sequence) -> Sequence {
    let units = units_per_metre(journey);
    let mut tracks: HashMap<u64, Track> = HashMap::new();
    let steps = (0..journey.steps.len()).map(|number| {
        let (step, unit) = (&journey.steps[number], units[number]);
        let placed = (0..step.features.len())
            .filter_map(|feature| {
                let in_camera = place(&mut tracks, &journey.steps, (number, feature))?;
                Some(Placed { feature, in_camera: in_camera * unit })
            })
            .collect();
        Step { motion: scaled(&step.motion, unit), placed, ..step.clone() }
    });
    Sequence { steps: steps.collect(), scale_drift: journey.scale_drift.clone() }
}

/// Places the map point of a feature in the camera frame of its keyframe, in metres, if its parallax has grown enough.
fn place(
    tracks: &mut HashMap<u64, Track>,
    steps: &[Step],
    (number, feature): (usize, usize),
) -> Option<Point3> {
    let step = &steps[number];
    let seen = step.features[feature].keypoint;
    let track =
        tracks.entry(step.map_points[feature]).or_insert(Track { first: (number, seen), parallax_rad: 0.0 });
    let (first, seen_first) = track.first;
    let pose = |number: usize| steps[number].stop.stand.map_from_camera();
    let first_from_now = pose(first).inverse().after(&pose(number));
    let found = triangulate(&first_from_now, seen_first, seen)?;
    if found.parallax_rad < track.parallax_rad * PLACED_ANEW {
        return None;
    }
    track.parallax_rad = found.parallax_rad;
    Some(found.in_second)
}

fn scaled(motion: &Pose, unit: f64) -> Pose {
    Pose::from_stored(motion.translation_m().map(|length| length * unit), motion.rotation_xyzw())
}

#[cfg(test)]
mod tests {
    use super::super::noise::Noise;
    use super::*;
    use crate::hotel::building::floor_plan::Layout;
    use crate::hotel::building::signs::SignPlan;
    use crate::hotel::building::texture::Patterns;
    use crate::hotel::building::world::{World, WorldPlan};
    use crate::hotel::rng::SeededRng;
    use crate::hotel::route::tour;

    fn journey() -> Sequence {
        let plan = WorldPlan { layout: Layout::SE1, floor: 9, signs: SignPlan::default(), seed: 7 };
        let world = World::new(&plan, &Patterns::new());
        let stops = tour(&world.plan, &[3, 5], &mut SeededRng::new(7, "route"));
        Sequence::record(&world, &stops, Noise::default(), 0.5, 7)
    }

    #[test]
    fn motions_and_points_are_in_one_unit_that_drifts_and_what_has_no_parallax_has_no_place() {
        let journey = journey();
        let (units, seen) = (units_per_metre(&journey), without_depth(&journey));
        let first = &journey.steps[0];
        let depths: Vec<f64> = first.features.iter().map(|feature| feature.in_camera.z * units[0]).collect();
        assert!((median(depths).unwrap() - 1.0).abs() < 0.01, "the unit is the first median depth");
        assert!(seen.steps[0].placed.is_empty(), "one view has no parallax");
        let (mut ratios, mut placed, mut new) = (Vec::new(), 0, 0);
        for (number, (with, without)) in journey.steps.iter().zip(&seen.steps).enumerate() {
            let length = |step: &Step| step.motion.centre().coords.norm();
            assert!((length(without) - length(with) * units[number]).abs() < 1e-12);
            (placed, new) = (placed + without.placed.len(), new + with.placed.len());
            for point in &without.placed {
                let depth_m = with.features[point.feature].in_camera.z;
                ratios.push((point.in_camera.z / (depth_m * units[number])).ln().abs());
            }
        }
        assert!(placed > new / 3, "{placed} places for {new} points");
        let ever: std::collections::HashSet<u64> = (seen.steps.iter())
            .flat_map(|step| step.placed.iter().map(|placed| step.map_points[placed.feature]))
            .collect();
        assert!((new / 4..new).contains(&ever.len()), "{} of {new} points have a place", ever.len());
        let off = median(ratios).unwrap();
        assert!((0.01..0.08).contains(&off), "depths are off by {off}");
        let ends = ScaleError::of(&[journey], &[vec![1.0; units.len()]]);
        assert_eq!(ends.odometry, ends.corrected);
        assert!((0.005..0.3).contains(&ends.odometry), "{ends:?}");
    }

    #[test]
    fn a_scale_that_follows_the_drift_leaves_no_error() {
        let journey = journey();
        let scales: Vec<f64> = journey.scale_drift.iter().map(|drift| 3.0 * (-drift).exp()).collect();
        let error = ScaleError::of(&[journey], &[scales]);
        assert!(error.corrected < 1e-12 && error.odometry > 0.005, "{error:?}");
    }
}
