//! What is left of a query after checks 1 to 3: candidates that are decided, and those that wait for geometry.

use std::collections::BTreeSet;

use super::alignment::Compared;
use super::sight::Sight;
use super::tracked_path::TrackedPath;
use crate::model::ids::KeyframeSeq;
use crate::model::settings::Settings;
use crate::model::verdict::{Candidate, CandidateDecision, ClosedLoop, Reason, Verify};

/// How a candidate stands after check 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
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
    /// There are no anchors, and the map's settings leave it to geometry alone.
    AskGeometry,
}

/// A candidate after check 3.
#[derive(Clone, Debug)]
pub struct Screened {
    /// Its number.
    pub keyframe: KeyframeSeq,
    /// The evidence so far.
    pub candidate: Candidate,
    /// How it stands.
    pub standing: Standing,
    /// What the comparison found, to be held against a transformation.
    pub compared: Compared,
    /// How it hangs together with the query by odometry, if it does.
    pub path: Option<TrackedPath>,
    /// What geometry needs to know of it.
    pub sight: Option<Sight>,
    /// Did the built-in judge stand in for a model that is away?
    pub stood_in: bool,
}

impl Screened {
    pub(super) fn stopped(
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
            standing: Standing::Stopped,
            compared: Compared::default(),
            path: None,
            sight: None,
            stood_in: false,
        }
    }
}

/// A query after checks 1 to 3, independent of the map it was asked of.
#[derive(Clone, Debug)]
pub struct Screening {
    /// The map's version that was asked.
    pub map_version: u64,
    /// The map's settings at that version.
    pub settings: Settings,
    /// Are the map's lengths metres?
    pub metric: bool,
    /// Which checks the query asks for.
    pub verify: Verify,
    /// Has the query no words?
    pub empty_bow: bool,
    /// How many keyframes were left out as covisible.
    pub excluded_covisible: usize,
    /// The query's loops that are confirmed already, by id.
    pub closed: Vec<ClosedLoop>,
    /// Did the built-in judge stand in for a model that is away, about any candidate?
    pub degraded: bool,
    /// The query's number, if it is stored.
    pub query: Option<KeyframeSeq>,
    /// What geometry needs to know of the query.
    pub sight: Option<Sight>,
    /// The candidates.
    pub candidates: Vec<Screened>,
}

impl Screening {
    /// The candidates that geometry is to look at.
    pub fn waiting(&self) -> impl Iterator<Item = &Screened> {
        let runs = self.sight.is_some() && self.verify != Verify::Anchors;
        self.candidates.iter().filter(move |c| runs && c.standing != Standing::Stopped && c.sight.is_some())
    }

    /// The keyframes whose features geometry will read, ascending; none if it has nothing to do.
    pub fn wanted_features(&self) -> BTreeSet<KeyframeSeq> {
        let mut wanted = BTreeSet::new();
        for screened in self.waiting() {
            wanted.insert(screened.keyframe);
            wanted.extend(screened.sight.iter().flat_map(|sight| sight.window.iter().copied()));
        }
        if !wanted.is_empty() {
            wanted.extend(self.query);
        }
        wanted
    }
}
