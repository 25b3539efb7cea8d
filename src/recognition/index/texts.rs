//! Which descriptions match: the index that keeps the number of judged pairs small (§IV-C.2).
//!
//! Ten thousand EXIT signs are one text. The judge therefore compares *distinct* texts, each new
//! one against those of its class that share a blocking key with it (an identifier, or a word
//! that two texts of level 4 must have in common); anchors match when their texts do. However
//! many anchors a map has, a new one costs the judgements of its text, and none if the text is known.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use super::verdicts::Verdicts;
use crate::model::ids::AnchorSeq;
use crate::semantics::{self, Source, Text};

/// Texts that match from this level on share a blocking key. A map that asks for less pays with every text of
/// the class being judged.
const COMPLETE_FROM_LEVEL: u8 = 4;

/// A distinct text of one class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TextId(usize);

#[derive(Clone, Debug)]
struct Node {
    class: Box<str>,
    text: Arc<Text>,
    objects: BTreeSet<AnchorSeq>,
    /// The other texts that match this one.
    matches: BTreeMap<TextId, (u8, Source)>,
}

/// Who carries a text, and which other texts match it.
type Content<'a> = (&'a BTreeSet<AnchorSeq>, BTreeMap<&'a str, (u8, Source)>);

/// The texts of a map's valid objects.
#[derive(Clone, Debug, Default)]
pub struct TextIndex {
    min_level: u8,
    nodes: Vec<Option<Node>>,
    free: Vec<TextId>,
    by_text: HashMap<(Box<str>, Box<str>), TextId>,
    by_key: HashMap<u64, Vec<TextId>>,
    /// By specific word, for what a model may be asked about.
    by_word: HashMap<Box<str>, BTreeSet<TextId>>,
    text_of: HashMap<AnchorSeq, TextId>,
    judged_pairs: u64,
}

impl TextIndex {
    /// An index in which texts match from this SimilarityLevel on.
    pub fn new(min_level: u8) -> Self {
        Self { min_level, ..Self::default() }
    }

    /// Texts match from this SimilarityLevel on.
    pub fn min_level(&self) -> u8 {
        self.min_level
    }

    /// The object carries this text now, or none that counts.
    pub fn set(&mut self, object: AnchorSeq, class: &str, text: Option<&Arc<Text>>, verdicts: &Verdicts) {
        let known = text.and_then(|text| self.find(class, text));
        if known.is_some() && self.text_of.get(&object) == known.as_ref() {
            return;
        }
        self.unset(object);
        let Some(text) = text else { return };
        let id = known.unwrap_or_else(|| self.add(class, text, verdicts));
        self.node_mut(id).objects.insert(object);
        self.text_of.insert(object, id);
    }

    /// The text an object carries.
    pub fn of(&self, object: AnchorSeq) -> Option<TextId> {
        self.text_of.get(&object).copied()
    }

    /// The text of this class that reads the same, if some object carries it.
    pub fn find(&self, class: &str, text: &Text) -> Option<TextId> {
        self.by_text.get(&(class.into(), text.normalised().into())).copied()
    }

    /// The text of this class with this normal form, if some object carries it.
    pub fn find_normalised(&self, class: &str, normalised: &str) -> Option<TextId> {
        self.by_text.get(&(class.into(), normalised.into())).copied()
    }

    /// A text, and the class of those that carry it.
    pub fn text(&self, id: TextId) -> (&str, &Arc<Text>) {
        let node = self.node(id);
        (&node.class, &node.text)
    }

    /// Every text, in no order that means anything.
    pub fn iter(&self) -> impl Iterator<Item = TextId> + '_ {
        self.nodes.iter().enumerate().filter_map(|(id, node)| node.as_ref().map(|_| TextId(id)))
    }

    /// The texts of a class, unless there are more than `max`.
    pub fn of_class(&self, class: &str, max: usize) -> Option<BTreeSet<TextId>> {
        let of_class: BTreeSet<TextId> =
            self.iter().filter(|id| &*self.node(*id).class == class).take(max + 1).collect();
        (of_class.len() <= max).then_some(of_class)
    }

    /// The texts of a class that share a specific word with this one, itself left out; each once, unless the word is
    /// in more than `widespread` texts and so tells nothing.
    pub fn sharing_words(&self, id: TextId, widespread: usize) -> BTreeSet<TextId> {
        let node = self.node(id);
        let lists = node.text.specific_words().filter_map(|word| self.by_word.get(word));
        let shared = lists.filter(|list| list.len() <= widespread).flatten().copied();
        shared.filter(|other| *other != id && self.node(*other).class == node.class).collect()
    }

    /// Do two texts of the map match, and who says so?
    pub fn level(&self, a: TextId, b: TextId) -> Option<(u8, Source)> {
        if a == b { Some((5, Source::Identical)) } else { self.node(a).matches.get(&b).cloned() }
    }

    /// The texts that match this one, itself among them.
    pub fn matching(&self, id: TextId) -> impl Iterator<Item = TextId> + '_ {
        std::iter::once(id).chain(self.node(id).matches.keys().copied())
    }

    /// The texts that match one that need not be in the index (an inline keyframe's).
    pub fn matching_text(&self, class: &str, text: &Text) -> Vec<TextId> {
        match self.find(class, text) {
            Some(id) => self.matching(id).collect(),
            None => self
                .candidates(class, text)
                .into_iter()
                .filter(|id| self.judge(text, *id, None).is_some())
                .collect(),
        }
    }

    /// The objects that carry a text, oldest first.
    pub fn objects(&self, id: TextId) -> impl Iterator<Item = AnchorSeq> + '_ {
        self.node(id).objects.iter().copied()
    }

    /// How many pairs of texts the judge has compared since the index was built.
    pub fn judged_pairs(&self) -> u64 {
        self.judged_pairs
    }

    fn node(&self, id: TextId) -> &Node {
        self.nodes[id.0].as_ref().expect("a text is named only as long as an object carries it")
    }

    fn node_mut(&mut self, id: TextId) -> &mut Node {
        self.nodes[id.0].as_mut().expect("a text is named only as long as an object carries it")
    }

    fn candidates(&self, class: &str, text: &Text) -> BTreeSet<TextId> {
        if self.min_level < COMPLETE_FROM_LEVEL {
            let every =
                self.nodes.iter().enumerate().filter_map(|(id, node)| Some((TextId(id), node.as_ref()?)));
            return every.filter(|(_, node)| &*node.class == class).map(|(id, _)| id).collect();
        }
        let sharing = text.keys().iter().filter_map(|key| self.by_key.get(key)).flatten().copied();
        sharing.filter(|id| &*self.node(*id).class == class).collect()
    }

    /// The judge's verdict, or the model's where the judge leaves the question open.
    fn judge(&self, text: &Text, id: TextId, verdicts: Option<&Verdicts>) -> Option<(u8, Source)> {
        let node = self.node(id);
        let by_model = verdicts.and_then(|verdicts| verdicts.similarity(&node.class, text, &node.text));
        let verdict = by_model.unwrap_or_else(|| semantics::similarity_level(text, &node.text));
        (verdict.0 >= self.min_level).then_some(verdict)
    }

    /// A model has judged two texts: if both are carried, they match now, or no longer.
    pub(super) fn rejudge(&mut self, class: &str, pair: [&str; 2], verdicts: &Verdicts) {
        let [Some(a), Some(b)] = pair.map(|text| self.by_text.get(&(class.into(), text.into())).copied())
        else {
            return;
        };
        if a == b {
            return;
        }
        let text = self.node(a).text.clone();
        let verdict = self.judge(&text, b, Some(verdicts));
        for (id, other) in [(a, b), (b, a)] {
            let matches = &mut self.node_mut(id).matches;
            match verdict.clone() {
                Some(verdict) => drop(matches.insert(other, verdict)),
                None => drop(matches.remove(&other)),
            }
        }
    }

    fn add(&mut self, class: &str, text: &Arc<Text>, verdicts: &Verdicts) -> TextId {
        let mut candidates = self.candidates(class, text);
        let judged = verdicts.judged_with(class, text.normalised());
        candidates.extend(judged.filter_map(|other| self.by_text.get(&(class.into(), other.into()))));
        self.judged_pairs += candidates.len() as u64;
        let matches: BTreeMap<_, _> = candidates
            .into_iter()
            .filter_map(|other| Some((other, self.judge(text, other, Some(verdicts))?)))
            .collect();
        let id = self.free.pop().unwrap_or(TextId(self.nodes.len()));
        if id.0 == self.nodes.len() {
            self.nodes.push(None);
        }
        for (other, verdict) in &matches {
            self.node_mut(*other).matches.insert(id, verdict.clone());
        }
        for key in text.keys() {
            self.by_key.entry(*key).or_default().push(id);
        }
        for word in text.specific_words() {
            self.by_word.entry(word.into()).or_default().insert(id);
        }
        self.by_text.insert((class.into(), text.normalised().into()), id);
        self.nodes[id.0] =
            Some(Node { class: class.into(), text: text.clone(), objects: BTreeSet::new(), matches });
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
        for other in node.matches.keys() {
            self.node_mut(*other).matches.remove(&id);
        }
        for key in node.text.keys() {
            if let Some(list) = self.by_key.get_mut(key) {
                list.retain(|listed| *listed != id);
                if list.is_empty() {
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
        self.by_text.remove(&(node.class, node.text.normalised().into()));
        self.free.push(id);
    }

    /// What the index says, without the numbers it says it by.
    fn content(&self) -> BTreeMap<(&str, &str), Content<'_>> {
        let named = |id: &TextId| self.node(*id).text.normalised();
        self.nodes
            .iter()
            .flatten()
            .map(|node| {
                let matches = node.matches.iter().map(|(id, verdict)| (named(id), verdict.clone())).collect();
                ((&*node.class, node.text.normalised()), (&node.objects, matches))
            })
            .collect()
    }
}

impl PartialEq for TextIndex {
    fn eq(&self, other: &Self) -> bool {
        self.min_level == other.min_level && self.content() == other.content()
    }
}
