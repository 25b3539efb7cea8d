//! Anchors under the verified transformation: matched ones must stand where it puts them (M8),
//! and sure identifiers must not contradict each other there (M7).
//!
//! Bearing and distance compare anchors up to a cone; a transformation compares places. So what matched by
//! chance falls away here, and a plate read differently at the very same place speaks up. So does one that hangs once, is in
//! both maps, and would hang twice under the transformation: seen from the next door, all doors are alike, but room 904 is
//! not where room 905 is.

use std::collections::{BTreeMap, BTreeSet};

use super::contradiction::{Contradiction, contradict};
use super::difference::{Differing, Placement, Ruling};
use super::sure_text::settle;
use crate::domain::difference::DifferenceEvidence;
use crate::domain::settings::Settings;
use crate::geometry::{Point3, Sim3};
use crate::recognition::loops::anchor_map::{LocalAnchor, LocalName};
use crate::recognition::loops::comparison::{Comparison, Matched};
use crate::recognition::loops::equation_2;
use crate::recognition::map::index::{Certainty, MapIndex};

/// Under a transformation, anchors this near to each other stand at the same place, in metres (M7).
pub(in crate::recognition) const SAME_PLACE_M: f64 = 0.75;

/// Far anchors stand where the transformation puts them only as well as it turns: this share of their distance.
pub(in crate::recognition) const TURNING_SHARE: f64 = 0.15;

/// A pair of anchors of one description.
#[derive(Clone, Debug)]
struct Pair {
    query: LocalAnchor,
    candidate: LocalAnchor,
    weight: f64,
    agreement: f64,
    places: usize,
}

/// What a comparison found, kept until the transformation is known.
#[derive(Clone, Debug, Default)]
pub struct Compared {
    matched: Vec<Pair>,
    elsewhere: Vec<Pair>,
    total_weight: f64,
    unmatched_of_query: Vec<LocalAnchor>,
    unmatched_of_candidate: Vec<LocalAnchor>,
    differing: Vec<Differing>,
}

/// The comparison under the transformation.
#[derive(Clone, Debug)]
pub struct Aligned<'a> {
    /// Which of the matched pairs still stand.
    pub stands: Vec<bool>,
    /// S of Eq. (2), over the pairs that stand.
    pub similarity: f64,
    /// What the pairs that stand say for this place ([`Matched::agreement`]).
    pub agreement: f64,
    /// The least number of places that something that stands hangs at; none if nothing does.
    pub least_places: Option<usize>,
    /// The weight of what hangs once, is in both maps, and would stand elsewhere.
    pub displaced: f64,
    /// The pairs that contradict at the same place.
    pub contradictions: Vec<Contradiction<'a>>,
    /// The pairs whose identifiers differ and do not stop the candidate.
    pub differences: Vec<DifferenceEvidence>,
}

impl Compared {
    /// Keeps what a comparison found.
    pub fn of(index: &MapIndex, comparison: &Comparison<'_>, mut differing: Vec<Differing>) -> Self {
        let settled = |anchor: &LocalAnchor| {
            let mut anchor = anchor.clone();
            settle(index, &mut anchor);
            anchor
        };
        let own = |anchors: &[&LocalAnchor]| anchors.iter().copied().map(settled).collect();
        for pair in &mut differing {
            pair.settle(index);
        }
        Self {
            matched: comparison.matches.iter().map(Pair::of).collect(),
            elsewhere: comparison.elsewhere.iter().map(Pair::of).collect(),
            total_weight: comparison.total_weight,
            unmatched_of_query: own(&comparison.unmatched_of_query),
            unmatched_of_candidate: own(&comparison.unmatched_of_candidate),
            differing,
        }
    }

    /// Whether there are anchors to be held against a transformation.
    pub fn has_anchors(&self) -> bool {
        self.total_weight > 0.0
    }

    /// Returns the largest distance between the two anchors of a matched pair, in metres, where both maps are in one
    /// frame; none if nothing matches whose distances were measured.
    pub fn largest_distance_m(&self) -> Option<f64> {
        let apart_m = |pair: &Pair| (pair.query.centre_in_session - pair.candidate.centre_in_session).norm();
        self.matched.iter().filter(|pair| pair.is_measured()).map(apart_m).reduce(f64::max)
    }

    /// Takes the comparison again under the transformation.
    pub fn under(&self, candidate_from_query: &Sim3, settings: &Settings) -> Aligned<'_> {
        let apart_m = |query: &LocalAnchor, candidate: &LocalAnchor| {
            (candidate_from_query.transform(&in_camera(query)) - in_camera(candidate)).norm()
        };
        let limit_m = settings.anchor_map_max_distance_difference_m;
        let stands: Vec<bool> = (self.matched.iter())
            .map(|pair| {
                !settings.aligned_anchors
                    || !pair.is_measured()
                    || apart_m(&pair.query, &pair.candidate) <= limit_m
            })
            .collect();
        let standing =
            || self.matched.iter().zip(&stands).filter(|(_, stands)| **stands).map(|(pair, _)| pair);
        let sum = |of: fn(&Pair) -> f64| standing().fold(0.0, |sum, pair| sum + of(pair));
        let displaced = if settings.aligned_anchors {
            let is_off = |pair: &&Pair| {
                apart_m(&pair.query, &pair.candidate) > limit_m.max(pair.distance_m() * TURNING_SHARE)
            };
            let fell =
                self.matched.iter().zip(&stands).filter(|(pair, stands)| !**stands && pair.places == 1);
            let off = fell.map(|(pair, _)| pair).chain(&self.elsewhere).filter(is_off);
            displaced_weight(off, standing())
        } else {
            0.0
        };
        // Geometry has found the place: only what is sure speaks against it.
        let is_sure = |anchor: &&LocalAnchor| anchor.certainty == Certainty::Sure;
        let query: Vec<_> = self.unmatched_of_query.iter().filter(is_sure).collect();
        let candidate: Vec<_> = self.unmatched_of_candidate.iter().filter(is_sure).collect();
        let contradictions = if settings.contradiction_veto {
            let same_place =
                |a: &LocalAnchor, b: &LocalAnchor| a.is_measured_with(b) && apart_m(a, b) <= SAME_PLACE_M;
            contradict(&query, &candidate, same_place)
        } else {
            Vec::new()
        };
        let agreement = sum(|pair| pair.agreement);
        let ruling = Ruling { contradictions: &contradictions, agreement, must_be_sure: true };
        let explain = |pair: &Differing| {
            let placement = placement(apart_m(pair.query(), pair.candidate()));
            pair.explain(&placement, ruling, settings)
        };
        let differences = self.differing.iter().filter_map(explain).collect();
        Aligned {
            similarity: equation_2::similarity(sum(|pair| pair.weight), self.total_weight),
            agreement,
            differences,
            least_places: standing().map(|pair| pair.places).min(),
            displaced,
            stands,
            contradictions,
        }
    }
}

impl Pair {
    fn of(matched: &Matched<'_>) -> Self {
        Self {
            query: matched.query.clone(),
            candidate: matched.candidate.clone(),
            weight: matched.weight(),
            agreement: matched.agreement(),
            places: matched.places,
        }
    }

    /// Whether both distances were measured, so that a transformation may be held against them.
    fn is_measured(&self) -> bool {
        self.query.is_measured_with(&self.candidate)
    }

    /// Returns how far the nearer of the two is from its camera.
    fn distance_m(&self) -> f64 {
        self.query.bearing.distance_m().min(self.candidate.bearing.distance_m())
    }
}

/// Returns where two anchors stand to each other under a transformation.
fn placement(apart_m: f64) -> Placement {
    if apart_m <= SAME_PLACE_M {
        return Placement::Same;
    }
    let told = format!("{apart_m:.2} m under the transformation, and {SAME_PLACE_M} m is the same place");
    Placement::Apart { measured: apart_m, limit: SAME_PLACE_M, told }
}

/// Returns the weight of the pairs that are off, each anchor of the query counted once, with the heaviest of its pairs,
/// and not if it also stands where it should: what two robots' maps hold twice is not displaced.
fn displaced_weight<'a>(
    off: impl Iterator<Item = &'a Pair>,
    standing: impl Iterator<Item = &'a Pair>,
) -> f64 {
    let stands: BTreeSet<LocalName> = standing.map(|pair| pair.query.name).collect();
    let mut heaviest: BTreeMap<LocalName, f64> = BTreeMap::new();
    for pair in off.filter(|pair| !stands.contains(&pair.query.name)) {
        let weight = heaviest.entry(pair.query.name).or_insert(0.0);
        *weight = weight.max(pair.weight);
    }
    heaviest.values().fold(0.0, |sum, weight| sum + weight)
}

/// Where the anchor's centre is in its own central keyframe's camera frame.
fn in_camera(anchor: &LocalAnchor) -> Point3 {
    let [x, y, z] = anchor.bearing.direction_in_camera();
    let d = anchor.bearing.distance_m();
    Point3::new(x * d, y * d, z * d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::anchor::AnchorState;
    use crate::domain::ids::AnchorSeq;
    use crate::geometry::{Bearing, Pose};
    use nalgebra::{UnitQuaternion, Vector3};

    fn anchor(number: u32, at: [f64; 3], places: usize) -> LocalAnchor {
        let centre = Point3::from(at);
        LocalAnchor {
            name: LocalName::MergedAnchor(AnchorSeq(number)),
            class: "door_number".into(),
            state: AnchorState::Valid,
            description: None,
            text: None,
            kind: None,
            text_id: None,
            certainty: Certainty::Sure,
            centre_in_session: centre,
            range_assumed: false,
            bearing: Bearing::of(&centre, &Pose::identity()),
            weight: 1.0 / centre.coords.norm() / places as f64,
            places,
        }
    }

    fn pair(number: u32, query: [f64; 3], candidate: [f64; 3], places: usize) -> Pair {
        let (query, candidate) = (anchor(number, query, places), anchor(number + 100, candidate, places));
        let weight = query.weight + candidate.weight;
        Pair { query, candidate, weight, agreement: weight / places as f64, places }
    }

    fn ahead(metres: f64) -> Sim3 {
        Sim3::from_parts(1.0, UnitQuaternion::identity(), Vector3::new(0.0, 0.0, metres))
    }

    #[test]
    fn a_sign_that_hangs_once_speaks_against_a_transformation_that_would_hang_it_twice() {
        let settings = Settings::default();
        // Room 904, three metres on in the candidate's view, and an exit sign that hangs at every door.
        let compared = Compared {
            matched: vec![pair(1, [0.5, 0.0, 2.0], [0.5, 0.0, 2.0], 12)],
            elsewhere: vec![pair(2, [0.0, 0.0, 2.0], [0.0, 0.0, 5.0], 1)],
            total_weight: 2.0,
            ..Compared::default()
        };
        let one_door_off = compared.under(&ahead(0.0), &settings);
        assert!((one_door_off.displaced - 0.7).abs() < 1e-9, "{}", one_door_off.displaced);
        assert!(one_door_off.displaced > one_door_off.agreement);
        assert_eq!(one_door_off.least_places, Some(12));
        let right = compared.under(&ahead(3.0), &settings);
        assert_eq!(right.displaced, 0.0);
        let paper = Settings { aligned_anchors: false, ..Settings::default() };
        assert_eq!(compared.under(&ahead(0.0), &paper).displaced, 0.0);
    }

    #[test]
    fn a_sign_that_also_stands_where_it_should_is_not_displaced() {
        let mut twice = pair(1, [0.0, 0.0, 2.0], [0.0, 0.0, 5.0], 1);
        twice.candidate.name = LocalName::MergedAnchor(AnchorSeq(77));
        let compared = Compared {
            matched: vec![pair(1, [0.0, 0.0, 2.0], [0.0, 0.0, 2.0], 1)],
            elsewhere: vec![twice],
            total_weight: 2.0,
            ..Compared::default()
        };
        assert_eq!(compared.under(&ahead(0.0), &Settings::default()).displaced, 0.0);
    }
}
