//! Answers: the fields of the server's answers that a client uses; any other field is passed over.

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};

use crate::wire::geometry::Similarity;

/// A map was declared.
#[derive(Clone, Debug, Deserialize)]
pub struct MapAnswer {
    /// The map's version after it.
    #[serde(default)]
    pub map_version: Option<u64>,
    /// The same map was declared before, and nothing changed.
    #[serde(skip)]
    pub replayed: bool,
}

/// A keyframe is stored.
#[derive(Clone, Debug, Deserialize)]
pub struct KeyframeAnswer {
    /// Its id.
    pub keyframe: String,
    /// The map's version after it.
    #[serde(default)]
    pub map_version: Option<u64>,
    /// With how many keyframes it is covisible.
    #[serde(default)]
    pub covisible: u64,
    /// What became of each detection, in the order sent.
    #[serde(default)]
    pub detections: Vec<DetectionAnswer>,
    /// The loop query's answer, if it was asked in the same round trip.
    #[serde(default, rename = "loop")]
    pub loop_answer: Option<LoopAnswer>,
    /// The same keyframe was stored before, and nothing changed.
    #[serde(skip)]
    pub replayed: bool,
}

/// A keyframe as it is read back.
#[derive(Clone, Debug, Deserialize)]
pub struct StoredKeyframe {
    /// Outcomes of its detections, in the order sent.
    #[serde(default)]
    pub detections: Vec<DetectionAnswer>,
}

/// What became of one detection.
#[derive(Clone, Debug, Deserialize)]
pub struct DetectionAnswer {
    /// The anchor it feeds.
    #[serde(default)]
    pub anchor: Option<String>,
    /// `created`, `observed` or `ignored`.
    pub outcome: String,
    /// Why, if it was ignored.
    #[serde(default)]
    pub reason: Option<String>,
    /// `pending`, `valid`, `uninformative` or `retired`.
    #[serde(default)]
    pub state: Option<String>,
}

/// The answer to "is this keyframe a loop?".
#[derive(Clone, Debug, Deserialize)]
pub struct LoopAnswer {
    /// The query's id, to read the verdict back.
    pub id: String,
    /// The answer.
    pub verdict: Verdict,
    /// The keyframe to close the loop with.
    #[serde(default)]
    pub best: Option<String>,
    /// Every keyframe that passed.
    #[serde(default)]
    pub loops: Vec<String>,
    /// Something that should have run could not.
    #[serde(default)]
    pub degraded: bool,
    /// Every candidate with its figures.
    #[serde(default)]
    pub candidates: Vec<Candidate>,
    /// Why, where no single candidate is the reason.
    #[serde(default)]
    pub reason: Option<Reason>,
    /// The map's version that was asked.
    #[serde(default)]
    pub map_version: Option<u64>,
}

/// The three answers of a loop query.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Passed every check that could run.
    Loop,
    /// A check said no.
    NoLoop,
    /// What is missing could turn the answer.
    Undecided,
}

/// A keyframe that was compared with the query.
#[derive(Clone, Debug, Deserialize)]
pub struct Candidate {
    /// Its id.
    pub keyframe: String,
    /// What the checks said.
    pub verdict: CandidateVerdict,
    /// Check 1: bags of words.
    #[serde(default)]
    pub bow: Option<BowFigures>,
    /// Check 2: local anchor maps.
    #[serde(default)]
    pub anchors: Option<AnchorFigures>,
    /// Check 3: geometry.
    #[serde(default)]
    pub geometry: Option<GeometryFigures>,
    /// The check that stopped it.
    #[serde(default)]
    pub reason: Option<Reason>,
}

/// The three answers of a candidate.
///
/// In the order of how near they are to a loop.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord)]
#[serde(rename_all = "snake_case")]
pub enum CandidateVerdict {
    /// A check said no.
    Rejected,
    /// What is missing could turn the answer.
    Undecided,
    /// Passed every check that could run.
    Loop,
}

/// Figures of the bag-of-words check.
#[derive(Clone, Debug, Deserialize)]
pub struct BowFigures {
    /// L1 score, 0 to 1.
    #[serde(default)]
    pub score: Option<f64>,
}

/// Figures of the anchor check.
#[derive(Clone, Debug, Deserialize)]
pub struct AnchorFigures {
    /// S of Eq. (2); none where both local maps are empty.
    #[serde(default)]
    pub similarity: Option<f64>,
    /// Anchors in the query's local map.
    #[serde(default)]
    pub in_query: u64,
    /// Anchors in the candidate's local map.
    #[serde(default)]
    pub in_candidate: u64,
    /// The pairs that match.
    #[serde(default)]
    pub matches: Vec<AnchorMatch>,
    /// The pairs that contradict.
    #[serde(default)]
    pub contradictions: Vec<AnchorContradiction>,
}

/// An anchor of the query's local map and one of the candidate's that match.
#[derive(Clone, Debug, Deserialize)]
pub struct AnchorMatch {
    /// The query's.
    pub query_anchor: String,
    /// The candidate's.
    pub candidate_anchor: String,
    /// What the pair adds to the numerator of Eq. (2).
    #[serde(default)]
    pub weight: f64,
}

/// An anchor of each side that cannot be one object.
#[derive(Clone, Debug, Deserialize)]
pub struct AnchorContradiction {
    /// The query's.
    pub query_anchor: String,
    /// The candidate's.
    pub candidate_anchor: String,
    /// For a person: "reads 910 where 901 hung".
    pub reason: String,
}

/// Figures of the geometric check.
#[derive(Clone, Debug, Deserialize)]
pub struct GeometryFigures {
    /// `verified`, `failed` or `skipped`.
    pub status: String,
    /// `se3` or `sim3`; `essential`, `homography` and `rotation` leave the length of the translation open.
    #[serde(default)]
    pub model: Option<String>,
    /// Descriptor matches.
    #[serde(default)]
    pub matches: Option<u64>,
    /// Matches that agree with the transform.
    #[serde(default)]
    pub inliers: Option<u64>,
    /// The transform itself: `point_in_candidate = scale * rotation * point_in_query + translation`.
    #[serde(default)]
    pub candidate_from_query: Option<Similarity>,
}

impl GeometryFigures {
    /// The transform, if its lengths are known: a pose graph must not take a translation of length 1 for one.
    pub fn full_transform(&self) -> Option<&Similarity> {
        let is_full = matches!(self.model.as_deref(), Some("se3" | "sim3"));
        self.candidate_from_query.as_ref().filter(|_| is_full)
    }
}

/// Why a check said no, or could not say.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct Reason {
    /// A word for programs.
    pub code: String,
    /// What was measured.
    #[serde(default)]
    pub measured: Option<f64>,
    /// What it was held against.
    #[serde(default)]
    pub limit: Option<f64>,
    /// One sentence for a person.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detail: Option<String>,
}

/// A loop is closed.
#[derive(Clone, Debug, Deserialize)]
pub struct ClosedLoop {
    /// Its id.
    pub id: String,
    /// The anchors that became one.
    #[serde(default)]
    pub merged: Vec<Merged>,
}

/// Two anchors became one.
#[derive(Clone, Debug, Deserialize)]
pub struct Merged {
    /// The one that stays.
    pub into: String,
    /// The one that went.
    pub from: String,
}

impl LoopAnswer {
    /// The candidate that the answer is about: `best`, or the one that came nearest to being it,
    /// an undecided one before a rejected one, then in the order that chooses `best` (inliers, S,
    /// BoW score, smallest id).
    pub fn leading(&self) -> Option<&Candidate> {
        match &self.best {
            Some(best) => self.candidate(best),
            None => self.candidates.iter().max_by(|a, b| a.nearness(b)),
        }
    }

    /// The best loop with the transformation to close it with.
    pub fn best_transform(&self) -> Option<(&str, &Similarity)> {
        let best = self.candidate(self.best.as_deref()?)?;
        Some((&best.keyframe, best.geometry.as_ref()?.candidate_from_query.as_ref()?))
    }

    /// The candidate of this id.
    pub fn candidate(&self, keyframe: &str) -> Option<&Candidate> {
        self.candidates.iter().find(|candidate| candidate.keyframe == keyframe)
    }
}

impl Candidate {
    /// BoW score; 0 for one that came by its anchors alone.
    pub fn bow_score(&self) -> f64 {
        self.bow.as_ref().and_then(|bow| bow.score).unwrap_or(0.0)
    }

    /// S of Eq. (2), where it could be taken.
    pub fn similarity(&self) -> Option<f64> {
        self.anchors.as_ref().and_then(|anchors| anchors.similarity)
    }

    /// Inliers of the geometry, where it ran.
    pub fn inliers(&self) -> Option<u64> {
        self.geometry.as_ref().and_then(|geometry| geometry.inliers)
    }

    /// Less: further from being `best`.
    pub fn nearness(&self, other: &Self) -> Ordering {
        let similarity = |candidate: &Self| candidate.similarity().unwrap_or(0.0);
        let verdict = self.verdict.cmp(&other.verdict);
        verdict
            .then(self.inliers().cmp(&other.inliers()))
            .then(similarity(self).total_cmp(&similarity(other)))
            .then(self.bow_score().total_cmp(&other.bow_score()))
            .then(other.keyframe.cmp(&self.keyframe))
    }
}
