//! The place of a passage: was the robot where its poses have it, and did it look at the wall where the sign hangs?
//!
//! A twin room has the same wall. So either the robot observes the very map points around the sign, or geometry finds them
//! in its image under a transformation that its poses bear out, as near as odometry tells one place from the next.

use std::collections::BTreeSet;

use super::expected::{Expecting, is_in_image};
use super::passages::Passage;
use crate::domain::ids::{KeyframeSeq, PointId};
use crate::domain::settings::Settings;
use crate::domain::verdict::GeometryStatus;
use crate::geometry::{Point3, Sim3};
use crate::recognition::extensions::tracked_path::TrackedPath;
use crate::recognition::loops::features::FeatureSet;
use crate::recognition::loops::geometry_check::{Comparisons, PlacedQuery, Terms, verify_views};
use crate::recognition::loops::geometry_snapshot::GeometrySnapshot;
use crate::recognition::loops::screening::Stage;
use crate::recognition::loops::wanted_features::WantedFeatures;
use crate::recognition::map::index::MapIndex;

/// Map points this near to a sign's centre, in metres, are around it.
pub const AROUND_M: f64 = 0.5;
/// The fewest points around a sign that tell whether it is in view.
pub const POINTS_MIN: usize = 6;
/// The keyframes of a passage that geometry looks at for one sign.
pub const LOOKS_MAX: usize = 3;

/// Verifications after one write. What is left over counts as not looked at.
pub const LOOKS_OF_A_WRITE_MAX: usize = 4;

/// The seed of the verification, whatever the seeds of queries.
const SEED: u64 = 0;

/// A keyframe that should have seen a sign, and one that read it from nearly there, for geometry: as they were at one version
/// of the map.
#[derive(Clone, Debug)]
pub struct Look {
    settings: Settings,
    metric: bool,
    /// The sign's centre in the session's frame.
    sign: Point3,
    query: (KeyframeSeq, GeometrySnapshot),
    candidate: (KeyframeSeq, GeometrySnapshot),
    path: TrackedPath,
    /// The map points around the sign that the candidate observes.
    around: BTreeSet<PointId>,
}

/// Whether a keyframe of the passage observes half of the map points around the sign, or more: tracking says that it is here.
pub fn tracked_here(index: &MapIndex, passage: &Passage) -> bool {
    passage.expecting.iter().any(|expecting| {
        let around = points_around(index, passage, expecting.read_by);
        let own = index.keyframe(expecting.keyframe).map(|keyframe| &keyframe.observes);
        let observed = own.map_or(0, |own| own.iter().filter(|point| around.contains(point)).count());
        is_half(observed, around.len())
    })
}

/// Returns the map points around a sign that a keyframe of its session observes, but for those on the sign: a new one
/// looks otherwise.
fn points_around(index: &MapIndex, passage: &Passage, keyframe: KeyframeSeq) -> BTreeSet<PointId> {
    let sign = &passage.sign;
    let on_it = index.objects().get(sign.root).and_then(|object| object.shapes.get(&sign.session));
    let is_on_it = |point: &PointId| on_it.is_some_and(|shape| shape.map_points.contains(point));
    let is_near = |point: &PointId| {
        let position = index.points().position(sign.session, *point);
        position.is_some_and(|position| (position - sign.centre).norm() <= AROUND_M)
    };
    let observed = index.keyframe(keyframe).into_iter().flat_map(|keyframe| keyframe.observes.iter());
    observed.filter(|point| is_near(point) && !is_on_it(point)).collect()
}

fn is_half(count: usize, of: usize) -> bool {
    of >= POINTS_MIN && 2 * count >= of
}

impl Look {
    /// Returns pairs of keyframes that geometry may look at, at most `most`, the nearest in direction first.
    pub(super) fn all(index: &MapIndex, passage: &Passage, most: usize) -> Vec<Self> {
        let mut pairs = passage.expecting.clone();
        pairs.sort_by(|a, b| a.angle_rad.total_cmp(&b.angle_rad).then_with(|| b.keyframe.cmp(&a.keyframe)));
        pairs.iter().take(LOOKS_MAX.min(most)).filter_map(|pair| Self::at(index, passage, pair)).collect()
    }

    fn at(index: &MapIndex, passage: &Passage, pair: &Expecting) -> Option<Self> {
        let (query, candidate) = (pair.keyframe, pair.read_by);
        let around = points_around(index, passage, candidate);
        if around.len() < POINTS_MIN {
            return None;
        }
        // Where odometry may be off by more, it cannot tell this place from the next.
        let properties = index.properties();
        let most_m = properties.settings.distinctive_place_radius_m;
        let path = TrackedPath::by_loops(index, query, candidate, most_m)?;
        let sights =
            GeometrySnapshot::stored(index, query).zip(GeometrySnapshot::stored(index, candidate))?;
        Some(Self {
            settings: properties.settings.clone(),
            metric: properties.metric,
            sign: passage.sign.centre,
            query: (query, sights.0),
            candidate: (candidate, sights.1),
            path,
            around,
        })
    }

    /// Returns the keyframes whose features it needs.
    pub fn wanted_features(&self) -> WantedFeatures {
        let mut wanted = WantedFeatures::of(self.candidate.0, &self.candidate.1);
        wanted.add_alone(self.query.0, Some(&self.query.1));
        wanted
    }

    /// Runs geometry. Returns where the sign would hang in the session's frame as the query's pose has it, if the query looks
    /// at that place, and is near enough to see it.
    pub fn verify(&self, features: &FeatureSet) -> Option<Point3> {
        let terms = Terms { settings: &self.settings, metric: self.metric };
        let (query, candidate) = (&self.query.1, &self.candidate.1);
        let of = |keyframe: KeyframeSeq| features.stored.get(&keyframe).map(AsRef::as_ref);
        let comparisons = Comparisons::default();
        let asked = PlacedQuery::new((query, of(self.query.0)?), &comparisons);
        let seen = of(self.candidate.0)?;
        let views = (candidate, seen);
        let checked = verify_views(&terms, Stage::AskGeometry, &asked, views, features, SEED).ok()?;
        let found = &checked.verification;
        if found.status != GeometryStatus::Verified || !found.model.is_metric() {
            return None;
        }
        let candidate_from_query: Sim3 = checked.between_poses(&found.candidate_from_query?);
        if self.path.discrepancy(&candidate_from_query, &self.settings).is_some() {
            return None;
        }
        // Where the query's pose has a point that the candidate's session knows.
        let placed = |point: &Point3| {
            let in_candidate = candidate.session_from_camera.inverse_transform(point);
            query.session_from_camera.transform(&candidate_from_query.inverse_transform(&in_candidate))
        };
        let is_in_view =
            |point: &Point3| is_in_image(&placed(point), &query.camera, &query.session_from_camera);
        let (mut everywhere, mut around) = (Found::default(), Found::default());
        for (feature, point) in seen.map_points.iter().enumerate() {
            let Some(point) = point else { continue };
            if candidate.position(*point).is_some_and(is_in_view) {
                let is_found = found.explained_features.binary_search(&(feature as u32)).is_ok();
                everywhere.count(is_found);
                if self.around.contains(point) {
                    around.count(is_found);
                }
            }
        }
        let looks_there = around.found >= POINTS_MIN && 2.0 * around.share() >= everywhere.share();
        (looks_there && is_in_view(&self.sign)).then(|| placed(&self.sign))
    }
}

/// Map points that should be in view, and those of them that geometry found.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    of: usize,
    found: usize,
}

impl Found {
    fn count(&mut self, is_found: bool) {
        self.of += 1;
        self.found += usize::from(is_found);
    }

    fn share(self) -> f64 {
        self.found as f64 / self.of.max(1) as f64
    }
}
