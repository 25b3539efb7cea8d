//! The answer to "is this keyframe a loop?", with the figures of every check that ran (§V).

pub use super::anchor_name::AnchorName;
use super::channel::ProposedBy;
use super::ids::{KeyframeId, LoopId};
use super::look_for::LookFor;
use super::reason::ReasonClass;
pub use super::reason::{Reason, ReasonCode};
use crate::geometry::{Bearing, Sim3};
use crate::named::named;
use crate::semantics::TextKind;

named! {
    /// The answer to a loop query.
    Decision {
        /// At least one candidate passed every check that could run.
        Loop = "loop",
        /// Every candidate was rejected, or there was none.
        NoLoop = "no_loop",
        /// No candidate passed, and missing facts could turn the answer of at least one.
        Undecided = "undecided",
    }
}

named! {
    /// The decision on one candidate.
    CandidateDecision {
        /// It passed every check that could run.
        Loop = "loop",
        /// Missing facts could turn the answer.
        Undecided = "undecided",
        /// A check stopped it.
        Rejected = "rejected",
    }
}

impl CandidateDecision {
    /// Whether a reason of this class may stand beside the decision.
    pub fn fits(self, class: ReasonClass) -> bool {
        match class {
            ReasonClass::Rejects => self == Self::Rejected,
            ReasonClass::Undecided | ReasonClass::Waits => self == Self::Undecided,
            ReasonClass::Depends => self != Self::Loop,
        }
    }
}

/// Check 2 of §V: bag of words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BowEvidence {
    /// DBoW2's L1 score, in `[0, 1]`.
    pub score: f64,
    /// The number of words that the two keyframes share.
    pub common_words: u32,
    /// The lowest score of the query against its covisible keyframes; 0 without any.
    pub reference_score: f64,
}

/// A pair of anchors that match, x(i, j) = 1 of Eq. (1).
#[derive(Clone, Debug, PartialEq)]
pub struct MatchEvidence {
    /// The anchor of the query's local map.
    pub query_anchor: AnchorName,
    /// The anchor of the candidate's local map.
    pub candidate_anchor: AnchorName,
    /// The kind of the query's text.
    pub kind: TextKind,
    /// SimilarityLevel of the two descriptions, 1 to 5.
    pub level: u8,
    /// The judge.
    pub source: String,
    /// Angle between the two bearings, in radians.
    pub angle_difference_rad: f64,
    /// Difference of the two distances, in metres.
    pub distance_difference_m: f64,
    /// The pair's two weights together, as Eq. (2) adds them.
    pub weight: f64,
}

/// A pair of anchors whose sure identifiers exclude each other at the same relative place.
#[derive(Clone, Debug, PartialEq)]
pub struct ContradictionEvidence {
    /// The anchor of the query's local map.
    pub query_anchor: AnchorName,
    /// The anchor of the candidate's local map.
    pub candidate_anchor: AnchorName,
    /// One sentence for a person: "reads 910 where 901 hung".
    pub reason: String,
    /// The pair's two weights together.
    pub weight: f64,
}

/// Check 3 of §V: the comparison of the two local anchor maps.
#[derive(Clone, Debug, PartialEq)]
pub struct AnchorEvidence {
    /// S of Eq. (2).
    pub similarity: f64,
    /// The threshold that S must exceed.
    pub threshold: f64,
    /// Valid anchors in the query's local map.
    pub in_query: usize,
    /// Valid anchors in the candidate's local map.
    pub in_candidate: usize,
    /// Anchors of both maps that nothing has described yet.
    pub pending: usize,
    /// The pairs that match.
    pub matches: Vec<MatchEvidence>,
    /// Whether one of them hangs in one place only.
    pub is_distinctive: bool,
    /// The pairs that contradict.
    pub contradictions: Vec<ContradictionEvidence>,
}

/// The last step of §V: the similarity transformation.
#[derive(Clone, Debug, PartialEq)]
pub struct GeometryEvidence {
    /// `verified`, `failed` or `skipped`.
    pub status: GeometryStatus,
    /// The reason why it was skipped or failed, for a person.
    pub reason: Option<String>,
    /// The figures, if it ran.
    pub figures: Option<GeometryFigures>,
}

/// The figures of a geometric verification.
#[derive(Clone, Debug, PartialEq)]
pub struct GeometryFigures {
    /// The model: `sim3`, `se3`, `essential`, `homography` or `rotation`.
    pub model: &'static str,
    /// Descriptor matches between points with positions on both sides.
    pub matches: u32,
    /// Samples that RANSAC drew.
    pub hypotheses: u32,
    /// Matches that the final transformation explains, after the guided search.
    pub inliers: u32,
    /// The decimal logarithm of the number of false alarms: how often chance explains as many.
    pub log10_false_alarms: Option<f64>,
    /// The inliers' mean reprojection error in both images, in pixels.
    pub mean_reprojection_error_px: Option<f64>,
    /// Maps points of the query's camera frame into the candidate's, in metres.
    pub candidate_from_query: Option<Sim3>,
    /// The covariance of a verified similarity, 6 by 6.
    pub covariance: Option<[f64; 36]>,
}

named! {
    /// The status of a geometric verification.
    GeometryStatus default Failed {
        /// It did not run; `reason` says why.
        Skipped = "skipped",
        /// It ran and found no transformation that explains enough.
        Failed = "failed",
        /// It ran and found one.
        Verified = "verified",
    }
}

named! {
    /// The kind of a term of the sum of evidence for a place (M64).
    EvidenceKind {
        /// A sign with a name is read here and there, and hangs in one place.
        Name = "name",
        /// The same, of a name that hangs in several places: it tells none of them.
        SharedName = "shared_name",
        /// At one spot two names are read that exclude each other.
        OtherName = "other_name",
        /// Around the one and around the other names are read that the other has not, wherever they hang.
        StrangeNames = "strange_names",
        /// Signs of the query that nobody read at the candidate.
        Absent = "absent",
        /// A name is read here and there, and would hang in two places.
        DisplacedName = "displaced_name",
        /// Pictures, notices and other texts agree. A copy of the place would show them, too.
        Texts = "texts",
        /// Geometry explains part of the view. A copy of the place would look the same.
        View = "view",
        /// Geometry finds no common view.
        NoView = "no_view",
        /// By the transformation the two cameras are farther apart than a place is wide.
        Apart = "apart",
        /// Odometry has the robot here, or elsewhere.
        Odometry = "odometry",
        /// Looks, pictures, notices and views together prove no more than that there is no copy of this place.
        Copy = "copy",
        /// Names tell it from far places, and not from the place next to it.
        Neighbour = "neighbour",
        /// Another place of the map is as likely.
        Rival = "rival",
        /// Crops that nobody has read yet may speak against it.
        Unread = "unread",
    }
}

/// One term of the sum of evidence for a place.
#[derive(Clone, Debug, PartialEq)]
pub struct EvidenceTerm {
    /// Its kind.
    pub kind: EvidenceKind,
    /// The signs that it rests on: the query's, and the candidate's.
    pub pairs: Vec<(AnchorName, AnchorName)>,
    /// The texts of the signs, or the number of cells or metres, for people.
    pub about: String,
    /// Its log-odds, natural: positive for the place.
    pub log_odds: f64,
}

/// The odds of a place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Odds {
    /// The terms of the sum.
    pub terms: Vec<EvidenceTerm>,
    /// The confidence that the query was taken there, 0 to 1.
    pub confidence: f64,
}

/// One candidate with its evidence and the check that stopped it.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The candidate's name.
    pub keyframe: KeyframeId,
    /// Its status.
    pub decision: CandidateDecision,
    /// What proposed it, where the query has a global descriptor; else none.
    pub proposed: Option<ProposedBy>,
    /// Check 2.
    pub bow: BowEvidence,
    /// Check 3, if it came so far.
    pub anchors: Option<AnchorEvidence>,
    /// The last step.
    pub geometry: GeometryEvidence,
    /// The odds of its place; none under the paper's method, or where an earlier check stopped it.
    pub odds: Option<Odds>,
    /// The check that stopped it; none for a loop.
    pub reason: Option<Reason>,
}

/// The whole answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The map's version that was asked.
    pub map_version: u64,
    /// The answer.
    pub decision: Decision,
    /// One sentence for a person: why.
    pub why: String,
    /// The confidence in the best place; none under the paper's method, or without a candidate that was weighed.
    pub confidence: Option<f64>,
    /// The best loop, if any.
    pub best: Option<KeyframeId>,
    /// Every loop, best first.
    pub loops: Vec<KeyframeId>,
    /// Whether a stand-in judged because a model was away.
    pub degraded: bool,
    /// Whether the map has shown one view in two places, around which different signs hang.
    pub has_twins: bool,
    /// The number of keyframes left out because they are covisible with the query (check 1).
    pub excluded_covisible: usize,
    /// The confirmed loops of the query's keyframe, by id, then those that a candidate would repeat (M63); at most [`CLOSED_MAX`].
    pub closed: Vec<ClosedLoop>,
    /// Why, where no candidate says it: there is none, or the loop is closed already.
    pub reason: Option<Reason>,
    /// The signs that would tell, each with the number of its candidate, where it is undecided.
    pub look_for: Vec<LookFor>,
    /// The candidates: loops first, then undecided, then rejected, each best first.
    pub candidates: Vec<Candidate>,
}

/// Confirmed loops that a verdict lists.
pub const CLOSED_MAX: usize = 100;

/// A confirmed loop of the keyframe that was asked about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClosedLoop {
    /// The loop.
    pub id: LoopId,
    /// The keyframe at its other end: the place that the return is closed with.
    pub keyframe: KeyframeId,
}

named! {
    /// The checks that a query asks for.
    Verify default Auto {
        /// The default: geometry where both keyframes have the features for it, else the anchors decide.
        Auto = "auto",
        /// Never geometry.
        Anchors = "anchors",
        /// Geometry must verify.
        Geometry = "geometry",
    }
}

/// One anchor of a local anchor map M_k, as `GET .../local-anchor-map` shows it (§V-A).
#[derive(Clone, Debug, PartialEq)]
pub struct LocalAnchorReport {
    /// The anchor.
    pub anchor: AnchorName,
    /// Its class.
    pub class: String,
    /// Its state.
    pub state: super::anchor::AnchorState,
    /// Its description, if it has one.
    pub description: Option<String>,
    /// The kind of that.
    pub kind: Option<TextKind>,
    /// Its bearing and distance from the central keyframe.
    pub bearing: Bearing,
    /// Its weight in Eq. (2).
    pub weight: f64,
}
