//! Whether the maps that a question asks show one view in several places ([`crate::recognition::locate::likeness`]).

use std::collections::BTreeSet;
use std::sync::Arc;

use tokio::task::spawn_blocking;

use crate::config::logging::in_part;
use crate::domain::bow::BowVector;
use crate::domain::ids::{KeyframeSeq, SessionSeq};
use crate::engine::maps::live::LiveMap;
use crate::engine::{Service, ServiceError};
use crate::recognition::locate::likeness::{is_found, most_alike, probes};
use crate::recognition::loops::features::{FeatureSet, MatchableFeatures};
use crate::recognition::loops::geometry_check::{PlacedQuery, Terms, verify_views};
use crate::recognition::loops::geometry_snapshot::GeometrySnapshot;
use crate::recognition::map::index::MapIndex;

/// A stored keyframe as geometry sees it.
struct Seen {
    snapshot: GeometrySnapshot,
    features: Arc<MatchableFeatures>,
}

impl Service {
    /// Whether a keyframe of this session of a map is found in another map, or the map itself has shown one view in two places.
    /// Other sessions of the map may show the same places. Looks at as many pairs as there are probes.
    pub(super) async fn shows_views_twice(
        &self,
        home: (usize, SessionSeq),
        maps: &[Arc<LiveMap>],
        seed: u64,
    ) -> Result<bool, ServiceError> {
        let (home, session) = home;
        let own = move |index: &MapIndex| (index.twins().next().is_some(), probes(index, session));
        let (_, (has_twins, probes)) = self.read(&maps[home], move |state| Ok(own(&state.index))).await?;
        if has_twins {
            return Ok(true);
        }
        for probe in probes {
            let Some(bow) = self.store.bow(maps[home].key, probe).await? else { continue };
            if self.is_elsewhere(probe, Arc::new(bow), home, maps, seed).await? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    async fn is_elsewhere(
        &self,
        probe: KeyframeSeq,
        bow: Arc<BowVector>,
        home: usize,
        maps: &[Arc<LiveMap>],
        seed: u64,
    ) -> Result<bool, ServiceError> {
        let mut best = None;
        for (number, live) in maps.iter().enumerate().filter(|(number, _)| *number != home) {
            let bow = bow.clone();
            let (_, found) = self.read(live, move |state| Ok(most_alike(&state.index, &bow))).await?;
            // The first of equals, by the maps' names.
            let score = |of: &Option<(usize, KeyframeSeq, u64)>| of.map_or(0, |(_, _, units)| units);
            if let Some((keyframe, units)) =
                found.map(|(keyframe, score)| (keyframe, u64::from(score.units())))
                && units > score(&best)
            {
                best = Some((number, keyframe, units));
            }
        }
        let Some((number, other, _)) = best else { return Ok(false) };
        let seen = (self.seen(&maps[home], probe).await?, self.seen(&maps[number], other).await?);
        let (Some(probe), Some(other)) = seen else { return Ok(false) };
        let (_, (settings, metric)) = self
            .read(&maps[number], |state| {
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
            outcome.is_ok_and(|outcome| is_found(&outcome.verification, cameras.0, cameras.1))
        };
        spawn_blocking(in_part("verify", verify)).await.map_err(ServiceError::panicked)
    }

    /// Reads what geometry needs of a keyframe; none if it has no features.
    async fn seen(&self, live: &Arc<LiveMap>, keyframe: KeyframeSeq) -> Result<Option<Seen>, ServiceError> {
        let look = move |index: &MapIndex| GeometrySnapshot::stored(index, keyframe);
        let (_, snapshot) = self.read(live, move |state| Ok(look(&state.index))).await?;
        let mut features =
            self.features.read(&self.store, live.key, BTreeSet::from([keyframe])).await?.stored;
        Ok(snapshot.zip(features.remove(&keyframe)).map(|(snapshot, features)| Seen { snapshot, features }))
    }
}
