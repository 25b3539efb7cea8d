//! The name of an anchor in a verdict.

use std::fmt;

/// The local anchor map whose anchors an entry names.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AnchorName {
    /// An anchor of the map, by its public id.
    Stored(String),
    /// The n-th detection of an inline keyframe, which founds no anchor because nothing is stored.
    Inline(usize),
}

/// The name as the API writes it: `a-7`, or `inline-0`.
impl fmt::Display for AnchorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stored(id) => f.write_str(id),
            Self::Inline(index) => write!(f, "inline-{index}"),
        }
    }
}
