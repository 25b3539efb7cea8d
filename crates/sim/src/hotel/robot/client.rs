//! Robot: a SLAM client with odometry and its own pose graph, which queries the server at each keyframe.
//!
//! A loop that it closes becomes an edge of its pose graph, whether correct or not. This is the purpose of the
//! experiment.

use super::message;
use super::pose_graph::{Edge, Sigma, UnknownPose, optimise};
use super::slam_map::SlamMap;
use crate::api::loops::LoopBody;
use crate::api::verdict::LoopAnswer;
use crate::client::{Client, ClientError};
use crate::domain::ids::IdError;
use crate::geometry::{Point3, Sim3};
use crate::hotel::method::Method;
use crate::hotel::sensing::camera::Stand;
use crate::hotel::sequence::Step;
use nalgebra::{UnitQuaternion, Vector3};

/// Keyframes that a robot collects after a closed loop before it optimises again (ORB-SLAM2: 10).
const CLOSING_EVERY_KEYFRAMES: usize = 10;
/// Odometry error between two keyframes, as assumed by the pose graph.
const ODOMETRY_SIGMA: Sigma = Sigma { m: 0.01, rad: 0.004, log_scale: 0.01 };
/// Error of a loop's transformation, as assumed by the pose graph.
const LOOP_SIGMA: Sigma = Sigma { m: 0.02, rad: 0.006, log_scale: 0.01 };
/// Poses and points that moved less are not sent again.
const MOVED_M: f64 = 0.001;
const MOVED_RAD: f64 = 0.0005;
/// Poses whose scale changed by less are not sent again.
const MOVED_LOG_SCALE: f64 = 0.0005;
/// Maximum points of one request, the API's limit.
const POINTS_PER_CORRECTION: usize = 100_000;

/// The reason why a run ended early.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// The server rejected a request or was unreachable.
    #[error(transparent)]
    Client(#[from] ClientError),
    /// An edge of the pose graph leads nowhere.
    #[error(transparent)]
    PoseGraph(#[from] UnknownPose),
}

/// A robot during a run.
#[derive(Debug)]
pub struct Robot<'a> {
    client: &'a Client,
    /// The map's id on the server.
    map: &'a str,
    arm: Method,
    session: String,
    slam_map: SlamMap<'a>,
    /// The frames of its keyframes, as last sent to the server.
    told: Vec<Sim3>,
    edges: Vec<Edge>,
    /// The newest loop accepted since the last optimisation, and its keyframe.
    waiting: Option<(usize, LoopToClose)>,
    last_closing: usize,
    closed: usize,
}

/// A loop that a robot closes with its latest keyframe.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopToClose {
    /// The id of the keyframe to close it with.
    pub candidate: String,
    /// The latest keyframe's pose in the candidate's camera frame, in units of the map, and the ratio of their scales.
    pub candidate_from_query: Sim3,
    /// The id of the answer that proposed it.
    pub answer: String,
}

impl<'a> Robot<'a> {
    /// Returns a robot before its first keyframe.
    pub fn new(client: &'a Client, map: &'a str, arm: Method, session: impl Into<String>) -> Self {
        Self {
            client,
            map,
            arm,
            session: session.into(),
            slam_map: SlamMap::default(),
            told: Vec::new(),
            edges: Vec::new(),
            waiting: None,
            last_closing: 0,
            closed: 0,
        }
    }

    /// Returns its own map, in its own frame.
    pub fn slam_map(&self) -> &SlamMap<'a> {
        &self.slam_map
    }

    /// Returns the number of its pose graph optimisations.
    pub fn closed(&self) -> usize {
        self.closed
    }

    /// Returns a keyframe's id.
    pub fn keyframe_id(&self, number: usize) -> String {
        format!("{}-{number}", self.session)
    }

    /// Returns the keyframe's number, if it is one of this robot's.
    pub fn number_of(&self, keyframe: &str) -> Option<usize> {
        keyframe.strip_prefix(&self.session)?.strip_prefix('-')?.parse().ok()
    }

    /// Sends the next keyframe with a loop query, and returns the answer.
    pub async fn ask(&mut self, step: &'a Step) -> Result<LoopAnswer, DriveError> {
        let frame = match self.slam_map.frames().last() {
            Some(last) => last.after(&Sim3::from(step.motion)),
            // Its frame is arbitrary: it does not know its initial pose.
            None => Sim3::from(Stand { at: [0.0, 0.0], heading_rad: 0.0 }.map_from_camera()),
        };
        let number = self.slam_map.push(step, &frame);
        if number > 0 {
            self.edges.push(Edge {
                from: number - 1,
                to: number,
                from_from_to: Sim3::from(step.motion),
                sigma: ODOMETRY_SIGMA,
            });
        }
        self.told.push(frame);
        let body = message::keyframe(self.arm, &self.session, number, step, &frame);
        let id = self.keyframe_id(number);
        let answer = self.client.put_keyframe(self.map, &id, &body, true).await?;
        Ok(answer.answer.loop_answer.unwrap_or_else(|| unreachable!("it was asked for")))
    }

    /// Accepts a loop of its latest keyframe, if any, and optimises once enough keyframes have followed.
    pub async fn close(&mut self, closed_with: Option<LoopToClose>) -> Result<(), DriveError> {
        let Some(latest) = self.told.len().checked_sub(1) else { return Ok(()) };
        if let Some(closed_with) = closed_with {
            // A loop with another robot's keyframe corrects no pose, because each robot has its own frame.
            if let Some(earlier) = self.number_of(&closed_with.candidate) {
                self.edges.push(Edge {
                    from: earlier,
                    to: latest,
                    from_from_to: self.in_units(earlier, latest, &closed_with.candidate_from_query),
                    sigma: LOOP_SIGMA,
                });
            }
            self.waiting = Some((latest, closed_with));
        }
        if self.waiting.is_some() && latest >= self.last_closing + CLOSING_EVERY_KEYFRAMES {
            self.close_loops().await?;
        }
        Ok(())
    }

    /// Closes the remaining loops at the end of the run.
    pub async fn finish(&mut self) -> Result<(), DriveError> {
        if self.waiting.is_none() { Ok(()) } else { self.close_loops().await }
    }

    /// Optimises the pose graph, sends the corrected poses and points, and confirms the loop.
    async fn close_loops(&mut self) -> Result<(), DriveError> {
        let mut frames = self.slam_map.frames().to_vec();
        optimise(&mut frames, &self.edges)?;
        self.slam_map.correct(frames);
        self.last_closing = self.told.len() - 1;
        self.closed += 1;
        let moved: Vec<usize> = (0..self.told.len()).filter(|number| self.has_moved(*number)).collect();
        if !moved.is_empty() {
            let corrected =
                |number: &usize| Ok((self.keyframe_id(*number).parse()?, self.slam_map.pose(*number)));
            let keyframes = moved.iter().map(corrected).collect::<Result<Vec<_>, IdError>>();
            let keyframes = keyframes.map_err(ClientError::from)?;
            let points: Vec<(u64, Point3)> = (self.slam_map.points().into_iter())
                .filter(|(_, reference, _)| self.has_moved(*reference))
                .map(|(id, _, place)| (id, place))
                .collect();
            // Poses with the first points: a long tour has more points than fit in one request.
            let mut parts = points.chunks(POINTS_PER_CORRECTION);
            let first = message::poses(&self.session, &keyframes, parts.next().unwrap_or_default());
            self.client.post_poses(self.map, &first).await?;
            for part in parts {
                self.client.post_poses(self.map, &message::poses(&self.session, &[], part)).await?;
            }
            for number in moved {
                self.told[number] = self.slam_map.frames()[number];
            }
        }
        // One loop per closing, the newest: the others are its neighbours.
        if let Some((latest, LoopToClose { candidate, answer, .. })) = self.waiting.take() {
            let id = format!("{}-loop-{}", self.session, self.closed);
            let keyframe = self.keyframe_id(latest);
            let body = LoopBody::found(&id, &keyframe, &candidate, answer).map_err(ClientError::from)?;
            self.client.post_loop(self.map, &body).await?;
        }
        Ok(())
    }

    /// Converts a loop's transformation to the units of the two frames; the server uses units of the map for both.
    fn in_units(&self, candidate: usize, query: usize, candidate_from_query: &Sim3) -> Sim3 {
        let [in_candidate, in_query] =
            [candidate, query].map(|number| self.slam_map.frames()[number].scale());
        let length = |scale: f64| Sim3::from_parts(scale, UnitQuaternion::identity(), Vector3::zeros());
        length(in_candidate).inverse().after(candidate_from_query).after(&length(in_query))
    }

    fn has_moved(&self, number: usize) -> bool {
        let (told, now) = (&self.told[number], &self.slam_map.frames()[number]);
        let change = told.without_scale().inverse().after(&now.without_scale());
        let [_, _, _, w] = change.rotation_xyzw();
        let log_scale = (now.scale() / told.scale()).ln();
        change.centre().coords.norm() > MOVED_M
            || 2.0 * w.abs().min(1.0).acos() > MOVED_RAD
            || log_scale.abs() > MOVED_LOG_SCALE
    }
}
