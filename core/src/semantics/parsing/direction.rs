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

// Stems, as words are compared: "links" is "link".
const WORDS: [&str; 8] = [
    "left link gauche izquierda 左",
    "right rechts droite derecha 右",
    "up upstair oben haut arriba 上",
    "down downstair unten bas abajo 下",
    "north nord norte 北口",
    "south sud sued 南口",
    "east ost 東口",
    "west ouest oeste 西口",
];

impl Directions {
    /// Returns the directions among these words.
    pub fn among(words: &[Word]) -> Directions {
        let bits = words.iter().filter_map(|word| bit(&word.text));
        Directions(bits.fold(0, |all, bit| all | bit))
    }

    /// Returns the directions without the points of the compass, which are parts of names: "North 101".
    pub fn without_compass(self) -> Directions {
        Directions(self.0 & 0xf)
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
        let named = (0..WORDS.len()).filter(|i| self.0 & (1 << i) != 0).map(name);
        named.collect::<Vec<_>>().join(" and ")
    }
}

/// The word an arrow stands for. A slanted arrow turns where its horizontal part points.
pub fn of_symbol(symbol: &str) -> Option<&'static str> {
    let direction = match symbol {
        "<-" | "<" | "←" | "⇐" | "⬅" | "⟵" | "⇦" | "◀" | "◄" | "↰" | "↲" | "↖" | "↙" | "👈" => {
            0
        }
        "->" | ">" | "→" | "⇒" | "➡" | "⟶" | "⇨" | "▶" | "►" | "↱" | "↳" | "↗" | "↘" | "➔" | "➜" | "👉" => {
            1
        }
        "↑" | "⇑" | "⬆" | "⇧" | "▲" | "👆" | "☝" => 2,
        "↓" | "⇓" | "⬇" | "⇩" | "▼" | "👇" => 3,
        _ => return None,
    };
    Some(name(direction))
}

fn name(direction: usize) -> &'static str {
    WORDS[direction].split(' ').next().unwrap_or_default()
}

/// Returns the one name of a point of the compass in all languages; none of other stems.
pub fn compass(stem: &str) -> Option<&'static str> {
    let named = WORDS.iter().skip(4).find(|words| words.split(' ').any(|word| word == stem))?;
    named.split(' ').next()
}

/// Whether this stem is a direction.
pub fn is_direction(stem: &str) -> bool {
    bit(stem).is_some()
}

fn bit(word: &str) -> Option<u16> {
    static BITS: LazyLock<HashMap<&str, u16>> = LazyLock::new(|| {
        let words = WORDS.iter().enumerate();
        words.flat_map(|(i, words)| words.split(' ').map(move |word| (word, 1 << i))).collect()
    });
    BITS.get(word).copied()
}
