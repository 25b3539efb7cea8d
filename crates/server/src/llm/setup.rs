//! The available models with their limits.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tokio::sync::Semaphore;

use super::budget::{Budget, SERVER};
use super::cache::AnswerCache;
use super::dialogue::Describer;
use super::embeddings::Embeddings;
use super::gateway::{Gateway, Shared};
use super::judge::Judge;
use super::port::{Model, Role};
use super::tesseract::Tesseract;
use crate::config::models::ModelArgs;
use crate::domain::roles::Roles;
use crate::store::{DayLimit, Fingerprints, Store, StoreError};

/// The available models.
#[derive(Debug)]
pub struct Models {
    /// The three functions, as clients ask for them.
    pub judge: Judge,
    /// The dialogue.
    pub describer: Describer,
    /// First delay before a failed job is retried.
    pub pause: Duration,
    /// Concurrent jobs.
    pub jobs_at_once: usize,
    /// Embeddings, which select the pairs for the judge's model.
    pub embeddings: Option<Embeddings>,
    gateways: Vec<Gateway>,
    shared: Arc<Shared>,
}

impl Models {
    /// Sets up these models: one for texts, one for images, one for embeddings.
    pub async fn with(
        found: [Option<Arc<dyn Model>>; 3],
        reader: Option<Tesseract>,
        args: &ModelArgs,
        store: &Store,
    ) -> Result<Self, StoreError> {
        let limits = DayLimit {
            payer: SERVER,
            microusd: args.model_daily_usd.map(|usd| (usd * 1e6) as i64),
            calls: args.model_daily_calls.map(i64::from),
        };
        let shared = Arc::new(Shared {
            args: args.clone(),
            cache: AnswerCache::new(store.clone()),
            budget: Budget::open(store.clone(), limits).await?,
            calls: Semaphore::new(usize::from(args.model_calls_at_once)),
            failures: AtomicU64::new(0),
        });
        let [model, vision, embeddings] =
            found.map(|model| model.map(|model| Gateway::new(model, shared.clone())));
        let tongue = model.clone().filter(|gateway| gateway.can(Role::Text));
        let eyes = vision.clone().or_else(|| model.clone()).filter(|gateway| gateway.can(Role::Vision));
        Ok(Self {
            judge: Judge {
                model: tongue.clone(),
                patience: Some(Duration::from_millis(args.model_client_timeout_ms)),
            },
            describer: Describer { eyes, tongue, reader },
            pause: Duration::from_millis(args.model_breaker_pause_ms),
            jobs_at_once: usize::from(args.model_calls_at_once),
            embeddings: embeddings.map(Embeddings::new),
            gateways: model.into_iter().chain(vision).collect(),
            shared,
        })
    }

    /// Returns the roles that these models fill.
    pub fn roles(&self) -> Roles {
        Roles { vision: self.describer.reads(), text: self.judge.model.is_some() }
    }

    /// Returns the fingerprints of the current models: verdicts of others may be re-evaluated.
    pub fn fingerprints(&self) -> Fingerprints {
        Fingerprints {
            crops: self.describer.fingerprint(),
            texts: self.judge.model.as_ref().map(Gateway::fingerprint),
        }
    }

    /// Has no answer be kept that was asked for before.
    pub fn note_erasure(&self) {
        self.shared.cache.note_erasure();
    }

    /// Returns the budget.
    pub fn budget(&self) -> &Budget {
        &self.shared.budget
    }

    /// Returns the number of questions that no call could answer since the start.
    pub fn failures(&self) -> u64 {
        self.shared.failures.load(Ordering::Relaxed)
    }

    /// Whether a model is unavailable or the budget spent; the built-in judge substitutes then.
    pub fn is_away(&self) -> bool {
        self.gateways.iter().any(|gateway| gateway.breaker.is_open()) || self.shared.budget.is_spent()
    }
}
