//! Directions a text points in, by word or arrow.

use std::collections::HashMap;
use std::sync::LazyLock;

use crate::semantics::lexicon::words::Word;

/// A set of directions, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Directions(u16);

/// How the directions of two texts relate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bearing {
    /// The same directions, or none at all.
    Same,
    /// One text points where the other is silent.
    OneSided,
    /// They point different ways.
    Clash,
}

/// The name of each direction, its other stems ("links" is "link"), and its arrows, of which a slanted one turns where its
/// horizontal part points. The points of the compass are the last four.
const DIRECTIONS: [&str; 8] = [
    "left link gauche izquierda 左 <- < ← ⇐ ⬅ ⟵ ⇦ ◀ ◄ ↰ ↲ ↖ ↙ 👈",
    "right rechts droite derecha 右 -> > → ⇒ ➡ ⟶ ⇨ ▶ ► ↱ ↳ ↗ ↘ ➔ ➜ 👉",
    "up upstair oben haut arriba 上 ↑ ⇑ ⬆ ⇧ ▲ 👆 ☝",
    "down downstair unten bas abajo 下 ↓ ⇓ ⬇ ⇩ ▼ 👇",
    "north nord norte 北口",
    "south sud sued 南口",
    "east ost 東口",
    "west ouest oeste 西口",
];
const COMPASS_FROM: usize = 4;

impl Directions {
    /// Returns the directions among these words.
    pub fn among(words: &[Word]) -> Directions {
        Directions(words.iter().filter_map(|word| number(&word.text)).fold(0, |all, i| all | 1 << i))
    }

    /// Returns the directions without the points of the compass, which are parts of names: "North 101".
    pub fn without_compass(self) -> Directions {
        Directions(self.0 & ((1 << COMPASS_FROM) - 1))
    }

    /// Compares the directions of two texts.
    pub fn bearing(self, other: Directions) -> Bearing {
        let common = self.0 & other.0;
        match () {
            () if self == other => Bearing::Same,
            () if common == self.0 || common == other.0 => Bearing::OneSided,
            () => Bearing::Clash,
        }
    }

    /// Returns the directions in words: "left and up".
    pub fn phrase(self) -> String {
        let named = (0..DIRECTIONS.len()).filter(|i| self.0 & (1 << i) != 0).map(name);
        named.collect::<Vec<_>>().join(" and ")
    }
}

/// Returns the one name of a direction in all languages; none of other stems and symbols.
pub fn named(stem_or_symbol: &str) -> Option<&'static str> {
    number(stem_or_symbol).map(name)
}

/// Returns the one name of a point of the compass; none of other stems.
pub fn compass(stem: &str) -> Option<&'static str> {
    number(stem).filter(|i| *i >= COMPASS_FROM).map(name)
}

/// Whether this stem is a direction.
pub fn is_direction(stem: &str) -> bool {
    number(stem).is_some()
}

fn name(direction: usize) -> &'static str {
    DIRECTIONS[direction].split(' ').next().unwrap_or_default()
}

fn number(word: &str) -> Option<usize> {
    static NUMBERS: LazyLock<HashMap<&str, usize>> = LazyLock::new(|| {
        let directions = DIRECTIONS.iter().enumerate();
        directions.flat_map(|(i, words)| words.split(' ').map(move |word| (word, i))).collect()
    });
    NUMBERS.get(word).copied()
}
