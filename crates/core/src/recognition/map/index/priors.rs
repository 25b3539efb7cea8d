//! Prior anchors of a map, by name and by the plan's frame.

use std::collections::{BTreeMap, BTreeSet};

use super::anchor::Anchor;
use super::reverse::remove_last;
use crate::domain::ids::{AnchorSeq, PriorId, SessionSeq};
use crate::domain::prior::Prior;

/// The prior anchors of a map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Priors {
    by_id: BTreeMap<PriorId, AnchorSeq>,
    by_frame: BTreeMap<SessionSeq, BTreeSet<AnchorSeq>>,
    /// On disk.
    bytes: u64,
}

impl Priors {
    pub(super) fn add(&mut self, seq: AnchorSeq, prior: &Prior) {
        if self.by_id.insert(prior.id.clone(), seq).is_none() {
            self.bytes += prior.bytes();
        }
        self.by_frame.entry(prior.frame).or_default().insert(seq);
    }

    /// Forgets an anchor that is removed, if it is a prior one.
    pub(super) fn remove(&mut self, anchor: &Anchor, seq: AnchorSeq) {
        let Some(prior) = &anchor.prior else { return };
        if self.by_id.remove(&prior.id).is_some() {
            self.bytes -= prior.bytes();
        }
        if remove_last(self.by_frame.get_mut(&prior.frame), &seq) {
            self.by_frame.remove(&prior.frame);
        }
    }

    /// Returns the anchor of this name.
    pub fn by_id(&self, id: &PriorId) -> Option<AnchorSeq> {
        self.by_id.get(id).copied()
    }

    /// Whether a session is a plan's frame: no robot may drive it.
    pub fn is_frame(&self, session: SessionSeq) -> bool {
        self.by_frame.contains_key(&session)
    }

    /// Returns the plans' frames, each with its anchors, ascending.
    pub fn frames(&self) -> impl Iterator<Item = (SessionSeq, &BTreeSet<AnchorSeq>)> {
        self.by_frame.iter().map(|(frame, anchors)| (*frame, anchors))
    }

    /// Returns the number of prior anchors.
    pub fn len(&self) -> usize {
        self.by_id.len()
    }

    /// Whether the map knows no plan.
    pub fn is_empty(&self) -> bool {
        self.by_id.is_empty()
    }

    /// Returns what they take on disk, in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}
