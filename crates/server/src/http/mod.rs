//! HTTP: the API over HTTP/1.1.
//!
//! | file or folder | concept |
//! |---|---|
//! | [`routes`] | one file per kind of resource: extract, call the engine once, respond |
//! | [`extract`] | path, query and body of a request, validated |
//! | [`answer`], [`problem`], [`envelope`] | success, errors, and the request id of every response |
//! | [`guards`] | layers that admit or reject a request before its handler |
//! | [`forwarding`], [`peers`] | requests about maps of other servers |
//! | [`server`], [`connection`] | the accept loop, shutdown; connection limit, timeouts |
//! | [`router`], [`app`] | the layers around the routes, and their shared state |
//! | [`metrics::counters`] | the metrics page |
//! | [`mod@document`], [`error_responses`] | the API document |
//! | [`pages`] | the viewer and the reference |

pub mod answer;
pub mod app;
pub mod connection;
pub mod document;
pub mod envelope;
pub mod error_responses;
pub mod extract;
pub mod forwarding;
pub mod guards;
pub mod metrics;
pub mod pages;
pub mod peers;
pub mod problem;
pub mod router;
pub mod routes;
pub mod server;

pub use app::App;
pub use document::document;
pub use server::{RunningServer, serve};
