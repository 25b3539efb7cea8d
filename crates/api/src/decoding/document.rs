//! Document: a JSON text, parsed into one list of values.
//!
//! A tree of JSON values owns every name and every text, and takes an allocation for each: for a keyframe with 7,000
//! numbers that was a quarter of a PUT. Here a value is 16 bytes in one list, in the order of the text, and strings stay
//! in the text.

use serde_json::Number;

/// A parsed JSON text.
#[derive(Debug)]
pub struct Document<'t> {
    pub(super) text: &'t [u8],
    /// The values, and the names of members, each before its value.
    pub(super) values: Vec<Token>,
    /// Strings that the text spells with escapes, as they read.
    pub(super) unescaped: String,
}

/// One value, or one name. Those inside a list or an object follow it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Token {
    Null,
    Bool(bool),
    Whole(i64),
    /// Above what an `i64` holds.
    Large(u64),
    Float(f64),
    /// Bytes of the text.
    Text {
        at: u32,
        bytes: u32,
    },
    /// Bytes of `unescaped`.
    Unescaped {
        at: u32,
        bytes: u32,
    },
    List {
        items: u32,
        end: u32,
    },
    Object {
        members: u32,
        end: u32,
    },
}

impl<'t> Document<'t> {
    /// Creates a document without a value, and with room for some.
    pub(super) fn with_room(text: &'t [u8], values: usize) -> Self {
        Self { text, values: Vec::with_capacity(values), unescaped: String::new() }
    }

    /// Returns the outermost value.
    pub fn root(&self) -> Json<'_> {
        Json { document: self, at: 0 }
    }

    fn token(&self, at: usize) -> Token {
        self.values.get(at).copied().unwrap_or(Token::Null)
    }

    /// Returns the string, or the name, at a place.
    pub(super) fn text_at(&self, at: usize) -> Option<&str> {
        let range = |at: u32, bytes: u32| at as usize..at as usize + bytes as usize;
        match self.token(at) {
            // The parser has seen that it is UTF-8.
            Token::Text { at, bytes } => std::str::from_utf8(self.text.get(range(at, bytes))?).ok(),
            Token::Unescaped { at, bytes } => self.unescaped.get(range(at, bytes)),
            _ => None,
        }
    }

    /// Returns the place after a value and all that is in it.
    fn after(&self, at: usize) -> usize {
        match self.token(at) {
            Token::List { end, .. } | Token::Object { end, .. } => end as usize,
            _ => at + 1,
        }
    }
}

/// A value of a document.
#[derive(Clone, Copy, Debug)]
pub struct Json<'d> {
    document: &'d Document<'d>,
    at: usize,
}

/// The kind of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `null`.
    Null,
    /// `true` or `false`.
    Bool,
    /// A number.
    Number,
    /// A string.
    Text,
    /// A list.
    List,
    /// An object.
    Object,
}

impl<'d> Json<'d> {
    fn token(self) -> Token {
        self.document.token(self.at)
    }

    /// Returns its kind.
    pub fn kind(self) -> Kind {
        match self.token() {
            Token::Null => Kind::Null,
            Token::Bool(_) => Kind::Bool,
            Token::Whole(_) | Token::Large(_) | Token::Float(_) => Kind::Number,
            Token::Text { .. } | Token::Unescaped { .. } => Kind::Text,
            Token::List { .. } => Kind::List,
            Token::Object { .. } => Kind::Object,
        }
    }

    /// Returns `true` or `false`.
    pub fn as_bool(self) -> Option<bool> {
        if let Token::Bool(value) = self.token() { Some(value) } else { None }
    }

    /// Returns a number as the nearest float.
    pub fn as_f64(self) -> Option<f64> {
        match self.token() {
            Token::Whole(number) => Some(number as f64),
            Token::Large(number) => Some(number as f64),
            Token::Float(number) => Some(number),
            _ => None,
        }
    }

    /// Returns a whole number that was written as one.
    pub fn as_i64(self) -> Option<i64> {
        if let Token::Whole(number) = self.token() { Some(number) } else { None }
    }

    /// Returns a number as JSON writes it.
    pub fn as_number(self) -> Option<Number> {
        match self.token() {
            Token::Whole(number) => Some(number.into()),
            Token::Large(number) => Some(number.into()),
            Token::Float(number) => Number::from_f64(number),
            _ => None,
        }
    }

    /// Returns a string.
    pub fn as_str(self) -> Option<&'d str> {
        self.document.text_at(self.at)
    }

    /// Returns how many items a list has, or members an object.
    pub fn len(self) -> usize {
        match self.token() {
            Token::List { items: count, .. } | Token::Object { members: count, .. } => count as usize,
            _ => 0,
        }
    }

    /// Whether it is no list and no object, or one with nothing in it.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Returns the items of a list; none of anything else.
    pub fn items(self) -> impl Iterator<Item = Self> + use<'d> {
        let items = if self.kind() == Kind::List { self.len() } else { 0 };
        let mut at = self.at + 1;
        (0..items).map(move |_| {
            let item = Self { document: self.document, at };
            at = self.document.after(at);
            item
        })
    }

    /// Returns the members of an object, in the order of the text; none of anything else.
    pub fn members(self) -> impl Iterator<Item = (&'d str, Self)> + use<'d> {
        let members = if self.kind() == Kind::Object { self.len() } else { 0 };
        let mut at = self.at + 1;
        (0..members).map(move |_| {
            let name = self.document.text_at(at).unwrap_or_default();
            let value = Self { document: self.document, at: at + 1 };
            at = self.document.after(at + 1);
            (name, value)
        })
    }

    /// Returns a member of an object.
    pub fn get(self, name: &str) -> Option<Self> {
        self.members().find(|(of, _)| *of == name).map(|(_, value)| value)
    }
}

impl Document<'_> {
    /// Creates a document of an object whose members are strings, as parameters of a query are.
    pub fn of_texts(members: &[(String, String)]) -> Self {
        let mut document = Self::with_room(&[], 1 + 2 * members.len());
        let at = document.open();
        for text in members.iter().flat_map(|(name, text)| [name, text]) {
            let token = document.unescaped_text(text);
            document.values.push(token);
        }
        document.close(at, members.len(), |members, end| Token::Object { members, end });
        document
    }

    /// Returns a string that stands in the text as it reads, found by its address.
    pub(super) fn text_in_place(&mut self, text: &str) -> Token {
        let at = text.as_ptr().addr().checked_sub(self.text.as_ptr().addr());
        match at.filter(|at| at + text.len() <= self.text.len()) {
            Some(at) => Token::Text { at: at as u32, bytes: text.len() as u32 },
            None => self.unescaped_text(text),
        }
    }

    /// Keeps a string that does not stand in the text as it reads.
    pub(super) fn unescaped_text(&mut self, text: &str) -> Token {
        let at = self.unescaped.len() as u32;
        self.unescaped.push_str(text);
        Token::Unescaped { at, bytes: text.len() as u32 }
    }

    /// Begins a list or an object, and returns its place.
    pub(super) fn open(&mut self) -> usize {
        self.values.push(Token::Null);
        self.values.len() - 1
    }

    /// Ends the list or object that begins at a place.
    pub(super) fn close(&mut self, at: usize, count: usize, token: impl FnOnce(u32, u32) -> Token) {
        self.values[at] = token(count as u32, self.values.len() as u32);
    }
}
