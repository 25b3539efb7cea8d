//! Views of keyframes: what the index and a row say of one.

use crate::domain::anchor::{AnchorState, Outcome};
use crate::domain::change::Keyframe;
use crate::domain::ids::{KeyframeId, KeyframeSeq};
use crate::domain::keyframe::{Detection, NewKeyframe};
use crate::domain::report::{KeyframeRecord, KeyframeReport, KeyframeSummary};
use crate::engine::{Result, ServiceError};
use crate::recognition::loops::points_now::PointsNow;
use crate::recognition::map::index::MapIndex;
use crate::store::KeyframeRow;

/// Finds a keyframe by its id.
pub(in crate::engine) fn find(index: &MapIndex, id: &KeyframeId) -> Result<KeyframeSeq> {
    index.keyframe_seq(id).ok_or_else(|| ServiceError::no_keyframe(id))
}

/// Returns the anchor's object, and its state.
pub(super) fn current(index: &MapIndex, outcome: Outcome) -> (Outcome, Option<AnchorState>) {
    let rooted = |anchor| index.objects().root(anchor).unwrap_or(anchor);
    let state = |anchor| index.objects().get(rooted(anchor)).map(|object| object.state);
    match outcome {
        Outcome::Created(anchor) => (Outcome::Created(rooted(anchor)), state(anchor)),
        Outcome::Observed(anchor) => (Outcome::Observed(rooted(anchor)), state(anchor)),
        Outcome::Ignored(reason) => (Outcome::Ignored(reason), None),
    }
}

/// Returns the report on a keyframe that was stored; the caller fills in the version.
pub(super) fn report(
    index: &MapIndex,
    id: &KeyframeId,
    seq: KeyframeSeq,
    outcomes: &[Outcome],
) -> KeyframeReport {
    let covisible = index.covisibility().degree(seq);
    KeyframeReport {
        keyframe: id.clone(),
        map_version: 0,
        covisible,
        is_cut_off: covisible == 0 && index.has_others_of_session(seq),
        detections: outcomes.iter().map(|outcome| current(index, *outcome)).collect(),
        revisits: false,
    }
}

/// Returns a line of the list of keyframes.
pub(super) fn summary(index: &MapIndex, keyframe: &Keyframe) -> KeyframeSummary {
    KeyframeSummary {
        id: keyframe.id.clone(),
        session: index.sessions()[keyframe.session.index()].clone(),
        stamp: keyframe.stamp,
        map_from_camera: keyframe.map_from_camera,
        covisible: index.covisibility().degree(keyframe.seq),
        anchors: index.objects_seen_by(keyframe.seq).into_iter().collect(),
    }
}

/// Returns a keyframe as it stands, with what only its row has.
pub(super) fn record(
    index: &MapIndex,
    id: &KeyframeId,
    seq: KeyframeSeq,
    row: KeyframeRow,
) -> Result<KeyframeRecord> {
    let stored = index.keyframe(seq).ok_or_else(|| ServiceError::no_keyframe(id))?;
    let position = |id: i64| Some((id, index.points().position(stored.session, id)?));
    let named = |(other, shared): &(KeyframeSeq, u32)| Some((index.keyframe(*other)?.id.clone(), *shared));
    let outcomes: Vec<Outcome> = row.detections.iter().map(|detection| detection.outcome).collect();
    let has_crop = row.detections.iter().map(|detection| detection.has_crop).collect();
    let mut detections: Vec<Detection> =
        row.detections.into_iter().map(|detection| detection.detection).collect();
    for anchor in index.anchors_seen_by(seq).filter_map(|anchor| index.anchor(anchor)) {
        for ((_, number), observation) in anchor.observations.range((seq, 0)..=(seq, u16::MAX)) {
            if let Some(detection) = detections.get_mut(usize::from(*number)) {
                detection.map_points = observation.map_points.to_vec();
            }
        }
    }
    let mut features = row.features;
    if let Some((features, points)) = features.as_mut().zip(PointsNow::of(stored)) {
        features.map_points.iter_mut().for_each(|id| *id = id.and_then(|id| points.now(id)));
    }
    Ok(KeyframeRecord {
        keyframe: NewKeyframe {
            id: id.clone(),
            session: index.sessions()[stored.session.index()].clone(),
            stamp: stored.stamp,
            map_from_camera: stored.map_from_camera,
            camera: stored.camera,
            gravity: stored.gravity,
            vocabulary: index.vocabulary().filter(|_| !row.bow.is_empty()).map(Into::into),
            bow: row.bow,
            global_descriptor: index.globals().get(seq),
            features,
            map_points: row.sent_points.into_iter().filter_map(position).collect(),
            observes: stored.observes.to_vec(),
            covisible: stored.declared.as_ref().map(|listed| listed.iter().filter_map(named).collect()),
            detections,
        },
        detections: outcomes.into_iter().map(|outcome| current(index, outcome)).collect(),
        has_crop,
        covisible: index.covisibility().degree(seq),
    })
}
