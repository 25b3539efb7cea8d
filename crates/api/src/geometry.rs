//! Geometry: the figures of the last check, and the transformation that a client closes the loop with.

use revisit_core::domain::verdict::{GeometryEvidence, GeometryFigures};
use revisit_core::geometry::Sim3;
use revisit_shapes::answer;
use serde::de::IntoDeserializer as _;
use serde::de::value::{Error as Unnamed, StrDeserializer};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::names::GeometryStatusName;
use super::space::{Quaternion, Vector3, rounded};

/// The result of geometric verification.
#[answer(of = &GeometryEvidence)]
#[schema(as = Geometry)]
pub struct GeometryView {
    /// Its outcome.
    pub status: GeometryStatusName,
    /// The reason why it was skipped or failed, for a person; left out where a check before it decided.
    pub reason: Option<String>,
    /// The model that was looked for. Where too few points are triangulated the images alone are compared, by the simplest model that
    /// explains nearly as much as the others.
    #[is(figures(of, |of| GeometryModel::from_name(of.model)))]
    pub model: Option<GeometryModel>,
    /// Descriptor matches; for `sim3` and `se3` between features with triangulated map points on both sides.
    #[is(figures(of, |of| Some(of.matches)))]
    pub matches: Option<u32>,
    /// Samples that RANSAC drew.
    #[is(figures(of, |of| Some(of.hypotheses)))]
    pub hypotheses: Option<u32>,
    /// Matches that the final transformation explains, after the guided search.
    #[is(figures(of, |of| Some(of.inliers)))]
    pub inliers: Option<u32>,
    /// The decimal logarithm of the number of false alarms: how often matches placed at random in the images would give a
    /// model with as many inliers. At most -6 is significant.
    #[from(figures(of, |of| of.log10_false_alarms))]
    #[rounded]
    pub log10_false_alarms: Option<f64>,
    /// The inliers' mean reprojection error in both images, in pixels.
    #[from(figures(of, |of| of.mean_reprojection_error_px))]
    #[rounded]
    pub mean_reprojection_error_px: Option<f64>,
    /// Maps points of the query's camera frame into the candidate's camera frame. For `essential` and `homography` the
    /// translation's length is not known and given as 1; for `rotation` nothing of the translation is known, and it is given
    /// as 0. A homography that leaves two motions has none.
    #[from(figures(of, |of| of.candidate_from_query))]
    pub candidate_from_query: Option<Similarity>,
    /// The covariance of `candidate_from_query` where `sim3` or `se3` is verified, row by row: x, y, z in metres and the
    /// rotation about X, Y, Z in radians, in the candidate's camera frame, as ROS writes it. It says how the inliers
    /// scatter; drift that all of them share does not show in it.
    #[schema(min_items = 36, max_items = 36)]
    #[is(figures(of, |of| of.covariance).map(Into::into))]
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
        let name: StrDeserializer<'_, Unnamed> = name.into_deserializer();
        Self::deserialize(name).ok()
    }
}

/// A similarity transformation: scale, then rotate, then translate.
#[answer(of = Sim3)]
#[derive(Copy)]
pub struct Similarity {
    /// Without unit; 1 on metric maps.
    #[from(of.scale())]
    #[rounded]
    pub scale: f64,
    /// In metres.
    #[from(of.translation_m().map(rounded))]
    pub translation: Vector3,
    /// A unit quaternion.
    #[from(of.rotation_xyzw().map(rounded))]
    pub rotation: Quaternion,
}

/// Returns one of the figures of a geometry that ran.
fn figures<T>(of: &GeometryEvidence, figure: fn(&GeometryFigures) -> Option<T>) -> Option<T> {
    of.figures.as_ref().and_then(figure)
}
