//! The words of a text as a weighted set, and the likeness of two such sets.

use std::cmp::Ordering;

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::misreading::misread;
use crate::semantics::lexicon::stable_hash;

/// Likeness, in percent, from which two texts without identifiers reach levels 4 and 3.
const LEVEL_4_PERCENT: u32 = 70;
const LEVEL_3_PERCENT: u32 = 40;

/// A word that counts: its stem and its worth. Sorts most telling first, then by hash, the global order of the keys.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Word {
    /// What it is worth.
    pub class: Class,
    hash: u64,
    /// Its stem.
    pub text: String,
}

impl Word {
    /// Returns the word of this stem, or the generic word it is a misreading of.
    pub fn new(stem: String) -> Word {
        let meant = misread(&stem).map_or(stem, str::to_owned);
        Word::of_class(dictionary::listed(&meant).unwrap_or(Class::Specific), meant)
    }

    /// Returns a word whose class the dictionary cannot tell.
    pub fn of_class(class: Class, text: String) -> Word {
        Word { class, hash: stable_hash::hash(b'w', &text), text }
    }

    /// Returns the word for a place beside the object, as in "left of the door".
    pub fn location(direction: &str) -> Word {
        Word::of_class(Class::Descriptive, format!("at {direction}"))
    }

    /// Whether it tells a place beside the object.
    pub fn is_location(&self) -> bool {
        self.text.starts_with("at ")
    }

    /// Returns what sets this text apart must weigh more than what all texts have.
    pub(in crate::semantics) fn weight(&self) -> u32 {
        if self.class == Class::Specific { 2 } else { 1 }
    }
}

/// What two sets of words have in common.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overlap {
    common: u32,
    all: u32,
    looks: [bool; 3],
    quantities: [bool; 3],
}

impl Overlap {
    /// Adds the weight of further words, none of which is in both sets.
    pub fn with_different(self, weight: u32) -> Overlap {
        Overlap { all: self.all + weight, ..self }
    }

    /// Weighted Jaccard likeness as a level, 1 to 5.
    pub fn level(self) -> u8 {
        let percent = self.common * 100;
        match () {
            () if self.common == self.all => 5,
            () if percent >= LEVEL_4_PERCENT * self.all => 4,
            () if percent >= LEVEL_3_PERCENT * self.all => 3,
            () if self.common > 0 => 2,
            () => 1,
        }
    }

    /// Weighted Jaccard likeness in percent.
    pub fn percent(self) -> u32 {
        (self.common * 100).checked_div(self.all).unwrap_or(0)
    }

    /// Both state looks, none in common: "a black cat", "a white cat" (level 2 in Table I).
    pub fn looks_clash(self) -> bool {
        self.looks == [false, true, true]
    }

    /// Both state looks or quantities that the other does not.
    pub fn details_differ(self) -> bool {
        [self.looks, self.quantities].iter().any(|sides| sides[1] && sides[2])
    }
}

/// Compares two sorted sets.
pub fn overlap(a: &[Word], b: &[Word]) -> Overlap {
    const BOTH: usize = 0;
    let mut overlap = Overlap::default();
    walk(a, b, |word, side| {
        overlap.all += word.weight();
        overlap.common += if side == BOTH { word.weight() } else { 0 };
        match word.class {
            Class::Look => overlap.looks[side] = true,
            Class::Quantity | Class::Letter => overlap.quantities[side] = true,
            _ => {}
        }
    });
    overlap
}

/// Walks two sorted sets at once; side 0 is both, 1 only `a`, 2 only `b`.
pub fn walk<'w>(a: &'w [Word], b: &'w [Word], mut visit: impl FnMut(&'w Word, usize)) {
    let (mut i, mut j) = (0, 0);
    loop {
        let order = match (a.get(i), b.get(j)) {
            (Some(x), Some(y)) => x.cmp(y),
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (None, None) => return,
        };
        match order {
            Ordering::Equal => visit(&a[i], 0),
            Ordering::Less => visit(&a[i], 1),
            Ordering::Greater => visit(&b[j], 2),
        }
        i += usize::from(order != Ordering::Greater);
        j += usize::from(order != Ordering::Less);
    }
}

/// Returns the words of which two sets of level 4 share at least one (prefix filtering of set-similarity joins): what
/// follows the prefix weighs too little to make up level 4 alone.
pub fn prefix(sorted: &[Word]) -> &[Word] {
    let total: u32 = sorted.iter().map(Word::weight).sum();
    let mut rest = total;
    let len = sorted.iter().take_while(|word| {
        let needed = rest * 100 >= LEVEL_4_PERCENT * total;
        rest -= word.weight();
        needed
    });
    &sorted[..len.count()]
}
