//! Use cases: what a client can ask for, without HTTP and without SQL.
//!
//! For every write: the map's lock, a pure decision of [`crate::recognition`], its changes applied to
//! the index and queued for the store, and the answer when they are on disk. Reads look at the
//! index, and at the store for what is only there.

mod bow;
mod descriptions;
mod error;
pub mod keys;
pub mod limits;
mod maps;
mod operations;
mod options;
mod rebuild;
#[cfg(test)]
mod rebuild_equals_live;
mod triggers;
mod unexamined;
mod verdict_record;

use std::ops::Deref;
use std::sync::Arc;

use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;

pub use error::ServiceError;
use maps::eviction::Used;
pub use maps::feeds::Listener;
pub use maps::pinned::PinnedMap;
pub use operations::backups::BackupMade;
use operations::backups::Backups;
use operations::export::Exports;
pub use operations::export::MapExport;
pub use operations::keyframes::PendingKeyframe;
pub use operations::loops::ConfirmedLoop;
pub use operations::queries::{QueryAnswer, Timings};
pub use operations::stats::Stats;
pub use options::{ModelChoice, ServiceOptions, WriteAnswer};

use crate::config::quotas::Quotas;
use crate::domain::ids::MapId;
use crate::llm::Models;
use crate::store::{Job, MapKey, Store};
use bow::NamedVocabulary;
use descriptions::rejudging::Rejudging;
use descriptions::worker::Worker;
use keys::keyring::Keyring;
use limits::concurrency_limit::ConcurrencyLimit;
use limits::load_shedding::LoadShedding;
use maps::features::FeatureCache;
use maps::live::LiveMap;
use maps::registry::Registry;
use triggers::Triggers;
use verdict_record::VerdictCounters;
pub use verdict_record::VerdictCounts;

/// At most so many writes are decided or wait for the disk at once; more wait their turn.
const WRITES_AT_ONCE: usize = 512;

/// At most so many reads (loop queries, lists) compute at once, for each core. More would only take turns on it, and
/// keep those waiting who need it for a moment.
const READS_PER_CORE: usize = 2;

/// At most so many wait for either; the pressure of requests bounds them first, unless the operator or many cores
/// allow more.
const WAITING_MAX: usize = 1024;

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

/// The service; clones share everything. Every request makes some.
#[derive(Clone, Debug)]
pub struct Service(Arc<Parts>);

/// The parts of a service.
#[derive(Clone, Debug)]
pub struct Parts {
    store: Store,
    registry: Arc<Registry>,
    writes: Arc<ConcurrencyLimit>,
    reads: Arc<ConcurrencyLimit>,
    /// As many writes are decided at once as there are cores; more would only take turns on them.
    deciding: Arc<Semaphore>,
    pressure: Arc<LoadShedding>,
    features: FeatureCache,
    vocabulary: Option<Arc<NamedVocabulary>>,
    models: Option<Arc<Models>>,
    worker: Arc<Worker>,
    rejudging: Arc<Rejudging>,
    triggers: Arc<Triggers>,
    verdicts: Arc<VerdictCounters>,
    write_answer: WriteAnswer,
    keys: Keyring,
    quotas: Quotas,
    exports: Exports,
    /// Ends what goes on in the background.
    closing: CancellationToken,
    backups: Option<Arc<Backups>>,
}

impl Deref for Service {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        &self.0
    }
}

impl Service {
    /// Opens the database and gets ready; maps are loaded when they are first asked for.
    pub async fn open(options: ServiceOptions) -> Result<Self, ServiceError> {
        let vocabulary = match options.vocabulary {
            Some(path) => Some(Arc::new(bow::load(path).await?)),
            None => None,
        };
        let store = Store::open(&options.database).await?;
        let models = open_models(options.models, &store).await?.map(Arc::new);
        let registry = Arc::new(Registry::new(options.map_memory));
        let service = Self(Arc::new(Parts {
            models: models.clone(),
            worker: Worker::new(),
            rejudging: Arc::default(),
            triggers: Arc::default(),
            verdicts: Arc::default(),
            write_answer: options.write_answer,
            keys: Keyring::open(store.clone(), options.keys_required).await?,
            quotas: options.quotas,
            exports: Exports::default(),
            closing: CancellationToken::new(),
            store,
            registry,
            writes: ConcurrencyLimit::new(WRITES_AT_ONCE, WAITING_MAX),
            reads: ConcurrencyLimit::new(READS_PER_CORE * cores(), WAITING_MAX),
            deciding: Arc::new(Semaphore::new(cores())),
            pressure: Arc::default(),
            features: FeatureCache::new(vocabulary.clone()),
            vocabulary,
            backups: None,
        }));
        service.poll_key_changes();
        service.start_triggers();
        if let Some(models) = models {
            service.worker.start(service.clone(), models.clone());
            service.rejudging.start(service.clone(), models);
        }
        Ok(service)
    }

    /// Writes what is queued, and closes the database.
    pub async fn close(&self) {
        self.closing.cancel();
        tokio::join!(self.worker.stop(), self.rejudging.stop());
        self.store.close().await;
    }

    /// The keys of this database.
    pub fn keys(&self) -> &Keyring {
        &self.keys
    }

    /// Sees in the background what other processes do to the keys.
    fn poll_key_changes(&self) {
        let (keys, closing) = (self.keys.clone(), self.closing.clone());
        tokio::spawn(closing.run_until_cancelled_owned(async move {
            loop {
                tokio::time::sleep(keys::keyring::POLL_INTERVAL).await;
                keys.poll_changes().await;
            }
        }));
    }

    /// Is the service open? Asks memory only: whoever wants to know must hear it under any load.
    pub fn ready(&self) -> Result<(), ServiceError> {
        if self.store.is_closed() { Err(closed()) } else { Ok(()) }
    }

    /// How much is being worked on.
    pub fn pressure(&self) -> &Arc<LoadShedding> {
        &self.pressure
    }

    /// The version of SQLite.
    pub async fn sqlite_version(&self) -> Result<String, ServiceError> {
        Ok(self.store.sqlite_version().await?)
    }

    async fn live(&self, id: &MapId) -> Result<Arc<LiveMap>, ServiceError> {
        let was_in_memory = self.registry.in_memory_now(id).is_some();
        let live = self.registry.get(&self.store, id, Used::ByClient).await?;
        if !was_in_memory {
            // Its anchors may lack what a model that was configured since could give.
            self.worker.wake();
        }
        Ok(live)
    }

    /// The key of the map that has this name now, which need not be in memory for that.
    async fn key_of(&self, id: &MapId) -> Result<MapKey, ServiceError> {
        if let Some(live) = self.registry.in_memory_now(id) {
            return Ok(live.key);
        }
        self.store.map_key(id).await?.ok_or_else(|| ServiceError::no_map(id))
    }

    /// [`Self::live`] for work that no client waits for: the map does not count as used.
    async fn live_in_background(&self, id: &MapId) -> Result<Arc<LiveMap>, ServiceError> {
        self.registry.get(&self.store, id, Used::InBackground).await
    }
}

/// Opens what is configured. Without models no map waits for one, whatever an earlier process had found.
async fn open_models(choice: ModelChoice, store: &Store) -> Result<Option<Models>, ServiceError> {
    let models = match choice {
        ModelChoice::None => None,
        #[cfg(feature = "llm")]
        ModelChoice::Configured(args) => {
            let opened = Models::open(&args, store).await;
            opened.map_err(|error| ServiceError::Internal(error.to_string()))?
        }
        ModelChoice::Given(args, models) => Some(Models::with(models, None, &args, store).await?),
    };
    if models.is_none() {
        store.committer().commit(Job::ForgetAway).await?;
    }
    Ok(models)
}

/// Milliseconds since a moment, for a client's `server-timing`.
fn milliseconds_since(start: std::time::Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(2, usize::from)
}

fn closed() -> ServiceError {
    ServiceError::Unavailable { detail: "the service is closing".to_owned(), retry_after_s: 1 }
}
