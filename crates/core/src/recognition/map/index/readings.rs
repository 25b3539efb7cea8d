//! Readings alike: which texts two keyframes or more of the map have read, and the numbering that follows (M20, M21).
//!
//! A misreading is seldom made twice, so what was read alike in two keyframes is what hangs there. It need not be by one
//! anchor: a plate read today and a year ago is read alike.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use super::parsed_readings::{ParsedReading, ParsedReadings};
use crate::domain::anchor::Observation;
use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::domain::settings::Settings;
use crate::semantics::{Numbering, Shape, Text};

/// A detection that read a text, and the anchor it feeds; ascending, so by keyframe first.
type Sighting = (KeyframeSeq, u16, AnchorSeq);

/// The readings of one class.
#[derive(Clone, Debug, Default, PartialEq)]
struct OfClass {
    /// By gist.
    sightings: HashMap<Box<str>, Vec<Sighting>>,
    /// By shape, the number of values that were read alike.
    alike: BTreeMap<Shape, usize>,
    /// Learned from these.
    numbering: Option<Arc<Numbering>>,
}

/// The readings of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Readings {
    by_class: HashMap<Box<str>, OfClass>,
    /// The operator's patterns, for every class but those of codes.
    given: Option<Arc<Numbering>>,
    /// The classes whose texts are codes.
    codes: BTreeSet<Box<str>>,
    /// The numbering of these.
    of_codes: Arc<Numbering>,
    /// By class, the learned shapes as they are shown. Kept, because each write shows them and classes may be many.
    learned: Arc<BTreeMap<Box<str>, Vec<String>>>,
    learns: bool,
    /// The classes whose numbering may have changed since [`Self::relearn`].
    open: BTreeSet<Box<str>>,
    /// The anchors that something they read is now, or no longer, read alike.
    touched: BTreeSet<AnchorSeq>,
}

impl Default for Readings {
    fn default() -> Self {
        let mut readings = Self {
            by_class: HashMap::new(),
            given: None,
            codes: BTreeSet::new(),
            of_codes: Arc::new(Numbering::of_codes()),
            learned: Arc::default(),
            learns: false,
            open: BTreeSet::new(),
            touched: BTreeSet::new(),
        };
        readings.set_rules(&Settings::default());
        readings
    }
}

impl Readings {
    /// Whether a text was read in two keyframes or more.
    pub fn is_alike(&self, class: &str, text: &Text) -> bool {
        self.sightings(class, text).is_some_and(is_alike)
    }

    /// Whether some keyframe has read a text.
    pub fn is_known(&self, class: &str, text: &Text) -> bool {
        self.sightings(class, text).is_some()
    }

    /// Whether every text of a class is a code.
    pub fn is_of_codes(&self, class: &str) -> bool {
        self.codes.contains(class)
    }

    /// Returns the numbering of a class: that of codes, the operator's, or the learned one if enough is known.
    pub fn numbering(&self, class: &str) -> Option<&Numbering> {
        if self.is_of_codes(class) {
            return Some(&self.of_codes);
        }
        self.given.as_deref().or_else(|| self.by_class.get(class)?.numbering.as_deref())
    }

    /// Returns the learned shapes by class; none where an operator gave patterns.
    pub fn learned(&self) -> Arc<BTreeMap<Box<str>, Vec<String>>> {
        self.learned.clone()
    }

    fn sightings(&self, class: &str, text: &Text) -> Option<&[Sighting]> {
        self.by_class.get(class)?.sightings.get(text.gist()).map(Vec::as_slice)
    }

    /// Takes the rules of the map's settings.
    pub(super) fn set_rules(&mut self, settings: &Settings) {
        let patterns = &settings.identifier_patterns;
        self.given = (!patterns.is_empty()).then(|| Arc::new(Numbering::given(patterns.clone())));
        self.learns = settings.learned_identifiers;
        self.open.extend(self.by_class.keys().cloned());
    }

    /// Takes the classes whose texts are codes. What is kept of classes whose rule changes must have been removed before.
    pub(super) fn set_codes(&mut self, classes: &[String]) {
        let before =
            std::mem::replace(&mut self.codes, classes.iter().map(|class| (**class).into()).collect());
        self.open.extend(before.symmetric_difference(&self.codes).cloned());
    }

    /// Counts the readings of a detection that feeds an anchor, or no longer: it is gone, or about to be read anew.
    pub(super) fn count(
        &mut self,
        class: &str,
        anchor: AnchorSeq,
        observation: &Observation,
        parsed: &mut ParsedReadings,
        is_there: bool,
    ) {
        let is_code = self.is_of_codes(class);
        let sighting = (observation.keyframe, observation.detection, anchor);
        for reading in observation.readings() {
            self.change(class, &parsed.of(reading, is_code), |sightings| {
                match sightings.binary_search(&sighting) {
                    Err(at) if is_there => sightings.insert(at, sighting),
                    Ok(at) if !is_there => {
                        sightings.remove(at);
                    }
                    _ => {}
                }
            });
        }
    }

    fn change(&mut self, class: &str, reading: &ParsedReading, change: impl FnOnce(&mut Vec<Sighting>)) {
        let gist = &*reading.gist;
        if !self.by_class.contains_key(class) {
            self.by_class.insert(class.into(), OfClass::default());
        }
        let Some(of_class) = self.by_class.get_mut(class) else { return };
        if !of_class.sightings.contains_key(gist) {
            of_class.sightings.insert(gist.into(), Vec::new());
        }
        let Some(sightings) = of_class.sightings.get_mut(gist) else { return };
        let before = is_alike(sightings);
        // Few on the way from one keyframe to two; those of a text that hangs everywhere stay untouched.
        let concerned: Vec<AnchorSeq> =
            if before { Vec::new() } else { sightings.iter().map(|(.., anchor)| *anchor).collect() };
        change(sightings);
        let now = is_alike(sightings);
        if before != now {
            self.touched.extend(concerned);
            self.touched.extend(sightings.iter().map(|(.., anchor)| *anchor));
            if let Some(shape) = &reading.shape {
                let values = of_class.alike.entry(shape.clone()).or_default();
                *values = if now { *values + 1 } else { *values - 1 };
                if *values == 0 {
                    of_class.alike.remove(shape);
                }
                self.open.insert(class.into());
            }
        }
        if of_class.sightings.get(gist).is_some_and(Vec::is_empty) {
            of_class.sightings.remove(gist);
            if of_class.sightings.is_empty() {
                self.open.insert(class.into());
            }
        }
    }

    /// Takes the anchors that are to be described anew.
    pub(super) fn take_touched(&mut self) -> BTreeSet<AnchorSeq> {
        std::mem::take(&mut self.touched)
    }

    /// Learns the numbering of each class anew where that may have changed. Returns the classes whose numbering is another.
    pub(super) fn relearn(&mut self) -> BTreeSet<Box<str>> {
        let mut changed = BTreeSet::new();
        for class in std::mem::take(&mut self.open) {
            let Some(of_class) = self.by_class.get_mut(&class) else { continue };
            let learns = self.learns && self.given.is_none() && !self.codes.contains(&class);
            let learned = if learns { Numbering::learned(&of_class.alike) } else { None };
            let is_empty = of_class.sightings.is_empty();
            let is_another = learned.as_ref() != of_class.numbering.as_deref();
            of_class.numbering = learned.clone().map(Arc::new);
            if is_empty {
                self.by_class.remove(&class);
            }
            if is_another {
                let shapes = learned.iter().flat_map(Numbering::learned_or_given);
                let shapes: Vec<String> = shapes.map(str::to_owned).collect();
                let of_all = Arc::make_mut(&mut self.learned);
                if shapes.is_empty() {
                    of_all.remove(&class);
                } else {
                    of_all.insert(class.clone(), shapes);
                }
                changed.insert(class);
            }
        }
        changed
    }
}

fn is_alike(sightings: &[Sighting]) -> bool {
    let [first, .., last] = sightings else { return false };
    first.0 != last.0
}
