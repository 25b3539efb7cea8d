//! Constants of "where am I?" (M56).

use super::constant::{Constant, constants};
use crate::recognition::locate::{
    anchor_pose, answer, explained_cells, likeness, map_search, places, pose, selection, sighted_anchor,
};
use crate::recognition::odds::weights;

/// Rule by rule, in the order in which a question meets them.
pub(super) const LOCATE: &[Constant] = constants! {
    "locate.candidates_per_map" = map_search::CANDIDATES_PER_MAP_MAX as f64, "1",
        "ours: places of one map that are compared with a keyframe";
    "locate.verifications" = selection::VERIFICATIONS_MAX as f64, "1",
        "ours: pairs of keyframes that geometry looks at for one question";
    "locate.looked_at_first" = selection::LOOKED_AT[0] as f64, "1",
        "ours: of these pairs, those after which it is first asked whether a place is located; the rest tell whether the building repeats itself";
    "locate.ranked" = selection::RANKED_MAX as f64, "1",
        "ours: candidates of each channel's ranking that count, over all maps";
    "locate.probes" = likeness::PROBES_MAX as f64, "1",
        "ours: keyframes beside a place for which views alone speak, that are held against the other maps at most";
    "locate.rival_maps" = likeness::RIVAL_MAPS_MAX as f64, "1",
        "ours: other maps that these are held against, those whose candidates look most like the question";
    "locate.alike_from_cells" = likeness::ALIKE_FROM_CELLS as f64, "1",
        "ours: cells of a keyframe's view that are explained in another map, from which they count against a view of a place beside it";
    "locate.single_view_factor" = likeness::SINGLE_VIEW_FACTOR, "1",
        "ours: times these cells that an unmapped place may explain of a single view";
    "locate.cells" = explained_cells::CELLS_ALONG_LONGER_SIDE, "1",
        "ours: cells along the longer side of an image, by which the explained part of a view is measured";
    "locate.even_cells" = weights::EVEN_CELLS, "1",
        "ours: cells that a place explains and its rival does not, at which the two are as likely as not";
    "locate.cells_per_log_odds" = weights::CELLS_PER_LOG_ODDS, "1",
        "ours: such cells that multiply the odds by e";
    "locate.min_confidence" = answer::LOCATED_MIN_CONFIDENCE, "1",
        "ours: the least confidence with which a place is located";
    "locate.same_spot_m" = places::SAME_SPOT_M, "m",
        "ours: poses of one session so near to each other are one place";
    "locate.same_spot_in_plan_m" = places::SAME_SPOT_IN_PLAN_M, "m",
        "ours: a pose in a plan's frame and one in an aligned session's so near to each other are one place";
    "locate.pairs_per_session" = sighted_anchor::PAIRS_PER_SESSION_MAX as f64, "1",
        "ours: pairs of a sighted anchor and one of a session's frame that a pose is sought from";
    "locate.agrees_within_sigmas" = anchor_pose::AGREES_WITHIN_SIGMAS, "1",
        "ours: an anchor agrees with a pose that puts it within so many standard deviations of its place";
    "locate.off_line_min_m" = anchor_pose::OFF_LINE_MIN_M, "m",
        "ours: three anchors are not on a line if one is so far from the line through the others";
    "locate.sighting_sigma_m" = pose::SIGHTING_SIGMA_M, "m",
        "ours: standard deviation of a sighted position, its fixed part";
    "locate.sighting_sigma_share" = pose::SIGHTING_SIGMA_SHARE, "1",
        "ours: the same, as a share of the distance";
    "locate.assumed_tilt_sigma_rad" = pose::ASSUMED_TILT_SIGMA_RAD, "rad",
        "ours: standard deviation of a camera's tilt where both are taken to be equally upright";
    "locate.measured_tilt_sigma_rad" = pose::MEASURED_TILT_SIGMA_RAD, "rad",
        "ours: standard deviation of a vertical that an accelerometer told";
};
