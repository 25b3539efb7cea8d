//! A keyframe arrives: association, anchor creation, matching, covisible merge (§IV).

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::association::{Association, associate};
use super::matching;
use crate::domain::anchor::{Observation, Outcome};
use crate::domain::change::{Change, Keyframe};
use crate::domain::event::{Event, EventKind};
use crate::domain::ids::{AnchorSeq, KeyframeId, KeyframeSeq, SessionId, SessionSeq};
use crate::domain::invalid::FieldError;
use crate::domain::keyframe::{Detection, NewKeyframe};
use crate::recognition::map::index::{MapIndex, MergedAnchor};
use crate::recognition::map::recorder::{Decided, Recorder};

/// Maximum revisits of one anchor that are announced one by one; an EXIT sign has thousands.
const MAX_REVISITS_TOLD: usize = 8;

/// What ingest made of a keyframe.
#[derive(Clone, Debug, PartialEq)]
pub struct Ingested {
    /// The keyframe's number.
    pub keyframe: KeyframeSeq,
    /// What became of its detections, in their order.
    pub outcomes: Vec<Outcome>,
    /// Whether it sees an anchor that matches one seen before. That triggers loop detection (§III).
    pub revisits: bool,
    /// The changes and events.
    pub decided: Decided,
}

/// Finds the faults that only the map can tell: a declared covisible keyframe that does not exist.
pub fn unknown_covisible<'k>(
    index: &MapIndex,
    declared: impl Iterator<Item = (usize, &'k KeyframeId)>,
) -> Vec<FieldError> {
    let unknown = |(place, id): (usize, &KeyframeId)| {
        index.keyframe_seq(id).is_none().then(|| {
            FieldError::new(format!("/covisible/{place}/keyframe"), "there is no such keyframe in the map")
                .got(id)
        })
    };
    declared.filter_map(unknown).collect()
}

/// Returns the vocabulary that the map's words belong to, if the keyframe's belong to another: the same number would
/// mean two things, and every score would be noise.
pub fn other_vocabulary<'a>(of_map: Option<&'a str>, keyframe: &NewKeyframe) -> Option<&'a str> {
    let theirs = keyframe.vocabulary.as_deref().filter(|_| !keyframe.bow.is_empty())?;
    of_map.filter(|ours| *ours != theirs)
}

/// Takes a checked keyframe into the map.
pub fn ingest(index: &mut MapIndex, new: &NewKeyframe) -> Ingested {
    let mut record = Recorder::new(index);
    let (keyframe, session) = add_keyframe(&mut record, new);
    let (outcomes, before) = associate_detections(&mut record, new, keyframe, session);
    let seen = record.index().objects_seen_by(keyframe);
    record.touch(seen.iter().copied());
    let changed = tell_described(&mut record, &seen, &before);
    merge_covisible(&mut record, keyframe, &seen, &changed);
    let revisits = tell_revisits(&mut record, Some(keyframe), &changed);
    Ingested { keyframe, outcomes, revisits, decided: record.finish() }
}

/// Returns the number of a session, which is added if the map does not know it.
pub(super) fn session_of(index: &MapIndex, id: &SessionId, changes: &mut Vec<Change>) -> SessionSeq {
    index.session(id).unwrap_or_else(|| {
        let session = SessionSeq(index.sessions().len() as u32);
        changes.push(Change::SessionAdded(session, id.clone()));
        session
    })
}

fn add_keyframe(record: &mut Recorder<'_>, new: &NewKeyframe) -> (KeyframeSeq, SessionSeq) {
    let index = record.index();
    let mut changes = Vec::new();
    let session = session_of(index, &new.session, &mut changes);
    if let (None, Some(vocabulary), false) = (index.vocabulary(), &new.vocabulary, new.bow.is_empty()) {
        changes.push(Change::VocabularySet(vocabulary.clone()));
    }
    let declared = (new.covisible.as_ref())
        .map(|listed| listed.iter().filter_map(|(id, n)| Some((index.keyframe_seq(id)?, *n))).collect());
    let keyframe = Keyframe::arriving(index.next_keyframe(), session, new, declared);
    let seq = keyframe.seq;
    changes.push(Change::KeyframeAdded(Box::new(keyframe), Arc::new(new.bow.clone())));
    if let Some(descriptor) = &new.global_descriptor {
        changes.push(Change::GlobalDescriptorSet(seq, Box::new(descriptor.clone())));
    }
    let moved = new.map_points.iter().filter(|(id, at)| index.points().position(session, *id) != Some(*at));
    changes.extend(moved.map(|(id, at)| Change::PointSet(session, *id, *at)));
    record.apply(changes);
    let mut event = Event::of(EventKind::KeyframeStored);
    (event.keyframe, event.session) = (Some(new.id.clone()), Some(new.session.clone()));
    record.emit(event);
    (seq, session)
}

fn associate_detections(
    record: &mut Recorder<'_>,
    new: &NewKeyframe,
    keyframe: KeyframeSeq,
    session: SessionSeq,
) -> (Vec<Outcome>, Names) {
    let index = record.index();
    let covisible = index.covisibility().with_itself(keyframe);
    let position = |point| index.points().position(session, point);
    let associations = associate(index, Some(session), covisible, &new.detections, position);
    let tracked = associations.iter().filter_map(|association| match association {
        Association::Tracked(root) => Some(*root),
        _ => None,
    });
    let before = names(index, &tracked.collect());
    let (mut outcomes, mut changes) = (Vec::new(), Vec::new());
    let mut next = index.next_anchor();
    for (number, (detection, association)) in new.detections.iter().zip(associations).enumerate() {
        let observation = || Box::new(observation(keyframe, number as u16, detection));
        let outcome = match association {
            Association::Ignored(reason) => Outcome::Ignored(reason),
            Association::Tracked(root) => {
                let member = nearest_member(index, root, keyframe);
                changes.push(Change::Observed(member, observation()));
                Outcome::Observed(member)
            }
            Association::New => {
                let anchor = next;
                next = AnchorSeq(next.0 + 1);
                changes.push(Change::AnchorAdded(anchor, detection.class.as_str().into()));
                changes.push(Change::Observed(anchor, observation()));
                Outcome::Created(anchor)
            }
        };
        changes.push(Change::OutcomeSet(keyframe, number as u16, outcome));
        outcomes.push(outcome);
    }
    record.apply(changes);
    (outcomes, before)
}

fn observation(keyframe: KeyframeSeq, number: u16, detection: &Detection) -> Observation {
    let [x0, y0, x1, y1] = detection.box_px;
    Observation {
        keyframe,
        detection: number,
        confidence: detection.confidence,
        map_points: detection.map_points.clone().into(),
        position_as_sent: detection.position_in_session,
        range_assumed: detection.range_assumed,
        reading: detection.reading().map(Into::into),
        described: detection.description.is_some(),
        crop_area_px: detection.crop.as_ref().map(|_| (x1 - x0) * (y1 - y0)),
        crop_reading: None,
    }
}

/// Returns the anchor of an object that a new observation is kept with: the one that the newest covisible keyframe saw.
/// If a loop that joined the object is revoked, the observation stays at its own place.
fn nearest_member(index: &MapIndex, root: AnchorSeq, keyframe: KeyframeSeq) -> AnchorSeq {
    let Some(object) = index.objects().get(root) else { return root };
    let newest_sight = |member: &AnchorSeq| {
        let keyframes = index.anchor(*member)?.observations.keys().rev().map(|(keyframe, _)| *keyframe);
        keyframes.into_iter().find(|seen_by| index.covisibility().joins(keyframe, *seen_by))
    };
    let members = object.members.iter().copied();
    members.max_by_key(|member| (newest_sight(member), std::cmp::Reverse(*member))).unwrap_or(root)
}

/// What each object is called, in normal form; objects without a description are left out.
pub(super) type Names = BTreeMap<AnchorSeq, Box<str>>;

pub(super) fn names(index: &MapIndex, objects: &BTreeSet<AnchorSeq>) -> Names {
    let name = |root: &AnchorSeq| {
        let description = index.objects().get(*root)?.description.as_ref()?;
        Some((*root, description.text.normalised().into()))
    };
    objects.iter().filter_map(name).collect()
}

/// Tells which of the objects seen have a description now, or another one; they are to be matched.
pub(super) fn tell_described(
    record: &mut Recorder<'_>,
    seen: &BTreeSet<AnchorSeq>,
    before: &Names,
) -> BTreeSet<AnchorSeq> {
    let now = names(record.index(), seen);
    let changed: BTreeSet<AnchorSeq> =
        now.iter().filter(|(root, name)| before.get(root) != Some(name)).map(|(root, _)| *root).collect();
    for root in &changed {
        tell_description(record, *root);
    }
    changed
}

/// Tells what an object is called now.
pub(in crate::recognition) fn tell_description(record: &mut Recorder<'_>, root: AnchorSeq) {
    let described = record.index().objects().get(root).and_then(|object| object.description.as_ref());
    let mut event = Event::of(EventKind::AnchorDescribed);
    event.anchor = Some(root);
    event.detail = described.map(|description| description.raw.to_string());
    record.emit(event);
}

/// Merges what matches, is covisible and stands close, until nothing more does.
fn merge_covisible(
    record: &mut Recorder<'_>,
    keyframe: KeyframeSeq,
    seen: &BTreeSet<AnchorSeq>,
    changed: &BTreeSet<AnchorSeq>,
) {
    for seen in seen {
        // Another description may match anything near the object; the same one has only this
        // keyframe's neighbours to be held against anew.
        merge_all(record, *seen, |index, object| {
            if changed.contains(seen) { index.keyframes_of(object) } else { BTreeSet::from([keyframe]) }
        });
    }
}

/// Merges one anchor's object with what matches it among the objects seen around some of its keyframes.
pub(in crate::recognition) fn merge_all(
    record: &mut Recorder<'_>,
    anchor: AnchorSeq,
    around: impl Fn(&MapIndex, &MergedAnchor) -> BTreeSet<KeyframeSeq>,
) {
    loop {
        let index = record.index();
        let Some(root) = index.objects().root(anchor) else { return };
        let Some(object) = index.objects().get(root) else { return };
        let around = around(index, object);
        let Some(merge) = matching::covisible_merge(index, root, &around) else { return };
        let why = "they match, their keyframes are covisible, and they stand close";
        record.merge(merge, |event| event.detail = Some(why.into()));
    }
}

/// Tells which of these anchors match one seen before, on another passage (§III); is there any?
pub(in crate::recognition) fn tell_revisits(
    record: &mut Recorder<'_>,
    keyframe: Option<KeyframeSeq>,
    changed: &BTreeSet<AnchorSeq>,
) -> bool {
    let roots: BTreeSet<AnchorSeq> =
        changed.iter().filter_map(|anchor| record.index().objects().root(*anchor)).collect();
    let mut any = false;
    for root in roots {
        let others: Vec<AnchorSeq> =
            matching::revisits(record.index(), root).take(MAX_REVISITS_TOLD).collect();
        any |= !others.is_empty();
        for other in others {
            let mut event = Event::of(EventKind::AnchorsMatched);
            (event.anchor, event.other) = (Some(root), Some(other));
            event.keyframe =
                keyframe.and_then(|seq| record.index().keyframe(seq)).map(|keyframe| keyframe.id.clone());
            let described = record.index().objects().get(root).and_then(|object| object.description.as_ref());
            event.detail = described.map(|description| description.raw.to_string());
            record.emit(event);
        }
    }
    any
}
