//! Events: changes of a map that listeners are notified of.

use super::ids::{AnchorSeq, KeyframeId, LoopId, SessionId};
use super::keyframe::Stamp;
use crate::named::named;

named! {
    /// The kinds of events.
    EventKind default KeyframeStored {
        /// A keyframe arrived.
        KeyframeStored = "keyframe_stored",
        /// A keyframe was deleted.
        KeyframeRemoved = "keyframe_removed",
        /// A client corrected poses or map points of a session.
        PosesCorrected = "poses_corrected",
        /// An anchor has a description, or another one than before.
        AnchorDescribed = "anchor_described",
        /// Two anchors match though their keyframes are not covisible: the robot has come back (§III).
        AnchorsMatched = "anchors_matched",
        /// Two anchors became one.
        AnchorsMerged = "anchors_merged",
        /// A sign hangs there no longer.
        AnchorRetired = "anchor_retired",
        /// A keyframe that arrived is a loop.
        LoopFound = "loop_found",
        /// A keyframe that arrived looks like a place, and evidence speaks against it. The first of a row of such keyframes of a
        /// session is told; `GET .../loop-queries` lists each.
        LoopRejected = "loop_rejected",
        /// A client closed a loop.
        LoopConfirmed = "loop_confirmed",
        /// A client took a loop back.
        LoopRevoked = "loop_revoked",
        /// A confirmed loop contradicts the others.
        LoopSuspected = "loop_suspected",
        /// The keyframes of a session are of another one now.
        SessionsMerged = "sessions_merged",
        /// A merge of sessions was taken back.
        MergeRevoked = "merge_revoked",
        /// The map was published under a name.
        ReleasePublished = "release_published",
    }
}

/// One event. It is flat, so that a reader in any language needs one struct; what a kind does
/// not speak of is empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Event {
    /// Its number in its map, growing by one; the id of the server-sent event.
    pub seq: u64,
    /// The kind of an event.
    pub kind: EventKind,
    /// The map's version in which it happened.
    pub map_version: u64,
    /// When it was written, by the server's clock; none before that.
    pub told: Option<Stamp>,
    /// The anchor it is about; of two that merged, the one whose name both go by.
    pub anchor: Option<AnchorSeq>,
    /// The other anchor.
    pub other: Option<AnchorSeq>,
    /// The keyframe that came back.
    pub keyframe: Option<KeyframeId>,
    /// The keyframe it came back to.
    pub candidate: Option<KeyframeId>,
    /// The loop it is about.
    pub loop_id: Option<LoopId>,
    /// The loop query that found it.
    pub query: Option<String>,
    /// The session that merged into another one.
    pub session: Option<SessionId>,
    /// The session that it merged into.
    pub into: Option<SessionId>,
    /// The description, or one sentence for a person.
    pub detail: Option<String>,
}

impl Event {
    /// Returns an event of which nothing is known but its kind; its number and version come when it is kept.
    pub fn of(kind: EventKind) -> Self {
        Self { kind, ..Self::default() }
    }
}
