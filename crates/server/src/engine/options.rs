//! How the service is opened.

use std::path::PathBuf;
use std::time::Duration;

use crate::config::memory::MemoryArgs;
#[cfg(feature = "llm")]
use crate::config::models::ModelArgs;
use crate::config::quotas::Quotas;
use crate::domain::ids::KeyframeId;
use crate::domain::verdict::Verdict;

/// The time between two looks for what settings let go of, unless an operator says otherwise.
pub const RETENTION_EVERY: Duration = Duration::from_mins(10);

/// Writes the answer of a loop query, by its id, keyframe and verdict, as clients receive it. This is the engine's port to
/// the shapes of the API: it records the very bytes, and does not know the shapes.
pub type WriteAnswer = fn(&str, Option<&KeyframeId>, &Verdict) -> Result<Vec<u8>, serde_json::Error>;

/// How to open the service.
#[derive(Clone, Debug)]
pub struct ServiceOptions {
    /// `sqlite://PATH`.
    pub database: String,
    /// A vocabulary to compute words with, and to guide the matching of descriptors.
    pub vocabulary: Option<PathBuf>,
    /// The models to ask.
    pub models: ModelChoice,
    /// Whether a key is wanted even while the database has none. Where others than this machine reach the server.
    pub keys_required: bool,
    /// The most that a map may hold.
    pub quotas: Quotas,
    /// What the maps in memory may take together, in bytes; idle ones leave when it is exceeded.
    pub map_memory: u64,
    /// The time between two looks for what settings let go of.
    pub retention_every: Duration,
    /// Writes the answers of loop queries.
    pub write_answer: WriteAnswer,
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
}

impl ServiceOptions {
    /// Returns the options of a service on this database, without a vocabulary.
    pub fn on(database: impl Into<String>, write_answer: WriteAnswer) -> Self {
        Self {
            database: database.into(),
            vocabulary: None,
            models: ModelChoice::None,
            keys_required: false,
            quotas: Quotas::default(),
            map_memory: MemoryArgs::default().map_memory_bytes(),
            retention_every: RETENTION_EVERY,
            write_answer,
        }
    }

    /// Returns the options of a service that writes of an answer its id, and what a list shows of it.
    #[cfg(test)]
    pub(super) fn for_tests(database: impl Into<String>) -> Self {
        Self::on(database, |id, _, verdict| {
            let (decision, why) = (verdict.decision.as_str(), &verdict.why);
            serde_json::to_vec(&serde_json::json!({
                "id": id, "map_version": verdict.map_version, "verdict": decision, "why": why, "candidates": []
            }))
        })
    }
}
