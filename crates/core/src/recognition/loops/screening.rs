//! A query after checks 1 to 3: candidates that are decided, and those that wait for geometry.

use std::collections::BTreeSet;

use super::geometry_snapshot::GeometrySnapshot;
use super::query::Query;
use super::wanted_features::WantedFeatures;
use crate::domain::change::Loop;
use crate::domain::ids::KeyframeSeq;
use crate::domain::settings::Settings;
use crate::domain::verdict::{CLOSED_MAX, Candidate, CandidateDecision, ClosedLoop, Reason, Verify};
use crate::recognition::extensions::returning::Returning;
use crate::recognition::map::index::MapIndex;
use crate::recognition::odds::bet::Bet;

/// The stage of a candidate after check 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Geometry is not asked: a check stopped it, or geometry could not turn the answer.
    Stopped,
    /// The anchors speak for it.
    AnchorsAgree,
    /// Nothing but geometry can speak for it.
    AskGeometry,
}

/// A candidate after check 3.
#[derive(Clone, Debug)]
pub struct PreVerified {
    /// Its number.
    pub keyframe: KeyframeSeq,
    /// The evidence so far.
    pub candidate: Candidate,
    /// Its stage.
    pub stage: Stage,
    /// Other keyframes of its place, covisible with it, that passed the anchors: they are looked at where it is a near miss.
    pub neighbours: Vec<PreVerified>,
    /// The way in which an identifier is known that matches and was not merely tracked through this same passage.
    pub identifier: Returning,
    /// The bet on it; none under the paper's method.
    pub bet: Option<Bet>,
    /// The confirmed loop that a loop with it would repeat, if there is one and repeated loops do not count.
    pub repeats: Option<ClosedLoop>,
    /// Its geometry: camera, pose and map points.
    pub snapshot: Option<GeometrySnapshot>,
    /// Whether the built-in judge stood in for a model that is away.
    pub is_degraded: bool,
}

impl PreVerified {
    /// Returns a candidate that a check stopped.
    pub(in crate::recognition) fn stopped(
        keyframe: KeyframeSeq,
        mut candidate: Candidate,
        decision: CandidateDecision,
        reason: Reason,
    ) -> Self {
        candidate.decision = decision;
        candidate.reason = Some(reason);
        Self::at(Stage::Stopped, keyframe, candidate)
    }

    /// Returns a candidate at a stage, of which nothing else is known.
    pub(in crate::recognition) fn at(stage: Stage, keyframe: KeyframeSeq, candidate: Candidate) -> Self {
        Self {
            keyframe,
            candidate,
            stage,
            neighbours: Vec::new(),
            identifier: Returning::No,
            bet: None,
            repeats: None,
            snapshot: None,
            is_degraded: false,
        }
    }

    /// Whether geometry will look at it, so that the keyframes around it may be asked.
    pub(in crate::recognition) fn may_be_near_miss(&self) -> bool {
        self.stage != Stage::Stopped && self.snapshot.is_some()
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
    /// The pairs of keyframes of this map that geometry verified and the anchors contradict (M16); 0 where the map's settings do
    /// not mind.
    pub twins: usize,
    /// The query's number, if it is stored.
    pub query: Option<KeyframeSeq>,
    /// The query's geometry: camera, pose and map points.
    pub snapshot: Option<GeometrySnapshot>,
    /// The candidates.
    pub candidates: Vec<PreVerified>,
    /// The pairs of candidates that are covisible, by their numbers, the smaller first.
    pub joined: BTreeSet<(usize, usize)>,
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
            twins: if settings.is_ours() { index.twins().count() } else { 0 },
            query: query.keyframe,
            snapshot: query.snapshot.clone(),
            joined: BTreeSet::new(),
            candidates,
        }
    }

    /// Returns the candidates that geometry is to look at.
    pub fn waiting(&self) -> impl Iterator<Item = &PreVerified> {
        let runs = self.snapshot.is_some() && self.verify != Verify::Anchors;
        let is_looked_at = |c: &PreVerified| c.stage != Stage::Stopped && c.snapshot.is_some();
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
