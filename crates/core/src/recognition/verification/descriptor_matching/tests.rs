//! Matches against a plain double loop.

use proptest::prelude::*;

use super::*;
use crate::geometry::hamming::distance;

const ALL: MatchingLimits =
    MatchingLimits { max_distance: 1.0, max_ratio: 1.0, mutual: false, orientation: false };

/// Descriptors of two words with few bits set, so that distances tie.
fn packed(words: &[(u64, u64)]) -> PackedDescriptors {
    let bytes: Vec<u8> =
        words.iter().flat_map(|(a, b)| [a.to_le_bytes(), b.to_le_bytes()].concat()).collect();
    PackedDescriptors::from_bytes(16, &bytes).expect("two words each")
}

fn keypoints(count: usize) -> Vec<Keypoint> {
    vec![Keypoint { u: 0.0, v: 0.0, octave: 0, angle_deg: None }; count]
}

/// What the documentation says, as slowly as possible.
fn plainly(query: &Side, candidate: &Side, limits: &MatchingLimits) -> Vec<Match> {
    let bits = f64::from(query.descriptors.bits());
    let node = |side: &Side, feature: u32| side.nodes.map(|nodes| nodes[feature as usize]);
    let guided = query.nodes.is_some() && candidate.nodes.is_some();
    let near = |from: &Side, feature: u32, to: &Side| -> Vec<(u32, u32)> {
        let one = from.descriptors.get(feature as usize);
        let same = |&&other: &&u32| {
            !guided
                || (node(from, feature) == node(to, other)
                    && node(from, feature).is_some_and(|node| node != NO_NODE))
        };
        let mut all: Vec<_> = to
            .features
            .iter()
            .filter(same)
            .map(|&other| (distance(one, to.descriptors.get(other as usize)), other))
            .collect();
        all.sort_unstable();
        all
    };
    let mut found = Vec::new();
    for &feature in query.features {
        let ranked = near(query, feature, candidate);
        let Some(&(best, other)) = ranked.first() else { continue };
        let is_clear =
            ranked.get(1).is_none_or(|&(second, _)| f64::from(best) < limits.max_ratio * f64::from(second));
        let is_mutual = !limits.mutual || near(candidate, other, query)[0].1 == feature;
        if f64::from(best) <= limits.max_distance * bits && is_clear && is_mutual {
            found.push(Match { query: feature, candidate: other, distance: best });
        }
    }
    found
}

fn some_side() -> impl Strategy<Value = (Vec<(u64, u64)>, Vec<u32>, Vec<bool>)> {
    (0..40usize).prop_flat_map(|count| {
        let node = prop_oneof![4 => 0..4u32, 1 => Just(NO_NODE)];
        (
            prop::collection::vec((0..256u64, 0..16u64), count),
            prop::collection::vec(node, count),
            prop::collection::vec(prop::bool::weighted(0.8), count),
        )
    })
}

proptest! {
    #[test]
    fn matches_are_those_of_a_double_loop(
        (words_a, nodes_a, keep_a) in some_side(), (words_b, nodes_b, keep_b) in some_side(),
        (max_distance, max_ratio, mutual, guided) in (0.0..0.2f64, 0.5..1.0f64, any::<bool>(), any::<bool>()),
    ) {
        let chosen = |keep: &[bool]| -> Vec<u32> {
            (0..keep.len() as u32).filter(|&i| keep[i as usize]).collect()
        };
        let (a, b) = (packed(&words_a), packed(&words_b));
        let (points_a, points_b) = (keypoints(words_a.len()), keypoints(words_b.len()));
        let (features_a, features_b) = (chosen(&keep_a), chosen(&keep_b));
        let side = |descriptors, keypoints, nodes, features| Side { descriptors, keypoints, nodes, features };
        let query = side(&a, points_a.as_slice(), guided.then_some(nodes_a.as_slice()), features_a.as_slice());
        let candidate = side(&b, points_b.as_slice(), guided.then_some(nodes_b.as_slice()), features_b.as_slice());
        let limits = MatchingLimits { max_distance, max_ratio, mutual, orientation: false };
        let words_differ = a.words_each() != b.words_each();
        let expected = if words_differ { Vec::new() } else { plainly(&query, &candidate, &limits) };
        prop_assert_eq!(match_descriptors(&query, &candidate, &limits), expected);
    }
}

#[test]
fn nodes_guide_only_where_both_sides_have_them() {
    let (a, b) = (packed(&[(0b1111, 0)]), packed(&[(0b1111, 0), (0b0111, 0)]));
    let (points_a, points_b) = (keypoints(1), keypoints(2));
    let query = Side { descriptors: &a, keypoints: &points_a, nodes: Some(&[7]), features: &[0] };
    let candidate = Side { descriptors: &b, keypoints: &points_b, nodes: Some(&[3, 7]), features: &[0, 1] };
    let other = |found: Vec<Match>| found.iter().map(|found| found.candidate).collect::<Vec<_>>();
    assert_eq!(other(match_descriptors(&query, &candidate, &ALL)), [1]);
    let unguided = Side { nodes: None, ..candidate };
    assert_eq!(other(match_descriptors(&query, &unguided, &ALL)), [0]);
}

#[test]
fn thresholds_are_not_truncated() {
    // 128 bits: a share of 0.02 is 2.56 bits, so two bits match and three do not.
    let (a, points) = (packed(&[(0, 0)]), keypoints(1));
    let limits = MatchingLimits { max_distance: 0.02, ..ALL };
    let matches = |bits: u64| {
        let b = packed(&[(bits, 0)]);
        let side = |descriptors| Side { descriptors, keypoints: &points, nodes: None, features: &[0] };
        match_descriptors(&side(&a), &side(&b), &limits).len()
    };
    assert_eq!((matches(0b11), matches(0b111)), (1, 0));
}
