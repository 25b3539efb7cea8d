//! Explain: a readable line for each answer.

use super::score::Outcome;
use crate::api::odds::EvidenceView;
use crate::api::verdict::CandidateView;
use crate::domain::verdict::Decision;
use crate::hotel::route::Place;
use crate::hotel::run::AnsweredQuery;
use crate::hotel::scenario::Scenario;

impl Scenario {
    /// Returns where a keyframe was taken, in truth.
    pub fn place(&self, (robot, number): (usize, usize)) -> String {
        let floor = self.floor_of(robot);
        match self.course.journeys[robot].steps[number].stop.place {
            Place::Room(room) => format!("room {}", floor.numbers[room]),
            Place::Corridor if self.floors.len() == 1 => String::from("the corridor"),
            Place::Corridor => format!("the corridor of room {}", floor.numbers[0]),
        }
    }

    /// Returns the answer in the server's own sentence.
    pub fn said(&self, asked: &AnsweredQuery) -> String {
        let keyframe = format!("{} in {}", keyframe_id(asked.keyframe), self.place(asked.keyframe));
        let answer = &asked.answer;
        let place =
            answer.place().or_else(|| answer.leading()).map_or("nothing", |place| place.keyframe.as_str());
        let verdict = match answer.verdict.0 {
            Decision::Loop => format!("a loop with {place}"),
            Decision::NoLoop => format!("looks like {place}, and is no loop"),
            Decision::Undecided => format!("looks like {place}; not decided"),
        };
        format!("{keyframe}: {verdict}. {}", answer.why)
    }

    /// Returns the answer with the figures that decided.
    pub fn answer(&self, asked: &AnsweredQuery) -> String {
        let keyframe = format!("{} in {}", keyframe_id(asked.keyframe), self.place(asked.keyframe));
        let Some(candidate) = asked.answer.leading() else {
            return format!("{keyframe}: nothing like it in the map");
        };
        let looks = format!(
            "{keyframe} looks like {} ({:.2}){}",
            candidate.keyframe,
            candidate.bow_score(),
            evidence(candidate)
        );
        match asked.answer.verdict.0 {
            Decision::Loop => format!("{looks}{}: a loop", agreement(candidate)),
            Decision::NoLoop => format!("{looks} but {}: rejected", why(candidate)),
            Decision::Undecided => format!("{looks} but {}: left open", why(candidate)),
        }
    }

    /// Returns the answer with the truth.
    pub fn judged(&self, asked: &AnsweredQuery) -> String {
        let truth = match asked.scored.outcome {
            Outcome::Right => "right",
            Outcome::RightlyNone => "right, there was none",
            Outcome::Missed => "missed: it was there before",
            Outcome::Wrong => "WRONG",
            Outcome::Unscored => "not scored: near by, or the same things from afar",
        };
        let accepted = asked.accepted;
        let accepted =
            accepted.map_or_else(String::new, |other| format!(" (taken in {})", self.place(other)));
        format!("{}{accepted} [{truth}]", self.answer(asked))
    }
}

/// Returns the id of a keyframe on the server.
pub fn keyframe_id((robot, number): (usize, usize)) -> String {
    format!("{}-{number}", crate::hotel::run::session(robot))
}

/// Returns the terms of the sum of evidence.
fn evidence(candidate: &CandidateView) -> String {
    let term =
        |term: &EvidenceView| format!("{} {}: {:+.1}", term.kind.0.as_str(), term.about, term.log_odds);
    let terms: Vec<String> = candidate.evidence.iter().map(term).collect();
    if terms.is_empty() { String::new() } else { format!(" [{}]", terms.join("; ")) }
}

fn agreement(candidate: &CandidateView) -> String {
    let anchors = candidate.anchors.as_ref();
    let matches = anchors.and_then(|anchors| anchors.matches.as_ref()).map_or(0, Vec::len);
    let anchors = match (matches, candidate.similarity()) {
        (0, _) | (_, None) => String::new(),
        (1, Some(similarity)) => format!(", the same sign at the same place (S = {similarity:.2})"),
        (n, Some(similarity)) => format!(", the same {n} signs at the same places (S = {similarity:.2})"),
    };
    match candidate.inliers() {
        Some(inliers) => format!("{anchors}, {inliers} points fit{}", at_scale(candidate)),
        None => anchors,
    }
}

/// Returns the ratio of the two keyframes' scales, if lengths have no common unit.
fn at_scale(candidate: &CandidateView) -> String {
    let geometry = &candidate.geometry;
    match geometry.full_transform().map(|transform| transform.scale) {
        Some(scale) if scale != 1.0 => format!(" at scale {scale:.2}"),
        Some(_) => String::new(),
        None => format!(" by {}", geometry.model.map_or("no model", |model| model.as_str())),
    }
}

fn why(candidate: &CandidateView) -> String {
    let contradictions = candidate.anchors.as_ref().map(|anchors| anchors.contradictions.as_slice());
    if let Some([first, ..]) = contradictions {
        return first.reason.clone();
    }
    let detail = candidate.reason.as_ref().map(|reason| reason.detail.clone());
    detail.unwrap_or_else(|| String::from("a check said no"))
}
