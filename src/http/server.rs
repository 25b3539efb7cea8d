//! Server: accepts connections until it is told to stop, then finishes what is in flight.

use std::io;
use std::net::SocketAddr;
use std::time::Duration;

use axum::serve::ListenerExt as _;
use tokio::net::TcpListener;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

use super::router::router;
use super::{App, routes};
use crate::service::Service;

/// How long requests in flight may take to finish once the server is told to stop.
const DRAIN: Duration = Duration::from_secs(10);

/// Serves until `stopping` is cancelled and what is in flight is finished, or has had its time.
pub async fn serve(listener: TcpListener, service: Service, stopping: CancellationToken) -> io::Result<()> {
    let app = App::new(service, stopping.clone());
    routes::ask_about_triggers(&app);
    // Answers are small and waited for: none is held back to be sent with the next.
    let listener = listener.tap_io(|stream| {
        if let Err(error) = stream.set_nodelay(true) {
            tracing::debug!(%error, "no TCP_NODELAY");
        }
    });
    let served =
        axum::serve(listener, router(app)).with_graceful_shutdown(stopping.clone().cancelled_owned());
    let drained = async {
        stopping.cancelled().await;
        tokio::time::sleep(DRAIN).await;
    };
    tokio::select! {
        result = served => result,
        () = drained => {
            tracing::warn!(seconds = DRAIN.as_secs(), "some requests did not finish in time");
            Ok(())
        }
    }
}

/// A server in this process, for those who need one of their own: replay, demo and tests.
pub struct RunningServer {
    addr: SocketAddr,
    stopping: CancellationToken,
    served: Option<JoinHandle<io::Result<()>>>,
    service: Service,
}

impl RunningServer {
    /// Starts serving on a free port of this machine.
    pub async fn start(service: Service) -> io::Result<Self> {
        let listener = TcpListener::bind((std::net::Ipv4Addr::LOCALHOST, 0)).await?;
        let addr = listener.local_addr()?;
        let stopping = CancellationToken::new();
        let served = tokio::spawn(serve(listener, service.clone(), stopping.clone()));
        Ok(Self { addr, stopping, served: Some(served), service })
    }

    /// Where it listens.
    pub fn addr(&self) -> SocketAddr {
        self.addr
    }

    /// Where it listens, as a client wants it.
    pub fn url(&self) -> String {
        format!("http://{}", self.addr)
    }

    /// Stops it as SIGTERM would, and closes its service.
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
