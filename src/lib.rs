//! Revisit: semantic place recognition. "Is this keyframe a loop?"
//!
//! ARCHITECTURE.md beside the sources draws the house; [`recognition`] is the paper, and stands with all that it needs in
//! the crate `revisit_core`.

#[cfg(feature = "hotel")]
pub mod buildings;
pub mod cli;
pub mod config;
pub mod engine;
#[cfg(feature = "hotel")]
pub mod hotel;
pub mod http;
pub mod integrity;
pub mod llm;
pub mod store;

pub use revisit_api as api;
pub use revisit_client as client;
pub use revisit_core::{domain, geometry, named, recognition, semantics, vocabulary};
