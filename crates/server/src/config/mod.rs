//! Config: the operator's settings, and the only place that reads the environment.
//!
//! | file | concept |
//! |---|---|
//! | [`build`] | name, version and missing features of this binary |
//! | [`flags`] | numbers and groups of flags, parsed |
//! | [`limits`] | concurrency, memory and timeouts |
//! | [`listen`] | the listen address, and whether other machines reach it |
//! | [`logging`] | filter and format of the log |
//! | [`memory`] | the memory budget of maps |
//! | [`models`] | language and vision models, and their budgets |
//! | [`quotas`] | the maximum size of a map |
//! | [`tls`] | the one TLS stack |
//! | [`traces`] | spans for an OpenTelemetry collector |

pub mod build;
mod flags;
pub mod limits;
pub mod listen;
pub mod logging;
pub mod memory;
pub mod models;
pub mod quotas;
pub use revisit_client::tls;
pub mod traces;
