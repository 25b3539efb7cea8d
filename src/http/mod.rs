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
//! | [`seats`], [`refused`] | how many connections there are, who gives way, and what the others hear |
//! | [`streams`] | how many of them one key may listen on |
//! | [`patient`], [`watched`], [`paced`] | how long a client is waited for: its head, its taking the answer, its body |
//! | [`unheard`] | what is told of a request that is no HTTP |
//! | [`unread`] | request bodies that were not read to the end |
//! | [`untaken`] | how much memory answers may keep that clients do not take |
//! | [`sockets`] | options of connections, and how the listener is closed |
//! | [`admission`] | which requests are worked on, and which are refused at once |
//! | [`inflate`], [`memory`] | what a body becomes, and how much of the memory it may have |
//! | [`metrics`], [`gauges`], [`process`], [`traffic`] | what Prometheus reads |
//! | [`mod@document`], [`refusals`] | the API document |
//! | [`pages`] | the viewer and the reference |

pub mod access;
pub mod admission;
pub mod answer;
pub mod body;
pub mod document;
pub mod envelope;
pub mod gauges;
pub mod if_match;
pub mod inflate;
pub mod memory;
pub mod metrics;
pub mod paced;
pub mod pages;
pub mod path;
pub mod patient;
pub mod problem;
pub mod process;
pub mod query;
pub mod refusals;
pub mod refused;
pub mod router;
pub mod routes;
pub mod seats;
pub mod server;
pub mod sockets;
pub mod streams;
pub mod this_machine;
pub mod traffic;
pub mod trajectory_query;
pub mod unheard;
pub mod unread;
pub mod untaken;
pub mod watched;

use std::io;
use std::ops::Deref;
use std::sync::Arc;

use axum::extract::FromRef;
use bytes::Bytes;
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;

pub use document::document;
pub use server::{RunningServer, serve};

use crate::config::limits::LimitArgs;
use crate::service::Service;
use access::Needs;
use memory::Memory;
use metrics::Metrics;
use paced::Pace;
use seats::Seats;
use streams::Streams;
use untaken::AnswerMemory;

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
    pub needs: Needs,
    /// Cancelled when the server is told to stop.
    pub stopping: CancellationToken,
    /// Loop checks that anchors have triggered and that nobody waits for.
    pub triggers: Arc<Semaphore>,
    /// How much at once, and how patient.
    pub limits: LimitArgs,
    /// How slow a body may be.
    pub pace: Pace,
    /// The connections.
    pub seats: Arc<Seats>,
    /// The answers without an end.
    pub streams: Arc<Streams>,
    /// What large bodies may take.
    pub memory: Memory,
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
            needs: Needs::of(&serde_json::from_slice(&document)?),
            metrics: Metrics::default(),
            document: document.into(),
            stopping,
            triggers: Arc::new(Semaphore::new(routes::TRIGGERS_AT_ONCE)),
            pace: Pace::of(&limits),
            seats: Seats::new(limits.max_connections),
            streams: Streams::new(limits.streams()),
            memory: Memory::new(limits.max_body_memory),
            answers: AnswerMemory::new(limits.max_answer_memory),
            limits,
        })))
    }

    /// The same app with other needs.
    #[cfg(test)]
    pub fn with_needs(self, needs: Needs) -> Self {
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
