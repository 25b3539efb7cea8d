//! Scalars read: numbers within bounds, texts of bounded length, names, bytes.

use std::ops::RangeInclusive;

use revisit_core::domain::counted::counted;

use super::base64;
use super::faults::Bounds;
use super::read::Node;

impl<'a> Node<'a> {
    /// Reads a number within bounds. JSON has no NaN and no infinity, and the bounds keep both out of any sum. Zero has one
    /// form: SQLite keeps no sign of a zero, so `-0.0` would be answered as `0.0` after a restart.
    pub fn number(&self, range: RangeInclusive<f64>) -> Option<f64> {
        let Some(number) = self.value().as_f64() else {
            return self.expected("a number");
        };
        if range.contains(&number) {
            return Some(number + 0.0);
        }
        self.refuse("the number is out of range", Bounds(&range))
    }

    /// Returns a whole number within bounds; `5.0` is one too, as JSON knows one kind of number only.
    pub fn whole(&self, range: RangeInclusive<i64>) -> Option<i64> {
        let Some(number) = self.value().as_f64() else {
            return self.expected("a whole number");
        };
        let whole = self.value().as_i64().or_else(|| exactly(number));
        match whole {
            Some(whole) if range.contains(&whole) => Some(whole),
            None if number.fract() != 0.0 => self.refuse("expected a whole number", Bounds(&range)),
            // An unsigned hash of 64 bits, as it is or as it comes out of a signed one.
            _ if *range.end() == i64::MAX => self.refuse(
                "the number is out of range: it takes 63 bits; of an id of 64 send `id & 0x7fffffffffffffff`",
                Bounds(&range),
            ),
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
        self.value().as_str().or_else(|| self.expected("a string"))
    }

    /// Reads the bytes of a string of base64.
    pub fn bytes(&self) -> Option<Vec<u8>> {
        match base64::decode(self.string()?) {
            Ok(bytes) => Some(bytes),
            Err(why) => self.refuse(format!("not base64: {why}"), "A-Z a-z 0-9 + / and padding with ="),
        }
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

    /// Reads the name of one of a few values.
    pub fn one_of<T: Copy, const N: usize>(&self, values: [(&str, T); N]) -> Option<T> {
        let find = |wanted: &str| values.iter().find(|(name, _)| *name == wanted).map(|(_, value)| *value);
        self.choice(&values.map(|(name, _)| name), find)
    }
}

/// 2^53 and below, where every whole number is an f64 of its own.
fn exactly(number: f64) -> Option<i64> {
    const LARGEST: f64 = 9_007_199_254_740_992.0;
    (number.fract() == 0.0 && number.abs() <= LARGEST).then_some(number as i64)
}
