//! Keyframes: listed, read, and what surrounds one.

use super::named::find;
use crate::domain::anchor::{AnchorState, Outcome};
use crate::domain::change::Keyframe;
use crate::domain::ids::{KeyframeId, KeyframeSeq, MapId};
use crate::domain::keyframe::{Detection, NewKeyframe};
use crate::domain::report::{KeyframeRecord, KeyframeReport, KeyframeSummary, Page};
use crate::domain::request::PageRequest;
use crate::domain::verdict::LocalAnchorReport;
use crate::engine::error::parsed;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::loops::anchor_map::local_anchor_map;
use crate::recognition::loops::centre::Centre;
use crate::recognition::loops::points_now::PointsNow;
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::redundancy::find_redundant;
use crate::store::KeyframeRow;

impl Service {
    /// Returns the keyframes in order of arrival, or those that others make redundant. Of these a page may be short, or empty, and
    /// not the last: it looks at a bounded number of keyframes.
    pub async fn list_keyframes(
        &self,
        map: &MapId,
        are_redundant: bool,
        page: PageRequest,
    ) -> Result<(u64, Page<KeyframeSummary>)> {
        let live = self.live(map).await?;
        let from = KeyframeSeq(parsed(&page)?.unwrap_or(0));
        self.read(&live, move |state| {
            let index = &state.index;
            let (seqs, next) = if are_redundant {
                let found = find_redundant(index, from, page.limit);
                (found.keyframes, found.next)
            } else {
                let mut rest = index.keyframes_from(from).map(|keyframe| keyframe.seq);
                (rest.by_ref().take(page.limit).collect(), rest.next())
            };
            let keyframes = seqs.into_iter().filter_map(|seq| index.keyframe(seq));
            let items = keyframes.map(|keyframe| summary(index, keyframe)).collect();
            Ok(Page { items, next_cursor: next.map(|seq| seq.0.to_string()) })
        })
        .await
    }

    /// Returns a keyframe as it stands.
    pub async fn get_keyframe(&self, map: &MapId, id: &KeyframeId) -> Result<(u64, KeyframeRecord)> {
        let live = self.live(map).await?;
        let name = id.clone();
        let (_, seq) = self.read(&live, move |state| find(&state.index, &name)).await?;
        // It may be culled between the look at the index and the look at the store.
        let row = self.store.keyframe(live.key, seq).await?.ok_or_else(|| ServiceError::no_keyframe(id))?;
        let name = id.clone();
        self.read(&live, move |state| record(&state.index, &name, seq, row.clone())).await
    }

    /// Returns the keyframes covisible with one, each with its number of shared points, most first.
    pub async fn covisible(&self, map: &MapId, id: &KeyframeId) -> Result<(u64, Vec<(KeyframeId, u32)>)> {
        let live = self.live(map).await?;
        let id = id.clone();
        self.read(&live, move |state| {
            let index = &state.index;
            let seq = find(index, &id)?;
            let named = |(other, shared)| Some((index.keyframe(other)?.id.clone(), shared));
            let mut items: Vec<_> = index.covisibility().shared(seq).filter_map(named).collect();
            items.sort_by(|(a, of_a), (b, of_b)| of_b.cmp(of_a).then_with(|| a.cmp(b)));
            Ok(items)
        })
        .await
    }

    /// Returns the local anchor map around a keyframe, M_k of §V-A.
    pub async fn local_anchor_map(
        &self,
        map: &MapId,
        id: &KeyframeId,
    ) -> Result<(u64, Vec<LocalAnchorReport>)> {
        let live = self.live(map).await?;
        let id = id.clone();
        self.read(&live, move |state| {
            let index = &state.index;
            let centre =
                Centre::stored(index, find(index, &id)?).ok_or_else(|| ServiceError::no_keyframe(&id))?;
            let local = local_anchor_map(index, &centre, &mut PlaceCounts::default());
            let report = |anchor: crate::recognition::loops::anchor_map::LocalAnchor| LocalAnchorReport {
                anchor: anchor.name.public(),
                class: anchor.class.into(),
                state: anchor.state,
                description: anchor.description.map(Into::into),
                kind: anchor.kind,
                bearing: anchor.bearing,
                weight: anchor.weight,
            };
            Ok(local.anchors.into_iter().map(report).collect())
        })
        .await
    }
}

/// Returns the anchor's object, and its state.
fn current(index: &MapIndex, outcome: Outcome) -> (Outcome, Option<AnchorState>) {
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
fn summary(index: &MapIndex, keyframe: &Keyframe) -> KeyframeSummary {
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
fn record(index: &MapIndex, id: &KeyframeId, seq: KeyframeSeq, row: KeyframeRow) -> Result<KeyframeRecord> {
    let stored = index.keyframe(seq).ok_or_else(|| ServiceError::no_keyframe(id))?;
    let position = |id: i64| Some((id, index.points().position(stored.session, id)?));
    let named = |(other, shared): &(KeyframeSeq, u32)| Some((index.keyframe(*other)?.id.clone(), *shared));
    let outcomes: Vec<Outcome> = row.detections.iter().map(|detection| detection.outcome).collect();
    let has_crop = row.detections.iter().map(|detection| detection.has_crop).collect();
    let mut detections: Vec<Detection> =
        row.detections.into_iter().map(|detection| detection.detection).collect();
    stored.place(&mut detections);
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
            vocabulary: index.vocabulary().filter(|_| !row.bow.is_empty()).map(Into::into),
            bow: row.bow,
            global_descriptor: index.globals().get(seq),
            features,
            map_points: row.sent_points.into_iter().filter_map(position).collect(),
            observes: stored.observes.to_vec(),
            covisible: stored.declared.as_ref().map(|listed| listed.iter().filter_map(named).collect()),
            detections,
            ..stored.without_lists(index.sessions()[stored.session.index()].clone())
        },
        detections: outcomes.into_iter().map(|outcome| current(index, outcome)).collect(),
        has_crop,
        covisible: index.covisibility().degree(seq),
    })
}
