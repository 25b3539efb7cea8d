//! The texts of a map, each with the objects that carry it and the texts that match it.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use super::identities::{Identities, IdentityId};
use super::matches::{Matches, Verdict};
use super::text_id::TextId;
use crate::domain::ids::AnchorSeq;
use crate::domain::judged::{Finding, ModelVerdict};
use crate::domain::settings::Settings;
use crate::recognition::map::index::verdicts::Verdicts;
use crate::semantics::{self, Source, Text};

/// Texts that match from this level on share a blocking key. A map that asks for less pays with every text of
/// the class being judged.
pub(super) const COMPLETE_FROM_LEVEL: u8 = 4;

/// So many matches of a text are listed: more than the signs of a real building have, and a few KiB. In this crate's own
/// tests two, so that the laws of maps hold across the bound as well.
pub(super) const LISTED_MAX: usize = if cfg!(test) { 2 } else { 64 };

/// A text with all that is known of it.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) class: Box<str>,
    pub(super) text: Arc<Text>,
    pub(super) objects: BTreeSet<AnchorSeq>,
    pub(super) matches: Matches,
    pub(super) identity: Option<IdentityId>,
}

/// The texts that have a blocking key.
#[derive(Clone, Debug, Default)]
pub(super) struct Sharing {
    pub(super) texts: Vec<TextId>,
    /// The number of them that have an identifier and no identity, which may match one text of an identity and not another.
    pub(super) undecided: usize,
}

/// The texts of a map's valid objects, and what a model said of texts.
#[derive(Clone, Debug)]
pub struct TextIndex {
    pub(super) min_level: u8,
    /// The most matches that a text lists.
    pub(super) listed_max: usize,
    pub(super) verdicts: Verdicts,
    pub(super) nodes: Vec<Option<Node>>,
    pub(super) free: Vec<TextId>,
    pub(super) by_text: HashMap<(Box<str>, Box<str>), TextId>,
    pub(super) by_key: HashMap<u64, Sharing>,
    pub(super) identities: Identities,
    /// By specific word, for what a model may be asked about.
    pub(super) by_word: HashMap<Box<str>, BTreeSet<TextId>>,
    pub(super) text_of: HashMap<AnchorSeq, TextId>,
    pub(super) judged_pairs: u64,
}

impl Default for TextIndex {
    /// Returns the texts of a map with the settings that maps have by default.
    fn default() -> Self {
        let min_level = Settings::default().matching_min_similarity_level;
        Self::new(u8::try_from(min_level).unwrap_or(u8::MAX), Verdicts::default())
    }
}

impl TextIndex {
    /// Returns an index in which texts match from this SimilarityLevel on, where a model has said this so far.
    pub fn new(min_level: u8, verdicts: Verdicts) -> Self {
        Self::listing(min_level, verdicts, LISTED_MAX)
    }

    /// Returns an index in which a text lists at most `listed_max` matches.
    pub(super) fn listing(min_level: u8, verdicts: Verdicts, listed_max: usize) -> Self {
        Self {
            min_level,
            listed_max,
            verdicts,
            nodes: Vec::new(),
            free: Vec::new(),
            by_text: HashMap::new(),
            by_key: HashMap::new(),
            identities: Identities::default(),
            by_word: HashMap::new(),
            text_of: HashMap::new(),
            judged_pairs: 0,
        }
    }

    /// Returns what a model said of texts.
    pub fn verdicts(&self) -> &Verdicts {
        &self.verdicts
    }

    /// Returns what a model said of texts, of an index that is done with.
    pub(in crate::recognition::map::index) fn into_verdicts(self) -> Verdicts {
        self.verdicts
    }

    /// A model has judged: if it compared two texts and both are carried, they match now, or no longer.
    pub(in crate::recognition::map::index) fn learn(&mut self, verdict: &ModelVerdict) {
        self.verdicts.add(verdict);
        if matches!(verdict.finding, Finding::Similarity(_)) {
            self.rejudge(&verdict.class, [&verdict.a, &verdict.b]);
        }
    }

    /// Texts match from this SimilarityLevel on.
    pub fn min_level(&self) -> u8 {
        self.min_level
    }

    /// Returns the text an object carries.
    pub fn of(&self, object: AnchorSeq) -> Option<TextId> {
        self.text_of.get(&object).copied()
    }

    /// Returns the text of this class that reads the same, if some object carries it.
    pub fn find(&self, class: &str, text: &Text) -> Option<TextId> {
        self.by_text.get(&(class.into(), text.normalised().into())).copied()
    }

    /// Returns the text of this class with this normal form, if some object carries it.
    pub fn find_normalised(&self, class: &str, normalised: &str) -> Option<TextId> {
        self.by_text.get(&(class.into(), normalised.into())).copied()
    }

    /// Returns the number of distinct texts.
    pub fn len(&self) -> usize {
        self.by_text.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.by_text.is_empty()
    }

    /// Returns a text, and the class of those that carry it.
    pub fn text(&self, id: TextId) -> (&str, &Arc<Text>) {
        let node = self.node(id);
        (&node.class, &node.text)
    }

    /// Returns every text, in no order that means anything.
    pub fn iter(&self) -> impl Iterator<Item = TextId> + '_ {
        self.nodes.iter().enumerate().filter_map(|(id, node)| node.as_ref().map(|_| TextId(id)))
    }

    /// Returns the texts of a class, unless there are more than `max`.
    pub fn of_class(&self, class: &str, max: usize) -> Option<BTreeSet<TextId>> {
        let of_class: BTreeSet<TextId> =
            self.iter().filter(|id| &*self.node(*id).class == class).take(max + 1).collect();
        (of_class.len() <= max).then_some(of_class)
    }

    /// Returns the texts of a class that share a specific word with this one, itself left out; each once, unless the
    /// word is in more than `widespread` texts and so tells nothing.
    pub fn sharing_words(&self, id: TextId, widespread: usize) -> BTreeSet<TextId> {
        let node = self.node(id);
        let lists = node.text.specific_words().filter_map(|word| self.by_word.get(word));
        let shared = lists.filter(|list| list.len() <= widespread).flatten().copied();
        shared.filter(|other| *other != id && self.node(*other).class == node.class).collect()
    }

    /// Returns whether two texts of the map match, and the source of that judgement.
    pub fn level(&self, a: TextId, b: TextId) -> Option<(u8, Source)> {
        let (of_a, of_b) = (self.node(a), self.node(b));
        if a == b {
            return self.with_itself(&of_a.text);
        }
        match (of_a.matches.listed(), of_b.matches.listed()) {
            (Some(list), _) => list.get(&b).cloned(),
            (None, Some(list)) => list.get(&a).cloned(),
            (None, None) if of_a.class == of_b.class => self.judge(&of_a.text, b),
            (None, None) => None,
        }
    }

    /// Returns the texts among `others` that [`Self::level`] may find to match; those that do are among them. `is_other` tells
    /// the same of one text.
    pub fn may_match(
        &self,
        id: TextId,
        others: impl ExactSizeIterator<Item = TextId>,
        is_other: impl Fn(TextId) -> bool,
    ) -> Vec<TextId> {
        match self.node(id).matches.listed() {
            Some(list) if list.len() < others.len() => {
                list.keys().copied().chain([id]).filter(|other| is_other(*other)).collect()
            }
            Some(list) => others.filter(|other| *other == id || list.contains_key(other)).collect(),
            None => others.collect(),
        }
    }

    /// Returns the verdict on a text that is read twice alike: "Level 5" is no match even then.
    pub fn with_itself(&self, text: &Text) -> Option<(u8, Source)> {
        self.counts(semantics::similarity_level(text, text))
    }

    /// Returns the identity of a text, if all texts of that identity match the same texts.
    pub fn identity(&self, id: TextId) -> Option<IdentityId> {
        let node = self.node(id);
        let is_undecided = |key: &u64| self.by_key.get(key).is_some_and(|sharing| sharing.undecided > 0);
        let decides = self.min_level >= COMPLETE_FROM_LEVEL && !node.text.keys().iter().any(is_undecided);
        node.identity.filter(|_| decides)
    }

    /// Whether a text has too many matches to be listed.
    pub fn is_crowded(&self, id: TextId) -> bool {
        self.node(id).matches.is_crowded()
    }

    /// Whether one object carries a text, and no other text matches it.
    pub fn is_of_one_object(&self, id: TextId) -> bool {
        let node = self.node(id);
        node.objects.len() == 1 && node.matches.listed().is_some_and(BTreeMap::is_empty)
    }

    /// Returns the objects that carry a text, oldest first.
    pub fn objects(&self, id: TextId) -> impl Iterator<Item = AnchorSeq> + '_ {
        self.node(id).objects.iter().copied()
    }

    /// Returns how many pairs of texts the judge has compared since the index was built.
    pub fn judged_pairs(&self) -> u64 {
        self.judged_pairs
    }

    /// Returns a text of the index.
    pub(super) fn node(&self, id: TextId) -> &Node {
        self.nodes[id.0].as_ref().expect("a text is named only as long as an object carries it")
    }

    /// Returns a text of the index, to be changed.
    pub(super) fn node_mut(&mut self, id: TextId) -> &mut Node {
        self.nodes[id.0].as_mut().expect("a text is named only as long as an object carries it")
    }

    /// In the order of their oldest objects, which is the same however the index came about.
    pub(super) fn by_age(&self, mut texts: Vec<TextId>) -> Vec<TextId> {
        texts.sort_by_cached_key(|id| self.node(*id).objects.first());
        texts
    }

    /// Returns the texts that the built-in judge may match with this one, it among them if it is in the index.
    pub(super) fn candidates(&self, class: &str, text: &Text) -> Vec<TextId> {
        if self.min_level < COMPLETE_FROM_LEVEL {
            return self.iter().filter(|id| &*self.node(*id).class == class).collect();
        }
        let lists = text.keys().iter().filter_map(|key| Some(&self.by_key.get(key)?.texts));
        let of_class = |id: &TextId| &*self.node(*id).class == class;
        let mut sharing: Vec<TextId> = lists.flatten().copied().filter(of_class).collect();
        sharing.sort_unstable();
        sharing.dedup();
        sharing
    }

    /// Returns the candidates, and the texts that a model has judged with this one.
    pub(super) fn partners(&self, class: &str, text: &Text) -> Vec<TextId> {
        let mut partners = self.candidates(class, text);
        let judged = self.verdicts.judged_with(class, text.normalised());
        let before = partners.len();
        partners.extend(judged.filter_map(|other| self.find_normalised(class, other)));
        if partners.len() > before {
            partners.sort_unstable();
            partners.dedup();
        }
        partners
    }

    /// Returns the judge's verdict, or the model's where the judge leaves the question open; none if it is no match.
    pub(super) fn judge(&self, text: &Text, id: TextId) -> Option<Verdict> {
        let node = self.node(id);
        let by_model = self.verdicts.similarity(&node.class, text, &node.text);
        self.counts(by_model.unwrap_or_else(|| semantics::similarity_level(text, &node.text)))
    }

    /// Returns a verdict that is high enough to match.
    pub(super) fn counts(&self, verdict: Verdict) -> Option<Verdict> {
        (verdict.0 >= self.min_level).then_some(verdict)
    }
}
