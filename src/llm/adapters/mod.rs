//! The adapters: one file per protocol.

mod built_in;
mod embeddings;
mod openai;
mod scripted;
mod vqa;
mod wire;

pub use built_in::BuiltIn;
pub use embeddings::Embeddings;
pub use openai::{Dialect, OpenAi};
pub use scripted::Scripted;
pub use vqa::Vqa;
pub use wire::{Endpoint, EndpointError};
