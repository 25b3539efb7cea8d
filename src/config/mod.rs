//! Config: what the operator decides, and the one place that reads the environment.
//!
//! | file | concept |
//! |---|---|
//! | [`build`] | what this binary is, and what it was built without |
//! | [`limits`] | how much at once, and how patient |
//! | [`listen`] | where to listen, and whether others reach it |
//! | [`logging`] | what is logged, and how |
//! | [`memory`] | how much memory the maps may take |
//! | [`models`] | which language and vision models to ask, and what they may cost |
//! | [`quotas`] | how much a map may hold |
//! | [`tls`] | the one TLS stack |
//! | [`traces`] | where traces go |

pub mod build;
pub mod limits;
pub mod listen;
pub mod logging;
pub mod memory;
pub mod models;
pub mod quotas;
pub mod tls;
pub mod traces;
