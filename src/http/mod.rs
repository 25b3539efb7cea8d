//! HTTP: the API over HTTP/1.1.
//!
//! | file or folder | concept |
//! |---|---|
//! | [`routes`] | one file for each kind of resource: extract, call the engine once, answer |
//! | [`extract`] | path, query and body of a request, checked |
//! | [`answer`], [`problem`], [`envelope`] | success, errors, and the request id of every answer |
//! | [`guards`] | layers that admit or reject a request before its handler |
//! | [`connection`] | the accept loop; connections: their number, timeouts, shutdown |
//! | [`router`], [`app`] | the layers around the routes, and the state that they share |
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
pub mod guards;
pub mod metrics;
pub mod pages;
pub mod problem;
pub mod router;
pub mod routes;

pub use app::App;
pub use connection::server::{RunningServer, serve};
pub use document::document;
