//! Identities and word groups change no answer: each is held against judging every pair.

use std::collections::{BTreeSet, HashMap};

use proptest::prelude::*;
use proptest::sample::subsequence;

use std::sync::Arc;

use super::text_index::*;
use super::*;
use crate::domain::ids::AnchorSeq;
use crate::recognition::map::index::Verdicts;
use crate::semantics::Text;

/// Parts of texts; those of equal identifiers sort before or after others by their first word.
const IDENTIFIERS: [&str; 16] = [
    "alpha", "zeta", "floor 9", "room 9", "9", "suite 12", "room 12", "12-15", "901-905", "room 903", "9O1",
    "0901", "901", "gate 7", "left", "not beta",
];
const WORDS: [&str; 18] = [
    "boat", "lake", "wooden", "stormy", "castle", "harbour", "windmill", "red", "blue", "2 kg", "3 kg",
    "left", "not dogs", "dogs", "sails", "beta", "floor 9", "floor 8",
];

fn texts(parts: &'static [&'static str], most: usize) -> impl Strategy<Value = Vec<String>> {
    prop::collection::vec(subsequence(parts, 1..=most).prop_map(|parts| parts.join(", ")), 0..24)
}

/// Texts that have many words in common, so that many match.
fn crowds() -> impl Strategy<Value = Vec<String>> {
    let text = (prop::bool::weighted(0.8), subsequence(&WORDS[..], 0..=3)).prop_map(|(is_crowd, parts)| {
        let common = if is_crowd { "boat lake wooden stormy castle harbour windmill " } else { "boat lake " };
        format!("{common}{}", parts.join(" "))
    });
    prop::collection::vec(text, 0..24)
}

fn index(texts: &[String], min_level: u8, judged: &[(usize, usize, u8)]) -> TextIndex {
    let mut index = TextIndex::listing(min_level, Verdicts::default(), 2);
    for (number, text) in texts.iter().enumerate() {
        let class = if number % 7 == 6 { "plate" } else { "sign" };
        index.set(AnchorSeq(number as u32), class, Some(&Arc::new(Text::parse(text))));
    }
    for (a, b, level) in judged {
        if let (Some(a), Some(b)) = (texts.get(*a), texts.get(*b)) {
            index.learn(&super::tests::similarity("sign", a, b, *level));
        }
    }
    index
}

fn by_the_letter(index: &TextIndex, a: TextId) -> Vec<TextId> {
    let matches = |b: &TextId| *b == a || super::tests::by_the_letter(index, a, *b).is_some();
    index.iter().filter(matches).collect()
}

proptest! {
    #[test]
    fn texts_of_one_identity_match_the_same(texts in texts(&IDENTIFIERS, 5), min_level in 3..=5u8) {
        let index = index(&texts, min_level, &[]);
        let mut of_identity: HashMap<IdentityId, Vec<TextId>> = HashMap::new();
        for id in index.iter() {
            let letter = by_the_letter(&index, id);
            prop_assert_eq!(&index.matching_set(id), &letter);
            if let Some(identity) = index.identity(id) {
                prop_assert_eq!(of_identity.entry(identity).or_insert_with(|| letter.clone()), &letter);
            }
        }
    }

    #[test]
    fn texts_of_one_word_group_match_the_same_but_for_exceptions(
        texts in prop_oneof![crowds(), texts(&WORDS, 8)],
        min_level in 3..=5u8,
        judged in prop::collection::vec((0..24usize, 0..24usize, 1..=5u8), 0..4),
    ) {
        let index = index(&texts, min_level, &judged);
        let mut groups = WordGroups::of(&index);
        for id in index.iter() {
            let letter: BTreeSet<TextId> = by_the_letter(&index, id).into_iter().collect();
            if let Some(group) = groups.group(id) {
                let of_group: BTreeSet<TextId> = groups.matching(&index, group).into_iter().collect();
                let found = &of_group ^ &groups.exceptions(&index, id, group);
                prop_assert_eq!(&found, &letter, "{:?}", index.text(id).1.normalised());
            }
            prop_assert_eq!(index.matching_set(id).into_iter().collect::<BTreeSet<_>>(), letter);
        }
    }
}
