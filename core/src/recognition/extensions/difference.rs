//! Differences: identifiers that differ between two local anchor maps, and why they did not count as contradictions.
//!
//! They explain a verdict and decide nothing. So only the heaviest anchors are compared, which are the nearest ones.

use std::collections::BTreeSet;

use super::contradiction::Contradiction;
use crate::domain::difference::{DifferenceEvidence, DifferenceReason};
use crate::domain::settings::Settings;
use crate::recognition::loops::anchor_map::{LocalAnchor, LocalAnchorMap, LocalName};
use crate::recognition::loops::comparison::Comparison;
use crate::recognition::loops::equation_1::{same_relative_place, similar};
use crate::recognition::map::index::TextIndex;
use crate::semantics;

/// Anchors of each map that an explanation looks at, so that a hall full of plates costs no more than a corridor.
pub const EXPLAINED_MAX: usize = 16;

/// Differences listed for one candidate.
pub const DIFFERENCES_MAX: usize = 8;

/// A pair of anchors of one class whose identifiers differ.
#[derive(Clone, Debug)]
pub struct Differing {
    query: LocalAnchor,
    candidate: LocalAnchor,
    query_identifier: String,
    candidate_identifier: String,
    /// Whether the judge sees a conflict.
    is_conflict: bool,
    /// The identifier that also hangs elsewhere in the other map.
    known: Option<String>,
}

/// Where two anchors stand to each other.
#[derive(Clone, Debug)]
pub enum Placement {
    /// At the same place.
    Same,
    /// Too far apart for that.
    Apart {
        /// By how much, in metres or radians.
        measured: f64,
        /// What is still the same place.
        limit: f64,
        /// The figure for a person: "2.3 m".
        told: String,
    },
}

/// What contradicts, and whether it was enough.
#[derive(Clone, Copy, Debug)]
pub struct Ruling<'a> {
    /// The pairs that count as contradictions.
    pub contradictions: &'a [Contradiction<'a>],
    /// The weight of what agrees with this place.
    pub agreement: f64,
}

impl Ruling<'_> {
    fn contradicting_weight(&self) -> f64 {
        self.contradictions.iter().fold(0.0, |sum, pair| sum + pair.weight())
    }
}

/// Finds for each of the heaviest unmatched anchors of the query the nearest anchor whose identifier differs.
pub fn find_differing(
    query: &LocalAnchorMap,
    candidate: &LocalAnchorMap,
    comparison: &Comparison<'_>,
    texts: &TextIndex,
    settings: &Settings,
) -> Vec<Differing> {
    let of_query = unmatched(query, comparison.matches.iter().map(|pair| pair.query.name).collect());
    let of_candidate =
        unmatched(candidate, comparison.matches.iter().map(|pair| pair.candidate.name).collect());
    let names = |pair: &Contradiction<'_>| (pair.query.name, pair.candidate.name);
    let counted: BTreeSet<(LocalName, LocalName)> = comparison.contradictions.iter().map(names).collect();
    let mut found: Vec<Differing> = Vec::new();
    for a in of_query {
        let differing = of_candidate.iter().filter(|b| differs(a, b, texts, settings));
        // Where the pair counts as a contradiction, that is the one to be explained.
        let ranked = differing.map(|b| (!counted.contains(&(a.name, b.name)), deviation(a, b, settings), b));
        let nearest = ranked.min_by(|(counted_b, off_b, b), (counted_c, off_c, c)| {
            (counted_b.cmp(counted_c)).then(off_b.total_cmp(off_c)).then(b.name.cmp(&c.name))
        });
        found.extend(nearest.map(|(.., b)| Differing::of(a, b, comparison)));
    }
    found.sort_by(|a, b| b.weight().total_cmp(&a.weight()).then_with(|| a.query.name.cmp(&b.query.name)));
    found.truncate(DIFFERENCES_MAX);
    found
}

/// Returns the heaviest anchors that bear an identifier and match nothing, by weight.
fn unmatched(map: &LocalAnchorMap, matched: BTreeSet<LocalName>) -> Vec<&LocalAnchor> {
    let has_identifier = |anchor: &LocalAnchor| anchor.text.as_ref().is_some_and(|text| text.has_name());
    map.heaviest(EXPLAINED_MAX, |anchor| !matched.contains(&anchor.name) && has_identifier(anchor))
}

/// Whether the two bear different identifiers; if these are no conflict, only at the same relative place.
fn differs(a: &LocalAnchor, b: &LocalAnchor, texts: &TextIndex, settings: &Settings) -> bool {
    let (Some(of_a), Some(of_b)) = (a.text.as_deref(), b.text.as_deref()) else { return false };
    a.class == b.class
        && (semantics::is_conflict(of_a, of_b)
            || (same_relative_place(a, b, settings) && similar(a, b, texts, settings).is_none()))
}

/// Returns how far two anchors are from the same relative place; below 1 they stand there.
fn deviation(a: &LocalAnchor, b: &LocalAnchor, settings: &Settings) -> f64 {
    let distance =
        a.bearing.distance_difference_m(&b.bearing) / settings.anchor_map_max_distance_difference_m;
    let distance = if a.is_measured_with(b) { distance } else { 0.0 };
    let angle = a.bearing.angle_difference_rad(&b.bearing) / settings.anchor_map_max_angle_difference_rad;
    // A limit of 0 lets nothing stand at the same place; 0/0 is then the nearest there is.
    [distance, angle].into_iter().filter(|share| !share.is_nan()).fold(0.0, f64::max)
}

/// Returns where two anchors stand to each other by bearing and distance (§V-B).
pub fn relative_placement(a: &LocalAnchor, b: &LocalAnchor, settings: &Settings) -> Placement {
    if same_relative_place(a, b, settings) {
        return Placement::Same;
    }
    let distance_m = a.bearing.distance_difference_m(&b.bearing);
    let limit_m = settings.anchor_map_max_distance_difference_m;
    let angle_rad = a.bearing.angle_difference_rad(&b.bearing);
    let limit_rad = settings.anchor_map_max_angle_difference_rad;
    if distance_m >= limit_m && a.is_measured_with(b) {
        let told =
            format!("{distance_m:.2} m nearer or farther, and less than {limit_m:.2} m is the same place");
        Placement::Apart { measured: distance_m, limit: limit_m, told }
    } else {
        let told = format!("{angle_rad:.2} rad aside, and less than {limit_rad:.2} rad is the same place");
        Placement::Apart { measured: angle_rad, limit: limit_rad, told }
    }
}

impl Differing {
    fn of(a: &LocalAnchor, b: &LocalAnchor, comparison: &Comparison<'_>) -> Self {
        let conflict = a.text.as_deref().zip(b.text.as_deref()).and_then(|(a, b)| semantics::conflict(a, b));
        let first = |anchor: &LocalAnchor| {
            let first = anchor.text.as_ref().and_then(|text| text.names().next());
            first.map_or_else(String::new, |name| name.as_str().to_owned())
        };
        let (query_identifier, candidate_identifier) = match conflict {
            Some(conflict) => (conflict.a.as_str().to_owned(), conflict.b.as_str().to_owned()),
            None => (first(a), first(b)),
        };
        let unknown = |anchors: &[&LocalAnchor], anchor: &LocalAnchor| {
            anchors.iter().any(|one| one.name == anchor.name)
        };
        let known = if !unknown(&comparison.unmatched_of_query, a) {
            Some(query_identifier.clone())
        } else if !unknown(&comparison.unmatched_of_candidate, b) {
            Some(candidate_identifier.clone())
        } else {
            None
        };
        Self {
            query: a.clone(),
            candidate: b.clone(),
            query_identifier,
            candidate_identifier,
            is_conflict: conflict.is_some(),
            known,
        }
    }

    /// Returns the anchor of the query's map.
    pub fn query(&self) -> &LocalAnchor {
        &self.query
    }

    /// Returns the anchor of the candidate's map.
    pub fn candidate(&self) -> &LocalAnchor {
        &self.candidate
    }

    fn weight(&self) -> f64 {
        self.query.weight + self.candidate.weight
    }

    /// Says why the pair did not stop the candidate; `None` if it did, and stands among the contradictions.
    pub fn explain(
        &self,
        placement: &Placement,
        ruling: Ruling<'_>,
        settings: &Settings,
    ) -> Option<DifferenceEvidence> {
        use DifferenceReason::{
            AnotherPlace, KnownElsewhere, NoConflict, Outweighed, PairedOtherwise, VetoOff,
        };
        let mut counted = ruling.contradictions.iter();
        let counts = counted
            .any(|pair| pair.query.name == self.query.name && pair.candidate.name == self.candidate.name);
        let contradicting = ruling.contradicting_weight();
        if counts && contradicting > ruling.agreement {
            return None;
        }
        let (here, there) = (&self.query_identifier, &self.candidate_identifier);
        let (reason, figures, detail) = if !settings.is_ours() {
            (VetoOff, None, String::from("the map's settings leave contradictions out"))
        } else if counts {
            let figures = Some((contradicting, ruling.agreement));
            (Outweighed, figures, format!("reads {here} where {there} hung, and what agrees weighs no less"))
        } else if !self.is_conflict {
            (NoConflict, None, self.judgement())
        } else if let Placement::Apart { measured, limit, told } = placement {
            (AnotherPlace, Some((*measured, *limit)), format!("{here} stands elsewhere than {there}: {told}"))
        } else if let Some(known) = &self.known {
            let detail =
                format!("{known} also hangs elsewhere in the other map: another view, not another place");
            (KnownElsewhere, None, detail)
        } else {
            let detail = format!("{here} or {there} contradicts another sign already, and each counts once");
            (PairedOtherwise, None, detail)
        };
        Some(DifferenceEvidence {
            query_anchor: self.query.name.public(),
            candidate_anchor: self.candidate.name.public(),
            query_identifier: here.clone(),
            candidate_identifier: there.clone(),
            reason,
            measured: figures.map(|(measured, _)| measured),
            limit: figures.map(|(_, limit)| limit),
            detail,
        })
    }

    fn judgement(&self) -> String {
        let texts = self.query.text.as_deref().zip(self.candidate.text.as_deref());
        texts.map_or_else(String::new, |(a, b)| semantics::similarity(a, b).reason)
    }
}
