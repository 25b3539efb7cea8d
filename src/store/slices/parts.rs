//! Parts: packed lists of changes, or of the values that they replaced, each of a size that one slice writes.

use crate::domain::change::Change;
use crate::store::StoreError;

/// Bytes of one part.
const PART_BYTES: usize = 128 << 10;

/// The kind of a part's entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::store) enum Kind {
    Poses,
    Points,
    Forgotten,
    Positions,
    Touched,
    FormerPoses,
    FormerPoints,
    FormerForgotten,
    FormerPositions,
}

impl Kind {
    pub(in crate::store) const ALL: [Self; 9] = [
        Self::Poses,
        Self::Points,
        Self::Forgotten,
        Self::Positions,
        Self::Touched,
        Self::FormerPoses,
        Self::FormerPoints,
        Self::FormerForgotten,
        Self::FormerPositions,
    ];

    pub(in crate::store) fn as_str(self) -> &'static str {
        match self {
            Self::Poses => "poses",
            Self::Points => "points",
            Self::Forgotten => "forgotten",
            Self::Positions => "positions",
            Self::Touched => "touched",
            Self::FormerPoses => "former_poses",
            Self::FormerPoints => "former_points",
            Self::FormerForgotten => "former_forgotten",
            Self::FormerPositions => "former_positions",
        }
    }

    pub(in crate::store) fn from_name(name: &str) -> Result<Self, StoreError> {
        let kind = Self::ALL.into_iter().find(|kind| kind.as_str() == name);
        kind.ok_or_else(|| StoreError::corrupt(format!("deferred {name}")))
    }

    /// Bytes of one entry.
    pub(in crate::store) fn width(self) -> usize {
        const NUMBER: usize = size_of::<u32>();
        const WIDE: usize = size_of::<i64>();
        match self {
            Self::Poses | Self::FormerPoses => NUMBER + 7 * WIDE,
            Self::Points | Self::FormerPoints | Self::FormerForgotten => NUMBER + WIDE + 3 * WIDE,
            Self::Forgotten | Self::Touched => NUMBER + WIDE,
            Self::Positions => 3 * NUMBER + 3 * WIDE,
            Self::FormerPositions => 2 * NUMBER + 3 * WIDE,
        }
    }

    /// Whether it is history: moved to `former_values` as it stands, and applied to nothing.
    pub(in crate::store) fn is_former(self) -> bool {
        matches!(self, Self::FormerPoses | Self::FormerPoints | Self::FormerForgotten | Self::FormerPositions)
    }

    /// Returns the kind of a change that may be deferred.
    pub(in crate::store) fn of(change: &Change) -> Option<Self> {
        match change {
            Change::PoseSet(..) => Some(Self::Poses),
            Change::PointSet(..) => Some(Self::Points),
            Change::PointsForgotten(..) => Some(Self::Forgotten),
            Change::PositionSet(..) => Some(Self::Positions),
            Change::AnchorTouched(..) => Some(Self::Touched),
            _ => None,
        }
    }
}

/// A packed list of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    pub(in crate::store) kind: Kind,
    pub(in crate::store) entries: Vec<u8>,
}

/// Cuts a packed list into parts.
pub(in crate::store) fn cut(kind: Kind, entries: &[u8]) -> impl Iterator<Item = Part> {
    let whole = PART_BYTES / kind.width() * kind.width();
    entries.chunks(whole).map(move |chunk| Part { kind, entries: chunk.to_vec() })
}
