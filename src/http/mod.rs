//! HTTP: the API over HTTP/1.1.
//!
//! | file | concept |
//! |---|---|
//! | [`routes`] | one file for each kind of resource: extract, ask the service once, answer |
//! | [`path`], [`query`], [`trajectory_query`], [`body`], [`if_match`] | what a request says, checked |
//! | [`answer`] | what success says |
//! | [`problem`], [`envelope`] | what a refusal says, and the id that every answer carries |
//! | [`router`] | the layers around the routes |
//! | [`server`] | the accept loop, and how it stops |
//! | [`access`], [`this_machine`] | who asks, and may they? |
//! | [`slots`], [`refused`] | how many connections there are, who gives way, and what the others hear |
//! | [`streams`] | how many of them one key may listen on |
//! | [`patient`], [`watched`], [`paced`] | how long a client is waited for: its head, its taking the answer, its body |
//! | [`unheard`] | what is told of a request that is no HTTP |
//! | [`unread`] | request bodies that were not read to the end |
//! | [`untaken`] | how much memory answers may keep that clients do not take |
//! | [`sockets`] | options of connections, and how the listener is closed |
//! | [`admission`] | which requests are worked on, and which are refused at once |
//! | [`inflate`], [`memory`] | what a body becomes, and how much of the memory it may have |
//! | [`metrics`], [`gauges`], [`process`], [`shed_metrics`] | what Prometheus reads |
//! | [`mod@document`], [`refusals`] | the API document |
//! | [`pages`] | the viewer and the reference |

pub mod answer;
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

use std::io;
use std::ops::Deref;
use std::sync::Arc;

use axum::extract::FromRef;
use bytes::Bytes;
use tokio_util::sync::CancellationToken;

pub use connection::server::{RunningServer, serve};
pub use document::document;

use crate::config::limits::LimitArgs;
use crate::engine::Service;
use connection::answer_memory::AnswerMemory;
use connection::connection_limit::ConnectionSlots;
use connection::min_rate_body::MinRate;
use guards::access::RoutePermissions;
use guards::body_memory::BodyMemory;
use guards::stream_limit::StreamLimit;
use metrics::counters::Metrics;

/// The state that handlers work with; clones share everything.
#[derive(Clone)]
pub struct App(Arc<Parts>);

/// The parts of an app.
pub struct Parts {
    /// The use cases.
    pub service: Service,
    /// The counters.
    pub metrics: Metrics,
    /// The API document as JSON.
    pub document: Bytes,
    /// What each operation asks of who calls it.
    pub needs: RoutePermissions,
    /// Cancelled when the server is told to stop.
    pub stopping: CancellationToken,
    /// How much at once, and how patient.
    pub limits: LimitArgs,
    /// How slow a body may be.
    pub pace: MinRate,
    /// The connections.
    pub slots: Arc<ConnectionSlots>,
    /// The answers without an end.
    pub streams: Arc<StreamLimit>,
    /// What large bodies may take.
    pub memory: BodyMemory,
    /// What large answers may take.
    pub answers: Arc<AnswerMemory>,
}

impl Deref for App {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        &self.0
    }
}

impl App {
    /// Creates an app around a service within limits, until `stopping` is cancelled. It fails without an API document,
    /// which says who may do what.
    pub fn new(service: Service, limits: LimitArgs, stopping: CancellationToken) -> io::Result<Self> {
        service.pressure().allow(limits.requests());
        let document = serde_json::to_vec(&document())?;
        Ok(Self(Arc::new(Parts {
            service,
            needs: RoutePermissions::of(&serde_json::from_slice(&document)?),
            metrics: Metrics::default(),
            document: document.into(),
            stopping,
            pace: MinRate::of(&limits),
            slots: ConnectionSlots::new(limits.max_connections),
            streams: StreamLimit::new(limits.streams()),
            memory: BodyMemory::new(limits.max_body_memory),
            answers: AnswerMemory::new(limits.max_answer_memory),
            limits,
        })))
    }

    /// The same app with other needs.
    #[cfg(test)]
    pub fn with_needs(self, needs: RoutePermissions) -> Self {
        let mut parts = Arc::into_inner(self.0).unwrap_or_else(|| unreachable!("nobody else has it yet"));
        parts.needs = needs;
        Self(Arc::new(parts))
    }
}

impl FromRef<App> for Service {
    fn from_ref(app: &App) -> Self {
        app.service.clone()
    }
}
