//! Eq. (2) of §V-B: S, the weight of matching anchors over the weight of all anchors of both local maps.

use super::assignment::{Edge, assign};
use crate::domain::settings::Settings;

/// Returns S: the summed weight of matching pairs over the weight of all anchors of both maps; 0 without anchors.
pub(in crate::recognition) fn similarity(matching_weight: f64, total_weight: f64) -> f64 {
    if total_weight > 0.0 { matching_weight / total_weight } else { 0.0 }
}

/// Whether S says that the two places are one: it exceeds the threshold tau, strictly.
pub(in crate::recognition) fn passes(similarity: f64, settings: &Settings) -> bool {
    similarity > settings.anchor_map_min_similarity
}

/// Returns the pairs that Eq. (2) sums: one-to-one by maximum weight, or, to the paper's letter, all with x(i, j) = 1.
/// `pairs` are those, each with its weight, ascending.
pub(in crate::recognition) fn summed_pairs(pairs: Vec<Edge>, settings: &Settings) -> Vec<(usize, usize)> {
    if settings.is_ours() {
        return assign(&pairs);
    }
    pairs.into_iter().map(|(i, j, _)| (i, j)).collect()
}

/// Returns the sum of weights. (`Iterator::sum` of no floats is -0, which a reader would be shown.)
pub(in crate::recognition) fn total(weights: impl Iterator<Item = f64>) -> f64 {
    weights.fold(0.0, |sum, weight| sum + weight)
}
