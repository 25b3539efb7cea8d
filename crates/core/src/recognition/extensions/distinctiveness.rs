//! How distinctive a description is: in how many places does it stand (M6)?
//!
//! The paper weighs an anchor by 1/d alone, so that an EXIT sign that hangs at every corner
//! speaks as loudly as a door number that hangs once; on generated hotels that drops precision to
//! 79 %. A description that stands in p places weighs 1/p. Places are counted within one
//! session's frame, since frames of different sessions cannot be compared; the largest count stands.
//! [`Sighting`] tells whether two may be one place.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use super::sighting::Sighting;
use crate::domain::ids::{AnchorSeq, KeyframeSeq, SessionSeq};
use crate::geometry::Point3;
use crate::recognition::anchors::match_sets::{MatchSets, SetId};
use crate::recognition::loops::centre::Centre;
use crate::recognition::map::index::{MapIndex, TextId};
use crate::semantics::{self, Text};

/// Counting ends at this number of places: what hangs in more says next to nothing of any.
pub(in crate::recognition) const PLACES_MAX: usize = 64;

/// An anchor of an inline keyframe, which stands somewhere although the map does not have it.
#[derive(Clone, Debug)]
struct Guest {
    class: Box<str>,
    text: Arc<Text>,
    /// The set of texts of the map that match its own.
    matching: SetId,
    /// None where nothing measured how far it is.
    centre_in_session: Option<Point3>,
}

/// The counts of one query; each set of texts is counted once. Where many texts match each other, they match the same.
#[derive(Debug, Default)]
pub struct PlaceCounts {
    by_text: HashMap<TextId, usize>,
    by_set: HashMap<(SetId, Vec<bool>), usize>,
    sets: MatchSets,
    guests: Vec<Guest>,
    /// The session the guests are in, unless the map does not know it.
    session: Option<SessionSeq>,
    /// The keyframes covisible with the guests.
    covisible: BTreeSet<KeyframeSeq>,
}

impl PlaceCounts {
    /// Counts for a query around this centre: what an inline keyframe sees stands somewhere, too.
    pub fn around(index: &MapIndex, centre: &Centre) -> Self {
        let (session, covisible) = (centre.session, centre.covisible.clone());
        let mut counts = Self { session, covisible, ..Self::default() };
        for anchor in &centre.inline {
            let Some(text) = anchor.text.clone() else { continue };
            let matching = counts.sets.number(index.texts().matching_text(&anchor.class, &text));
            let centre_in_session = (!anchor.range_assumed).then_some(anchor.centre_in_session);
            let class = anchor.class.clone();
            counts.guests.push(Guest { class, text, matching, centre_in_session });
        }
        counts
    }

    /// In how many places anchors stand that carry this text or one that matches it; at least 1.
    pub fn of_text(&mut self, index: &MapIndex, text: TextId) -> usize {
        if let Some(known) = self.by_text.get(&text) {
            return *known;
        }
        // Most plates hang once, and nothing matches them.
        if self.guests.is_empty() && index.texts().is_of_one_object(text) {
            return 1;
        }
        let set = self.sets.of(index.texts(), text);
        let mut has_text: HashMap<SetId, bool> = HashMap::new();
        let carries = self.guests.iter().map(|guest| {
            let matching = self.sets.texts(guest.matching);
            *has_text.entry(guest.matching).or_insert_with(|| matching.binary_search(&text).is_ok())
        });
        let carries = carries.collect();
        let count = self.count_once(index, set, carries);
        self.by_text.insert(text, count);
        count
    }

    /// Returns the same for a text that no object of the map carries.
    pub fn of_guest(&mut self, index: &MapIndex, class: &str, text: &Text) -> usize {
        let min_level = index.properties().settings.matching_min_similarity_level;
        let alike = |guest: &Guest| {
            *guest.class == *class && u32::from(semantics::similarity_level(text, &guest.text).0) >= min_level
        };
        let carries = self.guests.iter().map(alike).collect();
        // What the query sees was held against the map before. Capital letters count in the level alone.
        let reads_alike = |guest: &&Guest| {
            *guest.class == *class
                && *guest.text == *text
                && guest.text.information_level() == text.information_level()
        };
        let itself = self.guests.iter().find(reads_alike);
        let set = match itself.map(|guest| guest.matching) {
            Some(known) => known,
            None => self.sets.number(index.texts().matching_text(class, text)),
        };
        self.count_once(index, set, carries)
    }

    /// Counts the places of a set of texts and of the guests that carry one of them.
    fn count_once(&mut self, index: &MapIndex, set: SetId, carries: Vec<bool>) -> usize {
        let key = (set, carries);
        if let Some(known) = self.by_set.get(&key) {
            return *known;
        }
        let count = self.count(index, self.sets.texts(set), &key.1);
        self.by_set.insert(key, count);
        count
    }

    fn count(&self, index: &MapIndex, texts: &[TextId], carries: &[bool]) -> usize {
        let carriers: BTreeSet<AnchorSeq> =
            texts.iter().flat_map(|text| index.texts().objects(*text)).collect();
        let mut carriers_in: BTreeMap<Option<SessionSeq>, Vec<AnchorSeq>> = BTreeMap::new();
        for root in carriers {
            for session in index.objects().get(root).into_iter().flat_map(|object| object.shapes.keys()) {
                carriers_in.entry(Some(*session)).or_default().push(root);
            }
        }
        carriers_in.entry(self.session).or_default();
        let places_in = |(session, roots): (&Option<SessionSeq>, &Vec<AnchorSeq>)| {
            // Where nothing measured a distance, nothing tells two places apart.
            let stored = roots.iter().filter_map(|root| Sighting::of(index, *root, (*session)?));
            let guests = self.guests.iter().zip(carries).filter(|(_, carries)| **carries);
            let guests = guests.filter(|_| *session == self.session);
            let guests = guests.filter_map(|(guest, _)| guest.centre_in_session);
            places(index, stored.chain(guests.map(|centre| Sighting::inline(centre, &self.covisible))))
        };
        carriers_in.iter().map(places_in).max().unwrap_or(1).max(1)
    }
}

/// Counts the places of sightings in one session, taken greedily in their order: each is held against the first sighting of
/// each place alone. No more sightings are taken than decide.
fn places<'a>(index: &MapIndex, sightings: impl Iterator<Item = Sighting<'a>>) -> usize {
    let mut firsts: Vec<Sighting<'_>> = Vec::new();
    let mut seen_by: BTreeSet<KeyframeSeq> = BTreeSet::new();
    let mut has_guest = false;
    for sighting in sightings {
        if firsts.iter().any(|first| first.may_be_at(&sighting, index)) {
            continue;
        }
        // What one local anchor map holds is one place; all that an inline keyframe sees is in one.
        let is_guest = sighting.is_inline();
        if (is_guest && has_guest) || sighting.is_around_any(index, &seen_by) {
            continue;
        }
        seen_by.append(&mut sighting.keyframes(index));
        has_guest |= is_guest;
        firsts.push(sighting);
        if firsts.len() == PLACES_MAX {
            break;
        }
    }
    firsts.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::keyframe::{Detection, NewKeyframe, Stamp};
    use crate::geometry::Pose;
    use crate::recognition::anchors::ingest::ingest;
    use crate::recognition::loops::query::Query;
    use proptest::prelude::*;

    fn sign(number: usize, text: &str) -> NewKeyframe {
        let detection = Detection {
            position_in_session: Some(Point3::new(number as f64 * 1.7, 0.0, 0.0)),
            text: Some(text.to_owned()),
            ..Detection::of("sign", 0.9, [0.0, 0.0, 10.0, 10.0])
        };
        let id = format!("kf-{number}").parse().unwrap();
        let keyframe = NewKeyframe::at(id, Stamp { sec: 0, nanosec: 0 }, Pose::identity());
        NewKeyframe { detections: vec![detection], ..keyframe }
    }

    const TEXTS: [&str; 11] = [
        "room 901 oak",
        "room 901 glass",
        "room 901 left",
        "room 901 not glass",
        "room 905",
        "a red wooden boat on a lake",
        "a red wooden boat on the lake at dawn",
        "boat lake wooden stormy castle harbour windmill",
        "boat lake wooden stormy castle harbour windmill sails",
        "boat lake wooden stormy castle harbour windmill dogs",
        "boat lake wooden stormy castle harbour dogs",
    ];

    proptest! {
        #[test]
        fn counting_all_texts_at_once_equals_counting_each_alone(
            signs in prop::collection::vec(0..TEXTS.len(), 0..16),
            asked in prop::collection::vec(0..TEXTS.len(), 0..6),
        ) {
            let mut index = MapIndex::default();
            for (number, text) in signs.iter().enumerate() {
                ingest(&mut index, &sign(number, TEXTS[*text]));
            }
            let mut query = sign(99, "");
            query.detections = asked.iter().enumerate().map(|(at, text)| sign(at * 3, TEXTS[*text]).detections.remove(0)).collect();
            let query = Query::inline(&index, &query);
            let mut together = PlaceCounts::around(&index, &query.centre);
            for id in index.texts().iter() {
                let alone = PlaceCounts::around(&index, &query.centre).of_text(&index, id);
                prop_assert_eq!(together.of_text(&index, id), alone);
                let texts: Vec<TextId> = index.texts().matching(id).collect();
                let carries = |guest: &Guest| {
                    index.texts().matching_text(&guest.class, &guest.text).contains(&id)
                };
                let carries: Vec<bool> = together.guests.iter().map(carries).collect();
                prop_assert_eq!(together.count(&index, &texts, &carries), alone);
            }
            for text in TEXTS.map(Text::parse) {
                let alone = PlaceCounts::around(&index, &query.centre).of_guest(&index, "sign", &text);
                prop_assert_eq!(together.of_guest(&index, "sign", &text), alone);
            }
        }
    }
}
