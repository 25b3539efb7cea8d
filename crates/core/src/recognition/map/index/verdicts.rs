//! What a model said of texts: facts of the map, looked up instead of asked.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::domain::judged::{Finding, ModelVerdict};
use crate::semantics::{self, Source, Text};

/// A class and a text in normal form.
type Carried = (Box<str>, Box<str>);

/// A SimilarityLevel by a model.
#[derive(Clone, Debug, PartialEq)]
struct Found {
    level: u8,
    source: Arc<str>,
    reason: Box<str>,
}

/// The model's verdicts about the texts of a map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdicts {
    /// By class and the smaller text, then by the larger.
    similarity: BTreeMap<Carried, BTreeMap<Box<str>, Found>>,
    /// The other way round: the smaller texts that a larger one was judged with.
    smaller: BTreeMap<Carried, BTreeSet<Box<str>>>,
    information: BTreeMap<Carried, u8>,
    merges: BTreeMap<Carried, BTreeMap<Box<str>, Box<str>>>,
    count: usize,
}

impl Verdicts {
    pub(super) fn add(&mut self, verdict: &ModelVerdict) {
        let key = (verdict.class.clone(), verdict.a.clone());
        match &verdict.finding {
            Finding::Similarity(level) => {
                let larger = (verdict.class.clone(), verdict.b.clone());
                self.smaller.entry(larger).or_default().insert(verdict.a.clone());
                let (source, reason) = (verdict.source.clone(), verdict.reason.clone());
                let found = Found { level: *level, source, reason };
                let before = self.similarity.entry(key).or_default().insert(verdict.b.clone(), found);
                self.count += usize::from(before.is_none());
            }
            Finding::Information(level) => {
                self.count += usize::from(self.information.insert(key, *level).is_none());
            }
            Finding::Merge(text) => {
                let before = self.merges.entry(key).or_default().insert(verdict.b.clone(), text.clone());
                self.count += usize::from(before.is_none());
            }
        }
    }

    /// Returns how many there are.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// SimilarityLevel of two texts by a model, if one has judged them and the question was its own.
    pub fn similarity(&self, class: &str, a: &Text, b: &Text) -> Option<(u8, Source)> {
        let found = self.found(class, a, b)?;
        Some((found.level, Source::Model(found.source.clone())))
    }

    /// Returns why a model gave two texts their SimilarityLevel, if it has judged them and said why.
    pub fn reason(&self, class: &str, a: &Text, b: &Text) -> Option<&str> {
        Some(&*self.found(class, a, b)?.reason).filter(|reason| !reason.is_empty())
    }

    fn found(&self, class: &str, a: &Text, b: &Text) -> Option<&Found> {
        // What binds a model's answer binds it here as well, whoever wrote the row.
        if self.similarity.is_empty() || !semantics::similarity_is_open(a, b) {
            return None;
        }
        let (low, high) = ordered(a.normalised(), b.normalised());
        self.similarity.get(&carried(class, low))?.get(high)
    }

    /// Whether a verdict is known already, whoever gave it.
    pub fn says(&self, verdict: &ModelVerdict) -> bool {
        let key = carried(&verdict.class, &verdict.a);
        match &verdict.finding {
            Finding::Similarity(level) => {
                let found = self.similarity.get(&key).and_then(|with| with.get(&verdict.b));
                found.is_some_and(|found| found.level == *level)
            }
            Finding::Information(level) => self.information.get(&key) == Some(level),
            Finding::Merge(text) => self.merges.get(&key).and_then(|with| with.get(&verdict.b)) == Some(text),
        }
    }

    /// Returns the texts that a model has judged with this one.
    pub fn judged_with<'a>(&'a self, class: &str, text: &str) -> impl Iterator<Item = &'a str> {
        let key = carried(class, text);
        let larger = self.similarity.get(&key).into_iter().flat_map(BTreeMap::keys);
        let smaller = self.smaller.get(&key).into_iter().flatten();
        larger.chain(smaller).map(AsRef::as_ref)
    }

    /// InformationLevel of a text: the model's if it has one and the question was its own, else the built-in judge's.
    pub fn information_level(&self, class: &str, text: &Text) -> u8 {
        self.information(class, text).unwrap_or_else(|| text.information_level())
    }

    /// InformationLevel of a text by a model.
    pub fn information(&self, class: &str, text: &Text) -> Option<u8> {
        if self.information.is_empty() || !semantics::information_is_open(text) {
            return None;
        }
        self.information.get(&carried(class, text.normalised())).copied()
    }

    /// MergeText of two texts in normal form.
    pub fn merged(&self, class: &str, a: &str, b: &str) -> Option<&str> {
        let (low, high) = ordered(a, b);
        self.merges.get(&carried(class, low))?.get(high).map(AsRef::as_ref)
    }
}

fn carried(class: &str, text: &str) -> Carried {
    (class.into(), text.into())
}

fn ordered<'t>(a: &'t str, b: &'t str) -> (&'t str, &'t str) {
    if a <= b { (a, b) } else { (b, a) }
}
