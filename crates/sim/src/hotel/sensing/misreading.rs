//! Misreading: simulates how text recognition misreads a number.

use crate::hotel::rng::SeededRng;

/// The share of misreadings that lose a character; the others replace one.
const DROPPED_SHARE: f64 = 0.25;

/// Look-alike characters.
const LOOK_ALIKE: [(char, &str); 10] = [
    ('0', "869"),
    ('1', "74"),
    ('2', "7"),
    ('3', "89"),
    ('4', "91"),
    ('5', "683"),
    ('6', "580"),
    ('7', "12"),
    ('8', "3069"),
    ('9', "084"),
];

/// Returns a misread number.
pub fn misread(number: &str, rng: &mut SeededRng) -> String {
    let mut characters: Vec<char> = number.chars().collect();
    let at = rng.below(characters.len());
    if rng.happens(DROPPED_SHARE) && characters.len() > 1 {
        characters.remove(at);
    } else if let Some((_, alike)) = LOOK_ALIKE.iter().find(|(character, _)| *character == characters[at]) {
        let alike: Vec<char> = alike.chars().collect();
        characters[at] = *rng.one_of(&alike);
    }
    characters.into_iter().collect()
}
