//! Held against how far the estimate really scatters.

use nalgebra::{UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::super::correspondence::Reprojection;
use super::super::limits::Limits;
use super::super::refinement::refine;
use super::*;
use crate::geometry::pinhole::Pinhole;

const CAMERA: Pinhole = Pinhole { fx: 500.0, fy: 500.0, cx: 320.0, cy: 240.0 };

/// The sum of twelve uniform numbers less six: as good as normal.
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random_range(-0.5..0.5)).sum()
}

/// Points that both sides have with an error of 2 cm, and see with one of a pixel.
fn drawn(truth: &Sim3, rng: &mut ChaCha8Rng) -> Vec<Correspondence> {
    let limits = Limits::DEFAULT;
    let mut pairs = Vec::new();
    while pairs.len() < 60 {
        let (x, y, z) =
            (rng.random_range(-2.0..2.0), rng.random_range(-1.5..1.5), rng.random_range(3.0..6.0));
        let in_query = Vector3::new(x, y, z);
        let in_candidate = truth.transform(&in_query.into()).coords;
        let mut into = |point: Vector3<f64>, seen: &Vector3<f64>| {
            let error_m = Vector3::new(normal(rng), normal(rng), normal(rng)) * 0.02;
            let [u, v] = CAMERA.project(seen).expect("in front");
            Reprojection {
                point: point + error_m,
                pixel: [u + normal(rng), v + normal(rng)],
                inverse_variance: limits.variance_px2(0).recip(),
                depth: None,
            }
        };
        pairs.push(Correspondence {
            into_query: Some(into(in_candidate, &in_query)),
            into_candidate: Some(into(in_query, &in_candidate)),
            distance: 10,
            query_feature: pairs.len() as u32,
            candidate_feature: Some(pairs.len() as u32),
        });
    }
    pairs
}

#[test]
fn it_is_how_far_the_estimate_scatters() {
    const DRAWS: u32 = 150;
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.2);
    let truth = Sim3::from_parts(1.0, turn, Vector3::new(0.6, -0.1, 0.4));
    let cameras = Cameras { query: CAMERA, candidate: CAMERA };
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let (mut scatter, mut told) = ([0.0; 6], [0.0; 6]);
    for _ in 0..DRAWS {
        let pairs = drawn(&truth, &mut rng);
        let places: Vec<u32> = (0..pairs.len() as u32).collect();
        let found = refine(&truth, &pairs, &places, &cameras, true);
        let covariance = covariance(&found, &pairs, &cameras, true).expect("sixty pairs");
        let moved = Vector3::from(found.translation_m()) - Vector3::from(truth.translation_m());
        let turned = (found.rotation() * truth.rotation().inverse()).scaled_axis();
        let off = [moved.x, moved.y, moved.z, turned.x, turned.y, turned.z];
        for i in 0..6 {
            scatter[i] += off[i] * off[i] / f64::from(DRAWS);
            told[i] += covariance[i * 6 + i] / f64::from(DRAWS);
        }
        assert!((0..6).all(|i| (0..6).all(|j| covariance[i * 6 + j] == covariance[j * 6 + i])));
    }
    // A variance from 150 draws is known to 12 %; three times that, and the pairs scatter, too.
    for i in 0..6 {
        let ratio = told[i] / scatter[i];
        assert!((0.6..1.6).contains(&ratio), "{i}: {ratio}: {told:?} {scatter:?}");
    }
}

#[test]
fn twice_the_pairs_halve_it_and_too_few_have_none() {
    let truth = Sim3::from_parts(1.0, UnitQuaternion::identity(), Vector3::new(0.2, 0.0, 0.1));
    let cameras = Cameras { query: CAMERA, candidate: CAMERA };
    let pairs = drawn(&truth, &mut ChaCha8Rng::seed_from_u64(2));
    let once = covariance(&truth, &pairs, &cameras, true).expect("sixty pairs");
    let twice = covariance(&truth, &[pairs.clone(), pairs.clone()].concat(), &cameras, true).expect("more");
    // By hand: 60 / 57 of the sandwich, against half of it times 120 / 117.
    let expected = 0.5 * (120.0 / 117.0) / (60.0 / 57.0);
    assert!((twice[0] / once[0] - expected).abs() < 1e-9);
    assert_eq!(covariance(&truth, &pairs[..3], &cameras, true), None);
}
