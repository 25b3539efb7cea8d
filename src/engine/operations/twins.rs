//! Twins are looked for inside the write that brings a sign, so that a map's version says whether it has any.

use std::sync::Arc;

use tokio::runtime::Handle;

use crate::domain::bow::BowVector;
use crate::domain::change::Twins;
use crate::domain::ids::KeyframeSeq;
use crate::domain::keyframe::NewKeyframe;
use crate::engine::maps::live::LiveMap;
use crate::engine::{Result, Service};
use crate::recognition::extensions::twins::{Suspects, are_looked_for, found, suspects};
use crate::recognition::loops::features::MatchableFeatures;
use crate::recognition::loops::query::Query;
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::recorder::Decided;

impl Service {
    /// Looks for a twin of what a keyframe sees, and adds it to the write that is being decided; `new` is the keyframe where
    /// that write brings it. Blocks, as a decision may: not for async threads.
    pub(in crate::engine) fn add_twins(
        &self,
        live: &LiveMap,
        index: &mut MapIndex,
        (keyframe, new): (KeyframeSeq, Option<&NewKeyframe>),
        decided: &mut Decided,
    ) {
        if !are_looked_for(index) {
            return;
        }
        let looked = match new {
            Some(new) => self.twins_of(live, index, (keyframe, Some(new)), &new.bow),
            None => match Handle::current().block_on(self.store.bow(live.key, keyframe)) {
                Ok(bow) => self.twins_of(live, index, (keyframe, None), &bow.unwrap_or_default()),
                Err(error) => Err(error.into()),
            },
        };
        match looked {
            Ok(Some(twins)) => {
                let changes = found(index, twins);
                index.apply(&changes);
                decided.changes.extend(changes);
            }
            Ok(None) => {}
            // The write is decided already, and does not depend on it.
            Err(error) => tracing::warn!(%error, "twins could not be looked for"),
        }
    }

    fn twins_of(
        &self,
        live: &LiveMap,
        index: &MapIndex,
        (keyframe, new): (KeyframeSeq, Option<&NewKeyframe>),
        bow: &BowVector,
    ) -> Result<Option<Twins>> {
        let query = Query::stored(index, keyframe, bow);
        let Some(suspects) = query.and_then(|query| suspects(index, &query)) else { return Ok(None) };
        Handle::current().block_on(async {
            let own = match new.and_then(|new| new.features.clone()) {
                Some(features) => self.features.prepare(features).await?,
                None => None,
            };
            self.verify_twins(live, &suspects, keyframe, own).await
        })
    }

    async fn verify_twins(
        &self,
        live: &LiveMap,
        suspects: &Suspects,
        keyframe: KeyframeSeq,
        own: Option<Arc<MatchableFeatures>>,
    ) -> Result<Option<Twins>> {
        // Whatever was decided before has features to be read; the writer needs no lock of the map.
        live.on_disk(&self.store, live.newest_version()).await?;
        for at in suspects.places() {
            let mut features =
                self.features.read(&self.store, live.key, suspects.wanted_features(at)).await?;
            features.stored.extend(own.clone().map(|own| (keyframe, own)));
            if let Some(twins) = suspects.verify(at, &features) {
                return Ok(Some(twins));
            }
        }
        Ok(None)
    }
}
