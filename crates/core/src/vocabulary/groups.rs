//! Features grouped by a node of the vocabulary: only features of one group are compared when two keyframes are matched.

/// Groups of features; nodes ascend, and so do the features of each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FeatureGroups {
    /// Each node, and where its features end.
    groups: Vec<(u32, u32)>,
    features: Vec<u32>,
}

impl FeatureGroups {
    /// Groups features, each given as one number: its node in the upper half, the feature below.
    pub fn of(mut features: Vec<u64>) -> Self {
        // One comparison of integers orders both.
        features.sort_unstable();
        let mut groups: Vec<(u32, u32)> = Vec::new();
        for (end, feature) in (1..).zip(&features) {
            let node = (feature >> 32) as u32;
            match groups.last_mut() {
                Some(last) if last.0 == node => last.1 = end,
                _ => groups.push((node, end)),
            }
        }
        Self { groups, features: features.iter().map(|&feature| feature as u32).collect() }
    }

    /// `(node, its features)`; the node's number is the one DBoW2 gives it.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (u32, &[u32])> + '_ {
        let mut start = 0;
        self.groups.iter().map(move |&(node, end)| {
            let features = &self.features[start..end as usize];
            start = end as usize;
            (node, features)
        })
    }

    /// Returns the number of groups.
    pub fn len(&self) -> usize {
        self.groups.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Returns the pairs of groups that two keyframes have in common: what guided matching compares.
    pub fn common<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = (&'a [u32], &'a [u32])> {
        let mut theirs = other.iter().peekable();
        self.iter().filter_map(move |(node, ours)| {
            while theirs.next_if(|(their_node, _)| *their_node < node).is_some() {}
            let (_, theirs) = theirs.next_if(|(their_node, _)| *their_node == node)?;
            Some((ours, theirs))
        })
    }
}
