//! Features of keyframes, read from disk for the few that geometry looks at; a cache bounded in bytes.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use futures_util::{StreamExt as _, TryStreamExt as _, stream};
use moka::future::Cache;

use crate::domain::ids::KeyframeSeq;
use crate::domain::keyframe::Features;
use crate::engine::named_vocabulary::NamedVocabulary;
use crate::engine::tasks::blocking;
use crate::engine::{Result, ServiceError};
use crate::recognition::loops::features::{FeatureSet, MatchableFeatures};
use crate::recognition::loops::wanted_features::WantedFeatures;
use crate::recognition::verification::descriptor_matching::NO_NODE;
use crate::store::{MapKey, Store, StoreError};

/// What the cache may hold: some thousand keyframes of a thousand features.
const CACHE_BYTES: u64 = 256 * 1024 * 1024;

/// Keyframes read in one statement.
const READS_AT_ONCE: usize = 8;

/// The features of keyframes, by map and number. Both are never given twice while the server runs, and a keyframe's
/// features never change but for their map points, which the question brings, so nothing in here can be out of date.
#[derive(Clone, Debug)]
pub(in crate::engine) struct FeatureCache {
    cache: Cache<(MapKey, KeyframeSeq), Arc<MatchableFeatures>>,
    /// Groups features by node, so that only those of one node are compared.
    vocabulary: Option<Arc<NamedVocabulary>>,
    /// Features that geometry found in it.
    pub hits: Arc<AtomicU64>,
    /// Features that it had to read from disk.
    pub misses: Arc<AtomicU64>,
}

impl FeatureCache {
    pub fn new(vocabulary: Option<Arc<NamedVocabulary>>) -> Self {
        let weigh = |_: &(MapKey, KeyframeSeq), features: &Arc<MatchableFeatures>| {
            u32::try_from(features.heap_bytes()).unwrap_or(u32::MAX)
        };
        let cache = Cache::builder().max_capacity(CACHE_BYTES).weigher(weigh).build();
        Self { cache, vocabulary, hits: Arc::default(), misses: Arc::default() }
    }

    /// Returns the bytes of the features in it.
    pub fn bytes(&self) -> u64 {
        self.cache.weighted_size()
    }

    /// Returns the features of these keyframes, with the map points that they observe at the version of the question; those
    /// without any are left out.
    pub async fn read(&self, store: &Store, map: MapKey, wanted: WantedFeatures) -> Result<FeatureSet> {
        let found: Vec<_> = stream::iter(wanted.keyframes)
            .map(|(seq, points)| async move {
                let sent = self.read_one(store, map, seq).await?;
                let now = |sent: Arc<MatchableFeatures>| match points {
                    Some(points) => Arc::new(sent.observing(&points)),
                    None => sent,
                };
                Ok::<_, ServiceError>((seq, sent.map(now)))
            })
            .buffer_unordered(READS_AT_ONCE)
            .try_collect()
            .await?;
        let stored = found.into_iter().filter_map(|(seq, features)| Some((seq, features?))).collect();
        Ok(FeatureSet { inline: None, stored })
    }

    /// Returns the features of a keyframe that is not stored, ready to be matched; `None` if their lists do not fit
    /// together.
    pub async fn prepare(&self, features: Features) -> Result<Option<Arc<MatchableFeatures>>> {
        let vocabulary = self.vocabulary.clone();
        let prepared = blocking(move || prepare(features, vocabulary.as_deref())).await?;
        Ok(prepared.map(Arc::new))
    }

    /// Nobody asks for a keyframe that is gone: its room is for others.
    pub async fn forget(&self, map: MapKey, keyframe: KeyframeSeq) {
        self.cache.invalidate(&(map, keyframe)).await;
    }

    /// The same for a whole map.
    pub async fn forget_map(&self, map: MapKey) {
        let of_map: Vec<_> = self.cache.iter().map(|(key, _)| *key).filter(|(of, _)| *of == map).collect();
        for key in of_map {
            self.cache.invalidate(&key).await;
        }
    }

    async fn read_one(
        &self,
        store: &Store,
        map: MapKey,
        seq: KeyframeSeq,
    ) -> Result<Option<Arc<MatchableFeatures>>> {
        if let Some(known) = self.cache.get(&(map, seq)).await {
            self.hits.fetch_add(1, Ordering::Relaxed);
            return Ok(Some(known));
        }
        self.misses.fetch_add(1, Ordering::Relaxed);
        let Some(features) = store.features(map, seq).await? else { return Ok(None) };
        let prepared = self.prepare(features).await?;
        let features = prepared.ok_or_else(|| {
            StoreError::Corrupt(format!("the features of keyframe {} do not fit together", seq.0))
        })?;
        self.cache.insert((map, seq), features.clone()).await;
        Ok(Some(features))
    }
}

/// Packs features, and groups them by the vocabulary's nodes if it has descriptors of their length.
fn prepare(features: Features, vocabulary: Option<&NamedVocabulary>) -> Option<MatchableFeatures> {
    let groups =
        vocabulary.and_then(|named| Some(named.vocabulary.transform_features(&features).ok()?.groups));
    let mut prepared = MatchableFeatures::of(features)?;
    prepared.nodes = groups.map(|groups| {
        let mut nodes = vec![NO_NODE; prepared.keypoints.len()];
        for (node, of_node) in groups.iter() {
            for feature in of_node {
                nodes[*feature as usize] = node;
            }
        }
        nodes
    });
    Some(prepared)
}
