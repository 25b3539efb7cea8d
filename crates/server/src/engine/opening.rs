//! Opening and closing the engine.

use std::sync::Arc;

use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;

use super::cluster::followers::Followers;
use super::descriptions::judgement_runner::JudgementRunner;
use super::descriptions::round::Round;
use super::error::Result;
use super::keys::keyring::{Keyring, POLL_INTERVAL};
use super::limits::bounds::{EXPORTS_AT_ONCE, TURNS_PER_CORE, WAITING_MAX, WRITES_AT_ONCE};
use super::limits::concurrency_limit::ConcurrencyLimit;
use super::limits::quota::KeyBytes;
use super::limits::shared_turns::SharedTurns;
use super::maps::features::FeatureCache;
use super::maps::registry::Registry;
use super::named_vocabulary::NamedVocabulary;
use super::options::{ModelChoice, ServiceOptions};
use super::service::{Parts, Service};
use crate::config::limits::cores;
use crate::llm::Models;
use crate::store::{Job, Store};

/// Answers of followers that are on their way at once; a connection each.
const HANDED_ON_AT_ONCE: usize = 4;

impl Service {
    /// Opens the database, and starts background tasks. Maps are loaded on first use.
    pub async fn open(options: ServiceOptions) -> Result<Self> {
        let vocabulary = match options.vocabulary {
            Some(path) => Some(Arc::new(NamedVocabulary::load(path).await?)),
            None => None,
        };
        let store = Store::open(&options.database).await?;
        let models = open_models(options.models, &store).await?.map(Arc::new);
        let followers = Arc::new(Followers::new(options.map_memory));
        let registry = Arc::new(Registry::new(options.map_memory, Some(followers.registry.clone())));
        let service = Self(Arc::new(Parts {
            models: models.clone(),
            worker: Arc::default(),
            rejudging: Arc::default(),
            starting: Arc::default(),
            triggers: Arc::default(),
            verdicts: Arc::default(),
            write_answer: options.write_answer,
            keys: Keyring::open(store.clone(), options.keys_required).await?,
            quotas: options.quotas,
            key_bytes: KeyBytes::default(),
            exports: Arc::new(SharedTurns::new(EXPORTS_AT_ONCE, WAITING_MAX)),
            erasing: Arc::default(),
            copying: Arc::default(),
            asking: Arc::default(),
            closing: CancellationToken::new(),
            store,
            writes: ConcurrencyLimit::new(WRITES_AT_ONCE, WAITING_MAX),
            reads: Arc::new(SharedTurns::new(TURNS_PER_CORE * cores(), WAITING_MAX)),
            deciding: Arc::new(SharedTurns::new(TURNS_PER_CORE * cores(), WAITING_MAX)),
            pressure: Arc::default(),
            features: FeatureCache::new(vocabulary.clone()),
            vocabulary,
            backups: None,
            membership: Arc::default(),
            followers,
            follows: false,
            owned: registry.clone(),
            registry,
            handing_on: Arc::new(Semaphore::new(HANDED_ON_AT_ONCE)),
        }));
        service.poll_key_changes();
        service.start_triggers();
        service.erase_in_background();
        service.start_retention(options.retention_every);
        if let Some(models) = models {
            service.worker.background.start(Round::new(service.clone(), models.clone()).run());
            service.rejudging.start(JudgementRunner::new(service.clone(), models).run());
        }
        Ok(service)
    }

    /// Stops background tasks, writes what is queued, and closes the database.
    pub async fn close(&self) {
        self.closing.cancel();
        tokio::join!(self.worker.background.stop(), self.rejudging.stop());
        self.leave().await;
        self.store.close().await;
    }

    /// Reads in the background what other processes change in the keys.
    fn poll_key_changes(&self) {
        let (keys, closing) = (self.keys.clone(), self.closing.clone());
        tokio::spawn(closing.run_until_cancelled_owned(async move {
            loop {
                tokio::time::sleep(POLL_INTERVAL).await;
                keys.poll_changes().await;
                keys.share_rates().await;
            }
        }));
    }
}

/// Opens the configured models. Without models no map waits for one, whatever an earlier process noted.
async fn open_models(choice: ModelChoice, store: &Store) -> Result<Option<Models>> {
    let models = match choice {
        ModelChoice::None => None,
        #[cfg(feature = "llm")]
        ModelChoice::Configured(args) => {
            let opened = Models::open(&args, store).await;
            opened.map_err(|error| super::ServiceError::Internal(error.to_string()))?
        }
    };
    // Among others no server may change maps that are not its own.
    if models.is_none() && store.leases().is_none() {
        store.committer().commit(Job::ForgetAway).await?;
    }
    Ok(models)
}
