//! Anchors under the verified transformation: matched ones must stand where it puts them (`contract.md` §8.8),
//! and sure identifiers must not contradict each other there (§8.7).
//!
//! Bearing and distance compare anchors up to a cone; a transformation compares places. So what matched by
//! chance falls away here, and a plate read differently at the very same place speaks up.

use super::anchor_map::LocalAnchor;
use super::comparison::{Comparison, equation_2};
use super::contradiction::{Contradiction, contradict};
use crate::geometry::{Point3, Sim3};
use crate::model::settings::Settings;

/// Under a transformation, anchors this near to each other stand at the same place, in metres (`contract.md` §8.7).
const SAME_PLACE_M: f64 = 0.75;

/// What a comparison found, kept until the transformation is known.
#[derive(Clone, Debug, Default)]
pub struct Compared {
    matched: Vec<(LocalAnchor, LocalAnchor)>,
    total_weight: f64,
    unmatched_of_query: Vec<LocalAnchor>,
    unmatched_of_candidate: Vec<LocalAnchor>,
}

/// The comparison under the transformation.
#[derive(Clone, Debug)]
pub struct Aligned<'a> {
    /// Which of the matched pairs still stand.
    pub stands: Vec<bool>,
    /// S of Eq. (2), over the pairs that stand.
    pub similarity: f64,
    /// The weight of the pairs that stand.
    pub agreeing_weight: f64,
    /// The pairs that contradict at the same place.
    pub contradictions: Vec<Contradiction<'a>>,
}

impl Compared {
    /// Keeps what a comparison found.
    pub fn of(comparison: &Comparison<'_>) -> Self {
        let own = |anchors: &[&LocalAnchor]| anchors.iter().copied().cloned().collect();
        Self {
            matched: comparison
                .matches
                .iter()
                .map(|pair| (pair.query.clone(), pair.candidate.clone()))
                .collect(),
            total_weight: comparison.total_weight,
            unmatched_of_query: own(&comparison.unmatched_of_query),
            unmatched_of_candidate: own(&comparison.unmatched_of_candidate),
        }
    }

    /// Are there anchors to be held against a transformation?
    pub fn has_anchors(&self) -> bool {
        self.total_weight > 0.0
    }

    /// Takes the comparison again under the transformation.
    pub fn under(&self, candidate_from_query: &Sim3, settings: &Settings) -> Aligned<'_> {
        let apart_m = |query: &LocalAnchor, candidate: &LocalAnchor| {
            (candidate_from_query.transform(&in_camera(query)) - in_camera(candidate)).norm()
        };
        let limit_m = settings.anchor_map_max_distance_difference_m;
        let stands: Vec<bool> = (self.matched.iter())
            .map(|(query, candidate)| !settings.aligned_anchors || apart_m(query, candidate) <= limit_m)
            .collect();
        let standing = self.matched.iter().zip(&stands).filter(|(_, stands)| **stands);
        let agreeing_weight =
            standing.fold(0.0, |sum, ((query, candidate), _)| sum + query.weight + candidate.weight);
        let (query, candidate): (Vec<_>, Vec<_>) =
            (self.unmatched_of_query.iter().collect(), self.unmatched_of_candidate.iter().collect());
        let contradictions = if settings.contradiction_veto {
            contradict(&query, &candidate, |a, b| apart_m(a, b) <= SAME_PLACE_M)
        } else {
            Vec::new()
        };
        Aligned {
            similarity: equation_2(agreeing_weight, self.total_weight),
            agreeing_weight,
            stands,
            contradictions,
        }
    }
}

/// Where the anchor's centre is in its own central keyframe's camera frame.
fn in_camera(anchor: &LocalAnchor) -> Point3 {
    let [x, y, z] = anchor.bearing.direction_in_camera();
    let d = anchor.bearing.distance_m();
    Point3::new(x * d, y * d, z * d)
}
