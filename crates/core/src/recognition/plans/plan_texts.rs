//! Texts of the plans: which drawn signs bear a text that was read.
//!
//! A plan says how often it shows a text, so a general word may tell a place there: "kitchen" stands once. Texts are therefore
//! looked up whether or not they say enough for a loop.

use std::collections::{BTreeMap, BTreeSet};

use crate::domain::ids::AnchorSeq;
use crate::recognition::map::index::MapIndex;
use crate::semantics::Text;

/// Texts up to this length are held against texts that differ in one character.
pub(in crate::recognition) const SIMILAR_CHARS_MAX: usize = 12;

/// The characters that a reader takes for each other, as a gist has them.
const CHARACTERS: &str = "0123456789abcdefghijklmnopqrstuvwxyz";

/// The prior anchors of a map by class and gist.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanTexts {
    by_text: BTreeMap<(Box<str>, Box<str>), Vec<AnchorSeq>>,
}

impl PlanTexts {
    /// Collects the texts of a map's prior anchors.
    pub fn of(index: &MapIndex) -> Self {
        let mut by_text: BTreeMap<_, Vec<AnchorSeq>> = BTreeMap::new();
        for anchor in index.priors().frames().flat_map(|(_, anchors)| anchors) {
            let Some(object) = index.objects().get(*anchor) else { continue };
            let Some(description) = &object.description else { continue };
            let key = (index.class_of(object).into(), description.text.gist().into());
            by_text.entry(key).or_default().push(*anchor);
        }
        Self { by_text }
    }

    /// Returns the signs with a text, or, where the plans have none, those with one that means the same.
    pub fn same(&self, index: &MapIndex, class: &str, text: &Text) -> Vec<AnchorSeq> {
        let alike = self.exactly(class, text.gist());
        if !alike.is_empty() || self.by_text.is_empty() {
            return alike.to_vec();
        }
        let is_prior =
            |anchor: &AnchorSeq| index.anchor(*anchor).is_some_and(|anchor| anchor.prior.is_some());
        let matching = index.texts().matching_text(class, text).into_iter();
        let found: BTreeSet<AnchorSeq> =
            matching.flat_map(|text| index.texts().objects(text)).filter(is_prior).collect();
        found.into_iter().collect()
    }

    /// Returns the signs with a text that differs from one in a single character: what it may have been misread for.
    pub fn similar(&self, class: &str, text: &Text) -> Vec<AnchorSeq> {
        let characters: Vec<char> = text.gist().chars().collect();
        let mut found = BTreeSet::new();
        if characters.len() > SIMILAR_CHARS_MAX || self.by_text.is_empty() {
            return Vec::new();
        }
        for place in (0..characters.len()).filter(|place| CHARACTERS.contains(characters[*place])) {
            for other in CHARACTERS.chars().filter(|other| *other != characters[place]) {
                let mut changed = characters.clone();
                changed[place] = other;
                let changed: String = changed.into_iter().collect();
                found.extend(self.exactly(class, &changed));
            }
        }
        found.into_iter().collect()
    }

    fn exactly(&self, class: &str, gist: &str) -> &[AnchorSeq] {
        self.by_text.get(&(class.into(), gist.into())).map_or(&[], Vec::as_slice)
    }
}
