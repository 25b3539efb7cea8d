//! The forms of keyframes, observations, merges and loops within [`super::change_form`].

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::domain::anchor::Observation;
use crate::domain::bow::BowVector;
use crate::domain::change::{Change, Keyframe, Loop, Merge, MergeCause};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, SessionSeq, StoredId};
use crate::domain::keyframe::{Camera, Stamp};
use crate::geometry::{Gravity, Point3, Pose, Sim3};

/// A translation in metres, and a quaternion xyzw.
pub(super) type PoseForm = ([f64; 3], [f64; 4]);

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct KeyframeForm {
    seq: u32,
    id: String,
    session: u32,
    stamp: (i64, u32),
    pose: PoseForm,
    camera: Option<([f64; 4], [u32; 2])>,
    gravity: Option<[f64; 3]>,
    observes: Vec<i64>,
    declared: Option<Vec<(u32, u32)>>,
    bytes: u64,
    words: Vec<u32>,
    weights: Vec<u32>,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct ObservationForm {
    keyframe: u32,
    detection: u16,
    confidence: f64,
    map_points: Vec<i64>,
    position: Option<[f64; 3]>,
    range_assumed: bool,
    reading: Option<String>,
    described: bool,
    crop_area_px: Option<f64>,
}

/// Two anchors, and the loop that merged them; none of a covisible merge.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct MergeForm(u32, u32, Option<String>);

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct LoopForm {
    id: String,
    keyframe: u32,
    candidate: u32,
    keyframe_id: String,
    candidate_id: String,
    query: Option<String>,
    /// A scale, then the rest.
    candidate_from_query: Option<(f64, PoseForm)>,
}

impl KeyframeForm {
    pub(super) fn of(keyframe: &Keyframe, bow: &BowVector) -> Option<Self> {
        let Keyframe {
            seq,
            id,
            session,
            stamp,
            map_from_camera,
            camera,
            gravity,
            observes,
            declared,
            renamed,
            bytes,
        } = keyframe;
        if renamed.is_some() {
            return None;
        }
        Some(Self {
            seq: seq.0,
            id: id.to_string(),
            session: session.0,
            stamp: (stamp.sec, stamp.nanosec),
            pose: pose_form(map_from_camera),
            camera: camera
                .map(|Camera { fx, fy, cx, cy, width, height }| ([fx, fy, cx, cy], [width, height])),
            gravity: gravity.map(|gravity| gravity.as_given()),
            observes: observes.iter().collect(),
            declared: declared
                .as_ref()
                .map(|listed| listed.iter().map(|(other, shared)| (other.0, *shared)).collect()),
            bytes: *bytes,
            words: bow.words().to_vec(),
            weights: bow.weights().to_vec(),
        })
    }

    pub(super) fn change(self) -> Option<Change> {
        let gravity = match self.gravity {
            Some(vector) => Some(Gravity::new(vector)?),
            None => None,
        };
        let camera = |([fx, fy, cx, cy], [width, height]): ([f64; 4], [u32; 2])| Camera {
            fx,
            fy,
            cx,
            cy,
            width,
            height,
        };
        let keyframe = Keyframe {
            seq: KeyframeSeq(self.seq),
            id: stored(&self.id)?,
            session: SessionSeq(self.session),
            stamp: Stamp { sec: self.stamp.0, nanosec: self.stamp.1 },
            map_from_camera: Pose::from_stored(self.pose.0, self.pose.1),
            camera: self.camera.map(camera),
            gravity,
            observes: self.observes.into(),
            declared: self.declared.map(|listed| {
                listed.into_iter().map(|(other, shared)| (KeyframeSeq(other), shared)).collect()
            }),
            renamed: None,
            bytes: self.bytes,
        };
        Some(Change::KeyframeAdded(Box::new(keyframe), bow(self.words, self.weights)?))
    }
}

impl ObservationForm {
    pub(super) fn of(observed: &Observation) -> Option<Self> {
        if observed.crop_reading.is_some() {
            return None;
        }
        Some(Self {
            keyframe: observed.keyframe.0,
            detection: observed.detection,
            confidence: observed.confidence,
            map_points: observed.map_points.to_vec(),
            position: observed.position_in_session.map(Into::into),
            range_assumed: observed.range_assumed,
            reading: observed.reading.as_deref().map(str::to_owned),
            described: observed.described,
            crop_area_px: observed.crop_area_px,
        })
    }

    pub(super) fn observation(self) -> Observation {
        Observation {
            keyframe: KeyframeSeq(self.keyframe),
            detection: self.detection,
            confidence: self.confidence,
            map_points: self.map_points.into(),
            position_in_session: self.position.map(Point3::from),
            range_assumed: self.range_assumed,
            reading: self.reading.map(Into::into),
            described: self.described,
            crop_area_px: self.crop_area_px,
            crop_reading: None,
        }
    }
}

impl MergeForm {
    pub(super) fn of(merge: &Merge) -> Self {
        let by = match &merge.cause {
            MergeCause::Covisible => None,
            MergeCause::Loop(id) => Some(id.to_string()),
        };
        Self(merge.into.0, merge.from.0, by)
    }

    pub(super) fn merge(self) -> Option<Merge> {
        let cause = match self.2 {
            None => MergeCause::Covisible,
            Some(id) => MergeCause::Loop(stored(&id)?),
        };
        Some(Merge { into: AnchorSeq(self.0), from: AnchorSeq(self.1), cause })
    }
}

impl LoopForm {
    pub(super) fn of(closed: &Loop) -> Self {
        let similarity = |of: &Sim3| (of.scale(), (of.translation_m(), of.rotation_xyzw()));
        Self {
            id: closed.id.to_string(),
            keyframe: closed.keyframe.0,
            candidate: closed.candidate.0,
            keyframe_id: closed.keyframe_id.to_string(),
            candidate_id: closed.candidate_id.to_string(),
            query: closed.query.clone(),
            candidate_from_query: closed.candidate_from_query.as_ref().map(similarity),
        }
    }

    pub(super) fn closed(self) -> Option<Loop> {
        let similarity = |(scale, (at, turned))| Sim3::scaled(Pose::from_stored(at, turned), scale);
        Some(Loop {
            id: stored(&self.id)?,
            keyframe: KeyframeSeq(self.keyframe),
            candidate: KeyframeSeq(self.candidate),
            keyframe_id: stored(&self.keyframe_id)?,
            candidate_id: stored(&self.candidate_id)?,
            query: self.query,
            candidate_from_query: self.candidate_from_query.map(similarity),
        })
    }
}

pub(super) fn pose_form(pose: &Pose) -> PoseForm {
    (pose.translation_m(), pose.rotation_xyzw())
}

pub(super) fn bow(words: Vec<u32>, weights: Vec<u32>) -> Option<Arc<BowVector>> {
    BowVector::from_parts(words, weights).ok().map(Arc::new)
}

pub(super) fn stored<T: StoredId>(text: &str) -> Option<T> {
    T::stored(text).ok()
}
