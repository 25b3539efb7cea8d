//! An identifier: a number or code that names one thing, and how two of them relate.

use crate::semantics::lexicon::role::Role;
use crate::semantics::lexicon::stable_hash::hash;

/// A number or code read in a text, with what it numbers.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Identifier {
    /// What it numbers.
    pub role: Role,
    /// Canonical form: upper case, no leading zeros: `901`, `B1-3`. Equal values are equal identifiers.
    pub value: String,
    written: String,
    /// Equal for values that OCR may take for one another.
    pub(in crate::semantics) look_alike: u64,
    span: Option<Span>,
}

/// The numbers a range holds; a single number is a range of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
struct Span {
    letters: usize,
    low: u64,
    high: u64,
}

/// How two identifiers relate, least alike first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Relation {
    /// They number different kinds of things, and say nothing of each other.
    Unrelated,
    /// They exclude each other.
    Different,
    /// Several letters stand where the other has look-alike digits.
    PoorlyRead,
    /// One letter stands where the other has a look-alike digit.
    LookAlike,
    /// One range holds the other, or they overlap.
    Overlap,
    /// Equal but for leading zeros.
    EqualButZeros,
    /// Equal.
    Equal,
}

impl Identifier {
    /// `code` as written, letters and digits with separators.
    pub(in crate::semantics) fn new(role: Role, code: &str) -> Identifier {
        let written = code.to_uppercase();
        let value = canonical(&written);
        let look_alike = hash(b'i', &canonical(&look_alike_form(&value)));
        let span = range(&value, 3).or_else(|| single(&value));
        Identifier { role, value, written, look_alike, span }
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

    /// Returns how the two relate. Symmetric.
    pub fn relation(&self, other: &Identifier) -> Relation {
        if !self.role.is_compatible(&other.role) {
            return Relation::Unrelated;
        }
        if self.value == other.value {
            return if self.written == other.written { Relation::Equal } else { Relation::EqualButZeros };
        }
        if self.overlaps(other) {
            return Relation::Overlap;
        }
        if self.look_alike != other.look_alike {
            return Relation::Different;
        }
        // "O4" and "04" are one letter apart as written, not once the zero is gone: the kinder reading holds.
        match (misread_letters(&self.value, &other.value), misread_letters(&self.written, &other.written)) {
            (Some(1), _) | (_, Some(1)) => Relation::LookAlike,
            (None, None) => Relation::Different,
            _ => Relation::PoorlyRead,
        }
    }

    fn overlaps(&self, other: &Identifier) -> bool {
        let (Some(a), Some(b)) = (self.span, other.span) else { return false };
        self.value[..a.letters] == other.value[..b.letters] && a.low <= b.high && b.low <= a.high
    }
}

/// Whether `code` is a range: equal prefixes, rising numbers, with `digits` digits or more unless it has a prefix.
/// "901-905" is one; "1-03" is room 3 of floor 1.
pub fn is_range(code: &str, digits: usize) -> bool {
    range(code, digits).is_some()
}

fn range(value: &str, min_digits: usize) -> Option<Span> {
    let (low, high) = value.split_once('-')?;
    let (low, high) = (single(low)?, single(high)?);
    let same_prefix = value[..low.letters] == value[value.find('-')? + 1..][..high.letters];
    let digits = value.find('-')? - low.letters;
    let plausible = low.letters > 0 || (digits >= min_digits && value.len() == 2 * digits + 1);
    (same_prefix && low.low < high.low && plausible).then_some(Span { high: high.low, ..low })
}

fn single(value: &str) -> Option<Span> {
    let letters = value.find(|c: char| c.is_ascii_digit())?;
    let digits = &value[letters..];
    let number = digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse().ok()).flatten()?;
    Some(Span { letters, low: number, high: number })
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

/// Returns the digit that OCR takes a letter for, and the other way round; and the hyphen for a full stop.
fn look_alike_digit(c: char) -> char {
    match c {
        'O' | 'D' | 'Q' => '0',
        'I' | 'L' => '1',
        'Z' => '2',
        'S' => '5',
        'G' => '6',
        'B' => '8',
        '.' => '-',
        _ => c,
    }
}

fn look_alike_form(value: &str) -> String {
    value.chars().map(look_alike_digit).collect()
}

/// Returns how many letters stand for a look-alike digit, if nothing else differs.
fn misread_letters(a: &str, b: &str) -> Option<usize> {
    if a.len() != b.len() {
        return None;
    }
    let mut letters = 0;
    for (x, y) in a.chars().zip(b.chars()).filter(|(x, y)| x != y) {
        let both_letters_or_digits =
            x.is_alphabetic() && y.is_alphabetic() || x.is_numeric() && y.is_numeric();
        let misread = !both_letters_or_digits && look_alike_digit(x) == look_alike_digit(y);
        letters += misread.then_some(1)?;
    }
    Some(letters)
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

    #[test]
    fn relations_are_exact_but_for_zeros_ranges_and_look_alikes() {
        let relation =
            |a: &str, b: &str| Identifier::new(Role::Neutral, a).relation(&Identifier::new(Role::Neutral, b));
        for (a, b, expected) in [
            ("901", "901", Relation::Equal),
            ("B1-3", "B1-03", Relation::EqualButZeros),
            ("9O1", "901", Relation::LookAlike),
            ("O4", "04", Relation::LookAlike),
            ("9OI", "901", Relation::PoorlyRead),
            ("15.02", "15-02", Relation::LookAlike),
            ("3", "8", Relation::Different),
            ("B1-D", "B1-Q", Relation::Different),
            ("901-905", "903", Relation::Overlap),
            ("901-905", "905-907", Relation::Overlap),
            ("A1-A5", "A3", Relation::Overlap),
            ("A1-A5", "B3", Relation::Different),
            ("901-905", "906", Relation::Different),
            ("1-03", "2", Relation::Different),
        ] {
            assert_eq!(relation(a, b), expected, "{a} {b}");
            assert_eq!(relation(b, a), expected, "{b} {a}");
        }
    }
}
