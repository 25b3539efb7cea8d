//! Realism: figures that compare the simulated hotel with real ones, so that it cannot become too easy unnoticed.

use super::floor_plan::FloorPlan;
use super::texture::DESCRIPTOR_BITS;
use crate::domain::keyframe::Keypoint;
use crate::domain::verdict::GeometryStatus;
use crate::geometry::Point3;
use crate::geometry::hamming::PackedDescriptors;
use crate::hotel::robot::message::descriptor_bytes;
use crate::hotel::route::{Place, heading_difference_rad};
use crate::hotel::scoring::score;
use crate::hotel::scoring::truth::{is_same_place, shared_points};
use crate::hotel::sensing::camera::CAMERA;
use crate::hotel::sequence::{Sequence, Step};
use crate::recognition::verification::{Limits, View, verify};
use crate::vocabulary::{DescriptorMismatch, Vocabulary, WordVector};

/// Measured medians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Realism {
    /// Features of an image.
    pub features: f64,
    /// Physical points shared by successive keyframes.
    pub shared_with_next: f64,
    /// Bag-of-words score between keyframes of one place on two visits.
    pub score_same_place: f64,
    /// Bag-of-words score between the same views of two rooms.
    pub score_twin_rooms: f64,
    /// Bag-of-words score between a room and the corridor.
    pub score_elsewhere: f64,
    /// Inliers of Sim3 between keyframes of one place on two visits.
    pub inliers_same_place: f64,
    /// Inliers of Sim3 between the same views of two rooms.
    pub inliers_twin_rooms: f64,
    /// The share of equal views of two rooms that Sim3 verifies as one place.
    pub verified_twin_rooms: f64,
}

/// Maximum difference of two twin views in place and heading, in metres and radians.
const TWIN_M: f64 = 0.4;
const TWIN_RAD: f64 = 0.15;
/// Sampling interval of the pairs.
const EVERY_PAIR: usize = 7;

/// Measures one journey through a floor.
pub fn measure(
    plan: &FloorPlan,
    journey: &Sequence,
    vocabulary: &Vocabulary,
) -> Result<Realism, DescriptorMismatch> {
    let steps = &journey.steps;
    let words: Vec<WordVector> =
        steps.iter().map(|step| words(vocabulary, step)).collect::<Result<_, _>>()?;
    let pairs = || (0..steps.len()).flat_map(|later| (0..later).map(move |earlier| (earlier, later)));
    let far_apart = |(a, b): &(usize, usize)| steps[*a].stop.visit + 2 <= steps[*b].stop.visit;
    let same: Vec<(usize, usize)> = pairs()
        .filter(far_apart)
        .filter(|(a, b)| is_same_place(&steps[*a], &steps[*b]))
        .step_by(EVERY_PAIR)
        .collect();
    let twins: Vec<(usize, usize)> =
        pairs().filter(|(a, b)| are_twins(plan, &steps[*a], &steps[*b])).step_by(EVERY_PAIR).collect();
    let in_corridor = |at: usize| steps[at].stop.place == Place::Corridor;
    let elsewhere = pairs().filter(|(a, b)| in_corridor(*a) != in_corridor(*b)).step_by(EVERY_PAIR * 20);
    let score = |(a, b): &(usize, usize)| words[*a].l1_score(&words[*b]);
    let inliers = |pairs: &[(usize, usize)]| -> Vec<(bool, f64)> {
        pairs.iter().filter_map(|(a, b)| verified(&steps[*b], &steps[*a])).collect()
    };
    let (of_same, of_twins) = (inliers(&same), inliers(&twins));
    let verified = of_twins.iter().filter(|(is_verified, _)| *is_verified).count();
    Ok(Realism {
        features: median(steps.iter().map(|step| step.features.len() as f64)),
        shared_with_next: median(steps.windows(2).map(|pair| shared_points(&pair[0], &pair[1]) as f64)),
        score_same_place: median(same.iter().map(score)),
        score_twin_rooms: median(twins.iter().map(score)),
        score_elsewhere: median(elsewhere.map(|pair| score(&pair))),
        inliers_same_place: median(of_same.iter().map(|(_, inliers)| *inliers)),
        inliers_twin_rooms: median(of_twins.iter().map(|(_, inliers)| *inliers)),
        verified_twin_rooms: verified as f64 / of_twins.len().max(1) as f64,
    })
}

/// Whether these are the same views of two different rooms.
fn are_twins(plan: &FloorPlan, a: &Step, b: &Step) -> bool {
    let (Place::Room(of_a), Place::Room(of_b)) = (a.stop.place, b.stop.place) else { return false };
    let in_room = |step: &Step, room: usize| {
        let (door, at) = (plan.rooms[room].door, step.stop.stand.at);
        let (dx, dy) = (at[0] - door.origin[0], at[1] - door.origin[1]);
        let [fx, fy] = door.facing;
        ([dx * fy - dy * fx, dx * fx + dy * fy], step.stop.stand.heading_rad - door.heading_rad())
    };
    let ((at_a, heading_a), (at_b, heading_b)) = (in_room(a, of_a), in_room(b, of_b));
    of_a != of_b
        && (at_a[0] - at_b[0]).hypot(at_a[1] - at_b[1]) < TWIN_M
        && heading_difference_rad(heading_a, heading_b) < TWIN_RAD
}

fn words(vocabulary: &Vocabulary, step: &Step) -> Result<WordVector, DescriptorMismatch> {
    Ok(vocabulary.transform(DESCRIPTOR_BITS / 8, &descriptor_bytes(step), 0)?.words)
}

/// Returns whether Sim3 verifies two keyframes as one place, and its inliers.
fn verified(query: &Step, candidate: &Step) -> Option<(bool, f64)> {
    let [query, candidate] = [Matchable::of(query)?, Matchable::of(candidate)?];
    let result = verify(&query.view(), &candidate.view(), &[], &Limits::DEFAULT, 0);
    Some((result.status == GeometryStatus::Verified, f64::from(result.inliers)))
}

struct Matchable {
    keypoints: Vec<Keypoint>,
    descriptors: PackedDescriptors,
    points_in_camera: Vec<Option<Point3>>,
}

impl Matchable {
    fn of(step: &Step) -> Option<Self> {
        Some(Self {
            keypoints: step.features.iter().map(|feature| feature.keypoint).collect(),
            descriptors: PackedDescriptors::from_bytes(DESCRIPTOR_BITS / 8, &descriptor_bytes(step))?,
            points_in_camera: step.features.iter().map(|feature| Some(feature.in_camera)).collect(),
        })
    }

    fn view(&self) -> View<'_> {
        View {
            camera: CAMERA,
            keypoints: &self.keypoints,
            descriptors: &self.descriptors,
            nodes: None,
            points_in_camera: &self.points_in_camera,
        }
    }
}

fn median(figures: impl Iterator<Item = f64>) -> f64 {
    score::median(figures.collect()).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::super::floor_plan::Layout;
    use super::super::signs::SignPlan;
    use super::super::texture::Patterns;
    use super::super::world::{World, WorldPlan};
    use super::*;
    use crate::hotel::rng::SeededRng;
    use crate::hotel::route::tour;
    use crate::hotel::sensing::noise::Noise;

    #[test]
    fn the_hotel_is_as_confusing_as_it_says() {
        let patterns = Patterns::new();
        let plan = WorldPlan { layout: Layout::SE1, floor: 9, signs: SignPlan::default(), seed: 901 };
        let world = World::new(&plan, &patterns);
        let stops = tour(&world.plan, &[3, 6, 3], &mut SeededRng::new(1, "route"));
        let journey = Sequence::record(&world, &stops, Noise::default(), 0.5, 1);
        let vocabulary = patterns.vocabulary().expect("a vocabulary");
        let realism = measure(&world.plan, &journey, &vocabulary).expect("descriptors of one length");
        let check = |name: &str, figure: f64, range: std::ops::Range<f64>| {
            assert!(range.contains(&figure), "{name}: {figure} is not in {range:?}\n{realism:#?}");
        };
        check("features", realism.features, 200.0..400.1);
        check("shared with the next", realism.shared_with_next, 80.0..300.0);
        check("score of one place", realism.score_same_place, 0.15..0.45);
        check("score of twin rooms", realism.score_twin_rooms, 0.08..0.30);
        check("twins against one place", realism.score_twin_rooms / realism.score_same_place, 0.4..1.0);
        check("score elsewhere", realism.score_elsewhere, 0.0..0.10);
        check("inliers of one place", realism.inliers_same_place, 80.0..350.0);
        check("inliers of twin rooms", realism.inliers_twin_rooms, 40.0..350.0);
        check("twin rooms that verify", realism.verified_twin_rooms, 0.7..1.01);
    }
}
