//! Use cases: what a client can ask for, without HTTP and without SQL.
//!
//! For every write: the map's lock, a pure decision of [`crate::recognition`], its changes applied to
//! the index and queued for the store, and the answer when they are on disk. Reads look at the
//! index, and at the store for what is only there.

mod anchors;
mod backups;
mod board;
mod error;
mod events;
mod features;
mod gate;
mod giving;
mod judging;
mod keyframes;
pub mod keyring;
#[cfg(test)]
mod law;
mod live;
mod loops;
mod maps;
mod poses;
pub mod pressure;
mod queries;
mod quota;
mod registry;
mod reports;
mod stats;
mod words;
mod worker;

use std::path::PathBuf;
use std::sync::Arc;

use tokio::sync::OwnedSemaphorePermit;
use tokio::task::spawn_blocking;
use tokio_util::sync::CancellationToken;
use tracing::Instrument as _;

pub use backups::BackupMade;
use backups::Backups;
pub use error::ServiceError;
pub use keyframes::PendingKeyframe;
pub use queries::{QueryAnswer, Timings};
pub use stats::Stats;

use crate::config::logging::in_part;
use crate::config::models::ModelArgs;
use crate::config::quotas::Quotas;
use crate::config::traces;
use crate::model::ids::MapId;
use crate::models::Models;
use crate::models::port::Model;
use crate::recognition::index::MapIndex;
use crate::store::{Job, Store};
use features::FeatureCache;
use gate::Gate;
use keyring::Keyring;
use live::{Decision, LiveMap, Pending, State};
use pressure::Pressure;
use registry::Registry;
use words::NamedVocabulary;
pub use worker::Trigger;
use worker::Worker;

/// At most so many writes are decided or wait for the disk at once; more wait their turn.
const WRITES_AT_ONCE: usize = 512;

/// At most so many reads (loop queries, lists) compute at once, for each core. More would only take turns on it, and
/// keep those waiting who need it for a moment.
const READS_PER_CORE: usize = 2;

/// At most so many wait for either; the pressure of requests bounds them first, unless the operator allows many.
const WAITING_MAX: usize = 1024;

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
    /// Is a key wanted even while the database has none? Where others than this machine reach the server.
    pub keys_required: bool,
    /// The most that a map may hold.
    pub quotas: Quotas,
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
        Self {
            database: database.into(),
            vocabulary: None,
            models: ModelChoice::None,
            keys_required: false,
            quotas: Quotas::default(),
        }
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

/// The service; clones share everything.
#[derive(Clone, Debug)]
pub struct Service {
    store: Store,
    registry: Arc<Registry>,
    writes: Arc<Gate>,
    reads: Arc<Gate>,
    pressure: Arc<Pressure>,
    features: FeatureCache,
    vocabulary: Option<Arc<NamedVocabulary>>,
    models: Option<Arc<Models>>,
    worker: Arc<Worker>,
    keys: Keyring,
    quotas: Quotas,
    /// Ends what goes on in the background.
    closing: CancellationToken,
    backups: Option<Arc<Backups>>,
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
            keys: Keyring::open(store.clone(), options.keys_required).await?,
            quotas: options.quotas,
            closing: CancellationToken::new(),
            store,
            registry,
            writes: Gate::new(WRITES_AT_ONCE, WAITING_MAX),
            reads: Gate::new(READS_PER_CORE * cores(), WAITING_MAX),
            pressure: Arc::default(),
            features: FeatureCache::new(vocabulary.clone()),
            vocabulary,
            backups: None,
        };
        service.glance_at_keys();
        if let Some(models) = models {
            service.worker.start(service.clone(), models);
        }
        Ok(service)
    }

    /// Writes what is queued, and closes the database.
    pub async fn close(&self) {
        self.closing.cancel();
        self.worker.stop().await;
        self.store.close().await;
    }

    /// The keys of this database.
    pub fn keys(&self) -> &Keyring {
        &self.keys
    }

    /// Sees in the background what other processes do to the keys.
    fn glance_at_keys(&self) {
        let (keys, closing) = (self.keys.clone(), self.closing.clone());
        tokio::spawn(closing.run_until_cancelled_owned(async move {
            loop {
                tokio::time::sleep(keyring::GLANCE).await;
                keys.glance().await;
            }
        }));
    }

    /// Is the service open? Asks memory only: whoever wants to know must hear it under any load.
    pub fn ready(&self) -> Result<(), ServiceError> {
        if self.store.is_closed() { Err(closed()) } else { Ok(()) }
    }

    /// How much is being worked on.
    pub fn pressure(&self) -> &Arc<Pressure> {
        &self.pressure
    }

    /// The version of SQLite.
    pub async fn sqlite_version(&self) -> Result<String, ServiceError> {
        Ok(self.store.sqlite_version().await?)
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
        let permit = self.writes.enter().await?;
        self.begin_within(permit, live, decide).await
    }

    /// The same, however long it takes to get a turn.
    async fn begin_patiently<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        decide: impl FnOnce(&mut MapIndex) -> Result<Decision<T>, ServiceError> + Send + 'static,
    ) -> Result<Begun<T>, ServiceError> {
        self.disk_takes(false)?;
        let permit = self.writes.enter_patiently().await?;
        self.begin_within(permit, live, decide).await
    }

    /// [`Self::begin`] for a write that frees space.
    async fn begin_freeing<T: Send + 'static>(
        &self,
        live: &Arc<LiveMap>,
        decide: impl FnOnce(&mut MapIndex) -> Result<Decision<T>, ServiceError> + Send + 'static,
    ) -> Result<Begun<T>, ServiceError> {
        self.disk_takes(true)?;
        let permit = self.writes.enter().await?;
        self.begin_within(permit, live, decide).await
    }

    /// Refuses a write that the disk would not take, before the index is ahead of the disk.
    fn disk_takes(&self, freeing: bool) -> Result<(), ServiceError> {
        self.store.committer().refuses(freeing).map_or(Ok(()), |error| Err(error.into()))
    }

    async fn begin_within<T: Send + 'static>(
        &self,
        permit: OwnedSemaphorePermit,
        live: &Arc<LiveMap>,
        decide: impl FnOnce(&mut MapIndex) -> Result<Decision<T>, ServiceError> + Send + 'static,
    ) -> Result<Begun<T>, ServiceError> {
        // One at a time takes a thread to wait for the map's lock; the others wait here, where waiting costs nothing.
        let _lane = live.lane.lock().await;
        let (deciding, store) = (live.clone(), self.store.clone());
        let pending = spawn_blocking(in_part("decide", move || deciding.decide(&store, decide)))
            .await
            .map_err(panicked)??;
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
        let permit = self.reads.enter().await?;
        let looking = live.clone();
        let (version, value) = spawn_blocking(in_part("read", move || {
            let state = looking.state()?;
            Ok::<_, ServiceError>((state.version, look(&state)?))
        }))
        .await
        .map_err(panicked)??;
        // Waiting for the disk takes no core.
        drop(permit);
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
        self.pending.committed(&self.live).instrument(traces::part("commit")).await
    }
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

fn panicked(error: tokio::task::JoinError) -> ServiceError {
    ServiceError::Internal(format!("a decision did not finish: {error}"))
}
