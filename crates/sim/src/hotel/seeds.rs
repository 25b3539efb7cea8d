//! Seeds: the random worlds for tuning, and those held out for reporting.

use std::fmt;
use std::ops::Range;

/// The worlds of `eval hotel --worlds`, for tuning and inspection.
pub const DEVELOPMENT: Range<u64> = 0..1_000;

/// The first of the worlds of `eval hotel --worlds --held-out`, for reporting only. They are never used for tuning
/// (CONTRIBUTING.md), and `eval hotel --world` does not explain them.
pub const HELD_OUT_FROM: u64 = 1_000_000;

/// Held-out worlds are taken in blocks of so many, because a block that was reported has lost its innocence.
pub const BLOCK_WORLDS: u64 = 100;

/// The last held-out block.
pub const BLOCK_MAX: u64 = 9_999;

/// The set from which an experiment takes its worlds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorldSet {
    /// Worlds for tuning and inspection.
    Development,
    /// A block of the worlds that are for reporting only.
    HeldOut(u64),
}

impl WorldSet {
    /// Returns the set of a held-out block, or the development worlds.
    pub fn of_block(block: Option<u64>) -> Self {
        block.map_or(Self::Development, Self::HeldOut)
    }

    /// Returns the seeds of its worlds.
    pub fn seeds(self) -> Range<u64> {
        match self {
            Self::Development => DEVELOPMENT,
            Self::HeldOut(block) => {
                let first = HELD_OUT_FROM + BLOCK_WORLDS * block;
                first..first + BLOCK_WORLDS
            }
        }
    }
}

impl fmt::Display for WorldSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Development => write!(f, "development worlds"),
            Self::HeldOut(block) => write!(f, "held-out worlds (block {block})"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn held_out_blocks_follow_one_another_and_hold_no_development_world() {
        assert_eq!(WorldSet::of_block(None).seeds(), 0..1_000);
        assert_eq!(WorldSet::of_block(Some(0)).seeds(), 1_000_000..1_000_100);
        assert_eq!(WorldSet::of_block(Some(1)).seeds(), 1_000_100..1_000_200);
        assert_eq!(WorldSet::of_block(Some(BLOCK_MAX)).seeds(), 1_999_900..2_000_000);
        for block in 0..BLOCK_MAX {
            assert_eq!(WorldSet::HeldOut(block).seeds().end, WorldSet::HeldOut(block + 1).seeds().start);
        }
    }
}
