//! Check 3 of §V: the local anchor map around the query against that around each candidate.

use std::cell::OnceCell;

use super::anchor_map::{LocalAnchorMap, local_anchor_map};
use super::centre::Centre;
use super::comparison::{Comparison, compare};
use super::equation_2;
use super::evidence;
use super::geometry_snapshot::GeometrySnapshot;
use super::low_score::explain_low_score;
use super::query::Query;
use super::screening::{CandidateStage, Passed, PreVerified, Rivalry};
use crate::domain::ids::KeyframeSeq;
use crate::domain::settings::WithoutAnchors;
use crate::domain::verdict::{Candidate, CandidateDecision, Reason, ReasonCode, Verify};
use crate::recognition::extensions::alignment::Compared;
use crate::recognition::extensions::closed_return::{joined_return, repeated_loop};
use crate::recognition::extensions::company::Companies;
use crate::recognition::extensions::difference::find_differing;
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::extensions::returning::{is_tracked_only, returning_identifier};
use crate::recognition::extensions::vouching::{Voucher, may_vouch, widened};
use crate::recognition::extensions::witness::lacks_witness;
use crate::recognition::extensions::worst_case::{WorstCase, awaited, model_is_missed, worst_case};
use crate::recognition::map::index::MapIndex;

/// A query's surroundings, to be held against those of its candidates.
#[derive(Debug)]
pub struct AnchorCheck<'a> {
    index: &'a MapIndex,
    query: &'a Query<'a>,
    verify: Verify,
    around: LocalAnchorMap,
    /// Whether neighbours may vouch for what its own anchors leave open.
    may_vouch: bool,
    /// The neighbours' own local map, made where they are asked.
    around_neighbours: OnceCell<LocalAnchorMap>,
}

/// Counts that all candidates of a query share.
#[derive(Debug)]
pub struct Counts {
    /// The places at which texts hang.
    pub places: PlaceCounts,
    companies: Companies,
}

impl Counts {
    /// Returns the counts for a query around this centre.
    pub fn around(index: &MapIndex, centre: &Centre) -> Self {
        Self { places: PlaceCounts::around(index, centre), companies: Companies::default() }
    }
}

impl<'a> AnchorCheck<'a> {
    /// Takes the local anchor map around the query.
    pub fn new(index: &'a MapIndex, query: &'a Query<'a>, verify: Verify, counts: &mut Counts) -> Self {
        let around = local_anchor_map(index, &query.centre, &mut counts.places);
        let may_vouch = may_vouch(index, query, verify);
        Self { index, query, verify, around, may_vouch, around_neighbours: OnceCell::new() }
    }

    /// Checks one candidate; returns none if its keyframe was culled.
    pub fn check(
        &self,
        keyframe: KeyframeSeq,
        candidate: Candidate,
        counts: &mut Counts,
    ) -> Option<PreVerified> {
        let centre = Centre::stored(self.index, keyframe)?;
        let around = local_anchor_map(self.index, &centre, &mut counts.places);
        let pre_verified = self.compare(keyframe, candidate.clone(), [&self.around, &around], counts);
        Some(match pre_verified.left_open() {
            Some(otherwise) if self.may_vouch => {
                let vouched = self.ask_neighbours(&pre_verified, candidate, &centre, counts);
                vouched.map_or(pre_verified, |(by, vouched)| vouched.vouched(by, otherwise))
            }
            _ => pre_verified,
        })
    }

    /// Returns who vouches for a candidate that its own anchors leave open, and the candidate as they have it.
    fn ask_neighbours(
        &self,
        pre_verified: &PreVerified,
        candidate: Candidate,
        centre: &Centre,
        counts: &mut Counts,
    ) -> Option<(Voucher, PreVerified)> {
        let keyframe = pre_verified.keyframe;
        if let Some(closed) = joined_return(self.index, self.query, keyframe) {
            let joined = PreVerified {
                is_here: self.is_here(keyframe),
                repeats: self.closes_once().then_some(closed),
                snapshot: GeometrySnapshot::stored(self.index, keyframe),
                ..pre_verified.clone()
            };
            return Some((Voucher::ConfirmedLoop, joined));
        }
        let around_query = self
            .around_neighbours
            .get_or_init(|| widened(self.index, &self.query.centre, &mut counts.places));
        let around_candidate = widened(self.index, centre, &mut counts.places);
        let wide = self.compare(keyframe, candidate, [around_query, &around_candidate], counts);
        let agrees = wide.stage == CandidateStage::AnchorsAgree && wide.contradicted.is_none();
        agrees.then_some((Voucher::Anchors, wide))
    }

    fn compare(
        &self,
        keyframe: KeyframeSeq,
        candidate: Candidate,
        maps: [&LocalAnchorMap; 2],
        counts: &mut Counts,
    ) -> PreVerified {
        let settings = &self.index.properties().settings;
        let mut comparison = compare(maps[0], maps[1], self.index, settings);
        if settings.company {
            counts.companies.weigh(self.index, &mut comparison, maps, &mut counts.places);
        }
        self.judge(keyframe, candidate, maps, &comparison)
    }

    fn judge(
        &self,
        keyframe: KeyframeSeq,
        mut candidate: Candidate,
        maps: [&LocalAnchorMap; 2],
        comparison: &Comparison<'_>,
    ) -> PreVerified {
        let (index, query) = (self.index, self.query);
        let settings = &index.properties().settings;
        let [around_query, around_candidate] = maps;
        let is_degraded = model_is_missed(index, around_query, around_candidate);
        let differing = find_differing(around_query, around_candidate, comparison, index.texts(), settings);
        candidate.anchors = Some(evidence::anchors(comparison, &differing, settings));
        // Only where a model reads crops does a description come by itself.
        let reads = query.roles.vision || index.model_away();
        let worst = reads.then(|| worst_case(index, around_query, around_candidate, comparison)).flatten();
        let missing = match () {
            () if !reads || awaited(index, around_query, around_candidate) == 0 => ReasonCode::NotDescribed,
            () if index.model_away() => ReasonCode::LlmUnavailable,
            () => ReasonCode::LlmPending,
        };
        let nearest = query.nearest();
        let is_tracked_only =
            || nearest.is_some_and(|query| is_tracked_only(index, comparison, query, keyframe));
        let passed = judge_anchors(index, comparison, worst, missing).map(|passed| match passed.stage {
            CandidateStage::AnchorsAgree | CandidateStage::NeedsWitness
                if settings.tracked_loops_need_geometry && is_tracked_only() =>
            {
                let has_witness = passed.stage == CandidateStage::AnchorsAgree;
                Passed { stage: CandidateStage::TrackedOnly { has_witness }, ..passed }
            }
            _ => passed,
        });
        let mut pre_verified = match passed {
            Err((decision, mut reason)) if reason.code == ReasonCode::ScoreBelowThreshold => {
                let why = explain_low_score(maps, comparison, index.texts(), settings);
                reason.detail = format!("{}: {why}", reason.detail);
                PreVerified::stopped(keyframe, candidate, decision, reason)
            }
            Err((decision, reason)) => PreVerified::stopped(keyframe, candidate, decision, reason),
            Ok(Passed { stage, contradicted }) => PreVerified {
                keyframe,
                candidate,
                stage,
                contradicted,
                vouched: None,
                rivalry: Rivalry::default(),
                neighbours: Vec::new(),
                is_here: self.is_here(keyframe),
                identifier: returning_identifier(index, comparison, query, nearest, keyframe),
                compared: Compared::of(index, comparison, differing),
                repeats: self
                    .closes_once()
                    .then(|| repeated_loop(index, comparison, query, keyframe))
                    .flatten(),
                path: None,
                snapshot: if self.verify == Verify::Anchors {
                    None
                } else {
                    GeometrySnapshot::stored(index, keyframe)
                },
                is_degraded: false,
            },
        };
        pre_verified.is_degraded = is_degraded;
        pre_verified
    }

    /// Whether a loop that repeats a confirmed one is none (M63).
    fn closes_once(&self) -> bool {
        self.index.properties().settings.returns_close_once && !self.query.again
    }

    /// Whether the query's session has the two keyframes at one place.
    fn is_here(&self, candidate: KeyframeSeq) -> bool {
        let (index, query) = (self.index, self.query);
        let radius_m = index.properties().settings.distinctive_place_radius_m;
        index.keyframe(candidate).is_some_and(|candidate| {
            let apart_m = (query.centre.map_from_camera.centre() - candidate.map_from_camera.centre()).norm();
            query.centre.session == Some(candidate.session) && apart_m <= radius_m
        })
    }
}

/// Decides by the anchors alone: contradictions first, since they name what S only measures.
pub fn judge_anchors(
    index: &MapIndex,
    comparison: &Comparison<'_>,
    worst: Option<WorstCase>,
    missing: ReasonCode,
) -> Result<Passed, (CandidateDecision, Reason)> {
    use CandidateDecision::{Rejected, Undecided};
    let settings = &index.properties().settings;
    let passes = |similarity| equation_2::passes(similarity, settings);
    let (agreeing, contradicting) = (comparison.agreement(), comparison.contradicting_weight());
    let could_turn = comparison.pending > 0
        && passes(comparison.best_case.similarity)
        && comparison.best_case.agreeing_weight >= contradicting;
    let contradicted = (contradicting > agreeing)
        .then(|| evidence::contradicted(&comparison.contradictions, contradicting, agreeing));
    // Asked last: what is sure takes a look at every reading.
    let is_surely_contradicted =
        || contradicted.is_some() && comparison.surely_contradicting_weight(index) > agreeing;
    if passes(comparison.similarity) && !is_surely_contradicted() {
        let turns = |worst: &WorstCase| !passes(worst.similarity) || worst.contradicting_weight > agreeing;
        let open = match (worst.filter(turns), comparison.least_places()) {
            (Some(worst), _) => Some(evidence::awaited(&worst, missing)),
            (None, Some(places)) if places > 1 => Some(evidence::not_distinctive(places)),
            _ => None,
        };
        match (open, &contradicted) {
            (None, _) => {
                let needs_witness = settings.single_text_needs_witness && lacks_witness(comparison);
                let stage =
                    if needs_witness { CandidateStage::NeedsWitness } else { CandidateStage::AnchorsAgree };
                return Ok(Passed { stage, contradicted });
            }
            (Some(open), None) => return Err((Undecided, open)),
            // Geometry will not be asked, so what contradicts need not be sure.
            (Some(_), Some(_)) => {}
        }
    }
    if could_turn {
        return Err((Undecided, evidence::pending(comparison, missing)));
    }
    if let Some(reason) = contradicted {
        return Err((Rejected, reason));
    }
    if comparison.in_query > 0 && comparison.in_candidate > 0 {
        let reason = evidence::reason(
            ReasonCode::ScoreBelowThreshold,
            comparison.similarity,
            settings.anchor_map_min_similarity,
        );
        return Err((Rejected, reason));
    }
    match settings.without_anchors {
        WithoutAnchors::Undecided => Err((Undecided, evidence::no_anchors(comparison))),
        WithoutAnchors::Reject => Err((Rejected, evidence::no_anchors(comparison))),
        WithoutAnchors::Geometry => Ok(Passed { stage: CandidateStage::AskGeometry, contradicted: None }),
    }
}
