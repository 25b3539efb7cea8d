//! Answers: figures of a loop query's answer that several readers need.

use std::cmp::Ordering;

use revisit_core::domain::reason::ReasonCode;

use crate::geometry::{GeometryModel, GeometryView, Similarity};
use crate::verdict::{CandidateView, LoopAnswer, ReasonView};

impl LoopAnswer {
    /// Returns the candidate that the answer is about: `best`, or the one that came nearest to being it, an undecided one before
    /// a rejected one, then in the order that chooses `best` (inliers, S, BoW score, smallest id).
    pub fn leading(&self) -> Option<&CandidateView> {
        match &self.best {
            Some(best) => self.candidate(best),
            None => self.candidates.iter().max_by(|a, b| a.nearness(b)),
        }
    }

    /// Returns the candidate of a loop that was not told because its return is closed already.
    pub fn repeated(&self) -> Option<&CandidateView> {
        let repeats = |reason: &ReasonView| reason.code.0 == ReasonCode::AlreadyClosed;
        self.candidates.iter().find(|candidate| candidate.reason.as_ref().is_some_and(repeats))
    }

    /// Returns the place that the answer names: the best loop, or the one whose return is closed already.
    pub fn place(&self) -> Option<&CandidateView> {
        match &self.best {
            Some(best) => self.candidate(best),
            None => self.repeated(),
        }
    }

    /// Returns the best loop with the transformation to close it with.
    pub fn best_transform(&self) -> Option<(&str, &Similarity)> {
        let best = self.candidate(self.best.as_deref()?)?;
        Some((&best.keyframe, best.geometry.candidate_from_query.as_ref()?))
    }

    /// Returns the candidate of this id.
    pub fn candidate(&self, keyframe: &str) -> Option<&CandidateView> {
        self.candidates.iter().find(|candidate| candidate.keyframe == keyframe)
    }
}

impl CandidateView {
    /// Returns the BoW score; 0 for one that came by its anchors or its global descriptor alone.
    pub fn bow_score(&self) -> f64 {
        self.bow.as_ref().map_or(0.0, |bow| bow.score)
    }

    /// Returns S of Eq. (2), where it could be taken.
    pub fn similarity(&self) -> Option<f64> {
        self.anchors.as_ref().map(|anchors| anchors.similarity)
    }

    /// Returns the inliers of the geometry, where it ran.
    pub fn inliers(&self) -> Option<u64> {
        self.geometry.inliers.map(u64::from)
    }

    /// Compares two candidates; less is further from being `best`.
    pub fn nearness(&self, other: &Self) -> Ordering {
        let similarity = |candidate: &Self| candidate.similarity().unwrap_or(0.0);
        // The model names a loop first and a rejection last.
        let verdict = other.verdict.cmp(&self.verdict);
        verdict
            .then(self.inliers().cmp(&other.inliers()))
            .then(similarity(self).total_cmp(&similarity(other)))
            .then(self.bow_score().total_cmp(&other.bow_score()))
            .then(other.keyframe.cmp(&self.keyframe))
    }
}

impl GeometryView {
    /// Returns the transformation, if its lengths are known: a pose graph must not take a translation of length 1 for one.
    pub fn full_transform(&self) -> Option<&Similarity> {
        let is_full = matches!(self.model, Some(GeometryModel::Se3 | GeometryModel::Sim3));
        self.candidate_from_query.as_ref().filter(|_| is_full)
    }
}
