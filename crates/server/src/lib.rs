//! The server: what robots ask over HTTP, decided by the core, written by the store.
//!
//! | module | what it holds |
//! |---|---|
//! | [`http`] | routes, extraction, guards, connections, metrics, the API document |
//! | [`engine`] | maps in memory, their operations, descriptions, limits, keys, the cluster |
//! | [`llm`] | the port to language and vision models: adapters, cache, budget, breaker, dialogue |
//! | [`integrity`] | check, backup, restore |
//! | [`config`] | the only place that reads the environment |

pub mod config;
pub mod engine;
pub mod http;
pub mod integrity;
pub mod llm;
#[cfg(test)]
mod test_database;

use revisit_api as api;
use revisit_core::{domain, geometry, recognition, semantics, vocabulary};
use revisit_store as store;
