//! A sign that was replaced while tracking kept its map points: what was read of the new one has fed the old one's anchor, and
//! moves to an anchor of its own.

use std::collections::BTreeSet;

use super::passages::Passage;
use super::readings::read_otherwise;
use crate::domain::anchor::Observation;
use crate::domain::change::{Change, MovedObservation};
use crate::domain::ids::AnchorSeq;
use crate::recognition::anchors::ingest::{merge_all, tell_description, tell_revisits};
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::recorder::Recorder;

/// Founds an anchor for the detections of a sign that were read otherwise, with this gist. Returns it; none if there are none
/// that can go.
pub(super) fn split(record: &mut Recorder<'_>, passage: &Passage, gist: &str) -> Option<AnchorSeq> {
    let index = record.index();
    let object = index.objects().get(passage.sign.root)?;
    let (new, class) = (index.next_anchor(), index.class_of(object).into());
    let mut moved = Vec::new();
    for from in &object.members {
        let Some(anchor) = index.anchor(*from) else { continue };
        let reads =
            |seen: &&Observation| read_otherwise(index, object, seen).is_some_and(|text| text.gist() == gist);
        let goes = anchor.observations.values().filter(reads);
        let of_anchor: Vec<MovedObservation> = goes
            .map(|seen| MovedObservation {
                keyframe: seen.keyframe,
                detection: seen.detection,
                from: *from,
                to: new,
            })
            .collect();
        // No anchor is left without a detection.
        if of_anchor.len() < anchor.observations.len() {
            moved.extend(of_anchor);
        }
    }
    if moved.is_empty() {
        return None;
    }
    let added = Change::AnchorAdded(new, class);
    let changes = [added].into_iter().chain(moved.into_iter().map(Change::ObservationMoved)).collect();
    record.touch([new]);
    record.apply(changes);
    Some(new)
}

/// Tells of an anchor that is new or has returned, and matches it as if it had just been read (§IV-C.2).
pub(super) fn match_anew(record: &mut Recorder<'_>, anchor: AnchorSeq) {
    tell_description(record, anchor);
    merge_all(record, anchor, MapIndex::keyframes_of);
    tell_revisits(record, None, &BTreeSet::from([anchor]));
}
