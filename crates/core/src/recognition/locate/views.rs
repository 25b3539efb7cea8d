//! Geometry between a keyframe that asks and a candidate.

use super::explained_cells::{Cells, cells};
use super::map_search::{LocateQuestion, MapSearch};
use super::pose::of_covariance;
use super::selection::Chosen;
use crate::domain::location::{LocatedPose, PoseSource};
use crate::domain::verdict::{Candidate, GeometryStatus};
use crate::recognition::loops::decision::conclude_view;
use crate::recognition::loops::features::FeatureSet;
use crate::recognition::loops::geometry_check::{GeometryOutcome, PlacedQuery, check_geometry};

/// The findings of geometry between a keyframe that asks and a candidate.
#[derive(Clone, Debug)]
pub struct View {
    /// The candidate.
    pub chosen: Chosen,
    /// Its checks, with their figures.
    pub candidate: Candidate,
    /// The cells of the keyframe's image that one transformation explains; none where geometry did not verify.
    pub cells: Cells,
    /// The number of cells of the candidate's image that it explains.
    pub candidate_cells: usize,
    /// The first keyframe's pose in the candidate's session, where the transformation has a length.
    pub pose: Option<LocatedPose>,
}

impl View {
    /// Returns the number of cells that the two images have in common: the smaller of the two sides, for many features of
    /// one may match few of the other.
    pub fn common_cells(&self) -> usize {
        self.cells.len().min(self.candidate_cells)
    }
}

/// Looks at one candidate.
pub fn look(
    question: &LocateQuestion,
    search: &MapSearch,
    chosen: Chosen,
    asked: Option<&PlacedQuery<'_>>,
    features: &FeatureSet,
) -> View {
    let screening = &search.screenings[chosen.asked];
    let pre_verified = &screening.candidates[chosen.candidate];
    let checked = check_geometry(screening, pre_verified, asked, features, question.seed);
    let outcome = checked.as_ref().ok().cloned();
    let candidate = conclude_view(screening, pre_verified, checked).candidate;
    let verified = outcome.filter(|outcome| outcome.verification.status == GeometryStatus::Verified);
    let explained = verified.as_ref().map(|outcome| &outcome.verification.explained_pixels);
    let cameras = screening.snapshot.as_ref().zip(pre_verified.snapshot.as_ref());
    let (cells, candidate_cells) = match explained.zip(cameras) {
        Some(([in_query, in_candidate], (own, other))) => (
            cells(chosen.asked, &own.camera, in_query),
            cells(chosen.asked, &other.camera, in_candidate).len(),
        ),
        None => (Cells::new(), 0),
    };
    let pose = verified.and_then(|outcome| pose(question, search, chosen, &outcome));
    View { chosen, candidate, cells, candidate_cells, pose }
}

/// Composes the first keyframe's pose from a verified transformation.
fn pose(
    question: &LocateQuestion,
    search: &MapSearch,
    chosen: Chosen,
    outcome: &GeometryOutcome,
) -> Option<LocatedPose> {
    let verification = &outcome.verification;
    let transform = verification.candidate_from_query.filter(|_| verification.model.is_metric())?;
    let site = &search.sites[search.proposed[chosen.asked][chosen.candidate].site];
    let between = outcome.between_poses(&transform).without_scale();
    let map_from_asked = site.map_from_camera.after(&between);
    let asked_from_reference = question.reference_from_camera(chosen.asked)?.inverse();
    let uncertainty = of_covariance(&verification.covariance?);
    Some(LocatedPose {
        map_from_camera: map_from_asked.after(&asked_from_reference),
        uncertainty,
        source: PoseSource::Views,
        assumed: Vec::new(),
    })
}
