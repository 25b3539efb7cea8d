//! The one integration binary: everything here speaks to a real server over HTTP, or reads what is committed.

// A test that cannot go on has failed; unwrap says where.
#![allow(clippy::unwrap_used)]

mod bad_input;
mod bounds;
#[cfg(feature = "hotel")]
mod buildings;
mod closing;
mod cluster;
mod codes;
mod crash;
mod documents;
mod erasures;
mod events;
mod eviction;
mod exports;
mod first_data;
mod followers;
mod frames;
mod geometry;
mod globals;
#[cfg(feature = "hotel")]
mod hotel;
mod limits;
mod lives;
mod locate;
mod locate_unloaded;
mod method;
#[cfg(feature = "llm")]
mod models;
mod observations;
mod openapi;
mod operations;
mod paper;
mod paths;
mod plans;
mod races;
mod raw;
mod readme;
mod recordings;
mod releases;
mod replayed;
mod retention;
mod session_merges;
mod settings;
mod support;
mod tidy;
mod trajectories;
mod transfers;
mod trust;
mod try_it;
mod two_laps;
mod untaken;
#[cfg(feature = "hotel")]
mod verdict_list;
#[cfg(feature = "hotel")]
mod verdicts;
mod vocabulary;
