//! A sign to look for: what would tell one of several places from the others.

use crate::geometry::Point3;

/// A sign that would tell one of several places from the others.
#[derive(Clone, Debug, PartialEq)]
pub struct LookFor {
    /// The place near which it hangs, by its number in an answer to "where am I?", or among the candidates of a loop query.
    pub place: usize,
    /// The sign.
    pub sign: NearbySign,
}

/// A sign near a keyframe that bears an identifier and hangs in one place only.
#[derive(Clone, Debug, PartialEq)]
pub struct NearbySign {
    /// Its class.
    pub class: String,
    /// Its description.
    pub description: String,
    /// Its centre in the session's frame, in metres.
    pub position: Point3,
}
