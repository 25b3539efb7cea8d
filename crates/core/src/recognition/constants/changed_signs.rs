//! Constants of signs that change (M18).

use super::constant::{Constant, constants};
use crate::recognition::extensions::{changed_signs, way_by_loops};
use crate::recognition::map::index::CELL_M;

/// Rule by rule.
pub(super) const CHANGED_SIGNS: &[Constant] = constants! {
    "changed_signs.missing_passages" = changed_signs::judged::MISSING_PASSAGES as f64, "passages",
        "ours: separate passages that had a sign in view and did not see it retire it (signs_may_change)";
    "changed_signs.returning_reads" = changed_signs::judged::RETURNING_READS as f64, "keyframes",
        "ours: keyframes of one passage that read a retired sign as it was called return it";
    "changed_signs.same_side_rad" = changed_signs::expected::SAME_SIDE_RAD, "rad",
        "ours: a sign is expected in view within this angle of a direction from which it was read, no farther off than there";
    "changed_signs.same_view_rad" = changed_signs::expected::SAME_VIEW_RAD, "rad",
        "ours: of views whose directions differ less, the newest is compared";
    "changed_signs.clear_views" = changed_signs::judged::CLEAR_VIEWS as f64, "keyframes",
        "ours: where nothing hangs in a sign's place, so many keyframes of a passage must have had it clearly in view";
    "changed_signs.clear_side_rad" = changed_signs::expected::CLEAR_SIDE_RAD, "rad",
        "ours: a sign is clearly in view within this angle of a direction from which it was read";
    "changed_signs.clear_margin_share" = changed_signs::expected::CLEAR_MARGIN_SHARE, "1",
        "ours: and farther from the edges of the image than this share of its width and height";
    "changed_signs.views_max" = changed_signs::expected::VIEWS_MAX as f64, "views",
        "ours: views that read a sign and are looked at, the newest";
    "changed_signs.around_m" = changed_signs::place::AROUND_M, "m",
        "ours: map points this near to a sign's centre are around it";
    "changed_signs.points_min" = changed_signs::place::POINTS_MIN as f64, "points",
        "ours: the fewest points around a sign that say that a keyframe looks at its place";
    "changed_signs.looks_max" = changed_signs::place::LOOKS_MAX as f64, "1",
        "ours: verifications by which a passage that missed a sign is held against earlier keyframes";
    "changed_signs.looks_of_a_write_max" = changed_signs::place::LOOKS_OF_A_WRITE_MAX as f64, "1",
        "ours: such verifications of one write; what is left over counts as not looked at";
    "changed_signs.looked_back_max" = changed_signs::passages::LOOKED_BACK_MAX as f64, "keyframes",
        "ours: keyframes of a session among which the end of a passage is looked for";
    "changed_signs.looked_back_radii" = changed_signs::passages::LOOKED_BACK_RADII, "distinctive_place_radius_m",
        "ours: and the way among which it is";
    "changed_signs.within_m" = CELL_M, "m",
        "ours: signs farther from a camera than this may not be expected in its view";
    "changed_signs.misses_kept" = changed_signs::judged::MISSES_KEPT as f64, "passages",
        "ours: passages that missed a sign and are kept, the newest";
    "way_by_loops.looked_at_max" = way_by_loops::LOOKED_AT_MAX as f64, "keyframes",
        "ours: keyframes among which the shortest way through confirmed loops is looked for";
};
