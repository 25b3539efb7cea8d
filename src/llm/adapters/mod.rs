//! The adapters: one file per protocol.

mod built_in;
mod embeddings;
mod openai;
mod scripted;
#[cfg(test)]
mod silent;
mod vqa;
mod wire;

pub use built_in::BuiltIn;
pub use embeddings::Embeddings;
pub use openai::{Dialect, OpenAi};
pub use scripted::Scripted;
#[cfg(test)]
pub use silent::Silent;
pub use vqa::Vqa;
pub use wire::{Endpoint, EndpointError};
