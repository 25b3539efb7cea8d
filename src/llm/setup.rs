//! The available models with their limits.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tokio::sync::Semaphore;

use super::breaker::Breaker;
use super::budget::Budget;
use super::cache::AnswerCache;
use super::daily_limits::{Limits, Prices};
use super::dialogue::Describer;
use super::embeddings::Embeddings;
use super::gateway::{Gateway, Policy, RolePrices, Shared};
use super::judge::Judge;
use super::port::{Model, Question};
use super::tesseract::Tesseract;
use crate::config::models::ModelArgs;
use crate::domain::roles::Roles;
use crate::store::{Fingerprints, Store, StoreError};

/// The available models.
#[derive(Debug)]
pub struct Models {
    /// The three functions.
    pub judge: Judge,
    /// The dialogue.
    pub describer: Describer,
    /// Maximum time that a client's question about texts waits for a model.
    pub patience: Duration,
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
    /// Sets up these models, the second of them for images.
    pub async fn with(
        found: [Option<Arc<dyn Model>>; 2],
        reader: Option<Tesseract>,
        args: &ModelArgs,
        store: &Store,
    ) -> Result<Self, StoreError> {
        Self::all(found, None, reader, args, store).await
    }

    /// Sets up these models, with an embeddings model.
    pub(super) async fn all(
        [model, vision]: [Option<Arc<dyn Model>>; 2],
        embeddings: Option<Arc<dyn Model>>,
        reader: Option<Tesseract>,
        args: &ModelArgs,
        store: &Store,
    ) -> Result<Self, StoreError> {
        let milliseconds = Duration::from_millis;
        let text = Prices { input_usd: args.model_input_usd, output_usd: args.model_output_usd };
        let vision_prices = Prices {
            input_usd: args.model_vision_input_usd.unwrap_or(text.input_usd),
            output_usd: args.model_vision_output_usd.unwrap_or(text.output_usd),
        };
        let of_embeddings = Prices { input_usd: args.model_embeddings_usd, output_usd: 0.0 };
        let prices = RolePrices { text, vision: vision_prices, embeddings: of_embeddings };
        let limits = Limits {
            microusd: args.model_daily_usd.map(|usd| (usd * 1e6) as i64),
            calls: args.model_daily_calls.map(i64::from),
        };
        let shared = Arc::new(Shared {
            cache: AnswerCache::new(store.clone()),
            budget: Budget::open(store.clone(), limits).await?,
            calls: Semaphore::new(usize::from(args.model_calls_at_once)),
            failures: AtomicU64::new(0),
        });
        let policy = Policy {
            text_timeout: milliseconds(args.model_text_timeout_ms),
            vision_timeout: milliseconds(args.model_vision_timeout_ms),
            retries: usize::from(args.model_retries),
            retry_delay: milliseconds(args.model_retry_delay_ms),
            max_tokens: args.model_max_tokens,
            prices,
        };
        let pause = milliseconds(args.model_breaker_pause_ms);
        let gateway = |model: Arc<dyn Model>| {
            Gateway::new(model, Breaker::new(args.model_breaker_failures, pause), policy, shared.clone())
        };
        let embeddings = embeddings.map(gateway).map(Embeddings::new);
        let [model, vision] = [model.map(gateway), vision.map(gateway)];
        let talks = Question::Information { class: String::new(), text: String::new() };
        let tongue = model.clone().filter(|gateway| gateway.can(&talks));
        let eyes = vision.clone().or_else(|| model.clone()).filter(Gateway::sees);
        Ok(Self {
            judge: Judge::new(tongue.clone()),
            describer: Describer { eyes, tongue, reader },
            patience: milliseconds(args.model_client_timeout_ms),
            pause,
            jobs_at_once: usize::from(args.model_calls_at_once),
            embeddings,
            gateways: model.into_iter().chain(vision).collect(),
            shared,
        })
    }

    /// Returns the roles that these models fill.
    pub fn roles(&self) -> Roles {
        Roles { vision: self.describer.reads(), text: self.judge.has_model() }
    }

    /// Returns the fingerprints of the current models: verdicts of others may be re-evaluated.
    pub fn fingerprints(&self) -> Fingerprints {
        Fingerprints {
            crops: self.describer.fingerprint(),
            texts: self.judge.model().map(Gateway::fingerprint),
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
        self.gateways.iter().any(|gateway| gateway.breaker().is_open()) || self.shared.budget.is_spent()
    }
}
