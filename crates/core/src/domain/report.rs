//! What a reader is shown of a map: derived views, never facts.

use serde::{Deserialize, Serialize};

use super::anchor::{AnchorState, Outcome};
use super::change::Merge;
use super::fleet_frames::Suspect;
use super::ids::{AnchorSeq, BackupId, JudgementId, KeyframeId, LoopId, MapId, SessionId};
use super::judgement::{Asks, Estimate, JobState, Replaced, Tally};
use super::keyframe::{NewKeyframe, Stamp};
use super::map::{Learned, MapProperties};
use super::prior::Prior;
use crate::geometry::{Aabb, Point3, Pose};
use crate::semantics::TextKind;

/// A map at one version.
#[derive(Clone, Debug, PartialEq)]
pub struct MapReport {
    /// The map.
    pub id: MapId,
    /// Its description, classes and settings.
    pub properties: MapProperties,
    /// The vocabulary its words belong to, once there are any.
    pub vocabulary: Option<String>,
    /// Grows by one with each write.
    pub version: u64,
    /// Number of its keyframes.
    pub keyframes: usize,
    /// Number of its anchors, merged ones counted once.
    pub anchors: usize,
    /// Number of sessions that have written to it.
    pub sessions: usize,
    /// Number of its confirmed loops.
    pub loops: usize,
    /// Size of its keyframes on disk, in bytes.
    pub bytes: u64,
    /// Its knowledge of its building; empty in a map that was last written to by a version that did not say so.
    pub learned: Learned,
}

/// The outcome of ingesting one keyframe.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframeReport {
    /// The keyframe.
    pub keyframe: KeyframeId,
    /// The map's version after it.
    pub map_version: u64,
    /// Number of keyframes covisible with it.
    pub covisible: usize,
    /// Whether nothing joins it with the others of its session.
    pub is_cut_off: bool,
    /// The outcomes of its detections, in their order, each with its anchor's state.
    pub detections: Vec<(Outcome, Option<AnchorState>)>,
    /// Whether it has just shown an anchor that matches one seen before. That triggers loop detection (§III).
    pub revisits: bool,
}

/// One distinct reading of an anchor with its votes (M4).
#[derive(Clone, Debug, PartialEq)]
pub struct ReadingReport {
    /// The text, as last read.
    pub text: String,
    /// The sum of the detections' confidences.
    pub weight: f64,
    /// Number of detections that read it.
    pub count: usize,
}

/// A match between two anchors (§IV-C.2).
#[derive(Clone, Debug, PartialEq)]
pub struct AnchorMatchReport {
    /// The other anchor.
    pub anchor: AnchorSeq,
    /// Its public id.
    pub name: String,
    /// SimilarityLevel, 1 to 5.
    pub level: u8,
    /// The judge: `identical`, `identifiers`, `lexical`, `operator`, `model:<name>`.
    pub source: String,
    /// Whether some of the two anchors' keyframes are covisible. If not, the robot has come back.
    pub revisit: bool,
    /// One sentence for a person.
    pub reason: String,
}

/// An anchor with all that was derived about it.
#[derive(Clone, Debug, PartialEq)]
pub struct AnchorReport {
    /// The anchor.
    pub anchor: AnchorSeq,
    /// Its public id.
    pub name: String,
    /// Of a prior one, the session that stands for the plan's frame, and what the plan says.
    pub prior: Option<(SessionId, Prior)>,
    /// Its class.
    pub class: String,
    /// The state of its description.
    pub state: AnchorState,
    /// Its description.
    pub description: Option<String>,
    /// The kind of that.
    pub kind: Option<TextKind>,
    /// The source of its description: `readings`, `operator` or `plan`.
    pub description_source: &'static str,
    /// The identifiers found in the description.
    pub identifiers: Vec<String>,
    /// InformationLevel of the description, 1 to 5.
    pub information_level: u8,
    /// One sentence for a person that says why it has that level, if it has a description.
    pub information_reason: Option<String>,
    /// The patterns or shapes of the building's numbers on signs of this class, if that is known.
    pub numbering: Vec<String>,
    /// Its place in a plan's frame, if it is known.
    pub plan_place: Option<PlanPlace>,
    /// The distinct readings, heaviest first.
    pub readings: Vec<ReadingReport>,
    /// Two readings by models or people that cannot be of one object.
    pub disagreement: Option<String>,
    /// The keyframes that saw it, in order of arrival.
    pub keyframes: Vec<KeyframeId>,
    /// Its box in the frame of each session that saw it, oldest session first, and whether a guess of its distance placed it.
    pub frames: Vec<(SessionId, Aabb, bool)>,
    /// Number of its distinct map points.
    pub map_points: usize,
    /// The anchors that match it; bounded, oldest first.
    pub matches: Vec<AnchorMatchReport>,
    /// Number of anchors that match it in all.
    pub matches_total: usize,
    /// Of a retired one, the anchor that hangs in its place.
    pub replaced_by: Option<AnchorSeq>,
    /// The anchor it was merged into, if it was.
    pub merged_into: Option<AnchorSeq>,
    /// The anchors merged into it.
    pub merged_from: Vec<AnchorSeq>,
    /// Grows with each fact about this anchor.
    pub version: u64,
    /// Whether it has an image crop.
    pub has_crop: bool,
}

/// The place of an anchor in a plan's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanPlace {
    /// The session that stands for the plan's frame.
    pub frame: SessionId,
    /// The aligned session that it is known by; none for what the plan itself shows.
    pub by: Option<SessionId>,
    /// The place, in metres.
    pub position_in_frame: Point3,
}

/// A session of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct SessionReport {
    /// Its name.
    pub id: SessionId,
    /// Number of its keyframes.
    pub keyframes: usize,
    /// The times of its first and its last keyframe, by stamp.
    pub stamps: Option<(Stamp, Stamp)>,
    /// Number of prior anchors in its frame; of a plan's frame only.
    pub priors: usize,
    /// Its alignment to a plan.
    pub alignment: Option<AlignmentReport>,
}

/// The alignment of a session to a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct AlignmentReport {
    /// The session that stands for the plan's frame.
    pub frame: SessionId,
    /// Maps points of the session's frame into the plan's frame.
    pub plan_from_session: Pose,
    /// Number of signs of the plan that agree.
    pub inliers: usize,
    /// Standard deviation of the place where they were seen, in metres.
    pub position_sigma_m: f64,
    /// Standard deviation of the rotation about the vertical, in rad.
    pub yaw_sigma_rad: f64,
}

/// The places of a map's sessions relative to one of them.
#[derive(Clone, Debug, PartialEq)]
pub struct FramesReport {
    /// The map's version that it was computed at.
    pub version: u64,
    /// The session in whose frame the others are; none in a map without sessions.
    pub reference: Option<SessionId>,
    /// The sessions, in order of appearance.
    pub frames: Vec<FrameReport>,
    /// The confirmed loops that contradict the others, by name.
    pub suspects: Vec<Suspect>,
    /// The number of confirmed loops between sessions that count.
    pub loops: usize,
    /// The number of those without a transformation.
    pub left_out: usize,
}

/// A session in the frame of the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameReport {
    /// The session.
    pub session: SessionId,
    /// Maps points of its frame into that of the reference; none if nothing joins the two.
    pub reference_from_session: Option<Pose>,
    /// The root mean square of what its loops are off, in metres.
    pub residual_m: Option<f64>,
    /// The number of its loops with other sessions that count.
    pub loops: usize,
}

/// A job that asks a map's verdicts again, as it stands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JudgementReport {
    /// The map's version.
    pub map_version: u64,
    /// The job; `None` of a preview.
    pub id: Option<JudgementId>,
    /// The verdicts that it asks for again.
    pub asks: Asks,
    /// Its state; `None` of a preview.
    pub state: Option<JobState>,
    /// Whether it is running and no model can be asked now: none is configured, it is away, or the budget is spent.
    pub waits: bool,
    /// Its questions, as counted when it began.
    pub questions: u64,
    /// The most that it may take.
    pub estimate: Estimate,
    /// The outcomes of its questions.
    pub tally: Tally,
    /// The verdicts that it replaced by others, the newest first.
    pub replaced: Vec<Replaced>,
}

/// A confirmed loop.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopReport {
    /// Its name.
    pub id: LoopId,
    /// The keyframe that came back.
    pub keyframe: KeyframeId,
    /// The keyframe it came back to.
    pub candidate: KeyframeId,
    /// The query that found it.
    pub query: Option<String>,
    /// The anchors it merged.
    pub merged: Vec<Merge>,
}

/// A backup that is verified and on disk; serialised, the note beside it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BackupReport {
    /// Its name.
    pub id: BackupId,
    /// The time of the request: everything acknowledged before is in it.
    #[serde(flatten, with = "Created")]
    pub created: Stamp,
    /// Its size.
    pub bytes: u64,
    /// Its SHA-256, in hexadecimal.
    pub sha256: String,
    /// The version of its schema.
    pub schema: i64,
    /// Maps in it.
    pub maps: u64,
    /// Keyframes in it.
    pub keyframes: u64,
    /// Anchors in it, merged ones too.
    pub anchors: u64,
}

/// The time of a backup in its note.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Stamp")]
struct Created {
    #[serde(rename = "created_sec")]
    sec: i64,
    #[serde(rename = "created_nanosec")]
    nanosec: u32,
}

/// The questions to models, and their cost.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UsageReport {
    /// By operation and model.
    pub lines: Vec<UsageLine>,
    /// Calls since midnight, UTC.
    pub calls_today: u64,
    /// Cost of today, in millionths of a US dollar.
    pub microusd_today: u64,
    /// The most calls of a day.
    pub daily_calls: Option<u64>,
    /// The most that a day may cost, in millionths of a US dollar.
    pub daily_microusd: Option<u64>,
    /// Whether a model is away, or the budget spent.
    pub away: bool,
}

/// Calls of one model for one operation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UsageLine {
    /// `similarity`, `information`, `merge` or `describe`.
    pub operation: String,
    /// The model's name.
    pub model: String,
    /// Calls.
    pub calls: u64,
    /// Tokens sent.
    pub input_tokens: u64,
    /// Tokens received.
    pub output_tokens: u64,
    /// Cost in millionths of a US dollar.
    pub microusd: u64,
    /// Questions answered without a call.
    pub cache_hits: u64,
}

/// A keyframe as it stands now.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframeRecord {
    /// The keyframe as the client sent it, with its pose, its points and its detections' positions as last corrected.
    pub keyframe: NewKeyframe,
    /// The outcomes of its detections, in their order, each with its anchor's state.
    pub detections: Vec<(Outcome, Option<AnchorState>)>,
    /// Whether the crop of each is kept.
    pub has_crop: Vec<bool>,
    /// Number of keyframes covisible with it.
    pub covisible: usize,
}

/// A line of the list of keyframes.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframeSummary {
    /// Its name.
    pub id: KeyframeId,
    /// Its session.
    pub session: SessionId,
    /// The time when it was taken.
    pub stamp: Stamp,
    /// `map_from_camera`, as last corrected.
    pub map_from_camera: Pose,
    /// Number of keyframes covisible with it.
    pub covisible: usize,
    /// The anchors it sees.
    pub anchors: Vec<AnchorSeq>,
}

/// One part of a list: where the next part starts, if there is one.
#[derive(Clone, Debug, PartialEq)]
pub struct Page<T> {
    /// The items.
    pub items: Vec<T>,
    /// The cursor of the next part.
    pub next_cursor: Option<String>,
}

impl<T> Page<T> {
    /// Returns the first `limit` of the items that are left; if there are more, with the cursor of the last one of these.
    pub fn of(mut items: Vec<T>, limit: usize, cursor: impl FnOnce(&T) -> String) -> Self {
        let more = items.len() > limit;
        items.truncate(limit);
        let next_cursor = items.last().filter(|_| more).map(cursor);
        Self { items, next_cursor }
    }
}
