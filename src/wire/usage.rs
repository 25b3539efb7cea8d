//! Usage: what language models were asked and what it cost.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Calls of language models since the server started, by operation and model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Usage {
    /// Calls.
    pub calls: u64,
    /// Tokens sent.
    pub input_tokens: u64,
    /// Tokens received.
    pub output_tokens: u64,
    /// Cost in US dollars.
    pub cost_usd: f64,
    /// Questions answered from the cache.
    pub cache_hits: u64,
    /// The same by operation and model.
    pub items: Vec<UsageItem>,
    /// One sentence for a person.
    pub detail: String,
}

/// Calls of one model for one operation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UsageItem {
    /// `similarity`, `information`, `merge` or `describe`.
    pub operation: String,
    /// The model's name.
    pub model: String,
    /// Calls.
    pub calls: u64,
    /// Tokens sent.
    pub input_tokens: u64,
    /// Tokens received.
    pub output_tokens: u64,
    /// Cost in US dollars.
    pub cost_usd: f64,
    /// Questions answered from the cache.
    pub cache_hits: u64,
}

impl Usage {
    /// The usage of a server that has no model to call.
    pub fn without_models() -> Self {
        let detail = "no language model is configured: the built-in judge answers everything, free of charge";
        Self { detail: detail.to_owned(), ..Self::default() }
    }
}
