//! The handle of the engine: every use case is one of its methods.

use std::collections::BTreeMap;
use std::ops::Deref;
use std::sync::{Arc, Mutex, OnceLock};

use tokio::sync::Semaphore;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

use super::backups::folder::BackupFolder;
use super::cluster::followers::Followers;
use super::cluster::membership::Membership;
use super::descriptions::worker::{Background, Worker};
use super::error::{Result, ServiceError};
use super::keys::keyring::Keyring;
use super::limits::concurrency_limit::ConcurrencyLimit;
use super::limits::load_shedding::LoadShedding;
use super::limits::quota::KeyBytes;
use super::limits::shared_turns::SharedTurns;
use super::limits::trigger_queue::TriggerQueue;
use super::maps::features::FeatureCache;
use super::maps::live::LiveMap;
use super::maps::loads::Used;
use super::maps::registry::Registry;
use super::named_vocabulary::NamedVocabulary;
use super::options::WriteAnswer;
use crate::config::quotas::Quotas;
use crate::domain::ids::MapId;
use crate::domain::verdict::Decision;
use crate::llm::Models;
use crate::store::{Disk, MapKey, Store};

/// The engine behind the API. Clones share everything, and every request makes some.
#[derive(Clone, Debug)]
pub struct Service(pub(super) Arc<Parts>);

/// State that the clones of a [`Service`] share.
#[derive(Clone, Debug)]
pub struct Parts {
    pub(super) store: Store,
    pub(super) registry: Arc<Registry>,
    pub(super) writes: Arc<ConcurrencyLimit>,
    pub(super) reads: Arc<SharedTurns>,
    pub(super) deciding: Arc<SharedTurns>,
    pub(super) pressure: Arc<LoadShedding>,
    pub(super) features: FeatureCache,
    pub(super) vocabulary: Option<Arc<NamedVocabulary>>,
    pub(super) models: Option<Arc<Models>>,
    pub(super) worker: Arc<Worker>,
    /// Jobs that ask models again.
    pub(super) rejudging: Arc<Background>,
    /// Held while such a job is started, so that one job of a map runs at a time.
    pub(super) starting: Arc<tokio::sync::Mutex<()>>,
    pub(super) triggers: Arc<TriggerQueue>,
    /// Loop queries answered since the start, by verdict.
    pub(super) verdicts: Arc<Mutex<BTreeMap<Decision, u64>>>,
    pub(super) write_answer: WriteAnswer,
    pub(super) keys: Keyring,
    pub(super) quotas: Quotas,
    pub(super) key_bytes: KeyBytes,
    pub(super) exports: Arc<SharedTurns>,
    /// Held by the one that works on erasures: when the database's file may be written anew.
    pub(super) erasing: Arc<tokio::sync::Mutex<Option<Instant>>>,
    /// Held for reading while a map is copied, and for writing while keyframes are erased: none is erased between the snapshot of
    /// a copy and its name.
    pub(super) copying: Arc<tokio::sync::RwLock<()>>,
    /// Held while an erasure is given its number.
    pub(super) asking: Arc<tokio::sync::Mutex<()>>,
    /// Ends background tasks.
    pub(super) closing: CancellationToken,
    pub(super) backups: Option<Arc<BackupFolder>>,
    /// Set once the server has joined those that share its database.
    pub(super) membership: Arc<OnceLock<Arc<Membership>>>,
    /// Copies of maps that other servers own.
    pub(super) followers: Arc<Followers>,
    /// Whether its maps are those copies: it writes nothing.
    pub(super) follows: bool,
    /// The maps that this server has itself; `registry` unless that holds copies.
    pub(super) owned: Arc<Registry>,
    /// Bounds the answers that are on their way to the owners of their maps.
    pub(super) handing_on: Arc<Semaphore>,
}

impl Deref for Service {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        &self.0
    }
}

impl Service {
    /// Returns the keys of this database.
    pub fn keys(&self) -> &Keyring {
        &self.keys
    }

    /// Fails if the service is closed. It asks memory only, so that it answers under any load.
    pub fn ready(&self) -> Result<()> {
        if self.store.is_closed() { Err(ServiceError::closed()) } else { Ok(()) }
    }

    /// Returns the state of the disk, as far as writes told.
    pub fn disk(&self) -> Disk {
        self.store.committer().disk()
    }

    /// Returns the limit on requests in flight.
    pub fn pressure(&self) -> &Arc<LoadShedding> {
        &self.pressure
    }

    /// Returns the version of PostgreSQL, where that keeps the facts.
    pub async fn postgres_version(&self) -> Result<Option<String>> {
        Ok(self.store.postgres_version().await?)
    }

    /// Returns a map for a client, loaded if it was not in memory.
    pub(super) async fn live(&self, id: &MapId) -> Result<Arc<LiveMap>> {
        let was_in_memory = self.registry.in_memory_now(id).is_some();
        self.should_have(id, was_in_memory).await?;
        let live = self.registry.get(&self.store, id, Used::ByClient).await?;
        if !was_in_memory {
            // Its anchors may lack what a model that was configured since could give.
            self.worker.background.wake();
            if self.store.is_shared() {
                // What another server forgot of it while it was not here.
                self.features.forget_map(live.key).await;
            }
            self.wait_for_no_model(&live).await;
        }
        Ok(live)
    }

    /// Returns the key of the map that has this name now; the map need not be in memory.
    pub(super) async fn key_of(&self, id: &MapId) -> Result<MapKey> {
        if let Some(live) = self.registry.in_memory_now(id) {
            return Ok(live.key);
        }
        self.store.map_key(id).await?.ok_or_else(|| ServiceError::no_map(id))
    }

    /// Returns a map for background work: it does not count as used.
    pub(super) async fn live_in_background(&self, id: &MapId) -> Result<Arc<LiveMap>> {
        self.should_have(id, self.registry.in_memory_now(id).is_some()).await?;
        self.registry.get(&self.store, id, Used::InBackground).await
    }

    /// Fails for a map that is not in memory where another server should have it.
    pub(in crate::engine) async fn should_have(&self, id: &MapId, is_in_memory: bool) -> Result<()> {
        let Some(membership) = self.membership.get().filter(|_| !self.follows && !is_in_memory) else {
            return Ok(());
        };
        if membership.should_have(id) {
            return Ok(());
        }
        // Another server may know already that the one that should have had it is gone.
        membership.read_list(&self.store).await;
        if membership.should_have(id) {
            return Ok(());
        }
        Err(ServiceError::unavailable("another server should have this map; ask it, or try again"))
    }
}
