//! A sign to look for: what would tell one of several places from the others.

use crate::geometry::Point3;

/// A sign that would tell one of several places from the others.
#[derive(Clone, Debug, PartialEq)]
pub struct LookFor {
    /// The place near which it hangs, by its number in an answer to "where am I?", or among the candidates of a loop query.
    pub place: usize,
    /// Its class.
    pub class: String,
    /// Its description.
    pub description: String,
    /// Its position in the place's session, in metres.
    pub position: Point3,
}
