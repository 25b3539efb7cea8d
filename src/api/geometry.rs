//! Geometry: the figures of the last check, and the transformation that a client closes the loop with.

use revisit_shapes::answer;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::names::GeometryStatusName;
use super::space::{Quaternion, Vector3, rounded};
use crate::domain::verdict::{GeometryEvidence, GeometryFigures};
use crate::geometry::Sim3;

/// The result of geometric verification.
#[answer]
#[schema(as = Geometry)]
pub struct GeometryView {
    /// Its outcome.
    pub status: GeometryStatusName,
    /// The reason why it was skipped or failed, for a person; left out where a check before it decided.
    pub reason: Option<String>,
    /// The model that was looked for. Where too few points are triangulated the images alone are compared, by the simplest model that
    /// explains nearly as much as the others.
    pub model: Option<GeometryModel>,
    /// Descriptor matches; for `sim3` and `se3` between features with triangulated map points on both sides.
    pub matches: Option<u32>,
    /// Samples that RANSAC drew.
    pub hypotheses: Option<u32>,
    /// Matches that the final transformation explains, after the guided search.
    pub inliers: Option<u32>,
    /// The decimal logarithm of the number of false alarms: how often matches placed at random in the images would give a
    /// model with as many inliers. At most -6 is significant.
    pub log10_false_alarms: Option<f64>,
    /// The inliers' mean reprojection error in both images, in pixels.
    pub mean_reprojection_error_px: Option<f64>,
    /// Maps points of the query's camera frame into the candidate's camera frame. For `essential` and `homography` the
    /// translation's length is not known and given as 1; for `rotation` nothing of the translation is known, and it is given
    /// as 0. A homography that leaves two motions has none.
    pub candidate_from_query: Option<Similarity>,
    /// The covariance of `candidate_from_query` where `sim3` or `se3` is verified, row by row: x, y, z in metres and the
    /// rotation about X, Y, Z in radians, in the candidate's camera frame, as ROS writes it. It says how the inliers
    /// scatter; drift that all of them share does not show in it.
    #[schema(min_items = 36, max_items = 36)]
    pub covariance: Option<Vec<f64>>,
}

/// A model of the relation between two views.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum GeometryModel {
    /// A similarity of points that are triangulated on both sides.
    Sim3,
    /// The same with scale 1, on metric maps.
    Se3,
    /// Directions alone: the camera moved in a scene with depth.
    Essential,
    /// A flat or far scene.
    Homography,
    /// The camera has only turned.
    Rotation,
}

impl GeometryModel {
    /// Returns the model's name.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Sim3 => "sim3",
            Self::Se3 => "se3",
            Self::Essential => "essential",
            Self::Homography => "homography",
            Self::Rotation => "rotation",
        }
    }

    fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "sim3" => Self::Sim3,
            "se3" => Self::Se3,
            "essential" => Self::Essential,
            "homography" => Self::Homography,
            "rotation" => Self::Rotation,
            _ => return None,
        })
    }
}

/// A similarity transformation: scale, then rotate, then translate.
#[answer]
#[derive(Copy)]
pub struct Similarity {
    /// Without unit; 1 on metric maps.
    pub scale: f64,
    /// In metres.
    pub translation: Vector3,
    /// A unit quaternion.
    pub rotation: Quaternion,
}

impl From<&GeometryEvidence> for GeometryView {
    fn from(geometry: &GeometryEvidence) -> Self {
        let figures = geometry.figures.as_ref();
        let number = |of: fn(&GeometryFigures) -> u32| figures.map(of);
        Self {
            status: geometry.status.into(),
            reason: geometry.reason.clone(),
            model: figures.and_then(|figures| GeometryModel::from_name(figures.model)),
            matches: number(|figures| figures.matches),
            hypotheses: number(|figures| figures.hypotheses),
            inliers: number(|figures| figures.inliers),
            log10_false_alarms: figures.and_then(|f| f.log10_false_alarms).map(rounded),
            mean_reprojection_error_px: figures.and_then(|f| f.mean_reprojection_error_px).map(rounded),
            candidate_from_query: figures
                .and_then(|figures| figures.candidate_from_query)
                .map(Similarity::from),
            covariance: figures.and_then(|figures| figures.covariance).map(|of| of.to_vec()),
        }
    }
}

impl From<Sim3> for Similarity {
    fn from(transform: Sim3) -> Self {
        let [x, y, z] = transform.translation_m().map(rounded);
        let [qx, qy, qz, qw] = transform.rotation_xyzw().map(rounded);
        Self {
            scale: rounded(transform.scale()),
            translation: Vector3 { x, y, z },
            rotation: Quaternion { x: qx, y: qy, z: qz, w: qw },
        }
    }
}
