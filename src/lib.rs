//! Revisit: semantic place recognition. "Is this keyframe a loop?"
//!
//! The program, and under one name what it is made of: ARCHITECTURE.md beside the sources draws the house; [`recognition`] is the paper,
//! and stands with all that it needs in the crate `revisit_core`.

pub mod cli;

pub use revisit_api as api;
pub use revisit_client as client;
pub use revisit_core::{domain, geometry, named, recognition, semantics, vocabulary};
pub use revisit_server::{config, engine, http, integrity, llm};
#[cfg(feature = "hotel")]
pub use revisit_sim::{buildings, hotel};
pub use revisit_store as store;
