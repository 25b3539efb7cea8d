//! One spelling for letters of one shape: a Latin, a Greek and a Cyrillic A are one letter on a plate.

use std::collections::HashMap;
use std::sync::LazyLock;

use unicode_security::skeleton;

/// Returns text in upper case with the Latin letter for each letter of its shape.
///
/// Only one letter for one letter, after the table of confusables of UTS #39. That table also makes a digit of some letters,
/// and the other way round; these are misreadings (`relation.rs`), and never the same.
pub fn latin_capitals(text: &str) -> String {
    let capitals = text.chars().flat_map(char::to_uppercase);
    capitals
        .map(|c| if c.is_ascii() { c } else { LATIN.get(&skeleton_of(c)).copied().unwrap_or(c) })
        .collect()
}

/// The Latin capitals by the form that the table gives all letters of their shape.
static LATIN: LazyLock<HashMap<Option<char>, char>> =
    LazyLock::new(|| ('A'..='Z').map(|capital| (skeleton_of(capital), capital)).collect());

/// Returns the one character that stands for all of the shape of a letter; none if several stand for it.
fn skeleton_of(letter: char) -> Option<char> {
    let mut buffer = [0; 4];
    let mut skeleton = skeleton(letter.encode_utf8(&mut buffer));
    let (first, more) = (skeleton.next()?, skeleton.next());
    (more.is_none() && letter.is_alphabetic()).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_of_one_shape_are_one_letter() {
        for (text, latin) in [
            ("АВС", "ABC"),
            ("ΑΒΕ", "ABE"),
            ("і", "I"),
            ("ab", "AB"),
            ("Ж", "Ж"),
            ("Ä", "Ä"),
            ("дверь", "ДBEPЬ"),
        ] {
            assert_eq!(latin_capitals(text), latin, "{text}");
        }
    }
}
