//! Releases: named versions of a map that stay as they are, for robots to ask while the map goes on changing.

use super::ids::{AnchorSeq, KeyframeId, MapId, ReleaseName, SessionId};
use super::keyframe::Stamp;
use super::map::MapFigures;

/// A release to be published.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NewRelease {
    /// Free text for people.
    pub description: String,
    /// The version that the map must have; any if none is given.
    pub version: Option<u64>,
}

/// A release that was published.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Release {
    /// The name.
    pub name: ReleaseName,
    /// Free text for people.
    pub description: String,
    /// The map's version that it holds.
    pub version: u64,
    /// When it was published.
    pub published: Stamp,
    /// The size of its contents.
    pub figures: MapFigures,
    /// Number of its erasures: each took keyframes out of it for good.
    pub erasures: u64,
    /// The robots that asked it, the latest first.
    pub uses: Vec<ReleaseUse>,
}

/// A robot that asked a release.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReleaseUse {
    /// The session of the keyframes that it asked about.
    pub session: SessionId,
    /// Number of its queries.
    pub queries: u64,
    /// When it asked last.
    pub last: Stamp,
}

/// The map that a new one begins as: a release, or a map as it stands.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct MapBase {
    /// The map.
    pub map: MapId,
    /// Its release; the map as it stands if none is given.
    pub release: Option<ReleaseName>,
}

impl MapBase {
    /// Returns the id of the map whose rows are copied.
    pub fn id(&self) -> MapId {
        self.release.as_ref().map_or_else(|| self.map.clone(), |name| self.map.of_release(name))
    }
}

/// The differences between two versions of a map. Each list has the first of them; the counts are of all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReleaseChanges {
    /// Keyframes that are in the later version only.
    pub keyframes_added: Counted<KeyframeId>,
    /// Keyframes that are in the earlier version only.
    pub keyframes_removed: Counted<KeyframeId>,
    /// Keyframes with another pose, and the distance of their positions in metres.
    pub keyframes_moved: Counted<(KeyframeId, f64)>,
    /// Anchors that are in the later version only.
    pub anchors_added: Counted<AnchorChange>,
    /// Anchors that are in the earlier version only; merged ones are counted as the one they merged into.
    pub anchors_removed: Counted<AnchorChange>,
    /// Anchors with another description.
    pub anchors_described: Counted<AnchorChange>,
    /// Anchors that hang there no longer.
    pub anchors_retired: Counted<AnchorChange>,
    /// Anchors that hang there again.
    pub anchors_returned: Counted<AnchorChange>,
}

/// A list that is cut off, and how many there are.
#[derive(Clone, Debug, PartialEq)]
pub struct Counted<T> {
    /// Number of all.
    pub count: usize,
    /// The first of them.
    pub first: Vec<T>,
}

impl<T> Default for Counted<T> {
    fn default() -> Self {
        Self { count: 0, first: Vec::new() }
    }
}

impl<T> Counted<T> {
    /// Counts one more, and lists it unless there are `limit` already.
    pub fn add(&mut self, limit: usize, item: T) {
        self.count += 1;
        if self.first.len() < limit {
            self.first.push(item);
        }
    }
}

/// An anchor in two versions of a map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AnchorChange {
    /// The anchor, whose number is the same in both.
    pub anchor: AnchorSeq,
    /// Its class.
    pub class: String,
    /// Its description in the earlier version, if it has one there.
    pub before: Option<String>,
    /// Its description in the later version, if it has one there.
    pub after: Option<String>,
}
