//! Whether the maps that a question asks show one view in several places ([`crate::recognition::locate::likeness`]).

use std::sync::Arc;

use tokio::task::spawn_blocking;

use super::locate::SearchedMap;
use crate::config::logging::in_part;
use crate::domain::bow::BowVector;
use crate::domain::ids::{KeyframeSeq, MapId, SessionSeq};
use crate::engine::maps::live::LiveMap;
use crate::engine::{Service, ServiceError};
use crate::recognition::locate::likeness::{PROBES_MAX, alike_cells, most_alike, probes};
use crate::recognition::loops::features::{FeatureSet, MatchableFeatures};
use crate::recognition::loops::geometry_check::{PlacedQuery, Terms, verify_views};
use crate::recognition::loops::geometry_snapshot::GeometrySnapshot;
use crate::recognition::loops::wanted_features::WantedFeatures;
use crate::recognition::map::index::MapIndex;
use crate::store::WordsSought;

/// A keyframe as geometry sees it.
struct Seen {
    snapshot: GeometrySnapshot,
    features: Arc<MatchableFeatures>,
}

/// A keyframe of another map that looks most like a probe.
#[derive(Clone, Copy)]
struct Elsewhere {
    map: usize,
    keyframe: KeyframeSeq,
    score_units: u32,
}

impl Service {
    /// Returns the most cells of a view of this session that a keyframe of another map explains. Other sessions of the home map
    /// may show the same places. Looks at so many pairs; where there is none to look at, or where the map itself has shown one
    /// view in two places, a view says nothing of its place.
    pub(super) async fn alike_cells(
        &self,
        (home, session): (usize, SessionSeq),
        maps: &[SearchedMap],
        pairs: usize,
        seed: u64,
    ) -> Result<usize, ServiceError> {
        let (_, Some(live)) = &maps[home] else { return Ok(usize::MAX) };
        let own = move |index: &MapIndex| {
            (index.twins().next().is_some(), probes(index, session, pairs.min(PROBES_MAX)))
        };
        let (_, (has_twins, probes)) = self.read(live, move |state| Ok(own(&state.index))).await?;
        if has_twins || pairs == 0 {
            return Ok(usize::MAX);
        }
        let (mut asking, mut vectors) = (Vec::new(), Vec::new());
        for probe in probes {
            if let Some(bow) = self.store.bow(live.key, probe).await? {
                asking.push(probe);
                vectors.push(bow);
            }
        }
        let elsewhere = self.most_alike_elsewhere(home, maps, Arc::new(vectors)).await?;
        let mut most = 0;
        for (probe, other) in asking.into_iter().zip(elsewhere) {
            let Some(Elsewhere { map, keyframe, .. }) = other else { continue };
            let other = match &maps[map] {
                (_, Some(live)) => live.clone(),
                (asked, None) => match self.live(&asked.id).await {
                    // Deleted meanwhile.
                    Err(ServiceError::NotFound(_)) => continue,
                    live => live?,
                },
            };
            most = self.cells_in_common((live, probe), (&other, keyframe), seed).await?.max(most);
        }
        Ok(most)
    }

    /// Returns for each vector the keyframe of all other maps whose words are most like it, the first of equals by the maps'
    /// names.
    async fn most_alike_elsewhere(
        &self,
        home: usize,
        maps: &[SearchedMap],
        vectors: Arc<Vec<BowVector>>,
    ) -> Result<Vec<Option<Elsewhere>>, ServiceError> {
        let mut best: Vec<Option<Elsewhere>> = vec![None; vectors.len()];
        for (map, (asked, live)) in maps.iter().enumerate().filter(|(map, _)| *map != home) {
            let found = match live {
                Some(live) => self.most_alike_in_memory(live, vectors.clone()).await?,
                None => self.most_alike_on_disk(&asked.id, &vectors).await?,
            };
            for (best, found) in best.iter_mut().zip(found) {
                let Some((keyframe, score_units)) = found else { continue };
                if best.is_none_or(|best| score_units > best.score_units) {
                    *best = Some(Elsewhere { map, keyframe, score_units });
                }
            }
        }
        Ok(best)
    }

    async fn most_alike_in_memory(
        &self,
        live: &Arc<LiveMap>,
        vectors: Arc<Vec<BowVector>>,
    ) -> Result<Vec<Option<(KeyframeSeq, u32)>>, ServiceError> {
        let search = move |index: &MapIndex| -> Vec<_> {
            let found = vectors.iter().map(|vector| most_alike(index, vector));
            found.map(|found| found.map(|(keyframe, score)| (keyframe, score.units()))).collect()
        };
        Ok(self.read(live, move |state| Ok(search(&state.index))).await?.1)
    }

    async fn most_alike_on_disk(
        &self,
        map: &MapId,
        vectors: &[BowVector],
    ) -> Result<Vec<Option<(KeyframeSeq, u32)>>, ServiceError> {
        let sought = WordsSought { vectors, must_have_camera: true };
        let found = self.store.most_alike(map, sought, |_| true).await?.map(|(_, found)| found);
        let found = found.unwrap_or_default().into_iter();
        Ok(found.map(|found| found.map(|found| (found.keyframe, found.score.units()))).collect())
    }

    /// Returns how many cells of the one keyframe's view the other one explains.
    async fn cells_in_common(
        &self,
        (home, probe): (&Arc<LiveMap>, KeyframeSeq),
        (other_map, other): (&Arc<LiveMap>, KeyframeSeq),
        seed: u64,
    ) -> Result<usize, ServiceError> {
        let seen = (self.seen(home, probe).await?, self.seen(other_map, other).await?);
        let (Some(probe), Some(other)) = seen else { return Ok(0) };
        let (_, (settings, metric)) = self
            .read(other_map, |state| {
                let properties = state.index.properties();
                Ok((properties.settings.clone(), properties.metric))
            })
            .await?;
        let verify = move || {
            let terms = Terms { settings: &settings, metric };
            let asked = PlacedQuery::new((&probe.snapshot, &probe.features));
            let outcome = verify_views(
                &terms,
                &asked,
                (&other.snapshot, &other.features),
                &FeatureSet::default(),
                seed,
            );
            let cameras = (&probe.snapshot.camera, &other.snapshot.camera);
            outcome.map_or(0, |outcome| alike_cells(&outcome.verification, cameras.0, cameras.1))
        };
        spawn_blocking(in_part("verify", verify)).await.map_err(ServiceError::panicked)
    }

    /// Reads what geometry needs of a keyframe; none if it has no features.
    async fn seen(&self, live: &Arc<LiveMap>, keyframe: KeyframeSeq) -> Result<Option<Seen>, ServiceError> {
        let look = move |index: &MapIndex| GeometrySnapshot::stored(index, keyframe);
        let (_, snapshot) = self.read(live, move |state| Ok(look(&state.index))).await?;
        let Some(snapshot) = snapshot else { return Ok(None) };
        let wanted = WantedFeatures::alone(keyframe, &snapshot);
        let mut features = self.features.read(&self.store, live.key, wanted).await?.stored;
        Ok(features.remove(&keyframe).map(|features| Seen { snapshot, features }))
    }
}
