//! When two indexes of texts are equal: what they list and how they came about does not matter.

use std::collections::BTreeMap;

use super::matches::Verdict;
use super::text_id::TextId;
use super::text_index::TextIndex;

impl TextIndex {
    /// Returns the matches of a text, by what they read.
    fn matches_by_name(&self, id: TextId) -> BTreeMap<&str, Verdict> {
        let node = self.node(id);
        let named = |other: TextId, verdict| (self.node(other).text.normalised(), verdict);
        if let Some(list) = node.matches.listed() {
            return list.iter().map(|(other, verdict)| named(*other, verdict.clone())).collect();
        }
        let others = self.partners(&node.class, &node.text).into_iter().filter(|other| *other != id);
        others.filter_map(|other| Some(named(other, self.judge(&node.text, other)?))).collect()
    }

    /// Whether a text means the same in both indexes, of which the texts and verdicts are the same.
    fn says_the_same(&self, id: TextId, other: &Self, theirs: TextId) -> bool {
        let (a, b) = (self.node(id), other.node(theirs));
        // What neither lists follows from the texts and the verdicts alone.
        let follows = a.matches.is_crowded() && b.matches.is_crowded();
        a.objects == b.objects && (follows || self.matches_by_name(id) == other.matches_by_name(theirs))
    }
}

/// Equal in what they say, not in the numbers they say it by nor in what they list.
impl PartialEq for TextIndex {
    fn eq(&self, other: &Self) -> bool {
        let counterpart = |name| other.by_text.get(name).copied();
        self.min_level == other.min_level
            && self.verdicts == other.verdicts
            && self.by_text.len() == other.by_text.len()
            && (self.by_text.iter()).all(|(name, id)| {
                counterpart(name).is_some_and(|theirs| self.says_the_same(*id, other, theirs))
            })
    }
}
