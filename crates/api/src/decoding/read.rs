//! Reader: walks a JSON value and notes every fault in it, each with its place, instead of stopping at the first.
//!
//! serde stops at the first error, and a client that fixes its bodies one error at a time is a client that curses.
//! So a body becomes a [`Document`] first, and this reader takes the model out of it. Each method returns `None` after
//! it noted a fault; callers read all fields before they give up on any.

use std::collections::HashSet;
use std::fmt::Display;
use std::hash::Hash;
use std::ops::RangeInclusive;
use std::str::FromStr;

use revisit_core::domain::counted::counted;
use revisit_core::domain::ids::{ID_FORM, IdError};
use revisit_core::domain::invalid::FieldError;

use super::column::{Column, Packed};
use super::document::{Document, Json, Kind};
use super::faults::{Faults, kind, push_segment, shown};

/// What can be read from a JSON body.
pub trait Decode: Sized {
    /// Reads it; `None` if faults were noted.
    fn decode(node: &Node<'_>) -> Option<Self>;
}

/// An object whose members are read one by one: a shape of [`revisit_shapes`].
pub trait Members: Sized {
    /// Returns their names.
    fn names() -> Vec<&'static str>;

    /// Reads them; `None` if faults were noted.
    fn read(object: &Object<'_>) -> Option<Self>;
}

/// The parameters of a request whose query has those of both.
impl<A: Members, B: Members> Decode for (A, B) {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let object = node.object(&[A::names(), B::names()].concat())?;
        // The page comes first in the list of faults.
        let (b, a) = (B::read(&object), A::read(&object));
        Some((a?, b?))
    }
}

/// Reads an object with these members and no others.
pub fn members<T: Members>(node: &Node<'_>) -> Option<T> {
    T::read(&node.object(&T::names())?)
}

/// Reads a document, or tells every fault in it.
pub fn decode<T: Decode>(document: &Document<'_>) -> Result<T, Vec<FieldError>> {
    decode_with(document.root(), T::decode)
}

/// Reads a value by a function of its own, or tells every fault in it.
pub fn decode_with<T>(
    value: Json<'_>,
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
    /// Into a string that packs a list; the next steps have no pointer.
    Unpacked,
}

/// One value in the body and the way that leads to it.
pub struct Node<'a> {
    value: Json<'a>,
    // The way is a list through the callers' stack frames, spelled out only when there is a fault to tell.
    parent: Option<&'a Node<'a>>,
    step: Step<'a>,
    faults: &'a Faults,
}

impl<'a> Node<'a> {
    /// Returns the value itself.
    pub fn value(&self) -> Json<'a> {
        self.value
    }

    fn child<'c>(&'c self, step: Step<'c>, value: Json<'c>) -> Node<'c> {
        Node { value, parent: Some(self), step, faults: self.faults }
    }

    /// Writes the JSON pointer (RFC 6901) of this value, and its place within a packed list, which a pointer cannot name.
    fn spell(&self, pointer: &mut String, packed: &mut Option<String>) {
        if let Some(parent) = self.parent {
            parent.spell(pointer, packed);
        }
        let to = packed.as_mut().unwrap_or(pointer);
        match self.step {
            Step::Root => {}
            Step::Name(name) => push_segment(to, name),
            Step::Index(index) => push_segment(to, &index.to_string()),
            Step::Unpacked => *packed = Some(String::new()),
        }
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
        self.faults.note(|| {
            let (mut pointer, mut packed) = (String::new(), None);
            self.spell(&mut pointer, &mut packed);
            let fault = fault(pointer);
            match packed {
                Some(place) if !place.is_empty() => {
                    FieldError { detail: format!("item {}: {}", &place[1..], fault.detail), ..fault }
                }
                _ => fault,
            }
        });
        None
    }

    /// Notes that this value is of another kind.
    pub(super) fn expected<T>(&self, what: &str) -> Option<T> {
        self.refuse(format!("expected {what}, not {}", kind(self.value)), what)
    }

    /// Notes a fault of a member of this object.
    pub fn refuse_member<T>(&self, name: &str, detail: impl Into<String>, limit: impl Display) -> Option<T> {
        self.child(Step::Name(name), self.value.get(name).unwrap_or(self.value)).refuse(detail, limit)
    }

    /// Returns a list, each item read by `read`; all faults of all items are noted.
    pub fn list<T>(&self, max: usize, mut read: impl FnMut(&Node<'_>) -> Option<T>) -> Option<Vec<T>> {
        let mut list = Vec::with_capacity(self.value.len().min(max));
        self.each(max, |_, item| {
            list.push(read(item)?);
            Some(())
        })?;
        Some(list)
    }

    /// Returns a list of at least and at most so many items.
    pub fn some_of<T>(
        &self,
        range: RangeInclusive<usize>,
        read: impl FnMut(&Node<'_>) -> Option<T>,
    ) -> Option<Vec<T>> {
        let list = self.list(*range.end(), read)?;
        if list.len() < *range.start() {
            return self.refuse("the list is empty", format!("{} to {} items", range.start(), range.end()));
        }
        Some(list)
    }

    /// Reads a list in which nothing may be twice; the second one is a fault.
    pub fn unique<T: Clone + Ord + Hash>(
        &self,
        max: usize,
        mut read: impl FnMut(&Node<'_>) -> Option<T>,
    ) -> Option<Vec<T>> {
        let mut list: Vec<T> = Vec::with_capacity(self.value.len().min(max));
        // Ascending lists, which is what most clients send, need no set.
        let mut seen = None;
        self.each(max, |_, item| {
            let value = read(item)?;
            if seen.is_some() || list.last().is_some_and(|last| *last >= value) {
                let seen = seen.get_or_insert_with(|| list.iter().cloned().collect::<HashSet<T>>());
                if !seen.insert(value.clone()) {
                    return item.refuse("listed twice", "each one once");
                }
            }
            list.push(value);
            Some(())
        })?;
        Some(list)
    }

    /// Reads exactly `N` numbers within bounds.
    pub fn numbers<const N: usize>(&self, range: RangeInclusive<f64>) -> Option<[f64; N]> {
        if self.value.kind() == Kind::List && self.value.len() != N {
            return self.refuse("the list has another length", format!("{N} numbers"));
        }
        let mut numbers = [0.0; N];
        self.each(N, |at, item| {
            numbers[at] = item.number(range.clone())?;
            Some(())
        })?;
        Some(numbers)
    }

    /// Reads each item of a list by `read`, with its place; all faults of all items are noted.
    pub fn each(&self, max: usize, mut read: impl FnMut(usize, &Node<'_>) -> Option<()>) -> Option<()> {
        if self.value.kind() != Kind::List {
            return self.expected("a list");
        }
        if self.value.len() > max {
            return self.refuse("the list is too long", counted(max, "item"));
        }
        let mut all = Some(());
        for (index, item) in self.value.items().enumerate() {
            if read(index, &self.child(Step::Index(index), item)).is_none() {
                all = None;
            }
        }
        all
    }

    /// Returns an object with these fields and no other; a field more is a fault, for it is most likely a typing error.
    pub fn object<'n>(&'n self, fields: &[&str]) -> Option<Object<'n>> {
        if self.value.kind() != Kind::Object {
            return self.expected("an object");
        }
        for (name, value) in self.value.members().filter(|(name, _)| !fields.contains(name)) {
            let stray = self.child(Step::Name(name), value);
            let _: Option<()> = stray.refuse("there is no such field", fields.join(", "));
        }
        Some(Object { node: self })
    }
}

/// Reads `true` or `false`.
pub fn switch(node: &Node<'_>) -> Option<bool> {
    node.value.as_bool().or_else(|| node.expected("true or false"))
}

/// Reads `true` or `false` where it is written as a text.
pub fn written_switch(node: &Node<'_>) -> Option<bool> {
    node.choice(&["true", "false"], |text| text.parse().ok())
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
}

impl Object<'_> {
    /// Returns a field that must be there.
    pub fn required<T>(&self, name: &str, read: impl FnOnce(&Node<'_>) -> Option<T>) -> Option<T> {
        if let Some(value) = self.node.value.get(name) {
            return read(&self.node.child(Step::Name(name), value));
        }
        self.note(name, |pointer| FieldError::new(pointer, "the field is required"))
    }

    /// Returns a field that may be left out; the outer `None` says that it is there and wrong.
    pub fn optional<T>(&self, name: &str, read: impl FnOnce(&Node<'_>) -> Option<T>) -> Option<Option<T>> {
        match self.node.value.get(name) {
            None => Some(None),
            Some(value) => read(&self.node.child(Step::Name(name), value)).map(Some),
        }
    }

    /// Whether the field is there.
    pub fn has(&self, name: &str) -> bool {
        self.node.value.get(name).is_some()
    }

    /// Reads a column, in whichever form it has, as [`Self::optional`] does.
    pub fn optional_column<T>(
        &self,
        column: Column,
        read: impl FnOnce(&Node<'_>) -> Option<T>,
    ) -> Option<Option<T>> {
        let packed = column.packed.and_then(|packed| Some((packed, self.node.value.get(packed.name)?)));
        let Some((packed, value)) = packed else {
            return self.optional(column.list, read);
        };
        let node = self.node.child(Step::Name(packed.name), value);
        if self.has(column.list) {
            return node.note(|pointer| {
                FieldError::new(pointer, format!("{} has the same numbers, as a list", column.list))
                    .limit("one of the two forms")
            });
        }
        let bytes = node.bytes()?;
        let Some(list) = packed.unpack(&bytes) else {
            let limit = format!("{} bytes for each item", packed.item_bytes());
            return node.refuse_as("the last item is not whole", format!("{} bytes", bytes.len()), limit);
        };
        read(&node.child(Step::Unpacked, list.root())).map(Some)
    }

    /// Reads a column that must be there.
    pub fn required_column<T>(&self, column: Column, read: impl FnOnce(&Node<'_>) -> Option<T>) -> Option<T> {
        if column.packed.is_some_and(|packed| self.has(packed.name)) {
            self.optional_column(column, read)?
        } else {
            self.required(column.list, read)
        }
    }

    /// Checks that two columns that run in parallel are equally long; the second one is told off.
    pub fn parallel(&self, first: Column, second: Column) -> Option<()> {
        let form = |column: Column| {
            let text = |packed: Packed| self.node.value.get(packed.name)?.as_str();
            if let Some((packed, text)) = column.packed.and_then(|packed| Some((packed, text(packed)?))) {
                return Some((packed.name, packed.item_count(text)));
            }
            let list = self.node.value.get(column.list).filter(|value| value.kind() == Kind::List)?;
            Some((column.list, list.len()))
        };
        match (form(first), form(second)) {
            (Some((first, wanted)), Some((second, got))) if wanted != got => self.note(second, |pointer| {
                FieldError::new(pointer, format!("must be as long as {first}"))
                    .got(counted(got, "item"))
                    .limit(counted(wanted, "item"))
            }),
            // A list that is missing or is no list has been told off already.
            _ => Some(()),
        }
    }

    /// Notes a fault at a field, whether it is there or not.
    fn note<T>(&self, name: &str, fault: impl FnOnce(String) -> FieldError) -> Option<T> {
        self.node.child(Step::Name(name), self.node.value).note(fault)
    }
}
