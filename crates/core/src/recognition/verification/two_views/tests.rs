//! Planted motions of cameras that know no depth.

use nalgebra::{UnitQuaternion, Vector3};

use super::super::{Failure, Limits, Model, Verification, View};
use super::homography::Homography;
use super::image_model::ImageModel;
use super::pairs::TwoViews;
use super::rotation::Rotation;
use super::*;
use crate::domain::keyframe::{Camera, Keypoint};
use crate::domain::settings::GeometryAcceptance;
use crate::domain::verdict::GeometryStatus;
use crate::geometry::hamming::PackedDescriptors;
use crate::geometry::sampling::SplitMix64;
use crate::geometry::{Point3, Pose, Sim3};

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
    verify_two_views(&asked.view(), &stored.view(), &Limits::default(), 1)
}

#[test]
fn a_planted_motion_is_found_also_among_false_matches() {
    for false_every in [0, 4, 2] {
        let found = check(&room(1, 4.0), &moved(), false_every);
        assert_eq!(found.status, GeometryStatus::Verified, "{false_every}: {found:#?}");
        let (rotation_deg, direction_deg) = off(&found.candidate_from_query.unwrap(), &moved());
        assert!(rotation_deg < 1.0 && direction_deg < 4.0, "{false_every}: {rotation_deg}, {direction_deg}");
    }
}

#[test]
fn a_camera_that_only_turned_is_a_rotation_and_a_plane_a_homography() {
    for false_every in [0, 4, 2] {
        let found = check(&room(1, 4.0), &turned(), false_every);
        assert_eq!((found.status, found.model), (GeometryStatus::Verified, Model::Rotation), "{found:#?}");
        let transform = found.candidate_from_query.unwrap();
        assert!(off(&transform, &turned()).0 < 0.1, "{transform:?}");
        assert_eq!(transform.translation_m(), [0.0; 3], "nothing is known of it");
        let found = check(&room(1, 0.0), &moved(), false_every);
        assert_eq!((found.status, found.model), (GeometryStatus::Verified, Model::Homography), "{found:#?}");
        let found = check(&room(1, 4.0), &moved(), false_every);
        assert_eq!((found.status, found.model), (GeometryStatus::Verified, Model::Essential), "{found:#?}");
    }
}

#[test]
fn rooms_whose_features_match_by_chance_are_refused() {
    for seed in 0..5 {
        let asked = picture(&room(10 + seed, 4.0), 1_000, &moved(), 0, 5);
        let stored = picture(&room(20 + seed, 4.0), 1_000, &Pose::identity(), 0, 6);
        let found = verify_two_views(&asked.view(), &stored.view(), &Limits::default(), seed);
        assert_eq!(found.status, GeometryStatus::Failed, "{seed}: {found:#?}");
        assert_eq!(found, verify_two_views(&asked.view(), &stored.view(), &Limits::default(), seed));
    }
}

/// The same views with query and candidate exchanged.
fn swapped(scene: &[Point3], query: &Pose, noise: [u64; 2]) -> [Verification; 2] {
    let asked = picture(scene, 1_000, query, 4, noise[0]);
    let stored = picture(scene, 1_000, &Pose::identity(), 0, noise[1]);
    [
        verify_two_views(&asked.view(), &stored.view(), &Limits::default(), 1),
        verify_two_views(&stored.view(), &asked.view(), &Limits::default(), 1),
    ]
}

#[test]
fn exchanging_query_and_candidate_inverts_the_model() {
    for (depth_m, pose, model) in [
        (4.0, moved(), Model::Essential),
        (0.0, moved(), Model::Homography),
        (4.0, turned(), Model::Rotation),
    ] {
        for seed in 0..3 {
            let [there, back] = swapped(&room(30 + seed, depth_m), &pose, [seed, 90 + seed]);
            assert_eq!([there.model, back.model], [model; 2]);
            assert!(there.inliers.abs_diff(back.inliers) <= 4, "{there:?} {back:?}");
            if let Some((there, back)) = there.candidate_from_query.zip(back.candidate_from_query) {
                let whole_turn = (there.rotation() * back.rotation()).angle().to_degrees();
                assert!(whole_turn < 1.0, "{whole_turn}");
            }
        }
    }
}

#[test]
fn a_known_homography_is_recovered_from_four_points() {
    // By hand: (x, y) goes to (2x + 1, 2y) / (x + 2); the origin to (0.5, 0), (1, 0) to (1, 0), (0, 1) to (0.5, 1).
    let map = nalgebra::Matrix3::new(2.0, 0.0, 1.0, 0.0, 2.0, 0.0, 1.0, 0.0, 2.0);
    let sighting = |ray: Vector3<f64>| pairs::Sighting {
        ray: ray / ray.z,
        pixel: [525.0 * ray.x / ray.z, 525.0 * ray.y / ray.z],
        sigma_px: 1.0,
    };
    let pair = |x: f64, y: f64| {
        let ray = Vector3::new(x, y, 1.0);
        pairs::RayPair { query: sighting(ray), candidate: sighting(map * ray), distance: 1 }
    };
    let corners = [pair(0.0, 0.0), pair(1.0, 0.0), pair(0.0, 1.0), pair(1.0, 1.0)];
    assert!((corners[3].candidate.ray - Vector3::new(1.0, 2.0 / 3.0, 1.0)).norm() < 1e-12);
    let views = |pairs: &[pairs::RayPair]| TwoViews {
        pairs: pairs.to_vec(),
        query_focal_px: [525.0; 2],
        candidate_focal_px: [525.0; 2],
    };
    let of_corners = views(&corners);
    let found = [
        Homography::of_sample(&of_corners, &[0, 1, 2, 3]).expect("four corners"),
        Homography::fit(corners.iter().copied()).expect("four corners"),
    ];
    for found in found {
        let scaled = found.candidate_from_query * (map.determinant().cbrt());
        assert!((scaled - map).norm() < 1e-9, "{scaled}");
        // A tenth in x is 52.5 pixels in the candidate's image.
        let mut off = corners[0];
        off.candidate.ray.x += 0.1;
        let [_, in_candidate] = found.chi_squares(&of_corners, &off);
        assert!((in_candidate - 52.5 * 52.5).abs() < 1e-6, "{in_candidate}");
    }
    // Three on a line, and a corner seen from behind.
    let line = views(&[pair(0.0, 0.0), pair(0.5, 0.0), pair(1.0, 0.0), pair(0.0, 1.0)]);
    assert!(Homography::of_sample(&line, &[0, 1, 2, 3]).is_none());
    let mut mirrored = corners;
    for pair in &mut mirrored {
        pair.candidate.ray.x = -pair.candidate.ray.x;
    }
    assert!(Homography::of_sample(&views(&mirrored), &[0, 1, 2, 3]).is_none());
    // Two rays that are one leave the roll open.
    assert!(Rotation::of_sample(&views(&[corners[0]; 2]), &[0, 1]).is_none());
}

#[test]
fn a_homography_tells_the_motion_only_where_one_is_possible() {
    // Before a wall at z = 2, a metre to the side: H = R + t N^T / d with R = 1, t = (-1, 0, 0), N = (0, 0, 1), d = 2.
    let to_the_side = nalgebra::Matrix3::new(1.0, 0.0, -0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let rays = |half_width: f64| -> Vec<Vector3<f64>> {
        (-5..=5).map(|i| Vector3::new(f64::from(i) / 5.0 * half_width, 0.0, 1.0)).collect()
    };
    // The other motion takes the wall for one that leans by atan(1 / 0.5): seen from the front only by rays below x = 2
    // on its side.
    let found = decomposition::motion_of(&to_the_side, &rays(4.0)).expect("a wide view leaves one");
    assert!((Vector3::from(found.translation_m()) - Vector3::new(-1.0, 0.0, 0.0)).norm() < 1e-9, "{found:?}");
    assert!(found.rotation().angle() < 1e-9);
    assert_eq!(decomposition::motion_of(&to_the_side, &rays(0.2)), None, "a narrow one leaves two");
    assert_eq!(decomposition::motion_of(&nalgebra::Matrix3::identity(), &rays(4.0)), None, "no motion");
}

#[test]
fn matches_at_one_place_prove_nothing() {
    let found = check(&vec![Point3::new(0.5, 0.0, 5.0); 60], &turned(), 0);
    assert_ne!(found.status, GeometryStatus::Verified, "{found:#?}");
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_thread() {
    let asked = picture(&room(3, 4.0), 1_000, &moved(), 3, 5);
    let stored = picture(&room(3, 4.0), 1_000, &Pose::identity(), 0, 6);
    let bits = || format!("{:?}", verify_two_views(&asked.view(), &stored.view(), &Limits::default(), 9));
    let expected = bits();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(bits(), expected));
        }
    });
}

#[test]
fn the_count_of_the_letter_is_a_switch() {
    // Twelve points that both see: significant, and fewer than 20.
    let scene: Vec<Point3> = room(1, 4.0).into_iter().take(30).collect();
    let by = |acceptance: GeometryAcceptance| {
        let asked = picture(&scene, 1_000, &turned(), 2, 5);
        let stored = picture(&scene, 1_000, &Pose::identity(), 0, 6);
        let limits = Limits { acceptance, ..Limits::default() };
        verify_two_views(&asked.view(), &stored.view(), &limits, 1)
    };
    assert_eq!(by(GeometryAcceptance::Significance).status, GeometryStatus::Verified);
    let counted = by(GeometryAcceptance::Count);
    assert_eq!(counted.status, GeometryStatus::Failed, "{counted:#?}");
    assert!(matches!(counted.failure, Some(Failure::TooFewInliers { limit: 20, .. })));
}
