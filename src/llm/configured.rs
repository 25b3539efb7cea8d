//! Configured models: turns the operator's flags into adapters.

use std::sync::Arc;
use std::time::Duration;

use secrecy::SecretString;
use thiserror::Error;

use super::adapters::{self, Dialect, Endpoint, EndpointError, OpenAi, Scripted, Vqa};
use super::port::Model;
use super::setup::Models;
use super::tesseract::{ReaderError, Tesseract};
use crate::config::models::{Kind, ModelArgs, Reader};
use crate::store::{Store, StoreError};

/// The reason why models cannot be used as configured.
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
    /// Embeddings without a model whose pairs they could select.
    #[error(
        "--model-embeddings-url chooses the pairs of texts that a language model is asked about: it needs --model-url"
    )]
    EmbeddingsAlone,
    /// The reader.
    #[error("--reader tesseract: {0}")]
    Reader(#[from] ReaderError),
    /// The budget's records could not be read.
    #[error(transparent)]
    Store(#[from] StoreError),
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
    /// Returns the configured models; `None` if there are none.
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
    let name = chosen.name.ok_or(SetupError::NoName(chosen.what))?;
    Ok(Some(Arc::new(OpenAi::new(endpoint, name, Dialect::from(args)))))
}
