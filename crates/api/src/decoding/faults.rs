//! Faults of a body: noted with the place of each, and with a short form of what was sent.

use std::cell::{Cell, RefCell};
use std::fmt::Display;
use std::ops::RangeInclusive;

use revisit_core::domain::counted::counted;
use revisit_core::domain::invalid::FieldError;

use super::document::{Json, Kind};
use crate::limits;

/// A pointer longer than this is cut: its names come from the client.
const POINTER_CHARS: usize = 512;

/// The faults noted so far.
#[derive(Default)]
pub(crate) struct Faults {
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
            let (faults, are) = (counted(unlisted, "more fault"), if unlisted == 1 { "is" } else { "are" });
            list.push(FieldError::new("", format!("{faults} {are} not listed")));
        }
        list
    }
}

/// Appends a name or an index to a JSON pointer (RFC 6901).
pub(crate) fn push_segment(pointer: &mut String, name: &str) {
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
pub(crate) struct Bounds<'r, T>(pub &'r RangeInclusive<T>);

impl<T: Display> Display for Bounds<'_, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "[{}, {}]", self.0.start(), self.0.end())
    }
}

/// Returns the kind of a value, for people.
pub(crate) fn kind(value: Json<'_>) -> &'static str {
    match value.kind() {
        Kind::Null => "null",
        Kind::Bool => "true or false",
        Kind::Number => "a number",
        Kind::Text => "a string",
        Kind::List => "a list",
        Kind::Object => "an object",
    }
}

/// Returns a value as an error shows it: short, whatever was sent.
pub(crate) fn shown(value: Json<'_>) -> String {
    match value.kind() {
        Kind::Null => "null".to_owned(),
        Kind::Bool => value.as_bool().unwrap_or_default().to_string(),
        // A packed number may be none, as JSON has it.
        Kind::Number => match value.as_number() {
            Some(number) => number.to_string(),
            None => format!("{:?}", value.as_f64().unwrap_or(f64::NAN)),
        },
        Kind::Text => {
            format!("{:?}", value.as_str().unwrap_or_default().chars().take(80).collect::<String>())
        }
        Kind::List => format!("a list of {}", value.len()),
        Kind::Object => format!("an object of {}", counted(value.len(), "field")),
    }
}
