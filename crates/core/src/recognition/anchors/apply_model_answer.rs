//! A model's verdict arrives: it is checked against the map as it is now, applied, and what follows is told (§IV-A.3).

use std::collections::{BTreeMap, BTreeSet};

use super::ingest::{merge_all, tell_description, tell_revisits};
use super::matching;
use crate::domain::anchor::AnchorState;
use crate::domain::change::Change;
use crate::domain::event::{Event, EventKind};
use crate::domain::ids::{AnchorSeq, KeyframeId, KeyframeSeq};
use crate::domain::judged::{CropRead, Finding, ModelVerdict};
use crate::recognition::map::index::{MapIndex, MergedAnchor};
use crate::recognition::map::recorder::{Decided, Recorder};

/// Maximum anchors of one text that are followed up; an EXIT sign hangs at thousands of doors.
const MAX_FOLLOWED: usize = 64;

/// Maximum matches of one verdict that are announced one by one.
const MAX_MATCHES_TOLD: usize = 8;

/// What a verdict changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Learned {
    /// The changes and events.
    pub decided: Decided,
    /// The keyframes that see an anchor which turns out to have been seen before: loop detection is triggered (§III).
    pub triggers: Vec<KeyframeId>,
    /// The keyframe whose crop was read: what it sees may have a twin (M16).
    pub read: Option<KeyframeSeq>,
}

/// A crop was read. `None` if the detection is gone, feeds no anchor any more, or was read for good or just so before.
pub fn learn_reading(index: &mut MapIndex, read: CropRead) -> Option<Learned> {
    let known = index.observation(read.anchor, (read.keyframe, read.detection))?.crop_reading.as_ref();
    let settled = known.is_some_and(|known| !known.degraded || *known == read.reading);
    if settled { None } else { replace_reading(index, read) }
}

/// Applies a reading, also where another one stands. `None` if the detection is gone, or feeds no anchor any more.
pub fn replace_reading(index: &mut MapIndex, read: CropRead) -> Option<Learned> {
    let observation = index.observation(read.anchor, (read.keyframe, read.detection))?;
    observation.crop_area_px?;
    // Read alike by another model: the anchor stays as it is.
    let is_news = observation.crop_reading.as_ref() != Some(&read.reading);
    let (anchor, keyframe) = (read.anchor, read.keyframe);
    let concerned: BTreeSet<AnchorSeq> = index.objects().root(anchor).into_iter().collect();
    let mut record = Recorder::new(index);
    if is_news {
        record.touch([anchor]);
    }
    let before = named(record.index(), &concerned);
    record.apply(vec![Change::CropRead(Box::new(read))]);
    Some(Learned { read: Some(keyframe), ..follow_up(record, &before) })
}

/// Texts were judged. `None` if nobody carries them any more.
pub fn learn_verdict(index: &mut MapIndex, verdict: ModelVerdict) -> Option<Learned> {
    match verdict.finding {
        Finding::Similarity(_) => learn_similarity(index, verdict),
        Finding::Information(_) | Finding::Merge(_) => {
            let concerned: BTreeSet<AnchorSeq> = (index.objects().iter())
                .filter(|(_, object)| index.class_of(object) == &*verdict.class)
                .filter(|(_, object)| {
                    let called = object.description.as_ref();
                    called.is_some_and(|called| called.text.normalised() == &*verdict.a)
                        || (object.votes.says(&verdict.a) && object.votes.says(&verdict.b))
                })
                .map(|(root, _)| root)
                .collect();
            if concerned.is_empty() {
                return None;
            }
            let mut record = Recorder::new(index);
            let before = named(record.index(), &concerned);
            record.apply(vec![Change::Judged(Box::new(verdict))]);
            Some(follow_up(record, &before))
        }
    }
}

/// Notes that the model which a map waits for is away, or back; returns none if the map knows.
pub fn learn_away(index: &mut MapIndex, away: bool) -> Option<Decided> {
    if index.model_away() == away {
        return None;
    }
    let mut record = Recorder::new(index);
    record.apply(vec![Change::ModelAway(away)]);
    Some(record.finish())
}

fn learn_similarity(index: &mut MapIndex, verdict: ModelVerdict) -> Option<Learned> {
    let pair = [&verdict.a, &verdict.b].map(|text| index.texts().find_normalised(&verdict.class, text));
    let [Some(a), Some(b)] = pair else {
        // Two readings of one object: the verdict tells whether they are to be merged.
        let says_both =
            |(_, object): (_, &MergedAnchor)| object.votes.says(&verdict.a) && object.votes.says(&verdict.b);
        if !index.objects().iter().any(says_both) {
            return None;
        }
        let mut record = Recorder::new(index);
        record.apply(vec![Change::Judged(Box::new(verdict))]);
        return Some(Learned { decided: record.finish(), ..Learned::default() });
    };
    let matched = index.texts().level(a, b).is_some();
    let mut record = Recorder::new(index);
    record.apply(vec![Change::Judged(Box::new(verdict))]);
    if matched || record.index().texts().level(a, b).is_none() {
        return Some(Learned { decided: record.finish(), ..Learned::default() });
    }
    let index = record.index();
    // What only a plan shows was not seen, and nothing comes back to it.
    let was_seen = |root: &AnchorSeq| index.anchor(*root).is_some_and(|anchor| anchor.prior.is_none());
    let carriers =
        |id| -> Vec<AnchorSeq> { index.texts().objects(id).filter(was_seen).take(MAX_FOLLOWED).collect() };
    let (of_a, of_b) = (carriers(a), carriers(b));
    for root in &of_a {
        merge_all(&mut record, *root, MapIndex::keyframes_of);
    }
    let mut triggers = BTreeSet::new();
    let mut told = 0;
    for root in of_a {
        let Some(root) = record.index().objects().root(root) else { continue };
        let near = matching::neighbourhood(record.index(), root);
        for other in of_b.iter().filter(|other| near.binary_search(other).is_err()) {
            if told == MAX_MATCHES_TOLD || *other == root {
                continue;
            }
            told += 1;
            let mut event = Event::of(EventKind::AnchorsMatched);
            let newer = root.max(*other);
            (event.anchor, event.other) = (Some(newer), Some(root.min(*other)));
            record.emit(event);
            triggers.extend(newest_keyframe(record.index(), newer));
        }
    }
    Some(Learned { decided: record.finish(), triggers: triggers.into_iter().collect(), read: None })
}

/// What an object is called, and whether that says enough.
type Named = BTreeMap<AnchorSeq, (Box<str>, AnchorState)>;

fn named(index: &MapIndex, objects: &BTreeSet<AnchorSeq>) -> Named {
    let name = |root: &AnchorSeq| {
        let object = index.objects().get(*root)?;
        let text = object.description.as_ref().map_or("", |description| description.text.normalised());
        Some((*root, (text.into(), object.state)))
    };
    objects.iter().filter_map(name).collect()
}

/// Announces and matches again the objects whose text changed, or that count now.
fn follow_up(mut record: Recorder<'_>, before: &Named) -> Learned {
    let now = named(record.index(), &before.keys().copied().collect());
    let changed: BTreeSet<AnchorSeq> =
        now.iter().filter(|(root, name)| before.get(root) != Some(name)).map(|(root, _)| *root).collect();
    for root in &changed {
        record.touch([*root]);
        tell_description(&mut record, *root);
    }
    for root in changed.iter().take(MAX_FOLLOWED) {
        merge_all(&mut record, *root, MapIndex::keyframes_of);
    }
    let followed: BTreeSet<AnchorSeq> = changed.iter().take(MAX_FOLLOWED).copied().collect();
    let mut triggers = BTreeSet::new();
    for root in followed {
        if tell_revisits(&mut record, None, &BTreeSet::from([root])) {
            triggers.extend(newest_keyframe(record.index(), root));
        }
    }
    Learned { decided: record.finish(), triggers: triggers.into_iter().collect(), read: None }
}

fn newest_keyframe(index: &MapIndex, anchor: AnchorSeq) -> Option<KeyframeId> {
    let newest = index.keyframes_of(index.object_of(anchor)?).pop_last()?;
    Some(index.keyframe(newest)?.id.clone())
}
