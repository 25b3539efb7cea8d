//! `revisit serve`: the server.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::Args;
use tokio::net::TcpListener;
use tokio::signal::unix::{SignalKind, signal};
use tokio_util::sync::CancellationToken;

use super::replay::OwnServer;
use super::{Failure, write_out};
use crate::config::{build, listen, logging, models};
use crate::http::{self, RunningServer};
use crate::service::{ModelChoice, Service, ServiceOptions};

/// Serve maps over HTTP.
///
/// The first line on standard output is `listening on http://ADDR`; logs go to standard error. SIGTERM and SIGINT
/// finish what is in flight and exit 0.
#[derive(Args, Debug)]
pub struct ServeArgs {
    /// Where to listen; port 0 takes a free one. Only addresses of this machine, as there are no API keys yet
    #[arg(long, env = "REVISIT_LISTEN", value_name = "ADDR", default_value = "127.0.0.1:7878", value_parser = listen::loopback)]
    listen: SocketAddr,
    /// Where everything is kept; the file is made if it is not there
    #[arg(long, env = "REVISIT_DATABASE", value_name = "URL", default_value = "sqlite://revisit.db")]
    database: String,
    /// A vocabulary: words are computed where a client sends features without them, and it guides matching. DBoW2's
    /// text form or our binary one (`revisit vocabulary convert`), plain, gzip or zstd
    #[arg(long, env = "REVISIT_VOCABULARY", value_name = "FILE")]
    vocabulary: Option<PathBuf>,
    #[command(flatten)]
    models: models::ModelArgs,
    #[command(flatten)]
    log: logging::LogArgs,
}

/// Runs it.
pub async fn run(args: ServeArgs) -> Result<(), Failure> {
    logging::start(&args.log)?;
    let stopping = stop_on_signal()?;
    // The port first: a second server on one machine shall say so before it opens the database.
    let listener = TcpListener::bind(args.listen)
        .await
        .map_err(|error| format!("cannot listen on {}: {error}", args.listen))?;
    let service = Service::open(ServiceOptions {
        database: args.database.clone(),
        vocabulary: args.vocabulary,
        models: ModelChoice::Configured(Box::new(args.models)),
    })
    .await?;
    let addr = listener.local_addr()?;
    write_out(&format!("listening on http://{addr}\n"))?;
    tracing::info!(%addr, database = args.database, version = build::VERSION, "serving");
    let served = http::serve(listener, service.clone(), stopping).await;
    service.close().await;
    tracing::info!("stopped");
    Ok(served?)
}

/// Cancelled by the first SIGTERM or SIGINT.
fn stop_on_signal() -> Result<CancellationToken, Failure> {
    let (mut term, mut int) = (signal(SignalKind::terminate())?, signal(SignalKind::interrupt())?);
    let stopping = CancellationToken::new();
    let token = stopping.clone();
    tokio::spawn(async move {
        tokio::select! {
            _ = term.recv() => {}
            _ = int.recv() => {}
        }
        tracing::info!("stopping");
        token.cancel();
    });
    Ok(stopping)
}

/// A server on a database that goes with it, for `replay`.
pub async fn own_server() -> Result<OwnServer, Failure> {
    let directory = tempfile::tempdir()?;
    let database = format!("sqlite://{}", directory.path().join("replay.db").display());
    let service = Service::open(ServiceOptions::on(database)).await?;
    let server = RunningServer::start(service).await?;
    let url = server.url();
    // Dropped in this order: the server stops before its directory goes.
    Ok(OwnServer::new(url, (server, directory)))
}
