//! How much is listed changes no answer, and neither does the order of arrival.

use std::collections::{BTreeMap, HashMap};
use std::time::Instant;

use proptest::prelude::*;

use std::sync::Arc;

use super::text_index::*;
use super::*;
use crate::domain::ids::AnchorSeq;
use crate::domain::judged::{Finding, ModelVerdict};
use crate::recognition::map::index::Verdicts;
use crate::semantics::{self, Source, Text};

const CLASSES: [&str; 2] = ["sign", "plate"];

/// Texts that share identifiers, words, or nothing; some read alike, some point elsewhere, some deny.
const TEXTS: [&str; 20] = [
    "floor 9 room 9 room 12 alpha",
    "alpha 9",
    "zeta 9",
    "red boat lake, no dogs",
    "room 901",
    "room 901 alpha",
    "room 901 beta",
    "room 901 not beta",
    "room 0901",
    "room 901 floor 9",
    "floor 9",
    "room 901 left",
    "9O1",
    "a red wooden boat on a lake",
    "a red boat on a lake",
    "a red wooden boat on the lake",
    "a blue boat on a lake",
    "red boat lake",
    "exit",
    "fire exit",
];

#[derive(Clone, Debug)]
enum Step {
    Set(u32, usize, usize),
    Unset(u32),
    Judged(usize, usize, usize, u8),
}

fn step() -> impl Strategy<Value = Step> {
    let text = || 0..TEXTS.len();
    prop_oneof![
        4 => (0..24u32, 0..CLASSES.len(), text()).prop_map(|(object, class, text)| Step::Set(object, class, text)),
        1 => (0..24u32).prop_map(Step::Unset),
        1 => (0..CLASSES.len(), text(), text(), 1..=5u8).prop_map(|(class, a, b, level)| Step::Judged(class, a, b, level)),
    ]
}

pub(super) fn similarity(class: &str, a: &str, b: &str, level: u8) -> ModelVerdict {
    let (a, b) = (Text::parse(a), Text::parse(b));
    let mut pair = [a.normalised(), b.normalised()];
    pair.sort_unstable();
    ModelVerdict {
        reason: "".into(),
        fingerprint: "".into(),
        class: class.into(),
        a: pair[0].into(),
        b: pair[1].into(),
        finding: Finding::Similarity(level),
        source: "model:test".into(),
    }
}

fn take(index: &mut TextIndex, step: &Step) {
    match step {
        Step::Set(object, class, text) => {
            let text = Arc::new(Text::parse(TEXTS[*text]));
            index.set(AnchorSeq(*object), CLASSES[*class], Some(&text));
        }
        Step::Unset(object) => index.set(AnchorSeq(*object), "", None),
        Step::Judged(class, a, b, level) => {
            index.learn(&similarity(CLASSES[*class], TEXTS[*a], TEXTS[*b], *level));
        }
    }
}

type Name = (String, String);

/// All that an index answers, by what texts read.
#[derive(Debug, PartialEq)]
struct Answers {
    levels: BTreeMap<(Name, Name), Option<(u8, Source)>>,
    matching: BTreeMap<Name, Vec<Name>>,
    of_guests: Vec<Vec<Name>>,
}

fn answers(index: &TextIndex) -> Answers {
    let name = |id| {
        let (class, text) = index.text(id);
        (class.to_owned(), text.normalised().to_owned())
    };
    let pairs = || index.iter().flat_map(|a| index.iter().map(move |b| (a, b)));
    let of_guest = |class, text| {
        let matching = index.matching_text(class, &Text::parse(text));
        matching.into_iter().map(name).collect()
    };
    let guests = TEXTS.iter().chain(&["room 901 gamma", "a wooden red boat"]);
    Answers {
        levels: pairs().map(|(a, b)| ((name(a), name(b)), index.level(a, b))).collect(),
        matching: index.iter().map(|id| (name(id), index.matching(id).map(name).collect())).collect(),
        of_guests: guests
            .flat_map(|text| CLASSES.map(|class| (class, *text)))
            .map(|(c, t)| of_guest(c, t))
            .collect(),
    }
}

/// The letter: every pair of texts of one class is judged.
pub(super) fn by_the_letter(index: &TextIndex, a: TextId, b: TextId) -> Option<(u8, Source)> {
    let ((class_a, text_a), (class_b, text_b)) = (index.text(a), index.text(b));
    let verdict = index
        .verdicts()
        .similarity(class_a, text_a, text_b)
        .unwrap_or_else(|| semantics::similarity_level(text_a, text_b));
    (class_a == class_b && verdict.0 >= index.min_level).then_some(verdict)
}

proptest! {
    #[test]
    fn listing_changes_no_answer(
        steps in prop::collection::vec(step(), 0..80),
        min_level in 3..=5u8,
        listed_max in 0..4usize,
    ) {
        let index = |listed_max| TextIndex::listing(min_level, Verdicts::default(), listed_max);
        let (mut few, mut all) = (index(listed_max), index(usize::MAX));
        for step in &steps {
            take(&mut few, step);
            take(&mut all, step);
        }
        prop_assert_eq!(answers(&few), answers(&all));
        prop_assert_eq!(&few, &all);
        prop_assert_eq!(&all, &few);
        for a in few.iter() {
            for b in few.iter().filter(|b| *b != a) {
                prop_assert_eq!(few.level(a, b), by_the_letter(&few, a, b));
            }
        }
    }

    #[test]
    fn texts_of_one_identity_match_what_judging_every_pair_says(
        steps in prop::collection::vec(step(), 0..80),
        min_level in 1..=5u8,
        listed_max in 0..4usize,
    ) {
        let mut index = TextIndex::listing(min_level, Verdicts::default(), listed_max);
        for step in &steps {
            take(&mut index, step);
        }
        let mut of_identity: HashMap<IdentityId, Vec<TextId>> = HashMap::new();
        for a in index.iter() {
            let matches = |b: &TextId| *b == a || by_the_letter(&index, a, *b).is_some();
            let letter: Vec<TextId> = index.iter().filter(matches).collect();
            let mut by_age: Vec<TextId> = index.matching(a).collect();
            by_age.sort_unstable();
            prop_assert_eq!(&index.matching_set(a), &letter);
            prop_assert_eq!(&by_age, &letter);
            if let Some(identity) = index.identity(a) {
                prop_assert_eq!(of_identity.entry(identity).or_insert_with(|| letter.clone()), &letter);
            }
        }
        for text in TEXTS.iter().chain(&["room 901 gamma", "room 901 not gamma", "room 901 right"]) {
            let text = Text::parse(text);
            let Some(class) = CLASSES.iter().find(|class| index.find(class, &text).is_none()) else { continue };
            let is_match = |id: &TextId| {
                let (of, theirs) = index.text(*id);
                of == *class && semantics::similarity_level(&text, theirs).0 >= min_level
            };
            let mut found = index.matching_text(class, &text);
            found.sort_unstable();
            prop_assert_eq!(found, index.iter().filter(is_match).collect::<Vec<_>>());
        }
    }

    #[test]
    fn the_order_of_arrival_changes_no_answer(
        steps in prop::collection::vec(step(), 0..80),
        listed_max in 0..4usize,
    ) {
        let mut live = TextIndex::listing(4, Verdicts::default(), listed_max);
        for step in &steps {
            take(&mut live, step);
        }
        let carried: BTreeMap<AnchorSeq, TextId> = live.text_of.iter().map(|(a, id)| (*a, *id)).collect();
        for backwards in [false, true] {
            let mut rebuilt = TextIndex::listing(4, live.verdicts().clone(), listed_max);
            let mut order: Vec<_> = carried.iter().collect();
            if backwards {
                order.reverse();
            }
            for (object, id) in order {
                let (class, text) = live.text(*id);
                rebuilt.set(*object, class, Some(text));
            }
            prop_assert_eq!(answers(&rebuilt), answers(&live));
            prop_assert_eq!(&rebuilt, &live);
        }
    }
}

#[test]
fn indexes_that_differ_in_one_match_are_not_equal_whatever_they_list() {
    let with = |listed_max, verdict: Option<u8>| {
        let mut index = TextIndex::listing(4, Verdicts::default(), listed_max);
        for (object, text) in [9, 11, 12].into_iter().enumerate() {
            take(&mut index, &Step::Set(object as u32, 0, text + 4));
        }
        if let Some(level) = verdict {
            take(&mut index, &Step::Judged(0, 13, 16, level));
        }
        index
    };
    for (a, b) in [(0, 0), (0, 64), (64, 64)] {
        assert_eq!(with(a, Some(5)), with(b, Some(5)));
        assert_ne!(with(a, Some(5)), with(b, Some(4)));
        assert_ne!(with(a, Some(5)), with(b, None));
    }
}

#[test]
fn a_crowd_is_not_listed_and_seldom_judged() {
    let index = crowd(500);
    let listed: usize =
        index.nodes.iter().flatten().filter_map(|node| Some(node.matches.listed()?.len())).sum();
    assert_eq!(listed, 0);
    let id = index.of(AnchorSeq(7)).unwrap();
    assert_eq!(index.matching(id).count(), 500);
    // Each newcomer is crowded after as many judgements as it may list, and one.
    assert!(index.judged_pairs() <= 500 * (LISTED_MAX as u64 + 1), "{}", index.judged_pairs());
}

fn crowd(texts: u32) -> TextIndex {
    let letters = |n: u32| (0..4).map(|at| char::from(b'b' + (n >> (at * 4) & 15) as u8)).collect::<String>();
    carried((0..texts).map(|n| format!("a plate with room 901, x{}", letters(n))), LISTED_MAX)
}

fn carried(texts: impl Iterator<Item = String>, listed_max: usize) -> TextIndex {
    let mut index = TextIndex::listing(4, Verdicts::default(), listed_max);
    for (n, text) in texts.enumerate() {
        index.set(AnchorSeq(n as u32), "sign", Some(&Arc::new(Text::parse(&text))));
    }
    index
}

/// `cargo test --lib prints_the_cost_of_crowds -- --ignored --nocapture`
#[test]
#[ignore = "prints figures"]
fn prints_the_cost_of_crowds() {
    let tell = |name: &str, listed_max: usize, texts: &dyn Fn(u32) -> String| {
        for count in [750, 1500, 3000, 6000] {
            let start = Instant::now();
            let index = carried((0..count).map(texts), listed_max);
            let built = start.elapsed();
            let nodes = index.nodes.iter().flatten();
            let listed: usize = nodes.filter_map(|node| Some(node.matches.listed()?.len())).sum();
            let start = Instant::now();
            let found = index.matching(index.of(AnchorSeq(0)).unwrap()).count();
            println!(
                "{name}, {listed_max} listed at most: {count} texts, {listed} matches listed, {} pairs judged, built in {built:.0?}; {found} matches of one in {:.0?}",
                index.judged_pairs(),
                start.elapsed()
            );
        }
    };
    let room = |n: u32| {
        let letters: String = (0..4).map(|at| char::from(b'b' + (n >> (at * 4) & 15) as u8)).collect();
        format!("room 901 x{letters}")
    };
    tell("all alike", 64, &room);
    tell("all alike", 2000, &room);
    tell("one number, other floors", 64, &|n| format!("room 901 floor {}", n + 1));
}
