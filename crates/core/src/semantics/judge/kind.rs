//! The kind of a text: what it may be evidence of (M22).

use crate::semantics::judge::information::specific;
use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::role;
use crate::semantics::lexicon::word_list::WordList;
use crate::semantics::lexicon::words::Word;
use crate::semantics::names::name::Name;
use crate::semantics::names::numbering::Standing;
use crate::semantics::parsing::normalise::bare;
use crate::semantics::parsing::reading::Reading;
use crate::semantics::text::{Text, TextKind};

/// Words beside a known kind of room from which on a text is a sentence, and no name.
const NAME_WORDS_MAX: usize = 4;
/// Words from which on a text that also has grammar is a sentence.
const NOTICE_WORDS_MIN: usize = 3;

/// Words that ask for something.
static REQUESTS: WordList = WordList::of(
    "please bitte veuillez priere favor prego gelieve vennligst lutfen prosim kerjuk prosze pozhaluysta пожалуйста παρακαλω \
    请 請 ください 주세요",
);

/// Returns the kind of a text whose names, words and information are known. Unknown is the default.
pub fn kind(text: &Text, clean: &str, read: &Reading) -> TextKind {
    let has_grammar = || words(clean).any(|word| dictionary::listed(&word) == Some(Class::Function));
    let requests = || words(clean).any(|word| REQUESTS.has(&word)) || clean.ends_with(['!', '！']);
    match () {
        () if text.own.as_ref().is_some_and(Name::is_code) => TextKind::Code,
        () if text.standing == Standing::Doubtful => TextKind::Unknown,
        () if text.has_own_name() || text.information.is_container_alone => TextKind::Name,
        () if text.information.level == 1 => TextKind::Unknown,
        () if !text.negated.is_empty() || requests() => TextKind::Notice,
        () if read.is_of_picture && specific(&text.words).next().is_some() => TextKind::Description,
        () if text.words.len() >= NOTICE_WORDS_MIN && has_grammar() => TextKind::Notice,
        () if text.specific_words().next().is_none() => TextKind::CommonSign,
        () if text.information.name.is_some() && is_beside_kind(&text.words) => TextKind::ProperName,
        () => TextKind::Unknown,
    }
}

fn words(clean: &str) -> impl Iterator<Item = String> + '_ {
    clean.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).map(bare)
}

/// Whether a word tells what kind of room is named: "Meeting Room Turing".
fn is_beside_kind(words: &[Word]) -> bool {
    let tells = |word: &Word| word.class == Class::Generic && role::role_of(&word.text).is_some();
    words.len() <= NAME_WORDS_MAX && words.iter().any(tells)
}

#[cfg(test)]
mod tests {
    use crate::semantics::Text;
    use crate::semantics::TextKind::{self, *};

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
