//! Models: the one port to language and vision models, its adapters, and all that keeps them affordable and harmless.
//!
//! | concept | file |
//! |---|---|
//! | the port: a question, an answer, what can go wrong | [`port`] |
//! | the adapters: chat, embeddings, VQA, scripted, built-in | [`adapters`] |
//! | what is asked, word by word | [`prompts`] |
//! | what an answer must look like | [`parse`] |
//! | an image as it is sent | [`picture`] |
//! | decoding an image | `imaging` |
//! | asking: cache, budget, breaker, retries, in this order | [`gateway`] |
//! | answers that were paid for | [`cache`] |
//! | the daily budget and the usage | [`budget`] |
//! | what asking again may cost | [`estimate`] |
//! | a model that is away is left alone | [`breaker`] |
//! | InformationLevel, SimilarityLevel, MergeText of §IV-A.2 | [`judge`] |
//! | embeddings, by which pairs of texts are chosen | [`embeddings`] |
//! | the dialogue of §IV-A.1 | [`dialogue`] |
//! | a reader of characters on this machine | [`tesseract`] |
//! | all of it | [`setup`] |
//! | the same as the operator configured it | `configured` |

// The port and what asks through it are always there. The feature holds what reaches out: adapters and decoders.
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
pub mod tesseract;

#[cfg(feature = "llm")]
pub use configured::SetupError;
pub use setup::Models;
