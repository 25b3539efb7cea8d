//! Identities: equal identifiers and directions in one class, where these alone decide.
//!
//! "room 901, oak" and "room 901, glass" match the same texts. Where thousands of texts share an identifier, the judge
//! therefore compares identities, not texts.

use std::cell::RefCell;
use std::collections::HashMap;

use super::{COMPLETE_FROM_LEVEL, TextId, TextIndex};
use crate::semantics::{Identity, Text};

/// The number of an identity; never given twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct IdentityId(u64);

/// The identities of an index, each with the number of its texts.
#[derive(Clone, Debug, Default)]
pub(super) struct Identities {
    known: HashMap<(Box<str>, Identity), (IdentityId, usize)>,
    next: u64,
}

impl Identities {
    /// Counts a text in, and returns its identity if it has one.
    pub(super) fn join(&mut self, class: &str, text: &Text) -> Option<IdentityId> {
        let fresh = (IdentityId(self.next), 0);
        let (id, texts) = self.known.entry((class.into(), text.identity()?)).or_insert(fresh);
        self.next += 1;
        *texts += 1;
        Some(*id)
    }

    /// Counts a text out.
    pub(super) fn leave(&mut self, class: &str, text: &Text) {
        let Some(identity) = text.identity() else { return };
        let identity = (class.into(), identity);
        if let Some((_, texts)) = self.known.get_mut(&identity) {
            *texts -= 1;
            if *texts == 0 {
                self.known.remove(&identity);
            }
        }
    }
}

/// One text that is held against many others of its class: each identity of theirs is judged once.
pub(super) struct Judging<'a> {
    index: &'a TextIndex,
    text: &'a Text,
    /// Whether the text has an identity, and matches are sought at a level at which identities decide.
    has_identity: bool,
    known: RefCell<HashMap<IdentityId, bool>>,
}

impl<'a> Judging<'a> {
    pub(super) fn of(index: &'a TextIndex, text: &'a Text) -> Self {
        let has_identity = index.min_level >= COMPLETE_FROM_LEVEL && text.identity().is_some();
        Self { index, text, has_identity, known: RefCell::default() }
    }

    /// Returns whether another text, which reads differently, matches.
    pub(super) fn matches(&self, other: TextId) -> bool {
        self.by_identity(other).unwrap_or_else(|| self.index.judge(self.text, other).is_some())
    }

    /// Returns the same where identities decide, about which no model is asked; none elsewhere.
    pub(super) fn by_identity(&self, other: TextId) -> Option<bool> {
        let identity = self.index.node(other).identity.filter(|_| self.has_identity)?;
        let mut known = self.known.borrow_mut();
        Some(*known.entry(identity).or_insert_with(|| self.index.judge(self.text, other).is_some()))
    }
}
