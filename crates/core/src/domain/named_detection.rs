//! A detection by name, for operations that are recorded.

use super::ids::KeyframeId;

/// A detection by the name of its keyframe. It stands for the anchor that it feeds, whose id is the server's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedDetection {
    /// The keyframe.
    pub keyframe: KeyframeId,
    /// The number of the detection in it, from 0.
    pub number: u16,
}
