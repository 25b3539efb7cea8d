//! The sentence that explains an information level.

use crate::semantics::judge::information::specific;
use crate::semantics::text::Text;

/// InformationLevel of a text, 1 to 5, and the reason in one sentence.
pub fn information(text: &Text) -> (u8, String) {
    let level = text.information_level();
    let reason = match (text.identifiers.first(), &text.information.name) {
        _ if text.normalised().is_empty() => "the text is empty".to_owned(),
        _ if level == 1
            && let Some(foreign) = &text.foreign =>
        {
            format!("{} is not how this building writes its names", foreign.as_str())
        }
        _ if level == 1 => format!("\"{}\" says nothing about the object", text.normalised()),
        (Some(identifier), _) if level == 5 => {
            format!("{} is an identifier with another word", identifier.as_str())
        }
        (Some(identifier), _) => format!("{} is an identifier", identifier.as_str()),
        (None, Some(name)) => format!("{name} is a proper name"),
        (None, None) => {
            match specific(&text.words).map(|word| word.text.as_str()).collect::<Vec<_>>().as_slice() {
                [] => "it has only generic words".to_owned(),
                words => format!("its specific words are {}", words.join(", ")),
            }
        }
    };
    (level, reason)
}
