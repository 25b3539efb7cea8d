//! Faults of a body: noted with the place of each, and with a short form of what was sent.

use std::cell::{Cell, RefCell};
use std::fmt::Display;
use std::ops::RangeInclusive;

use serde_json::Value;

use crate::api::limits;
use crate::domain::counted::counted;
use crate::domain::invalid::FieldError;

/// A pointer longer than this is cut: its names come from the client.
const POINTER_CHARS: usize = 512;

/// The faults noted so far.
#[derive(Default)]
pub(in crate::api) struct Faults {
    listed: RefCell<Vec<FieldError>>,
    unlisted: Cell<usize>,
}

impl Faults {
    /// Notes a fault; beyond the limit it is only counted.
    pub fn note(&self, fault: impl FnOnce() -> FieldError) {
        let mut listed = self.listed.borrow_mut();
        if listed.len() < limits::LISTED_FAULTS {
            listed.push(fault());
        } else {
            self.unlisted.set(self.unlisted.get() + 1);
        }
    }

    /// Returns the faults, and the number of those that are not listed.
    pub fn into_list(self) -> Vec<FieldError> {
        let mut list = self.listed.into_inner();
        let unlisted = self.unlisted.get();
        if unlisted > 0 {
            list.push(FieldError::new(
                "",
                format!(
                    "{} {} not listed",
                    counted(unlisted, "more fault"),
                    if unlisted == 1 { "is" } else { "are" }
                ),
            ));
        }
        list
    }
}

/// Appends a name or an index to a JSON pointer (RFC 6901).
pub(in crate::api) fn push_segment(pointer: &mut String, name: &str) {
    pointer.push('/');
    for c in name.chars() {
        if pointer.len() > POINTER_CHARS {
            pointer.push('…');
            return;
        }
        match c {
            '~' => pointer.push_str("~0"),
            '/' => pointer.push_str("~1"),
            c => pointer.push(c),
        }
    }
}

/// Returns a JSON pointer made of these names and indices.
pub fn pointer<'s>(segments: impl IntoIterator<Item = &'s str>) -> String {
    segments.into_iter().fold(String::new(), |mut pointer, segment| {
        push_segment(&mut pointer, segment);
        pointer
    })
}

/// Bounds as an error shows them.
pub(in crate::api) struct Bounds<'r, T>(pub &'r RangeInclusive<T>);

impl<T: Display> Display for Bounds<'_, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "[{}, {}]", self.0.start(), self.0.end())
    }
}

/// Returns the kind of a value, for people.
pub(in crate::api) fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

/// Returns a value as an error shows it: short, whatever was sent.
pub(in crate::api) fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => format!("{:?}", text.chars().take(80).collect::<String>()),
        Value::Array(items) => format!("a list of {}", items.len()),
        Value::Object(members) => format!("an object of {}", counted(members.len(), "field")),
        scalar => scalar.to_string(),
    }
}
