//! The outcome of a verification: the model, the status, the figures, and why it failed or could not run.

use thiserror::Error;

use super::limits::Limits;
use crate::domain::verdict::GeometryStatus;
use crate::geometry::Sim3;

/// The relation between two images that was looked for. Two points of one scene are related by the first of these that the
/// scene and the motion allow; the later ones have fewer unknowns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// A similarity from points with positions on both sides: seven unknowns.
    #[default]
    Sim3,
    /// The same with scale 1, on metric maps: six unknowns.
    Se3,
    /// An essential matrix from directions alone: five unknowns. The translation's length is not known, and reported as 1.
    Essential,
    /// A homography: the scene is flat, or far. Eight unknowns, four points.
    Homography,
    /// The camera has only turned: three unknowns. The translation is not known, and reported as 0.
    Rotation,
}

impl Model {
    /// Returns the similarity that a map asks for.
    pub fn similarity(limits: &Limits) -> Self {
        if limits.fixed_scale { Self::Se3 } else { Self::Sim3 }
    }

    /// Returns the model's name in the API document.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Sim3 => "sim3",
            Self::Se3 => "se3",
            Self::Essential => "essential",
            Self::Homography => "homography",
            Self::Rotation => "rotation",
        }
    }

    /// Whether it rests on map points, so that its transform has a length.
    pub fn is_metric(self) -> bool {
        matches!(self, Self::Sim3 | Self::Se3)
    }
}

/// Why a candidate was not verified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Failure {
    /// The descriptors of the two keyframes have different lengths.
    #[error("descriptors of {query} and {candidate} bits cannot be compared")]
    DescriptorLengths {
        /// The query's, in bits.
        query: u32,
        /// The candidate's.
        candidate: u32,
    },
    /// Too few features of one side have a position.
    #[error("fewer than {limit} features of one side have a triangulated map point")]
    TooFewPoints {
        /// `Limits::min_matches`.
        limit: u32,
    },
    /// Too few descriptors match.
    #[error("only {matches} features match, and {limit} are needed")]
    TooFewMatches {
        /// The matches.
        matches: u32,
        /// `Limits::min_matches`.
        limit: u32,
    },
    /// Every sample was degenerate: the matches lie on a line or at one place.
    #[error("all of {hypotheses} samples were degenerate: the matches lie on a line, or at one place")]
    Degenerate {
        /// Samples drawn.
        hypotheses: u32,
    },
    /// The camera has only turned, as far as can be told.
    #[error("the parallax is {millidegrees} thousandths of a degree, and {limit} are needed")]
    TooLittleParallax {
        /// The median angle left after the best rotation, in thousandths of a degree.
        millidegrees: u32,
        /// The least that tells.
        limit: u32,
    },
    /// No sample gave a transformation.
    #[error("none of {hypotheses} samples gave a transformation, {degenerate} of them being degenerate")]
    NoHypothesis {
        /// Samples drawn.
        hypotheses: u32,
        /// Those too small, on a line, or of two shapes.
        degenerate: u32,
    },
    /// The best transformation explains too few features.
    #[error("only {inliers} features fit one motion, and {limit} are needed")]
    TooFewInliers {
        /// The matches it explains.
        inliers: u32,
        /// `Limits::min_inliers`, or the fewest that chance does not explain among as many matches.
        limit: u32,
    },
    /// Too few of the features it explains are beyond doubt.
    #[error("only {sure} inliers have a position on both sides and near descriptors, and {limit} are needed")]
    TooFewSureInliers {
        /// The sure inliers.
        sure: u32,
        /// [`Limits::min_sure_inliers`].
        limit: u32,
    },
}

impl Failure {
    /// Returns why no sample gave a model.
    pub(super) fn without_hypothesis(hypotheses: u32, degenerate: u32) -> Self {
        if hypotheses == degenerate {
            Self::Degenerate { hypotheses }
        } else {
            Self::NoHypothesis { hypotheses, degenerate }
        }
    }

    /// Returns the status it gives a verification: what could not run says nothing for or against the candidate (M39).
    pub fn status(self) -> GeometryStatus {
        match self {
            Self::DescriptorLengths { .. }
            | Self::TooFewPoints { .. }
            | Self::TooFewMatches { .. }
            | Self::Degenerate { .. }
            | Self::TooLittleParallax { .. } => GeometryStatus::Skipped,
            Self::NoHypothesis { .. } | Self::TooFewInliers { .. } | Self::TooFewSureInliers { .. } => {
                GeometryStatus::Failed
            }
        }
    }
}

/// The answer, with the evidence.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verification {
    /// The answer.
    pub status: GeometryStatus,
    /// The model that was looked for.
    pub model: Model,
    /// Descriptor matches: for a similarity, between points with positions on both sides.
    pub matches: u32,
    /// Samples that RANSAC drew.
    pub hypotheses: u32,
    /// The matches that the best hypothesis explains, once refined.
    pub matched_inliers: u32,
    /// Features of the query matched after the guided search, with the candidate's features and the window's landmarks.
    pub projected_matches: u32,
    /// Those matched with features of the candidate itself that the final transformation explains.
    pub inliers: u32,
    /// The features of the candidate itself that the final transformation explains, ascending.
    pub explained_features: Vec<u32>,
    /// The places of the inliers, in pixels: in the query's image, and in the candidate's. Of a similarity, only those of
    /// features that the candidate itself sees.
    pub explained_pixels: [Vec<[f64; 2]>; 2],
    /// The inliers beyond doubt ([`super::SureLimits`]).
    pub sure_inliers: u32,
    /// The decimal logarithm of the number of false alarms ([`super::significance`]); none before a model is found.
    pub log10_false_alarms: Option<f64>,
    /// The mean reprojection error of all that the transformation explains, over both images, in pixels.
    pub mean_reprojection_error_px: Option<f64>,
    /// The best transformation, also when the candidate failed for its few inliers: maps points of the query's camera
    /// frame into the candidate's. Absent where the model leaves several ([`super::two_views::decomposition`]).
    pub candidate_from_query: Option<Sim3>,
    /// The covariance of a full transformation ([`super::covariance`]): 6 by 6, row by row, of x, y, z in metres and the
    /// rotation about X, Y, Z in radians, in the candidate's camera frame.
    pub covariance: Option<[f64; 36]>,
    /// Why the candidate was not verified.
    pub failure: Option<Failure>,
}

impl Verification {
    /// Starts a verification before anything is looked at.
    pub(super) fn started(model: Model) -> Self {
        Self { model, ..Self::default() }
    }

    /// Returns a verification that could not run.
    pub(super) fn skipped(model: Model, failure: Failure) -> Self {
        Self::started(model).concluded(Err(failure))
    }

    /// Adds how it ended.
    pub(super) fn concluded(mut self, end: Result<(), Failure>) -> Self {
        self.failure = end.err();
        self.status = self.failure.map_or(GeometryStatus::Verified, Failure::status);
        self
    }
}
