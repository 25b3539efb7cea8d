//! Geometry: the figures of the last check, and the transformation that a client closes the loop with.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::space::{Quaternion, Vector3, rounded};
use crate::geometry::Sim3;
use crate::model::verdict::{GeometryEvidence, GeometryFigures, GeometryStatus};

/// What geometric verification found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Geometry)]
pub struct GeometryView {
    /// How far it came.
    pub status: GeometryStatusName,
    /// Why it was skipped or failed, for a person.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// What was looked for: `sim3`, a similarity from triangulated points; or `essential`, from directions alone, where
    /// too few are triangulated: the translation's length is then unknown and given as 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// Descriptor matches between features with triangulated map points on both sides.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matches: Option<u32>,
    /// Samples that RANSAC drew.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hypotheses: Option<u32>,
    /// Matches that the final transformation explains, after the guided search.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inliers: Option<u32>,
    /// The inliers' mean reprojection error in both images, in pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_reprojection_error_px: Option<f64>,
    /// Maps points of the query's camera frame into the candidate's camera frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub candidate_from_query: Option<Similarity>,
}

/// `verified`, `failed`, or `skipped` with its reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = GeometryStatus)]
#[expect(missing_docs, reason = "said above")]
pub enum GeometryStatusName {
    Verified,
    Failed,
    Skipped,
}

/// A similarity transformation: scale, then rotate, then translate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
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
        let status = match geometry.status {
            GeometryStatus::Skipped => GeometryStatusName::Skipped,
            GeometryStatus::Failed => GeometryStatusName::Failed,
            GeometryStatus::Verified => GeometryStatusName::Verified,
        };
        let figures = geometry.figures.as_ref();
        let number = |of: fn(&GeometryFigures) -> u32| figures.map(of);
        Self {
            status,
            reason: geometry.reason.clone(),
            model: figures.map(|figures| figures.model.to_owned()),
            matches: number(|figures| figures.matches),
            hypotheses: number(|figures| figures.hypotheses),
            inliers: number(|figures| figures.inliers),
            mean_reprojection_error_px: figures.and_then(|f| f.mean_reprojection_error_px).map(rounded),
            candidate_from_query: figures
                .and_then(|figures| figures.candidate_from_query)
                .map(Similarity::from),
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
