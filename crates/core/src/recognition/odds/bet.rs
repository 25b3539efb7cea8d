//! The bet on one candidate: what is known of it before geometry looks at it.

use super::names::Names;
use crate::domain::look_for::NearbySign;
use crate::domain::settings::{Settings, WithoutAnchors};
use crate::domain::verdict::{AnchorName, ReasonCode};
use crate::recognition::extensions::tracked_path::TrackedPath;

/// A pair of texts without names at the same relative place.
#[derive(Clone, Debug)]
pub struct TextPair {
    /// The query's anchor.
    pub query: AnchorName,
    /// The candidate's.
    pub candidate: AnchorName,
    /// The text, for people.
    pub text: String,
    /// Whether it is a description that says enough and hangs in one place.
    pub is_description: bool,
}

/// The lengths around a query and a candidate that are metres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Metres {
    /// None: the map has no unit.
    None,
    /// Those of transformations. The poses of one drive only turn, so that its signs tell none.
    OfViews,
    /// Those between signs as well.
    OfSigns,
}

/// The knowledge of a candidate before geometry looks at it.
#[derive(Clone, Debug)]
pub struct Bet {
    /// Names around the two.
    pub names: Names,
    /// Other texts that agree, and were not tracked from one to the other.
    pub texts: Vec<TextPair>,
    /// Signs of the query's local anchor map that nobody read around the candidate.
    pub absent: Vec<AnchorName>,
    /// The unbroken way between the two, and how far apart odometry has them, in metres.
    pub path: Option<(TrackedPath, f64)>,
    /// Whether the query's session has the two at one place.
    pub is_here: bool,
    /// The lengths that are metres.
    pub metres: Metres,
    /// Whether all that agrees was tracked from one to the other in this same passage.
    pub is_tracked_only: bool,
    /// Crops around the two that nobody has read yet, and that a model will.
    pub unread: usize,
    /// Anchors around the two that nothing has described yet, where they may be one; else 0.
    pub pending: usize,
    /// Signs around the candidate with names that hang in one place and that the query has not read, the nearest first.
    pub nearby: Vec<NearbySign>,
    /// The reason why descriptions are missing.
    pub missing: ReasonCode,
}

impl Bet {
    /// Whether geometry could make it a loop: with names that are alike; or where nothing repeats, with other texts or if the map's
    /// settings leave it to geometry.
    pub fn may_win(&self, settings: &Settings) -> bool {
        let names = self.names.alike.iter().filter(|pair| pair.places == 1).count();
        let by_view = settings.without_anchors == WithoutAnchors::Geometry || !self.texts.is_empty();
        names > 0 || (!settings.building_repeats && by_view)
    }
}
