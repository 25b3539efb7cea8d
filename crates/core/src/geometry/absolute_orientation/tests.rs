//! The closed form against its laws and against golden values.

use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

use super::*;
use crate::geometry::sim3::tests::any_sim3;

fn any_cloud() -> impl Strategy<Value = Vec<Point3>> {
    prop::collection::vec(prop::array::uniform3(-5.0..5.0f64).prop_map(Point3::from), 4..20)
}

fn width(points: &[Point3]) -> f64 {
    let mean = points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / points.len() as f64;
    let scatter: Matrix3<f64> =
        points.iter().map(|p| (p.coords - mean) * (p.coords - mean).transpose()).sum();
    let mut spread: Vec<f64> = scatter.symmetric_eigenvalues().iter().copied().collect();
    spread.sort_by(f64::total_cmp);
    spread[1].max(0.0).sqrt()
}

fn distance(a: &Sim3, b: &Sim3, points: &[Point3]) -> f64 {
    points.iter().map(|p| (a.transform(p) - b.transform(p)).norm()).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn a_planted_similarity_comes_back(planted in any_sim3(), cloud in any_cloud()) {
        prop_assume!(width(&cloud) > 0.5);
        let pairs: Vec<_> = cloud.iter().map(|p| (*p, planted.transform(p))).collect();
        let found = align(&pairs, Scale::Free).expect("a cloud with width");
        prop_assert!(distance(&found, &planted, &cloud) < 1e-7);
        let rigid = Sim3::from_parts(1.0, *planted.rotation(), planted.translation_m().into());
        let pairs: Vec<_> = cloud.iter().map(|p| (*p, rigid.transform(p))).collect();
        let found = align(&pairs, Scale::Fixed).expect("a cloud with width");
        prop_assert!(distance(&found, &rigid, &cloud) < 1e-7);
    }

    /// Moving either side by a similarity moves the answer by it, noise or not.
    #[test]
    fn the_estimate_is_equivariant(
        moved in any_sim3(), planted in any_sim3(), cloud in any_cloud(),
        noise in prop::collection::vec(prop::array::uniform3(-0.1..0.1f64), 20),
    ) {
        prop_assume!(width(&cloud) > 1.0);
        let noisy = |p: &Point3, i: usize| p + Vector3::from(noise[i]) * planted.scale();
        let pairs: Vec<_> =
            cloud.iter().enumerate().map(|(i, p)| (*p, noisy(&planted.transform(p), i))).collect();
        let found = align(&pairs, Scale::Free).expect("a cloud with width");
        let outer: Vec<_> = pairs.iter().map(|(a, b)| (*a, moved.transform(b))).collect();
        let found_outer = align(&outer, Scale::Free).expect("a cloud with width");
        prop_assert!(distance(&found_outer, &moved.after(&found), &cloud) < 1e-6);
        let inner: Vec<_> = pairs.iter().map(|(a, b)| (moved.transform(a), *b)).collect();
        let found_inner = align(&inner, Scale::Free).expect("a cloud with width");
        prop_assert!(distance(&found_inner.after(&moved), &found, &cloud) < 1e-6);
    }

    #[test]
    fn a_mirrored_cloud_still_gives_a_rotation(cloud in any_cloud()) {
        let pairs: Vec<_> = cloud.iter().map(|p| (*p, Point3::new(-p.x, p.y, p.z))).collect();
        if let Ok(found) = align(&pairs, Scale::Free) {
            let (linear, _) = found.linear_and_translation();
            prop_assert!(linear.determinant() > 0.0);
        }
    }
}

#[test]
fn points_on_a_line_or_in_one_place_are_refused() {
    let line: Vec<_> = (0..10).map(|i| Point3::new(f64::from(i), 2.0 * f64::from(i), 1.0)).collect();
    let pairs: Vec<_> = line.iter().map(|p| (*p, p + Vector3::new(0.3, 0.1, 7.0))).collect();
    assert_eq!(align(&pairs, Scale::Free), Err(Degenerate::Ambiguous));
    assert_eq!(align(&pairs, Scale::Fixed), Err(Degenerate::Ambiguous));
    let one = [(Point3::new(1.0, 2.0, 3.0), Point3::new(4.0, 5.0, 6.0)); 5];
    assert_eq!(align(&one, Scale::Fixed), Err(Degenerate::Coincident));
    assert_eq!(align(&one[..2], Scale::Fixed), Err(Degenerate::TooFew(2)));
    let far = [(Point3::new(1e200, 0.0, 0.0), Point3::new(0.0, 1e200, 0.0)), one[0], one[1]];
    assert_eq!(align(&far, Scale::Fixed), Err(Degenerate::NotFinite));
}

#[test]
#[ignore = "needs REVISIT_SHARED"]
fn golden_three_point_problems() {
    let shared =
        std::env::var_os("REVISIT_SHARED").expect("REVISIT_SHARED names the folder that holds golden/");
    let text =
        std::fs::read_to_string(Path::new(&shared).join("golden/sim3_horn.tsv")).expect("golden values");
    let (mut in_rotation, mut in_translation, mut in_scale) = (Vec::new(), Vec::new(), Vec::new());
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let v: Vec<f64> = line.split_whitespace().map(|v| v.parse().expect("a number")).collect();
        let point = |at: usize| Point3::new(v[at], v[at + 1], v[at + 2]);
        let pairs: Vec<_> = (0..3).map(|i| (point(10 + 3 * i), point(1 + 3 * i))).collect();
        let scale = if v[0] == 1.0 { Scale::Fixed } else { Scale::Free };
        let found = align(&pairs, scale).expect("three points that are no line");
        in_scale.push((found.scale() - v[19]).abs() / v[19]);
        let expected = Matrix3::from_row_slice(&v[20..29]);
        in_rotation.push((found.rotation().to_rotation_matrix().into_inner() - expected).abs().max());
        in_translation.push((Vector3::from(found.translation_m()) - point(29).coords).abs().max());
    }
    for (name, errors) in
        [("scale", &mut in_scale), ("rotation", &mut in_rotation), ("translation", &mut in_translation)]
    {
        errors.sort_by(f64::total_cmp);
        let (median, worst) = (errors[errors.len() / 2], errors[errors.len() - 1]);
        assert!(median < 5e-6 && worst < 5e-4, "{name}: median {median}, worst {worst}");
    }
    assert!(in_translation.len() >= 100);
}
