//! Misreading: what text recognition makes of a number that it reads wrong.

use crate::hotel::rng::SeededRng;

/// Of readings that are wrong, this share has lost a character; the others have it replaced.
const DROPPED_SHARE: f64 = 0.25;

/// Characters that are taken for each other.
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

/// Returns a number as it may be misread.
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
