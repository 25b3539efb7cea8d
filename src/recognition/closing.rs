//! A loop is closed, or taken back: matched anchors merge, or part again (§IV-C.2).

use super::anchor_map::{Centre, LocalName, local_anchor_map};
use super::comparison::compare;
use super::distinctiveness::PlaceCounts;
use super::index::MapIndex;
use super::recorder::{Decided, Recorder};
use crate::model::change::{Change, Loop, Merge, MergeCause};
use crate::model::event::{Event, EventKind};
use crate::model::ids::LoopId;
use crate::model::report::MergeReport;
use crate::model::settings::Settings;

/// Closes a loop: merges the pairs that match between the two local anchor maps, one-to-one
/// whatever the map's reading of Eq. (2) is (three EXIT signs are not one), and makes the two
/// keyframes covisible (`contract.md` §8.12).
pub fn close_loop(index: &mut MapIndex, closed: Loop) -> (Vec<MergeReport>, Decided) {
    let pairs = matched_objects(index, &closed);
    let mut record = Recorder::new(index);
    let mut event = Event::of(EventKind::LoopConfirmed);
    event.loop_id = Some(closed.id.clone());
    event.keyframe = Some(closed.keyframe_id.clone());
    event.candidate = Some(closed.candidate_id.clone());
    event.query.clone_from(&closed.query);
    record.tell(event);
    let id = closed.id.clone();
    record.apply(vec![Change::LoopAdded(closed)]);
    let mut merged = Vec::new();
    for (a, b) in pairs {
        let objects = record.index().objects();
        let (Some(a), Some(b)) = (objects.root(a), objects.root(b)) else { continue };
        if a == b {
            continue;
        }
        let merge = Merge { into: a.min(b), from: a.max(b), cause: MergeCause::Loop(id.clone()) };
        merged.push(MergeReport { into: merge.into, from: merge.from });
        let mut event = Event::of(EventKind::AnchorsMerged);
        (event.anchor, event.other) = (Some(merge.into), Some(merge.from));
        event.loop_id = Some(id.clone());
        record.tell(event);
        record.touch(merge.into);
        record.touch(merge.from);
        record.apply(vec![Change::Merged(merge)]);
    }
    (merged, record.finish())
}

fn matched_objects(
    index: &MapIndex,
    closed: &Loop,
) -> Vec<(crate::model::ids::AnchorSeq, crate::model::ids::AnchorSeq)> {
    let mut places = PlaceCounts::default();
    let centres = Centre::stored(index, closed.keyframe).zip(Centre::stored(index, closed.candidate));
    let Some((query, candidate)) = centres else { return Vec::new() };
    let query = local_anchor_map(index, &query, &mut places);
    let candidate = local_anchor_map(index, &candidate, &mut places);
    let settings = Settings { one_to_one: true, ..index.properties().settings.clone() };
    let comparison = compare(&query, &candidate, index.texts(), &settings);
    let pairs = comparison.matches.iter().filter_map(|pair| match (pair.query.name, pair.candidate.name) {
        (LocalName::Object(a), LocalName::Object(b)) => Some((a, b)),
        _ => None,
    });
    pairs.collect()
}

/// Takes a loop back: what it merged parts again.
pub fn revoke_loop(index: &mut MapIndex, id: &LoopId) -> (Vec<MergeReport>, Decided) {
    let split: Vec<MergeReport> = merges_of(index, id);
    let mut record = Recorder::new(index);
    let mut event = Event::of(EventKind::LoopRevoked);
    event.loop_id = Some(id.clone());
    if let Some(closed) = record.index().loops().get(id) {
        event.keyframe = Some(closed.keyframe_id.clone());
        event.candidate = Some(closed.candidate_id.clone());
    }
    record.tell(event);
    for merge in &split {
        record.touch(merge.into);
        record.touch(merge.from);
    }
    record.apply(vec![Change::LoopRemoved(id.clone())]);
    (split, record.finish())
}

/// The anchors a loop merged.
pub fn merges_of(index: &MapIndex, id: &LoopId) -> Vec<MergeReport> {
    let made = index.objects().links_of_loop(id).into_iter();
    made.map(|merge| MergeReport { into: merge.into, from: merge.from }).collect()
}
