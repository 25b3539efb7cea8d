//! Planted motions of cameras that know no depth.

use super::*;
use crate::geometry::hamming::PackedDescriptors;
use crate::geometry::{Point3, Pose};
use crate::model::keyframe::{Camera, Keypoint};

const CAMERA: Camera = Camera { fx: 525.0, fy: 525.0, cx: 320.0, cy: 240.0, width: 640, height: 480 };

struct Picture {
    keypoints: Vec<Keypoint>,
    descriptors: PackedDescriptors,
    points: Vec<Option<Point3>>,
}

impl Picture {
    fn view(&self) -> View<'_> {
        View {
            camera: CAMERA,
            keypoints: &self.keypoints,
            descriptors: &self.descriptors,
            nodes: None,
            points_in_camera: &self.points,
        }
    }
}

fn unit(random: &mut SplitMix64) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// The scene seen by a camera, with noise of up to half a pixel; of `false_every` points one is seen elsewhere.
fn picture(
    scene: &[Point3],
    names: u64,
    world_from_camera: &Pose,
    false_every: usize,
    noise: u64,
) -> Picture {
    let mut random = SplitMix64::new(noise);
    let (mut keypoints, mut bytes) = (Vec::new(), Vec::new());
    for (number, point) in scene.iter().enumerate() {
        let seen = world_from_camera.inverse_transform(point);
        let mut jitter = || unit(&mut random) - 0.5;
        let (mut u, mut v) =
            (seen.x / seen.z * 525.0 + 320.0 + jitter(), seen.y / seen.z * 525.0 + 240.0 + jitter());
        if false_every > 0 && number % false_every == 0 {
            (u, v) = ((jitter() + 0.5) * 640.0, (jitter() + 0.5) * 480.0);
        }
        keypoints.push(Keypoint { u, v, octave: 0, angle_deg: None });
        let mut name = SplitMix64::new(names + number as u64);
        bytes.extend((0..4).flat_map(|_| name.next_u64().to_le_bytes()));
    }
    let points = vec![None; keypoints.len()];
    Picture { keypoints, descriptors: PackedDescriptors::from_bytes(32, &bytes).unwrap(), points }
}

fn room(seed: u64, depth_m: f64) -> Vec<Point3> {
    let mut random = SplitMix64::new(seed);
    let mut draw = || unit(&mut random);
    (0..120).map(|_| Point3::new(draw() * 5.0 - 2.5, draw() * 3.0 - 1.5, 3.0 + draw() * depth_m)).collect()
}

fn moved() -> Pose {
    let half = 6.0_f64.to_radians() / 2.0;
    Pose::new([0.5, 0.05, 0.2], [0.0, half.sin(), 0.0, half.cos()]).unwrap()
}

fn turned() -> Pose {
    let half = 12.0_f64.to_radians() / 2.0;
    Pose::new([0.0; 3], [0.0, half.sin(), 0.0, half.cos()]).unwrap()
}

/// Degrees between two rotations, and between two directions.
fn off(found: &Sim3, planted: &Pose) -> (f64, f64) {
    let [x, y, z, w] = planted.rotation_xyzw();
    let planted_rotation = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
    let direction = Vector3::from(found.translation_m());
    let angle = direction.angle(&Vector3::from(planted.translation_m()));
    (found.rotation().angle_to(&planted_rotation).to_degrees(), angle.to_degrees())
}

fn check(scene: &[Point3], query: &Pose, false_every: usize) -> Verification {
    let asked = picture(scene, 1_000, query, false_every, 5);
    let stored = picture(scene, 1_000, &Pose::identity(), 0, 6);
    verify_essential(&asked.view(), &stored.view(), &Limits::default(), 1)
}

#[test]
fn a_planted_motion_is_found_also_among_false_matches() {
    for false_every in [0, 4, 2] {
        let found = check(&room(1, 4.0), &moved(), false_every);
        assert_eq!(found.status, Status::Verified, "{false_every}: {found:#?}");
        let (rotation_deg, direction_deg) = off(&found.candidate_from_query.unwrap(), &moved());
        assert!(rotation_deg < 1.0 && direction_deg < 4.0, "{false_every}: {rotation_deg}, {direction_deg}");
    }
}

#[test]
fn a_camera_that_only_turned_and_a_plane_are_refused() {
    let found = check(&room(1, 4.0), &turned(), 0);
    assert_eq!(found.status, Status::Failed, "{found:#?}");
    let found = check(&room(1, 0.0), &moved(), 0);
    assert_eq!(found.status, Status::Failed, "{found:#?}");
}

#[test]
fn rooms_whose_features_match_by_chance_are_refused() {
    for seed in 0..5 {
        let asked = picture(&room(10 + seed, 4.0), 1_000, &moved(), 0, 5);
        let stored = picture(&room(20 + seed, 4.0), 1_000, &Pose::identity(), 0, 6);
        let found = verify_essential(&asked.view(), &stored.view(), &Limits::default(), seed);
        assert_eq!(found.status, Status::Failed, "{seed}: {found:#?}");
        assert_eq!(found, verify_essential(&asked.view(), &stored.view(), &Limits::default(), seed));
    }
}
