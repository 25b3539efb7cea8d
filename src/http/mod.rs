//! HTTP: the contract spoken over HTTP/1.1.
//!
//! | file | concept |
//! |---|---|
//! | [`routes`] | one file for each kind of resource: extract, ask the service once, answer |
//! | [`path`], [`query`], [`body`], [`if_match`] | what a request says, checked |
//! | [`answer`] | what success says |
//! | [`problem`], [`envelope`] | what a refusal says, and the id that every answer carries |
//! | [`router`] | the layers around the routes |
//! | [`server`] | the accept loop, and how it stops |
//! | [`access`] | who asks, and may they? |
//! | [`metrics`], [`gauges`], [`process`] | what Prometheus reads |
//! | [`mod@document`], [`refusals`] | the API document |
//! | [`pages`] | the viewer and the reference |

pub mod access;
pub mod answer;
pub mod body;
pub mod document;
pub mod envelope;
pub mod gauges;
pub mod if_match;
pub mod metrics;
pub mod pages;
pub mod path;
pub mod problem;
pub mod process;
pub mod query;
pub mod refusals;
pub mod router;
pub mod routes;
pub mod server;

use std::sync::Arc;

use axum::extract::FromRef;
use bytes::Bytes;
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;

pub use document::document;
pub use server::{RunningServer, serve};

use crate::service::Service;
use access::Needs;
use metrics::Metrics;

/// What handlers work with.
#[derive(Clone)]
pub struct App {
    /// The use cases.
    pub service: Service,
    /// The counters.
    pub metrics: Arc<Metrics>,
    /// The API document as JSON.
    pub document: Bytes,
    /// What each operation asks of who calls it.
    pub needs: Arc<Needs>,
    /// Cancelled when the server is told to stop.
    pub stopping: CancellationToken,
    /// Loop checks that anchors have triggered and that nobody waits for.
    pub triggers: Arc<Semaphore>,
}

impl App {
    /// An app around a service, until `stopping` is cancelled.
    pub fn new(service: Service, stopping: CancellationToken) -> Self {
        let document = serde_json::to_vec(&document()).unwrap_or_default();
        Self {
            service,
            needs: Arc::new(Needs::of(&serde_json::from_slice(&document).unwrap_or_default())),
            metrics: Arc::new(Metrics::default()),
            document: document.into(),
            stopping,
            triggers: Arc::new(Semaphore::new(routes::TRIGGERS_AT_ONCE)),
        }
    }
}

impl FromRef<App> for Service {
    fn from_ref(app: &App) -> Self {
        app.service.clone()
    }
}
