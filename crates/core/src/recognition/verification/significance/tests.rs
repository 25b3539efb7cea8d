//! Numbers computed by hand, and what must hold for all.

use proptest::prelude::*;

use super::*;

fn is_near(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 1e-9 * (1.0 + expected.abs())
}

#[test]
fn false_alarms_are_those_computed_by_hand() {
    // C(4, 2) = 6 samples; both others agree by chance once in a hundred: 6 * 0.1^2.
    assert!(is_near(log10_false_alarms(4, 4, 2, 0.1), 0.06_f64.log10()));
    // One of the two or both: 6 * (2 * 0.1 * 0.9 + 0.1^2) = 1.14, which proves nothing.
    assert_eq!(log10_false_alarms(4, 3, 2, 0.1), 0.0);
    // C(10, 3) = 120; at least six of seven: 120 * (7 * 0.01^6 * 0.99 + 0.01^7).
    let tail: f64 = 7.0 * 1e-12 * 0.99 + 1e-14;
    assert!(is_near(log10_false_alarms(10, 9, 3, 0.01), (120.0 * tail).log10()));
    // What defines the model says nothing, nor does what every model explains.
    assert_eq!(log10_false_alarms(10, 3, 3, 0.01), 0.0);
    assert_eq!(log10_false_alarms(10, 10, 3, 1.0), 0.0);
    assert_eq!(log10_false_alarms(0, 0, 3, 0.5), 0.0);
}

fn at(u: f64, v: f64, is_inlier: bool) -> ImageMatch {
    ImageMatch { pixels: [[u, v]; 2], agreeing_area_px2: [100.0, 50.0], distance: 7, is_inlier }
}

#[test]
fn one_corner_found_in_several_octaves_counts_once() {
    // Cells of 16 pixels: the second lies in the cell of the first, the third in the next.
    let corners = [at(0.0, 0.0, true), at(15.0, 3.0, true), at(17.0, 3.0, false), at(100.0, 50.0, true)];
    let found = weigh(&corners, 2);
    // They span 100 by 50 pixels, of which a match agrees in 100.
    assert_eq!(found, Evidence { matches: 3, inliers: 2, sample: 2, chance: 0.02 });
    // Of two in one cell the nearer descriptors speak.
    let nearer = ImageMatch { distance: 6, ..corners[1] };
    let outlier = ImageMatch { is_inlier: false, ..corners[0] };
    assert_eq!(weigh(&[outlier, nearer, corners[3]], 2).inliers, 2);
}

#[test]
fn matches_at_one_place_prove_nothing() {
    let same = vec![at(10.0, 10.0, true); 50];
    assert_eq!(weigh(&same, 2).log10_false_alarms(), 0.0);
    assert_eq!(weigh(&[], 2).log10_false_alarms(), 0.0);
    let line: Vec<_> = (0..50).map(|i| at(f64::from(i) * 20.0, 10.0, true)).collect();
    assert_eq!(weigh(&line, 2).log10_false_alarms(), 0.0, "a line spans no area");
}

#[test]
fn the_fewest_that_reach_the_level_are_told() {
    let evidence = Evidence { matches: 100, inliers: 8, sample: 4, chance: 1e-3 };
    let least = evidence.least_inliers(-6.0).expect("some do");
    assert!(log10_false_alarms(100, least, 4, 1e-3) <= -6.0);
    assert!(log10_false_alarms(100, least - 1, 4, 1e-3) > -6.0);
    assert_eq!(evidence.accept(-6.0), Err(Failure::TooFewInliers { inliers: 8, limit: least }));
    let hopeless = Evidence { matches: 5, inliers: 5, sample: 4, chance: 0.5 };
    assert_eq!(hopeless.least_inliers(-6.0), None);
    assert_eq!(hopeless.accept(-6.0), Err(Failure::TooFewInliers { inliers: 5, limit: 6 }));
}

proptest! {
    #[test]
    fn more_inliers_are_never_less_significant(
        matches in 1..2_000u32, inliers in 0..2_000u32, sample in 2..9u32, chance in 1e-9..0.999f64,
    ) {
        let inliers = inliers.min(matches.saturating_sub(1));
        let (fewer, more) = (
            log10_false_alarms(matches, inliers, sample, chance),
            log10_false_alarms(matches, inliers + 1, sample, chance),
        );
        prop_assert!(more <= fewer + 1e-9, "{more} {fewer}");
        prop_assert!(fewer <= 0.0 && !fewer.is_nan());
    }

    #[test]
    fn a_tail_is_the_sum_of_its_terms(count in 1..40u32, least in 0..40u32, chance in 0.01..0.99f64) {
        let least = least.min(count);
        let choose = |k: u32| (0..k).fold(1.0, |product, i| product * f64::from(count - i) / f64::from(i + 1));
        let term = |k: u32| choose(k) * chance.powi(k as i32) * (1.0 - chance).powi((count - k) as i32);
        let expected: f64 = (least..=count).map(term).sum();
        prop_assert!((ln_binomial_tail(count, least, chance).exp() - expected).abs() < 1e-9);
    }
}
