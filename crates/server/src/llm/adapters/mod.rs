//! The adapters: models behind HTTP, and one that follows a script.

mod chat;
mod remote;
mod scripted;
mod wire;

pub use chat::Dialect;
pub use remote::{Protocol, Remote};
pub use scripted::Scripted;
pub use wire::{Endpoint, EndpointError};
