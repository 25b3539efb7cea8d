//! The thresholds of the verification, each with its source.
//!
//! Where ORB-SLAM's value is not taken, the recording `euroc` (two robots' maps of one room, drifting apart by up to
//! 0.3 m) says why: what is measured there is in the docs of the field.

use super::correspondence::Depth;
use crate::domain::settings::{GeometryAcceptance, GeometryModels};
use crate::geometry::pinhole::MIN_DEPTH;

/// Every threshold. [`Limits::default`] is what the service uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// `geometry_min_matches`: the fewest descriptor matches between points with a position on both sides to try at all
    /// (ORB-SLAM: 20).
    pub min_matches: u32,
    /// `geometry_min_inliers`: the fewest inliers at the very end, after guided search and refinement (ORB-SLAM3: 20).
    pub min_inliers: u32,
    /// `geometry_models`: which models may verify.
    pub models: GeometryModels,
    /// `geometry_acceptance`: by significance, or by count.
    pub acceptance: GeometryAcceptance,
    /// The decimal logarithm of the most false alarms that verify a candidate ([`super::significance`]): one in a million.
    /// A query verifies twenty candidates or so, so that one in fifty thousand queries has a false alarm under the
    /// background model.
    pub max_log10_false_alarms: f64,
    /// The inliers that must be beyond doubt.
    pub sure: SureLimits,
    /// Whether the scale is 1, the map being metric.
    pub fixed_scale: bool,
    /// How descriptors are matched.
    pub matching: MatchingLimits,
    /// What a keypoint's position scatters by at octave 0, in pixels (ORB-SLAM: 1).
    pub keypoint_sigma_px: f64,
    /// `geometry_landmark_sigma_px`: the error of a map point's own place, in pixels, at any octave; it adds to that of the
    /// keypoint. Landmarks of real maps are a hand's breadth off, and two maps drift: between two maps of `euroc` most true
    /// pairs are lost with 0, nearly none from 3 on.
    pub landmark_sigma_px: f64,
    /// How much more a keypoint scatters from octave to octave: the scale factor of ORB's image pyramid, 1.2.
    pub octave_factor: f64,
    /// What a point's depth in its own map scatters by, as a share of it. Small far-off planes look alike from either
    /// side of their normal; only the depth of their points tells.
    pub depth_sigma: f64,
    /// The squared reprojection error, in units of the keypoint's variance, below which a pair is an inlier: 9.21,
    /// the 99 % quantile of chi-square with two degrees of freedom (M13).
    pub max_chi_square: f64,
    /// How samples are drawn.
    pub sampling: SamplingLimits,
    /// How the guided search looks for more matches.
    pub guided: GuidedLimits,
}

/// Which inliers are beyond doubt: both sides have a position for the point, the candidate itself sees it, and the
/// descriptors are near.
///
/// Many inliers alone say that the two cameras stand in one room: points of the candidate's neighbours and points that only
/// one side has located agree as well when the two images hardly overlap. These say that the two saw the same things.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SureLimits {
    /// The share of `min_inliers` that must be sure: 12 of 20.
    pub share: f64,
    /// The share of the descriptor matches that must be sure: the more matches, the more of them agree by chance. In a
    /// mirrored room with the same pictures a band of a tenth of them does; true pairs of `euroc` have 17 % and more.
    pub share_of_matches: f64,
    /// The largest distance of their descriptors, as a share of the length (ORB-SLAM's `TH_LOW`: 50 of 256 bits).
    pub max_distance: f64,
}

/// How descriptors are matched. Distances are shares of the descriptor's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchingLimits {
    /// The largest distance of a match (ORB-SLAM's `TH_HIGH`: 100 of 256 bits). The geometry weeds out the worse ones.
    pub max_distance: f64,
    /// The best must be closer than this share of the second best (ORB-SLAM's loop closing: 0.75 to 0.9).
    pub max_ratio: f64,
    /// Whether each must be the other's best.
    pub mutual: bool,
    /// Whether the matches must turn the image alike, where both sides have orientations.
    pub orientation: bool,
}

/// How RANSAC draws its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplingLimits {
    /// The most hypotheses. ORB-SLAM stops at 300, which finds a sample without outliers among 25 % inliers; 1,000 do among
    /// 17 %.
    pub max_hypotheses: u32,
    /// Sampling stops once the chance of having missed every good sample is below this (ORB-SLAM: 1 %).
    pub max_chance_of_miss: f64,
    /// A hypothesis comes from three noisy points: its inliers may be this many times farther off than the last ones.
    pub tolerance: f64,
    /// A new best hypothesis is refined on its inliers so many times at most, while that makes it better.
    pub local_rounds: u32,
    /// The longest side of a sample's triangle, as a share of its distance from the camera, must exceed this.
    pub min_extent: f64,
    /// Its height over that side, as a share of the side, must exceed this: three points on a line leave the rotation open.
    pub min_height: f64,
    /// On metric maps, the sides of the two triangles may differ by this factor.
    pub max_side_factor: f64,
}

/// How the guided search looks for more matches around the projected points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuidedLimits {
    /// How far from the projection a keypoint may be, in standard deviations at octave 0.
    pub radius: f64,
    /// The largest descriptor distance, as a share of the length.
    pub max_distance: f64,
    /// Rounds of search and refinement.
    pub rounds: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Limits {
    /// What the service uses where a map's settings say nothing else.
    pub const DEFAULT: Self = Self {
        min_matches: 20,
        min_inliers: 20,
        models: GeometryModels::Auto,
        acceptance: GeometryAcceptance::Significance,
        max_log10_false_alarms: -6.0,
        sure: SureLimits { share: 0.6, share_of_matches: 0.125, max_distance: 55.0 / 256.0 },
        fixed_scale: true,
        matching: MatchingLimits {
            max_distance: 100.0 / 256.0,
            max_ratio: 0.9,
            mutual: true,
            orientation: true,
        },
        keypoint_sigma_px: 1.0,
        landmark_sigma_px: 3.35,
        octave_factor: 1.2,
        depth_sigma: 0.08,
        max_chi_square: 9.21,
        sampling: SamplingLimits {
            max_hypotheses: 1_000,
            max_chance_of_miss: 0.01,
            tolerance: 2.0,
            local_rounds: 3,
            min_extent: 0.05,
            min_height: 0.1,
            max_side_factor: 1.5,
        },
        guided: GuidedLimits { radius: 4.0, max_distance: 75.0 / 256.0, rounds: 2 },
    };

    /// Returns how many inliers must be sure among this many matches, and at least a share of `min_inliers`.
    pub fn min_sure_inliers(&self, matches: u32) -> u32 {
        let least = (f64::from(self.min_inliers) * self.sure.share).ceil();
        self.min_sure_share(matches).max(least as u32)
    }

    /// Returns how many inliers must be sure among this many matches; always more than the three that any transformation
    /// explains.
    pub fn min_sure_share(&self, matches: u32) -> u32 {
        let of_matches = (f64::from(matches) * self.sure.share_of_matches).ceil();
        (of_matches as u32).max(4)
    }

    /// Returns the depth of a point in its own camera; `None` behind it.
    pub fn depth(&self, metres: f64) -> Option<Depth> {
        (metres > MIN_DEPTH).then(|| Depth { metres, inverse_sigma: (metres * self.depth_sigma).recip() })
    }

    /// Returns what a keypoint's position scatters by at an octave, in pixels.
    pub fn keypoint_sigma_px(&self, octave: u8) -> f64 {
        (0..octave).fold(self.keypoint_sigma_px, |sigma_px, _| sigma_px * self.octave_factor)
    }

    /// Returns the variance sigma^2(octave) of what a projected landmark and its keypoint are apart, in square pixels.
    pub fn variance_px2(&self, octave: u8) -> f64 {
        let sigma_px = self.keypoint_sigma_px(octave);
        sigma_px * sigma_px + self.landmark_sigma_px * self.landmark_sigma_px
    }
}
