//! InformationLevel, §IV-A.2: how much a text tells about one object.

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::misreading;
use crate::semantics::lexicon::words::Word;
use crate::semantics::parsing::caption;
use crate::semantics::parsing::noise::is_one_symbol;
use crate::semantics::parsing::normalise::bare;
use crate::semantics::parsing::reading::Reading;
use crate::semantics::text::{ENOUGH_SPECIFIC_WORDS, Information, Text};

/// An all-capitals text longer than this is a sentence in capitals, and its words are no names.
const MAX_WORDS_OF_CAPITAL_NAME: usize = 3;

/// Finds the level of a text, whose words and names are known: `clean` has its capitals.
pub fn assess(text: &Text, clean: &str, read: &Reading) -> Information {
    let name = proper_name(clean, &text.words);
    let is_uninformative = is_uninformative(text);
    let is_container_alone = text.has_name() && !text.has_own_name() && is_uninformative;
    let has_word = || text.words.iter().any(|word| word.class != Class::Letter) || read.tells_role();
    let level = match () {
        // A container alone tells the floor and not the object on it (M23).
        () if is_container_alone => 4,
        () if text.has_name() => 4 + u8::from(has_word()),
        () if is_uninformative || is_one_symbol(text.normalised()) => 1,
        () if name.is_some() || specific(&text.words).count() >= ENOUGH_SPECIFIC_WORDS => 4,
        () if specific(&text.words).next().is_some() => 3,
        () => 2,
    };
    Information { level, is_container_alone, name }
}

/// InformationLevel of a text, 1 to 5, and the reason in one sentence.
pub fn information(text: &Text) -> (u8, String) {
    let level = text.information_level();
    let words = || specific(&text.words).map(|word| word.text.as_str()).collect::<Vec<_>>().join(", ");
    let reason = match (text.names().next(), &text.information.name) {
        _ if text.normalised().is_empty() => "the text is empty".to_owned(),
        _ if level == 1
            && let Some(foreign) = &text.foreign =>
        {
            format!("{} is not how this building writes its names", foreign.as_str())
        }
        _ if level == 1 => format!("\"{}\" says nothing about the object", text.normalised()),
        (Some(name), _) if level == 5 => format!("{} is an identifier with another word", name.as_str()),
        (Some(name), _) => format!("{} is an identifier", name.as_str()),
        (None, Some(name)) => format!("{name} is a proper name"),
        (None, None) if level == 2 => "it has only generic words".to_owned(),
        (None, None) => format!("its specific words are {}", words()),
    };
    (level, reason)
}

/// Returns the words that are not on every door.
pub fn specific(words: &[Word]) -> impl Iterator<Item = &Word> {
    words.iter().filter(|word| word.class < Class::Generic)
}

/// Empty, or a confession of not knowing with nothing but generic words beside it.
fn is_uninformative(text: &Text) -> bool {
    let unsure =
        |word: &Word| dictionary::is_unsure(&word.text) || dictionary::is_unsure_when_negated(&word.text);
    let confesses = text.words.iter().any(|word| dictionary::is_unsure(&word.text))
        || text.negated.iter().any(|word| dictionary::is_unsure_when_negated(&word.text));
    text.words.iter().all(|word| word.class == Class::Letter)
        || text.normalised() == "n/a"
        || (confesses && text.words.iter().all(|word| word.class >= Class::Generic || unsure(word)))
}

/// Returns a capitalised word outside the dictionary: "Mona Lisa", "Turing".
///
/// Capitals that open a sentence prove nothing, so the first word counts only if no other word of the text is specific.
/// In a short text all in capitals (TURING) they count, as signs are written so; EXIT is in the dictionary. What a caption
/// begins with makes no difference.
fn proper_name(clean: &str, read: &[Word]) -> Option<String> {
    let all: Vec<&str> =
        clean.split(|c: char| !(c.is_alphanumeric() || c == '\'')).filter(|word| !word.is_empty()).collect();
    let words = caption::introduced(&all);
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
