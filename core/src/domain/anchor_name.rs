//! The name of an anchor in a verdict.

/// The local anchor map whose anchors an entry names.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AnchorName {
    /// An anchor of the map, by its public id.
    Stored(String),
    /// The n-th detection of an inline keyframe, which founds no anchor because nothing is stored.
    Inline(usize),
}

impl AnchorName {
    /// Returns the name as the API writes it: `a-7`, or `inline-0`.
    pub fn to_text(&self) -> String {
        match self {
            Self::Stored(id) => id.clone(),
            Self::Inline(index) => format!("inline-{index}"),
        }
    }
}
