//! Reader: walks a JSON value and notes every fault in it, each with its place, instead of stopping at the first.
//!
//! serde stops at the first error, and a client that fixes its bodies one error at a time is a client that curses.
//! So a body becomes a [`Value`] first, and this reader takes the model out of it. Each method returns `None` after
//! it noted a fault; callers read all fields before they give up on any.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use serde_json::{Map, Value};

use super::faults::{Bounds, Faults, kind, push_segment, shown};
use crate::domain::counted::counted;
use crate::domain::ids::{ID_FORM, IdError};
use crate::domain::invalid::FieldError;

/// What can be read from a JSON body.
pub trait Decode: Sized {
    /// Reads it; `None` if faults were noted.
    fn decode(node: &Node<'_>) -> Option<Self>;
}

/// Reads a value, or tells every fault in it.
pub fn decode<T: Decode>(value: &Value) -> Result<T, Vec<FieldError>> {
    decode_with(value, T::decode)
}

/// Reads a value by a function of its own, or tells every fault in it.
pub fn decode_with<T>(
    value: &Value,
    read: impl FnOnce(&Node<'_>) -> Option<T>,
) -> Result<T, Vec<FieldError>> {
    let faults = Faults::default();
    let read = read(&Node { value, parent: None, step: Step::Root, faults: &faults });
    match (read, faults.into_list()) {
        (Some(read), list) if list.is_empty() => Ok(read),
        (_, list) => Err(list),
    }
}

#[derive(Clone, Copy)]
enum Step<'a> {
    Root,
    Name(&'a str),
    Index(usize),
}

/// One value in the body and the way that leads to it.
pub struct Node<'a> {
    value: &'a Value,
    // The way is a list through the callers' stack frames, spelled out only when there is a fault to tell.
    parent: Option<&'a Node<'a>>,
    step: Step<'a>,
    faults: &'a Faults,
}

impl<'a> Node<'a> {
    /// Returns the value itself.
    pub fn value(&self) -> &'a Value {
        self.value
    }

    fn child<'c>(&'c self, step: Step<'c>, value: &'c Value) -> Node<'c> {
        Node { value, parent: Some(self), step, faults: self.faults }
    }

    /// Returns the JSON pointer (RFC 6901) of this value.
    fn pointer(&self) -> String {
        let mut pointer = self.parent.map(Node::pointer).unwrap_or_default();
        match self.step {
            Step::Root => {}
            Step::Name(name) => push_segment(&mut pointer, name),
            Step::Index(index) => push_segment(&mut pointer, &index.to_string()),
        }
        pointer
    }

    /// Notes a fault of this value, with what was sent and what would have been allowed.
    pub fn refuse<T>(&self, detail: impl Into<String>, limit: impl Display) -> Option<T> {
        self.note(|pointer| FieldError::new(pointer, detail).got(shown(self.value)).limit(limit))
    }

    /// Notes a fault of this value, with what it amounts to where its own text would say little.
    pub fn refuse_as<T>(
        &self,
        detail: impl Into<String>,
        got: impl ToString,
        limit: impl Display,
    ) -> Option<T> {
        self.note(|pointer| FieldError::new(pointer, detail).got(got).limit(limit))
    }

    fn note<T>(&self, fault: impl FnOnce(String) -> FieldError) -> Option<T> {
        self.faults.note(|| fault(self.pointer()));
        None
    }

    fn expected<T>(&self, what: &str) -> Option<T> {
        self.refuse(format!("expected {what}, not {}", kind(self.value)), what)
    }

    /// Reads a number within bounds. JSON has no NaN and no infinity, and the bounds keep both out of any sum. Zero has one
    /// form: SQLite keeps no sign of a zero, so `-0.0` would be answered as `0.0` after a restart.
    pub fn number(&self, range: RangeInclusive<f64>) -> Option<f64> {
        let Some(number) = self.value.as_f64() else {
            return self.expected("a number");
        };
        if range.contains(&number) {
            return Some(number + 0.0);
        }
        self.refuse("the number is out of range", Bounds(&range))
    }

    /// Returns a whole number within bounds; `5.0` is one too, as JSON knows one kind of number only.
    pub fn whole(&self, range: RangeInclusive<i64>) -> Option<i64> {
        let Value::Number(number) = self.value else {
            return self.expected("a whole number");
        };
        let whole = number.as_i64().or_else(|| number.as_f64().and_then(exactly));
        match whole {
            Some(whole) if range.contains(&whole) => Some(whole),
            None if number.as_f64().is_some_and(|number| number.fract() != 0.0) => {
                self.refuse("expected a whole number", Bounds(&range))
            }
            _ => self.refuse("the number is out of range", Bounds(&range)),
        }
    }

    /// Returns a whole number that fits 32 bits, within bounds.
    pub fn count(&self, range: RangeInclusive<i64>) -> Option<u32> {
        self.whole(range).and_then(|whole| u32::try_from(whole).ok())
    }

    /// Returns a whole number written in digits, as a query parameter is.
    pub fn digits(&self, range: RangeInclusive<i64>) -> Option<i64> {
        match self.string()?.parse() {
            Ok(whole) if range.contains(&whole) => Some(whole),
            Ok(_) => self.refuse("the number is out of range", Bounds(&range)),
            Err(_) => self.refuse("expected a whole number", Bounds(&range)),
        }
    }

    /// Returns a string as it is.
    pub fn string(&self) -> Option<&'a str> {
        self.value.as_str().or_else(|| self.expected("a string"))
    }

    /// Reads free text of bounded length, in characters.
    pub fn text(&self, max_chars: usize) -> Option<String> {
        let text = self.string()?;
        if text.len() > max_chars && text.chars().nth(max_chars).is_some() {
            return self.refuse("the text is too long", counted(max_chars, "character"));
        }
        // C strings, and SQLite's own functions, end at a NUL.
        if text.contains('\0') {
            return self.refuse("the text has a NUL character in it", "no U+0000");
        }
        Some(text.to_owned())
    }

    /// A short name for people and programs: not blank, no control characters.
    pub fn name(&self, max_chars: usize) -> Option<String> {
        let name = self.text(max_chars)?;
        if name.trim().is_empty() || name.chars().any(char::is_control) {
            return self.refuse("not a name", format!("1 to {max_chars} printable characters"));
        }
        Some(name)
    }

    /// One of a few names.
    pub fn choice<T>(&self, names: &[&str], from_name: impl FnOnce(&str) -> Option<T>) -> Option<T> {
        let name = self.string()?;
        from_name(name).or_else(|| self.refuse("there is no such value", names.join(", ")))
    }

    /// Returns a list, each item read by `read`; all faults of all items are noted.
    pub fn list<T>(&self, max: usize, mut read: impl FnMut(&Node<'_>) -> Option<T>) -> Option<Vec<T>> {
        let Value::Array(items) = self.value else {
            return self.expected("a list");
        };
        if items.len() > max {
            return self.refuse("the list is too long", counted(max, "item"));
        }
        let mut all = Some(Vec::with_capacity(items.len()));
        for (index, item) in items.iter().enumerate() {
            match (read(&self.child(Step::Index(index), item)), &mut all) {
                (Some(item), Some(list)) => list.push(item),
                (Some(_), None) => {}
                (None, _) => all = None,
            }
        }
        all
    }

    /// Exactly `N` numbers within bounds.
    pub fn numbers<const N: usize>(&self, range: RangeInclusive<f64>) -> Option<[f64; N]> {
        if self.value.as_array().is_some_and(|items| items.len() != N) {
            return self.refuse("the list has another length", format!("{N} numbers"));
        }
        self.list(N, |item| item.number(range.clone()))?.try_into().ok()
    }

    /// Returns an object with these fields and no other; a field more is a fault, for it is most likely a typing error.
    pub fn object<'n>(&'n self, fields: &[&str]) -> Option<Object<'n>> {
        let Value::Object(members) = self.value else {
            return self.expected("an object");
        };
        for name in members.keys().filter(|name| !fields.contains(&name.as_str())) {
            let stray = self.child(Step::Name(name), &members[name]);
            let _: Option<()> = stray.refuse("there is no such field", fields.join(", "));
        }
        Some(Object { node: self, members })
    }
}

/// Reads `true` or `false`.
pub fn switch(node: &Node<'_>) -> Option<bool> {
    node.value.as_bool().or_else(|| node.expected("true or false"))
}

/// Reads an id as clients choose them.
pub fn id<T: FromStr<Err = IdError>>(node: &Node<'_>) -> Option<T> {
    match node.string()?.parse() {
        Ok(id) => Some(id),
        Err(error) => node.refuse(error.to_string(), ID_FORM),
    }
}

/// An object whose fields are read by name.
pub struct Object<'n> {
    node: &'n Node<'n>,
    members: &'n Map<String, Value>,
}

impl Object<'_> {
    /// Returns a field that must be there.
    pub fn required<T>(&self, name: &str, read: impl FnOnce(&Node<'_>) -> Option<T>) -> Option<T> {
        if let Some(value) = self.members.get(name) {
            return read(&self.node.child(Step::Name(name), value));
        }
        self.node
            .child(Step::Name(name), &Value::Null)
            .note(|pointer| FieldError::new(pointer, "the field is required"))
    }

    /// Returns a field that may be left out; the outer `None` says that it is there and wrong.
    pub fn optional<T>(&self, name: &str, read: impl FnOnce(&Node<'_>) -> Option<T>) -> Option<Option<T>> {
        match self.members.get(name) {
            None => Some(None),
            Some(value) => read(&self.node.child(Step::Name(name), value)).map(Some),
        }
    }

    /// Whether the field is there.
    pub fn has(&self, name: &str) -> bool {
        self.members.contains_key(name)
    }

    /// Two lists that run in parallel must be equally long; the second one is told off.
    pub fn parallel(&self, first: &str, second: &str) -> Option<()> {
        let length = |name: &str| self.members.get(name).and_then(Value::as_array).map(Vec::len);
        match (length(first), length(second)) {
            (Some(wanted), Some(got)) if wanted != got => {
                self.node.child(Step::Name(second), &Value::Null).note(|pointer| {
                    FieldError::new(pointer, format!("must be as long as {first}"))
                        .got(counted(got, "item"))
                        .limit(counted(wanted, "item"))
                })
            }
            // A list that is missing or is no list has been told off already.
            _ => Some(()),
        }
    }
}

/// 2^53 and below, where every whole number is an f64 of its own.
fn exactly(number: f64) -> Option<i64> {
    const LARGEST: f64 = 9_007_199_254_740_992.0;
    (number.fract() == 0.0 && number.abs() <= LARGEST).then_some(number as i64)
}
