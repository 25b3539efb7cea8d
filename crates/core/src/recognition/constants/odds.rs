//! Constants of the sum of evidence (M64).

use super::constant::{Constant, constants};
use crate::recognition::odds::{drive, names, sum, weights};

/// The chain, the spots, then the weights.
pub(super) const ODDS: &[Constant] = constants! {
    "odds.chain_max" = drive::CHAIN_MAX as f64, "1",
        "ours: keyframes of the unbroken chain back from a query whose signs belong to the question";
    "odds.signs_max" = drive::SIGNS_MAX as f64, "1",
        "ours: signs with names of one side, the nearest first";
    "odds.pairs_max" = names::PAIRS_MAX as f64, "1",
        "ours: pairs of one name whose company is looked at";
    "odds.same_spot_m" = names::SAME_SPOT_M, "m",
        "ours: under a transformation, other names this near are at one spot";
    "odds.tells_a_direction_m" = names::TELLS_A_DIRECTION_M, "m",
        "ours: signs this far apart tell how far apart two cameras stand that have read them";
    "odds.far_share" = names::FAR_SHARE, "1",
        "ours: a sign may be off by this share of its distance";
    "odds.place_widths" = sum::PLACE_WIDTHS, "1",
        "ours: cameras farther apart than so many times anchor_map_max_distance_difference_m stand at two places";
    "odds.name" = weights::NAME.natural(), "1",
        "ours: log-odds of a name that agrees and hangs in one place";
    "odds.name_doubtful" = weights::NAME_DOUBTFUL.natural(), "1",
        "ours: the same, read once with less confidence than reading_min_confidence";
    "odds.other_name" = weights::OTHER_NAME.natural(), "1",
        "ours: log-odds of two names at one spot that exclude each other";
    "odds.other_name_doubtful" = weights::OTHER_NAME_DOUBTFUL.natural(), "1",
        "ours: the same, where either was read once, with less confidence than reading_min_confidence";
    "odds.strange_names" = weights::STRANGE_NAMES.natural(), "1",
        "ours: log-odds of a name on either side that the other side has not";
    "odds.absent" = weights::ABSENT.natural(), "1",
        "ours: log-odds of a sign of the query that nobody read at the candidate";
    "odds.absent_max" = weights::ABSENT_MAX.natural(), "1",
        "ours: of all such signs together";
    "odds.displaced" = weights::DISPLACED.natural(), "1",
        "ours: log-odds of a name that would hang in two places";
    "odds.displaced_by_bearing" = weights::DISPLACED_BY_BEARING.natural(), "1",
        "ours: the same without a transformation, for all such names together";
    "odds.description" = weights::DESCRIPTION.natural(), "1",
        "ours: log-odds of a description that agrees";
    "odds.text" = weights::TEXT.natural(), "1",
        "ours: log-odds of any other text without a name";
    "odds.texts_max" = weights::TEXTS_MAX.natural(), "1",
        "ours: all such texts together, at most";
    "odds.no_copy" = weights::NO_COPY.natural(), "1",
        "ours: log-odds that there is no copy of a place, which looks, pictures and notices together cannot exceed";
    "odds.view_that_does_not_repeat" = weights::VIEW_THAT_DOES_NOT_REPEAT.natural(), "1",
        "ours: log-odds of a view verified on map points where nothing repeats";
    "odds.no_view" = weights::NO_VIEW.natural(), "1",
        "ours: log-odds where geometry on map points finds no common view";
    "odds.no_common_points" = weights::NO_COMMON_POINTS.natural(), "1",
        "ours: the same where it finds one on images alone";
    "odds.no_view_of_a_sign" = weights::NO_VIEW_OF_A_SIGN.natural(), "1",
        "ours: the same where images alone could show it, and not both show a sign that agrees";
    "odds.no_view_in_images" = weights::NO_VIEW_IN_IMAGES.natural(), "1",
        "ours: the same where both show such a sign";
    "odds.here" = weights::HERE.natural(), "1",
        "ours: log-odds against the place next to it, which no number of names around both exceeds";
    "odds.near" = weights::NEAR.natural(), "1",
        "ours: the same where neither a view nor a sign in both local anchor maps places the cameras";
    "odds.elsewhere" = weights::ELSEWHERE.natural(), "1",
        "ours: log-odds where odometry or the transformation has it elsewhere";
    "odds.unread" = weights::UNREAD.natural(), "1",
        "ours: log-odds of crops that nobody has read yet";
};
