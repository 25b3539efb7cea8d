//! The search for the texts that match one.

use std::cell::RefCell;
use std::collections::HashMap;

use super::identities::IdentityId;
use super::text_id::TextId;
use super::text_index::{COMPLETE_FROM_LEVEL, TextIndex};
use crate::semantics::{self, Text};

impl TextIndex {
    /// Returns the texts that match this one: itself, then the others in the order of their oldest objects.
    pub fn matching(&self, id: TextId) -> impl Iterator<Item = TextId> + '_ {
        let node = self.node(id);
        let listed = node.matches.listed().map(|list| list.keys().copied().collect());
        let is_listed = listed.is_some();
        let others = listed.unwrap_or_else(|| self.partners(&node.class, &node.text));
        let others = self.by_age(others).into_iter().filter(move |other| *other != id);
        let judging = Judging::of(self, &node.text);
        std::iter::once(id).chain(others.filter(move |other| is_listed || judging.matches(*other)))
    }

    /// Returns the texts that match this one, itself included, ascending by number.
    pub fn matching_set(&self, id: TextId) -> Vec<TextId> {
        let node = self.node(id);
        let mut found: Vec<TextId> = if let Some(list) = node.matches.listed() {
            list.keys().copied().collect()
        } else {
            let judging = Judging::of(self, &node.text);
            let others = self.partners(&node.class, &node.text).into_iter();
            others.filter(|other| *other != id && judging.matches(*other)).collect()
        };
        let at = found.partition_point(|other| *other < id);
        found.insert(at, id);
        found
    }

    /// Returns the texts that match one that need not be in the index (an inline keyframe's).
    pub fn matching_text(&self, class: &str, text: &Text) -> Vec<TextId> {
        if let Some(id) = self.find(class, text) {
            return self.matching(id).collect();
        }
        let mut matching = self.candidates(class, text);
        let judging = Judging::of(self, text);
        matching.retain(|other| {
            judging.by_identity(*other).unwrap_or_else(|| {
                self.counts(semantics::similarity_level(text, &self.node(*other).text)).is_some()
            })
        });
        self.by_age(matching)
    }
}

/// One text that is held against many others of its class: each identity of theirs is judged once.
struct Judging<'a> {
    index: &'a TextIndex,
    text: &'a Text,
    /// Whether the text has an identity, and matches are sought at a level at which identities decide.
    has_identity: bool,
    known: RefCell<HashMap<IdentityId, bool>>,
}

impl<'a> Judging<'a> {
    fn of(index: &'a TextIndex, text: &'a Text) -> Self {
        let has_identity = index.min_level >= COMPLETE_FROM_LEVEL && text.identity().is_some();
        Self { index, text, has_identity, known: RefCell::default() }
    }

    /// Returns whether another text, which reads differently, matches.
    fn matches(&self, other: TextId) -> bool {
        self.by_identity(other).unwrap_or_else(|| self.index.judge(self.text, other).is_some())
    }

    /// Returns the same where identities decide, about which no model is asked; none elsewhere.
    fn by_identity(&self, other: TextId) -> Option<bool> {
        let identity = self.index.node(other).identity.filter(|_| self.has_identity)?;
        let mut known = self.known.borrow_mut();
        Some(*known.entry(identity).or_insert_with(|| self.index.judge(self.text, other).is_some()))
    }
}
