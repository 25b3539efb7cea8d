//! A name: all its parts in order, with the digits as they are grouped.

use crate::semantics::lexicon::stable_hash::hash;
use crate::semantics::names::spelling::latin_capitals;

/// Parts kept of one name. What follows is one part more, so that nothing is left out and comparing two hostile texts stays
/// cheap.
pub const PARTS_MAX: usize = 48;

/// Kinds of parts. A part is held against parts of its own kind only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PartKind {
    /// A group of digits.
    Digits,
    /// One letter.
    Letter,
    /// Two letters or more.
    Word,
    /// A code, which is compared exactly.
    Code,
}

/// A part of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Letters or digits.
    pub kind: PartKind,
    /// Latin capitals, or digits without leading zeros.
    pub text: Box<str>,
}

/// A name of one object, or of one part of a building.
#[derive(Clone, Debug)]
pub struct Name {
    parts: Vec<Part>,
    /// The parts with the marks between groups of digits. Equal keys are equal names.
    key: Box<str>,
    /// The key with leading zeros, in lower case.
    spelt: Box<str>,
    /// As people write it: `A 101`.
    written: Box<str>,
    /// Equal for names that a reader may take for one another.
    look_alike: u64,
}

impl Name {
    /// Returns the parts in order.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Whether all parts are among those of another name, in their order: what the frame cut off, or a reader dropped, is
    /// missing.
    pub fn is_part_of(&self, other: &Name) -> bool {
        let mut rest = other.parts.iter();
        self.parts.len() < other.parts.len() && self.parts.iter().all(|part| rest.any(|of| of == part))
    }

    /// Returns the spelling that all spellings of the name share, but for leading zeros.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Returns the spelling that all spellings of the name share, in lower case: `b 1-03` for `B1-03`.
    pub fn spelt(&self) -> &str {
        &self.spelt
    }

    /// Returns the name as people write it.
    pub fn as_str(&self) -> &str {
        &self.written
    }

    /// Returns the name that a code is, or a text that is compared whole; none of an empty text.
    pub fn exactly(kind: PartKind, text: &str) -> Option<Name> {
        let mut name = NameBuilder { written: text.to_owned(), ..NameBuilder::default() };
        name.push(Part { kind, text: text.into() }, text, ' ');
        name.build().filter(|_| !text.is_empty())
    }

    /// Whether it is a code.
    pub fn is_code(&self) -> bool {
        self.parts.iter().any(|part| part.kind == PartKind::Code)
    }

    /// Returns the blocking key.
    pub(in crate::semantics) fn look_alike(&self) -> u64 {
        self.look_alike
    }

    /// Returns the letters and digits with leading zeros, without anything between them.
    pub(in crate::semantics) fn characters(&self) -> impl Iterator<Item = char> + Clone + '_ {
        self.spelt.chars().filter(|c| c.is_alphanumeric())
    }

    /// Returns how many letters and digits stand before the end of each part.
    pub(in crate::semantics) fn borders(&self) -> impl Iterator<Item = usize> + '_ {
        self.spelt.split(|c: char| !c.is_alphanumeric()).scan(0, |end, part| {
            *end += part.chars().count();
            Some(*end)
        })
    }
}

/// Collects a name part by part.
#[derive(Default)]
pub struct NameBuilder {
    parts: Vec<Part>,
    key: String,
    spelt: String,
    written: String,
}

impl NameBuilder {
    /// Begins a name that people write with a word before it, which is no part of it.
    pub fn after(word: &str) -> Self {
        Self { written: word.to_owned(), ..Self::default() }
    }

    /// Adds a word, or a letter.
    pub fn word(&mut self, word: &str, written: &str) {
        self.write(written);
        self.letters(word);
    }

    /// Adds a number or code: runs of letters and of digits with the marks between them. `canonical` gives one word for all
    /// languages.
    pub fn code(&mut self, code: &str, canonical: impl Fn(&str) -> String) {
        self.write(code);
        let (mut rest, mut mark) = (code, None);
        while let Some(first) = rest.chars().next() {
            let run = |is: fn(char) -> bool| rest.find(|c| !is(c)).unwrap_or(rest.len());
            let is_digit = first.is_ascii_digit();
            let end = if is_digit { run(|c| c.is_ascii_digit()) } else { run(char::is_alphabetic) };
            if end == 0 {
                mark = mark.or(Some(first));
                rest = &rest[first.len_utf8()..];
                continue;
            }
            let part = &rest[..end];
            match part.chars().nth(1) {
                _ if is_digit => self.digits(part, mark),
                Some(_) => self.letters(&canonical(part)),
                None => self.letters(part),
            }
            (rest, mark) = (&rest[end..], None);
        }
    }

    /// Whether the last part is this word.
    pub fn ends_with(&self, word: &str) -> bool {
        self.parts.last().is_some_and(|part| *part.text == *latin_capitals(word))
    }

    /// Returns the name; none if it has no part.
    pub fn build(self) -> Option<Name> {
        let look_alike = hash(b'i', &look_alike_form(&self.spelt));
        let Self { parts, key, spelt, written } = self;
        (!parts.is_empty()).then(|| Name {
            parts,
            key: key.into(),
            spelt: spelt.into(),
            written: written.into(),
            look_alike,
        })
    }

    fn write(&mut self, written: &str) {
        if !self.written.is_empty() {
            self.written.push(' ');
        }
        self.written.extend(written.chars().flat_map(char::to_uppercase));
    }

    fn letters(&mut self, letters: &str) {
        let text = latin_capitals(letters);
        let kind = if text.chars().nth(1).is_some() { PartKind::Word } else { PartKind::Letter };
        let lower = text.to_lowercase();
        self.push(Part { kind, text: text.into() }, &lower, ' ');
    }

    fn digits(&mut self, digits: &str, mark: Option<char>) {
        let significant = digits.trim_start_matches('0');
        let text = if significant.is_empty() { "0" } else { significant };
        let after_digits = self.parts.last().is_some_and(|part| part.kind == PartKind::Digits);
        // The border between a letter and a digit is spelling.
        let mark = mark.filter(|_| after_digits).unwrap_or(' ');
        self.push(Part { kind: PartKind::Digits, text: text.into() }, digits, mark);
    }

    fn push(&mut self, part: Part, spelt: &str, mark: char) {
        for (text, part) in [(&mut self.key, &*part.text), (&mut self.spelt, spelt)] {
            if !text.is_empty() {
                text.push(mark);
            }
            text.push_str(part);
        }
        match self.parts.get_mut(PARTS_MAX) {
            None => self.parts.push(part),
            Some(rest) => {
                *rest = Part { kind: PartKind::Word, text: format!("{}{}", rest.text, part.text).into() }
            }
        }
    }
}

/// Returns the digit that a reader takes a letter for, and the other way round.
pub(in crate::semantics) fn look_alike_digit(c: char) -> char {
    match c {
        'o' | 'd' | 'q' => '0',
        'i' | 'l' => '1',
        'z' => '2',
        's' => '5',
        'g' => '6',
        'b' => '8',
        _ => c,
    }
}

/// Returns the form that look-alike names share. Zeros are left out, and what may be misread for one: some spell leading
/// zeros and some do not.
fn look_alike_form(spelt: &str) -> String {
    spelt.chars().filter(|c| c.is_alphanumeric()).map(look_alike_digit).filter(|c| *c != '0').collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(code: &str) -> Name {
        let mut builder = NameBuilder::default();
        builder.code(code, str::to_owned);
        builder.build().expect("a code")
    }

    #[test]
    fn spellings_of_one_name_have_one_key() {
        for (code, key, spelt) in [
            ("B1-03", "B 1-3", "b 1-03"),
            ("b-1-3", "B 1-3", "b 1-3"),
            ("HUB10", "HUB 10", "hub 10"),
            ("3-114A", "3-114 A", "3-114 a"),
            ("D1.02", "D 1.2", "d 1.02"),
            ("000", "0", "000"),
            ("901/902", "901/902", "901/902"),
        ] {
            let name = name(code);
            assert_eq!((name.key(), name.spelt()), (key, spelt), "{code}");
        }
    }

    #[test]
    fn a_border_between_parts_is_known_by_its_place() {
        for (code, borders) in [
            ("1.02", &[1, 3][..]),
            ("10.2", &[2, 3]),
            ("102", &[3]),
            ("B1-03", &[1, 2, 4]),
            ("3A4", &[1, 2, 3]),
        ] {
            assert_eq!(name(code).borders().collect::<Vec<_>>(), borders, "{code}");
        }
    }
}
