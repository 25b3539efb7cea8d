//! Wording: one painting described in several ways, and which pairs of descriptions a model is asked about: chosen by
//! words, and by embeddings.
//!
//! The model here knows the truth, so that what is left out was never asked. The embeddings are a real model's answers,
//! taken once (`tests/data/embeddings/wording.json`). Three sets are the paintings of development worlds of the hotel
//! under *other wording*; the fourth was written by hand to share few words.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use revisit::domain::change::Change;
use revisit::domain::judged::{Finding, ModelVerdict};
use revisit::domain::roles::Roles;
use revisit::recognition::anchors::apply_model_answer::learn_verdict;
use revisit::recognition::anchors::description_tasks::DescriptionTask;
use revisit::recognition::anchors::find_description_tasks::find_description_tasks;
use revisit::recognition::anchors::ingest::ingest;
use revisit::recognition::anchors::pairs::{Embedded, Embeddings, Settled};
use revisit::recognition::map::index::MapIndex;
use revisit::semantics::{Embedding, Text};
use serde::Deserialize;

use super::generated::keyframe;

const FIXTURE: &str = include_str!("../../tests/data/embeddings/wording.json");

#[derive(Deserialize)]
struct Fixture {
    sets: Vec<Set>,
}

/// Descriptions of paintings.
#[derive(Deserialize)]
pub struct Set {
    /// The place they are from.
    pub name: String,
    /// The painting, its description, and the description's embedding in base64.
    texts: Vec<(String, String, String)>,
}

/// The outcome of one way to choose pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Pairs that the model was asked about.
    pub asked: usize,
    /// Pairs of descriptions of one painting that match in the end.
    pub matched: usize,
    /// Pairs of descriptions of two paintings that match in the end, by the built-in judge's word.
    pub wrong: usize,
}

/// Reads the sets.
pub fn sets() -> Vec<Set> {
    serde_json::from_str::<Fixture>(FIXTURE).expect("the fixture").sets
}

struct AtHand(HashMap<String, Arc<Embedding>>);

impl Embeddings for AtHand {
    fn of(&self, text: &str) -> Embedded {
        self.0.get(text).map_or(Embedded::NotYet, |embedding| Embedded::As(embedding.clone()))
    }
}

impl Set {
    /// Counts the pairs of descriptions that are of one painting.
    pub fn of_one_painting(&self) -> usize {
        self.pairs().filter(|(a, b)| a.0 == b.0).count()
    }

    /// Lets the model say its word about every pair that is chosen.
    pub fn play(&self, by_embeddings: bool) -> Outcome {
        let painting_of: HashMap<String, &str> =
            self.texts.iter().map(|(painting, text, _)| (normal(text), painting.as_str())).collect();
        let at_hand = self.texts.iter().map(|(_, text, components)| {
            let bytes = STANDARD.decode(components).expect("base64");
            let embedding = Embedding::from_components(bytes.into_iter().map(u8::cast_signed).collect());
            (normal(text), Arc::new(embedding.expect("an embedding")))
        });
        let at_hand = AtHand(at_hand.collect());
        let embeddings = by_embeddings.then_some(&at_hand as &dyn Embeddings);
        let mut index = self.index();
        let roles = Roles { vision: false, text: true };
        let (mut settled, mut asked) = (Settled::new(), BTreeSet::new());
        loop {
            let open = find_description_tasks(&index, roles, embeddings, &mut settled, 256, |lack| {
                !matches!(lack, DescriptionTask::Similarity { .. } | DescriptionTask::Embedding { .. })
            });
            if open.found.is_empty() && open.is_all {
                break;
            }
            for lack in open.found {
                let DescriptionTask::Similarity { class, a, b } = lack else {
                    panic!("no embedding of {lack:?}")
                };
                let is_one = painting_of[&*a] == painting_of[&*b];
                asked.insert((a.clone(), b.clone()));
                let finding = Finding::Similarity(if is_one { 5 } else { 1 });
                let (source, reason, fingerprint) = ("model:truth".into(), "".into(), "".into());
                let verdict = ModelVerdict { class, a, b, finding, source, reason, fingerprint };
                learn_verdict(&mut index, verdict);
            }
        }
        let texts = index.texts();
        let matches = |a: &str, b: &str| {
            let [a, b] = [a, b].map(|text| texts.find_normalised("painting", &normal(text)));
            a.zip(b).and_then(|(a, b)| texts.level(a, b)).is_some()
        };
        let matching: Vec<bool> =
            self.pairs().filter(|(a, b)| matches(&a.1, &b.1)).map(|(a, b)| a.0 == b.0).collect();
        let matched = matching.iter().filter(|is_one| **is_one).count();
        Outcome { asked: asked.len(), matched, wrong: matching.len() - matched }
    }

    fn pairs(&self) -> impl Iterator<Item = (&(String, String, String), &(String, String, String))> {
        let texts = self.texts.iter().enumerate();
        texts.flat_map(|(at, a)| self.texts[at + 1..].iter().map(move |b| (a, b)))
    }

    /// Each description is an anchor far from all others.
    fn index(&self) -> MapIndex {
        let mut index = MapIndex::default();
        index.apply(&[Change::MapSet(Box::default())]);
        for (at, (_, text, _)) in self.texts.iter().enumerate() {
            let x = at as f64 * 50.0;
            ingest(
                &mut index,
                &keyframe(format!("kf-{at}"), x, ("painting", text.clone()), [x, 0.0, 2.0], &[]),
            );
        }
        index
    }
}

fn normal(text: &str) -> String {
    Text::parse(text).normalised().to_owned()
}
