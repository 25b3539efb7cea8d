//! InformationLevel, §IV-A.2: how much a text tells about one object.

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::misreading;
use crate::semantics::lexicon::role::Role;
use crate::semantics::lexicon::words::Word;
use crate::semantics::names::identifier::Identifier;
use crate::semantics::parsing::frame;
use crate::semantics::parsing::noise::is_one_symbol;
use crate::semantics::parsing::normalise::bare;

/// From this many specific words on, a text without identifier or name is worth an anchor.
pub const ENOUGH_SPECIFIC_WORDS: usize = 3;
/// An all-capitals text longer than this is a sentence in capitals, and its words are no names.
const MAX_WORDS_OF_CAPITAL_NAME: usize = 3;

/// What was found of a text's worth.
#[derive(Clone, Debug)]
pub struct Information {
    /// 1 to 5.
    pub level: u8,
    /// Whether it only numbers parts of a building that hold many objects: "Level 5".
    pub is_container_alone: bool,
    pub(in crate::semantics) name: Option<String>,
}

impl Information {
    /// A code names one thing, and no word is beside it.
    pub fn of_code() -> Information {
        Information { level: 4, is_container_alone: false, name: None }
    }
}

/// Finds the level of a text: `clean` has its capitals, the rest is parsed from the normalised form.
pub fn assess(
    clean: &str,
    normalised: &str,
    identifiers: &[Identifier],
    has_own_name: bool,
    words: &[Word],
    negated: &[Word],
) -> Information {
    let name = proper_name(clean, words);
    let is_container_alone =
        !identifiers.is_empty() && !has_own_name && is_uninformative(normalised, words, negated);
    let level = match () {
        // A container alone tells the floor and not the object on it (M23).
        () if is_container_alone => 4,
        () if !identifiers.is_empty() => {
            let with_word = words.iter().any(|word| word.class != Class::Letter)
                || identifiers.iter().any(|i| i.role != Role::Neutral);
            if with_word { 5 } else { 4 }
        }
        () if is_uninformative(normalised, words, negated) || is_one_symbol(normalised) => 1,
        () if name.is_some() || specific(words).count() >= ENOUGH_SPECIFIC_WORDS => 4,
        () if specific(words).next().is_some() => 3,
        () => 2,
    };
    Information { level, is_container_alone, name }
}

/// Returns the words that are not on every door.
pub fn specific(words: &[Word]) -> impl Iterator<Item = &Word> {
    words.iter().filter(|word| word.class < Class::Generic)
}

/// Empty, or a confession of not knowing with nothing but generic words beside it.
fn is_uninformative(normalised: &str, words: &[Word], negated: &[Word]) -> bool {
    let unsure =
        |word: &Word| dictionary::is_unsure(&word.text) || dictionary::is_unsure_when_negated(&word.text);
    let confesses = words.iter().any(|word| dictionary::is_unsure(&word.text))
        || negated.iter().any(|word| dictionary::is_unsure_when_negated(&word.text));
    words.iter().all(|word| word.class == Class::Letter)
        || normalised == "n/a"
        || (confesses && words.iter().all(|word| word.class >= Class::Generic || unsure(word)))
}

/// Returns a capitalised word outside the dictionary: "Mona Lisa", "Turing".
///
/// Capitals that open a sentence prove nothing, so the first word counts only if no other word of the text is specific.
/// In a short text all in capitals (TURING) they count, as signs are written so; EXIT is in the dictionary. A frame
/// around it makes no difference.
fn proper_name(clean: &str, read: &[Word]) -> Option<String> {
    let all: Vec<&str> =
        clean.split(|c: char| !(c.is_alphanumeric() || c == '\'')).filter(|word| !word.is_empty()).collect();
    let words = frame::framed(&all);
    // A word of a generic phrase is generic there: "Thang máy" is a lift.
    let is_generic =
        |stem: &str| read.binary_search(&Word::of_class(Class::Generic, stem.to_owned())).is_ok();
    let is_specific = |word: &str| {
        let stem = dictionary::stem(&bare(word));
        misreading::class_of(&stem) == Class::Specific
            && !dictionary::is_unsure(&stem)
            && !dictionary::negates(&stem)
            && !is_generic(&stem)
    };
    let is_letters =
        |word: &str| word.chars().nth(1).is_some() && word.chars().all(|c| c.is_alphabetic() || c == '\'');
    let shouted = words.len() > MAX_WORDS_OF_CAPITAL_NAME && !clean.chars().any(char::is_lowercase);
    let mut candidates =
        words.iter().enumerate().filter(|(_, word)| is_letters(word) && word.starts_with(char::is_uppercase));
    let name = candidates.find(|(i, word)| {
        let opens_sentence = *i == 0
            && words[1..].iter().any(|other| is_specific(other) && !other.starts_with(char::is_uppercase));
        !opens_sentence && is_specific(word)
    });
    name.filter(|_| !shouted).map(|(_, word)| (*word).to_owned())
}
