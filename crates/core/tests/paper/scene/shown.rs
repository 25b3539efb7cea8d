//! What a scene shows: an anchor with all that follows about it, and how values are compared.

use revisit_core::domain::anchor::{AnchorState, Outcome};
use revisit_core::domain::ids::{AnchorSeq, KeyframeId};
use revisit_core::domain::report::AnchorMatchReport;
use revisit_core::domain::verdict::{AnchorEvidence, EvidenceKind, Reason};
use revisit_core::geometry::{Aabb, Point3};
use revisit_core::recognition::anchors::matching::{matches, neighbourhood};
use revisit_core::recognition::loops::anchor_map::LocalAnchor;
use revisit_core::recognition::map::index::MergedAnchor;
use revisit_core::recognition::odds::log_odds::LogOdds;
use revisit_core::{Candidate, MapIndex, ReasonCode, Verdict, semantics};

/// An anchor of a scene as it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Sign {
    pub id: AnchorSeq,
    pub class: String,
    /// What is known of it, and of the anchors that go by its name.
    pub object: MergedAnchor,
    /// The keyframes that saw it, in order of arrival.
    pub keyframes: Vec<String>,
    /// Its box in the frame of each session that saw it, oldest session first.
    pub frames: Vec<(String, Aabb)>,
    /// The anchors that match it, oldest first.
    pub matches: Vec<AnchorMatchReport>,
    /// The anchor whose name it goes by, if that is another.
    pub merged_into: Option<AnchorSeq>,
    /// The shapes of the building's numbers on things of its class.
    pub numbering: Vec<String>,
}

impl Sign {
    pub(super) fn of(map: &MapIndex, id: AnchorSeq) -> Option<Self> {
        let root = map.objects().root(id)?;
        let object = if root == id { map.objects().get(id)?.clone() } else { map.anchor_alone(id)? };
        let class = map.class_of(&object).to_owned();
        let keyframe = |seq| map.keyframe(seq).map(|keyframe| keyframe.id.to_string());
        let session = |seq: usize| map.sessions()[seq].to_string();
        let numbering = map.readings().numbering(&class).into_iter();
        Some(Self {
            id,
            keyframes: map.keyframes_of(&object).into_iter().filter_map(keyframe).collect(),
            frames: (object.shapes.iter())
                .filter_map(|(seq, shape)| Some((session(seq.index()), shape.aabb?)))
                .collect(),
            matches: if root == id { matches_of(map, id, &object) } else { Vec::new() },
            merged_into: (root != id).then_some(root),
            numbering: numbering
                .flat_map(|numbering| numbering.learned_or_given().map(str::to_owned))
                .collect(),
            class,
            object,
        })
    }

    /// Returns what it is called; empty if nothing has described it.
    pub fn description(&self) -> &str {
        self.object.description.as_ref().map_or("", |description| &description.raw)
    }

    pub fn state(&self) -> AnchorState {
        self.object.state
    }

    /// Returns the InformationLevel of its description, 1 if it has none.
    pub fn information_level(&self) -> u8 {
        self.object.description.as_ref().map_or(1, |description| description.information_level)
    }

    /// Returns how many distinct map points it has.
    pub fn map_points(&self) -> usize {
        self.object.shapes.values().map(|shape| shape.map_points.len()).sum()
    }

    /// Returns its box in the frame of the oldest session that saw it.
    pub fn aabb(&self) -> Aabb {
        self.frames.first().unwrap_or_else(|| panic!("it is nowhere: {self:#?}")).1
    }

    pub fn centre(&self) -> Point3 {
        self.aabb().centre()
    }

    /// Returns its readings, heaviest first: text, weight and count.
    pub fn readings(&self) -> Vec<(String, f64, usize)> {
        let report = self.object.votes.report().into_iter();
        report.map(|reading| (reading.text, reading.weight, reading.count)).collect()
    }
}

fn matches_of(map: &MapIndex, id: AnchorSeq, object: &MergedAnchor) -> Vec<AnchorMatchReport> {
    let near = neighbourhood(map, id);
    let texts = map.texts();
    let report = |other| {
        let (level, source) = texts.level(texts.of(id)?, texts.of(other)?)?;
        let theirs = map.objects().get(other)?.description.as_ref()?;
        Some(AnchorMatchReport {
            anchor: other,
            name: map.anchor_name(other),
            level,
            source: source.as_str().to_owned(),
            revisit: !near.contains(&other),
            reason: semantics::similarity(&object.description.as_ref()?.text, &theirs.text).reason,
        })
    };
    let mut found: Vec<AnchorMatchReport> = matches(map, id).filter_map(report).collect();
    found.sort_by_key(|report| report.anchor);
    found
}

/// Returns the name of what became of a detection.
pub fn named(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Created(_) => "created",
        Outcome::Observed(_) => "observed",
        Outcome::Ignored(_) => "ignored",
    }
}

/// Returns keyframes as text.
pub fn ids<'a>(keyframes: impl IntoIterator<Item = &'a KeyframeId>) -> Vec<String> {
    keyframes.into_iter().map(ToString::to_string).collect()
}

/// Returns the keyframes of a verdict's candidates, best first.
pub fn candidates(verdict: &Verdict) -> Vec<String> {
    ids(verdict.candidates.iter().map(|candidate| &candidate.keyframe))
}

/// Returns the comparison of the two local anchor maps.
#[track_caller]
pub fn anchors(candidate: &Candidate) -> &AnchorEvidence {
    candidate.anchors.as_ref().unwrap_or_else(|| panic!("it came not so far: {candidate:#?}"))
}

/// Returns why a candidate was stopped.
#[track_caller]
pub fn reason(candidate: &Candidate) -> &Reason {
    candidate.reason.as_ref().unwrap_or_else(|| panic!("nothing stopped it: {candidate:#?}"))
}

/// Returns the word of the check that stopped a candidate, if one did.
pub fn code(candidate: &Candidate) -> Option<ReasonCode> {
    candidate.reason.as_ref().map(|reason| reason.code)
}

/// Returns the terms of the sum of evidence for a candidate, in their order.
#[track_caller]
pub fn terms(candidate: &Candidate) -> Vec<(EvidenceKind, LogOdds)> {
    let odds = candidate.odds.as_ref().unwrap_or_else(|| panic!("it was not weighed: {candidate:#?}"));
    odds.terms.iter().map(|term| (term.kind, LogOdds::of(term.log_odds))).collect()
}

/// Returns the confidence in a candidate.
#[track_caller]
pub fn confidence(candidate: &Candidate) -> f64 {
    candidate.odds.as_ref().unwrap_or_else(|| panic!("it was not weighed: {candidate:#?}")).confidence
}

/// Returns what the anchors of a local map are called; empty where nothing has described one.
pub fn descriptions(anchors: &[LocalAnchor]) -> Vec<String> {
    anchors.iter().map(|anchor| anchor.description.as_deref().unwrap_or_default().to_owned()).collect()
}

/// Answers are exact to nine decimals.
#[track_caller]
pub fn close_to(what: &str, got: f64, expected: f64) {
    assert!((got - expected).abs() < 2e-9, "{what}: {got}, not {expected}");
}

/// The same for a figure that may be missing.
#[track_caller]
pub fn told(what: &str, got: Option<f64>, expected: f64) {
    close_to(what, got.unwrap_or_else(|| panic!("{what}: no figure")), expected);
}

/// The same for a vector.
#[track_caller]
pub fn close_to_all(what: &str, got: impl Into<[f64; 3]>, expected: [f64; 3]) {
    for (got, expected) in got.into().into_iter().zip(expected) {
        close_to(what, got, expected);
    }
}
