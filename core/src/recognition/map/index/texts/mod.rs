//! Which descriptions match: the index that keeps the number of judged pairs small (§IV-C.2).
//!
//! Ten thousand EXIT signs are one text. The judge therefore compares *distinct* texts, each new
//! one against those of its class that share a blocking key with it (an identifier, or a word
//! that two texts of level 4 must have in common); anchors match when their texts do. However
//! many anchors a map has, a new one costs the judgements of its text, and none if the text is known.
//!
//! Where very many texts match each other ("room 901 ..."), lists of matches would grow with the square of
//! their number; a text with too many therefore keeps none, and is judged anew when asked about (`matches.rs`).

mod equality;
mod identities;
#[cfg(test)]
mod laws;
mod matches;
#[cfg(test)]
mod tests;
mod word_groups;

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

pub use self::identities::IdentityId;
use self::identities::{Identities, Judging};
use self::matches::{Matches, Verdict};
pub use self::word_groups::{GroupId, WordGroups};
use super::verdicts::Verdicts;
use crate::domain::ids::AnchorSeq;
use crate::domain::judged::{Finding, ModelVerdict};
use crate::domain::settings::Settings;
use crate::semantics::{self, Source, Text};

/// Texts that match from this level on share a blocking key. A map that asks for less pays with every text of
/// the class being judged.
const COMPLETE_FROM_LEVEL: u8 = 4;

/// So many matches of a text are listed: more than the signs of a real building have, and a few KiB. In this crate's own
/// tests two, so that the laws of maps hold across the bound as well.
const LISTED_MAX: usize = if cfg!(test) { 2 } else { 64 };

/// A distinct text of one class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TextId(usize);

#[derive(Clone, Debug)]
struct Node {
    class: Box<str>,
    text: Arc<Text>,
    objects: BTreeSet<AnchorSeq>,
    matches: Matches,
    identity: Option<IdentityId>,
}

/// The texts that have a blocking key.
#[derive(Clone, Debug, Default)]
struct Sharing {
    texts: Vec<TextId>,
    /// The number of them that have an identifier and no identity, which may match one text of an identity and not another.
    undecided: usize,
}

/// The texts of a map's valid objects, and what a model said of texts.
#[derive(Clone, Debug)]
pub struct TextIndex {
    min_level: u8,
    /// The most matches that a text lists.
    listed_max: usize,
    verdicts: Verdicts,
    nodes: Vec<Option<Node>>,
    free: Vec<TextId>,
    by_text: HashMap<(Box<str>, Box<str>), TextId>,
    by_key: HashMap<u64, Sharing>,
    identities: Identities,
    /// By specific word, for what a model may be asked about.
    by_word: HashMap<Box<str>, BTreeSet<TextId>>,
    text_of: HashMap<AnchorSeq, TextId>,
    judged_pairs: u64,
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

    fn listing(min_level: u8, verdicts: Verdicts, listed_max: usize) -> Self {
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
    pub(super) fn into_verdicts(self) -> Verdicts {
        self.verdicts
    }

    /// A model has judged: if it compared two texts and both are carried, they match now, or no longer.
    pub(super) fn learn(&mut self, verdict: &ModelVerdict) {
        self.verdicts.add(verdict);
        if matches!(verdict.finding, Finding::Similarity(_)) {
            self.rejudge(&verdict.class, [&verdict.a, &verdict.b]);
        }
    }

    /// Texts match from this SimilarityLevel on.
    pub fn min_level(&self) -> u8 {
        self.min_level
    }

    /// The object carries this text now, or none that counts.
    pub fn set(&mut self, object: AnchorSeq, class: &str, text: Option<&Arc<Text>>) {
        let known = text.and_then(|text| self.find(class, text));
        if known.is_some() && self.text_of.get(&object) == known.as_ref() {
            return;
        }
        self.unset(object);
        let Some(text) = text else { return };
        let id = known.unwrap_or_else(|| self.add(class, text));
        self.node_mut(id).objects.insert(object);
        self.text_of.insert(object, id);
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

    /// Returns the verdict on a text that is read twice alike: "Level 5" is no match even then.
    pub fn with_itself(&self, text: &Text) -> Option<(u8, Source)> {
        self.counts(semantics::similarity_level(text, text))
    }

    /// Returns the texts that match this one: itself, then the others in the order of their oldest objects.
    pub fn matching(&self, id: TextId) -> impl Iterator<Item = TextId> + '_ {
        let node = self.node(id);
        let listed = node.matches.listed().map(|list| list.keys().copied().collect());
        let is_listed = listed.is_some();
        let others = listed.unwrap_or_else(|| self.partners(&node.class, &node.text));
        let others = self.by_age(others).into_iter().filter(move |other| *other != id);
        let judging = Judging::of(self, &node.text);
        std::iter::once(id).chain(others.filter(move |other| is_listed || judging.matches(*other)))
    }

    /// Returns the texts that match this one, itself included, ascending by number.
    pub fn matching_set(&self, id: TextId) -> Vec<TextId> {
        let node = self.node(id);
        let mut found: Vec<TextId> = if let Some(list) = node.matches.listed() {
            list.keys().copied().collect()
        } else {
            let judging = Judging::of(self, &node.text);
            let others = self.partners(&node.class, &node.text).into_iter();
            others.filter(|other| *other != id && judging.matches(*other)).collect()
        };
        let at = found.partition_point(|other| *other < id);
        found.insert(at, id);
        found
    }

    /// Returns the identity of a text, if all texts of that identity match the same texts.
    pub fn identity(&self, id: TextId) -> Option<IdentityId> {
        let node = self.node(id);
        let is_undecided = |key: &u64| self.by_key.get(key).is_some_and(|sharing| sharing.undecided > 0);
        let decides = self.min_level >= COMPLETE_FROM_LEVEL && !node.text.keys().iter().any(is_undecided);
        node.identity.filter(|_| decides)
    }

    /// Returns the texts that match one that need not be in the index (an inline keyframe's).
    pub fn matching_text(&self, class: &str, text: &Text) -> Vec<TextId> {
        if let Some(id) = self.find(class, text) {
            return self.matching(id).collect();
        }
        let mut matching = self.candidates(class, text);
        let judging = Judging::of(self, text);
        matching.retain(|other| {
            judging.by_identity(*other).unwrap_or_else(|| {
                self.counts(semantics::similarity_level(text, &self.node(*other).text)).is_some()
            })
        });
        self.by_age(matching)
    }

    /// Whether a text has too many matches to be listed.
    pub fn is_crowded(&self, id: TextId) -> bool {
        self.node(id).matches.is_crowded()
    }

    /// Returns the objects that carry a text, oldest first.
    pub fn objects(&self, id: TextId) -> impl Iterator<Item = AnchorSeq> + '_ {
        self.node(id).objects.iter().copied()
    }

    /// Returns how many pairs of texts the judge has compared since the index was built.
    pub fn judged_pairs(&self) -> u64 {
        self.judged_pairs
    }

    fn node(&self, id: TextId) -> &Node {
        self.nodes[id.0].as_ref().expect("a text is named only as long as an object carries it")
    }

    fn node_mut(&mut self, id: TextId) -> &mut Node {
        self.nodes[id.0].as_mut().expect("a text is named only as long as an object carries it")
    }

    /// In the order of their oldest objects, which is the same however the index came about.
    fn by_age(&self, mut texts: Vec<TextId>) -> Vec<TextId> {
        texts.sort_by_cached_key(|id| self.node(*id).objects.first());
        texts
    }

    /// Returns the texts that the built-in judge may match with this one, it among them if it is in the index.
    fn candidates(&self, class: &str, text: &Text) -> Vec<TextId> {
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
    fn partners(&self, class: &str, text: &Text) -> Vec<TextId> {
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
    fn judge(&self, text: &Text, id: TextId) -> Option<Verdict> {
        let node = self.node(id);
        let by_model = self.verdicts.similarity(&node.class, text, &node.text);
        self.counts(by_model.unwrap_or_else(|| semantics::similarity_level(text, &node.text)))
    }

    fn counts(&self, verdict: Verdict) -> Option<Verdict> {
        (verdict.0 >= self.min_level).then_some(verdict)
    }

    fn rejudge(&mut self, class: &str, pair: [&str; 2]) {
        let [Some(a), Some(b)] = pair.map(|text| self.find_normalised(class, text)) else { return };
        if a == b {
            return;
        }
        let verdict = self.judge(&self.node(a).text, b);
        let max = self.listed_max;
        for (id, other) in [(a, b), (b, a)] {
            let matches = &mut self.node_mut(id).matches;
            match &verdict {
                Some(verdict) => matches.insert(other, verdict.clone(), max),
                None => matches.remove(other),
            }
        }
    }

    fn add(&mut self, class: &str, text: &Arc<Text>) -> TextId {
        let id = self.free.pop().unwrap_or(TextId(self.nodes.len()));
        if id.0 == self.nodes.len() {
            self.nodes.push(None);
        }
        let (mut matches, max) = (Matches::none(), self.listed_max);
        for other in self.partners(class, text) {
            // Neither would list the other.
            if matches.is_crowded() && self.node(other).matches.is_crowded() {
                continue;
            }
            self.judged_pairs += 1;
            if let Some(verdict) = self.judge(text, other) {
                self.node_mut(other).matches.insert(id, verdict.clone(), max);
                matches.insert(other, verdict, max);
            }
        }
        for key in text.keys() {
            let sharing = self.by_key.entry(*key).or_default();
            sharing.texts.push(id);
            sharing.undecided += usize::from(text.is_undecided_by_identity());
        }
        let identity = self.identities.join(class, text);
        for word in text.specific_words() {
            self.by_word.entry(word.into()).or_default().insert(id);
        }
        self.by_text.insert((class.into(), text.normalised().into()), id);
        self.nodes[id.0] = Some(Node {
            class: class.into(),
            text: text.clone(),
            objects: BTreeSet::new(),
            matches,
            identity,
        });
        id
    }

    fn unset(&mut self, object: AnchorSeq) {
        let Some(id) = self.text_of.remove(&object) else { return };
        let node = self.node_mut(id);
        node.objects.remove(&object);
        if !node.objects.is_empty() {
            return;
        }
        // Nobody carries the text any more: its matches are withdrawn with it.
        let Some(node) = self.nodes[id.0].take() else { return };
        self.identities.leave(&node.class, &node.text);
        for key in node.text.keys() {
            if let Some(sharing) = self.by_key.get_mut(key) {
                sharing.texts.retain(|listed| *listed != id);
                sharing.undecided -= usize::from(node.text.is_undecided_by_identity());
                if sharing.texts.is_empty() {
                    self.by_key.remove(key);
                }
            }
        }
        for word in node.text.specific_words() {
            if let Some(set) = self.by_word.get_mut(word) {
                set.remove(&id);
                if set.is_empty() {
                    self.by_word.remove(word);
                }
            }
        }
        self.by_text.remove(&(node.class.clone(), node.text.normalised().into()));
        let others = match node.matches {
            Matches::Listed(list) => list.into_keys().collect(),
            Matches::Crowded => self.partners(&node.class, &node.text),
        };
        for other in others {
            self.node_mut(other).matches.remove(id);
        }
        self.free.push(id);
    }
}
