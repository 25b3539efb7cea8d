//! Twins are looked for after the write that brings or describes a sign, and kept in a version of the map of its own.

use std::sync::Arc;

use crate::domain::ids::KeyframeSeq;
use crate::engine::maps::live::{Decision, LiveMap, State};
use crate::engine::{Result, Service};
use crate::recognition::extensions::twins::{Suspects, are_looked_for, keep, suspects};
use crate::recognition::map::index::MapIndex;

impl Service {
    /// Looks for a twin of what a keyframe sees, after one of its signs was described.
    pub(in crate::engine) async fn look_for_twins(&self, live: &Arc<LiveMap>, keyframe: KeyframeSeq) {
        if let Err(error) = self.suspect_twins(live, keyframe).await {
            // The write is on its way already, and does not depend on it.
            tracing::warn!(%error, "twins could not be looked for");
        }
    }

    async fn suspect_twins(&self, live: &Arc<LiveMap>, keyframe: KeyframeSeq) -> Result<()> {
        if live.glance(|state| are_looked_for(&state.index)).is_some_and(|(_, looked_for)| !looked_for) {
            return Ok(());
        }
        let Some(bow) = self.store.bow(live.key, keyframe).await? else { return Ok(()) };
        let look = move |state: &State| Ok(suspects(&state.index, keyframe, &bow));
        match self.look(live, look).await? {
            (_, Some(suspects)) => self.verify_twins(live, suspects).await,
            (_, None) => Ok(()),
        }
    }

    /// Has geometry look at suspects, and keeps the first that is a twin.
    pub(super) async fn verify_twins(&self, live: &Arc<LiveMap>, suspects: Suspects) -> Result<()> {
        // The features of whatever was decided before are read from the disk.
        live.on_disk(&self.store, live.newest_version()).await?;
        let suspects = Arc::new(suspects);
        for at in suspects.places() {
            let features = self.features.read(&self.store, live.key, suspects.wanted_features(at)).await?;
            let looking = suspects.clone();
            if let Some(twins) = self.verify(Some(live.key), move || looking.verify(at, &features)).await? {
                let decide = move |index: &mut MapIndex| Ok(Decision::of((), keep(index, twins)));
                return self.change(live, decide).await.map(drop);
            }
        }
        Ok(())
    }
}
