//! Words: the codes of the model with their words for people, as a script that the viewer imports.

use revisit_core::domain::anchor::AnchorState;
use revisit_core::domain::event::EventKind;
use revisit_core::domain::reason::ReasonCode;
use revisit_core::domain::verdict::EvidenceKind;
use revisit_core::named::Named;
use serde_json::{Map, Value, json};

/// Returns the script.
pub fn script() -> String {
    let reason = |code: ReasonCode| {
        let words = code.words();
        let (class, check) = (words.class.as_str(), words.check.as_str());
        json!({"title": words.title, "sentence": code.meaning(), "class": class, "check": check})
    };
    [
        exported("REASONS", &by_name(reason)),
        exported("EVIDENCE", &by_name(|kind: EvidenceKind| json!(kind.meaning()))),
        exported("EVENTS", &json!(EventKind::NAMES)),
        exported("ANCHOR_STATES", &json!(AnchorState::NAMES)),
    ]
    .concat()
}

fn by_name<T: Named>(words: impl Fn(T) -> Value) -> Value {
    T::VALUES.iter().map(|value| (value.name().to_owned(), words(*value))).collect::<Map<_, _>>().into()
}

fn exported(name: &str, value: &Value) -> String {
    format!("export const {name} = {value};\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_script_has_the_words_of_every_code() {
        let script = script();
        assert_eq!(script.lines().count(), 4);
        for code in ReasonCode::VALUES {
            assert!(script.contains(&format!("\"{}\":{{", code.as_str())), "{code:?}");
        }
        let waits =
            r#""llm_pending":{"check":"anchors","class":"waits","sentence":"Anchors are not described yet"#;
        assert!(script.contains(waits), "{script}");
    }
}
