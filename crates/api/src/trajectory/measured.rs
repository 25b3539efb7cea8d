//! Measured: what the kept answer of a loop's query says of the transformation between its keyframes.

use revisit_core::domain::verdict::GeometryStatus;
use revisit_core::geometry::Pose;
use serde::Deserialize;

use crate::geometry::{GeometryModel, GeometryView, Similarity};
use crate::space::Transform;

/// A loop's transformation, as it was verified when the query was answered.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredLoop {
    /// `candidate_from_query`, its scale left out.
    pub candidate_from_query: Pose,
    /// The query's unit in the candidate's.
    pub scale: f64,
    /// Covariance, row by row (`GeometryView::covariance`).
    pub covariance: Option<[f64; 36]>,
}

#[derive(Deserialize)]
struct Kept {
    keyframe: Option<String>,
    candidates: Vec<KeptCandidate>,
}

#[derive(Deserialize)]
struct KeptCandidate {
    keyframe: String,
    geometry: Option<GeometryView>,
}

impl MeasuredLoop {
    /// Reads the transformation between these two keyframes from a kept answer; none if the answer is about another one.
    pub fn between(answer: &[u8], keyframe: &str, candidate: &str) -> Option<Self> {
        let kept: Kept = serde_json::from_slice(answer).ok()?;
        // A keyframe that was asked about inline has no id yet.
        let is_of_it = kept.keyframe.as_deref().is_none_or(|asked| asked == keyframe);
        is_of_it.then(|| Self::to(kept, candidate))?
    }

    /// Reads the transformation to one candidate from a kept answer; none where geometry verified no full transformation.
    pub fn of(answer: &[u8], candidate: &str) -> Option<Self> {
        Self::to(serde_json::from_slice(answer).ok()?, candidate)
    }

    fn to(kept: Kept, candidate: &str) -> Option<Self> {
        let geometry = kept.candidates.into_iter().find(|it| it.keyframe == candidate)?.geometry?;
        let full = matches!(geometry.model, Some(GeometryModel::Sim3 | GeometryModel::Se3));
        if geometry.status.0 != GeometryStatus::Verified || !full {
            return None;
        }
        let Similarity { scale, translation, rotation } = geometry.candidate_from_query?;
        let candidate_from_query = Transform { translation, rotation }.pose()?;
        let covariance = geometry.covariance.and_then(|rows| <[f64; 36]>::try_from(rows.as_slice()).ok());
        Some(Self { candidate_from_query, scale, covariance })
    }
}
