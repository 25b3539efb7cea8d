//! Everything about models, as the operator configured it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use secrecy::SecretString;
use thiserror::Error;
use tokio::sync::Semaphore;

use super::adapters::{self, Dialect, Endpoint, EndpointError, OpenAi, Scripted, Vqa};
use super::breaker::Breaker;
use super::budget::{Budget, Limits, Prices};
use super::cache::AnswerCache;
use super::dialogue::Describer;
use super::embeddings::Embeddings;
use super::gateway::{Gateway, Policy, RolePrices, Shared};
use super::judge::Judge;
use super::port::{Model, Question};
use super::tesseract::{ReaderError, Tesseract};
use crate::config::models::{Kind, ModelArgs, Reader};
use crate::model::roles::Roles;
use crate::store::{Fingerprints, Store, StoreError};

/// Why models cannot be used as configured.
#[derive(Debug, Error)]
pub enum SetupError {
    /// An address.
    #[error(transparent)]
    Endpoint(#[from] EndpointError),
    /// A key.
    #[error("{0}")]
    Key(String),
    /// A model without a name.
    #[error("{0} needs a name: what does its server call it?")]
    NoName(&'static str),
    /// Embeddings without a model that they could choose for.
    #[error(
        "--model-embeddings-url chooses the pairs of texts that a language model is asked about: it needs --model-url"
    )]
    EmbeddingsAlone,
    /// The reader.
    #[error("--reader tesseract: {0}")]
    Reader(#[from] ReaderError),
    /// The books could not be read.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// The models at hand.
#[derive(Debug)]
pub struct Models {
    /// The three functions.
    pub judge: Judge,
    /// The dialogue.
    pub describer: Describer,
    /// Longest time a client that asks about texts waits for a model.
    pub patience: Duration,
    /// How long a job that failed is left alone, at first.
    pub pause: Duration,
    /// Jobs at once.
    pub jobs_at_once: usize,
    /// Embeddings, by which the pairs that the judge's model is asked about are chosen.
    pub embeddings: Option<Embeddings>,
    gateways: Vec<Gateway>,
    shared: Arc<Shared>,
}

/// One model with its key, as configured.
struct Chosen<'a> {
    what: &'static str,
    kind: Kind,
    url: Option<&'a str>,
    name: Option<&'a str>,
    key: Option<SecretString>,
}

impl Models {
    /// The models that are configured; `None` if there are none.
    pub async fn open(args: &ModelArgs, store: &Store) -> Result<Option<Self>, SetupError> {
        if !args.any() {
            return Ok(None);
        }
        let model = Chosen {
            what: "--model-url",
            kind: args.model_kind,
            url: args.model_url.as_deref(),
            name: args.model_name.as_deref(),
            key: args.model_key().map_err(SetupError::Key)?,
        };
        let vision = Chosen {
            what: "--model-vision-url",
            kind: args.model_vision_kind,
            url: args.model_vision_url.as_deref(),
            name: args.model_vision_name.as_deref(),
            key: args.model_vision_key().map_err(SetupError::Key)?,
        };
        let found = [adapter(model, args)?, adapter(vision, args)?];
        let embeddings = embeddings(args)?;
        let reader = match args.reader {
            Reader::None => None,
            Reader::Tesseract => Some(Tesseract::find().await?),
        };
        let models = Self::all(found, embeddings, reader, args, store).await?;
        let is_alone = models.embeddings.is_some() && !models.judge.has_model();
        if is_alone { Err(SetupError::EmbeddingsAlone) } else { Ok(Some(models)) }
    }

    /// These models, the second of them for images: what [`Self::open`] makes of a configuration, and tests of a script.
    pub async fn with(
        found: [Option<Arc<dyn Model>>; 2],
        reader: Option<Tesseract>,
        args: &ModelArgs,
        store: &Store,
    ) -> Result<Self, SetupError> {
        Self::all(found, None, reader, args, store).await
    }

    async fn all(
        [model, vision]: [Option<Arc<dyn Model>>; 2],
        embeddings: Option<Arc<dyn Model>>,
        reader: Option<Tesseract>,
        args: &ModelArgs,
        store: &Store,
    ) -> Result<Self, SetupError> {
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

    /// The roles that these models fill.
    pub fn roles(&self) -> Roles {
        Roles { vision: self.describer.reads(), text: self.judge.has_model() }
    }

    /// Returns the fingerprints of those who answer: what others answered may be asked again.
    pub fn fingerprints(&self) -> Fingerprints {
        Fingerprints {
            crops: self.describer.fingerprint(),
            texts: self.judge.model().map(Gateway::fingerprint),
        }
    }

    /// The books.
    pub fn budget(&self) -> &Budget {
        &self.shared.budget
    }

    /// Questions that no call could answer, since the start.
    pub fn failures(&self) -> u64 {
        self.shared.failures.load(Ordering::Relaxed)
    }

    /// Is a model away, or the budget spent? Then built-in verdicts stand in.
    pub fn is_away(&self) -> bool {
        self.gateways.iter().any(|gateway| gateway.breaker().is_open()) || self.shared.budget.is_spent()
    }
}

fn embeddings(args: &ModelArgs) -> Result<Option<Arc<dyn Model>>, SetupError> {
    let Some(url) = &args.model_embeddings_url else { return Ok(None) };
    let key = args.model_embeddings_key().map_err(SetupError::Key)?;
    let connect_timeout = Duration::from_millis(args.model_connect_timeout_ms);
    let endpoint = Endpoint::new(url, "embeddings", key, connect_timeout)?;
    let name = args.model_embeddings_name.as_deref().ok_or(SetupError::NoName("--model-embeddings-url"))?;
    Ok(Some(Arc::new(adapters::Embeddings::new(endpoint, name))))
}

fn adapter(chosen: Chosen<'_>, args: &ModelArgs) -> Result<Option<Arc<dyn Model>>, SetupError> {
    if chosen.kind == Kind::Scripted {
        return Ok(Some(Arc::new(Scripted::rehearsal())));
    }
    let Some(url) = chosen.url else { return Ok(None) };
    let connect_timeout = Duration::from_millis(args.model_connect_timeout_ms);
    if chosen.kind == Kind::Vqa {
        let endpoint = Endpoint::new(url, "", chosen.key, connect_timeout)?;
        return Ok(Some(Arc::new(Vqa::new(endpoint, chosen.name.unwrap_or("vqa")))));
    }
    let endpoint = Endpoint::new(url, "chat/completions", chosen.key, connect_timeout)?;
    let dialect = Dialect {
        token_parameter: args.model_token_parameter,
        max_tokens: args.model_max_tokens,
        temperature: args.model_temperature.0,
        seed: args.model_seed,
        response_format: args.model_response_format,
        system_role: args.model_system_role,
        image_form: args.model_image_form,
    };
    let name = chosen.name.ok_or(SetupError::NoName(chosen.what))?;
    Ok(Some(Arc::new(OpenAi::new(endpoint, name, dialect))))
}
