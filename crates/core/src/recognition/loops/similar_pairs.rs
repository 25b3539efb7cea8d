//! Pairs of similar descriptions between two local anchor maps, found once for all that a comparison asks of them.
//!
//! Two maps of a hundred anchors have ten thousand pairs, and few are similar. The texts of the map list their matches, so
//! these are looked up among the candidate's texts, and only what lists none is held against each of them.

use std::collections::HashMap;

use super::anchor_map::LocalAnchor;
use super::equation_1::similar;
use crate::domain::settings::Settings;
use crate::recognition::map::index::{TextId, TextIndex};
use crate::semantics::Source;

/// A counterpart of an anchor of the query's map, wherever it stands.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::recognition) struct Counterpart {
    /// Its place in the candidate's map.
    pub candidate: usize,
    /// SimilarityLevel of the two descriptions, and who judged.
    pub judged: (u8, Source),
}

/// The similar pairs of two lists of anchors.
#[derive(Clone, Debug)]
pub(in crate::recognition) struct SimilarPairs {
    /// By anchor of the query's map; ascending by anchor of the candidate's.
    of_query: Vec<Vec<Counterpart>>,
    /// Whether an anchor of the candidate's map has a counterpart.
    has_counterpart: Vec<bool>,
}

impl SimilarPairs {
    /// Finds the similar pairs between the anchors of two maps.
    pub fn between(
        query: &[&LocalAnchor],
        candidate: &[&LocalAnchor],
        texts: &TextIndex,
        settings: &Settings,
    ) -> Self {
        let mut by_text: HashMap<TextId, Vec<usize>> = HashMap::new();
        let mut unlisted = Vec::new();
        for (j, anchor) in candidate.iter().enumerate() {
            match anchor.text_id {
                Some(text) => by_text.entry(text).or_default().push(j),
                None => unlisted.push(j),
            }
        }
        let counterparts = |anchor: &&LocalAnchor| {
            let may_be: Vec<usize> = match anchor.text_id {
                Some(text) => texts
                    .may_match(text, by_text.keys().copied(), |other| by_text.contains_key(&other))
                    .into_iter()
                    .flat_map(|other| &by_text[&other])
                    .chain(&unlisted)
                    .copied()
                    .collect(),
                None => (0..candidate.len()).collect(),
            };
            let judged = may_be.into_iter().filter_map(|j| {
                let judged = similar(anchor, candidate[j], texts, settings)?;
                Some(Counterpart { candidate: j, judged })
            });
            let mut found: Vec<Counterpart> = judged.collect();
            found.sort_unstable_by_key(|counterpart| counterpart.candidate);
            found
        };
        let of_query: Vec<Vec<Counterpart>> = query.iter().map(counterparts).collect();
        let mut has_counterpart = vec![false; candidate.len()];
        for counterpart in of_query.iter().flatten() {
            has_counterpart[counterpart.candidate] = true;
        }
        Self { of_query, has_counterpart }
    }

    /// Returns the pairs, in the order of the two maps.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &Counterpart)> {
        self.of_query.iter().enumerate().flat_map(|(i, found)| found.iter().map(move |pair| (i, pair)))
    }

    /// Returns the pair of two anchors, if it is similar.
    pub fn get(&self, query: usize, candidate: usize) -> Option<&Counterpart> {
        let found = self.of_query.get(query)?;
        found.binary_search_by_key(&candidate, |pair| pair.candidate).ok().map(|at| &found[at])
    }

    /// Returns the anchors that nothing on the other side is called like: the query's, and the candidate's.
    ///
    /// "Unmatched on the other side" is taken by description alone: a plate that also hangs somewhere in the other map is
    /// known there, and seeing its neighbour in its place means another point of view, not another building.
    pub fn unmatched<'a>(
        &self,
        query: &[&'a LocalAnchor],
        candidate: &[&'a LocalAnchor],
    ) -> [Vec<&'a LocalAnchor>; 2] {
        let [of_query, of_candidate] = self.unmatched_places();
        [
            of_query.into_iter().map(|place| query[place]).collect(),
            of_candidate.into_iter().map(|place| candidate[place]).collect(),
        ]
    }

    /// Returns the places of the same in the two lists.
    pub fn unmatched_places(&self) -> [Vec<usize>; 2] {
        let of_query = self.of_query.iter().enumerate().filter(|(_, found)| found.is_empty());
        let of_candidate = self.has_counterpart.iter().enumerate().filter(|(_, has)| !**has);
        [of_query.map(|(place, _)| place).collect(), of_candidate.map(|(place, _)| place).collect()]
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use proptest::prelude::*;

    use super::*;
    use crate::domain::anchor::AnchorState;
    use crate::domain::ids::AnchorSeq;
    use crate::geometry::{Bearing, Point3, Pose};
    use crate::recognition::loops::anchor_map::LocalName;
    use crate::recognition::map::index::Certainty;
    use crate::semantics::Text;

    // More of them match one text than it lists in this crate's own tests.
    const TEXTS: [&str; 9] = [
        "EXIT",
        "room 901",
        "room 901 oak",
        "room 901 glass",
        "901",
        "room 910",
        "a red wooden boat on a lake",
        "red wooden boat, lake",
        "Level 5",
    ];

    /// An anchor: its text, its class, and whether an object of the map carries the text.
    type Drawn = (usize, bool, bool);

    fn anchor(texts: &TextIndex, number: usize, (text, is_door, _): Drawn) -> LocalAnchor {
        let centre = Point3::new(0.0, 0.0, 1.0);
        LocalAnchor {
            name: LocalName::MergedAnchor(AnchorSeq(number as u32)),
            class: class(is_door).into(),
            state: AnchorState::Valid,
            description: None,
            text: Some(Arc::new(Text::parse(TEXTS[text]))),
            kind: None,
            text_id: texts.of(AnchorSeq(number as u32)),
            certainty: Certainty::Sure,
            centre_in_session: centre,
            range_assumed: false,
            bearing: Bearing::of(&centre, &Pose::identity()),
            weight: 1.0,
            places: 1,
        }
    }

    fn class(is_door: bool) -> &'static str {
        if is_door { "door" } else { "sign" }
    }

    fn map() -> impl Strategy<Value = Vec<Drawn>> {
        prop::collection::vec((0..TEXTS.len(), prop::bool::weighted(0.7), prop::bool::weighted(0.8)), 0..12)
    }

    proptest! {
        #[test]
        fn pairs_are_those_that_comparing_all_finds(query in map(), candidate in map()) {
            let (settings, mut texts) = (Settings::default(), TextIndex::default());
            for (number, (text, is_door, is_known)) in query.iter().chain(&candidate).enumerate() {
                let text = is_known.then(|| Arc::new(Text::parse(TEXTS[*text])));
                texts.set(AnchorSeq(number as u32), class(*is_door), text.as_ref());
            }
            let anchors: Vec<LocalAnchor> = query.iter().chain(&candidate).enumerate()
                .map(|(number, drawn)| anchor(&texts, number, *drawn))
                .collect();
            let (of_query, of_candidate) = anchors.split_at(query.len());
            let (a, b): (Vec<&LocalAnchor>, Vec<&LocalAnchor>) = (of_query.iter().collect(), of_candidate.iter().collect());
            let found = SimilarPairs::between(&a, &b, &texts, &settings);
            let mut pairs = found.iter();
            for (i, x) in a.iter().enumerate() {
                for (j, y) in b.iter().enumerate() {
                    let judged = similar(x, y, &texts, &settings);
                    prop_assert_eq!(found.get(i, j).map(|pair| pair.judged.clone()), judged.clone());
                    if let Some(judged) = judged {
                        prop_assert_eq!(pairs.next(), Some((i, &Counterpart { candidate: j, judged })));
                    }
                }
            }
            prop_assert_eq!(pairs.next(), None);
            let alike = |x: &LocalAnchor, y: &LocalAnchor| similar(x, y, &texts, &settings).is_some();
            let names = |anchors: &[&LocalAnchor]| anchors.iter().map(|anchor| anchor.name).collect::<Vec<_>>();
            let alone_in = |these: &[&LocalAnchor], those: &[&LocalAnchor]| {
                let alone: Vec<&LocalAnchor> =
                    these.iter().copied().filter(|x| !those.iter().any(|y| alike(x, y))).collect();
                names(&alone)
            };
            let [alone_of_query, alone_of_candidate] = found.unmatched(&a, &b);
            prop_assert_eq!(names(&alone_of_query), alone_in(&a, &b));
            prop_assert_eq!(names(&alone_of_candidate), alone_in(&b, &a));
        }
    }
}
