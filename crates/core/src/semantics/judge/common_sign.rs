//! Common signs: texts that hang in every building, whether or not a plan shows them.

use std::collections::HashSet;
use std::sync::LazyLock;

use crate::semantics::lexicon::generic;
use crate::semantics::text::Text;

/// Whether a text has no name, and no word but those on the signs of every building: EXIT, "Toilets".
pub fn is_common_sign(text: &Text) -> bool {
    static WORDS: LazyLock<HashSet<&str>> = LazyLock::new(|| generic::words().collect());
    let is_common =
        |word: &str| WORDS.contains(word) || word.strip_suffix('s').is_some_and(|one| WORDS.contains(one));
    let mut words = text.normalised().split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    !text.has_name() && words.all(is_common)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_signs_of_every_building_are_told_from_its_own() {
        for text in ["EXIT", "Toilets", "Emergency exit", "Lift"] {
            assert!(is_common_sign(&Text::parse(text)), "{text}");
        }
        for text in ["Exit 3", "Kitchen", "Lift lobby", "312", "L1_door1"] {
            assert!(!is_common_sign(&Text::parse(text)), "{text}");
        }
    }
}
