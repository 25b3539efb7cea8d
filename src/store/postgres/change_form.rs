//! The form of changes in the log: plain values, from which the constructors of the model make changes again.
//!
//! Kinds of changes that are rare have none: whoever follows the map loads it anew.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::domain::anchor::{IgnoredReason, Observation, Outcome};
use crate::domain::bow::BowVector;
use crate::domain::change::{Change, Keyframe, Loop, Merge, MergeCause, MissedSign, MovedObservation, Twins};
use crate::domain::global_descriptor::{GlobalDescriptor, GlobalEncoding};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, LoopId, SessionSeq, StoredId};
use crate::domain::keyframe::{Camera, Stamp};
use crate::geometry::{Gravity, Point3, Pose, Sim3};

/// A translation in metres, and a quaternion xyzw.
type PoseForm = ([f64; 3], [f64; 4]);

/// One change. Seqs are numbers, ids texts; units and frames are those of [`Change`].
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Form {
    Vocabulary(String),
    Session(u32, String),
    Keyframe(Box<KeyframeForm>),
    Global(u32, String, String, Vec<u8>),
    KeyframeRemoved(u32, Vec<u32>, Vec<u32>),
    Pose(u32, PoseForm),
    Point(u32, i64, [f64; 3]),
    PointsForgotten(u32, Vec<i64>),
    Anchor(u32, String),
    AnchorRemoved(u32),
    Observed(u32, Box<ObservationForm>),
    Moved(u32, u16, u32, u32),
    Created(u32, u16, u32),
    SeenAgain(u32, u16, u32),
    Ignored(u32, u16, String),
    Position(u32, u32, u16, [f64; 3]),
    Description(u32, Option<String>),
    Touched(u32, u64),
    Merged(MergeForm),
    Parted(MergeForm),
    LoopAdded(Box<LoopForm>),
    LoopRemoved(String),
    TwinsFound([u32; 4]),
    TwinsWithdrawn([u32; 4]),
    Missed(u32, u32, Option<u32>),
    MissesWithdrawn(u32),
    Retired(u32, Option<u32>),
    Returned(u32),
}

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
    declared: Vec<(u32, u32)>,
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

impl Form {
    /// Returns the form of a change; `None` if its kind has none.
    pub(super) fn of(change: &Change) -> Option<Self> {
        Some(match change {
            Change::VocabularySet(name) => Self::Vocabulary(name.to_string()),
            Change::SessionAdded(seq, id) => Self::Session(seq.0, id.to_string()),
            Change::KeyframeAdded(keyframe, bow) => {
                Self::Keyframe(Box::new(KeyframeForm::of(keyframe, bow)?))
            }
            Change::GlobalDescriptorSet(seq, descriptor) => Self::Global(
                seq.0,
                descriptor.model.to_string(),
                descriptor.encoding.as_str().to_owned(),
                descriptor.data.to_vec(),
            ),
            Change::KeyframeRemoved(seq, bow) => {
                Self::KeyframeRemoved(seq.0, bow.words().to_vec(), bow.weights().to_vec())
            }
            Change::PoseSet(seq, pose) => Self::Pose(seq.0, pose_form(pose)),
            Change::PointSet(session, id, at) => Self::Point(session.0, *id, (*at).into()),
            Change::PointsForgotten(session, ids) => Self::PointsForgotten(session.0, ids.to_vec()),
            Change::AnchorAdded(seq, class) => Self::Anchor(seq.0, class.to_string()),
            Change::AnchorRemoved(seq) => Self::AnchorRemoved(seq.0),
            Change::Observed(seq, observed) => {
                Self::Observed(seq.0, Box::new(ObservationForm::of(observed)?))
            }
            Change::ObservationMoved(moved) => {
                Self::Moved(moved.keyframe.0, moved.detection, moved.from.0, moved.to.0)
            }
            Change::OutcomeSet(seq, detection, outcome) => match outcome {
                Outcome::Created(anchor) => Self::Created(seq.0, *detection, anchor.0),
                Outcome::Observed(anchor) => Self::SeenAgain(seq.0, *detection, anchor.0),
                Outcome::Ignored(reason) => Self::Ignored(seq.0, *detection, reason.as_str().to_owned()),
            },
            Change::PositionSet(anchor, keyframe, detection, at) => {
                Self::Position(anchor.0, keyframe.0, *detection, (*at).into())
            }
            Change::DescriptionSet(seq, text) => Self::Description(seq.0, text.as_deref().map(str::to_owned)),
            Change::AnchorTouched(seq, version) => Self::Touched(seq.0, *version),
            Change::Merged(merge) => Self::Merged(MergeForm::of(merge)),
            Change::Parted(merge) => Self::Parted(MergeForm::of(merge)),
            Change::LoopAdded(closed) => Self::LoopAdded(Box::new(LoopForm::of(closed))),
            Change::LoopRemoved(id) => Self::LoopRemoved(id.to_string()),
            Change::TwinsFound(twins) => Self::TwinsFound(twins_form(*twins)),
            Change::TwinsWithdrawn(twins) => Self::TwinsWithdrawn(twins_form(*twins)),
            Change::SignMissed(missed) => {
                Self::Missed(missed.anchor.0, missed.keyframe.0, missed.other.map(|other| other.0))
            }
            Change::MissesWithdrawn(anchor) => Self::MissesWithdrawn(anchor.0),
            Change::SignRetired(anchor, other) => Self::Retired(anchor.0, other.map(|other| other.0)),
            Change::SignReturned(anchor) => Self::Returned(anchor.0),
            Change::MapSet(_)
            | Change::PartsForgotten(_)
            | Change::PriorSet(..)
            | Change::ObservationsSent(_)
            | Change::PointsOfKeyframeSet(_)
            | Change::PointsOfDetectionSet(..)
            | Change::SessionsMerged(_)
            | Change::MergeKept(_)
            | Change::MergeSettled(_)
            | Change::MergeRevoked(_)
            | Change::CropRead(_)
            | Change::Judged(_)
            | Change::JudgementAdvanced(_)
            | Change::ModelAway(_) => return None,
        })
    }

    /// Returns the change; `None` if a value is none of the model's.
    pub(super) fn change(self) -> Option<Change> {
        Some(match self {
            Self::Vocabulary(name) => Change::VocabularySet(name.into()),
            Self::Session(seq, id) => Change::SessionAdded(SessionSeq(seq), stored(&id)?),
            Self::Keyframe(form) => form.change()?,
            Self::Global(seq, model, encoding, data) => {
                let encoding = GlobalEncoding::from_name(&encoding)?;
                let descriptor = GlobalDescriptor { model: stored(&model)?, encoding, data: data.into() };
                Change::GlobalDescriptorSet(KeyframeSeq(seq), Box::new(descriptor))
            }
            Self::KeyframeRemoved(seq, words, weights) => {
                Change::KeyframeRemoved(KeyframeSeq(seq), bow(words, weights)?)
            }
            Self::Pose(seq, (at, turned)) => Change::PoseSet(KeyframeSeq(seq), Pose::from_stored(at, turned)),
            Self::Point(session, id, at) => Change::PointSet(SessionSeq(session), id, Point3::from(at)),
            Self::PointsForgotten(session, ids) => Change::PointsForgotten(SessionSeq(session), ids.into()),
            Self::Anchor(seq, class) => Change::AnchorAdded(AnchorSeq(seq), class.into()),
            Self::AnchorRemoved(seq) => Change::AnchorRemoved(AnchorSeq(seq)),
            Self::Observed(seq, form) => Change::Observed(AnchorSeq(seq), Box::new(form.observation())),
            Self::Moved(keyframe, detection, from, to) => Change::ObservationMoved(MovedObservation {
                keyframe: KeyframeSeq(keyframe),
                detection,
                from: AnchorSeq(from),
                to: AnchorSeq(to),
            }),
            Self::Created(seq, detection, anchor) => {
                Change::OutcomeSet(KeyframeSeq(seq), detection, Outcome::Created(AnchorSeq(anchor)))
            }
            Self::SeenAgain(seq, detection, anchor) => {
                Change::OutcomeSet(KeyframeSeq(seq), detection, Outcome::Observed(AnchorSeq(anchor)))
            }
            Self::Ignored(seq, detection, reason) => {
                let reason = IgnoredReason::from_name(&reason)?;
                Change::OutcomeSet(KeyframeSeq(seq), detection, Outcome::Ignored(reason))
            }
            Self::Position(anchor, keyframe, detection, at) => {
                Change::PositionSet(AnchorSeq(anchor), KeyframeSeq(keyframe), detection, Point3::from(at))
            }
            Self::Description(seq, text) => Change::DescriptionSet(AnchorSeq(seq), text.map(Into::into)),
            Self::Touched(seq, version) => Change::AnchorTouched(AnchorSeq(seq), version),
            Self::Merged(form) => Change::Merged(form.merge()?),
            Self::Parted(form) => Change::Parted(form.merge()?),
            Self::LoopAdded(form) => Change::LoopAdded(form.closed()?),
            Self::LoopRemoved(id) => Change::LoopRemoved(stored::<LoopId>(&id)?),
            Self::TwinsFound(form) => Change::TwinsFound(twins(form)),
            Self::TwinsWithdrawn(form) => Change::TwinsWithdrawn(twins(form)),
            Self::Missed(anchor, keyframe, other) => Change::SignMissed(MissedSign {
                anchor: AnchorSeq(anchor),
                keyframe: KeyframeSeq(keyframe),
                other: other.map(AnchorSeq),
            }),
            Self::MissesWithdrawn(anchor) => Change::MissesWithdrawn(AnchorSeq(anchor)),
            Self::Retired(anchor, other) => Change::SignRetired(AnchorSeq(anchor), other.map(AnchorSeq)),
            Self::Returned(anchor) => Change::SignReturned(AnchorSeq(anchor)),
        })
    }
}

impl KeyframeForm {
    fn of(keyframe: &Keyframe, bow: &BowVector) -> Option<Self> {
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
            declared: declared.iter().map(|(other, shared)| (other.0, *shared)).collect(),
            bytes: *bytes,
            words: bow.words().to_vec(),
            weights: bow.weights().to_vec(),
        })
    }

    fn change(self) -> Option<Change> {
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
            declared: self.declared.into_iter().map(|(other, shared)| (KeyframeSeq(other), shared)).collect(),
            renamed: None,
            bytes: self.bytes,
        };
        Some(Change::KeyframeAdded(Box::new(keyframe), bow(self.words, self.weights)?))
    }
}

impl ObservationForm {
    fn of(observed: &Observation) -> Option<Self> {
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

    fn observation(self) -> Observation {
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
    fn of(merge: &Merge) -> Self {
        let by = match &merge.cause {
            MergeCause::Covisible => None,
            MergeCause::Loop(id) => Some(id.to_string()),
        };
        Self(merge.into.0, merge.from.0, by)
    }

    fn merge(self) -> Option<Merge> {
        let cause = match self.2 {
            None => MergeCause::Covisible,
            Some(id) => MergeCause::Loop(stored(&id)?),
        };
        Some(Merge { into: AnchorSeq(self.0), from: AnchorSeq(self.1), cause })
    }
}

impl LoopForm {
    fn of(closed: &Loop) -> Self {
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

    fn closed(self) -> Option<Loop> {
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

fn pose_form(pose: &Pose) -> PoseForm {
    (pose.translation_m(), pose.rotation_xyzw())
}

fn twins_form(twins: Twins) -> [u32; 4] {
    [twins.keyframe.0, twins.candidate.0, twins.anchor.0, twins.candidate_anchor.0]
}

fn twins([keyframe, candidate, anchor, candidate_anchor]: [u32; 4]) -> Twins {
    Twins {
        keyframe: KeyframeSeq(keyframe),
        candidate: KeyframeSeq(candidate),
        anchor: AnchorSeq(anchor),
        candidate_anchor: AnchorSeq(candidate_anchor),
    }
}

fn bow(words: Vec<u32>, weights: Vec<u32>) -> Option<Arc<BowVector>> {
    BowVector::from_parts(words, weights).ok().map(Arc::new)
}

fn stored<T: StoredId>(text: &str) -> Option<T> {
    T::stored(text).ok()
}
