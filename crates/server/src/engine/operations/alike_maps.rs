//! Whether the maps that a question asks show one view in several places ([`crate::recognition::locate::likeness`]).

use std::sync::Arc;

use crate::domain::bow::BowVector;
use crate::domain::ids::{KeyframeSeq, SessionSeq};
use crate::engine::maps::live::{LiveMap, State};
use crate::engine::{Result, Service};
use crate::recognition::locate::likeness::{PROBES_MAX, alike_cells, most_alike, probes};
use crate::recognition::loops::features::{FeatureSet, MatchableFeatures};
use crate::recognition::loops::geometry_check::{Comparisons, PlacedQuery, Terms, verify_views};
use crate::recognition::loops::geometry_snapshot::GeometrySnapshot;
use crate::recognition::loops::screening::Stage;
use crate::recognition::loops::wanted_features::WantedFeatures;
use crate::recognition::map::index::MapIndex;

/// A keyframe as geometry sees it.
struct Seen {
    snapshot: GeometrySnapshot,
    features: Arc<MatchableFeatures>,
}

impl Service {
    /// Returns the most cells of a view of this session that a keyframe of one of these other maps explains. Other sessions of
    /// the home map may show the same places. Looks at so many pairs; where there is none to look at, or where the map itself
    /// has shown one view in two places, a view says nothing of its place.
    pub(super) async fn alike_cells(
        &self,
        (home, session): (&Arc<LiveMap>, SessionSeq),
        others: &[&Arc<LiveMap>],
        pairs: usize,
        seed: u64,
    ) -> Result<usize> {
        let own = move |index: &MapIndex| {
            (index.twins().next().is_some(), probes(index, session, pairs.min(PROBES_MAX)))
        };
        let (_, (has_twins, probes)) = self.read(home, move |state| Ok(own(&state.index))).await?;
        if has_twins || pairs == 0 {
            return Ok(usize::MAX);
        }
        let mut most = 0;
        for probe in probes {
            let Some(bow) = self.store.bow(home.key, probe).await? else { continue };
            if let Some((map, keyframe)) = self.most_alike(others, Arc::new(bow)).await? {
                most = self.cells_in_common((home, probe), (others[map], keyframe), seed).await?.max(most);
            }
        }
        Ok(most)
    }

    /// Returns the keyframe of some maps whose words are most like a vector, the first of equals.
    async fn most_alike(
        &self,
        maps: &[&Arc<LiveMap>],
        bow: Arc<BowVector>,
    ) -> Result<Option<(usize, KeyframeSeq)>> {
        let mut best: Option<(usize, KeyframeSeq, u32)> = None;
        for (map, live) in maps.iter().enumerate() {
            let bow = bow.clone();
            let (_, found) = self.read(live, move |state| Ok(most_alike(&state.index, &bow))).await?;
            if let Some((keyframe, score)) = found
                && best.is_none_or(|(_, _, units)| score.units() > units)
            {
                best = Some((map, keyframe, score.units()));
            }
        }
        Ok(best.map(|(map, keyframe, _)| (map, keyframe)))
    }

    /// Returns how many cells of the one keyframe's view the other one explains.
    async fn cells_in_common(
        &self,
        (home, probe): (&Arc<LiveMap>, KeyframeSeq),
        (other_map, other): (&Arc<LiveMap>, KeyframeSeq),
        seed: u64,
    ) -> Result<usize> {
        let seen = (self.seen(home, probe).await?, self.seen(other_map, other).await?);
        let (Some(probe), Some(other)) = seen else { return Ok(0) };
        let terms = |state: &State| {
            let properties = state.index.properties();
            Ok((properties.settings.clone(), properties.metric))
        };
        let (_, (settings, metric)) = self.read(other_map, terms).await?;
        let verify = move || {
            let terms = Terms { settings: &settings, metric };
            let comparisons = Comparisons::default();
            let asked = PlacedQuery::new((&probe.snapshot, &probe.features), &comparisons);
            let (seen, none) = ((&other.snapshot, &*other.features), FeatureSet::default());
            let outcome = verify_views(&terms, Stage::AskGeometry, &asked, seen, &none, seed);
            let cameras = (&probe.snapshot.camera, &other.snapshot.camera);
            outcome.map_or(0, |outcome| alike_cells(&outcome.verification, cameras.0, cameras.1))
        };
        self.verify(None, verify).await
    }

    /// Reads what geometry needs of a keyframe; none if it has no features.
    async fn seen(&self, live: &Arc<LiveMap>, keyframe: KeyframeSeq) -> Result<Option<Seen>> {
        let look = move |index: &MapIndex| GeometrySnapshot::stored(index, keyframe);
        let (_, snapshot) = self.read(live, move |state| Ok(look(&state.index))).await?;
        let Some(snapshot) = snapshot else { return Ok(None) };
        let wanted = WantedFeatures::alone(keyframe, &snapshot);
        let mut features = self.features.read(&self.store, live.key, wanted).await?.stored;
        Ok(features.remove(&keyframe).map(|features| Seen { snapshot, features }))
    }
}
