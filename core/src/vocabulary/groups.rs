//! Features grouped by a node of the vocabulary: only features of one group are compared when two keyframes are matched.

/// Groups of features; nodes ascend, and so do the features of each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FeatureGroups {
    /// Each node, and where its features end.
    groups: Vec<(u32, u32)>,
    features: Vec<u32>,
}

impl FeatureGroups {
    /// Groups `(node, feature)` pairs, ascending.
    pub(super) fn of_sorted(pairs: impl ExactSizeIterator<Item = (u32, u32)>) -> Self {
        let mut groups: Vec<(u32, u32)> = Vec::new();
        let mut features = Vec::with_capacity(pairs.len());
        for (node, feature) in pairs {
            features.push(feature);
            let end = features.len() as u32;
            match groups.last_mut() {
                Some(last) if last.0 == node => last.1 = end,
                _ => groups.push((node, end)),
            }
        }
        Self { groups, features }
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
