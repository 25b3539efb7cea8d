//! The sets of matching texts that a query meets, each numbered once.
//!
//! Most texts of a crowd match the same set, so a count is made once for a set and not for each of its texts.

use std::collections::HashMap;
use std::sync::Arc;

use crate::recognition::map::index::{GroupId, IdentityId, TextId, TextIndex, WordGroups};

/// The number of a set of texts within one query.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SetId(usize);

/// The sets of one query.
#[derive(Debug, Default)]
pub struct MatchSets {
    /// In ascending order each.
    sets: Vec<Arc<[TextId]>>,
    numbers: HashMap<Arc<[TextId]>, SetId>,
    by_identity: HashMap<IdentityId, SetId>,
    by_group: HashMap<GroupId, SetId>,
    /// Made when the first text with too many matches is met.
    word_groups: Option<WordGroups>,
}

impl MatchSets {
    /// Returns the texts of a set, ascending.
    pub fn texts(&self, set: SetId) -> &Arc<[TextId]> {
        &self.sets[set.0]
    }

    /// Returns the number of a set of texts.
    pub fn number(&mut self, mut texts: Vec<TextId>) -> SetId {
        texts.sort_unstable();
        texts.dedup();
        if let Some(known) = self.numbers.get(&*texts) {
            return *known;
        }
        let texts: Arc<[TextId]> = texts.into();
        let set = SetId(self.sets.len());
        self.sets.push(texts.clone());
        self.numbers.insert(texts, set);
        set
    }

    /// Returns the set of texts that match a text of the map.
    pub fn of(&mut self, texts: &TextIndex, text: TextId) -> SetId {
        let Some(identity) = texts.identity(text) else { return self.by_words(texts, text) };
        if let Some(known) = self.by_identity.get(&identity) {
            return *known;
        }
        let set = self.number(texts.matching_set(text));
        self.by_identity.insert(identity, set);
        set
    }

    /// Returns the same for a text without an identity: the set of its word group, but for exceptions.
    fn by_words(&mut self, texts: &TextIndex, text: TextId) -> SetId {
        if !texts.is_crowded(text) {
            return self.number(texts.matching_set(text));
        }
        let groups = self.word_groups.get_or_insert_with(|| WordGroups::of(texts));
        let Some(group) = groups.group(text) else { return self.number(texts.matching_set(text)) };
        let exceptions = groups.exceptions(texts, text, group);
        let of_group = if let Some(known) = self.by_group.get(&group) {
            *known
        } else {
            let matching = groups.matching(texts, group);
            let set = self.number(matching);
            self.by_group.insert(group, set);
            set
        };
        if exceptions.is_empty() {
            return of_group;
        }
        let set = self.texts(of_group).iter().copied().filter(|other| !exceptions.contains(other));
        let missing = exceptions.iter().filter(|other| self.texts(of_group).binary_search(other).is_err());
        let set = set.chain(missing.copied()).collect();
        self.number(set)
    }
}
