//! Knowledge of a map about signs that change: those that passages missed, and those that are retired (M18).

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use crate::domain::change::{Change, MissedSign};
use crate::domain::ids::{AnchorSeq, KeyframeSeq};

/// The facts about signs that change.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChangedSigns {
    /// By sign and by the keyframe that missed it, what hangs in its place.
    missed: BTreeMap<(AnchorSeq, KeyframeSeq), Option<AnchorSeq>>,
    /// Each retired anchor, with the one that hangs in its place.
    retired: BTreeMap<AnchorSeq, Option<AnchorSeq>>,
}

impl ChangedSigns {
    /// Whether an anchor is retired.
    pub fn is_retired(&self, anchor: AnchorSeq) -> bool {
        self.retired.contains_key(&anchor)
    }

    /// Returns the passages that missed one of some anchors since it was last seen.
    pub(super) fn misses_of(&self, anchors: &[AnchorSeq]) -> impl Iterator<Item = MissedSign> {
        anchors.iter().flat_map(|anchor| {
            self.missed.range(all_of(*anchor)).map(|((anchor, keyframe), other)| MissedSign {
                anchor: *anchor,
                keyframe: *keyframe,
                other: *other,
            })
        })
    }

    /// Returns the anchor that hangs in the place of the newest retired one of some anchors.
    pub(super) fn replacement_of(&self, anchors: &[AnchorSeq]) -> Option<AnchorSeq> {
        anchors.iter().rev().find_map(|anchor| *self.retired.get(anchor)?)
    }

    /// Applies a change that is about signs that change. Returns the anchor of which the state may be another one.
    pub(super) fn apply(&mut self, change: &Change) -> Option<AnchorSeq> {
        match change {
            Change::SignMissed(MissedSign { anchor, keyframe, other }) => {
                self.missed.insert((*anchor, *keyframe), *other);
                None
            }
            Change::MissesWithdrawn(anchor) => {
                self.withdraw_misses(*anchor);
                None
            }
            Change::SignRetired(anchor, other) => {
                self.retired.insert(*anchor, *other);
                Some(*anchor)
            }
            Change::SignReturned(anchor) => self.retired.remove(anchor).map(|_| *anchor),
            _ => None,
        }
    }

    fn withdraw_misses(&mut self, anchor: AnchorSeq) {
        let of_anchor: Vec<_> = self.missed.range(all_of(anchor)).map(|(key, _)| *key).collect();
        for key in of_anchor {
            self.missed.remove(&key);
        }
    }

    pub(super) fn remove_anchor(&mut self, anchor: AnchorSeq) {
        self.withdraw_misses(anchor);
        self.retired.remove(&anchor);
    }
}

fn all_of(anchor: AnchorSeq) -> RangeInclusive<(AnchorSeq, KeyframeSeq)> {
    (anchor, KeyframeSeq(0))..=(anchor, KeyframeSeq(u32::MAX))
}
