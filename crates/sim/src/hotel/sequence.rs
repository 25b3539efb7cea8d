//! Sequence: all sensor data of a robot's tour, with the truth.
//!
//! A journey is recorded once and then used by each arm of the experiment, so that all see the same data.

use super::building::signs::SignKind;
use super::building::world::World;
use super::rng::SeededRng;
use super::route::Stop;
use super::sensing::noise::Noise;
use super::sensing::ocr;
use super::sensing::odometry::{drifting_motions, integrate, scale_drift};
use super::sensing::reader::Reader;
use super::sensing::sensor::{Feature, SeenSign, take_image};
use super::sensing::tracking::Tracker;
use crate::geometry::{Point3, Pose};

/// The reader's confidence in a reading where there is no text.
const IMAGINED_CONFIDENCE: f64 = 0.7;

/// A detection as the robot sends it.
#[derive(Clone, Debug)]
pub struct Detection {
    /// Its class.
    pub class: &'static str,
    /// The detector's confidence.
    pub confidence: f64,
    /// `[x0, y0, x1, y1]`, in pixels.
    pub bounding_box: [f64; 4],
    /// The features on it.
    pub features: Vec<usize>,
    /// The reading or the description.
    pub text: String,
}

/// A map point that a keyframe places, for the first time or again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Its feature in the keyframe.
    pub feature: usize,
    /// Its position in the keyframe's camera frame: in metres by depth, in the robot's own unit by triangulation.
    pub in_camera: Point3,
}

/// The sensor data of a keyframe.
#[derive(Clone, Debug)]
pub struct Step {
    /// The truth: its pose and visit.
    pub stop: Stop,
    /// Its motion since the last keyframe by odometry, `previous_from_this`. The first one's is the identity.
    pub motion: Pose,
    /// Its corners.
    pub features: Vec<Feature>,
    /// The map point of each feature, as the robot's tracking numbers it.
    pub map_points: Vec<u64>,
    /// The map points that it places.
    pub placed: Vec<Placed>,
    /// Its signs.
    pub detections: Vec<Detection>,
}

/// One robot's tour.
#[derive(Clone, Debug)]
pub struct Sequence {
    /// The keyframes in order.
    pub steps: Vec<Step>,
    /// The units per metre of a robot without depth at each keyframe, relative to the first, as a natural logarithm
    /// ([`scale_drift`]).
    pub scale_drift: Vec<f64>,
}

impl Sequence {
    /// Records a tour through a world; odometry drifts by `drift_m`.
    pub fn record(world: &World, stops: &[Stop], noise: Noise, drift_m: f64, seed: u64) -> Self {
        Self::through(|_| world, stops, noise, drift_m, seed)
    }

    /// Records a tour through a world that changes between visits; no sign is added or removed.
    pub fn through<'a>(
        world_at: impl Fn(usize) -> &'a World,
        stops: &[Stop],
        noise: Noise,
        drift_m: f64,
        seed: u64,
    ) -> Self {
        let truth: Vec<Pose> = stops.iter().map(|stop| stop.stand.map_from_camera()).collect();
        let motions = drifting_motions(&truth, drift_m, &mut SeededRng::new(seed, "odometry"));
        let motions = std::iter::once(Pose::identity()).chain(motions);
        let mut sensor = SeededRng::new(seed, "sensor");
        let mut reading = SeededRng::new(seed, "reader");
        let (mut tracker, mut reader) = (Tracker::default(), Reader::new(noise));
        let mut plates = SeededRng::new(seed, "plates");
        let missing: Vec<bool> = (world_at(0).signs.iter())
            .map(|sign| plates.happens(noise.no_plate_share) && sign.kind == SignKind::DoorPlate)
            .collect();
        let scale_drift = scale_drift(&truth, &mut SeededRng::new(seed, "scale"));
        let steps = (stops.iter().zip(motions).enumerate()).map(|(number, (stop, motion))| {
            let world = world_at(stop.visit);
            let image = take_image(world, &stop.stand, noise.missed_share, &mut sensor);
            let (mut map_points, mut placed) = (Vec::new(), Vec::new());
            for (place, feature) in image.features.iter().enumerate() {
                let (id, is_new) = tracker.observe(feature.point, number);
                map_points.push(id);
                // A new map point stands at its depth.
                placed.extend(is_new.then_some(Placed { feature: place, in_camera: feature.in_camera }));
            }
            let seen = image.signs.into_iter().filter(|seen| !missing[seen.sign]);
            let mut detections: Vec<Detection> = seen
                .filter_map(|SeenSign { sign, bounding_box, confidence, features }| {
                    let (class, text) =
                        reader.detect(sign, &world.signs[sign], bounding_box, stop.visit, &mut reading)?;
                    Some(Detection { class, confidence, bounding_box, features, text })
                })
                .collect();
            let imagined = reader.imagine(&mut reading).into_iter();
            detections.extend(imagined.map(|(text, bounding_box)| Detection {
                class: ocr::CLASS,
                confidence: IMAGINED_CONFIDENCE,
                bounding_box,
                features: features_in(&image.features, bounding_box),
                text,
            }));
            Step { stop: *stop, motion, features: image.features, map_points, placed, detections }
        });
        Self { steps: steps.collect(), scale_drift }
    }

    /// Returns the true poses of its keyframes, `map_from_camera`.
    pub fn true_poses(&self) -> Vec<Pose> {
        self.steps.iter().map(|step| step.stop.stand.map_from_camera()).collect()
    }

    /// Returns its floor, of several identical-looking ones.
    pub fn storey(&self) -> usize {
        self.steps.first().map_or(0, |step| step.stop.storey)
    }
}

/// Returns the poses of keyframes by odometry alone, in the frame of the first one's camera.
pub fn by_odometry(steps: &[Step]) -> Vec<Pose> {
    let motions: Vec<Pose> = steps.iter().skip(1).map(|step| step.motion).collect();
    integrate(&motions)
}

/// Returns the indices of the features in a box, `[x0, y0, x1, y1]` in pixels.
fn features_in(features: &[Feature], [x0, y0, x1, y1]: [f64; 4]) -> Vec<usize> {
    let is_in = |feature: &Feature| {
        (x0..=x1).contains(&feature.keypoint.u) && (y0..=y1).contains(&feature.keypoint.v)
    };
    features.iter().enumerate().filter(|(_, feature)| is_in(feature)).map(|(place, _)| place).collect()
}
