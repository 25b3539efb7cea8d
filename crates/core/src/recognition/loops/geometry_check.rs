//! Geometry on one pair of keyframes: what it needs, by which numbers it is accepted, and what came out.

use std::cell::{Cell, OnceCell};

use super::features::{FeatureSet, MatchableFeatures};
use super::geometry_snapshot::GeometrySnapshot;
use super::screening::{PreVerified, Screening, Stage};
use crate::domain::settings::{GeometryAcceptance, Settings};
use crate::domain::verdict::Verify;
use crate::geometry::{Point3, Sim3};
use crate::recognition::verification::resection::resection;
use crate::recognition::verification::{Failure, Landmark, Limits, Verification, View, verify_by_any_model};

/// A keyframe that geometry can look at.
pub type Seeing<'a> = (&'a GeometrySnapshot, &'a MatchableFeatures);

/// The terms of a map by which geometry verifies.
#[derive(Clone, Copy, Debug)]
pub struct Terms<'a> {
    /// Its settings.
    pub settings: &'a Settings,
    /// Whether its lengths are metres.
    pub metric: bool,
}

/// Pairs of descriptors that one question compares, over all of its candidates: as many as twenty candidates have where each
/// keyframe has three thousand features. Without a bound a question would cost the square of its features.
pub const COMPARISONS_MAX: u64 = 200_000_000;

/// The comparisons of one question so far.
#[derive(Debug, Default)]
pub struct Comparisons(Cell<u64>);

impl Comparisons {
    /// Takes so many, unless they would be too many. The first candidate is compared in any case.
    fn take(&self, count: u64) -> bool {
        let so_far = self.0.get();
        let is_allowed = so_far == 0 || so_far.saturating_add(count) <= COMPARISONS_MAX;
        if is_allowed {
            self.0.set(so_far.saturating_add(count));
        }
        is_allowed
    }
}

/// The keyframe that is asked about. Its points are placed once, when the first candidate needs them.
pub struct PlacedQuery<'a> {
    seeing: Seeing<'a>,
    placed: OnceCell<Placed>,
    comparisons: &'a Comparisons,
}

impl<'a> PlacedQuery<'a> {
    /// Takes what is asked about, and the comparisons of the question so far.
    pub fn new(seeing: Seeing<'a>, comparisons: &'a Comparisons) -> Self {
        Self { seeing, placed: OnceCell::new(), comparisons }
    }

    fn placed(&self, terms: &Terms<'_>) -> &Placed {
        self.placed.get_or_init(|| Placed::of(self.seeing, &mut [], terms))
    }
}

/// The points of a keyframe in the frame of its camera.
struct Placed {
    points: Vec<Option<Point3>>,
    /// The transformation of points from the camera's frame, by its pose, into the camera's frame, by its image.
    camera_from_posed: Sim3,
}

impl Placed {
    /// Brings points, and landmarks around them, into the frame of the camera that sees them, where its pose has them
    /// elsewhere.
    fn of(seeing: Seeing<'_>, landmarks: &mut [Landmark<'_>], terms: &Terms<'_>) -> Self {
        let mut points = seeing.0.points_in_camera(seeing.1);
        let limits = limits(terms, Stage::AskGeometry, true);
        let resected = terms.settings.is_ours().then(|| resection(&view(seeing, &points), &limits));
        let Some(camera_from_posed) = resected.flatten() else {
            return Self { points, camera_from_posed: Sim3::identity() };
        };
        let of_landmarks = landmarks.iter_mut().map(|landmark| &mut landmark.point_in_camera);
        for point in points.iter_mut().flatten().chain(of_landmarks) {
            *point = camera_from_posed.transform(point);
        }
        Self { points, camera_from_posed }
    }

    fn are_at_least(&self, count: usize) -> bool {
        self.points.iter().flatten().count() >= count
    }
}

/// The outcome of geometry between the query and one candidate.
#[derive(Clone, Debug)]
pub struct GeometryOutcome {
    /// The outcome.
    pub verification: Verification,
    /// Both keyframes have enough map points with positions for a similarity to be found.
    pub are_triangulated: bool,
    /// Of the query and of the candidate: what maps points of the camera's frame, by its pose, into the camera's frame, by its
    /// image.
    camera_from_posed: [Sim3; 2],
}

impl GeometryOutcome {
    /// Returns a transformation between the two cameras as one between the frames in which anchors stand, which are those of
    /// the poses.
    pub fn between_poses(&self, candidate_from_query: &Sim3) -> Sim3 {
        let [of_query, of_candidate] = &self.camera_from_posed;
        of_candidate.inverse().after(&candidate_from_query.after(of_query))
    }

    /// Whether a similarity failed that has at least half of the inliers that verify. Enough of them, of which too few are
    /// sure, say that the two cameras stand in one room, and their neighbours would say no more.
    pub fn is_near_miss(&self) -> bool {
        let is_half =
            |failure| matches!(failure, Failure::TooFewInliers { inliers, limit } if 2 * inliers >= limit);
        self.verification.model.is_metric() && self.verification.failure.is_some_and(is_half)
    }
}

/// Runs geometry on one candidate, or tells what is missing for it.
pub fn check_geometry(
    screening: &Screening,
    pre_verified: &PreVerified,
    asked: Option<&PlacedQuery<'_>>,
    features: &FeatureSet,
    seed: u64,
) -> Result<GeometryOutcome, &'static str> {
    if screening.verify == Verify::Anchors {
        return Err("the query asks for anchors alone");
    }
    let found =
        pre_verified.snapshot.as_ref().zip(features.stored.get(&pre_verified.keyframe).map(AsRef::as_ref));
    let asked = asked.ok_or("the query has no features or no camera")?;
    let candidate = found.ok_or("the candidate has no features or no camera")?;
    let terms = Terms { settings: &screening.settings, metric: screening.metric };
    verify_views(&terms, pre_verified.stage, asked, candidate, features, seed)
}

/// Runs geometry on two keyframes, by the numbers of geometry alone where `stage` has it asked.
pub fn verify_views(
    terms: &Terms<'_>,
    stage: Stage,
    asked: &PlacedQuery<'_>,
    candidate: Seeing<'_>,
    features: &FeatureSet,
    seed: u64,
) -> Result<GeometryOutcome, &'static str> {
    let query = asked.seeing;
    let min_matches = terms.settings.geometry_min_matches as usize;
    if [query, candidate].iter().any(|(_, features)| features.keypoints.len() < min_matches) {
        return Err("one of the two has fewer features than geometry_min_matches");
    }
    if !asked.comparisons.take(query.1.comparisons(candidate.1)) {
        return Err(
            "the candidates before it had so many features that no more are compared for one question",
        );
    }
    let window = candidate.0.window.iter().filter_map(|seq| features.stored.get(seq).map(AsRef::as_ref));
    let mut landmarks = candidate.0.landmarks(candidate.1, window, query);
    let of_query = asked.placed(terms);
    let of_candidate = Placed::of(candidate, &mut landmarks, terms);
    let are_triangulated = [of_query, &of_candidate].iter().all(|placed| placed.are_at_least(min_matches));
    let limits = limits(terms, stage, are_triangulated);
    let (query, candidate) = (view(query, &of_query.points), view(candidate, &of_candidate.points));
    let verification = verify_by_any_model(&query, &candidate, &landmarks, &limits, seed);
    let camera_from_posed = [of_query.camera_from_posed, of_candidate.camera_from_posed];
    Ok(GeometryOutcome { verification, are_triangulated, camera_from_posed })
}

/// Significance says that two views are of one thing, and no more: where nothing else speaks for the place, and where map
/// points let a similarity be found, the letter's numbers count (M19).
fn limits(terms: &Terms<'_>, stage: Stage, are_triangulated: bool) -> Limits {
    let settings = terms.settings;
    let by_count = are_triangulated || stage == Stage::AskGeometry;
    Limits {
        min_matches: settings.geometry_min_matches,
        min_inliers: settings.geometry_min_inliers,
        models: settings.geometry_models,
        landmark_sigma_px: settings.geometry_landmark_sigma_px,
        acceptance: if by_count { GeometryAcceptance::Count } else { settings.geometry_acceptance },
        fixed_scale: terms.metric,
        ..Limits::default()
    }
}

fn view<'a>((snapshot, features): Seeing<'a>, points_in_camera: &'a [Option<Point3>]) -> View<'a> {
    View {
        camera: snapshot.camera,
        keypoints: &features.keypoints,
        descriptors: &features.descriptors,
        nodes: features.nodes.as_deref(),
        points_in_camera,
    }
}
