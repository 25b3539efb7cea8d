//! Word groups: the texts of one class and one profile, which match the same texts but for exceptions.
//!
//! They are made for one query, and only where it meets a text with too many matches to be listed. Groups are compared
//! with groups; exceptions are texts that share a rare word or that a model has judged, and these are judged by pairs.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use super::text_id::TextId;
use super::text_index::{COMPLETE_FROM_LEVEL, TextIndex};
use crate::semantics::Profile;

/// A word in at most this many texts is rare. In this crate's own tests two, so that its laws hold across the bound.
const RARE_MAX: usize = if cfg!(test) { 2 } else { 16 };

/// The number of a group within one query.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GroupId(usize);

#[derive(Clone, Debug)]
struct Group {
    class: Box<str>,
    profile: Profile,
    texts: Vec<TextId>,
}

/// The groups of an index at the time of a query.
#[derive(Clone, Debug, Default)]
pub struct WordGroups {
    groups: Vec<Group>,
    group_of: HashMap<TextId, GroupId>,
    /// The texts that have a rare word.
    by_rare_word: HashMap<Box<str>, Vec<TextId>>,
    /// By group, which groups match it.
    matching: HashMap<GroupId, Arc<[bool]>>,
}

impl WordGroups {
    /// Groups the texts of an index; none have a group if texts match below the level at which profiles decide.
    pub fn of(index: &TextIndex) -> Self {
        if index.min_level < COMPLETE_FROM_LEVEL {
            return Self::default();
        }
        let mut by_word: HashMap<&str, Vec<TextId>> = HashMap::new();
        for id in index.iter() {
            for word in index.node(id).text.stems() {
                by_word.entry(word).or_default().push(id);
            }
        }
        let is_frequent = |word: &str| by_word.get(word).is_some_and(|texts| texts.len() > RARE_MAX);
        let (mut groups, mut numbers): (Vec<Group>, HashMap<(&str, Profile), GroupId>) = Default::default();
        let mut group_of = HashMap::new();
        for id in index.iter() {
            let node = index.node(id);
            let Some(profile) = node.text.profile(is_frequent) else { continue };
            let group = *numbers.entry((&node.class, profile)).or_insert_with_key(|(class, profile)| {
                groups.push(Group { class: (*class).into(), profile: profile.clone(), texts: Vec::new() });
                GroupId(groups.len() - 1)
            });
            groups[group.0].texts.push(id);
            group_of.insert(id, group);
        }
        let rare = by_word.into_iter().filter(|(_, texts)| (2..=RARE_MAX).contains(&texts.len()));
        let by_rare_word = rare.map(|(word, texts)| (word.into(), texts)).collect();
        Self { groups, group_of, by_rare_word, matching: HashMap::new() }
    }

    /// Returns the group of a text; none if words alone do not decide about it.
    pub fn group(&self, id: TextId) -> Option<GroupId> {
        self.group_of.get(&id).copied()
    }

    /// Returns the texts that match those of a group, but for exceptions.
    pub fn matching(&mut self, index: &TextIndex, group: GroupId) -> Vec<TextId> {
        let matching = self.groups_matching(index, group);
        let groups = self.groups.iter().zip(&*matching).filter(|(_, matches)| **matches);
        groups.flat_map(|(group, _)| &group.texts).copied().collect()
    }

    /// Returns the exceptions of a text of a group: texts that match it and not its group, or the other way round.
    pub fn exceptions(&mut self, index: &TextIndex, id: TextId, group: GroupId) -> BTreeSet<TextId> {
        let node = index.node(id);
        let sharing = node.text.stems().filter_map(|word| self.by_rare_word.get(word)).flatten().copied();
        let judged = index.verdicts.judged_with(&node.class, node.text.normalised());
        let judged = judged.filter_map(|other| index.find_normalised(&node.class, other));
        let in_doubt: BTreeSet<TextId> = sharing.chain(judged).chain([id]).collect();
        let of_group = self.groups_matching(index, group);
        let is_exception = |other: &TextId| {
            let with_group = self.group_of.get(other).is_some_and(|group| of_group[group.0]);
            let is_match = *other == id
                || (index.node(*other).class == node.class && index.judge(&node.text, *other).is_some());
            with_group != is_match
        };
        in_doubt.into_iter().filter(is_exception).collect()
    }

    fn groups_matching(&mut self, index: &TextIndex, group: GroupId) -> Arc<[bool]> {
        let groups = &self.groups;
        let matching = self.matching.entry(group).or_insert_with(|| {
            let own = &groups[group.0];
            let matches = |other: &Group| {
                other.class == own.class && own.profile.reaches(&other.profile, index.min_level)
            };
            groups.iter().map(matches).collect()
        });
        matching.clone()
    }
}
