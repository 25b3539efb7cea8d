//! Loop closing: which of the reported loops a robot closes.

use super::client::{LoopToClose, Robot};
use super::common_regions::confirmation::{Confirmation, Proposal};
use super::message;
use super::slam_map::SlamMap;
use crate::api::verdict::{CandidateView, LoopAnswer};
use crate::domain::verdict::Decision;
use crate::geometry::Sim3;
use crate::hotel::method::Method;
use crate::hotel::scoring::truth::KeyframeIndex;

/// One robot's rule for closing loops: every reported one, or those that three keyframes confirm, as ORB-SLAM3 does.
#[derive(Clone, Debug)]
pub struct LoopClosing(Option<Confirmation>);

/// A loop that a robot accepts.
#[derive(Clone, Debug, PartialEq)]
pub struct Accepted {
    /// Its earlier keyframe.
    pub candidate: KeyframeIndex,
    /// The number of points that agree: the server's inliers, or those of the confirmation.
    pub inliers: u64,
    /// The loop to close; none where the server verified no transformation with known lengths.
    pub to_close: Option<LoopToClose>,
}

impl LoopClosing {
    /// Returns the rule of an arm's robots.
    pub fn of(arm: Method) -> Self {
        Self(arm.confirms().then(Confirmation::default))
    }

    /// Receives the answer for a keyframe, the latest of its robot.
    pub fn hear(
        &mut self,
        robots: &[Robot<'_>],
        query: KeyframeIndex,
        answer: &LoopAnswer,
    ) -> Option<Accepted> {
        let Some(confirmation) = &mut self.0 else { return as_told(robots, answer) };
        let maps: Vec<&SlamMap<'_>> = robots.iter().map(Robot::slam_map).collect();
        let confirmed = confirmation.hear(&maps, query, &proposals(robots, answer))?;
        let (robot, number) = confirmed.candidate;
        Some(Accepted {
            candidate: confirmed.candidate,
            inliers: confirmed.found as u64,
            to_close: Some(LoopToClose {
                candidate: robots[robot].keyframe_id(number),
                candidate_from_query: Sim3::from(confirmed.candidate_from_query),
                answer: confirmed.answer,
            }),
        })
    }
}

/// Returns the keyframe with this id among those of all robots.
pub fn find(robots: &[Robot<'_>], keyframe: &str) -> Option<KeyframeIndex> {
    robots.iter().enumerate().find_map(|(robot, own)| Some((robot, own.number_of(keyframe)?)))
}

/// A return that is closed already counts as the loop that it stands for, and is not closed again.
fn as_told(robots: &[Robot<'_>], answer: &LoopAnswer) -> Option<Accepted> {
    let candidate = answer.place()?;
    let to_close = transform(candidate).filter(|_| answer.verdict.0 == Decision::Loop);
    Some(Accepted {
        candidate: find(robots, &candidate.keyframe)?,
        inliers: candidate.inliers().unwrap_or(0),
        to_close: to_close.map(|candidate_from_query| LoopToClose {
            candidate: candidate.keyframe.clone(),
            candidate_from_query,
            answer: answer.id.clone(),
        }),
    })
}

/// Returns every loop of an answer that has a transformation.
fn proposals(robots: &[Robot<'_>], answer: &LoopAnswer) -> Vec<Proposal> {
    let proposal = |keyframe: &String| {
        Some(Proposal {
            candidate: find(robots, keyframe)?,
            // Robots that confirm measure depth.
            candidate_from_query: transform(answer.candidate(keyframe)?)?.without_scale(),
            answer: answer.id.clone(),
        })
    };
    answer.loops.iter().filter_map(proposal).collect()
}

fn transform(candidate: &CandidateView) -> Option<Sim3> {
    message::similarity(candidate.geometry.full_transform()?)
}
