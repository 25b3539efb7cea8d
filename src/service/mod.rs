//! Use cases: what a client can ask for, without HTTP and without SQL.
//!
//! For every write: the map's lock, a pure decision of [`crate::recognition`], its changes applied to
//! the index and queued for the store, and the answer when they are on disk. Reads look at the
//! index, and at the store for what is only there.

mod anchors;
mod error;
mod events;
mod features;
mod keyframes;
#[cfg(test)]
mod law;
mod live;
mod loops;
mod maps;
mod poses;
mod queries;
mod registry;
mod reports;
mod words;

use std::path::PathBuf;
use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::spawn_blocking;

pub use error::ServiceError;
pub use keyframes::PendingKeyframe;
pub use queries::{QueryAnswer, Timings};

use crate::model::ids::MapId;
use crate::recognition::index::MapIndex;
use crate::store::Store;
use features::FeatureCache;
use live::{Decision, LiveMap, Pending, State};
use registry::Registry;
use words::NamedVocabulary;

/// At most so many writes are decided or wait for the disk at once; more wait their turn.
const WRITES_AT_ONCE: usize = 512;

/// At most so many heavy reads (loop queries, lists) compute at once.
const READS_AT_ONCE: usize = 16;

/// How to open the service.
#[derive(Clone, Debug)]
pub struct ServiceOptions {
    /// `sqlite://PATH`.
    pub database: String,
    /// A vocabulary to compute words with, and to guide the matching of descriptors.
    pub vocabulary: Option<PathBuf>,
}

impl ServiceOptions {
    /// A service on this database, without a vocabulary.
    pub fn on(database: impl Into<String>) -> Self {
        Self { database: database.into(), vocabulary: None }
    }
}

/// A write's result, and whether it was made now or had been before.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored<T> {
    /// False if the identical request was answered before.
    pub created: bool,
    /// The map's version.
    pub map_version: u64,
    /// The result.
    pub value: T,
}

/// Figures for the metrics page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Maps in memory.
    pub maps: u64,
    /// Keyframes of these maps.
    pub keyframes: u64,
    /// Anchors of these maps, merged ones counted once.
    pub anchors: u64,
    /// Postings of their inverted files.
    pub postings: u64,
    /// Bytes of their inverted files.
    pub index_bytes: u64,
    /// Writes committed since the start.
    pub commits: u64,
    /// Transactions they took.
    pub commit_batches: u64,
    /// Writes waiting for the disk.
    pub queue_depth: u64,
}

/// The service; clones share everything.
#[derive(Clone, Debug)]
pub struct Service {
    store: Store,
    registry: Arc<Registry>,
    writes: Arc<Semaphore>,
    reads: Arc<Semaphore>,
    features: FeatureCache,
    vocabulary: Option<Arc<NamedVocabulary>>,
}

impl Service {
    /// Opens the database and gets ready; maps are loaded when they are first asked for.
    pub async fn open(options: ServiceOptions) -> Result<Self, ServiceError> {
        let vocabulary = match options.vocabulary {
            Some(path) => Some(Arc::new(words::load(path).await?)),
            None => None,
        };
        let store = Store::open(&options.database).await?;
        let registry = Arc::new(Registry::new(store.next_map_key().await?));
        Ok(Self {
            store,
            registry,
            writes: Arc::new(Semaphore::new(WRITES_AT_ONCE)),
            reads: Arc::new(Semaphore::new(READS_AT_ONCE)),
            features: FeatureCache::new(vocabulary.clone()),
            vocabulary,
        })
    }

    /// Writes what is queued, and closes the database.
    pub async fn close(&self) {
        self.store.close().await;
    }

    /// Does the database answer?
    pub async fn ready(&self) -> Result<(), ServiceError> {
        self.store.sqlite_version().await?;
        Ok(())
    }

    /// The version of SQLite.
    pub async fn sqlite_version(&self) -> Result<String, ServiceError> {
        Ok(self.store.sqlite_version().await?)
    }

    /// Figures for the metrics page, of the maps in memory.
    pub fn stats(&self) -> Stats {
        let commits = self.store.committer().stats();
        let mut stats = Stats {
            commits: commits.jobs,
            commit_batches: commits.transactions,
            queue_depth: commits.waiting,
            ..Stats::default()
        };
        for live in self.registry.in_memory() {
            let Ok(state) = live.state() else { continue };
            stats.maps += 1;
            stats.keyframes += state.index.keyframe_count() as u64;
            stats.anchors += state.index.objects().len() as u64;
            stats.postings += state.index.inverted_file().posting_count() as u64;
            stats.index_bytes += state.index.inverted_file().heap_bytes() as u64;
        }
        stats
    }

    async fn live(&self, id: &MapId) -> Result<Arc<LiveMap>, ServiceError> {
        self.registry.get(&self.store, id).await
    }

    /// Decides a write off the async threads and queues it. If the client goes away, the decision is
    /// committed all the same.
    async fn begin<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        decide: impl FnOnce(&mut MapIndex) -> Result<Decision<T>, ServiceError> + Send + 'static,
    ) -> Result<Begun<T>, ServiceError> {
        let permit = self.writes.clone().acquire_owned().await.map_err(|_| closed())?;
        let (deciding, store) = (live.clone(), self.store.clone());
        let pending = spawn_blocking(move || deciding.decide(&store, decide)).await.map_err(panicked)??;
        Ok(Begun { live: live.clone(), pending, _permit: permit })
    }

    /// Decides a write and waits until it is on disk.
    async fn change<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        decide: impl FnOnce(&mut MapIndex) -> Result<Decision<T>, ServiceError> + Send + 'static,
    ) -> Result<(T, u64), ServiceError> {
        self.begin(live, decide).await?.committed().await
    }

    /// Reads the index off the async threads, and waits until what was read is on disk.
    async fn read<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        read: impl FnOnce(&State) -> Result<T, ServiceError> + Send + 'static,
    ) -> Result<(u64, T), ServiceError> {
        let _permit = self.reads.acquire().await.map_err(|_| closed())?;
        let reading = live.clone();
        let (version, value) = spawn_blocking(move || {
            let state = reading.state()?;
            Ok::<_, ServiceError>((state.version, read(&state)?))
        })
        .await
        .map_err(panicked)??;
        live.on_disk(version).await?;
        Ok((version, value))
    }
}

/// A write that is decided and on its way to the disk.
struct Begun<T> {
    live: Arc<LiveMap>,
    pending: Pending<T>,
    /// Counts among the writes under way until the disk has it.
    _permit: OwnedSemaphorePermit,
}

impl<T> Begun<T> {
    /// Waits until it is on disk.
    async fn committed(self) -> Result<(T, u64), ServiceError> {
        self.pending.committed(&self.live).await
    }
}

/// Milliseconds since a moment, for a client's `server-timing`.
fn milliseconds_since(start: std::time::Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn closed() -> ServiceError {
    ServiceError::Unavailable { detail: "the service is closing".to_owned(), retry_after_s: 1 }
}

fn panicked(error: tokio::task::JoinError) -> ServiceError {
    ServiceError::Internal(format!("a decision did not finish: {error}"))
}
