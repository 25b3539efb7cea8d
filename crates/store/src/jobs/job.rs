//! What the writer is asked to do, in pieces that hold or fall as a whole.

use std::sync::Arc;

use revisit_core::domain::change::Change;
use revisit_core::domain::erasure::NewErasure;
use revisit_core::domain::event::Event;
use revisit_core::domain::fleet_frames::FleetFrames;
use revisit_core::domain::former::FormerValues;
use revisit_core::domain::ids::{AnchorSeq, JudgementId, KeyframeSeq, MapId, ReleaseName, SessionId};
use revisit_core::domain::judgement::Judgement;
use revisit_core::domain::key::{Key, KeySeq, SecretHash};
use revisit_core::domain::keyframe::{NewKeyframe, Stamp};
use revisit_core::domain::map::{Learned, MapFigures, MapProperties};
use revisit_core::domain::release::ReleaseUse;
use revisit_core::domain::request::Digest;
use revisit_core::domain::verdict_line::VerdictLine;

use crate::jobs::row_block::RowBlock;
use crate::log::parts::Part;
use crate::map_key::MapKey;

/// What one request changes in one map: committed as a whole.
#[derive(Debug)]
pub struct Batch {
    /// The map.
    pub map: MapKey,
    /// The map's version after it.
    pub version: u64,
    /// The dense numbers given next after it.
    pub next_keyframe: KeyframeSeq,
    /// The dense numbers given next after it.
    pub next_anchor: AnchorSeq,
    /// The number of the next event after it.
    pub next_event: u64,
    /// How much the map holds after it.
    pub figures: MapFigures,
    /// The map's knowledge of its building after it.
    pub learned: Learned,
    /// What the map's index takes in memory after it, in bytes.
    pub memory_bytes: u64,
    /// The changes, in their order.
    pub changes: Vec<Change>,
    /// The values that they replaced.
    pub former: FormerValues,
    /// The heavy parts of the keyframe that arrived, if one did.
    pub new_keyframe: Option<NewKeyframeRows>,
    /// What happened, numbered.
    pub events: Vec<Event>,
    /// Whether another server follows the map, and is told the changes.
    pub is_followed: bool,
}

/// The parts of a new keyframe that the index does not keep.
#[derive(Debug)]
pub struct NewKeyframeRows {
    /// The keyframe as sent.
    pub keyframe: Arc<NewKeyframe>,
    /// The digest that tells a retry of it from another keyframe.
    pub digest: Digest,
}

/// A key to be stored. Its number is the caller's guess of the next one; if another process took it meanwhile, the job fails.
#[derive(Clone, Debug, PartialEq)]
pub struct NewKeyRow {
    /// The key.
    pub key: Key,
    /// The hash of its secret.
    pub hash: SecretHash,
}

/// Calls of one model for one operation, on one day. A negative cost gives back what was reserved and not used.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spent {
    /// Days since 1970, UTC.
    pub day: i64,
    /// The question.
    pub operation: &'static str,
    /// The model that answered.
    pub model: Arc<str>,
    /// Calls.
    pub calls: i64,
    /// Tokens sent.
    pub input_tokens: i64,
    /// Tokens received.
    pub output_tokens: i64,
    /// Millionths of a US dollar.
    pub cost_microusd: i64,
    /// Questions answered without a call.
    pub cache_hits: i64,
    /// The key at whose expense.
    pub key: Option<KeySeq>,
}

/// A step of an erasure.
#[derive(Clone, Debug, PartialEq)]
pub enum ErasureStep {
    /// It is asked for, at this time.
    Begin(NewErasure, Stamp),
    /// So many keyframes are to be removed from the map, and some from these releases of it. Written once, before the first of
    /// them is.
    Count(u64, Vec<MapKey>),
    /// Nothing in this map, or this release of it, names what is gone any more.
    RemoveTraces(MapKey, Vec<SessionId>),
    /// All is removed.
    Removed,
    /// The file was rewritten, at this time.
    Done(Stamp),
}

/// The name and kind that a complete copy of a map gets.
#[derive(Clone, Debug, PartialEq)]
pub enum CopiedAs {
    /// A release of the map that was copied.
    Release {
        /// The map.
        map: MapKey,
        /// Its name.
        of: MapId,
        /// The release's name.
        name: ReleaseName,
        /// The version that it holds.
        version: u64,
        /// Free text for people.
        description: String,
        /// When it was published.
        published: Stamp,
        /// The digest of the request.
        digest: Digest,
    },
    /// A map of its own.
    Map {
        /// Its name.
        id: MapId,
        /// Its properties.
        properties: Box<MapProperties>,
        /// Its first version, which sets the properties.
        version: u64,
        /// The digest of the body that made it.
        digest: Digest,
        /// The key that made it.
        owner: Option<KeySeq>,
    },
    /// The map that it was in another database.
    Itself {
        /// Its name.
        id: MapId,
    },
}

/// What the writer is asked to do in one piece.
#[derive(Debug)]
pub enum Job {
    /// A new map.
    CreateMap {
        /// Its name.
        id: MapId,
        /// Its properties.
        properties: Box<MapProperties>,
        /// The digest of the body that made it.
        digest: Digest,
        /// The key that made it.
        owner: Option<KeySeq>,
    },
    /// A map is deleted; its rows are removed in slices.
    DeleteMap(MapKey),
    /// A copy of a map begins: its row, under an id by which no client finds it.
    BeginCopy {
        /// The row.
        row: Box<RowBlock>,
        /// The id.
        id: String,
    },
    /// A copy that gets no name is thrown away; its rows are removed in slices.
    DiscardCopy(MapKey),
    /// Rows of a copy.
    CopyRows {
        /// The copy.
        map: MapKey,
        /// The rows.
        block: Box<RowBlock>,
    },
    /// A copy has all of its rows, and gets its name.
    FinishCopy {
        /// The copy.
        map: MapKey,
        /// Its name.
        copied_as: Box<CopiedAs>,
    },
    /// Rows of a table beside maps, from another database; those that are there stay.
    AddRows(Box<RowBlock>),
    /// A map from another database holds a release of another one.
    AddRelease {
        /// The map, and the one that holds its release.
        maps: (MapKey, MapKey),
        /// The rest of its row.
        row: Box<RowBlock>,
    },
    /// Events of new maps are numbered from above this number.
    RaiseLastEvent(i64),
    /// The record of what models said of a map goes, beside what is in force.
    ForgetDialogues(MapKey),
    /// A step of an erasure of this number in its map.
    Erase(MapKey, u64, ErasureStep),
    /// Queries that a release answered.
    CountUses {
        /// The map that holds its rows.
        release: MapKey,
        /// The robots that asked.
        uses: Vec<ReleaseUse>,
    },
    /// A request's changes.
    Change(Box<Batch>),
    /// A part of a request's changes, which counts for nothing until the last of them is committed.
    Stage {
        /// The map.
        map: MapKey,
        /// The version that the request makes.
        version: u64,
        /// The part's number.
        number: i64,
        /// The part.
        part: Part<'static>,
        /// Whether the request takes something away.
        frees_space: bool,
    },
    /// A request's changes, of which the poses and points are staged.
    ChangeStaged {
        /// The changes that are not staged.
        batch: Box<Batch>,
        /// Whether the request takes something away.
        frees_space: bool,
    },
    /// The frames of a map's sessions, at a version.
    KeepFrames {
        /// The map.
        map: MapKey,
        /// The version.
        version: u64,
        /// The frames.
        frames: Arc<FleetFrames>,
    },
    /// Events that belong to no change.
    AppendEvents(MapKey, u64, Vec<Event>),
    /// A loop query's verdict is kept for reading back.
    KeepQuery {
        /// The map.
        map: MapKey,
        /// The query's id.
        id: String,
        /// Its number in the map, by age.
        kept: i64,
        /// The line that a list shows of it.
        line: VerdictLine,
        /// The answer, as sent.
        body: bytes::Bytes,
    },
    /// A model's answer is kept by the hash of all that it depends on.
    KeepAnswer {
        /// The hash.
        key: [u8; 32],
        /// The question.
        operation: &'static str,
        /// The model that answered.
        model: Arc<str>,
        /// The answer, as received.
        answer: Arc<str>,
        /// The erasures when it was asked for: after another one it is not kept.
        erasures: i64,
    },
    /// A job asks a map's verdicts again.
    StartJudgement(MapKey, Box<Judgement>),
    /// Such a job is stopped, if it is still running.
    StopJudgement(MapKey, JudgementId),
    /// No map waits for a model any more; those that did have another version now.
    ForgetAway,
    /// Calls of models, and what they cost or may cost.
    Spend(Spent),
    /// A new API key.
    CreateKey(Box<NewKeyRow>),
    /// An API key is good no longer, from this second on.
    RevokeKey(KeySeq, i64),
}

impl CopiedAs {
    /// Returns the map that a server must own to give a copy this name.
    fn fenced_map(&self) -> Option<MapKey> {
        match self {
            Self::Release { map, .. } => Some(*map),
            Self::Map { .. } | Self::Itself { .. } => None,
        }
    }
}

impl Job {
    /// Whether it leaves more room than it found. It is tried on a full disk, too.
    pub(crate) fn frees_space(&self) -> bool {
        match self {
            // A key must be revocable whatever the disk holds, and takes no space.
            Self::DeleteMap(_) | Self::RevokeKey(..) | Self::Erase(..) => true,
            Self::Change(batch) => Self::batch_frees_space(batch),
            Self::Stage { frees_space, .. } | Self::ChangeStaged { frees_space, .. } => *frees_space,
            _ => false,
        }
    }

    /// Returns the map that a server must own for it. A copy is no map yet: only the server that makes it knows it.
    pub(crate) fn fenced_map(&self) -> Option<MapKey> {
        match self {
            Self::Change(batch) | Self::ChangeStaged { batch, .. } => Some(batch.map),
            Self::DeleteMap(map)
            | Self::ForgetDialogues(map)
            | Self::Erase(map, ..)
            | Self::CountUses { release: map, .. }
            | Self::Stage { map, .. }
            | Self::KeepFrames { map, .. }
            | Self::AppendEvents(map, ..)
            | Self::KeepQuery { map, .. }
            | Self::StartJudgement(map, _)
            | Self::StopJudgement(map, _) => Some(*map),
            Self::FinishCopy { copied_as, .. } => copied_as.fenced_map(),
            Self::CreateMap { .. }
            | Self::DiscardCopy(_)
            | Self::BeginCopy { .. }
            | Self::CopyRows { .. }
            | Self::AddRows(_)
            | Self::AddRelease { .. }
            | Self::RaiseLastEvent(_)
            | Self::KeepAnswer { .. }
            | Self::ForgetAway
            | Self::Spend(_)
            | Self::CreateKey(_)
            | Self::RevokeKey(..) => None,
        }
    }

    /// Whether a batch leaves more room than it found.
    pub(crate) fn batch_frees_space(batch: &Batch) -> bool {
        batch.new_keyframe.is_none() && frees_space(&batch.changes)
    }

    /// Whether it leaves work that is done in slices.
    pub(crate) fn leaves_slices(&self) -> bool {
        matches!(
            self,
            Self::DeleteMap(_) | Self::DiscardCopy(_) | Self::ChangeStaged { .. } | Self::FinishCopy { .. }
        )
    }

    /// Whether later jobs of its map rest on it. A verdict that is not kept, or an event not told, is missed by none of them.
    pub(crate) fn is_planned_upon(&self) -> bool {
        !matches!(self, Self::KeepQuery { .. } | Self::AppendEvents(..) | Self::CountUses { .. })
    }
}

/// Whether these changes take something away.
fn frees_space(changes: &[Change]) -> bool {
    let takes_away = |change: &Change| {
        matches!(
            change,
            Change::KeyframeRemoved(..)
                | Change::AnchorRemoved(_)
                | Change::LoopRemoved(_)
                | Change::PartsForgotten(_)
        )
    };
    changes.iter().any(takes_away)
}
