//! Column: a long list of numbers, sent as a list or packed.
//!
//! Packed is base64 of little-endian numbers. Both forms are read by the same function, so that the same values make the
//! same facts and the same faults.

use super::document::{Document, Token};

/// A column and its two forms.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// The field with a list.
    pub list: &'static str,
    /// The field with packed numbers, if it may be packed.
    pub packed: Option<Packed>,
}

/// The packed form of a column.
#[derive(Clone, Copy, Debug)]
pub struct Packed {
    /// The field's name.
    pub name: &'static str,
    /// The type of its numbers.
    pub number: Number,
    /// The number of them in an item; none if an item is a number itself.
    pub row: Option<usize>,
}

/// A type of packed numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    /// Unsigned, 32 bits.
    U32,
    /// Signed, 64 bits.
    I64,
    /// Floating point, 32 bits.
    F32,
    /// Floating point, 64 bits.
    F64,
}

impl Number {
    const fn bytes(self) -> usize {
        match self {
            Self::U32 | Self::F32 => 4,
            Self::I64 | Self::F64 => 8,
        }
    }

    fn token(self, bytes: &[u8]) -> Token {
        let mut wide = [0; 8];
        wide[..bytes.len()].copy_from_slice(bytes);
        let [a, b, c, d, ..] = wide;
        match self {
            Self::U32 => Token::Whole(u32::from_le_bytes([a, b, c, d]).into()),
            Self::I64 => Token::Whole(i64::from_le_bytes(wide)),
            Self::F32 => Token::Float(f32::from_le_bytes([a, b, c, d]).into()),
            Self::F64 => Token::Float(f64::from_le_bytes(wide)),
        }
    }
}

impl Packed {
    /// Returns the packed bytes of an item.
    pub(super) fn item_bytes(self) -> usize {
        self.number.bytes() * self.row.unwrap_or(1)
    }

    /// Returns how many items a string of base64 packs, as far as its length tells.
    pub(super) fn item_count(self, text: &str) -> usize {
        text.trim_end_matches('=').len() * 3 / 4 / self.item_bytes()
    }

    /// Returns the list that packed numbers stand for; `None` if the last item is not whole.
    pub(super) fn unpack(self, bytes: &[u8]) -> Option<Document<'static>> {
        let items = bytes.chunks_exact(self.item_bytes());
        if !items.remainder().is_empty() {
            return None;
        }
        let count = items.len();
        let mut list = Document::with_room(&[], 1 + count * (1 + self.row.unwrap_or(0)));
        let start = list.open();
        for item in items {
            let numbers = item.chunks_exact(self.number.bytes()).map(|number| self.number.token(number));
            if self.row.is_none() {
                list.values.extend(numbers);
                continue;
            }
            let row = list.open();
            list.values.extend(numbers);
            // A list may leave out its last number; here it is not a number.
            if matches!(list.values.last(), Some(Token::Float(last)) if last.is_nan()) {
                list.values.pop();
            }
            list.close(row, list.values.len() - row - 1, |items, end| Token::List { items, end });
        }
        list.close(start, count, |items, end| Token::List { items, end });
        Some(list)
    }
}
