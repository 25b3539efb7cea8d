//! Verdict: the answer to a loop query, each candidate with its figures and the check that stopped it (`openapi/openapi.yaml`).

use revisit_core::domain::channel::ProposedBy;
use revisit_core::domain::ids::KeyframeId;
use revisit_core::domain::look_for::LookFor;
use revisit_core::domain::request::Detail;
use revisit_core::domain::verdict::{
    AnchorEvidence, BowEvidence, Candidate, CandidateDecision, ClosedLoop, ContradictionEvidence,
    MatchEvidence, Reason, Verdict,
};
use revisit_shapes::answer;

use super::geometry::GeometryView;
use super::names::{CandidateVerdictName, ChannelName, ReasonCodeName, TextKindName, VerdictName};
use super::odds::EvidenceView;
use super::space::rounded;

/// The answer to "is this keyframe a loop?". The same map version, keyframe, settings and seed give the same bytes.
#[answer]
pub struct LoopAnswer {
    /// The query's id, derived from what was asked, so that it repeats too.
    pub id: String,
    /// The keyframe that was asked about; left out for an inline one.
    pub keyframe: Option<String>,
    /// The map's version that was asked.
    pub map_version: u64,
    /// The answer.
    pub verdict: VerdictName,
    /// One sentence for a person: why.
    #[serde(default)]
    pub why: String,
    /// The confidence in the best place, 0 to 1; left out under `"method": "paper"`, and where no candidate was weighed.
    pub confidence: Option<f64>,
    /// The keyframe to close the loop with; null unless the verdict is `loop`.
    #[schema(required)]
    #[null]
    pub best: Option<String>,
    /// Every keyframe that passed, best first.
    pub loops: Vec<String>,
    /// Whether a stand-in judged because a model was away.
    pub degraded: bool,
    /// Whether the map has shown one view in two places, around which different signs hang (see the map's `twins`). Left
    /// out where it has not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub has_twins: bool,
    /// Number of keyframes that are not candidates because they are covisible with the query.
    pub excluded_covisible: usize,
    /// The loops of this keyframe that are confirmed already, by id, at most 100.
    #[schema(max_items = 100)]
    pub closed: Vec<ClosedView>,
    /// Why, where no candidate says it: there is none, or the loop is confirmed and no other is left.
    pub reason: Option<ReasonView>,
    /// The signs that would tell where it is undecided, the nearest to the best candidate first. Left out where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 8)]
    pub look_for: Vec<SignView>,
    /// The candidates: loops first, then undecided, then rejected, each best first. With `?detail=brief` the rejected ones are
    /// left out.
    pub candidates: Vec<CandidateView>,
}

/// A sign that would tell whether the query was taken at a candidate.
#[answer]
#[schema(as = SignToLookFor)]
pub struct SignView {
    /// The candidate near which it hangs.
    pub keyframe: String,
    /// Its class.
    pub class: String,
    /// Its description.
    pub description: String,
    /// `[x,y,z]` in the frame of the candidate's session, in metres.
    #[schema(min_items = 3, max_items = 3)]
    pub position: [f64; 3],
}

/// A confirmed loop of the keyframe that was asked about.
#[answer(of = &ClosedLoop)]
#[schema(as = ConfirmedLoop)]
pub struct ClosedView {
    /// The loop.
    #[from(&of.id)]
    pub r#loop: String,
    /// The keyframe at its other end.
    pub keyframe: String,
}

/// A keyframe that was compared with the query.
#[answer]
#[schema(as = Candidate)]
pub struct CandidateView {
    /// The candidate.
    pub keyframe: String,
    /// The outcome of its checks.
    pub verdict: CandidateVerdictName,
    /// The channels that proposed it, where the query has a global descriptor; else left out.
    #[schema(max_items = 3)]
    pub channel: Option<Vec<ChannelName>>,
    /// Global descriptors, where both keyframes have one.
    pub global: Option<GlobalFigures>,
    /// Bag of words; left out where `channel` is `global` alone.
    pub bow: Option<BowFigures>,
    /// Local anchor maps, if it came so far.
    pub anchors: Option<AnchorFigures>,
    /// Geometry.
    pub geometry: GeometryView,
    /// The confidence that the query was taken there, 0 to 1; left out under `"method": "paper"`.
    pub confidence: Option<f64>,
    /// The terms of the sum of evidence; left out where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub evidence: Vec<EvidenceView>,
    /// The check that stopped it; left out for a loop.
    pub reason: Option<ReasonView>,
}

/// Figures of the comparison of the two global descriptors.
#[answer]
#[derive(Copy)]
pub struct GlobalFigures {
    /// The cosine of the two vectors, 0 where it is negative; bits count as 1 and -1.
    pub similarity: f64,
}

/// Figures of the bag-of-words check.
#[answer(of = BowEvidence)]
pub struct BowFigures {
    /// DBoW2's L1 score, 0 to 1.
    #[rounded]
    pub score: f64,
    /// Number of words that the two keyframes share.
    pub common_words: u32,
    /// The lowest score of the query against its covisible keyframes, 0 without any.
    #[rounded]
    pub reference_score: f64,
}

/// Figures of the comparison of the two local anchor maps.
#[answer]
pub struct AnchorFigures {
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
    /// The pairs that match; left out with `?detail=brief`.
    pub matches: Option<Vec<MatchView>>,
    /// The pairs that contradict.
    pub contradictions: Vec<ContradictionView>,
}

/// A pair of anchors that match.
#[answer(of = &MatchEvidence)]
#[schema(as = Match)]
pub struct MatchView {
    /// The anchor of the query's local map; `inline-0` is the first detection of an inline keyframe.
    pub query_anchor: String,
    /// The anchor of the candidate's local map.
    pub candidate_anchor: String,
    /// The kind of the query's text.
    pub kind: TextKindName,
    /// SimilarityLevel of the two descriptions, 1 to 5.
    #[schema(minimum = 1, maximum = 5)]
    pub level: u8,
    /// The judge.
    pub source: String,
    /// Angle between the two bearings, in radians.
    #[rounded]
    pub angle_difference_rad: f64,
    /// Difference of the two distances, in metres.
    #[rounded]
    pub distance_difference_m: f64,
    /// The pair's two weights together, as Eq. (2) adds them, in 1/m.
    #[rounded]
    pub weight: f64,
}

/// A pair of anchors whose sure identifiers exclude each other at the same relative place.
#[answer(of = &ContradictionEvidence)]
#[schema(as = Contradiction)]
pub struct ContradictionView {
    /// The anchor of the query's local map.
    pub query_anchor: String,
    /// The anchor of the candidate's local map.
    pub candidate_anchor: String,
    /// One sentence for a person.
    pub reason: String,
    /// The pair's two weights together, in 1/m.
    #[rounded]
    pub weight: f64,
}

/// The check that decided, with what it measured and what it asked for.
#[answer(of = &Reason)]
#[schema(as = Reason)]
pub struct ReasonView {
    /// The check, as a word for programs.
    pub code: ReasonCodeName,
    /// The measured value, in the check's own unit.
    #[rounded]
    pub measured: Option<f64>,
    /// The value that it was compared with.
    #[rounded]
    pub limit: Option<f64>,
    /// One sentence for a person.
    pub detail: String,
}

impl LoopAnswer {
    /// Returns the answer of a query.
    pub fn of(id: &str, keyframe: Option<&KeyframeId>, verdict: &Verdict, detail: Detail) -> Self {
        let is_listed = |candidate: &&Candidate| {
            detail == Detail::Full || candidate.decision != CandidateDecision::Rejected
        };
        let candidates = verdict.candidates.iter().filter(is_listed);
        Self {
            id: id.to_owned(),
            keyframe: keyframe.map(ToString::to_string),
            map_version: verdict.map_version,
            verdict: verdict.decision.into(),
            why: verdict.why.clone(),
            confidence: verdict.confidence.map(rounded),
            best: verdict.best.as_ref().map(ToString::to_string),
            loops: verdict.loops.iter().map(ToString::to_string).collect(),
            degraded: verdict.degraded,
            has_twins: verdict.has_twins,
            excluded_covisible: verdict.excluded_covisible,
            closed: verdict.closed.iter().map(ClosedView::from).collect(),
            look_for: verdict.look_for.iter().filter_map(|sign| SignView::of(verdict, sign)).collect(),
            reason: verdict.reason.as_ref().map(ReasonView::from),
            candidates: candidates.map(|candidate| CandidateView::of(candidate, detail)).collect(),
        }
    }

    /// Writes the whole answer of a query, as clients receive it by default, and as it is recorded.
    pub fn bytes(
        id: &str,
        keyframe: Option<&KeyframeId>,
        verdict: &Verdict,
    ) -> Result<Vec<u8>, serde_json::Error> {
        serde_json::to_vec(&Self::of(id, keyframe, verdict, Detail::Full))
    }
}

impl SignView {
    fn of(verdict: &Verdict, LookFor { place, sign }: &LookFor) -> Option<Self> {
        Some(Self {
            keyframe: verdict.candidates.get(*place)?.keyframe.to_string(),
            class: sign.class.clone(),
            description: sign.description.clone(),
            position: [sign.position.x, sign.position.y, sign.position.z].map(rounded),
        })
    }
}

impl CandidateView {
    /// Returns a candidate with its figures.
    pub fn of(candidate: &Candidate, detail: Detail) -> Self {
        let proposed = candidate.proposed.as_ref();
        Self {
            keyframe: candidate.keyframe.to_string(),
            verdict: candidate.decision.into(),
            channel: proposed.map(|by| by.channels.iter().copied().map(ChannelName::from).collect()),
            global: proposed
                .and_then(|by| by.similarity)
                .map(|cosine| GlobalFigures { similarity: rounded(cosine) }),
            bow: (!proposed.is_some_and(ProposedBy::is_global_alone)).then(|| candidate.bow.into()),
            anchors: candidate.anchors.as_ref().map(|anchors| AnchorFigures::of(anchors, detail)),
            geometry: (&candidate.geometry).into(),
            confidence: candidate.odds.as_ref().map(|odds| rounded(odds.confidence)),
            evidence: candidate.odds.iter().flat_map(|odds| &odds.terms).map(EvidenceView::from).collect(),
            reason: candidate.reason.as_ref().map(ReasonView::from),
        }
    }
}

impl AnchorFigures {
    fn of(anchors: &AnchorEvidence, detail: Detail) -> Self {
        let matches = || anchors.matches.iter().map(MatchView::from).collect();
        Self {
            similarity: rounded(anchors.similarity),
            threshold: anchors.threshold,
            in_query: anchors.in_query,
            in_candidate: anchors.in_candidate,
            pending: anchors.pending,
            matches: (detail == Detail::Full).then(matches),
            contradictions: anchors.contradictions.iter().map(ContradictionView::from).collect(),
        }
    }
}
