//! Syntax: bytes become a JSON value, or the place where they stop being JSON.
//!
//! Stricter than `serde_json::Value` in two ways: a name that appears twice in an object is refused (which of the two
//! did the client mean?), and the number of values is bounded, because `0,` takes two bytes here and thirty in memory.

use std::cell::Cell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use serde_path_to_error::{Deserializer as Tracked, Segment, Track};

use super::faults;
use crate::api::limits::BODY_VALUES;
use crate::domain::invalid::FieldError;

/// Why bytes are not a JSON value that we take.
#[derive(Clone, Debug, PartialEq)]
pub enum Unreadable {
    /// They are no JSON, or nested too deep.
    Syntax(FieldError),
    /// They hold more than [`BODY_VALUES`] values.
    TooManyValues,
}

/// Parses bytes as one JSON value.
pub fn parse(bytes: &[u8]) -> Result<Value, Unreadable> {
    let left = Cell::new(BODY_VALUES);
    let mut json = serde_json::Deserializer::from_slice(bytes);
    match (Tree { left: &left }).deserialize(&mut json).and_then(|value| json.end().map(|()| value)) {
        Ok(value) => Ok(value),
        Err(_) if left.get() == 0 => Err(Unreadable::TooManyValues),
        Err(_) if bytes.trim_ascii().is_empty() => {
            Err(Unreadable::Syntax(FieldError::new("", "the body is empty; an object without fields is {}")))
        }
        Err(error) => Err(Unreadable::Syntax(fault(bytes, &error))),
    }
}

fn fault(bytes: &[u8], error: &serde_json::Error) -> FieldError {
    let place = place(bytes);
    let Some(name) = not_a_number(bytes, error) else { return FieldError::new(place, error.to_string()) };
    let (line, column) = (error.line(), error.column());
    let detail = format!("{name} is not JSON, which has finite numbers only, at line {line} column {column}");
    FieldError::new(place, detail).got(name).limit("a finite number, or leave the field out")
}

/// Returns what stands where a value was expected, if it is a number that is none: Python's `json.dumps` writes `NaN`,
/// `Infinity` and `-Infinity`, and C's `printf` writes `nan` and `inf`.
fn not_a_number<'b>(bytes: &'b [u8], error: &serde_json::Error) -> Option<&'b str> {
    /// The longest is `-Infinity`.
    const LONGEST: usize = 9;
    let line = bytes.split(|byte| *byte == b'\n').nth(error.line().checked_sub(1)?)?;
    let at = error.column().saturating_sub(1).min(line.len());
    let is_part = |byte: &u8| byte.is_ascii_alphabetic() || matches!(byte, b'-' | b'+');
    let before = line[..at].iter().rev().take(LONGEST).take_while(|byte| is_part(byte)).count();
    let after = line[at..].iter().take(LONGEST).take_while(|byte| is_part(byte)).count();
    let word = std::str::from_utf8(&line[at - before..at + after]).ok()?;
    let name = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
    ["nan", "inf", "infinity"].contains(&name.as_str()).then_some(word)
}

/// Where the bytes stop being JSON; found by reading them again, so that good bodies pay nothing for it.
fn place(bytes: &[u8]) -> String {
    let mut track = Track::new();
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let left = Cell::new(BODY_VALUES);
    if (Tree { left: &left }).deserialize(Tracked::new(&mut json, &mut track)).is_ok() {
        return String::new();
    }
    let path = track.path();
    let segments: Vec<String> = path
        .iter()
        .filter_map(|segment| match segment {
            Segment::Seq { index } => Some(index.to_string()),
            Segment::Map { key } => Some(key.clone()),
            Segment::Enum { .. } | Segment::Unknown => None,
        })
        .collect();
    faults::pointer(segments.iter().map(String::as_str))
}

/// Reads any JSON value; `left` is how many more it may hold.
#[derive(Clone, Copy)]
struct Tree<'l> {
    left: &'l Cell<usize>,
}

impl<'de> DeserializeSeed<'de> for Tree<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        let left = self.left.get().checked_sub(1).ok_or_else(|| D::Error::custom("too many values"))?;
        self.left.set(left);
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Tree<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_string<E>(self, value: String) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        while let Some(item) = items.next_element_seed(self)? {
            list.push(item);
        }
        Ok(Value::Array(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some(name) = members.next_key::<String>()? {
            let value = members.next_value_seed(self)?;
            if object.contains_key(&name) {
                let name: String = name.chars().take(80).collect();
                return Err(A::Error::custom(format_args!("the name {name:?} appears twice in one object")));
            }
            object.insert(name, value);
        }
        Ok(Value::Object(object))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(json: &str, pointer: &str, says: &str) {
        match parse(json.as_bytes()) {
            Err(Unreadable::Syntax(error)) => {
                assert_eq!(error.pointer, pointer, "{json}");
                assert!(error.detail.contains(says), "{json}: {}", error.detail);
            }
            other => panic!("{json}: {other:?}"),
        }
    }

    #[test]
    fn a_value_comes_through_as_it_is() {
        let json = r#"{"a":[1,-2,3.5,"x",null,true],"b":{}}"#;
        assert_eq!(parse(json.as_bytes()), Ok(serde_json::from_str(json).expect("JSON")));
    }

    #[test]
    fn what_is_no_json_is_told_with_its_place() {
        check(r#"{"stamp":{"sec":NaN}}"#, "/stamp/sec", "NaN is not JSON");
        check(r#"{"stamp":{"sec":NaN}}"#, "/stamp/sec", "line 1 column 17");
        check("{\"a\":\n[0,\n -Infinity]}", "/a/1", "-Infinity is not JSON");
        for word in ["Infinity", "nan", "-nan", "inf", "-inf", "+Inf"] {
            check(&format!(r#"{{"a":[0,{word}]}}"#), "/a/1", &format!("{word} is not JSON"));
        }
        check("NaN", "", "NaN is not JSON");
        check(r#"{"a":None}"#, "/a", "expected value");
        check(r#"{"a":[0,1e400]}"#, "/a/1", "number out of range");
        check(r#"{"a":1,"a":2}"#, "", "\"a\" appears twice");
        check("{} {}", "", "trailing characters");
        check("", "", "the body is empty");
        check(" \n", "", "the body is empty");
        check("[", "", "EOF");
        check(&"[".repeat(1_000_000), &"/0".repeat(127), "recursion limit");
    }

    #[test]
    fn more_values_than_fit_are_too_many() {
        let many = format!("[{}0]", "0,".repeat(BODY_VALUES));
        assert_eq!(parse(many.as_bytes()), Err(Unreadable::TooManyValues));
    }
}
