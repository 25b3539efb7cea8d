//! Blocking keys: hashes that texts of level 4 and more share, so that only texts sharing one need comparing.

use crate::semantics::lexicon::role::Role;
use crate::semantics::lexicon::stable_hash::hash;
use crate::semantics::lexicon::words::{self, Word};
use crate::semantics::names::name::Name;

/// Keys of a text: of its own name if it has one, else of its most telling words, else of the floor or building.
pub fn of_text(own: Option<&Name>, containers: &[(Role, Name)], words: &[Word]) -> Vec<u64> {
    // What is on one side only never gives level 4, so these kinds need not meet.
    let mut keys: Vec<u64> = if let Some(own) = own {
        vec![own.look_alike()]
    } else if !words.is_empty() {
        words::prefix(words).iter().map(|word| hash(b'w', &word.text)).collect()
    } else {
        containers.iter().map(|(_, name)| hash(b'c', name.key())).collect()
    };
    keys.sort_unstable();
    keys.dedup();
    keys
}
