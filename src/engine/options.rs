//! How the service is opened.

use std::path::PathBuf;
use std::sync::Arc;

use crate::config::memory::MemoryArgs;
use crate::config::models::ModelArgs;
use crate::config::quotas::Quotas;
use crate::llm::port::Model;

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
    /// What the maps in memory may take together, in bytes; idle ones leave when it is exceeded.
    pub map_memory: u64,
}

/// The models to ask.
#[derive(Clone, Debug, Default)]
pub enum ModelChoice {
    /// None: the built-in judge answers everything.
    #[default]
    None,
    /// Those that the operator names.
    #[cfg(feature = "llm")]
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
            map_memory: MemoryArgs::default().map_memory_bytes(),
        }
    }
}
