//! Constants of the method: every number that decides a verdict and is no setting, with its unit and its source.
//!
//! They are defined where they are used; this table is what the API document shows of them. What only bounds memory or time,
//! and changes no answer, is not among them.

mod changed_signs;
mod constant;
mod frames;
mod geometry;
mod locate;
mod odds;
mod plans;

use super::anchors::{find_description_tasks, near_in_meaning, pairs};
use super::extensions::{company, distinctiveness, tracked_path, twins};
use super::loops::{anchor_map, candidates, decision, fusion};
use super::map::index;
use super::verification::{resection, similarity};
pub use constant::Constant;
use constant::constants;

use crate::semantics;

/// Returns every constant, rule by rule in the order in which a query meets them.
pub fn constants() -> impl Iterator<Item = &'static Constant> {
    [
        ANCHORS,
        changed_signs::CHANGED_SIGNS,
        geometry::GEOMETRY,
        odds::ODDS,
        FOUND,
        locate::LOCATE,
        plans::PLANS,
        frames::FRAMES,
    ]
    .into_iter()
    .flatten()
}

const ANCHORS: &[Constant] = constants! {
    // What is near, and what it weighs.
    "covisibility.max_gap_s" = index::MAX_GAP_S, "s",
        "ours: neighbours along the drive were taken no longer before or after it, by their clock";
    "anchor_map.min_distance_m" = anchor_map::LEAST_DISTANCE_M, "m",
        "ours: a nearer anchor weighs as if it stood at this distance";
    "odometry.slack_m" = tracked_path::SLACK_M, "m",
        "ours: a transformation may be off odometry by this on any way";
    // What is read.
    "numbering.values" = semantics::LEARNED_FROM_VALUES as f64, "1",
        "ours: values of one shape, each read alike in two keyframes or more, that make a numbering";
    "numbering.shown_values" = semantics::SHOWN_FROM_VALUES as f64, "1",
        "ours: values of one shape, read so, beside which numbers of other shapes with fewer values are of unknown kind";
    "information.specific_words" = semantics::ENOUGH_SPECIFIC_WORDS as f64, "1",
        "ours: specific words from which a text without an identifier has information level 4";
    "noise.digits_max" = semantics::NUMBER_DIGITS_MAX as f64, "1",
        "ours: digits of the longest number that is not looked at for zeros";
    "noise.zero_percent" = semantics::ZERO_PERCENT as f64, "%",
        "ours: share of zeros from which a longer number is noise";
    // Which texts a model is asked about.
    "judging.neighbours" = pairs::NEIGHBOURS_JUDGED as f64, "1",
        "ours: a text is judged by a model with so many of the texts most like it";
    "judging.small_class" = pairs::SMALL_CLASS as f64, "1",
        "ours: texts of a class in which texts that share no word are judged as well";
    "judging.widespread" = pairs::WIDESPREAD as f64, "1",
        "ours: a word in more texts than this tells none of them apart";
    "judging.near_by_chance" = near_in_meaning::NEAR_BY_CHANCE, "1",
        "ours: others of a class that may be as near as an embedding by chance";
    "judging.others_min" = near_in_meaning::OTHERS_MIN as f64, "1",
        "ours: others of a class from which the chance of being near is known";
    "judging.embedded_class" = pairs::EMBEDDED_CLASS_MAX as f64, "1",
        "ours: texts of a class up to which embeddings choose the pairs to be judged";
    "judging.better_crop" = find_description_tasks::BETTER_CROP, "1",
        "ours: how many times as large a crop must be to replace the one described before";
    // Candidates.
    "candidates.undecided_min_score_share" = decision::UNDECIDED_MIN_SCORE_SHARE, "1",
        "ours: a candidate without anchors whose words score below this share of the reference score does not make the answer undecided";
    "candidates.revisits_per_anchor" = candidates::MAX_REVISITS_PER_ANCHOR as f64, "1",
        "ours: matching anchors, the oldest first, through which an anchor proposes candidates";
    "candidates.near_miss_neighbours" = candidates::NEAR_MISS_NEIGHBOURS as f64, "1",
        "ours: covisible keyframes of a near miss that are checked in its stead";
    "candidates.reciprocal_rank_offset" = fusion::RECIPROCAL_RANK_OFFSET, "1",
        "Cormack, Clarke and Buettcher, SIGIR 2009: what is added to each rank of a channel before its reciprocal counts";
    // Anchor maps.
    "distinctiveness.places_max" = distinctiveness::PLACES_MAX as f64, "1",
        "ours: counting of places ends here";
    "resection.points_min" = resection::MIN_POINTS as f64, "points",
        "ours: the fewest points of a keyframe that say where its camera stands";
    "resection.median_chi_square_max" = resection::MAX_MEDIAN_CHI_SQUARE, "1",
        "the median of chi-square with two degrees of freedom: a keyframe whose points are off by less in its own image keeps its pose";
    "resection.refined_on_medians" = resection::REFINED_ON_MEDIANS, "1",
        "ours: points of up to so many times the median squared error fix the camera's pose";
    "resection.rounds" = resection::ROUNDS as f64, "1",
        "ours: rounds of choosing points and refining the camera's pose";
    "similarity.rounds" = similarity::ROUNDS as f64, "1",
        "ours: rounds of refining a similarity and taking its inliers again, at most";
    "twins.alone_min_inliers" = twins::ALONE_MIN_INLIERS as f64, "1",
        "ours: inliers without map points from which two views are alike";
    "twins.kept_max" = twins::KEPT_MAX as f64, "pairs",
        "ours: twins of a map that are kept; none is looked for beyond";
    "company.same_offset_m" = company::SAME_OFFSET_M, "m",
        "ours: two offsets this near are one";
    "company.neighbours_max" = company::NEIGHBOURS_MAX as f64, "1",
        "ours: neighbours of a text that are compared, the nearest first";
    "company.carriers_max" = company::CARRIERS_MAX as f64, "1",
        "ours: anchors of a text whose company is looked at, the oldest first";
};

const FOUND: &[Constant] = constants! {
    // What is found, held against tracking and anchors.
    "odometry.turn_slack_rad" = tracked_path::TURN_SLACK_RAD, "rad",
        "ours: how far a transformation's turn may be off odometry on any way";
    "odometry.turn_per_drift_share" = tracked_path::TURN_PER_DRIFT_SHARE, "rad",
        "ours: what is added to it for each whole of odometry_max_drift_share: a heading that scatters moves the place by its share of the way over the root of three";
};

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_constant_has_a_name_of_its_own_and_a_finite_value() {
        let names: BTreeSet<&str> = constants().map(|constant| constant.name).collect();
        assert_eq!(names.len(), constants().count());
        for constant in constants() {
            assert!(constant.value.is_finite(), "{}", constant.name);
            let (rule, quantity) = constant.name.split_once('.').expect("a rule and a quantity");
            assert!(!rule.is_empty() && !quantity.is_empty(), "{}", constant.name);
        }
    }
}
