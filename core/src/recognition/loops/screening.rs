//! A query after checks 1 to 3: candidates that are decided, and those that wait for geometry.

use std::collections::BTreeSet;

use super::geometry_snapshot::GeometrySnapshot;
use super::query::Query;
use super::wanted_features::WantedFeatures;
use crate::domain::change::Loop;
use crate::domain::ids::KeyframeSeq;
use crate::domain::settings::Settings;
use crate::domain::verdict::{
    CLOSED_MAX, Candidate, CandidateDecision, ClosedLoop, Reason, ReasonCode, Verify,
};
use crate::recognition::extensions::alignment::Compared;
use crate::recognition::extensions::returning::Returning;
use crate::recognition::extensions::tracked_path::TrackedPath;
use crate::recognition::extensions::vouching::{Vouched, Voucher};
use crate::recognition::map::index::MapIndex;

/// The stage of a candidate after check 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CandidateStage {
    /// A check stopped it.
    Stopped,
    /// The anchors say that the two places are one.
    AnchorsAgree,
    /// The anchors agree by texts alone that hang in many places: geometry on map points must witness.
    NeedsWitness,
    /// All that agrees was tracked from the candidate to the query in one passage: geometry must say that it is a return, and
    /// for texts that need a witness, geometry on map points.
    TrackedOnly {
        /// Something besides such texts agrees.
        has_witness: bool,
    },
    /// Its anchors leave it open, and neighbours vouch for it: geometry on map points must verify the view.
    Vouched,
    /// There are no anchors, and the map's settings leave it to geometry alone.
    AskGeometry,
}

/// A candidate that check 3 lets pass.
#[derive(Clone, Debug)]
pub struct Passed {
    /// Its stage.
    pub stage: CandidateStage,
    /// Identifiers that are not sure contradict the place: it is rejected where geometry cannot run (M7).
    pub contradicted: Option<Reason>,
}

/// A candidate's part among those that geometry alone may take for each other (M19).
#[derive(Clone, Debug, Default)]
pub struct Rivalry {
    /// The candidates that are known to be another place; looked for where geometry alone may make this one a loop.
    pub rivals: Vec<KeyframeSeq>,
    /// Whether it is a rival of another candidate: geometry looks at it, though a check stopped it.
    pub is_rival: bool,
}

/// A candidate after check 3.
#[derive(Clone, Debug)]
pub struct PreVerified {
    /// Its number.
    pub keyframe: KeyframeSeq,
    /// The evidence so far.
    pub candidate: Candidate,
    /// Its stage.
    pub stage: CandidateStage,
    /// Why it is rejected where geometry cannot run.
    pub contradicted: Option<Reason>,
    /// The voucher for it, where its own anchors leave it open.
    pub vouched: Option<Vouched>,
    /// Which other candidates look like it, and are not it.
    pub rivalry: Rivalry,
    /// Other keyframes of its place, covisible with it, that passed the anchors: they are looked at where it is a near miss.
    pub neighbours: Vec<PreVerified>,
    /// Whether the session's own poses have the query at the candidate's place: what looks alike there is no return.
    pub is_here: bool,
    /// Whether an identifier matches that was not merely tracked through this same passage.
    pub identifier: Returning,
    /// The comparison's findings, to be held against a transformation.
    pub compared: Compared,
    /// The confirmed loop that a loop with it would repeat, if there is one and repeated loops do not count.
    pub repeats: Option<ClosedLoop>,
    /// The unbroken odometry chain to the query, if there is one.
    pub path: Option<TrackedPath>,
    /// Its geometry: camera, pose and map points.
    pub snapshot: Option<GeometrySnapshot>,
    /// Whether the built-in judge stood in for a model that is away.
    pub is_degraded: bool,
}

impl PreVerified {
    pub(in crate::recognition) fn stopped(
        keyframe: KeyframeSeq,
        mut candidate: Candidate,
        decision: CandidateDecision,
        reason: Reason,
    ) -> Self {
        candidate.decision = decision;
        candidate.reason = Some(reason);
        Self {
            keyframe,
            candidate,
            stage: CandidateStage::Stopped,
            contradicted: None,
            vouched: None,
            rivalry: Rivalry::default(),
            neighbours: Vec::new(),
            is_here: false,
            identifier: Returning::No,
            compared: Compared::default(),
            repeats: None,
            path: None,
            snapshot: None,
            is_degraded: false,
        }
    }
}

impl PreVerified {
    /// Returns the decision and the reason of a candidate that its anchors neither bear out nor speak against: there are
    /// none, or all that agrees hangs in several places.
    pub(in crate::recognition) fn left_open(&self) -> Option<(CandidateDecision, Reason)> {
        let reason = self.candidate.reason.clone().filter(|_| self.stage == CandidateStage::Stopped)?;
        let is_open = matches!(reason.code, ReasonCode::NoAnchors | ReasonCode::NotDistinctive);
        is_open.then_some((self.candidate.decision, reason))
    }

    /// Whether geometry will look at it, so that the keyframes around it may be asked.
    pub(in crate::recognition) fn may_be_near_miss(&self) -> bool {
        self.stage != CandidateStage::Stopped && self.snapshot.is_some()
    }

    /// Adds the neighbours that passed the anchors. Their guided search does with the window that is read for this one.
    pub(in crate::recognition) fn add_neighbours(&mut self, mut neighbours: Vec<Self>) {
        neighbours.retain(Self::may_be_near_miss);
        let mut read: BTreeSet<KeyframeSeq> = neighbours.iter().map(|neighbour| neighbour.keyframe).collect();
        read.insert(self.keyframe);
        read.extend(self.snapshot.iter().flat_map(|snapshot| snapshot.window.iter().copied()));
        for snapshot in neighbours.iter_mut().filter_map(|neighbour| neighbour.snapshot.as_mut()) {
            snapshot.window.retain(|keyframe| read.contains(keyframe));
        }
        self.neighbours = neighbours;
    }

    /// Returns the candidate with somebody to vouch for it; `otherwise` is what it is without.
    pub(in crate::recognition) fn vouched(
        mut self,
        by: Voucher,
        otherwise: (CandidateDecision, Reason),
    ) -> Self {
        self.candidate.decision = CandidateDecision::Loop;
        self.candidate.reason = None;
        Self { stage: CandidateStage::Vouched, vouched: Some(Vouched { by, otherwise }), ..self }
    }
}

/// A query after checks 1 to 3, independent of the map it was asked of.
#[derive(Clone, Debug)]
pub struct Screening {
    /// The map's version that was asked.
    pub map_version: u64,
    /// The map's settings at that version.
    pub settings: Settings,
    /// Whether the map's lengths are metres.
    pub metric: bool,
    /// Which checks the query asks for.
    pub verify: Verify,
    /// Whether the query has no words.
    pub empty_bow: bool,
    /// The number of keyframes left out as covisible.
    pub excluded_covisible: usize,
    /// The number of other keyframes left out as too recent (M53), counted where there is no candidate.
    pub too_recent: usize,
    /// The query's loops that are confirmed already, by id.
    pub closed: Vec<ClosedLoop>,
    /// Whether the built-in judge stood in for a model that is away, about any candidate.
    pub degraded: bool,
    /// The pairs of keyframes of this map that geometry verified and the anchors contradict (M16); 0 where the
    /// map's settings do not mind.
    pub twins: usize,
    /// The query's number, if it is stored.
    pub query: Option<KeyframeSeq>,
    /// The query's geometry: camera, pose and map points.
    pub snapshot: Option<GeometrySnapshot>,
    /// The candidates.
    pub candidates: Vec<PreVerified>,
}

impl Screening {
    /// Returns a query with these candidates.
    pub(in crate::recognition) fn of_candidates(
        index: &MapIndex,
        map_version: u64,
        query: &Query<'_>,
        verify: Verify,
        candidates: Vec<PreVerified>,
    ) -> Self {
        let settings = &index.properties().settings;
        Self {
            map_version,
            settings: settings.clone(),
            metric: index.properties().metric,
            verify,
            empty_bow: query.bow.is_empty(),
            excluded_covisible: query.covisible().count(),
            too_recent: if candidates.is_empty() { query.too_recent(index) } else { 0 },
            closed: closed_loops(index, query),
            degraded: candidates.iter().any(|candidate| candidate.is_degraded),
            twins: if settings.twin_guard { index.twins().count() } else { 0 },
            query: query.keyframe,
            snapshot: query.snapshot.clone(),
            candidates,
        }
    }

    /// Returns the candidates that geometry is to look at.
    pub fn waiting(&self) -> impl Iterator<Item = &PreVerified> {
        let runs = self.snapshot.is_some() && self.verify != Verify::Anchors;
        let is_looked_at = |c: &PreVerified| {
            (c.stage != CandidateStage::Stopped || c.rivalry.is_rival) && c.snapshot.is_some()
        };
        self.candidates.iter().filter(move |c| runs && is_looked_at(c))
    }

    /// Returns the keyframes whose features geometry will read, ascending; none if it has nothing to do.
    pub fn wanted_features(&self) -> WantedFeatures {
        let mut wanted = WantedFeatures::default();
        for pre_verified in
            self.waiting().flat_map(|pre_verified| [pre_verified].into_iter().chain(&pre_verified.neighbours))
        {
            wanted.add(pre_verified.keyframe, pre_verified.snapshot.as_ref());
        }
        if let Some(query) = self.query.filter(|_| !wanted.keyframes.is_empty()) {
            wanted.add_alone(query, self.snapshot.as_ref());
        }
        wanted
    }
}

/// Returns the confirmed loops of the query's keyframe.
fn closed_loops(index: &MapIndex, query: &Query<'_>) -> Vec<ClosedLoop> {
    let Some(own) = query.keyframe else { return Vec::new() };
    let other = |closed: &Loop| {
        let is_start = closed.keyframe == own;
        if is_start { closed.candidate_id.clone() } else { closed.keyframe_id.clone() }
    };
    let closed = index.loops_of(own).take(CLOSED_MAX);
    closed.map(|closed| ClosedLoop { id: closed.id.clone(), keyframe: other(closed) }).collect()
}
