//! What a decision changes: the facts that the store keeps and the index applies.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::anchor::{Observation, Outcome};
use super::bow::BowVector;
use super::global_descriptor::GlobalDescriptor;
use super::ids::{AnchorSeq, KeyframeId, KeyframeSeq, LoopId, PointId, SessionId, SessionSeq};
use super::judged::{CropRead, ModelVerdict};
use super::judgement::JudgementProgress;
use super::keyframe::{Camera, Detection, NewKeyframe, Stamp};
use super::map::MapProperties;
pub use super::observation_update::{Declared, KeyframeUpdate, ObservationUpdate, PointsOfKeyframe, Renamed};
use super::point_list::PointList;
use super::prior::Prior;
pub use super::session_merge::{MergeUndo, SessionMerge};
use crate::geometry::{Gravity, Point3, Pose, Sim3};

/// A keyframe as the index keeps it: everything but the heavy parts (bag of words, features, crops).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Keyframe {
    /// Its dense number.
    pub seq: KeyframeSeq,
    /// Its name.
    pub id: KeyframeId,
    /// Its session.
    pub session: SessionSeq,
    /// The time when it was taken.
    pub stamp: Stamp,
    /// `map_from_camera` in the session's frame, as last corrected.
    pub map_from_camera: Pose,
    /// `map_from_camera` as it was sent: positions of its detections are kept as they were sent with it.
    pub sent_pose: Pose,
    /// The factor by which lengths have grown since then: sessions were merged with a scale.
    pub scale: f64,
    /// The camera, if known.
    pub camera: Option<Camera>,
    /// Gravity in the camera frame, if known.
    pub gravity: Option<Gravity>,
    /// The height that a barometer tells, in metres above a level of the session's own, if known.
    pub height_m: Option<f64>,
    /// The map points it observes, ascending.
    pub observes: PointList,
    /// The covisible keyframes that the client declared.
    pub declared: Declared,
    /// The map points that its features were sent with and that are others now; `None` as long as the client has not changed
    /// what it observes.
    pub renamed: Option<Renamed>,
    /// Its size on disk, in bytes ([`super::keyframe::NewKeyframe::bytes`]).
    pub bytes: u64,
}

impl Keyframe {
    /// Returns what the index keeps of a keyframe that arrives.
    pub fn arriving(seq: KeyframeSeq, session: SessionSeq, new: &NewKeyframe, declared: Declared) -> Self {
        Self {
            seq,
            id: new.id.clone(),
            session,
            stamp: new.stamp,
            map_from_camera: new.map_from_camera,
            sent_pose: new.map_from_camera,
            scale: 1.0,
            camera: new.camera,
            gravity: new.gravity,
            height_m: new.height_m,
            observes: new.observes.as_slice().into(),
            declared,
            renamed: None,
            bytes: new.bytes(),
        }
    }

    /// Returns the keyframe as a client sends it, as far as it is no list: its session has this name.
    pub fn without_lists(&self, session: SessionId) -> NewKeyframe {
        NewKeyframe {
            session,
            camera: self.camera,
            gravity: self.gravity,
            height_m: self.height_m,
            ..NewKeyframe::at(self.id.clone(), self.stamp, self.map_from_camera)
        }
    }

    /// Returns its pose, with the scale of its lengths.
    pub fn similarity(&self) -> Sim3 {
        Sim3::scaled(self.map_from_camera, self.scale)
    }

    /// Moves it to another pose, with the scale of its lengths.
    pub fn move_to(&mut self, map_from_camera: &Sim3) {
        self.map_from_camera = map_from_camera.without_scale();
        self.scale = map_from_camera.scale();
    }

    /// Returns where a detection is by now whose position was sent with it, in metres in the session's frame: it moves rigidly with
    /// its camera, because what the camera saw does not change.
    pub fn position_now(&self, as_sent: Point3) -> Point3 {
        if self.map_from_camera == self.sent_pose && self.scale == 1.0 {
            return as_sent;
        }
        self.similarity().transform(&self.sent_pose.inverse_transform(&as_sent))
    }

    /// Gives detections of this keyframe, as they were sent, the positions that they have by now.
    pub fn place(&self, detections: &mut [Detection]) {
        for position in detections.iter_mut().filter_map(|detection| detection.position_in_session.as_mut()) {
            *position = self.position_now(*position);
        }
    }

    /// Returns the covisible keyframes that the client declared.
    pub fn declared(&self) -> &[(KeyframeSeq, u32)] {
        self.declared.as_deref().unwrap_or_default()
    }
}

/// The reason why two anchors are one.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum MergeCause {
    /// They match, their keyframes are covisible, and they stand close (§IV-C.2).
    Covisible,
    /// They match and this loop was confirmed; revoking the loop splits them again.
    Loop(LoopId),
}

/// A link between two anchors that are one object. Anchors keep their own observations;
/// what is one object is the set of anchors joined by links, named by its oldest.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Merge {
    /// The older anchor.
    pub into: AnchorSeq,
    /// The newer anchor.
    pub from: AnchorSeq,
    /// Why.
    pub cause: MergeCause,
}

/// A loop that a client closed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Loop {
    /// Its name.
    pub id: LoopId,
    /// The keyframe that came back.
    pub keyframe: KeyframeSeq,
    /// The keyframe it came back to.
    pub candidate: KeyframeSeq,
    /// The name of the first, which stays when the keyframe is culled.
    pub keyframe_id: KeyframeId,
    /// The name of the second.
    pub candidate_id: KeyframeId,
    /// The query that found it, if the client told.
    pub query: Option<String>,
    /// Maps points of the keyframe's camera frame into the candidate's, if that query verified it by geometry and its answer is
    /// still kept.
    pub candidate_from_query: Option<Sim3>,
}

/// Two keyframes of one view, by geometry, around which different signs hang (M16).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Twins {
    /// The keyframe that was written last.
    pub keyframe: KeyframeSeq,
    /// The keyframe that it was taken for.
    pub candidate: KeyframeSeq,
    /// A sign around the first.
    pub anchor: AnchorSeq,
    /// The sign that hangs in its place around the second.
    pub candidate_anchor: AnchorSeq,
}

/// A detection that fed one anchor, and is one of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MovedObservation {
    /// The keyframe.
    pub keyframe: KeyframeSeq,
    /// The number of the detection in it.
    pub detection: u16,
    /// The anchor that it fed.
    pub from: AnchorSeq,
    /// The anchor that it feeds.
    pub to: AnchorSeq,
}

/// A passage that had a sign in view and did not see it as it is called (M18).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct MissedSign {
    /// The sign.
    pub anchor: AnchorSeq,
    /// The last keyframe of the passage that had it in view.
    pub keyframe: KeyframeSeq,
    /// The sign that hangs in its place; none where there is none.
    pub other: Option<AnchorSeq>,
}

impl Merge {
    /// Returns what it takes on disk, in bytes.
    pub fn bytes(&self) -> u64 {
        let name = match &self.cause {
            MergeCause::Covisible => 0,
            MergeCause::Loop(id) => id.as_str().len(),
        };
        (2 * size_of::<AnchorSeq>() + name) as u64
    }
}

impl Loop {
    /// Returns what it takes on disk, in bytes, without what it merges.
    pub fn bytes(&self) -> u64 {
        let names = [self.id.as_str(), self.keyframe_id.as_str(), self.candidate_id.as_str()];
        let texts =
            names.iter().map(|name| name.len()).sum::<usize>() + self.query.as_ref().map_or(0, String::len);
        (2 * size_of::<KeyframeSeq>() + texts) as u64
    }
}

/// Parts of a keyframe that are not kept any longer. What was decided with them stays.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ForgottenParts {
    /// The keyframe.
    pub keyframe: KeyframeSeq,
    /// Its features: geometry can be verified with it no more.
    pub features: bool,
    /// The vector of its whole image.
    pub global_descriptor: bool,
    /// The detections whose crops go, with the anchors that they feed.
    pub crops: Vec<(u16, Option<AnchorSeq>)>,
    /// The bytes that they took on disk.
    pub bytes: u64,
}

/// One fact more, or one fact less. A request's changes are committed together, and applied
/// to the index in this order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Change {
    /// The map's description, classes or settings are now these.
    MapSet(Box<MapProperties>),
    /// The map's words belong to this vocabulary from now on.
    VocabularySet(Box<str>),
    /// A session appeared.
    SessionAdded(SessionSeq, SessionId),
    /// A keyframe arrived, with its bag of words. Features and crops travel to the store beside the change.
    KeyframeAdded(Box<Keyframe>, Arc<BowVector>),
    /// Parts of a keyframe are not kept any longer.
    PartsForgotten(Box<ForgottenParts>),
    /// The keyframe that arrived has this vector of its whole image, in the form of the map's others.
    GlobalDescriptorSet(KeyframeSeq, Box<GlobalDescriptor>),
    /// A keyframe was culled, with its observations; its bag of words says which postings go.
    KeyframeRemoved(KeyframeSeq, Arc<BowVector>),
    /// A keyframe's pose was corrected, with the scale of its lengths ([`Keyframe::similarity`]); its detections move with it.
    PoseSet(KeyframeSeq, Sim3),
    /// A map point has this position now, in its session's frame.
    PointSet(SessionSeq, PointId, Point3),
    /// The last keyframe that observed these map points is gone, and they with it.
    PointsForgotten(SessionSeq, Box<[PointId]>),
    /// An anchor was founded.
    AnchorAdded(AnchorSeq, Box<str>),
    /// An anchor is a prior one: a plan shows it.
    PriorSet(AnchorSeq, Box<Prior>),
    /// An anchor is gone: it lost its last observation, or an operator deleted it.
    AnchorRemoved(AnchorSeq),
    /// A detection feeds an anchor (a new fact about the anchor).
    Observed(AnchorSeq, Box<Observation>),
    /// A detection feeds another anchor from now on.
    ObservationMoved(MovedObservation),
    /// The outcome of a detection.
    OutcomeSet(KeyframeSeq, u16, Outcome),
    /// A client's map changed what keyframes observe; the changes that follow from it come after it.
    ObservationsSent(Box<ObservationUpdate>),
    /// A keyframe observes other map points now, or is declared covisible with other keyframes.
    PointsOfKeyframeSet(Box<PointsOfKeyframe>),
    /// A detection has these map points now, ascending.
    PointsOfDetectionSet(AnchorSeq, KeyframeSeq, u16, Box<[PointId]>),
    /// An operator overrides an anchor's description (`None`: no longer).
    DescriptionSet(AnchorSeq, Option<Box<str>>),
    /// Something about this anchor changed: this is its version now.
    AnchorTouched(AnchorSeq, u64),
    /// Two anchors are one object.
    Merged(Merge),
    /// Two anchors that were one object, as a merge of sessions had it, are two again.
    Parted(Merge),
    /// The keyframes of a session are of another one now; the changes that bring them into its frame come with it.
    SessionsMerged(Box<SessionMerge>),
    /// A merge of sessions can be revoked, by this.
    MergeKept(Box<MergeUndo>),
    /// The merge of this session can be revoked no more: something was written on top of it.
    MergeSettled(SessionSeq),
    /// A merge of sessions was revoked; the changes that bring the keyframes back into their frame come with it.
    MergeRevoked(Box<MergeUndo>),
    /// A loop was closed; its two keyframes are covisible from now on.
    LoopAdded(Loop),
    /// A loop was revoked, with its merges and its covisibility.
    LoopRemoved(LoopId),
    /// Geometry verified a pair of keyframes that the anchors contradict.
    TwinsFound(Twins),
    /// Such a pair is none any more.
    TwinsWithdrawn(Twins),
    /// A passage missed a sign.
    SignMissed(MissedSign),
    /// The passages that missed a sign count no longer: it was seen again, or it is retired.
    MissesWithdrawn(AnchorSeq),
    /// A sign hangs there no longer; the other one hangs in its place, if any does.
    SignRetired(AnchorSeq, Option<AnchorSeq>),
    /// A retired sign hangs there again.
    SignReturned(AnchorSeq),
    /// A model read a detection's crop (a fact about the anchor that the detection feeds).
    CropRead(Box<CropRead>),
    /// A model judged texts of this map.
    Judged(Box<ModelVerdict>),
    /// A job that asks verdicts again has settled some of its questions.
    JudgementAdvanced(Box<JudgementProgress>),
    /// The model that this map waits for is away, or back.
    ModelAway(bool),
}
