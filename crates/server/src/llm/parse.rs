//! Validation of answers. Strict: an answer in another form is an error, and the built-in judge substitutes.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;

use super::port::{Fault, Question};
use crate::domain::judgement::TextFunction;
use crate::semantics::{self, Embedding};

/// Maximum characters of a description.
const TEXT_CHARS_MAX: usize = 2000;

/// Maximum characters of a question.
const QUESTION_CHARS_MAX: usize = 300;

/// Checks that an answer is usable; one that fails is neither cached nor used.
pub fn check(question: &Question, content: &str) -> Result<(), Fault> {
    match question {
        Question::Texts { function: TextFunction::Merge, .. } | Question::Summary { .. } => {
            text(content).map(drop)
        }
        Question::Texts { .. } => level(content).map(drop),
        Question::NextQuestion { .. } => next_question(content).map(drop),
        Question::Look { .. } => look(content).map(drop),
        Question::Embed { .. } => embedding(content).map(drop),
    }
}

/// Parses a level with its reason: `{"level": 1..5}`, or the number alone. Never a digit out of a sentence.
pub fn level(content: &str) -> Result<(u8, Option<String>), Fault> {
    let value: Value =
        serde_json::from_str(thought_through(content)).map_err(|_| Fault::Garbled("no JSON"))?;
    let found = match &value {
        Value::Object(members) => members.get("level").ok_or(Fault::Garbled("no level"))?,
        other => other,
    };
    let level = match found {
        Value::Number(number) => number.as_u64(),
        Value::String(text) if text.len() == 1 => text.parse().ok(),
        _ => None,
    };
    let level =
        level.filter(|level| (1..=5).contains(level)).ok_or(Fault::Garbled("no level from 1 to 5"))?;
    let reason = value.get("reason").and_then(Value::as_str).map(shown);
    Ok((level as u8, reason.filter(|reason| !reason.is_empty())))
}

/// Parses a text: `{"text": "..."}`, or plain words.
pub fn text(content: &str) -> Result<String, Fault> {
    let content = thought_through(content);
    let text = if content.starts_with(['{', '[', '`']) {
        let value: Value = serde_json::from_str(content).map_err(|_| Fault::Garbled("no JSON"))?;
        let text = value.get("text").and_then(Value::as_str);
        text.ok_or(Fault::Garbled("no text"))?.to_owned()
    } else {
        content.to_owned()
    };
    let text = semantics::clean(&text);
    if text.is_empty() { Err(Fault::Garbled("an empty text")) } else { bounded(text) }
}

/// Parses what was seen; an empty answer is valid, too.
pub fn look(content: &str) -> Result<String, Fault> {
    bounded(semantics::clean(thought_through(content)))
}

fn bounded(text: String) -> Result<String, Fault> {
    let is_long = text.chars().count() > TEXT_CHARS_MAX;
    if is_long { Err(Fault::Garbled("a text that is too long")) } else { Ok(text) }
}

/// Parses an embedding in the form of [`write_embedding`].
pub fn embedding(content: &str) -> Result<Embedding, Fault> {
    let bytes = STANDARD.decode(content).map_err(|_| Fault::Garbled("no embedding"))?;
    let components = bytes.into_iter().map(u8::cast_signed).collect();
    Embedding::from_components(components).ok_or(Fault::Garbled("no embedding"))
}

/// Formats an embedding for the cache: its components, a byte each, in base64.
pub fn write_embedding(embedding: &Embedding) -> String {
    let bytes: Vec<u8> = embedding.components().iter().map(|component| component.cast_unsigned()).collect();
    STANDARD.encode(bytes)
}

/// Parses the next question of a dialogue: one line.
pub fn next_question(content: &str) -> Result<String, Fault> {
    let question = text(content)?;
    let is_long = question.chars().count() > QUESTION_CHARS_MAX;
    if is_long { Err(Fault::Garbled("a question that is too long")) } else { Ok(question) }
}

/// Removes the reasoning that some models write before they answer.
fn thought_through(content: &str) -> &str {
    let content = content.trim();
    match content.strip_prefix("<think>") {
        Some(thoughts) => thoughts.split_once("</think>").map_or("", |(_, answer)| answer.trim()),
        None => content,
    }
}

/// Cleans a reason for display, and cuts it to one sentence.
fn shown(reason: &str) -> String {
    semantics::clean(reason).chars().take(200).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_is_a_number_from_1_to_5_and_nothing_else() {
        for (content, expected) in [
            (r#"{"level": 4, "reason": "both are boats"}"#, Some(4)),
            (r#"{"level":"4"}"#, Some(4)),
            (" 3 ", Some(3)),
            ("<think>a boat, 5?</think>\n{\"level\":2}", Some(2)),
            ("6", None),
            ("0", None),
            ("4.5", None),
            ("-4", None),
            ("I would say 4 out of 5.", None),
            ("Level: 4", None),
            (r#"{"level": 44}"#, None),
            (r#"{"level": "4 or 5"}"#, None),
            (r#"{"score": 4}"#, None),
            (r#"{"level": 4"#, None),
            ("```json\n{\"level\":4}\n```", None),
            ("[4]", None),
            ("", None),
            ("<think>4", None),
        ] {
            assert_eq!(level(content).ok().map(|(level, _)| level), expected, "{content}");
        }
    }

    #[test]
    fn a_text_is_plain_words_or_a_member_named_text() {
        assert_eq!(text(r#"{"text": "a red\u202e boat"}"#).as_deref(), Ok("a red boat"));
        assert_eq!(text(" a red boat ").as_deref(), Ok("a red boat"));
        for garbled in ["", r#"{"text": ""}"#, r#"{"text": 5}"#, r#"{"text": "a"#, &"x".repeat(3000)] {
            assert!(text(garbled).is_err(), "{garbled}");
        }
    }
}
