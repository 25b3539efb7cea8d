//! Config: what the operator decides, and the one place that reads the environment.
//!
//! | file | concept |
//! |---|---|
//! | [`build`] | what this binary is |
//! | [`limits`] | how much at once, and how patient |
//! | [`listen`] | where to listen, and where not |
//! | [`logging`] | what is logged, and how |
//! | [`models`] | which language and vision models to ask, and what they may cost |
//! | [`tls`] | the one TLS stack |

pub mod build;
pub mod limits;
pub mod listen;
pub mod logging;
pub mod models;
pub mod tls;
