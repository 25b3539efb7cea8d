//! What happened in a map, for those who listen.

use super::ids::{AnchorSeq, KeyframeId, LoopId};

/// The kinds of events (`openapi/openapi.yaml`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// An anchor has a description, or another one than before.
    AnchorDescribed,
    /// Two anchors match though their keyframes are not covisible: the robot has come back (§III).
    AnchorsMatched,
    /// Two anchors became one.
    AnchorsMerged,
    /// A sign hangs there no longer.
    AnchorRetired,
    /// A keyframe that arrived is a loop.
    LoopFound,
    /// A client closed a loop.
    LoopConfirmed,
    /// A client took a loop back.
    LoopRevoked,
}

impl EventKind {
    const ALL: [Self; 7] = [
        Self::AnchorDescribed,
        Self::AnchorsMatched,
        Self::AnchorsMerged,
        Self::AnchorRetired,
        Self::LoopFound,
        Self::LoopConfirmed,
        Self::LoopRevoked,
    ];

    /// The kind's name in the API document.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::AnchorDescribed => "anchor_described",
            Self::AnchorsMatched => "anchors_matched",
            Self::AnchorsMerged => "anchors_merged",
            Self::AnchorRetired => "anchor_retired",
            Self::LoopFound => "loop_found",
            Self::LoopConfirmed => "loop_confirmed",
            Self::LoopRevoked => "loop_revoked",
        }
    }

    /// The kind of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.as_str() == name)
    }
}

/// One event. It is flat, so that a reader in any language needs one struct; what a kind does
/// not speak of is empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    /// Its number in its map, growing by one; the id of the server-sent event.
    pub seq: u64,
    /// What happened.
    pub kind: EventKind,
    /// The map's version in which it happened.
    pub map_version: u64,
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
    /// The description, or one sentence for a person.
    pub detail: Option<String>,
}

impl Event {
    /// An event of which nothing is known but its kind; its number and version come when it is kept.
    pub fn of(kind: EventKind) -> Self {
        Self {
            seq: 0,
            kind,
            map_version: 0,
            anchor: None,
            other: None,
            keyframe: None,
            candidate: None,
            loop_id: None,
            query: None,
            detail: None,
        }
    }
}
