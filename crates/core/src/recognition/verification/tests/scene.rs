//! Drawn places, and keyframes that see them with noise.

use nalgebra::{UnitQuaternion, Vector3};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::super::View;
use crate::domain::keyframe::{Camera, Keypoint};
use crate::geometry::Point3;
use crate::geometry::Sim3;
use crate::geometry::hamming::PackedDescriptors;

const CAMERA: Camera = Camera { fx: 500.0, fy: 500.0, cx: 320.0, cy: 240.0, width: 640, height: 480 };
const BYTES: usize = 32;

pub fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// `world_from_camera` of a camera turned to its right by `yaw` radians.
pub fn from_yaw(yaw: f64, centre: [f64; 3]) -> Sim3 {
    Sim3::from_parts(1.0, UnitQuaternion::from_axis_angle(&Vector3::y_axis(), yaw), centre.into())
}

/// Points with descriptors.
#[derive(Clone)]
pub struct Scene {
    pub points: Vec<Point3>,
    pub descriptors: Vec<[u8; BYTES]>,
    pub point_noise_m: f64,
}

impl Scene {
    fn new(seed: u64, points: Vec<Point3>) -> Self {
        let mut rng = rng(seed ^ 0xde5c);
        let descriptors = points.iter().map(|_| rng.random()).collect();
        Self { points, descriptors, point_noise_m: 0.01 }
    }

    /// Returns a room of 6 m by 3 m, with things standing about, before a camera at the origin that looks along z.
    pub fn room(seed: u64, count: usize) -> Self {
        let mut rng = rng(seed);
        let mut draw = || {
            let (x, y, z) =
                (rng.random_range(-3.0..3.0), rng.random_range(-1.5..1.5), rng.random_range(2.0..6.0));
            if rng.random_bool(0.5) { Point3::new(x, y, 6.0) } else { Point3::new(x, y, z) }
        };
        Self::new(seed, (0..count).map(|_| draw()).collect())
    }

    /// One flat wall, 4 m before the origin.
    pub fn wall(seed: u64, count: usize) -> Self {
        let mut rng = rng(seed);
        let mut draw = || Point3::new(rng.random_range(-2.5..2.5), rng.random_range(-1.5..1.5), 4.0);
        Self::new(seed, (0..count).map(|_| draw()).collect())
    }

    pub fn moved(&self, by: &Sim3) -> Self {
        Self { points: self.points.iter().map(|point| by.transform(point)).collect(), ..self.clone() }
    }

    /// Returns what a camera sees: pixels off by up to a pixel, points by a little, descriptors by some bits. One
    /// feature in five has no position.
    pub fn seen_from(&self, world_from_camera: &Sim3, seed: u64) -> Keyframe {
        let mut rng = rng(seed);
        let mut seen = Keyframe { from_world: world_from_camera.inverse(), ..Keyframe::default() };
        let mut bytes = Vec::new();
        for (landmark, (point, descriptor)) in self.points.iter().zip(&self.descriptors).enumerate() {
            let mut noise = |size: f64| rng.random_range(-size..size);
            let pixel_noise = [noise(1.0), noise(1.0)];
            let noise_m = Vector3::new(noise(1.0), noise(1.0), noise(1.0)) * self.point_noise_m;
            let flipped: [usize; 12] = std::array::from_fn(|_| rng.random_range(0..8 * BYTES));
            let has_position = rng.random_bool(0.8);
            let p = seen.from_world.transform(point);
            let (u, v) = (CAMERA.fx * p.x / p.z + CAMERA.cx, CAMERA.fy * p.y / p.z + CAMERA.cy);
            if p.z < 0.5 || !(0.0..640.0).contains(&u) || !(0.0..480.0).contains(&v) {
                continue;
            }
            let mut descriptor = *descriptor;
            for bit in flipped {
                descriptor[bit / 8] ^= 1 << (bit % 8);
            }
            bytes.extend(descriptor);
            let [du, dv] = pixel_noise;
            seen.keypoints.push(Keypoint { u: u + du, v: v + dv, octave: 0, angle_deg: None });
            seen.points_in_camera.push(has_position.then(|| p + noise_m));
            seen.landmarks.push(Some(landmark));
        }
        seen.descriptors = PackedDescriptors::from_bytes(BYTES, &bytes).expect("whole descriptors");
        seen
    }
}

/// A keyframe, and where it was taken.
#[derive(Clone)]
pub struct Keyframe {
    pub from_world: Sim3,
    pub keypoints: Vec<Keypoint>,
    pub descriptors: PackedDescriptors,
    pub points_in_camera: Vec<Option<Point3>>,
    pub landmarks: Vec<Option<usize>>,
}

impl Default for Keyframe {
    fn default() -> Self {
        Self {
            from_world: Sim3::identity(),
            keypoints: Vec::new(),
            descriptors: PackedDescriptors::default(),
            points_in_camera: Vec::new(),
            landmarks: Vec::new(),
        }
    }
}

impl Keyframe {
    pub fn view(&self) -> View<'_> {
        View {
            camera: CAMERA,
            keypoints: &self.keypoints,
            descriptors: &self.descriptors,
            nodes: None,
            points_in_camera: &self.points_in_camera,
        }
    }

    /// Gives a share of the features each other's descriptors.
    pub fn shuffle_descriptors(&mut self, share: f64, seed: u64) {
        let mut rng = rng(seed);
        let mut order: Vec<usize> = (0..self.keypoints.len()).collect();
        let mut chosen = order.clone();
        chosen.shuffle(&mut rng);
        chosen.truncate((order.len() as f64 * share) as usize);
        for (i, &at) in chosen.iter().enumerate() {
            order[at] = chosen[(i + 1) % chosen.len()];
        }
        let bytes: Vec<u8> = order
            .iter()
            .flat_map(|&at| {
                self.descriptors.get(at).iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<_>>()
            })
            .collect();
        self.descriptors = PackedDescriptors::from_bytes(BYTES, &bytes).expect("whole descriptors");
    }
}
