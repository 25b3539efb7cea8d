//! Why S is low: the anchor that is in both local maps and did not match, with the angle or the distance that failed.
//!
//! It explains a verdict and decides nothing. So only the heaviest anchors are looked at, which are the nearest ones.

use super::anchor_map::{LocalAnchor, LocalAnchorMap};
use super::comparison::Comparison;
use super::equation_1::{same_relative_place, similar};
use crate::domain::settings::Settings;
use crate::recognition::map::index::TextIndex;

/// Anchors of each map that are looked at, so that a hall full of plates costs no more than a corridor.
const EXPLAINED_MAX: usize = 16;

/// The difference that keeps two anchors from standing at the same relative place.
struct Apart {
    /// The difference over the least that is no longer the same place.
    excess: f64,
    /// The figure for a person: "2.3 m".
    told: String,
}

/// Says in one sentence why two local anchor maps agree too little.
pub fn explain_low_score(
    [query, candidate]: [&LocalAnchorMap; 2],
    comparison: &Comparison<'_>,
    texts: &TextIndex,
    settings: &Settings,
) -> String {
    if let Some((anchor, told)) = displaced(query, candidate, texts, settings) {
        return format!("{anchor} is in both, but {told}");
    }
    let agreeing = comparison.agreeing_weight();
    if agreeing > 0.0 {
        let total = comparison.total_weight;
        return format!("what agrees weighs {agreeing:.2} of {total:.2}");
    }
    String::from("nothing that is read in one is read in the other")
}

/// Returns the heaviest anchor that is in both maps and stands elsewhere, with what is off.
fn displaced(
    query: &LocalAnchorMap,
    candidate: &LocalAnchorMap,
    texts: &TextIndex,
    settings: &Settings,
) -> Option<(String, String)> {
    let of_candidate = candidate.heaviest(EXPLAINED_MAX);
    query.heaviest(EXPLAINED_MAX).into_iter().find_map(|a| {
        let alike = of_candidate.iter().filter(|b| similar(a, b, texts, settings).is_some());
        let excess = |apart: &Option<Apart>| apart.as_ref().map_or(0.0, |apart| apart.excess);
        let differences = alike.map(|b| apart(a, b, settings));
        let Apart { told, .. } = differences.min_by(|a, b| excess(a).total_cmp(&excess(b)))??;
        let name = a.description.as_deref().unwrap_or(&a.class);
        Some((format!("\u{201c}{name}\u{201d}"), told))
    })
}

/// Returns what is off between two anchors by bearing or distance (§V-B); none if they stand at the same relative place.
fn apart(a: &LocalAnchor, b: &LocalAnchor, settings: &Settings) -> Option<Apart> {
    if same_relative_place(a, b, settings) {
        return None;
    }
    let distance_m = a.bearing.distance_difference_m(&b.bearing);
    let limit_m = settings.anchor_map_max_distance_difference_m;
    let angle_rad = a.bearing.angle_difference_rad(&b.bearing);
    let limit_rad = settings.anchor_map_max_angle_difference_rad;
    if distance_m >= limit_m && a.is_measured_with(b) {
        let told =
            format!("{distance_m:.2} m nearer or farther, and less than {limit_m:.2} m is the same place");
        Some(Apart { excess: distance_m / limit_m, told })
    } else {
        let told = format!("{angle_rad:.2} rad aside, and less than {limit_rad:.2} rad is the same place");
        Some(Apart { excess: angle_rad / limit_rad, told })
    }
}
