//! Server: accepts connections until shutdown begins, then finishes requests in flight.
//!
//! `axum::serve` waits indefinitely: for half a head, for a body, for a response to be read. Here each of these has a
//! timeout ([`super::connection::io_timeout`], [`super::connection::min_rate_body`]), and the number of connections is limited
//! ([`super::connection::connection_limit`]).
//!
//! Shutdown resets no connection. On Linux, the listener first ignores new ones. It is closed once those being opened
//! ([`HANDSHAKES`]) are accepted. Each connection receives one more response, with `connection: close`; one without a
//! request is closed after [`LAST_REQUESTS`].

use std::convert::Infallible;
use std::io;
use std::net::SocketAddr;
use std::num::NonZeroU32;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::extract::Request;
use axum::http::HeaderValue;
use axum::http::header::CONNECTION;
use governor::{DefaultDirectRateLimiter, Quota, RateLimiter};
use http_body_util::BodyExt as _;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::{GracefulShutdown, Watcher};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tower::ServiceExt as _;

use super::App;
use super::connection::connection_limit::{ConnectionSlot, SlotClaim};
use super::connection::io_timeout::{TimeoutStream, overdue};
use super::connection::reject_connection;
use super::connection::sockets;
use super::connection::unread::Unread;
use super::document::document;
use super::router::router;
use crate::config::limits::LimitArgs;
use crate::engine::Service;

/// Maximum time for requests in flight to finish after shutdown begins.
const DRAIN: Duration = Duration::from_secs(10);
/// Time for connections that are being opened at shutdown: an intercontinental round trip.
const HANDSHAKES: Duration = Duration::from_millis(250);
/// Time until a connection without a request is closed at shutdown, so that a request just sent is still answered.
const LAST_REQUESTS: Duration = Duration::from_secs(1);
/// Maximum bytes of a request's head, and of the read-ahead of a body.
const HEAD_BYTES: usize = 64 << 10;
/// First and maximum delay after a failed accept (usually no file descriptors are left); it doubles each time.
const ACCEPT_AGAIN: [Duration; 2] = [Duration::from_millis(20), Duration::from_secs(1)];
/// Maximum concurrent 503 responses to connections without a slot. Further ones are closed without a response.
const REFUSALS_AT_ONCE: usize = 64;
/// Maximum log lines per minute about rejected connections.
const COMPLAINTS_PER_MINUTE: NonZeroU32 = NonZeroU32::new(6).unwrap();

/// Serves until `stopping` is cancelled and the requests in flight are finished or timed out.
pub async fn serve(
    listener: TcpListener,
    service: Service,
    limits: LimitArgs,
    stopping: CancellationToken,
) -> io::Result<()> {
    let drain = limits.drain;
    let app = App::new(service, limits, serde_json::to_vec(&document())?, stopping.clone())?;
    let server = Arc::new(Connections {
        router: router(app.clone()),
        app,
        refusals: Arc::new(Semaphore::new(REFUSALS_AT_ONCE)),
        complaints: RateLimiter::direct(Quota::per_minute(COMPLAINTS_PER_MINUTE)),
        http: http(),
        closing: CancellationToken::new(),
        open: TaskTracker::new(),
    });
    let graceful = GracefulShutdown::new();
    let stopped = async {
        stopping.cancelled().await;
        // `/readyz` already returns 503.
        tokio::time::sleep(drain).await;
    };
    tokio::select! {
        () = server.accept(&listener, &graceful) => {}
        () = stopped => {}
    }
    server.closing.cancel();
    sockets::open_no_more(&listener);
    let _ = tokio::time::timeout(HANDSHAKES, server.accept(&listener, &graceful)).await;
    match sockets::close(listener) {
        Ok(opened) => opened.into_iter().for_each(|stream| server.admit(stream, graceful.watcher())),
        // Connections already being served still finish.
        Err(error) => tracing::warn!(%error, "opened connections are not served"),
    }
    server.open.close();
    let finished = async {
        let _ = tokio::time::timeout(LAST_REQUESTS, server.open.wait()).await;
        graceful.shutdown().await;
    };
    if tokio::time::timeout(DRAIN, finished).await.is_err() {
        tracing::warn!(seconds = DRAIN.as_secs(), "some requests did not finish in time");
    }
    Ok(())
}

fn http() -> http1::Builder {
    let mut http = http1::Builder::new();
    // `TimeoutStream` times heads and idle connections, because it can tell them apart.
    http.timer(TokioTimer::new())
        .header_read_timeout(None)
        .max_buf_size(HEAD_BYTES)
        .max_header_size(HEAD_BYTES);
    http
}

struct Connections {
    app: App,
    router: Router,
    refusals: Arc<Semaphore>,
    complaints: DefaultDirectRateLimiter,
    http: http1::Builder,
    /// Cancelled when connections must close after their next response.
    closing: CancellationToken,
    /// The tasks that serve connections.
    open: TaskTracker,
}

impl Connections {
    async fn accept(self: &Arc<Self>, listener: &TcpListener, graceful: &GracefulShutdown) {
        let [mut again, again_max] = ACCEPT_AGAIN;
        loop {
            match listener.accept().await {
                Ok((stream, _)) => {
                    [again, _] = ACCEPT_AGAIN;
                    self.admit(stream, graceful.watcher());
                }
                // The client had closed before the accept.
                Err(error) if sockets::is_the_clients(&error) => {}
                Err(error) => {
                    tracing::warn!(%error, "no connection can be accepted");
                    tokio::time::sleep(again).await;
                    again = (again * 2).min(again_max);
                }
            }
        }
    }

    /// Gives the connection a slot, or rejects it. Never waits, because that would block other connections.
    fn admit(self: &Arc<Self>, stream: TcpStream, watcher: Watcher) {
        let claimed = match self.app.slots.claim() {
            SlotClaim::Free(permit) => Some(permit),
            SlotClaim::Instead => {
                self.app.metrics.connection("evicted");
                None
            }
            SlotClaim::Full => {
                self.app.metrics.connection("refused");
                if self.complaints.check().is_ok() {
                    tracing::warn!(
                        "all connections are in use, and new ones are rejected (--max-connections)"
                    );
                }
                if let Ok(permit) = self.refusals.clone().try_acquire_owned() {
                    self.open.spawn(reject_connection::reject(stream, permit));
                }
                return;
            }
        };
        self.app.metrics.connection("accepted");
        let server = self.clone();
        self.open.spawn(async move {
            let Some(seat) = server.app.slots.acquire(claimed).await else { return };
            server.converse(stream, seat, watcher).await;
        });
    }

    async fn converse(&self, stream: TcpStream, seat: Arc<ConnectionSlot>, watcher: Watcher) {
        if let Err(error) = sockets::prepare(&stream, self.app.limits.stall_timeout) {
            tracing::debug!(%error, "the options of a connection could not be set");
        }
        let stream = TokioIo::new(TimeoutStream::new(stream, seat.clone(), &self.app.limits));
        let (router, at_work, closing) = (self.router.clone(), seat.clone(), self.closing.clone());
        let answer = hyper::service::service_fn(move |request: hyper::Request<hyper::body::Incoming>| {
            at_work.works();
            let (mut request, unread) = Unread::of(Request::from(request.map(Body::new)));
            request.extensions_mut().insert(at_work.clone());
            let answered = router.clone().oneshot(request);
            let (at_work, closing) = (at_work.clone(), closing.clone());
            async move {
                let response = answered.await.unwrap_or_else(|never: Infallible| match never {});
                let mut response = unread.settle(response).await;
                if closing.is_cancelled() {
                    response.headers_mut().insert(CONNECTION, HeaderValue::from_static("close"));
                }
                let resting = RestsOnDrop(at_work);
                // Held as long as the body: until its last byte was sent.
                let held = move |error| {
                    let _ = &resting;
                    error
                };
                Ok::<_, Infallible>(response.map(|body| body.map_err(held)))
            }
        });
        let conversation = watcher.watch(self.http.serve_connection(stream, answer));
        tokio::select! {
            ended = conversation => if let Err(error) = ended {
                tracing::debug!(%error, "a connection failed");
            },
            () = overdue(&seat, &self.app.limits) => tracing::debug!("a client sent no request in time"),
            () = seat.close_requested() => tracing::debug!("a connection was evicted for another"),
        }
    }
}

/// Marks a connection as waiting for its next request when this is dropped.
struct RestsOnDrop(Arc<ConnectionSlot>);

impl Drop for RestsOnDrop {
    fn drop(&mut self) {
        self.0.rests();
    }
}

/// A server in this process, for replay, demo and tests.
pub struct RunningServer {
    addr: SocketAddr,
    stopping: CancellationToken,
    served: Option<JoinHandle<io::Result<()>>>,
    service: Service,
}

impl RunningServer {
    /// Starts serving on a free port of this machine.
    pub async fn start(service: Service) -> io::Result<Self> {
        Self::start_within(service, LimitArgs::of::<&str>(&[]).map_err(io::Error::other)?).await
    }

    /// Starts serving within the given limits.
    pub async fn start_within(service: Service, limits: LimitArgs) -> io::Result<Self> {
        Self::start_at(service, limits, (std::net::Ipv4Addr::LOCALHOST, 0).into()).await
    }

    /// Starts serving at an address within the given limits.
    pub async fn start_at(service: Service, limits: LimitArgs, addr: SocketAddr) -> io::Result<Self> {
        let listener = TcpListener::bind(addr).await?;
        let addr = listener.local_addr()?;
        service.join(format!("http://{addr}")).await.map_err(io::Error::other)?;
        let stopping = CancellationToken::new();
        let served = tokio::spawn(serve(listener, service.clone(), limits, stopping.clone()));
        Ok(Self { addr, stopping, served: Some(served), service })
    }

    /// Returns its address.
    pub fn addr(&self) -> SocketAddr {
        self.addr
    }

    /// Returns its URL.
    pub fn url(&self) -> String {
        format!("http://{}", self.addr)
    }

    /// Starts shutdown as SIGTERM does, without waiting for it.
    pub fn tell_to_stop(&self) {
        self.stopping.cancel();
    }

    /// Stops it as SIGTERM does, and closes its service.
    pub async fn stop(mut self) -> io::Result<()> {
        self.stopping.cancel();
        let result = match self.served.take() {
            Some(served) => served.await.unwrap_or_else(|error| Err(io::Error::other(error))),
            None => Ok(()),
        };
        self.service.close().await;
        result
    }
}

impl Drop for RunningServer {
    fn drop(&mut self) {
        self.stopping.cancel();
    }
}
