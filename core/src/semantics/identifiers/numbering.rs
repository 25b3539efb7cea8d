//! Numbering: the numbers of one building, given by an operator or learned from what was read (M20).
//!
//! A reader finds numbers everywhere: railings, dates, plates cut by the frame. Once it is known how this building writes its
//! own ("7.04"), no other number names anything in it.

use std::collections::{BTreeMap, BTreeSet};

use regex::{Regex, RegexBuilder};
use thiserror::Error;

use crate::semantics::identifiers::identifier::Identifier;
use crate::semantics::lexicon::role::Role;

/// Number of values from which a shape is learned, each read alike in two keyframes or more.
pub const LEARNED_FROM_VALUES: usize = 10;
/// Patterns that an operator may give.
const PATTERNS_MAX: usize = 16;
/// Bytes of one pattern.
const PATTERN_BYTES_MAX: usize = 256;
/// Bytes that a compiled pattern may take.
const COMPILED_BYTES_MAX: usize = 1 << 20;
/// A longer number is no misreading of one of the building's by a single character.
const MISREAD_LEN_MAX: usize = 12;
/// The separators of a number.
const SEPARATORS: [char; 4] = ['.', '-', ':', '/'];

/// The way a number is written: runs of digits and the separators between them.
///
/// `#` is the first run, of any length, for it counts floors or all rooms. Every other run keeps its length: "7.04" and
/// "10.01" are both `#.99`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Shape(Box<str>);

impl Shape {
    /// Returns the shape of an identifier as written, if it is made of digits and separators alone.
    pub fn of(written: &str) -> Option<Self> {
        let mut shape = String::with_capacity(written.len());
        for c in written.chars() {
            match c {
                '0'..='9' if shape.is_empty() => shape.push('#'),
                '0'..='9' if shape.ends_with('#') => {}
                '0'..='9' => shape.push('9'),
                separator if SEPARATORS.contains(&separator) && shape.ends_with(['#', '9']) => {
                    shape.push(separator);
                }
                _ => return None,
            }
        }
        shape.ends_with(['#', '9']).then(|| Self(shape.into()))
    }

    /// Whether it is one run of digits, as anything countable has.
    fn is_bare(&self) -> bool {
        &*self.0 == "#"
    }

    /// As people are shown it: `#.99`.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Why a pattern is refused.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum PatternError {
    /// There are too many.
    #[error("{0} patterns, and at most {PATTERNS_MAX} are taken")]
    TooMany(usize),
    /// This one is empty or too long.
    #[error("pattern {0} must have 1 to {PATTERN_BYTES_MAX} bytes")]
    Length(usize),
    /// This one is no regular expression that runs in linear time and little memory.
    #[error("pattern {0} is no regular expression: {1}")]
    Syntax(usize, String),
}

/// The numbers of one building.
#[derive(Clone, Debug, Default)]
pub struct Numbering {
    shapes: BTreeSet<Shape>,
    patterns: Vec<Regex>,
}

impl PartialEq for Numbering {
    fn eq(&self, other: &Self) -> bool {
        let told = |numbering: &Self| numbering.shown().map(str::to_owned).collect::<Vec<_>>();
        told(self) == told(other)
    }
}

/// A text's identifiers under a numbering.
#[derive(Debug, Default)]
pub(in crate::semantics) struct Sorted {
    /// The building's own, containers, and bare numbers that only tell objects apart.
    pub identifiers: Vec<Identifier>,
    /// The others, which name nothing here.
    pub foreign: Vec<Identifier>,
}

impl Numbering {
    /// Learns from how many values of each shape were read alike in two keyframes or more; none while these are too few.
    ///
    /// Separated shapes go before bare numbers, which take many values on any wall.
    pub fn learned(established: &BTreeMap<Shape, usize>) -> Option<Self> {
        let holds = established.iter().filter(|(_, values)| **values >= LEARNED_FROM_VALUES);
        let mut shapes: BTreeSet<Shape> = holds.map(|(shape, _)| shape.clone()).collect();
        if shapes.iter().any(|shape| !shape.is_bare()) {
            shapes.retain(|shape| !shape.is_bare());
        }
        (!shapes.is_empty()).then(|| Self { shapes, patterns: Vec::new() })
    }

    /// Takes an operator's regular expressions; a text that one of them matches whole, whatever its case, is an identifier.
    pub fn given(patterns: &[String]) -> Result<Self, PatternError> {
        if patterns.len() > PATTERNS_MAX {
            return Err(PatternError::TooMany(patterns.len()));
        }
        let compile = |(at, pattern): (usize, &String)| {
            if pattern.is_empty() || pattern.len() > PATTERN_BYTES_MAX {
                return Err(PatternError::Length(at));
            }
            let syntax = |error: regex::Error| PatternError::Syntax(at, error.to_string());
            // By itself first, or "a)(b" would be whole within the brackets below.
            Regex::new(pattern).map_err(syntax)?;
            let whole = format!("^(?:{pattern})$");
            let mut builder = RegexBuilder::new(&whole);
            builder.case_insensitive(true).size_limit(COMPILED_BYTES_MAX).build().map_err(syntax)
        };
        let patterns = patterns.iter().enumerate().map(compile).collect::<Result<_, _>>()?;
        Ok(Self { shapes: BTreeSet::new(), patterns })
    }

    /// Returns the patterns or shapes, as people are shown them.
    pub fn shown(&self) -> impl Iterator<Item = &str> {
        let given = self.patterns.iter().map(|pattern| {
            let whole = pattern.as_str();
            whole.strip_prefix("^(?:").and_then(|rest| rest.strip_suffix(")$")).unwrap_or(whole)
        });
        given.chain(self.shapes.iter().map(Shape::as_str))
    }

    /// Sorts the identifiers of a text in normal form into the building's own and others.
    pub(in crate::semantics) fn sort(&self, normalised: &str, identifiers: Vec<Identifier>) -> Sorted {
        if self.patterns.iter().any(|pattern| pattern.is_match(normalised)) {
            let has_own = identifiers.iter().any(|identifier| !identifier.role.is_container());
            let whole = || vec![Identifier::new(Role::Neutral, normalised)];
            let identifiers = if has_own { identifiers } else { whole() };
            return Sorted { identifiers, foreign: Vec::new() };
        }
        let mut sorted = Sorted::default();
        for mut identifier in identifiers {
            if identifier.role.is_container() || self.has_shape(identifier.as_str()) {
                sorted.identifiers.push(identifier);
            } else if self.is_bare_beside(&identifier) {
                identifier.role = Role::Bare;
                sorted.identifiers.push(identifier);
            } else {
                sorted.foreign.push(identifier);
            }
        }
        sorted.identifiers.sort_unstable();
        sorted
    }

    fn has_shape(&self, written: &str) -> bool {
        Shape::of(written).is_some_and(|shape| self.shapes.contains(&shape))
    }

    /// Whether it is a bare number in a building that separates its own, and none of these misread.
    fn is_bare_beside(&self, identifier: &Identifier) -> bool {
        identifier.role == Role::Neutral
            && !self.shapes.is_empty()
            && Shape::of(identifier.as_str()).is_some_and(|shape| shape.is_bare())
            && !self.may_be_misread(identifier.as_str())
    }

    /// Whether one character more, less or other makes it a number of the building: "302" for "3.02".
    fn may_be_misread(&self, written: &str) -> bool {
        if !written.is_ascii() || written.len() > MISREAD_LEN_MAX {
            return false;
        }
        // Which digit stands where changes no shape.
        let characters = || std::iter::once('1').chain(SEPARATORS);
        (0..=written.len()).any(|at| {
            let (before, after) = written.split_at(at);
            let rest = after.get(1..);
            let inserted = characters().any(|c| self.has_shape(&format!("{before}{c}{after}")));
            let replaced =
                rest.is_some_and(|rest| characters().any(|c| self.has_shape(&format!("{before}{c}{rest}"))));
            inserted || replaced || rest.is_some_and(|rest| self.has_shape(&format!("{before}{rest}")))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::semantics::{Text, conflict, similarity};

    fn numbering(shapes: &[(&str, usize)]) -> Option<Numbering> {
        let established = shapes.iter().map(|(value, count)| (Shape::of(value).expect("digits"), *count));
        Numbering::learned(&established.collect())
    }

    #[test]
    fn a_shape_keeps_the_length_of_every_run_but_the_first() {
        for (value, shape) in [
            ("7.04", "#.99"),
            ("10.01", "#.99"),
            ("901", "#"),
            ("1-03", "#-99"),
            ("10:30", "#:99"),
            ("8.0", "#.9"),
        ] {
            assert_eq!(Shape::of(value).expect("a number").as_str(), shape, "{value}");
        }
        for value in ["", "B1-3", "7.", ".02", "4..02", "HUB4"] {
            assert_eq!(Shape::of(value), None, "{value}");
        }
    }

    #[test]
    fn ten_values_make_a_numbering_and_separated_ones_go_before_bare_ones() {
        assert_eq!(numbering(&[("7.04", 9), ("901", 9)]), None);
        let shown = |shapes: &[(&str, usize)]| -> Vec<String> {
            numbering(shapes).expect("enough").shown().map(str::to_owned).collect()
        };
        assert_eq!(shown(&[("7.04", 9), ("901", 10)]), ["#"]);
        assert_eq!(shown(&[("7.04", 10), ("901", 24)]), ["#.99"]);
        assert_eq!(shown(&[("7.04", 10), ("1-03", 12), ("901", 24)]), ["#-99", "#.99"]);
    }

    #[test]
    fn beside_separated_numbers_a_bare_one_contradicts_and_never_matches() {
        let numbering = numbering(&[("7.04", 10)]);
        let parse = |text: &str| Text::under(text, numbering.as_ref());
        let level = |a: &str, b: &str| similarity(&parse(a), &parse(b)).level;
        assert_eq!(level("7.04", "7.04"), 5);
        assert_eq!(level("room 7.04", "7.04"), 5);
        assert_eq!((level("10", "10"), level("10", "8"), level("10", "7.04")), (3, 1, 2));
        assert!(conflict(&parse("10"), &parse("8")).is_some());
        // What is no number of the building, or one of them misread, says nothing of another.
        for (a, b) in
            [("HUB04", "HUB10"), ("302", "303"), ("302", "3.02"), ("4.014.02", "4.02"), ("10", "7.04")]
        {
            assert!(conflict(&parse(a), &parse(b)).is_none(), "{a} | {b}");
        }
        for text in ["HUB04", "302", "4.014.02", "56G", "8.0"] {
            assert_eq!(parse(text).information_level(), 1, "{text}");
        }
        assert!(parse("room 12").information_level() < 4, "what is left is generic");
        assert!(level("Turing 12", "Turing 14") < 4, "a foreign number is still a difference");
        assert_eq!(parse("Level 5").identifiers().len(), 1, "a container stays one");
    }

    #[test]
    fn an_operators_pattern_matches_a_whole_text() {
        let patterns = [r"\d{1,2}\.\d\d".to_owned(), "hub ?[0-9]+".to_owned()];
        let numbering = Numbering::given(&patterns).expect("two patterns");
        let parse = |text: &str| Text::under(text, Some(&numbering));
        for (text, is_one) in [
            ("7.04", true),
            ("HUB04", true),
            ("Hub 4", true),
            ("room 7.04", false),
            ("302", false),
            ("9F", false),
        ] {
            assert_eq!(parse(text).has_own_identifier(), is_one, "{text}");
        }
        assert_eq!(numbering.shown().collect::<Vec<_>>(), patterns);
    }

    #[test]
    fn a_pattern_that_is_none_is_refused_by_its_number() {
        let given = |patterns: &[&str]| {
            Numbering::given(&patterns.iter().map(|p| (*p).to_owned()).collect::<Vec<_>>()).err()
        };
        assert_eq!(given(&["x", ""]), Some(PatternError::Length(1)));
        assert_eq!(given(&["x"; 17]), Some(PatternError::TooMany(17)));
        for bad in ["(", "a)(b", r"(a)\1", r"\w{1000}{1000}"] {
            assert!(matches!(given(&[bad]), Some(PatternError::Syntax(0, _))), "{bad}");
        }
    }
}
