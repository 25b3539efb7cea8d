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

/// The places of two anchors relative to each other.
#[derive(Clone, Debug)]
enum Placement {
    /// At the same place.
    Same,
    /// Too far apart for that.
    Apart {
        /// By how much, in metres or radians.
        measured: f64,
        /// The least that is no longer the same place.
        limit: f64,
        /// The figure for a person: "2.3 m".
        told: String,
    },
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
        let placements: Vec<Placement> = alike.map(|b| relative_placement(a, b, settings)).collect();
        let excess = |placement: &Placement| match placement {
            Placement::Same => 0.0,
            Placement::Apart { measured, limit, .. } => measured / limit,
        };
        let nearest = placements.into_iter().min_by(|a, b| excess(a).total_cmp(&excess(b)))?;
        let name = a.description.as_deref().unwrap_or(&a.class);
        match nearest {
            Placement::Same => None,
            Placement::Apart { told, .. } => Some((format!("\u{201c}{name}\u{201d}"), told)),
        }
    })
}

/// Returns where two anchors stand to each other by bearing and distance (§V-B).
fn relative_placement(a: &LocalAnchor, b: &LocalAnchor, settings: &Settings) -> Placement {
    if same_relative_place(a, b, settings) {
        return Placement::Same;
    }
    let distance_m = a.bearing.distance_difference_m(&b.bearing);
    let limit_m = settings.anchor_map_max_distance_difference_m;
    let angle_rad = a.bearing.angle_difference_rad(&b.bearing);
    let limit_rad = settings.anchor_map_max_angle_difference_rad;
    if distance_m >= limit_m && a.is_measured_with(b) {
        let told =
            format!("{distance_m:.2} m nearer or farther, and less than {limit_m:.2} m is the same place");
        Placement::Apart { measured: distance_m, limit: limit_m, told }
    } else {
        let told = format!("{angle_rad:.2} rad aside, and less than {limit_rad:.2} rad is the same place");
        Placement::Apart { measured: angle_rad, limit: limit_rad, told }
    }
}
