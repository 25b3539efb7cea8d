//! App: the state that handlers and layers share.

use std::io;
use std::ops::Deref;
use std::sync::Arc;

use axum::extract::FromRef;
use bytes::Bytes;
use tokio_util::sync::CancellationToken;

use super::connection::answer_memory::AnswerMemory;
use super::connection::connection_limit::ConnectionSlots;
use super::connection::min_rate_body::MinRate;
use super::guards::body_memory::BodyMemory;
use super::guards::route_permissions::RoutePermissions;
use super::guards::stream_limit::StreamLimit;
use super::metrics::counters::Metrics;
use super::peers::Peers;
use crate::config::limits::LimitArgs;
use crate::engine::Service;

/// The state of the handlers; clones share everything.
#[derive(Clone)]
pub struct App(Arc<Parts>);

/// State that the clones of an [`App`] share.
pub struct Parts {
    /// The engine.
    pub service: Service,
    /// The engine, answering from copies of maps that other servers own.
    pub following: Service,
    /// The metrics.
    pub metrics: Metrics,
    /// The API document as JSON.
    pub document: Bytes,
    /// The permission that each operation needs.
    pub permissions: RoutePermissions,
    /// Cancelled when shutdown begins.
    pub stopping: CancellationToken,
    /// Limits on concurrency, sizes and times.
    pub limits: LimitArgs,
    /// The lowest rate at which a body may arrive.
    pub pace: MinRate,
    /// Open connections, bounded in number.
    pub slots: Arc<ConnectionSlots>,
    /// Open event streams, bounded in number.
    pub streams: Arc<StreamLimit>,
    /// Memory that large request bodies share.
    pub memory: BodyMemory,
    /// Clients to the servers that share the database.
    pub peers: Peers,
    /// Memory that large answers share.
    pub answers: Arc<AnswerMemory>,
}

impl Deref for App {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        &self.0
    }
}

impl App {
    /// Creates an app around a service within limits, until `stopping` is cancelled. The API document, as JSON,
    /// declares the permission of each operation; invalid JSON is an error.
    pub fn new(
        service: Service,
        limits: LimitArgs,
        document: Vec<u8>,
        stopping: CancellationToken,
    ) -> io::Result<Self> {
        service.pressure().allow(limits.requests());
        Ok(Self(Arc::new(Parts {
            following: service.following(),
            service,
            permissions: RoutePermissions::of(&serde_json::from_slice(&document)?),
            metrics: Metrics::default(),
            document: document.into(),
            stopping,
            pace: MinRate::of(&limits),
            slots: ConnectionSlots::new(limits.max_connections),
            streams: StreamLimit::new(limits.streams()),
            memory: BodyMemory::new(limits.max_body_memory),
            peers: Peers::default(),
            answers: AnswerMemory::new(limits.max_answer_memory),
            limits,
        })))
    }
}

impl FromRef<App> for Service {
    fn from_ref(app: &App) -> Self {
        app.service.clone()
    }
}
