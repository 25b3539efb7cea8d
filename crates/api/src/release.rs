//! Release: a named version of a map that stays as it is (`openapi/openapi.yaml`).

use revisit_core::domain::release::{AnchorChange, Counted, NewRelease, Release, ReleaseChanges, ReleaseUse};
use revisit_shapes::{answer, body};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::space::{Time, rounded};

/// A release to be published.
#[body(NewRelease)]
#[derive(Default)]
pub struct ReleaseBody {
    /// Free text for people.
    #[schema(max_length = 4096)]
    pub description: Option<String>,
    /// The version that the map must have, if it matters: another one is a conflict.
    #[schema(minimum = 1)]
    pub map_version: Option<u64>,
}

/// A release.
#[answer(of = Release)]
#[schema(as = Release)]
pub struct ReleaseView {
    /// Its name.
    pub name: String,
    /// Free text for people.
    pub description: String,
    /// The map's version that it holds.
    #[from(of.version)]
    pub map_version: u64,
    /// When it was published.
    pub published: Time,
    /// Number of its keyframes.
    #[from(of.figures.keyframes)]
    pub keyframes: u64,
    /// Number of its anchors, merged ones counted once.
    #[from(of.figures.anchors)]
    pub anchors: u64,
    /// Number of its sessions.
    #[from(of.figures.sessions)]
    pub sessions: u64,
    /// Number of its confirmed loops.
    #[from(of.figures.loops)]
    pub loops: u64,
    /// Size of its facts on disk, in bytes: a release takes as much room as the map did.
    #[from(of.figures.bytes)]
    pub bytes: u64,
    /// How often something was erased from it for good. Else nothing changes it.
    pub erasures: u64,
    /// The robots whose loop queries it answered, the latest first. Written behind: a crash may lose the last few.
    #[schema(max_items = 1000)]
    #[from(of.uses)]
    pub asked_by: Vec<ReleaseUseView>,
}

/// A robot that asked a release.
#[answer(of = ReleaseUse)]
#[schema(as = ReleaseUse)]
pub struct ReleaseUseView {
    /// The session of the keyframes that it asked about.
    pub session: String,
    /// Number of its queries.
    pub queries: u64,
    /// When it asked last.
    pub last: Time,
}

/// The changes of a map from a release on. Each list has at most `limit` items; the numbers are of all.
#[answer]
#[schema(as = ReleaseChanges)]
pub struct ReleaseChangesView {
    /// The version of the release.
    pub since_version: u64,
    /// The version that it is compared with.
    pub until_version: u64,
    /// Number of keyframes that were added.
    pub keyframes_added: usize,
    /// Number of keyframes that were removed.
    pub keyframes_removed: usize,
    /// Number of keyframes that have another pose.
    pub keyframes_moved: usize,
    /// Number of anchors that were added.
    pub anchors_added: usize,
    /// Number of anchors that were removed; one that merged into another was not.
    pub anchors_removed: usize,
    /// Number of anchors that have another description.
    pub anchors_described: usize,
    /// Number of signs that hang there no longer.
    pub anchors_retired: usize,
    /// Number of signs that hang there again.
    pub anchors_returned: usize,
    /// The keyframes concerned.
    pub keyframes: Vec<KeyframeChangeView>,
    /// The anchors concerned; one may be listed for two changes.
    pub anchors: Vec<AnchorChangeView>,
}

/// A keyframe that changed.
#[answer]
#[schema(as = KeyframeChange)]
pub struct KeyframeChangeView {
    /// The change.
    pub change: KeyframeChangeName,
    /// The keyframe.
    pub keyframe: String,
    /// How far it moved, in metres; left out where it did not.
    pub moved_m: Option<f64>,
}

/// A change of a keyframe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = KeyframeChangeKind)]
pub enum KeyframeChangeName {
    /// It is new.
    Added,
    /// It is gone.
    Removed,
    /// It has another pose.
    Moved,
}

/// An anchor that changed.
#[answer]
#[schema(as = AnchorChange)]
pub struct AnchorChangeView {
    /// The change.
    pub change: AnchorChangeName,
    /// The anchor.
    pub anchor: String,
    /// Its class.
    pub class: String,
    /// Its description in the release; left out where it has none.
    pub before: Option<String>,
    /// Its description in the later version; left out where it has none.
    pub after: Option<String>,
}

/// A change of an anchor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = AnchorChangeKind)]
pub enum AnchorChangeName {
    /// It is new.
    Added,
    /// It is gone.
    Removed,
    /// It has another description.
    Described,
    /// The sign hangs there no longer.
    Retired,
    /// The sign hangs there again.
    Returned,
}

impl From<ReleaseBody> for NewRelease {
    fn from(ReleaseBody { description, map_version }: ReleaseBody) -> Self {
        Self { description: description.unwrap_or_default(), version: map_version }
    }
}

impl ReleaseChangesView {
    /// Returns the changes between two versions.
    pub fn of(since_version: u64, until_version: u64, changes: ReleaseChanges) -> Self {
        let plain = |change, of: Counted<_>| {
            of.first.into_iter().map(move |keyframe: revisit_core::domain::ids::KeyframeId| {
                KeyframeChangeView { change, keyframe: keyframe.to_string(), moved_m: None }
            })
        };
        let anchor = |change, of: Counted<AnchorChange>| {
            of.first.into_iter().map(move |of| AnchorChangeView {
                change,
                anchor: of.anchor.public(),
                class: of.class,
                before: of.before,
                after: of.after,
            })
        };
        let [added, removed] = [changes.keyframes_added.count, changes.keyframes_removed.count];
        let moved = changes.keyframes_moved;
        Self {
            since_version,
            until_version,
            keyframes_added: added,
            keyframes_removed: removed,
            keyframes_moved: moved.count,
            anchors_added: changes.anchors_added.count,
            anchors_removed: changes.anchors_removed.count,
            anchors_described: changes.anchors_described.count,
            anchors_retired: changes.anchors_retired.count,
            anchors_returned: changes.anchors_returned.count,
            keyframes: plain(KeyframeChangeName::Added, changes.keyframes_added)
                .chain(plain(KeyframeChangeName::Removed, changes.keyframes_removed))
                .chain(moved.first.into_iter().map(|(keyframe, moved_m)| KeyframeChangeView {
                    change: KeyframeChangeName::Moved,
                    keyframe: keyframe.to_string(),
                    moved_m: Some(rounded(moved_m)),
                }))
                .collect(),
            anchors: anchor(AnchorChangeName::Added, changes.anchors_added)
                .chain(anchor(AnchorChangeName::Removed, changes.anchors_removed))
                .chain(anchor(AnchorChangeName::Described, changes.anchors_described))
                .chain(anchor(AnchorChangeName::Retired, changes.anchors_retired))
                .chain(anchor(AnchorChangeName::Returned, changes.anchors_returned))
                .collect(),
        }
    }
}
