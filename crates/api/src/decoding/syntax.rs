//! Syntax: bytes become a document, or the place where they stop being JSON.
//!
//! Stricter than JSON readers are as a rule in two ways: a name that appears twice in an object is refused (which of the
//! two did the client mean?), and values and items are counted, because `0,` takes two bytes here and sixteen in memory.

use std::cell::Cell;
use std::collections::HashSet;
use std::fmt;

use revisit_core::domain::invalid::FieldError;
use serde::de::{DeserializeSeed, Deserializer, Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_path_to_error::{Deserializer as Tracked, Segment, Track};

use super::document::{Document, Token};
use super::faults;
use crate::limits::{BODY_VALUES, LIST_ITEMS};

/// The reason why bytes are not a JSON text that we take.
#[derive(Clone, Debug, PartialEq)]
pub enum Unreadable {
    /// They are no JSON, or nested too deep.
    Syntax(FieldError),
    /// They hold too many values or items.
    TooMany(TooMany),
}

/// The kind of thing of which a text has too many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TooMany {
    /// It holds more than [`BODY_VALUES`] values.
    Values,
    /// One of its lists has more than [`LIST_ITEMS`] items.
    Items,
}

/// Members of an object up to which each name is compared with those before it.
const FEW_MEMBERS: usize = 16;

/// Returns a text without the byte order mark of UTF-8, which a reader may ignore (RFC 8259, section 8.1): PowerShell writes it.
pub fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// Returns what to do with a text whose mark is that of UTF-16.
pub fn utf_16(bytes: &[u8]) -> Option<&'static str> {
    let is_marked = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]);
    is_marked.then_some("the text is UTF-16, as PowerShell's `>` writes it; JSON is UTF-8: save it so")
}

/// Parses bytes as one JSON value.
pub fn parse(bytes: &[u8]) -> Result<Document<'_>, Unreadable> {
    let bytes = without_mark(bytes);
    let count = Count::default();
    let mut document = Document::with_room(bytes, tokens_at_most(bytes).min(2 * BODY_VALUES));
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let parsed = Builder { document: &mut document, count: &count }.deserialize(&mut json);
    match (parsed.and_then(|()| json.end()), count.too_many.get()) {
        (Ok(()), _) => Ok(document),
        (Err(_), Some(too_many)) => Err(Unreadable::TooMany(too_many)),
        (Err(_), None) if bytes.trim_ascii().is_empty() => {
            Err(Unreadable::Syntax(FieldError::new("", "the body is empty; an object without fields is {}")))
        }
        (Err(error), None) => Err(Unreadable::Syntax(fault(bytes, &error))),
    }
}

/// Returns an upper bound on the values and names of a text: but for the first, each follows one of these bytes.
pub fn tokens_at_most(bytes: &[u8]) -> usize {
    /// Bytes that one `u8` can count: sums of bytes are what compilers know to add many at a time.
    const COUNTED_AT_ONCE: usize = u8::MAX as usize;
    let starts = |byte: &u8| u8::from(matches!(byte, b',' | b':' | b'[' | b'{'));
    let counts = bytes.chunks(COUNTED_AT_ONCE).map(|chunk| usize::from(chunk.iter().map(starts).sum::<u8>()));
    1 + counts.sum::<usize>()
}

fn fault(bytes: &[u8], error: &serde_json::Error) -> FieldError {
    if let Some(told) = utf_16(bytes) {
        return FieldError::new("", told);
    }
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

/// Returns why bytes are no JSON, if they are none, without holding them as a document if they are.
pub fn check(bytes: &[u8]) -> Result<(), Unreadable> {
    let bytes = without_mark(bytes);
    let read: Result<IgnoredAny, _> = serde_json::from_slice(bytes);
    read.map(drop).map_err(|error| Unreadable::Syntax(fault(bytes, &error)))
}

/// Returns the place where the bytes stop being JSON; found by reading them again, so that good bodies pay nothing for it.
fn place(bytes: &[u8]) -> String {
    let mut track = Track::new();
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let (mut document, count) = (Document::with_room(bytes, 0), Count::default());
    let builder = Builder { document: &mut document, count: &count };
    if builder.deserialize(Tracked::new(&mut json, &mut track)).is_ok() {
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

/// The values of a text so far, and the limit that it exceeds.
#[derive(Default)]
struct Count {
    values: Cell<usize>,
    too_many: Cell<Option<TooMany>>,
}

/// Appends one value to a document, with all that is in it.
struct Builder<'b, 't> {
    document: &'b mut Document<'t>,
    count: &'b Count,
}

/// Appends the name of a member.
struct Name<'b, 't>(Builder<'b, 't>);

impl<'t> Builder<'_, 't> {
    /// Returns a builder of a value inside this one.
    fn inner(&mut self) -> Builder<'_, 't> {
        Builder { document: self.document, count: self.count }
    }

    fn push(self, token: Token) {
        self.document.values.push(token);
    }

    fn refuse<T, E: serde::de::Error>(&self, what: TooMany) -> Result<T, E> {
        self.count.too_many.set(Some(what));
        Err(E::custom("too many"))
    }
}

impl<'t> DeserializeSeed<'t> for Builder<'_, 't> {
    type Value = ();

    fn deserialize<D: Deserializer<'t>>(self, deserializer: D) -> Result<(), D::Error> {
        self.count.values.set(self.count.values.get() + 1);
        if self.count.values.get() > BODY_VALUES {
            return self.refuse(TooMany::Values);
        }
        deserializer.deserialize_any(self)
    }
}

impl<'t> DeserializeSeed<'t> for Name<'_, 't> {
    type Value = ();

    fn deserialize<D: Deserializer<'t>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_str(self.0)
    }
}

impl<'t> Visitor<'t> for Builder<'_, 't> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        self.push(Token::Null);
        Ok(())
    }

    fn visit_bool<E>(self, value: bool) -> Result<(), E> {
        self.push(Token::Bool(value));
        Ok(())
    }

    fn visit_i64<E>(self, value: i64) -> Result<(), E> {
        self.push(Token::Whole(value));
        Ok(())
    }

    fn visit_u64<E>(self, value: u64) -> Result<(), E> {
        self.push(i64::try_from(value).map_or(Token::Large(value), Token::Whole));
        Ok(())
    }

    fn visit_f64<E>(self, value: f64) -> Result<(), E> {
        self.push(Token::Float(value));
        Ok(())
    }

    fn visit_borrowed_str<E>(self, value: &'t str) -> Result<(), E> {
        let token = self.document.text_in_place(value);
        self.push(token);
        Ok(())
    }

    fn visit_str<E>(self, value: &str) -> Result<(), E> {
        let token = self.document.unescaped_text(value);
        self.push(token);
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'t>>(mut self, mut list: A) -> Result<(), A::Error> {
        let (at, mut items) = (self.document.open(), 0);
        while list.next_element_seed(self.inner())?.is_some() {
            items += 1;
            if items > LIST_ITEMS {
                return self.refuse(TooMany::Items);
            }
        }
        self.document.close(at, items, |items, end| Token::List { items, end });
        Ok(())
    }

    fn visit_map<A: MapAccess<'t>>(mut self, mut object: A) -> Result<(), A::Error> {
        let (at, mut names) = (self.document.open(), Vec::new());
        while object.next_key_seed(Name(self.inner()))?.is_some() {
            names.push(self.document.values.len() - 1);
            object.next_value_seed(self.inner())?;
        }
        self.document.close(at, names.len(), |members, end| Token::Object { members, end });
        match repeated(self.document, &names) {
            None => Ok(()),
            Some(name) => {
                let name: String = name.chars().take(80).collect();
                Err(A::Error::custom(format_args!("the name {name:?} appears twice in one object")))
            }
        }
    }
}

/// Returns a name that stands at two of these places.
fn repeated<'d>(document: &'d Document<'_>, names: &[usize]) -> Option<&'d str> {
    let name = |at: &usize| document.text_at(*at).unwrap_or_default();
    if names.len() > FEW_MEMBERS {
        let mut seen = HashSet::with_capacity(names.len());
        return names.iter().map(name).find(|name| !seen.insert(*name));
    }
    let is_before = |place: usize| names[..place].iter().any(|other| name(other) == name(&names[place]));
    (0..names.len()).find(|place| is_before(*place)).map(|place| name(&names[place]))
}

#[cfg(test)]
mod tests {
    use super::super::document::Kind;
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
        let read = parse(json.as_bytes()).expect("JSON");
        let (list, object) =
            (read.root().get("a").expect("a list"), read.root().get("b").expect("an object"));
        let items: Vec<_> =
            list.items().map(|item| (item.as_number(), item.as_str(), item.as_bool())).collect();
        let number = |number: f64| (serde_json::Number::from_f64(number), None, None);
        let expected = [
            (Some(1.into()), None, None),
            (Some((-2).into()), None, None),
            number(3.5),
            (None, Some("x"), None),
            (None, None, None),
            (None, None, Some(true)),
        ];
        assert_eq!(items, expected);
        assert!(object.kind() == Kind::Object && object.is_empty());
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
    fn long_lists_and_many_values_are_too_many() {
        let list = format!("[{}0]", "0,".repeat(LIST_ITEMS));
        assert_eq!(parse(list.as_bytes()).err(), Some(Unreadable::TooMany(TooMany::Items)));
        let row = format!("[{}0],", "0,".repeat(999));
        let many = format!("[{}0]", row.repeat(BODY_VALUES / 1000));
        assert_eq!(parse(many.as_bytes()).err(), Some(Unreadable::TooMany(TooMany::Values)));
    }

    #[test]
    fn as_many_values_as_are_counted_have_room() {
        for json in [r#"{"a":[1,[],{}],"b,:[{":"x,y"}"#, "[]", "7", r#"{"a":{"b":{"c":null}}}"#] {
            let values = parse(json.as_bytes()).expect("JSON").values.len();
            assert!(values <= tokens_at_most(json.as_bytes()), "{json}: {values}");
        }
    }
}
