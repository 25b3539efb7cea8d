//! Witness: what a text without an identifier needs besides itself to close a loop (`contract.md` §8.14).
//!
//! A slogan, a brand or a kind of room hangs in many places, and the first time that it is met in a second one nothing
//! tells that from a return. So it speaks only beside a matched identifier, along an unbroken odometry chain that has the
//! two sightings at one place, or under geometry on map points. Such texts do not witness each other.

use super::alignment::Compared;
use super::anchor_map::LocalAnchor;
use super::comparison::Comparison;
use super::tracked_path::TrackedPath;

/// Two sightings of one sign lie this far apart in the frame of a robot that has not moved, in metres (`odometry_slack_m`).
const SLACK_M: f64 = 1.0;
/// And by this share of the way between them more (`odometry_max_drift_share`).
const DRIFT_SHARE: f64 = 0.05;

/// Whether all that agrees are pairs of texts that need a witness.
pub fn lacks_witness(comparison: &Comparison<'_>) -> bool {
    let needs = |anchor: &LocalAnchor| anchor.text.as_ref().is_some_and(|text| text.needs_witness());
    comparison.matches.iter().all(|pair| (needs(pair.query) && needs(pair.candidate)) || pair.is_disputed)
}

/// Whether odometry has every matched pair at one place.
pub fn odometry_agrees(path: &TrackedPath, compared: &Compared) -> bool {
    let limit_m = DRIFT_SHARE.mul_add(path.length_m, SLACK_M);
    compared.largest_distance_m().is_some_and(|apart_m| apart_m <= limit_m)
}
