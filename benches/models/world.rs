//! World: 400 anchors of three kinds, and a model that says 5 to everything.
//!
//! Drift has put every two objects at one place: an anchor founded on one passage stands where another was founded on
//! an earlier one, and a third keyframe sees both neighbourhoods. Whatever matches there is merged at once.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};

use revisit::config::models::ModelArgs;
use revisit::domain::change::Change;
use revisit::domain::ids::AnchorSeq;
use revisit::domain::judged::{Finding, ModelVerdict};
use revisit::domain::judgement::TextFunction;
use revisit::domain::keyframe::{Detection, NewKeyframe, Stamp};
use revisit::domain::roles::Roles;
use revisit::geometry::{Point3, Pose};
use revisit::llm::Models;
use revisit::llm::adapters::Scripted;
use revisit::llm::port::{Model, Question};
use revisit::recognition::anchors::apply_model_answer::learn_verdict;
use revisit::recognition::anchors::description_tasks::DescriptionTask;
use revisit::recognition::anchors::find_description_tasks::find_description_tasks;
use revisit::recognition::anchors::ingest::ingest;
use revisit::recognition::anchors::pairs::Settled;
use revisit::recognition::map::index::{MapIndex, MergedAnchor};
use revisit::semantics;
use revisit::store::Store;

/// Anchors of the world.
pub const ANCHORS: usize = 400;

const LOOKS: [&str; 10] =
    ["small", "large", "dark", "bright", "faded", "gilded", "modern", "antique", "framed", "blurry"];
const MOTIFS: [&str; 20] = [
    "sailing boat",
    "lighthouse",
    "castle",
    "orchard",
    "violin",
    "falcon",
    "glacier",
    "harbour",
    "meadow",
    "dancer",
    "horse",
    "windmill",
    "bridge",
    "sunflower",
    "fisherman",
    "waterfall",
    "cathedral",
    "rabbit",
    "market",
    "volcano",
];
const AROUND: [&str; 7] =
    ["at dawn", "in a storm", "under clouds", "by moonlight", "in autumn", "near a river", "in snow"];

/// What came of the world.
#[derive(Debug)]
pub struct Outcome {
    /// Anchors founded.
    pub founded: usize,
    /// Objects left.
    pub objects: usize,
    /// Distinct pairs that the model was asked about.
    pub pairs_asked: usize,
    /// All calls.
    pub calls: usize,
    /// Objects whose readings have identifiers that exclude each other.
    pub wrongly_merged: usize,
    /// Pairs of anchors with identifiers that exclude each other and that match all the same.
    pub wrongly_matched: usize,
}

impl Outcome {
    /// Pairs without any thought: each anchor with each.
    pub fn naive_pairs(&self) -> usize {
        self.founded * (self.founded - 1) / 2
    }

    /// How many of them reach the model, in percent.
    pub fn asked_percent(&self) -> f64 {
        100.0 * self.pairs_asked as f64 / self.naive_pairs() as f64
    }
}

/// The pairs asked about, and all calls.
type Journal = (BTreeSet<(String, String)>, usize);

fn object(number: usize) -> (&'static str, String) {
    match number / 2 % 3 {
        0 => ("door_number", format!("{} {}", ["Room", "door", "Zimmer"][number % 3], 100 + number)),
        1 => {
            let (row, shelf) = ((b'A' + (number % 20) as u8) as char, number);
            ("shelf", format!("shelf {row}-{shelf} with {} boxes", ["red", "blue", "brown"][number % 3]))
        }
        _ => {
            let (look, around) = (LOOKS[number % 10], AROUND[number / 3 % 7]);
            ("painting", format!("a {look} painting of a {} {around}", MOTIFS[number * 7 / 2 % 20]))
        }
    }
}

/// A keyframe at x that sees an object with a description.
pub fn keyframe(
    name: String,
    x: f64,
    (class, text): (&str, String),
    at: [f64; 3],
    covisible: &[String],
) -> NewKeyframe {
    let pose = Pose::new([x, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).expect("a pose");
    NewKeyframe {
        covisible: Some(covisible.iter().map(|name| (name.parse().expect("an id"), 50)).collect()),
        detections: vec![Detection {
            position_in_session: Some(Point3::new(at[0], at[1], at[2])),
            description: Some(text),
            ..Detection::of(class, 0.9, [0.0, 0.0, 40.0, 40.0])
        }],
        ..NewKeyframe::at(name.parse().expect("an id"), Stamp { sec: 0, nanosec: 0 }, pose)
    }
}

fn world() -> MapIndex {
    let mut index = MapIndex::default();
    index.apply(&[Change::MapSet(Box::default())]);
    for place in 0..ANCHORS / 2 {
        let x = place as f64 * 10.0;
        let (first, second) = (format!("a-{place}"), format!("b-{place}"));
        let both = [first.clone(), second.clone()];
        ingest(&mut index, &keyframe(first, x, object(2 * place), [x, 0.0, 2.0], &[]));
        ingest(&mut index, &keyframe(second, x, object(2 * place + 1), [x + 0.2, 0.0, 2.0], &[]));
        ingest(&mut index, &keyframe(format!("c-{place}"), x, object(2 * place), [x, 0.0, 2.0], &both));
    }
    index
}

/// Builds the world and lets the model say its word about everything that is open.
pub async fn play() -> Outcome {
    let mut index = world();
    let founded = index.next_anchor().0 as usize;
    let asked: Arc<Mutex<Journal>> = Arc::default();
    let journal = asked.clone();
    let generous = Scripted::new("generous", move |question| {
        let mut journal = journal.lock().expect("a journal");
        journal.1 += 1;
        if let Question::Texts { function: TextFunction::Similarity, a, b, .. } = question {
            journal.0.insert((a.min(b).clone(), a.max(b).clone()));
        }
        Ok(match question {
            Question::Texts { function: TextFunction::Merge, a, b, .. } => {
                serde_json::json!({"text": format!("{a}, {b}")}).to_string()
            }
            _ => r#"{"level": 5}"#.to_owned(),
        })
    });
    let directory = tempfile::tempdir().expect("a directory");
    let store =
        Store::open(&format!("sqlite://{}/world.db", directory.path().display())).await.expect("a store");
    let none: [&str; 0] = [];
    let args = ModelArgs::of(&none).expect("defaults");
    let model: Arc<dyn Model> = Arc::new(generous);
    let models = Models::with([Some(model), None, None], None, &args, &store).await.expect("models");
    let roles = Roles { vision: false, text: true };
    let mut settled = Settled::new();
    loop {
        let open = find_description_tasks(&index, roles, None, &mut settled, 256, |_| false).found;
        if open.is_empty() {
            break;
        }
        for lack in open {
            if let Some(verdict) = judge(&models, lack).await {
                learn_verdict(&mut index, verdict);
            }
        }
    }
    let (pairs_asked, calls) = {
        let journal = asked.lock().expect("a journal");
        (journal.0.len(), journal.1)
    };
    store.close().await;
    let disagrees = |object: &MergedAnchor| {
        let numbering = index.readings().numbering(index.class_of(object));
        object.votes.disagreement(numbering).is_some()
    };
    let wrongly_merged = index.objects().iter().filter(|(_, object)| disagrees(object)).count();
    Outcome {
        founded,
        objects: index.objects().len(),
        pairs_asked,
        calls,
        wrongly_merged,
        wrongly_matched: wrongly_matched(&index),
    }
}

async fn judge(models: &Models, lack: DescriptionTask) -> Option<ModelVerdict> {
    let verdict = |class, a, b, finding, source: String| ModelVerdict {
        class,
        a,
        b,
        finding,
        source: source.into(),
        reason: "".into(),
        fingerprint: "".into(),
    };
    Some(match lack {
        DescriptionTask::Reading { .. } | DescriptionTask::Embedding { .. } => return None,
        DescriptionTask::Information { class, text } => {
            let judged = models.judge.information(&class, &text).await;
            verdict(class, text, "".into(), Finding::Information(judged.level), judged.source)
        }
        DescriptionTask::Similarity { class, a, b } => {
            let judged = models.judge.similarity(&class, &a, &b).await;
            verdict(class, a, b, Finding::Similarity(judged.level), judged.source)
        }
        DescriptionTask::Merge { class, a, b, as_read: [first, second] } => {
            let merged = models.judge.merge(&class, &first, &second).await;
            verdict(class, a, b, Finding::Merge(merged.text.into()), merged.source)
        }
    })
}

fn wrongly_matched(index: &MapIndex) -> usize {
    let texts = index.texts();
    let ids: Vec<_> = texts.iter().collect();
    let mut wrong = 0;
    for (n, a) in ids.iter().enumerate() {
        for b in &ids[n + 1..] {
            let excluded = semantics::conflict(texts.text(*a).1, texts.text(*b).1).is_some();
            wrong += usize::from(excluded && texts.level(*a, *b).is_some());
        }
    }
    wrong
}

/// Is there an anchor at all? Keeps the generator honest.
pub fn kinds() -> BTreeSet<String> {
    let index = world();
    (0..index.next_anchor().0)
        .filter_map(|seq| Some(index.anchor(AnchorSeq(seq))?.class.to_string()))
        .collect()
}
