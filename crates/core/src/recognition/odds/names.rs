//! Names of two places, held against each other: the same name at one spot, other names there, names that would hang twice.

use std::collections::BTreeSet;
use std::sync::Arc;

use nalgebra::Vector3;

use super::exclusions::{DIFFERING_MAX, Exclusions};
use crate::domain::settings::Settings;
use crate::geometry::upright_alignment::align_upright;
use crate::geometry::{Point3, Sim3};
use crate::recognition::extensions::returning::Returning;
use crate::recognition::loops::anchor_map::{LocalAnchor, LocalName};
use crate::recognition::loops::comparison::Matched;
use crate::recognition::loops::similar_pairs::SimilarPairs;
use crate::recognition::map::index::{Certainty, MapIndex};
use crate::semantics;

/// Under a transformation, signs with other names this near to each other hang at one spot, in metres (M7).
pub(in crate::recognition) const SAME_SPOT_M: f64 = 0.75;
/// A far sign stands where a transformation puts it only as well as it turns, and odometry knows it: this share of its
/// distance.
pub(in crate::recognition) const FAR_SHARE: f64 = 0.15;
/// Pairs of one name that are looked at for other signs of the name.
pub(in crate::recognition) const PAIRS_MAX: usize = 16;
/// Signs this far apart tell in which direction a camera looks, in metres.
pub(in crate::recognition) const TELLS_A_DIRECTION_M: f64 = 2.0;

/// Two signs with names.
#[derive(Clone, Debug)]
pub struct NamePair {
    /// Around the query.
    pub query: Arc<LocalAnchor>,
    /// Around the candidate.
    pub candidate: Arc<LocalAnchor>,
    /// In how many places the name hangs, were the two one sign.
    pub places: usize,
    /// The way in which the two keyframes know it: themselves, by their local anchor maps, or, `No`, by the drive alone.
    pub known: Returning,
}

/// The pairs of two places.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Pairs that are called alike, and were not tracked from one to the other.
    pub alike: Vec<NamePair>,
    /// Pairs whose names exclude each other, and of which neither is known at the other place.
    pub excluding: Vec<NamePair>,
    /// Names of the query, each with one of the candidate, that exclude all names of their class at the other place; no name
    /// twice.
    pub strange: Vec<(LocalName, LocalName)>,
}

/// The pairs of names by the spots at which they hang.
#[derive(Clone, Debug, Default)]
pub struct Spots<'a> {
    /// At one spot, by the same name; each sign once, the nearest pairs first.
    pub agreeing: Vec<&'a NamePair>,
    /// By one name at two spots.
    pub displaced: Vec<&'a NamePair>,
    /// At one spot by names that exclude each other; each sign once.
    pub differing: Vec<&'a NamePair>,
}

impl NamePair {
    /// Returns the lower certainty of the two.
    pub fn certainty(&self) -> Certainty {
        self.query.certainty.min(self.candidate.certainty)
    }

    fn is_measured(&self) -> bool {
        self.query.is_measured_with(&self.candidate)
    }

    /// Returns how far apart the two are, as a share of what one spot may be; more than 1 is elsewhere.
    fn deviation(&self, transform: Option<&Sim3>, least_m: f64, settings: &Settings) -> f64 {
        let (a, b) = (&self.query.bearing, &self.candidate.bearing);
        let far_m = a.distance_m().min(b.distance_m()) * FAR_SHARE;
        let limit_m = least_m.max(far_m);
        if let Some(transform) = transform.filter(|_| self.is_measured()) {
            return (transform.transform(&self.query.centre_in_camera()) - self.candidate.centre_in_camera())
                .norm()
                / limit_m;
        }
        let turned = a.angle_difference_rad(b) / settings.anchor_map_max_angle_difference_rad;
        let apart = if self.is_measured() { a.distance_difference_m(b) / limit_m } else { 0.0 };
        if turned.is_nan() { apart } else { turned.max(apart) }
    }
}

impl Spots<'_> {
    /// Returns how far apart the two cameras stand by the signs that agree, and what their distances leave open, in metres, both
    /// cameras taken to be equally upright; none where the signs are too near each other to tell a direction.
    pub fn cameras_apart_m(&self) -> Option<(f64, f64)> {
        let measured = self.agreeing.iter().filter(|pair| pair.is_measured());
        let points: Vec<(Point3, Point3)> =
            measured.map(|pair| (pair.query.centre_in_camera(), pair.candidate.centre_in_camera())).collect();
        let (first, _) = points.first()?;
        let extent_m = points.iter().map(|(point, _)| (point - first).norm()).fold(0.0, f64::max);
        let down = Vector3::y();
        let candidate_from_query = align_upright(&points, &down, &down)?;
        let far_m = points.iter().map(|(point, _)| point.coords.norm()).fold(0.0, f64::max);
        let apart_m = candidate_from_query.centre().coords.norm();
        (extent_m >= TELLS_A_DIRECTION_M).then_some((apart_m, FAR_SHARE * far_m))
    }
}

impl Names {
    /// Finds the pairs between two lists of signs. `pair` makes a matched pair of two that are called alike; none where they
    /// were tracked from one to the other. `known` says how the two keyframes know it;
    /// `hangs_in_several`, whether a name hangs in several places.
    pub fn between<'a>(
        index: &MapIndex,
        query: &'a [Arc<LocalAnchor>],
        candidate: &'a [Arc<LocalAnchor>],
        pair: impl Fn(&'a LocalAnchor, &'a LocalAnchor, (u8, semantics::Source)) -> Option<Matched<'a>>,
        known: impl Fn(&Matched<'_>) -> Returning,
        mut hangs_in_several: impl FnMut(&NamePair) -> bool,
    ) -> Self {
        let settings = &index.properties().settings;
        let (of_query, of_candidate): (Vec<&LocalAnchor>, Vec<&LocalAnchor>) =
            (query.iter().map(Arc::as_ref).collect(), candidate.iter().map(Arc::as_ref).collect());
        let similar = SimilarPairs::between(&of_query, &of_candidate, index.texts(), settings);
        let alike = similar.iter().filter_map(|(i, found)| {
            let matched = pair(of_query[i], of_candidate[found.candidate], found.judged.clone())?;
            Some(NamePair {
                query: query[i].clone(),
                candidate: candidate[found.candidate].clone(),
                places: matched.places,
                known: known(&matched),
            })
        });
        let mut alike: Vec<NamePair> = alike.collect();
        for pair in alike.iter_mut().filter(|pair| pair.places == 1).take(PAIRS_MAX) {
            if hangs_in_several(pair) {
                pair.places = 2;
            }
        }
        let mut only = similar.unmatched_places();
        for places in &mut only {
            places.truncate(DIFFERING_MAX);
        }
        let exclusions = Exclusions::between(&of_query, &of_candidate);
        let strange = exclusions.strange(&only);
        let [only_query, only_candidate] = only;
        let excluding = only_query.iter().flat_map(|a| {
            only_candidate.iter().filter(|b| exclusions.has(*a, **b)).map(|b| NamePair {
                query: query[*a].clone(),
                candidate: candidate[*b].clone(),
                places: 1,
                known: Returning::No,
            })
        });
        Self { alike, excluding: excluding.collect(), strange }
    }

    /// Sorts the pairs by where the signs hang: under a transformation between the cameras, or else by bearing and distance.
    pub fn by_spot(&self, candidate_from_query: Option<&Sim3>, settings: &Settings) -> Spots<'_> {
        let least_m = settings.anchor_map_max_distance_difference_m;
        let agreeing =
            at_one_spot(&self.alike, |pair| pair.deviation(candidate_from_query, least_m, settings));
        let stands: BTreeSet<LocalName> =
            agreeing.iter().flat_map(|pair| [pair.query.name, pair.candidate.name]).collect();
        let is_off = |pair: &&NamePair| {
            pair.places == 1
                && pair.is_measured()
                && !stands.contains(&pair.query.name)
                && !stands.contains(&pair.candidate.name)
        };
        let mut displaced: Vec<&NamePair> = Vec::new();
        for pair in self.alike.iter().filter(is_off) {
            if displaced.iter().all(|known| known.query.name != pair.query.name) {
                displaced.push(pair);
            }
        }
        let spot_m = if candidate_from_query.is_some() { SAME_SPOT_M } else { least_m };
        let differing =
            at_one_spot(&self.excluding, |pair| pair.deviation(candidate_from_query, spot_m, settings));
        Spots { agreeing, displaced, differing }
    }
}

/// Returns the pairs at one spot, the nearest first, no sign twice.
fn at_one_spot(pairs: &[NamePair], deviation: impl Fn(&NamePair) -> f64) -> Vec<&NamePair> {
    let deviations = pairs.iter().map(|pair| (deviation(pair), pair));
    let mut near: Vec<(f64, &NamePair)> = deviations.filter(|(deviation, _)| *deviation < 1.0).collect();
    let names = |pair: &NamePair| (pair.query.name, pair.candidate.name);
    near.sort_by(|(a, x), (b, y)| a.total_cmp(b).then_with(|| names(x).cmp(&names(y))));
    let (mut taken, mut taken_of_candidate) = (BTreeSet::new(), BTreeSet::new());
    let mut kept = Vec::new();
    for (_, pair) in near {
        if !taken.contains(&pair.query.name) && !taken_of_candidate.contains(&pair.candidate.name) {
            taken.insert(pair.query.name);
            taken_of_candidate.insert(pair.candidate.name);
            kept.push(pair);
        }
    }
    kept
}
