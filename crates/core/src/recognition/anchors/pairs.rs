//! Pairs: which two texts a model is asked about (§IV-B).
//!
//! A text is judged with the few others that are most like it: by their words, or by their embeddings where a model makes
//! them (and those that are alike by their words besides). Together with the identifiers, which need no model, this keeps the number of calls in proportion to the
//! anchors, not to their pairs.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use super::description_tasks::DescriptionTask;
use super::near_in_meaning::near;
use crate::recognition::map::index::{MapIndex, TextId};
use crate::semantics::{self, Embedding, Route};

/// Maximum texts that one text is judged with by one measure.
pub(in crate::recognition) const NEIGHBOURS_JUDGED: usize = 6;

/// A class with so few texts is small enough to ask about texts that share no word: "a smiling lady", "the Mona Lisa".
pub(in crate::recognition) const SMALL_CLASS: usize = 32;

/// A word in more texts than this tells none of them apart.
pub(in crate::recognition) const WIDESPREAD: usize = 256;

/// In a class of more texts than this, words choose: to compare a text with all others takes too long.
pub(in crate::recognition) const EMBEDDED_CLASS_MAX: usize = 4096;

/// A class waits until so small a share of it, one in so many, has no embedding yet.
const WAITED_FOR: usize = 8;

/// Comparisons of embeddings in one look, which holds up the map's writers.
const COMPARISONS_MAX: usize = 1 << 18;

/// From this level of the built-in judge on a pair is asked about, however far apart its embeddings are.
const ALIKE_BY_WORDS: u8 = 4;

/// The embedding of a text, as far as it is known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Embedded {
    /// It is at hand.
    As(Arc<Embedding>),
    /// No model was asked for it yet.
    NotYet,
    /// A model was asked for it lately, and could not make it.
    Failed,
}

/// The embeddings at hand.
pub trait Embeddings: Send + Sync {
    /// Tells what is known of the embedding of a text in normal form.
    fn of(&self, text: &str) -> Embedded;
}

/// The texts whose pairs were all judged: they need not be looked at again.
pub type Settled = HashSet<(Box<str>, Box<str>)>;

/// Adds pairs that no model has judged to what was found, and the embeddings that are needed to choose them, until there
/// are `max`. Returns whether all was looked at.
pub(in crate::recognition) fn pairs(
    index: &MapIndex,
    embeddings: Option<&dyn Embeddings>,
    settled: &mut Settled,
    max: usize,
    found: &mut Vec<DescriptionTask>,
    passed_over: impl Fn(&DescriptionTask) -> bool,
) -> bool {
    let texts = index.texts();
    let mut seen: HashSet<DescriptionTask> = HashSet::new();
    let mut chosen_by =
        embeddings.map(|embeddings| ByMeaning { index, embeddings, classes: BTreeMap::new(), compared: 0 });
    for id in texts.iter() {
        let is_tired = chosen_by.as_ref().is_some_and(|by_meaning| by_meaning.compared > COMPARISONS_MAX);
        if found.len() >= max || is_tired {
            return false;
        }
        let (class, text) = texts.text(id);
        if !text.is_told_by_words() {
            continue;
        }
        let key = (class.into(), text.normalised().into());
        if settled.contains(&key) {
            continue;
        }
        let chosen = match &mut chosen_by {
            Some(by_meaning) => by_meaning.choose(id),
            None => Choice::of(nearest_by_words(index, id)),
        };
        let others = chosen.others.into_iter().map(|other| texts.text(other).1);
        let open = others.filter(|other| index.verdicts().similarity(class, text, other).is_none());
        let open = open.map(|other| similarity(class, text.normalised(), other.normalised()));
        let open: Vec<DescriptionTask> = open.collect();
        let is_settled = chosen.is_final && open.is_empty();
        for lack in chosen.lacks.into_iter().chain(open) {
            if found.len() < max && !passed_over(&lack) && seen.insert(lack.clone()) {
                found.push(lack);
            }
        }
        if is_settled {
            settled.insert(key);
        }
    }
    true
}

fn similarity(class: &str, a: &str, b: &str) -> DescriptionTask {
    let (a, b) = if a <= b { (a, b) } else { (b, a) };
    DescriptionTask::Similarity { class: class.into(), a: a.into(), b: b.into() }
}

/// The texts that a text is to be judged with.
#[derive(Default)]
struct Choice {
    others: Vec<TextId>,
    /// Embeddings that may change the choice, beside those that were named before.
    lacks: Vec<DescriptionTask>,
    /// Whether it stays while the class stays as it is.
    is_final: bool,
}

impl Choice {
    fn of(others: Vec<TextId>) -> Self {
        Self { others, lacks: Vec::new(), is_final: true }
    }
}

/// Chooses by embeddings.
struct ByMeaning<'a> {
    index: &'a MapIndex,
    embeddings: &'a dyn Embeddings,
    /// The texts of a class that words tell apart, with their embeddings; `None` where words choose.
    classes: BTreeMap<&'a str, Option<Class>>,
    compared: usize,
}

struct Class {
    /// In the order of the texts, so that equals have one order however the index came about.
    embedded: Vec<(TextId, Arc<Embedding>)>,
    /// The number of texts without an embedding so far, and those of them that were not named yet.
    missing: usize,
    lacks: Vec<DescriptionTask>,
}

impl ByMeaning<'_> {
    /// Chooses what a text is judged with, once nearly every text of its class has an embedding. A text whose embedding
    /// cannot be had is left out, and its own pairs are chosen by words.
    fn choose(&mut self, id: TextId) -> Choice {
        let texts = self.index.texts();
        let (class_name, text) = texts.text(id);
        let (index, embeddings) = (self.index, self.embeddings);
        let class = self.classes.entry(class_name);
        let class = class.or_insert_with(|| Class::of(index, class_name, embeddings));
        let Some(class) = class else { return Choice::of(nearest_by_words(index, id)) };
        let lacks = std::mem::take(&mut class.lacks);
        let own = match embeddings.of(text.normalised()) {
            Embedded::As(own) if WAITED_FOR * class.missing <= class.embedded.len() => own,
            Embedded::Failed => {
                return Choice { others: nearest_by_words(index, id), lacks, is_final: false };
            }
            Embedded::As(_) | Embedded::NotYet => return Choice { lacks, ..Choice::default() },
        };
        self.compared += class.embedded.len();
        // What is known to match says nothing of chance, and needs no question.
        let others: Vec<(f64, TextId)> = (class.embedded.iter())
            .filter(|(other, _)| *other != id && texts.level(id, *other).is_none())
            .filter_map(|(other, theirs)| Some((own.cosine(theirs)?, *other)))
            .collect();
        let is_final = class.missing == 0;
        Choice { others: near_ones(index, id, &others), lacks, is_final }
    }
}

/// Returns those that are near a text and open, and those that are alike by words, of others with their cosines.
fn near_ones(index: &MapIndex, id: TextId, others: &[(f64, TextId)]) -> Vec<TextId> {
    let texts = index.texts();
    let text = texts.text(id).1;
    let cosines: Vec<f64> = others.iter().map(|(cosine, _)| *cosine).collect();
    let is_open =
        |other: &TextId| matches!(semantics::route_similarity(text, texts.text(*other).1), Route::Open(_));
    let near = near(&cosines).into_iter().map(|at| others[at].1);
    let mut chosen: Vec<TextId> = near.filter(is_open).take(NEIGHBOURS_JUDGED).collect();
    let alike = nearest_by_words(index, id).into_iter().filter(|other| {
        let built_in = semantics::route_similarity(text, texts.text(*other).1);
        built_in.judgement().level >= ALIKE_BY_WORDS
    });
    for other in alike {
        if !chosen.contains(&other) {
            chosen.push(other);
        }
    }
    chosen
}

impl Class {
    /// Returns the texts of a class; `None` where there are too many, or so few that each is judged with each.
    fn of(index: &MapIndex, name: &str, embeddings: &dyn Embeddings) -> Option<Self> {
        let texts = index.texts();
        let of_class = texts.iter().filter(|id| texts.text(*id).0 == name);
        let told_by_words = of_class.filter(|id| texts.text(*id).1.is_told_by_words());
        let mut members: Vec<TextId> = told_by_words.take(EMBEDDED_CLASS_MAX + 1).collect();
        if !(NEIGHBOURS_JUDGED + 2..=EMBEDDED_CLASS_MAX).contains(&members.len()) {
            return None;
        }
        members.sort_by_key(|id| texts.text(*id).1.normalised());
        let mut class = Self { embedded: Vec::new(), missing: 0, lacks: Vec::new() };
        for id in members {
            let text = texts.text(id).1.normalised();
            match embeddings.of(text) {
                Embedded::As(embedding) => class.embedded.push((id, embedding)),
                Embedded::NotYet => class.lacks.push(DescriptionTask::Embedding { text: text.into() }),
                Embedded::Failed => {}
            }
        }
        class.missing = class.lacks.len();
        Some(class)
    }
}

/// Returns the texts whose words are most like this one's, about which a model may say more than the built-in judge.
fn nearest_by_words(index: &MapIndex, id: TextId) -> Vec<TextId> {
    let texts = index.texts();
    let (class, text) = texts.text(id);
    let candidates = match texts.of_class(class, SMALL_CLASS) {
        Some(all) => all.into_iter().filter(|other| *other != id).collect(),
        None => texts.sharing_words(id, WIDESPREAD),
    };
    let mut near: Vec<(u32, &str, TextId)> = (candidates.into_iter())
        .filter_map(|other| {
            let theirs = texts.text(other).1;
            let open = matches!(semantics::route_similarity(text, theirs), Route::Open(_));
            open.then(|| (semantics::likeness_percent(text, theirs), theirs.normalised(), other))
        })
        .collect();
    near.sort_by(|(a, name_a, _), (b, name_b, _)| b.cmp(a).then_with(|| name_a.cmp(name_b)));
    near.truncate(NEIGHBOURS_JUDGED);
    near.into_iter().map(|(_, _, other)| other).collect()
}
