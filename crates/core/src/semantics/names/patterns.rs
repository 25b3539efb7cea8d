//! Patterns: regular expressions of an operator for the names of a building (M20).
//!
//! Whoever may write to a map may send them, so what they cost is bounded before they are compiled. To match them without
//! regard to case a class of Unicode is folded letter by letter, which costs more than all else: classes are counted first.
//! They are compiled once, all together, within one limit of memory.

use regex::{RegexSet, RegexSetBuilder};
use regex_syntax::ast::{self, Ast, ClassSetItem};
use serde::Serialize;
use thiserror::Error;

/// Patterns that an operator may give.
const PATTERNS_MAX: usize = 16;
/// Bytes of one pattern.
const PATTERN_BYTES_MAX: usize = 256;
/// Bytes that all compiled patterns of a list may take.
const COMPILED_BYTES_MAX: usize = 1 << 20;
/// The most that the classes of a list may cost together: a class counts 1.
const CLASSES_MAX: u32 = 256;
/// A class of Unicode that is folded: one of its properties, or `\w` and its like within brackets.
const FOLDED_CLASS: u32 = 16;
/// So many letters of a range within brackets cost as much as a class.
const LETTERS_OF_A_CLASS: u32 = 8192;

/// Why patterns are refused.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum PatternError {
    /// There are too many.
    #[error("{0} patterns, and at most {PATTERNS_MAX} are taken")]
    TooMany(usize),
    /// This one is empty or too long.
    #[error("pattern {0} must have 1 to {PATTERN_BYTES_MAX} bytes")]
    Length(usize),
    /// This one is no regular expression that runs in linear time.
    #[error("pattern {0} is no regular expression: {1}")]
    Syntax(usize, String),
    /// With this one they have too many classes of letters.
    #[error(
        "with pattern {0} the classes are too many: write \\d for digits, and letters in place of \\p and [\\w]"
    )]
    Classes(usize),
    /// Together they take too much memory.
    #[error(
        "the patterns take more than {COMPILED_BYTES_MAX} bytes; repeat less, and write \\d in place of \\w"
    )]
    Memory,
}

impl PatternError {
    /// Returns the number of the pattern at fault, counted from 0.
    pub fn at(&self) -> Option<usize> {
        match self {
            Self::Length(at) | Self::Syntax(at, _) | Self::Classes(at) => Some(*at),
            Self::TooMany(_) | Self::Memory => None,
        }
    }
}

/// Patterns that were taken, compiled.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(transparent)]
pub struct Patterns {
    texts: Vec<String>,
    /// None where there are no patterns.
    #[serde(skip)]
    set: Option<RegexSet>,
}

impl PartialEq for Patterns {
    fn eq(&self, other: &Self) -> bool {
        self.texts == other.texts
    }
}

impl Patterns {
    /// No patterns.
    pub const NONE: Self = Self { texts: Vec::new(), set: None };

    /// Takes regular expressions; they match whole texts, whatever their case.
    pub fn new(texts: Vec<String>) -> Result<Self, PatternError> {
        if texts.len() > PATTERNS_MAX {
            return Err(PatternError::TooMany(texts.len()));
        }
        let mut cost = 0;
        for (at, text) in texts.iter().enumerate() {
            if text.is_empty() || text.len() > PATTERN_BYTES_MAX {
                return Err(PatternError::Length(at));
            }
            // By itself, or "a)(b" would be whole within the brackets below.
            let parsed = ast::parse::Parser::new().parse(text);
            let parsed = parsed.map_err(|error| PatternError::Syntax(at, error.to_string()))?;
            cost += cost_of_classes(&parsed);
            if cost > CLASSES_MAX {
                return Err(PatternError::Classes(at));
            }
        }
        let wholes: Vec<String> = texts.iter().map(|text| format!("^(?:{text})$")).collect();
        let set = RegexSetBuilder::new(&wholes).case_insensitive(true).size_limit(COMPILED_BYTES_MAX).build();
        match set {
            Ok(set) => Ok(Self { texts, set: Some(set) }),
            Err(regex::Error::CompiledTooBig(_)) => Err(PatternError::Memory),
            Err(error) => Err(wholes
                .iter()
                .enumerate()
                .find_map(wrong)
                .unwrap_or_else(|| PatternError::Syntax(0, error.to_string()))),
        }
    }

    /// Returns them as they were given.
    pub fn texts(&self) -> &[String] {
        &self.texts
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.texts.is_empty()
    }

    /// Whether one of them matches a whole text.
    pub fn match_whole(&self, text: &str) -> bool {
        self.set.as_ref().is_some_and(|set| set.is_match(text))
    }
}

/// Returns what is wrong with a pattern whose form is right: a property of letters that does not exist.
fn wrong((at, whole): (usize, &String)) -> Option<PatternError> {
    let parsed = regex_syntax::ParserBuilder::new().case_insensitive(true).build().parse(whole);
    parsed.err().map(|error| PatternError::Syntax(at, error.to_string()))
}

fn cost_of_classes(pattern: &Ast) -> u32 {
    let Ok(cost) = ast::visit(pattern, Classes::default());
    cost
}

/// Counts classes.
#[derive(Default)]
struct Classes {
    cost: u32,
}

impl ast::Visitor for Classes {
    type Output = u32;
    type Err = std::convert::Infallible;

    fn finish(self) -> Result<u32, Self::Err> {
        Ok(self.cost)
    }

    fn visit_pre(&mut self, part: &Ast) -> Result<(), Self::Err> {
        self.cost += match part {
            Ast::Dot(_) | Ast::ClassPerl(_) | Ast::ClassBracketed(_) => 1,
            Ast::ClassUnicode(_) => FOLDED_CLASS,
            _ => 0,
        };
        Ok(())
    }

    fn visit_class_set_item_pre(&mut self, item: &ClassSetItem) -> Result<(), Self::Err> {
        self.cost += match item {
            ClassSetItem::Perl(_) | ClassSetItem::Unicode(_) => FOLDED_CLASS,
            ClassSetItem::Range(range) => {
                u32::from(range.end.c).saturating_sub(range.start.c.into()) / LETTERS_OF_A_CLASS
            }
            _ => 0,
        };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(patterns: &[&str]) -> Option<PatternError> {
        Patterns::new(patterns.iter().map(|pattern| (*pattern).to_owned()).collect()).err()
    }

    #[test]
    fn a_pattern_that_is_none_is_refused_by_its_number() {
        assert_eq!(error(&["x", ""]), Some(PatternError::Length(1)));
        assert_eq!(error(&["x"; 17]), Some(PatternError::TooMany(17)));
        for bad in ["(", "a)(b", r"(a)\1", r"\p{Klingon}"] {
            assert!(matches!(error(&["x", bad]), Some(PatternError::Syntax(1, _))), "{bad}");
        }
    }

    #[test]
    fn what_would_cost_much_is_refused_before_it_is_compiled() {
        let many = |class: &str| class.repeat(PATTERN_BYTES_MAX / class.len());
        for class in [r"[\w]", r"\pL", r"[\PL]", r"[\w&&\pL]", r"[\w--a]", r"\W", ".", r"[a-\x{10FFFF}]"] {
            let costly = many(class);
            assert!(matches!(error(&[costly.as_str(); 16]), Some(PatternError::Classes(_))), "{class}");
        }
        for repeated in [r"\w{1000}{1000}", r"(?:\w{99}){99}", r"[^a]{9999}"] {
            assert_eq!(error(&["x", repeated]), Some(PatternError::Memory), "{repeated}");
        }
    }

    #[test]
    fn the_patterns_of_buildings_are_taken() {
        let given = [
            r"\d{1,2}\.\d\d",
            "hub ?[0-9]+",
            r"[A-Z]{1,3}-?\d{2,4}[a-z]?",
            r"(?:room|büro)\s*\w{1,8}",
            r"[\w.-]{1,4}",
        ];
        assert_eq!(error(&given), None);
    }
}
