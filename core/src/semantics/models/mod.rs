//! What a model may be asked about texts, and what binds it.

pub mod embedding;
pub mod judge_routing;
pub mod prompt_injection;
