//! Use cases: what a client can ask for, without HTTP and without SQL.
//!
//! For every write: the map's lock, a pure decision of [`crate::recognition`], its changes applied to
//! the index and queued for the store, and the answer when they are on disk. Reads look at the
//! index, and at the store for what is only there.

mod anchors;
mod board;
mod error;
mod events;
mod features;
mod giving;
mod judging;
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
mod worker;

use std::path::PathBuf;
use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::spawn_blocking;

pub use error::ServiceError;
pub use keyframes::PendingKeyframe;
pub use queries::{QueryAnswer, Timings};

use crate::config::models::ModelArgs;
use crate::model::ids::MapId;
use crate::models::Models;
use crate::models::judge::Judge;
use crate::models::port::Model;
use crate::recognition::index::MapIndex;
use crate::store::{Job, Store};
use features::FeatureCache;
use live::{Decision, LiveMap, Pending, State};
use registry::Registry;
use words::NamedVocabulary;
pub use worker::Trigger;
use worker::Worker;

/// At most so many writes are decided or wait for the disk at once; more wait their turn.
const WRITES_AT_ONCE: usize = 512;

/// At most so many heavy reads (loop queries, lists) compute at once.
const READS_AT_ONCE: usize = 16;

/// How often a read looks again because a write that it had seen failed.
const READ_AGAIN_MAX: usize = 3;

/// How to open the service.
#[derive(Clone, Debug)]
pub struct ServiceOptions {
    /// `sqlite://PATH`.
    pub database: String,
    /// A vocabulary to compute words with, and to guide the matching of descriptors.
    pub vocabulary: Option<PathBuf>,
    /// The models to ask.
    pub models: ModelChoice,
}

/// The models to ask.
#[derive(Clone, Debug, Default)]
pub enum ModelChoice {
    /// None: the built-in judge answers everything.
    #[default]
    None,
    /// Those that the operator names.
    Configured(Box<ModelArgs>),
    /// These, the second of them for images, with the operator's limits.
    Given(Box<ModelArgs>, [Option<Arc<dyn Model>>; 2]),
}

impl ServiceOptions {
    /// A service on this database, without a vocabulary.
    pub fn on(database: impl Into<String>) -> Self {
        Self { database: database.into(), vocabulary: None, models: ModelChoice::None }
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
    /// Questions that models are to be asked.
    pub model_jobs: u64,
    /// Questions that models could not answer since the start.
    pub model_failures: u64,
    /// 1 while a model is away or the day's budget is spent.
    pub models_away: u64,
    /// Calls of models since the database was made.
    pub model_calls: u64,
    /// Questions answered without a call.
    pub model_cache_hits: u64,
    /// What models cost, in millionths of a US dollar.
    pub model_microusd: u64,
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
    models: Option<Arc<Models>>,
    worker: Arc<Worker>,
}

impl Service {
    /// Opens the database and gets ready; maps are loaded when they are first asked for.
    pub async fn open(options: ServiceOptions) -> Result<Self, ServiceError> {
        let vocabulary = match options.vocabulary {
            Some(path) => Some(Arc::new(words::load(path).await?)),
            None => None,
        };
        let store = Store::open(&options.database).await?;
        let models = open_models(options.models, &store).await?.map(Arc::new);
        let registry = Arc::new(Registry::new(store.next_map_key().await?));
        let service = Self {
            models: models.clone(),
            worker: Worker::new(),
            store,
            registry,
            writes: Arc::new(Semaphore::new(WRITES_AT_ONCE)),
            reads: Arc::new(Semaphore::new(READS_AT_ONCE)),
            features: FeatureCache::new(vocabulary.clone()),
            vocabulary,
        };
        if let Some(models) = models {
            service.worker.start(service.clone(), models);
        }
        Ok(service)
    }

    /// Writes what is queued, and closes the database.
    pub async fn close(&self) {
        self.worker.stop().await;
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
            model_jobs: self.worker.open_jobs(),
            model_failures: self.models.as_ref().map_or(0, |models| models.failures()),
            models_away: self.models.as_ref().map_or(0, |models| u64::from(models.is_away())),
            commits: commits.jobs,
            commit_batches: commits.transactions,
            queue_depth: commits.waiting,
            ..Stats::default()
        };
        for line in self.usage().into_iter().flat_map(|usage| usage.lines) {
            stats.model_calls += line.calls;
            stats.model_cache_hits += line.cache_hits;
            stats.model_microusd += line.microusd;
        }
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

    fn judge(&self) -> Judge {
        self.models.as_ref().map(|models| models.judge.clone()).unwrap_or_default()
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
        self.disk_takes(false)?;
        self.begin_freeing(live, decide).await
    }

    /// Refuses a write that the disk would not take, before the index is ahead of the disk.
    fn disk_takes(&self, freeing: bool) -> Result<(), ServiceError> {
        self.store.committer().refuses(freeing).map_or(Ok(()), |error| Err(error.into()))
    }

    /// [`Self::begin`] for a write that frees space.
    async fn begin_freeing<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        decide: impl FnOnce(&mut MapIndex) -> Result<Decision<T>, ServiceError> + Send + 'static,
    ) -> Result<Begun<T>, ServiceError> {
        self.disk_takes(true)?;
        let permit = self.writes.clone().acquire_owned().await.map_err(|_| closed())?;
        let (deciding, store) = (live.clone(), self.store.clone());
        let pending = spawn_blocking(move || deciding.decide(&store, decide)).await.map_err(panicked)??;
        // Whatever was written, an anchor may lack something now.
        self.worker.wake();
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

    /// [`Self::change`] for a write that frees space: it goes on when the disk is full.
    async fn free<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        decide: impl FnOnce(&mut MapIndex) -> Result<Decision<T>, ServiceError> + Send + 'static,
    ) -> Result<(T, u64), ServiceError> {
        self.begin_freeing(live, decide).await?.committed().await
    }

    /// Reads the index off the async threads, and waits until what was read is on disk. If it never will be, because the
    /// write failed, the map as it is on disk is read instead: reads go on when writes do not.
    async fn read<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        read: impl Fn(&State) -> Result<T, ServiceError> + Send + Sync + 'static,
    ) -> Result<(u64, T), ServiceError> {
        let (read, mut live) = (Arc::new(read), live.clone());
        let mut again = READ_AGAIN_MAX;
        loop {
            let looking = read.clone();
            let on_disk = self.look(&live, move |state| looking(state)).await;
            if on_disk.is_ok() || !live.is_broken() || again == 0 {
                return on_disk;
            }
            again -= 1;
            let anew = self.live(&live.id).await?;
            if anew.key != live.key {
                // Another map of this name: the question was about the one that is gone.
                return on_disk;
            }
            live = anew;
        }
    }

    /// [`Self::read`] for those who look again by themselves.
    async fn look<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        look: impl FnOnce(&State) -> Result<T, ServiceError> + Send + 'static,
    ) -> Result<(u64, T), ServiceError> {
        let _permit = self.reads.acquire().await.map_err(|_| closed())?;
        let looking = live.clone();
        let (version, value) = spawn_blocking(move || {
            let state = looking.state()?;
            Ok::<_, ServiceError>((state.version, look(&state)?))
        })
        .await
        .map_err(panicked)??;
        live.on_disk(version).await?;
        Ok((version, value))
    }
}

/// Opens what is configured. Without models no map waits for one, whatever an earlier process had found.
async fn open_models(choice: ModelChoice, store: &Store) -> Result<Option<Models>, ServiceError> {
    let opened = match choice {
        ModelChoice::None => Ok(None),
        ModelChoice::Configured(args) => Models::open(&args, store).await,
        ModelChoice::Given(args, models) => Models::with(models, None, &args, store).await.map(Some),
    };
    let models = opened.map_err(|error| ServiceError::Internal(error.to_string()))?;
    if models.is_none() {
        store.committer().commit(Job::ForgetAway).await?;
    }
    Ok(models)
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
