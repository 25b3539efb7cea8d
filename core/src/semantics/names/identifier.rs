//! An identifier: a number or code as it stands in a text, with the word that tells what it numbers.

use crate::semantics::lexicon::role::Role;

/// A number or code read in a text, with what it numbers.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Identifier {
    /// What it numbers.
    pub role: Role,
    /// Canonical form: upper case, no leading zeros: `901`, `B1-3`. Equal values are equal identifiers.
    pub value: String,
    written: String,
}

impl Identifier {
    /// `code` as written, letters and digits with separators.
    pub(in crate::semantics) fn new(role: Role, code: &str) -> Identifier {
        let written = code.to_uppercase();
        let value = canonical(&written);
        Identifier { role, value, written }
    }

    /// A code, which is compared as it is.
    pub(in crate::semantics) fn exactly(code: &str) -> Identifier {
        Identifier { role: Role::Neutral, value: code.to_owned(), written: code.to_owned() }
    }

    /// As people write it: `901`, `B1-03`.
    pub fn as_str(&self) -> &str {
        &self.written
    }

    /// Returns the digits before the first separator, if there is one: the floor of "9.02".
    pub fn first_part(&self) -> Option<&str> {
        let (first, rest) = self.written.split_once(['.', '-', ':', '/'])?;
        let is_number = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
        (is_number(first) && rest.starts_with(|c: char| c.is_ascii_digit())).then_some(first)
    }

    /// As people say it, with the role: `room 901`.
    pub fn phrase(&self) -> String {
        format!("{} {}", self.role.as_str(), self.written).trim_start().to_owned()
    }
}

/// Strips the leading zeros of each hyphenated part, and the hyphen after a letter: A-01 is A1.
fn canonical(written: &str) -> String {
    let mut value = String::with_capacity(written.len());
    for part in written.split('-') {
        if value.ends_with(|c: char| c.is_ascii_digit())
            || (!value.is_empty() && !part.starts_with(|c: char| c.is_ascii_digit()))
        {
            value.push('-');
        }
        let letters = part.find(|c: char| !c.is_alphabetic()).unwrap_or(part.len());
        let (letters, number) = part.split_at(letters);
        let zeros = number.bytes().take_while(|b| *b == b'0').count();
        let keep_one = !number[zeros..].starts_with(|c: char| c.is_ascii_digit());
        value.push_str(letters);
        value.push_str(&number[zeros - usize::from(keep_one && zeros > 0)..]);
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn canonical_values_lose_leading_zeros_part_by_part() {
        for (written, value) in [
            ("B1-03", "B1-3"),
            ("04", "4"),
            ("0", "0"),
            ("A-01", "A1"),
            ("15.02", "15.02"),
            ("0.5", "0.5"),
            ("000", "0"),
        ] {
            assert_eq!(canonical(written), value, "{written}");
        }
    }
}
