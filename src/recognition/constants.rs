//! Constants of the method: every number that decides a verdict and is no setting, with its unit and its source.
//!
//! They are defined where they are used; this table is what the API document shows of them. What only bounds memory or time,
//! and changes no answer, is not among them.

use super::index::CELL_M;
use super::verification::limits::Limits;
use super::verification::two_views::consensus::{ImageModel as _, SCORE_CHI_SQUARE};
use super::verification::two_views::essential::{Essential, MIN_PARALLAX_RAD};
use super::verification::two_views::{MIN_RATIO, decomposition, homography, rotation};
use super::verification::{orientation, planar_ambiguity, resection, significance, similarity};
use super::{
    alignment, candidates, changed_signs, company, distinctiveness, lacking, near_in_meaning, pairs, passage,
    sight, tracked_path, twins, way_by_loops,
};
use crate::geometry::pinhole::MIN_DEPTH;
use crate::semantics;

/// A number that decides verdicts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant {
    /// The rule and the quantity, as `rule.quantity`.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its unit; `1` for counts, shares and factors.
    pub unit: &'static str,
    /// What it does, and where it comes from.
    pub doc: &'static str,
}

const fn constant(name: &'static str, value: f64, unit: &'static str, doc: &'static str) -> Constant {
    Constant { name, value, unit, doc }
}

const LIMITS: Limits = Limits::DEFAULT;

/// Every constant, rule by rule in the order in which a query meets them.
pub const CONSTANTS: &[Constant] = &[
    // What is read.
    constant(
        "numbering.values",
        semantics::LEARNED_FROM_VALUES as f64,
        "1",
        "ours: values of one shape, each read alike in two keyframes or more, that make a numbering",
    ),
    constant(
        "information.specific_words",
        semantics::ENOUGH_SPECIFIC_WORDS as f64,
        "1",
        "ours: specific words from which a text without an identifier has information level 4",
    ),
    constant(
        "noise.digits_max",
        semantics::NUMBER_DIGITS_MAX as f64,
        "1",
        "ours: digits of the longest number that is not looked at for zeros",
    ),
    constant(
        "noise.zero_percent",
        semantics::ZERO_PERCENT as f64,
        "%",
        "ours: share of zeros from which a longer number is noise",
    ),
    // Which texts a model is asked about.
    constant(
        "judging.neighbours",
        pairs::NEIGHBOURS_JUDGED as f64,
        "1",
        "ours: a text is judged by a model with so many of the texts most like it",
    ),
    constant(
        "judging.small_class",
        pairs::SMALL_CLASS as f64,
        "1",
        "ours: texts of a class in which texts that share no word are judged as well",
    ),
    constant(
        "judging.widespread",
        pairs::WIDESPREAD as f64,
        "1",
        "ours: a word in more texts than this tells none of them apart",
    ),
    constant(
        "judging.near_by_chance",
        near_in_meaning::NEAR_BY_CHANCE,
        "1",
        "ours: others of a class that may be as near as an embedding by chance",
    ),
    constant(
        "judging.others_min",
        near_in_meaning::OTHERS_MIN as f64,
        "1",
        "ours: others of a class from which the chance of being near is known",
    ),
    constant(
        "judging.embedded_class",
        pairs::EMBEDDED_CLASS_MAX as f64,
        "1",
        "ours: texts of a class up to which embeddings choose the pairs to be judged",
    ),
    constant(
        "judging.better_crop",
        lacking::BETTER_CROP,
        "1",
        "ours: how many times as large a crop must be to replace the one described before",
    ),
    // Candidates.
    constant(
        "candidates.revisits_per_anchor",
        candidates::MAX_REVISITS_PER_ANCHOR as f64,
        "1",
        "ours: matching anchors, the oldest first, through which an anchor proposes candidates",
    ),
    constant(
        "candidates.near_miss_neighbours",
        candidates::NEAR_MISS_NEIGHBOURS as f64,
        "1",
        "ours: covisible keyframes of a near miss that are checked in its stead",
    ),
    // Anchor maps.
    constant(
        "distinctiveness.places_max",
        distinctiveness::PLACES_MAX as f64,
        "1",
        "ours: counting of places ends here",
    ),
    constant(
        "passage.sure_passages",
        passage::SURE_PASSAGES as f64,
        "1",
        "ours: passages in which a text must be read alike to be sure",
    ),
    constant(
        "resection.points_min",
        resection::MIN_POINTS as f64,
        "points",
        "ours: the fewest points of a keyframe that say where its camera stands (geometry_resection)",
    ),
    constant(
        "resection.median_chi_square_max",
        resection::MAX_MEDIAN_CHI_SQUARE,
        "1",
        "the median of chi-square with two degrees of freedom: a keyframe whose points are off by less in its own image keeps its pose",
    ),
    constant(
        "resection.refined_on_medians",
        resection::REFINED_ON_MEDIANS,
        "1",
        "ours: points of up to so many times the median squared error fix the camera's pose",
    ),
    constant(
        "resection.rounds",
        resection::ROUNDS as f64,
        "1",
        "ours: rounds of choosing points and refining the camera's pose",
    ),
    constant(
        "similarity.rounds",
        similarity::ROUNDS as f64,
        "1",
        "ours: rounds of refining a similarity and taking its inliers again, at most",
    ),
    constant(
        "twins.kept_max",
        twins::KEPT_MAX as f64,
        "pairs",
        "ours: twins of a map that are kept; none is looked for beyond",
    ),
    constant(
        "changed_signs.missing_passages",
        changed_signs::judged::MISSING_PASSAGES as f64,
        "passages",
        "ours: separate passages that had a sign in view and did not see it retire it (signs_may_change)",
    ),
    constant(
        "changed_signs.returning_reads",
        changed_signs::judged::RETURNING_READS as f64,
        "keyframes",
        "ours: keyframes of one passage that read a retired sign as it was called return it",
    ),
    constant(
        "changed_signs.same_side_rad",
        changed_signs::expected::SAME_SIDE_RAD,
        "rad",
        "ours: a sign is expected in view within this angle of a direction from which it was read, no farther off than there",
    ),
    constant(
        "changed_signs.same_view_rad",
        changed_signs::expected::SAME_VIEW_RAD,
        "rad",
        "ours: of views whose directions differ less, the newest is compared",
    ),
    constant(
        "changed_signs.clear_views",
        changed_signs::judged::CLEAR_VIEWS as f64,
        "keyframes",
        "ours: where nothing hangs in a sign's place, so many keyframes of a passage must have had it clearly in view",
    ),
    constant(
        "changed_signs.clear_side_rad",
        changed_signs::expected::CLEAR_SIDE_RAD,
        "rad",
        "ours: a sign is clearly in view within this angle of a direction from which it was read",
    ),
    constant(
        "changed_signs.clear_margin_share",
        changed_signs::expected::CLEAR_MARGIN_SHARE,
        "1",
        "ours: and farther from the edges of the image than this share of its width and height",
    ),
    constant(
        "changed_signs.views_max",
        changed_signs::expected::VIEWS_MAX as f64,
        "views",
        "ours: views that read a sign and are looked at, the newest",
    ),
    constant(
        "changed_signs.around_m",
        changed_signs::place::AROUND_M,
        "m",
        "ours: map points this near to a sign's centre are around it",
    ),
    constant(
        "changed_signs.points_min",
        changed_signs::place::POINTS_MIN as f64,
        "points",
        "ours: the fewest points around a sign that say that a keyframe looks at its place",
    ),
    constant(
        "changed_signs.looks_max",
        changed_signs::place::LOOKS_MAX as f64,
        "1",
        "ours: verifications by which a passage that missed a sign is held against earlier keyframes",
    ),
    constant(
        "changed_signs.looks_of_a_write_max",
        changed_signs::place::LOOKS_OF_A_WRITE_MAX as f64,
        "1",
        "ours: such verifications of one write; what is left over counts as not looked at",
    ),
    constant(
        "changed_signs.looked_back_max",
        changed_signs::passages::LOOKED_BACK_MAX as f64,
        "keyframes",
        "ours: keyframes of a session among which the end of a passage is looked for",
    ),
    constant(
        "changed_signs.looked_back_radii",
        changed_signs::passages::LOOKED_BACK_RADII,
        "distinctive_place_radius_m",
        "ours: and the way among which it is",
    ),
    constant(
        "changed_signs.within_m",
        CELL_M,
        "m",
        "ours: signs farther from a camera than this may not be expected in its view",
    ),
    constant(
        "changed_signs.misses_kept",
        changed_signs::judged::MISSES_KEPT as f64,
        "passages",
        "ours: passages that missed a sign and are kept, the newest",
    ),
    constant(
        "way_by_loops.looked_at_max",
        way_by_loops::LOOKED_AT_MAX as f64,
        "keyframes",
        "ours: keyframes among which the shortest way through confirmed loops is looked for",
    ),
    constant("company.same_offset_m", company::SAME_OFFSET_M, "m", "ours: two offsets this near are one"),
    constant(
        "company.neighbours_max",
        company::NEIGHBOURS_MAX as f64,
        "1",
        "ours: neighbours of a text that are compared, the nearest first",
    ),
    constant(
        "company.pairs_max",
        company::PAIRS_MAX as f64,
        "1",
        "ours: matched pairs of a comparison whose company is looked at",
    ),
    constant(
        "company.carriers_max",
        company::CARRIERS_MAX as f64,
        "1",
        "ours: anchors of a text whose company is looked at, the oldest first",
    ),
    // Geometry on map points.
    constant(
        "matching.max_distance_share",
        LIMITS.matching.max_distance,
        "1",
        "ORB-SLAM's TH_HIGH: the largest distance of a match, as a share of the descriptor's bits",
    ),
    constant(
        "matching.max_ratio",
        LIMITS.matching.max_ratio,
        "1",
        "ORB-SLAM: the best must be nearer than this share of the second best",
    ),
    constant(
        "matching.orientation_bins",
        orientation::BINS as f64,
        "1",
        "ORB-SLAM's HISTO_LENGTH: bins of the turn of a match",
    ),
    constant(
        "matching.orientation_bins_kept",
        orientation::BINS_KEPT as f64,
        "1",
        "ORB-SLAM: the fullest bins, whose matches are kept",
    ),
    constant(
        "similarity.max_chi_square",
        LIMITS.max_chi_square,
        "1",
        "99 % quantile of chi-square, two degrees of freedom: an inlier's squared error in units of its variance is smaller",
    ),
    constant(
        "similarity.keypoint_sigma_px",
        LIMITS.keypoint_sigma_px,
        "px",
        "ORB-SLAM: standard deviation of a keypoint at octave 0",
    ),
    constant(
        "similarity.octave_factor",
        LIMITS.octave_factor,
        "1",
        "ORB-SLAM: how much more a keypoint scatters from octave to octave",
    ),
    constant(
        "similarity.depth_sigma_share",
        LIMITS.depth_sigma,
        "1",
        "ours: standard deviation of a point's depth, as a share of it",
    ),
    constant("similarity.min_depth", MIN_DEPTH, "m", "a point nearer to the camera has no pixel"),
    constant(
        "similarity.sure_share",
        LIMITS.sure.share,
        "1",
        "ours: share of geometry_min_inliers that must have positions on both sides and near descriptors",
    ),
    constant(
        "similarity.sure_share_of_matches",
        LIMITS.sure.share_of_matches,
        "1",
        "ours: the same, as a share of the matches",
    ),
    constant(
        "similarity.sure_max_distance_share",
        LIMITS.sure.max_distance,
        "1",
        "ours (ORB-SLAM's TH_LOW is 50 of 256): the largest distance of near descriptors, as a share of their bits",
    ),
    constant(
        "similarity.max_hypotheses",
        LIMITS.sampling.max_hypotheses as f64,
        "1",
        "ours (ORB-SLAM: 300): the most samples",
    ),
    constant(
        "similarity.max_chance_of_miss",
        LIMITS.sampling.max_chance_of_miss,
        "1",
        "ORB-SLAM: sampling stops once the chance of having missed every good sample is smaller",
    ),
    constant(
        "similarity.sample_tolerance",
        LIMITS.sampling.tolerance,
        "1",
        "ours: how many times farther off the inliers of a sample may be",
    ),
    constant(
        "similarity.local_rounds",
        LIMITS.sampling.local_rounds as f64,
        "1",
        "ours: refinements of a new best sample",
    ),
    constant(
        "similarity.min_extent_share",
        LIMITS.sampling.min_extent,
        "1",
        "ours: longest side of a sample's triangle over its distance",
    ),
    constant(
        "similarity.min_height_share",
        LIMITS.sampling.min_height,
        "1",
        "ours: height of a sample's triangle over its longest side",
    ),
    constant(
        "similarity.max_side_factor",
        LIMITS.sampling.max_side_factor,
        "1",
        "ours: how much the sides of the two triangles may differ on metric maps",
    ),
    constant(
        "similarity.flat_thickness_share",
        planar_ambiguity::MAX_THICKNESS_SHARE,
        "1",
        "ours: a patch is flat below this share of its narrower side",
    ),
    constant(
        "similarity.min_tilt_rad",
        planar_ambiguity::MIN_TILT_RAD,
        "rad",
        "ours: smaller tilts of a flat patch are not taken for two",
    ),
    constant(
        "guided_search.window_keyframes",
        sight::WINDOW_KEYFRAMES as f64,
        "1",
        "ORB-SLAM3: covisible keyframes whose points join the search",
    ),
    constant(
        "guided_search.radius_sigmas",
        LIMITS.guided.radius,
        "1",
        "ours: how far from its projection a keypoint may be, in standard deviations at octave 0",
    ),
    constant(
        "guided_search.max_distance_share",
        LIMITS.guided.max_distance,
        "1",
        "ours: the largest distance, as a share of the descriptor's bits",
    ),
    constant(
        "guided_search.rounds",
        LIMITS.guided.rounds as f64,
        "1",
        "ours: rounds of search and refinement",
    ),
    constant(
        "significance.max_log10_false_alarms",
        LIMITS.max_log10_false_alarms,
        "1",
        "ours (Moisan and Stival 2004): decimal logarithm of the most false alarms of what is accepted",
    ),
    constant("significance.cell_px", significance::CELL_PX, "px", "ours: features this near show one thing"),
    // Geometry on images alone.
    constant(
        "two_views.max_chi_square",
        SCORE_CHI_SQUARE,
        "1",
        "99 % quantile of chi-square, two degrees of freedom: homographies and rotations",
    ),
    constant(
        "two_views.max_chi_square_of_line",
        Essential::MAX_CHI_SQUARE,
        "1",
        "99 % quantile of chi-square, one degree of freedom: essential matrices",
    ),
    constant(
        "two_views.simpler_model_ratio",
        MIN_RATIO,
        "1",
        "ORB-SLAM: share of the two scores from which the simpler model is taken",
    ),
    constant(
        "two_views.min_parallax_rad",
        MIN_PARALLAX_RAD,
        "rad",
        "ours: median angle between the rays of a point below which the camera has only turned",
    ),
    constant(
        "two_views.min_stretch",
        decomposition::MIN_STRETCH,
        "1",
        "ours: ratio of singular values of a homography from which the camera has moved",
    ),
    constant(
        "two_views.homography_min_height_share",
        homography::MIN_HEIGHT,
        "1",
        "ours: height of three points of a sample over their longest side",
    ),
    constant(
        "two_views.rotation_min_sine",
        rotation::MIN_SINE,
        "1",
        "ours: sine of the least angle between the two rays of a sample",
    ),
    // What is found, held against tracking and anchors.
    constant(
        "odometry.turn_slack_rad",
        tracked_path::TURN_SLACK_RAD,
        "rad",
        "ours: how far a transformation's turn may be off odometry on any way",
    ),
    constant(
        "odometry.turn_per_drift_share",
        tracked_path::TURN_PER_DRIFT_SHARE,
        "rad",
        "ours: what is added to it for each whole of odometry_max_drift_share: a heading that scatters moves the place by its share of the way over the root of three",
    ),
    constant(
        "alignment.same_place_m",
        alignment::SAME_PLACE_M,
        "m",
        "ours: under a transformation, anchors this near stand at one place",
    ),
    constant(
        "alignment.turning_share",
        alignment::TURNING_SHARE,
        "1",
        "ours: an anchor is displaced if it is off by more than this share of its distance",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_constant_has_a_name_of_its_own_and_a_finite_value() {
        let names: BTreeSet<&str> = CONSTANTS.iter().map(|constant| constant.name).collect();
        assert_eq!(names.len(), CONSTANTS.len());
        for constant in CONSTANTS {
            assert!(constant.value.is_finite(), "{}", constant.name);
            let (rule, quantity) = constant.name.split_once('.').expect("a rule and a quantity");
            assert!(!rule.is_empty() && !quantity.is_empty(), "{}", constant.name);
        }
    }
}
