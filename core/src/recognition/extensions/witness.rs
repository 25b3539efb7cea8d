//! Witness: what a text without an identifier needs besides itself to close a loop (M22).
//!
//! A slogan, a brand or a kind of room hangs in many places, and the first time that it is met in a second one nothing
//! tells that from a return. So it speaks only beside a matched identifier, along an unbroken odometry chain that has the
//! two sightings at one place, under geometry on map points, or where a confirmed loop already joins the passages. Such texts
//! do not witness each other.

use super::alignment::Compared;
use super::closed_return::joining_loop;
use super::tracked_path::{TrackedPath, drift_m};
use crate::domain::settings::Settings;
use crate::recognition::loops::anchor_map::LocalAnchor;
use crate::recognition::loops::comparison::Comparison;
use crate::recognition::loops::query::Query;
use crate::recognition::loops::screening::{CandidateStage, PreVerified};
use crate::recognition::map::index::MapIndex;

/// Whether all that agrees are pairs of texts that need a witness.
pub fn lacks_witness(comparison: &Comparison<'_>) -> bool {
    let needs = |anchor: &LocalAnchor| {
        anchor.text.as_ref().zip(anchor.kind).is_some_and(|(text, kind)| text.needs_witness(kind))
    };
    comparison.matches.iter().all(|pair| (needs(pair.query) && needs(pair.candidate)) || pair.is_disputed)
}

/// Whether odometry has every matched pair at one place.
pub fn odometry_agrees(path: &TrackedPath, compared: &Compared, settings: &Settings) -> bool {
    let limit_m = drift_m(path.length_m, settings.odometry_slack_m, settings);
    compared.largest_distance_m().is_some_and(|apart_m| apart_m <= limit_m)
}

/// Adds where odometry has a candidate, and lets it agree if odometry or a confirmed loop bears it out.
pub(in crate::recognition) fn bear_out(
    index: &MapIndex,
    query: &Query<'_>,
    mut pre_verified: PreVerified,
) -> PreVerified {
    if pre_verified.stage == CandidateStage::Stopped {
        return pre_verified;
    }
    let settings = &index.properties().settings;
    let tracked = query.keyframe.filter(|_| settings.odometry_max_drift_share > 0.0);
    pre_verified.path = tracked.and_then(|query| TrackedPath::between(index, query, pre_verified.keyframe));
    let is_borne_out = || {
        pre_verified.path.is_some_and(|path| odometry_agrees(&path, &pre_verified.compared, settings))
            || joining_loop(index, &query.centre.covisible, pre_verified.keyframe).is_some()
    };
    if pre_verified.stage == CandidateStage::NeedsWitness && is_borne_out() {
        pre_verified.stage = CandidateStage::AnchorsAgree;
    }
    pre_verified
}
