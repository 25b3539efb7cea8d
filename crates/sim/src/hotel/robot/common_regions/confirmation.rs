//! Confirmation: agreement of three keyframes, which are neighbours of the query or follow it.

use std::collections::BTreeSet;

use super::projection::{Found, Image, Search};
use super::refinement::{Refined, refined};
use super::window::{COVISIBLE, WindowPoint, keyframes_around, keyframes_farther_around, points_of};
use crate::geometry::{Point3, Pose};
use crate::hotel::robot::slam_map::SlamMap;
use crate::hotel::scoring::truth::KeyframeIndex;

/// The number of keyframes that must agree.
const AGREEING: usize = 3;
/// Minimum points found in a query before refinement.
const FOUND_FIRST: usize = 50;
/// Minimum points that fit the refined transformation.
const FITTING: usize = 20;
/// Minimum points found after refinement.
const FOUND_REFINED: usize = 80;
/// Minimum points found by a neighbour of the query.
const FOUND_BY_NEIGHBOUR: usize = 30;
/// Minimum points found by a following keyframe before refinement.
const FOUND_LATER: usize = 30;
/// A following keyframe needs more fitting points than this.
const FITTING_LATER: usize = 50;
/// Minimum points found by a following keyframe after refinement.
const FOUND_LATER_REFINED: usize = 100;
/// Consecutive keyframes without agreement that end it.
const FAILURES: u32 = 2;

/// A loop that the server proposes.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// The keyframe to close it with.
    pub candidate: KeyframeIndex,
    /// The query's pose in the candidate's camera frame.
    pub candidate_from_query: Pose,
    /// The id of the answer that proposes it.
    pub answer: String,
}

/// A loop that three keyframes agree on.
#[derive(Clone, Debug, PartialEq)]
pub struct Confirmed {
    /// The keyframe to close it with.
    pub candidate: KeyframeIndex,
    /// The query's pose in the candidate's camera frame, refined.
    pub candidate_from_query: Pose,
    /// The number of the window's points visible in the query.
    pub found: usize,
    /// The id of the answer that proposed it: an earlier one if later keyframes had to agree.
    pub answer: String,
}

/// The state of one robot's loop closing between keyframes.
#[derive(Clone, Debug, Default)]
pub struct Confirmation {
    pending: Option<Pending>,
}

/// A loop with fewer than three agreeing keyframes so far.
#[derive(Clone, Debug)]
struct Pending {
    /// Its state at the last keyframe that agreed.
    latest: Confirmed,
    last: usize,
    agreeing: usize,
    failures: u32,
}

impl Confirmation {
    /// Receives the server's proposals for a keyframe, and returns the loop confirmed with it. `maps` are those of all
    /// robots.
    pub fn hear(
        &mut self,
        maps: &[&SlamMap<'_>],
        query: KeyframeIndex,
        proposals: &[Proposal],
    ) -> Option<Confirmed> {
        let query = Query::new(maps, query);
        match self.pending.take().map(|pending| query.follow(pending)) {
            Some(pending) if pending.failures == 0 => return self.keep(pending),
            Some(pending) if pending.failures < FAILURES => self.pending = Some(pending),
            Some(_) | None => {}
        }
        let mut best: Option<Pending> = None;
        for pending in proposals.iter().filter_map(|proposal| query.check(proposal)) {
            if best.as_ref().is_none_or(|best| best.latest.found < pending.latest.found) {
                best = Some(pending);
            }
        }
        self.keep(best?)
    }

    /// Keeps a loop until enough keyframes agree; one without any agreement is dropped.
    fn keep(&mut self, pending: Pending) -> Option<Confirmed> {
        if pending.agreeing >= AGREEING {
            self.pending = None;
            return Some(pending.latest);
        }
        self.pending = (pending.agreeing > 0).then_some(pending);
        None
    }
}

/// The keyframe being checked.
struct Query<'a> {
    maps: &'a [&'a SlamMap<'a>],
    robot: usize,
    number: usize,
    image: Image<'a>,
    /// Its own map points in its camera frame, one for each feature.
    points: Vec<Point3>,
}

impl<'a> Query<'a> {
    fn new(maps: &'a [&'a SlamMap<'a>], (robot, number): KeyframeIndex) -> Self {
        let map = maps[robot];
        let pose = map.pose(number);
        let placed = map.point_ids(number).filter_map(|id| map.point(id));
        let points = placed.map(|(place, ..)| pose.inverse_transform(&place)).collect();
        Self { maps, robot, number, image: Image::new(map.features(number)), points }
    }

    /// Checks a proposal, and the query's neighbours.
    fn check(&self, proposal: &Proposal) -> Option<Pending> {
        let (robot, candidate) = proposal.candidate;
        let around = keyframes_around(self.maps[robot], candidate);
        let connected = self.connected();
        if robot == self.robot && around.iter().any(|keyframe| connected.contains(keyframe)) {
            // The robot has just been here.
            return None;
        }
        let window = points_of(self.maps[robot], &around, candidate);
        let search = |transform: &Pose, search: Search| self.image.search(&window, transform, search);
        let found = search(&proposal.candidate_from_query, Search::FIRST);
        if found.len() < FOUND_FIRST {
            return None;
        }
        let refined = self.refined(&proposal.candidate_from_query, &window, &found)?;
        let found = search(&refined.candidate_from_query, Search::REFINED).len();
        if refined.inliers < FITTING || found < FOUND_REFINED {
            return None;
        }
        let latest = Confirmed {
            candidate: proposal.candidate,
            candidate_from_query: refined.candidate_from_query,
            found,
            answer: proposal.answer.clone(),
        };
        let agreeing = self.agreeing_neighbours(&latest);
        Some(Pending { latest, last: self.number, agreeing, failures: 0 })
    }

    /// Counts the neighbours that see the window where the transformation predicts it, up to three.
    fn agreeing_neighbours(&self, found: &Confirmed) -> usize {
        let map = self.maps[self.robot];
        let agrees = |neighbour: &usize| {
            let neighbour = Self::new(self.maps, (self.robot, *neighbour));
            let query_from_neighbour = map.pose(self.number).inverse().after(&map.pose(neighbour.number));
            let candidate_from_neighbour = found.candidate_from_query.after(&query_from_neighbour);
            let window = neighbour.window(found.candidate);
            let seen = neighbour.image.search(&window, &candidate_from_neighbour, Search::NEIGHBOURS);
            seen.len() >= FOUND_BY_NEIGHBOUR
        };
        map.covisible(self.number, COVISIBLE)
            .iter()
            .filter(|neighbour| agrees(neighbour))
            .take(AGREEING)
            .count()
    }

    /// Returns the state of a pending loop after this keyframe: with no failures if the keyframe agrees with the last
    /// agreeing one.
    fn follow(&self, pending: Pending) -> Pending {
        let Some((candidate_from_query, found)) = self.found_later(&pending) else {
            return Pending { failures: pending.failures + 1, ..pending };
        };
        let latest = Confirmed { candidate_from_query, found, ..pending.latest };
        Pending { latest, last: self.number, agreeing: pending.agreeing + 1, failures: 0 }
    }

    fn found_later(&self, pending: &Pending) -> Option<(Pose, usize)> {
        let map = self.maps[self.robot];
        let last_from_query = map.pose(pending.last).inverse().after(&map.pose(self.number));
        let candidate_from_query = pending.latest.candidate_from_query.after(&last_from_query);
        let window = self.window(pending.latest.candidate);
        let search = |transform: &Pose| self.image.search(&window, transform, Search::NEIGHBOURS);
        let found = search(&candidate_from_query);
        if found.len() < FOUND_LATER {
            return None;
        }
        let refined = self.refined(&candidate_from_query, &window, &found)?;
        let found = search(&refined.candidate_from_query).len();
        (refined.inliers > FITTING_LATER && found >= FOUND_LATER_REFINED)
            .then_some((refined.candidate_from_query, found))
    }

    fn window(&self, (robot, candidate): KeyframeIndex) -> Vec<WindowPoint> {
        let left_out = if robot == self.robot { self.connected() } else { BTreeSet::new() };
        let around = keyframes_farther_around(self.maps[robot], candidate, &left_out);
        points_of(self.maps[robot], &around, candidate)
    }

    /// Returns the keyframes that are covisible with the query.
    fn connected(&self) -> BTreeSet<usize> {
        self.maps[self.robot].covisible(self.number, usize::MAX).into_iter().collect()
    }

    fn refined(&self, transform: &Pose, window: &[WindowPoint], found: &[Found]) -> Option<Refined> {
        refined(transform, &self.image, &self.points, window, found)
    }
}
