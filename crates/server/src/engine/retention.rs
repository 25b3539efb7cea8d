//! Retention: what the settings of maps let go of. Looked for now and then, in the background; releases stay as they are.
//!
//! | setting | what goes |
//! |---|---|
//! | `keep_crops` | crops that were read, or that no model will read |
//! | `keep_readings` | dialogues of models, and what later verdicts replaced |
//! | `keep_descriptors_days` | features and global descriptors of keyframes that were stored longer ago |
//! | `keep_keyframes_days` | redundant keyframes that were stored longer ago ([`find_redundant`]) |
//!
//! Deleted rows leave their bytes in the file until it uses them again; only an erasure overwrites them at once.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use tokio::time::sleep;

use crate::domain::change::{Change, ForgottenParts};
use crate::domain::ids::{KeyframeSeq, MapId};
use crate::domain::settings::Settings;
use crate::engine::erasures::recorded;
use crate::engine::keys::keyring::now;
use crate::engine::maps::live::{Decision, LiveMap};
use crate::engine::maps::write_path::Manner;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::redundancy::find_redundant;
use crate::store::Job;

/// Seconds of a day.
const DAY_S: i64 = 86_400;

/// Names of maps that are read at once.
const MAPS_AT_ONCE: usize = 200;

/// Redundant keyframes that one look finds.
const THINNED_AT_ONCE: usize = 100;

impl Service {
    /// Looks at every map now and then.
    pub(in crate::engine) fn start_retention(&self, every: Duration) {
        let (service, closing) = (self.clone(), self.closing.clone());
        tokio::spawn(closing.run_until_cancelled_owned(async move {
            loop {
                sleep(every).await;
                if let Err(error) = service.let_go().await {
                    tracing::warn!(%error, "what settings let go of stays for now");
                }
            }
        }));
    }

    /// Looks at every map once.
    async fn let_go(&self) -> Result<()> {
        let mut after: Option<MapId> = None;
        loop {
            let ids = self.store.map_ids(after.as_ref(), MAPS_AT_ONCE).await?;
            for row in self.store.map_rows(&ids).await? {
                match self.let_go_of(&row.report.id, &row.report.properties.settings).await {
                    Ok(()) | Err(ServiceError::NotFound(_)) => {}
                    // A damaged map keeps none of the others from their turn.
                    Err(error) => {
                        tracing::warn!(map = %row.report.id, %error, "what its settings let go of stays");
                    }
                }
            }
            after = ids.last().cloned();
            if ids.len() < MAPS_AT_ONCE {
                return Ok(());
            }
        }
    }

    async fn let_go_of(&self, map: &MapId, settings: &Settings) -> Result<()> {
        if !self.is_here(map).await {
            return Ok(());
        }
        let key = self.key_of(map).await?;
        if !settings.keep_readings && self.store.has_dialogues(key).await? {
            let _owned = self.own(map).await?;
            self.store.committer().commit(Job::ForgetDialogues(key)).await?;
        }
        if !settings.keep_crops {
            let no_model_reads = !self.configured().roles.vision;
            loop {
                let found = self.store.read_crops(key, no_model_reads).await?;
                if !self.forget_parts(map, found).await? {
                    break;
                }
            }
        }
        if let Some(before) = stored_before(settings.keep_descriptors_days) {
            while self.forget_parts(map, self.store.old_descriptors(key, before).await?).await? {}
        }
        if let Some(before) = stored_before(settings.keep_keyframes_days) {
            self.thin(map, before).await?;
        }
        Ok(())
    }

    /// Has parts of keyframes forgotten, in one version of the map. Returns whether there were any.
    async fn forget_parts(&self, map: &MapId, parts: Vec<ForgottenParts>) -> Result<bool> {
        if parts.is_empty() {
            return Ok(false);
        }
        let live = self.live_in_background(map).await?;
        let keyframes: Vec<KeyframeSeq> = parts.iter().map(|parts| parts.keyframe).collect();
        let decide = move |index: &mut MapIndex| {
            let is_there = |parts: &ForgottenParts| index.keyframe(parts.keyframe).is_some();
            let parts = parts.into_iter().filter(is_there);
            let changes = parts.map(|parts| Change::PartsForgotten(Box::new(parts))).collect();
            Ok(Decision::of((), recorded(index, changes)))
        };
        self.begin(&live, Manner::Freeing, decide).await?.committed().await?;
        for keyframe in keyframes {
            self.features.forget(live.key, keyframe).await;
        }
        Ok(true)
    }

    /// Deletes redundant keyframes that were stored before this second.
    async fn thin(&self, map: &MapId, before_sec: i64) -> Result<()> {
        let mut from = KeyframeSeq(0);
        loop {
            let live: Arc<LiveMap> = self.live_in_background(map).await?;
            let old: BTreeSet<KeyframeSeq> =
                self.store.stored_before(live.key, before_sec, from).await?.into_iter().collect();
            let Some(first) = old.first().copied() else { return Ok(()) };
            let look = move |state: &crate::engine::maps::live::State| {
                let found = find_redundant(&state.index, first, THINNED_AT_ONCE);
                let named = found.keyframes.iter().filter(|seq| old.contains(seq));
                let ids: Vec<_> =
                    named.filter_map(|seq| Some(state.index.keyframe(*seq)?.id.clone())).collect();
                Ok((ids, found.next))
            };
            let (ids, next) = self.read(&live, look).await?.1;
            for id in &ids {
                match self.delete_keyframe(map, id).await {
                    // Its client deleted it meanwhile.
                    Ok(_) | Err(ServiceError::NotFound(_)) => {}
                    Err(error) => return Err(error),
                }
            }
            if !ids.is_empty() {
                tracing::info!(%map, keyframes = ids.len(), "old redundant keyframes were deleted");
            }
            let Some(next) = next else { return Ok(()) };
            from = next;
        }
    }
}

/// Returns the second before which what was stored goes; `None` where all is kept.
fn stored_before(days: u32) -> Option<i64> {
    (days > 0).then(|| now().sec - i64::from(days) * DAY_S)
}
