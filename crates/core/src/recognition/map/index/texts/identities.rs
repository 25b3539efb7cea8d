//! Identities: equal identifiers and directions in one class, where these alone decide.
//!
//! "room 901, oak" and "room 901, glass" match the same texts. Where thousands of texts share an identifier, the judge
//! therefore compares identities, not texts.

use std::collections::HashMap;

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
