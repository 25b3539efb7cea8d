//! The form of changes in the log: plain values, from which the constructors of the model make changes again.
//!
//! Kinds of changes that are rare have none: whoever follows the map loads it anew.

use serde::{Deserialize, Serialize};

use super::form_parts::{
    KeyframeForm, LoopForm, MergeForm, ObservationForm, PoseForm, bow, pose_form, stored,
};
use crate::domain::anchor::{IgnoredReason, Outcome};
use crate::domain::change::{Change, MissedSign, MovedObservation, Twins};
use crate::domain::global_descriptor::{GlobalDescriptor, GlobalEncoding};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, LoopId, SessionSeq};
use crate::geometry::{Point3, Pose};

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
