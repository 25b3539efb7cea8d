//! Knowledge of a map about signs that change: those that passages missed, and those that are retired (M18).

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use super::{MapIndex, MergedAnchor};
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

impl MapIndex {
    /// Returns the facts about signs that change.
    pub fn changed_signs(&self) -> &ChangedSigns {
        &self.changed_signs
    }

    /// Returns the passages that missed an object since it was last seen.
    pub fn misses_of(&self, object: &MergedAnchor) -> impl Iterator<Item = MissedSign> {
        let missed = &self.changed_signs.missed;
        object.members.iter().flat_map(|anchor| {
            missed.range(all_of(*anchor)).map(|((anchor, keyframe), other)| MissedSign {
                anchor: *anchor,
                keyframe: *keyframe,
                other: *other,
            })
        })
    }

    /// Returns what hangs in the place of a retired object, by its oldest anchor, if anything that is still in the map does.
    pub fn replacement_of(&self, object: &MergedAnchor) -> Option<AnchorSeq> {
        let replaced =
            object.members.iter().rev().find_map(|member| *self.changed_signs.retired.get(member)?);
        self.objects.root(replaced?)
    }
}

fn all_of(anchor: AnchorSeq) -> RangeInclusive<(AnchorSeq, KeyframeSeq)> {
    (anchor, KeyframeSeq(0))..=(anchor, KeyframeSeq(u32::MAX))
}
