//! Questions about texts for a model, and the limits on its answers.

pub mod embedding;
pub mod judge_routing;
pub mod prompt_injection;
