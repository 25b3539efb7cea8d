//! Keyframes: listed, read, and what surrounds one.

use super::keyframe_views::{find, record, summary};
use crate::domain::ids::{KeyframeId, KeyframeSeq, MapId};
use crate::domain::report::{KeyframeRecord, KeyframeSummary, Page};
use crate::domain::verdict::LocalAnchorReport;
use crate::engine::error::parsed;
use crate::engine::maps::live::LiveMap;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::loops::anchor_map::local_anchor_map;
use crate::recognition::loops::centre::Centre;
use crate::recognition::map::redundancy::find_redundant;
use crate::store::KeyframeRow;

impl Service {
    /// Returns the keyframes, in order of arrival.
    pub async fn list_keyframes(
        &self,
        map: &MapId,
        cursor: Option<&str>,
        limit: usize,
    ) -> Result<(u64, Page<KeyframeSummary>)> {
        let live = self.live(map).await?;
        let from = KeyframeSeq(parsed(cursor)?.unwrap_or(0));
        self.read(&live, move |state| {
            let index = &state.index;
            let mut rest = index.keyframes_from(from);
            let items = rest.by_ref().take(limit).map(|keyframe| summary(index, keyframe)).collect();
            Ok(Page { items, next_cursor: rest.next().map(|keyframe| keyframe.seq.0.to_string()) })
        })
        .await
    }

    /// Returns some keyframes that others make redundant, in order of arrival. The page may be short, or empty, and not the last:
    /// a page looks at a bounded number of keyframes.
    pub async fn list_redundant(
        &self,
        map: &MapId,
        cursor: Option<&str>,
        limit: usize,
    ) -> Result<(u64, Page<KeyframeSummary>)> {
        let live = self.live(map).await?;
        let from = KeyframeSeq(parsed(cursor)?.unwrap_or(0));
        self.read(&live, move |state| {
            let index = &state.index;
            let found = find_redundant(index, from, limit);
            let keyframes = found.keyframes.into_iter().filter_map(|seq| index.keyframe(seq));
            let items = keyframes.map(|keyframe| summary(index, keyframe)).collect();
            Ok(Page { items, next_cursor: found.next.map(|seq| seq.0.to_string()) })
        })
        .await
    }

    /// Returns a keyframe as it stands.
    pub async fn get_keyframe(&self, map: &MapId, id: &KeyframeId) -> Result<(u64, KeyframeRecord)> {
        let live = self.live(map).await?;
        let name = id.clone();
        let (_, seq) = self.read(&live, move |state| find(&state.index, &name)).await?;
        let row = self.keyframe_row(&live, id, seq).await?;
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

    pub(super) async fn keyframe_row(
        &self,
        live: &LiveMap,
        id: &KeyframeId,
        seq: KeyframeSeq,
    ) -> Result<KeyframeRow> {
        // Culled between the look at the index and the look at the store.
        self.store.keyframe(live.key, seq).await?.ok_or_else(|| ServiceError::no_keyframe(id))
    }
}
