//! Objects that changes have touched, which are derived anew.

use std::collections::BTreeSet;

use super::parsed_readings::ParsedReadings;
use crate::domain::ids::{AnchorSeq, KeyframeSeq};

/// Objects that a batch of changes has touched, and the texts that it met.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Touched {
    /// Anchors of which the objects must be derived anew.
    pub(super) anchors: BTreeSet<AnchorSeq>,
    /// Keyframes whose pose was corrected: anchors that they saw at a position of their own move with them.
    pub(super) moved: BTreeSet<KeyframeSeq>,
    /// Anchors that lost something, or of which a point moved: their own shape and votes are stale.
    pub(super) stale: BTreeSet<AnchorSeq>,
    /// Every object: a setting that decides about all of them changed.
    pub(super) all: bool,
    /// The rules of the numbering: every text is to be parsed anew.
    pub(super) rules: bool,
    /// Not touched, but met: the texts that were parsed for the batch.
    pub(super) parsed: ParsedReadings,
}
