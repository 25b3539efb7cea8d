//! Revisit: semantic place recognition. "Is this keyframe a loop?"
//!
//! ARCHITECTURE.md beside the sources draws the house; [`recognition`] is the paper.

pub mod cli;
pub mod client;
pub mod config;
pub mod geometry;
pub mod hotel;
pub mod http;
pub mod model;
pub mod models;
pub mod recognition;
pub mod semantics;
pub mod service;
pub mod store;
pub mod vocabulary;
pub mod wire;
