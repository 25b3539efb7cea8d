//! Readings that were parsed: a text that many detections read is parsed once.

use std::collections::HashMap;
use std::sync::Arc;

use crate::semantics::{Numbering, Shape, Text};

/// The most texts that are kept at once. When there are more, all are forgotten: a robot's next keyframes see other signs.
const TEXTS_MAX: usize = 1 << 14;

/// Parts of a text that votes and readings alike need.
#[derive(Debug, PartialEq)]
pub struct ParsedReading {
    /// In normal form.
    pub normalised: Box<str>,
    /// Its names in their one spelling, or its normal form.
    pub gist: Box<str>,
    /// The shape of its name, if it has a number.
    pub shape: Option<Shape>,
    /// Whether it says anything.
    pub is_informative: bool,
}

/// The readings that a batch of changes has parsed, by text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParsedReadings {
    by_text: HashMap<Box<str>, Arc<ParsedReading>>,
    /// Those of classes whose texts are codes.
    codes: HashMap<Box<str>, Arc<ParsedReading>>,
}

impl ParsedReadings {
    /// Returns a reading, parsed; a code is compared exactly. Nothing else of a numbering changes these parts.
    pub fn of(&mut self, reading: &str, is_code: bool) -> Arc<ParsedReading> {
        let known_texts = if is_code { &mut self.codes } else { &mut self.by_text };
        if let Some(known) = known_texts.get(reading) {
            return known.clone();
        }
        if known_texts.len() == TEXTS_MAX {
            known_texts.clear();
        }
        let text = Text::under(reading, is_code.then(Numbering::of_codes).as_ref());
        let parsed = Arc::new(ParsedReading {
            normalised: text.normalised().into(),
            gist: text.gist().into(),
            shape: text.shape(),
            is_informative: text.information_level() > 1,
        });
        known_texts.insert(reading.into(), parsed.clone());
        parsed
    }
}
