//! Models: the port to language and vision models, its adapters, and the limits on their cost and influence.
//!
//! | concept | file |
//! |---|---|
//! | the port: question, answer, errors | [`port`] |
//! | the adapters: chat, embeddings, VQA, scripted | [`adapters`] |
//! | the prompts | [`prompts`] |
//! | validation of answers | [`parse`] |
//! | an image as it is sent | [`picture`] |
//! | decoding an image | `imaging` |
//! | calls: cache, budget, breaker, retries, in this order | [`gateway`] |
//! | cached answers | [`cache`] |
//! | the daily budget and the usage | [`budget`] |
//! | cost estimate of a re-evaluation | [`estimate`] |
//! | the circuit breaker of an unavailable model | [`breaker`] |
//! | InformationLevel, SimilarityLevel, MergeText of §IV-A.2 | [`judge`] |
//! | embeddings, which select pairs of texts | [`embeddings`] |
//! | the dialogue of §IV-A.1 | [`dialogue`] |
//! | the local text reader (OCR) | [`tesseract`] |
//! | all models with their limits | [`setup`] |
//! | models from the operator's flags | `configured` |

// The port and its callers are always compiled. The feature contains the adapters and decoders, which reach outside.
#[cfg(feature = "llm")]
pub mod adapters;
pub mod breaker;
pub mod budget;
pub mod cache;
#[cfg(feature = "llm")]
mod configured;
pub mod dialogue;
pub mod embeddings;
mod estimate;
pub mod gateway;
#[cfg_attr(not(feature = "llm"), path = "no_imaging.rs")]
mod imaging;
pub mod judge;
pub mod parse;
pub mod picture;
pub mod port;
pub mod prompts;
pub mod setup;
#[cfg(test)]
pub mod silent;
pub mod tesseract;

#[cfg(feature = "llm")]
pub use configured::SetupError;
pub use setup::Models;
