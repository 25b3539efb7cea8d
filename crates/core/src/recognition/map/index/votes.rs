//! What an anchor's readings say together: a vote (M4).

use std::collections::BTreeMap;

use super::parsed_readings::{ParsedReading, ParsedReadings};
use crate::domain::anchor::Observation;
use crate::domain::ids::KeyframeSeq;
use crate::domain::report::ReadingReport;
use crate::semantics::{Numbering, Text};

/// Votes are summed in millionths of a detection's confidence: integers add up to the same
/// sum in any order, so that a rebuilt index equals the live one to the bit.
const UNITS_PER_CONFIDENCE: f64 = 1e6;

/// The votes for one reading; readings that normalise alike are one.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Tally {
    /// Whether it says anything. Any number of "unknown" does not outvote one number read.
    informative: bool,
    /// Whether a model or a person said so at least once.
    described: bool,
    units: u64,
    count: usize,
    newest: (KeyframeSeq, u16),
    /// As the newest detection wrote it.
    text: Box<str>,
    /// Equal for spellings of one name: these are one reading in the vote.
    gist: Box<str>,
}

impl Tally {
    fn rank(&self) -> (bool, u64, (KeyframeSeq, u16)) {
        (self.informative, self.units, self.newest)
    }

    fn add(&mut self, vote: &Self) {
        self.units += vote.units;
        self.count += vote.count;
        self.described |= vote.described;
        if vote.newest > self.newest {
            self.newest = vote.newest;
            self.text.clone_from(&vote.text);
        }
    }
}

/// The readings of an anchor, by normalised text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Votes {
    tallies: BTreeMap<Box<str>, Tally>,
}

/// The reading that won.
#[derive(Clone, Debug, PartialEq)]
pub struct Elected {
    /// As last read.
    pub text: Box<str>,
    /// How many detections read it alike.
    pub count: usize,
    /// Whether a model or a person said so at least once.
    pub described: bool,
    /// The summed confidence of these detections.
    pub weight: f64,
}

impl Elected {
    /// Whether it was read once only, by a reader that was not confident: dots and window frames are read so, too.
    pub fn is_doubtful(&self, min_confidence: f64) -> bool {
        !self.described && self.count == 1 && self.weight < min_confidence
    }
}

impl Votes {
    /// Counts one observation's reading, if it has one.
    pub fn add(&mut self, observation: &Observation, is_code: bool, parsed: &mut ParsedReadings) {
        if let Some(reading) = &observation.reading {
            self.add_reading(observation, reading, observation.described, &parsed.of(reading, is_code));
        }
        if let Some(read) = &observation.crop_reading {
            let described = read.described && !read.degraded;
            self.add_reading(observation, &read.text, described, &parsed.of(&read.text, is_code));
        }
    }

    fn add_reading(
        &mut self,
        observation: &Observation,
        reading: &str,
        described: bool,
        parsed: &ParsedReading,
    ) {
        let vote = Tally {
            informative: parsed.is_informative,
            described,
            units: (observation.confidence * UNITS_PER_CONFIDENCE).round() as u64,
            count: 1,
            newest: (observation.keyframe, observation.detection),
            text: reading.into(),
            gist: parsed.gist.clone(),
        };
        self.count(&parsed.normalised, vote);
    }

    /// Counts all votes of another anchor, which is the same object.
    pub fn add_all(&mut self, other: &Self) {
        for (normalised, tally) in &other.tallies {
            self.count(normalised, tally.clone());
        }
    }

    fn count(&mut self, normalised: &str, vote: Tally) {
        match self.tallies.get_mut(normalised) {
            Some(tally) => tally.add(&vote),
            None => drop(self.tallies.insert(normalised.into(), vote)),
        }
    }

    /// Returns the reading with the most weight; of equals, the newest. Spellings of one name are one reading, and where the
    /// numbering knows names of more parts, one that lacks some supports those and outvotes none.
    pub fn elected(&self, numbering: Option<&Numbering>) -> Option<Elected> {
        let mut by_gist: BTreeMap<&str, Tally> = BTreeMap::new();
        for tally in self.tallies.values() {
            by_gist
                .entry(&tally.gist)
                .and_modify(|reading| reading.add(tally))
                .or_insert_with(|| tally.clone());
        }
        let mut readings: Vec<Tally> = by_gist.into_values().collect();
        if let Some(numbering) = numbering.filter(|numbering| readings.len() > 1 && numbering.tells_parts()) {
            readings = with_support(readings, numbering);
        }
        let best = readings.into_iter().max_by_key(Tally::rank)?;
        let weight = best.units as f64 / UNITS_PER_CONFIDENCE;
        Some(Elected { text: best.text, count: best.count, described: best.described, weight })
    }

    /// Whether this is one of the readings, in normal form.
    pub fn says(&self, normalised: &str) -> bool {
        self.tallies.contains_key(normalised)
    }

    /// Returns a reading in normal form as it was last read.
    pub fn as_read(&self, normalised: &str) -> Option<&str> {
        Some(&self.tallies.get(normalised)?.text)
    }

    /// Returns the described readings that say anything, heaviest first, in normal form, each with how often it was
    /// read.
    pub fn described(&self) -> impl Iterator<Item = (&str, usize)> {
        let mut told: Vec<(&Box<str>, &Tally)> =
            self.tallies.iter().filter(|(_, tally)| tally.described && tally.informative).collect();
        told.sort_by_key(|(_, tally)| std::cmp::Reverse(tally.rank()));
        told.into_iter().map(|(normalised, tally)| (&**normalised, tally.count))
    }

    /// Returns the two readings that one description is to be made of: the two heaviest, if models or people said them
    /// and the heaviest of all is one of them. Both in normal form.
    pub fn to_merge(&self) -> Option<(&str, &str)> {
        let best = self.tallies.values().max_by_key(|tally| tally.rank())?;
        if self.tallies.len() < 2 || !best.described || !best.informative {
            return None;
        }
        let mut told = self.described().map(|(normalised, _)| normalised);
        Some((told.next()?, told.next()?))
    }

    /// Two described readings that cannot be of one object: "901 is not 910".
    pub fn disagreement(&self, numbering: Option<&Numbering>) -> Option<String> {
        let told: Vec<Text> =
            self.described().map(|(normalised, _)| Text::under(normalised, numbering)).collect();
        let first = told.first()?;
        told[1..].iter().find_map(|other| {
            let conflict = crate::semantics::conflict(first, other)?;
            Some(format!("{} is not {}", conflict.a.as_str(), conflict.b.as_str()))
        })
    }

    /// Returns every reading, heaviest first.
    pub fn report(&self) -> Vec<ReadingReport> {
        let mut tallies: Vec<&Tally> = self.tallies.values().collect();
        tallies.sort_by_key(|tally| std::cmp::Reverse(tally.rank()));
        tallies
            .into_iter()
            .map(|tally| ReadingReport {
                text: tally.text.to_string(),
                weight: tally.units as f64 / UNITS_PER_CONFIDENCE,
                count: tally.count,
            })
            .collect()
    }
}

/// Returns the readings of which none lacks parts, if there are such, each with the votes of those that do.
fn with_support(readings: Vec<Tally>, numbering: &Numbering) -> Vec<Tally> {
    let under = |reading: Tally| (Text::under(&reading.text, Some(numbering)), reading);
    let (partial, mut whole): (Vec<_>, Vec<_>) =
        readings.into_iter().map(under).partition(|(text, _)| text.is_partial());
    if whole.iter().all(|(_, reading)| !reading.informative) {
        whole.extend(partial);
    } else {
        for (of_part, part) in partial {
            let supported = whole.iter_mut().filter(|(text, _)| of_part.is_part_of(text));
            supported.for_each(|(_, reading)| reading.units += part.units);
        }
    }
    whole.into_iter().map(|(_, reading)| reading).collect()
}
