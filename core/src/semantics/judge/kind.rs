//! The kind of a text: what it may be evidence of (M22).

use crate::named::named;
use crate::semantics::judge::information::{Information, specific};
use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::role;
use crate::semantics::lexicon::word_list::WordList;
use crate::semantics::lexicon::words::Word;
use crate::semantics::names::name::Name;
use crate::semantics::parsing::normalise::bare;

/// Words beside a known kind of room from which on a text is a sentence, and no name.
const NAME_WORDS_MAX: usize = 4;
/// Words from which on a text that also has grammar is a sentence.
const NOTICE_WORDS_MIN: usize = 3;

named! {
    /// What kind of text a description is. A description by a model or by hand is one, whatever its words.
    TextKind {
        /// A name with a number: "901", "ML D 28", "HUB 10", also of a floor.
        Name = "name",
        /// A proper name beside a word for what it names: "Meeting Room Turing".
        ProperName = "proper_name",
        /// A sentence or an instruction: "Please keep this door closed".
        Notice = "notice",
        /// A sign of every building: EXIT.
        CommonSign = "common_sign",
        /// A description of a thing by a sentence: "a painting of a boat".
        Description = "description",
        /// A code: a fiducial marker, a UUID, a link, or any text of the map's `code_classes`.
        Code = "code",
        /// None of these for all that is known: a word that the lexicon does not have may be a name, a notice, a brand or noise.
        Unknown = "unknown",
    }
}

impl TextKind {
    /// Returns the kind of a text of this kind that a model or a person wrote: what has no name describes a thing.
    pub fn described(self) -> Self {
        match self {
            Self::Name | Self::Code | Self::CommonSign => self,
            Self::ProperName | Self::Notice | Self::Description | Self::Unknown => Self::Description,
        }
    }
}

/// Findings about a text that tell its kind.
pub struct Found<'t> {
    /// The text with its capitals.
    pub clean: &'t str,
    /// The object's own name.
    pub name: Option<&'t Name>,
    /// Whether it names a floor, wing or building.
    pub has_containers: bool,
    /// Whether its number has a shape that nothing bears out, beside others that are.
    pub is_doubtful: bool,
    /// Whether it tells what a picture shows.
    pub is_of_picture: bool,
    /// Its words.
    pub words: &'t [Word],
    /// Those of its words that are denied.
    pub negated: &'t [Word],
    /// Its InformationLevel.
    pub information: &'t Information,
}

/// Words that ask for something.
static REQUESTS: WordList = WordList::of(
    "please bitte veuillez priere favor prego gelieve vennligst lutfen prosim kerjuk prosze pozhaluysta пожалуйста παρακαλω \
    请 請 ください 주세요",
);

/// Returns the kind of a text. Unknown is the default.
pub fn kind(found: &Found<'_>) -> TextKind {
    let has_unknown = || found.words.iter().any(|word| word.class == Class::Specific);
    match () {
        () if found.name.is_some() && found.is_doubtful => TextKind::Unknown,
        () if found.name.is_some() || (found.has_containers && found.information.is_container_alone) => {
            TextKind::Name
        }
        () if found.information.level == 1 => TextKind::Unknown,
        () if is_request(found) => TextKind::Notice,
        () if found.is_of_picture && specific(found.words).next().is_some() => TextKind::Description,
        () if is_sentence(found) => TextKind::Notice,
        () if !has_unknown() => TextKind::CommonSign,
        () if found.information.name.is_some() && is_beside_kind(found) => TextKind::ProperName,
        () => TextKind::Unknown,
    }
}

/// Whether it asks for something, or forbids it.
fn is_request(found: &Found<'_>) -> bool {
    words(found.clean).any(|word| REQUESTS.has(&word))
        || !found.negated.is_empty()
        || found.clean.ends_with(['!', '！'])
}

/// Whether it has grammar, and as many words as a sentence.
fn is_sentence(found: &Found<'_>) -> bool {
    let has_grammar = words(found.clean).any(|word| dictionary::listed(&word) == Some(Class::Function));
    has_grammar && found.words.len() >= NOTICE_WORDS_MIN
}

fn words(clean: &str) -> impl Iterator<Item = String> + '_ {
    clean.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).map(bare)
}

/// Whether a word tells what kind of room is named: "Meeting Room Turing".
fn is_beside_kind(found: &Found<'_>) -> bool {
    let tells = |word: &Word| word.class == Class::Generic && role::role_of(&word.text).is_some();
    found.words.len() <= NAME_WORDS_MAX && found.words.iter().any(tells)
}

#[cfg(test)]
mod tests {
    use super::TextKind::{self, *};
    use crate::semantics::Text;

    #[test]
    fn each_text_has_one_kind() {
        let kinds: [(TextKind, &[&str]); 7] = [
            (
                Name,
                &["901", "Room A 101", "ML D 28", "HUB 10", "Level 5", "三楼", "EXIT 3", "7.04 Seminarraum"],
            ),
            (ProperName, &["Meeting Room Turing", "Turing Office"]),
            (
                Notice,
                &[
                    "Please keep this door closed",
                    "NO SMOKING",
                    "Bitte Tür schließen",
                    "Diese Brandschutztür ist stets geschlossen zu halten",
                    "Authorised staff only!",
                ],
            ),
            (CommonSign, &["EXIT", "Notausgang", "Salida de emergencia", "非常口"]),
            (Description, &["a painting of a red boat on a lake", "A framed picture showing a bridge"]),
            (Code, &["tag36h11:7", "https://example.org/17"]),
            (
                Unknown,
                &[
                    "Turing",
                    "Küche",
                    "Kijárat felé",
                    "Wi-Fi",
                    "Brandschutztür",
                    "CASTELLANA",
                    "会议室",
                    "SHAPING THE NEXT",
                    "",
                    "unknown",
                ],
            ),
        ];
        for (kind, texts) in kinds {
            for text in texts {
                assert_eq!(Text::parse(text).kind(), kind, "{text}");
            }
        }
    }
}
