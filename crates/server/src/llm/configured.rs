//! Configured models: turns the operator's flags into adapters.

use std::sync::Arc;
use std::time::Duration;

use secrecy::SecretString;
use thiserror::Error;

use super::adapters::{Dialect, Endpoint, EndpointError, Protocol, Remote, Scripted};
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

/// The server of a model, as configured.
struct Server<'a> {
    flag: &'static str,
    url: &'a Option<String>,
    name: &'a Option<String>,
    key: Option<SecretString>,
}

impl Models {
    /// Returns the configured models; `None` if there are none.
    pub async fn open(args: &ModelArgs, store: &Store) -> Result<Option<Self>, SetupError> {
        if !args.any() {
            return Ok(None);
        }
        let model = Server {
            flag: "--model-url",
            url: &args.model_url,
            name: &args.model_name,
            key: args.model_key().map_err(SetupError::Key)?,
        };
        let vision = Server {
            flag: "--model-vision-url",
            url: &args.model_vision_url,
            name: &args.model_vision_name,
            key: args.model_vision_key().map_err(SetupError::Key)?,
        };
        let model = model.of_kind(args.model_kind, args)?;
        let vision = vision.of_kind(args.model_vision_kind, args)?;
        let embeddings = Server {
            flag: "--model-embeddings-url",
            url: &args.model_embeddings_url,
            name: &args.model_embeddings_name,
            key: match args.model_embeddings_url {
                Some(_) => args.model_embeddings_key().map_err(SetupError::Key)?,
                None => None,
            },
        };
        let found = [model, vision, embeddings.speaking(Protocol::Embeddings, args)?];
        let reader = match args.reader {
            Reader::None => None,
            Reader::Tesseract => Some(Tesseract::find().await?),
        };
        let models = Self::with(found, reader, args, store).await?;
        let is_alone = models.embeddings.is_some() && models.judge.model.is_none();
        if is_alone { Err(SetupError::EmbeddingsAlone) } else { Ok(Some(models)) }
    }
}

impl Server<'_> {
    fn of_kind(self, kind: Kind, args: &ModelArgs) -> Result<Option<Arc<dyn Model>>, SetupError> {
        match kind {
            Kind::Openai => self.speaking(Protocol::Chat(Dialect::from(args)), args),
            Kind::Vqa => self.speaking(Protocol::Vqa, args),
            Kind::Scripted => Ok(Some(Arc::new(Scripted::rehearsal()))),
        }
    }

    /// Returns the model, if there is an address.
    fn speaking(self, protocol: Protocol, args: &ModelArgs) -> Result<Option<Arc<dyn Model>>, SetupError> {
        let Some(url) = self.url else { return Ok(None) };
        let connect_timeout = Duration::from_millis(args.model_connect_timeout_ms);
        let endpoint = Endpoint::new(url, protocol.path(), self.key, connect_timeout)?;
        let unnamed = (protocol == Protocol::Vqa).then_some("vqa");
        let name = self.name.as_deref().or(unnamed).ok_or(SetupError::NoName(self.flag))?;
        Ok(Some(Arc::new(Remote::new(endpoint, name, protocol))))
    }
}
