//! The answer to "where am I?": places with their evidence, and how sure the best of them is.

use std::collections::BTreeSet;

use super::ids::{KeyframeId, MapId, ReleaseName, SessionId};
use super::key::MapPattern;
use super::keyframe::NewKeyframe;
use super::look_for::LookFor;
use super::reason::Reason;
use super::verdict::{Candidate, Odds};
use crate::geometry::{Point3, Pose};
use crate::named::named;

/// Keyframes of one question, at most.
pub const ASKED_KEYFRAMES_MAX: usize = 16;

/// A keyframe that asks where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedKeyframe {
    /// The keyframe; without a pose of its own, its pose is the identity, and its positions are in its camera frame.
    pub keyframe: NewKeyframe,
    /// Whether its client gave it a pose. Poses of several keyframes are in one frame.
    pub has_pose: bool,
}

/// A guess where the camera is. It decides which candidates geometry looks at first, and nothing else.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LocationHint {
    /// The map.
    pub map: Option<MapId>,
    /// A position in the frame of any session, in metres.
    pub position: Option<Point3>,
    /// How far from it the camera may be, in metres.
    pub radius_m: f64,
}

/// "Where am I?" as a client asks it.
#[derive(Clone, Debug, PartialEq)]
pub struct LocateRequest {
    /// The keyframes, of one moment or one short drive; the pose that is sought is the first one's.
    pub keyframes: Vec<AskedKeyframe>,
    /// The maps that are asked; all that exist for the caller if there are none.
    pub maps: Vec<MapPattern>,
    /// The release of each map that is asked; the maps as they stand if none is named.
    pub release: Option<ReleaseName>,
    /// A guess.
    pub hint: LocationHint,
    /// Keyframes that are no candidates, in any map.
    pub without_keyframes: BTreeSet<KeyframeId>,
    /// Sessions whose keyframes are no candidates, in any map.
    pub without_sessions: BTreeSet<SessionId>,
    /// Places that the answer lists.
    pub max: usize,
    /// The seed of whatever is drawn.
    pub seed: u64,
}

named! {
    /// The answer to "where am I?", and the standing of one place in it.
    LocationVerdict {
        /// The place is known: the confidence is at least 0.99.
        Located = "located",
        /// Several places fit, and the evidence does not tell them apart.
        Ambiguous = "ambiguous",
        /// The evidence does not say where it is. The places are guesses.
        Unknown = "unknown",
    }
}

named! {
    /// The source of a place's pose.
    PoseSource {
        /// A verified geometry between the two views, on map points.
        Views = "views",
        /// Matched anchors with positions.
        Anchors = "anchors",
    }
}

named! {
    /// An assumption under which a pose holds.
    Assumption {
        /// Both cameras are equally upright: neither side told the direction of gravity.
        Upright = "upright",
    }
}

/// The standard deviation of a pose, as far as the evidence tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// Of the position, in metres.
    pub translation_m: f64,
    /// Of the rotation, in radians.
    pub rotation_rad: f64,
}

/// A camera's pose in a session's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct LocatedPose {
    /// `map_from_camera`, in metres.
    pub map_from_camera: Pose,
    /// How well it is known.
    pub uncertainty: Uncertainty,
    /// Its source.
    pub source: PoseSource,
    /// The assumptions it rests on.
    pub assumed: Vec<Assumption>,
}

/// A camera's pose in a plan's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanPose {
    /// The plan's frame.
    pub frame: SessionId,
    /// The camera's pose in it, in metres.
    pub plan_from_camera: Pose,
}

/// The signs that speak for a place and against it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SignEvidence {
    /// The identifiers that agree and hang in one place only, as read, by name.
    pub agreeing: Vec<String>,
    /// The number of pairs of identifiers that exclude each other at the same relative place.
    pub contradicting: u32,
}

/// A place at which the camera may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The map, by its place in the list of the maps that were asked.
    pub map: usize,
    /// The map's keyframe that stands for the place; none where only a plan's anchors say it.
    pub keyframe: Option<KeyframeId>,
    /// The number of the asked keyframe, from 0, that was taken there. The pose is the first one's all the same.
    pub asked: usize,
    /// The session in whose frame the pose is.
    pub session: SessionId,
    /// Its standing in the answer.
    pub verdict: LocationVerdict,
    /// The odds that the camera is here.
    pub odds: Odds,
    /// The camera's pose in the session's frame, where the evidence gives one.
    pub pose: Option<LocatedPose>,
    /// The same in the frame of the plan to which the session is aligned.
    pub in_plan: Option<PlanPose>,
    /// The signs that agree and contradict.
    pub signs: SignEvidence,
    /// The number of keyframes of this place, this one included, that geometry verified.
    pub verified_views: u32,
    /// The checks of the keyframe, with their figures; none where only a plan's anchors say it.
    pub candidate: Option<Candidate>,
}

/// The answer to "where am I?".
#[derive(Clone, Debug, PartialEq)]
pub struct Location {
    /// The answer.
    pub verdict: LocationVerdict,
    /// Why, in one sentence.
    pub why: String,
    /// The confidence in the first place; 0 without any.
    pub confidence: f64,
    /// The places, best first.
    pub places: Vec<Place>,
    /// Where places are ambiguous: the signs that would tell them apart.
    pub look_for: Vec<LookFor>,
    /// Why there is no place, or why the first one is not certain.
    pub reason: Option<Reason>,
}
