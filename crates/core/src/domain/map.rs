//! A map: what one building's robots share.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::ids::{AnchorSeq, KeyframeId};
use super::settings::Settings;
use crate::geometry::Gravity;

/// The properties of a map, as its client gives them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MapProperties {
    /// Free text for people.
    pub description: String,
    /// Whether its lengths are metres. If so, the scale between two sessions is 1.
    pub metric: bool,
    /// The classes of which anchors are made, sorted; empty means every class.
    pub anchor_classes: Vec<String>,
    /// The classes whose texts are codes, compared exactly, sorted.
    pub code_classes: Vec<String>,
    /// Gravity in the frame of each of its sessions, if they have it in common.
    pub gravity: Option<Gravity>,
    /// Every threshold of the method.
    pub settings: Settings,
}

/// The size of a map's contents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MapFigures {
    /// Keyframes.
    pub keyframes: u64,
    /// Anchors, merged ones counted once.
    pub anchors: u64,
    /// Sessions that have written to it.
    pub sessions: u64,
    /// Confirmed loops.
    pub loops: u64,
    /// Size of its facts on disk, in bytes.
    pub bytes: u64,
}

impl MapProperties {
    /// Whether detections of this class are semantic anchors here (§III: predefined categories).
    pub fn anchors_class(&self, class: &str) -> bool {
        self.anchor_classes.is_empty() || self.anchor_classes.iter().any(|c| c == class)
    }
}

/// Knowledge of a map about its building, as its row shows it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Learned {
    /// By class, the shapes of the building's numbers ([`crate::semantics::Numbering`]); without what an operator gave.
    pub numbering: Arc<BTreeMap<Box<str>, Vec<String>>>,
    /// The views that it has twice.
    pub twins: Vec<NamedTwins>,
}

/// [`super::change::Twins`] by their names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamedTwins {
    /// The keyframe that was written last.
    pub keyframe: KeyframeId,
    /// The keyframe that it was taken for.
    pub candidate: KeyframeId,
    /// A sign around the first.
    pub anchor: AnchorSeq,
    /// The sign that hangs in its place around the second.
    pub candidate_anchor: AnchorSeq,
}
