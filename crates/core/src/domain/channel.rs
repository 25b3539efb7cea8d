//! Channels: the ways in which candidates are found.

use crate::named::named;

named! {
    /// A way in which candidates are found.
    Channel {
        /// Bag of words (§V, check 2).
        Bow = "bow",
        /// An anchor seen before, on another passage (§III).
        Anchors = "anchors",
        /// Global descriptors that are alike.
        Global = "global",
    }
}

/// What proposed a candidate, where the query has a global descriptor.
#[derive(Clone, Debug, PartialEq)]
pub struct ProposedBy {
    /// The channels, each once, in the order of their names above.
    pub channels: Vec<Channel>,
    /// The cosine of its global descriptor and the query's, 0 where it is negative; none where it has no descriptor.
    pub similarity: Option<f64>,
}

impl ProposedBy {
    /// Whether the global descriptors alone did.
    pub fn is_global_alone(&self) -> bool {
        self.channels == [Channel::Global]
    }
}
