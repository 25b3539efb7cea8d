//! Revisit: semantic place recognition. "Is this keyframe a loop?"
//!
//! ARCHITECTURE.md beside the sources draws the house; [`recognition`] is the paper, and stands with all that it needs in
//! the crate `revisit_core`.

pub mod cli;
pub mod client;
pub mod config;
#[cfg(feature = "hotel")]
pub mod hotel;
pub mod http;
pub mod models;
pub mod service;
pub mod store;
pub mod wire;

pub use revisit_core::{geometry, model, recognition, semantics, vocabulary};
