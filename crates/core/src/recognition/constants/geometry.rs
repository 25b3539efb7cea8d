//! Constants of geometry (§V, the last step).

use super::constant::{Constant, constants};
use crate::geometry::pinhole::MIN_DEPTH;
use crate::recognition::loops::geometry_snapshot;
use crate::recognition::verification::limits::Limits;
use crate::recognition::verification::two_views::consensus::SCORE_CHI_SQUARE;
use crate::recognition::verification::two_views::essential::{Essential, MIN_PARALLAX_RAD};
use crate::recognition::verification::two_views::image_model::ImageModel as _;
use crate::recognition::verification::two_views::{MIN_RATIO, decomposition, homography, rotation};
use crate::recognition::verification::{orientation, planar_ambiguity, significance};

const LIMITS: Limits = Limits::DEFAULT;

/// Rule by rule, in the order in which a pair of keyframes meets them.
pub(super) const GEOMETRY: &[Constant] = constants! {
    // Geometry on map points.
    "matching.max_distance_share" = LIMITS.matching.max_distance, "1",
        "ORB-SLAM's TH_HIGH: the largest distance of a match, as a share of the descriptor's bits";
    "matching.max_ratio" = LIMITS.matching.max_ratio, "1",
        "ORB-SLAM: the best must be nearer than this share of the second best";
    "matching.orientation_bins" = orientation::BINS as f64, "1",
        "ORB-SLAM's HISTO_LENGTH: bins of the turn of a match";
    "matching.orientation_bins_kept" = orientation::BINS_KEPT as f64, "1",
        "ORB-SLAM: the fullest bins, whose matches are kept";
    "similarity.max_chi_square" = LIMITS.max_chi_square, "1",
        "99 % quantile of chi-square, two degrees of freedom: an inlier's squared error in units of its variance is smaller";
    "similarity.keypoint_sigma_px" = LIMITS.keypoint_sigma_px, "px",
        "ORB-SLAM: standard deviation of a keypoint at octave 0";
    "similarity.octave_factor" = LIMITS.octave_factor, "1",
        "ORB-SLAM: how much more a keypoint scatters from octave to octave";
    "similarity.depth_sigma_share" = LIMITS.depth_sigma, "1",
        "ours: standard deviation of a point's depth, as a share of it";
    "similarity.min_depth" = MIN_DEPTH, "m",
        "a point nearer to the camera has no pixel";
    "similarity.sure_share" = LIMITS.sure.share, "1",
        "ours: share of geometry_min_inliers that must have positions on both sides and near descriptors";
    "similarity.sure_share_of_matches" = LIMITS.sure.share_of_matches, "1",
        "ours: the same, as a share of the matches";
    "similarity.sure_max_distance_share" = LIMITS.sure.max_distance, "1",
        "ours (ORB-SLAM's TH_LOW is 50 of 256): the largest distance of near descriptors, as a share of their bits";
    "similarity.max_hypotheses" = LIMITS.sampling.max_hypotheses as f64, "1",
        "ours (ORB-SLAM: 300): the most samples";
    "similarity.max_chance_of_miss" = LIMITS.sampling.max_chance_of_miss, "1",
        "ORB-SLAM: sampling stops once the chance of having missed every good sample is smaller";
    "similarity.sample_tolerance" = LIMITS.sampling.tolerance, "1",
        "ours: how many times farther off the inliers of a sample may be";
    "similarity.local_rounds" = LIMITS.sampling.local_rounds as f64, "1",
        "ours: refinements of a new best sample";
    "similarity.min_extent_share" = LIMITS.sampling.min_extent, "1",
        "ours: longest side of a sample's triangle over its distance";
    "similarity.min_height_share" = LIMITS.sampling.min_height, "1",
        "ours: height of a sample's triangle over its longest side";
    "similarity.max_side_factor" = LIMITS.sampling.max_side_factor, "1",
        "ours: how much the sides of the two triangles may differ on metric maps";
    "similarity.flat_thickness_share" = planar_ambiguity::MAX_THICKNESS_SHARE, "1",
        "ours: a patch is flat below this share of its narrower side";
    "similarity.min_tilt_rad" = planar_ambiguity::MIN_TILT_RAD, "rad",
        "ours: smaller tilts of a flat patch are not taken for two";
    "guided_search.window_keyframes" = geometry_snapshot::WINDOW_KEYFRAMES as f64, "1",
        "ORB-SLAM3: covisible keyframes whose points join the search";
    "guided_search.radius_sigmas" = LIMITS.guided.radius, "1",
        "ours: how far from its projection a keypoint may be, in standard deviations at octave 0";
    "guided_search.max_distance_share" = LIMITS.guided.max_distance, "1",
        "ours: the largest distance, as a share of the descriptor's bits";
    "guided_search.rounds" = LIMITS.guided.rounds as f64, "1",
        "ours: rounds of search and refinement";
    "significance.max_log10_false_alarms" = LIMITS.max_log10_false_alarms, "1",
        "ours (Moisan and Stival 2004): decimal logarithm of the most false alarms of what is accepted";
    "significance.cell_px" = significance::CELL_PX, "px",
        "ours: features this near show one thing";
    // Geometry on images alone.
    "two_views.max_chi_square" = SCORE_CHI_SQUARE, "1",
        "99 % quantile of chi-square, two degrees of freedom: homographies and rotations";
    "two_views.max_chi_square_of_line" = Essential::MAX_CHI_SQUARE, "1",
        "99 % quantile of chi-square, one degree of freedom: essential matrices";
    "two_views.simpler_model_ratio" = MIN_RATIO, "1",
        "ORB-SLAM: share of the two scores from which the simpler model is taken";
    "two_views.min_parallax_rad" = MIN_PARALLAX_RAD, "rad",
        "ours: median angle between the rays of a point below which the camera has only turned";
    "two_views.min_stretch" = decomposition::MIN_STRETCH, "1",
        "ours: ratio of singular values of a homography from which the camera has moved";
    "two_views.homography_min_height_share" = homography::MIN_HEIGHT, "1",
        "ours: height of three points of a sample over their longest side";
    "two_views.rotation_min_sine" = rotation::MIN_SINE, "1",
        "ours: sine of the least angle between the two rays of a sample";
};
