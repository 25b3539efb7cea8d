//! Blocking keys: hashes that texts of level 4 and more share, so that only texts sharing one need comparing.

use super::identifier::Identifier;
use super::stable_hash::hash;
use super::words::{self, Word};

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
