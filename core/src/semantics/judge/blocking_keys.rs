//! Blocking keys: hashes that texts of level 4 and more share, so that only texts sharing one need comparing.

use crate::semantics::identifiers::identifier::Identifier;
use crate::semantics::lexicon::stable_hash::hash;
use crate::semantics::lexicon::words::{self, Word};

/// Keys of a text: of its own identifiers if it has any, else of its most telling words, else of the floor or building.
pub fn of_text(identifiers: &[Identifier], own: &[Identifier], words: &[Word]) -> Vec<u64> {
    // What is on one side only never gives level 4, so these kinds need not meet.
    let mut keys: Vec<u64> = if !own.is_empty() {
        own.iter().map(|identifier| identifier.look_alike).collect()
    } else if !words.is_empty() {
        words::prefix(words).iter().map(|word| hash(b'w', &word.text)).collect()
    } else {
        identifiers.iter().map(|identifier| hash(b'c', &identifier.value)).collect()
    };
    keys.sort_unstable();
    keys.dedup();
    keys
}
