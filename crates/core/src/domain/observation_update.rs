//! Changes that a client's map made to the points and edges of keyframes that it had sent (M57).

use serde::{Deserialize, Serialize};

use super::ids::{KeyframeId, KeyframeSeq, PointId, SessionId, SessionSeq};
use super::point_list::PointList;

/// The map points that a keyframe's features were sent with and that are others now.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Renamed {
    /// Ascending, each with the present one.
    pub pairs: Box<[(PointId, PointId)]>,
    /// Whether a feature sent with a point that is not listed observes none. Otherwise that point is the one it was sent as.
    /// Complete after a merge of sessions gave the points other numbers, for a new number may be an old one of another point.
    pub is_complete: bool,
}

/// The covisible keyframes that a client declared, each with its number of shared points. An empty list says that there are none,
/// `None` that the client does not know: its neighbours along the drive stand in for them (M62).
pub type Declared = Option<Box<[(KeyframeSeq, u32)]>>;

/// Changes that a client's map made to the points and edges of keyframes that it had sent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ObservationUpdate<S = SessionSeq, K = KeyframeSeq> {
    /// The session whose numbers the map points have.
    pub session: S,
    /// Map points that were fused into others, each with the one that stays; no point is fused twice, and none into itself,
    /// by whatever way.
    pub replaced: Vec<(PointId, PointId)>,
    /// Map points that were culled, none of them fused.
    pub removed: Vec<PointId>,
    /// Keyframes of the session of which the client says more, none twice.
    pub keyframes: Vec<KeyframeUpdate<K>>,
}

/// The same as the client sent it, by name.
pub type ChangedObservations = ObservationUpdate<SessionId, KeyframeId>;

/// The map points and covisible keyframes of a keyframe, as the client's map has them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyframeUpdate<K = KeyframeSeq> {
    /// The keyframe.
    pub keyframe: K,
    /// All map points that it observes, ascending; `None` where the client does not say.
    pub observes: Option<Vec<PointId>>,
    /// Covisible keyframes that are declared besides those declared before, or with another number of shared points.
    pub covisible: Vec<(K, u32)>,
}

/// The same as the client sent it, by name.
pub type ChangedKeyframe = KeyframeUpdate<KeyframeId>;

/// The map points that a keyframe observes from now on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointsOfKeyframe {
    /// The keyframe.
    pub keyframe: KeyframeSeq,
    /// As `Keyframe::observes`.
    pub observes: PointList,
    /// As `Keyframe::declared`.
    pub declared: Declared,
    /// As `Keyframe::renamed`.
    pub renamed: Renamed,
    /// As `Keyframe::bytes`.
    pub bytes: u64,
}
