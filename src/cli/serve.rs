//! `revisit serve`: the server.

use std::fs::File;
use std::io::BufWriter;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4};
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use tokio::net::TcpListener;

use super::failure::Failure;
use super::output::write_out;
use super::replay::OwnServer;
use super::signals::stop_on_signal;
use crate::api::verdict::LoopAnswer;
use crate::config::memory::MemoryArgs;
use crate::config::quotas::Quotas;
use crate::config::traces::Traces;
use crate::config::{build, limits, listen, logging, traces};
use crate::engine::{ModelChoice, Service, ServiceOptions};
use crate::http::{self, RunningServer};
use crate::store::{is_server_url, without_password};
use crate::vocabulary::Vocabulary;

/// A free port of this machine.
pub(super) const LOCAL: SocketAddr = SocketAddr::V4(SocketAddrV4::new(Ipv4Addr::LOCALHOST, 0));

/// File descriptors reserved for the database, the runtime and the log.
const FILES_BESIDE: u64 = 64;

/// Serve maps over HTTP.
///
/// The first line on standard output is `listening on http://ADDR`; logs go to standard error. On SIGTERM and SIGINT,
/// requests in flight are finished and the exit code is 0.
#[derive(Args, Debug)]
pub struct ServeArgs {
    /// Address to listen on; port 0 picks a free port. An address that other machines can reach needs an API key in
    /// the database first: `revisit keys create`
    #[arg(long, env = "REVISIT_LISTEN", value_name = "ADDR", default_value = "127.0.0.1:7878", value_parser = listen::address)]
    listen: SocketAddr,
    /// The database of all data: a file, which is created if it does not exist, or `postgres://USER@HOST/NAME`, which several
    /// servers may share
    #[arg(long, env = "REVISIT_DATABASE", value_name = "URL", default_value = "sqlite://revisit.db")]
    database: String,
    /// Address at which the other servers of a PostgreSQL database reach this one, such as `http://10.0.0.7:7878`; by default the address
    /// that it listens on
    #[arg(long, env = "REVISIT_ADVERTISE", value_name = "URL", value_parser = listen::peer)]
    advertise: Option<String>,
    /// A vocabulary, to compute words where a client sends features without them, and to guide matching. DBoW2's text
    /// format or the binary format (`revisit vocabulary convert`), plain, gzip or zstd
    #[arg(long, env = "REVISIT_VOCABULARY", value_name = "FILE")]
    vocabulary: Option<PathBuf>,
    /// Folder for backups requested by clients (POST /v1/backups), which are rejected without it
    #[arg(long, env = "REVISIT_BACKUPS", value_name = "DIR")]
    backups: Option<PathBuf>,
    /// Number of backups to keep; the oldest are deleted first
    #[arg(long, env = "REVISIT_BACKUPS_KEPT", value_name = "N", default_value_t = 7,
        value_parser = clap::value_parser!(u16).range(1..=1000))]
    backups_kept: u16,
    /// Seconds between two looks for crops, descriptors and keyframes that the maps' settings let go of (`keep_...`)
    #[arg(long, env = "REVISIT_RETENTION_EVERY_S", value_name = "SECONDS", default_value_t = 600,
        value_parser = clap::value_parser!(u32).range(1..=86_400))]
    retention_every_s: u32,
    #[command(flatten)]
    limits: limits::LimitArgs,
    #[command(flatten)]
    memory: MemoryArgs,
    #[cfg(feature = "llm")]
    #[command(flatten)]
    models: crate::config::models::ModelArgs,
    #[command(flatten)]
    quotas: Quotas,
    #[command(flatten)]
    log: logging::LogArgs,
    #[command(flatten)]
    traces: traces::TraceArgs,
}

/// Runs `serve`.
pub async fn run(args: ServeArgs) -> Result<(), Failure> {
    if let Some(reason) = build::missing_feature() {
        return Err(reason.into());
    }
    let traces = Traces::start(&args.traces)?;
    logging::start(&args.log, &traces)?;
    keep_to_small_pages();
    let stopping = stop_on_signal()?;
    // The port first: a second server must fail on it before it opens the database.
    let listener = TcpListener::bind(args.listen)
        .await
        .map_err(|error| format!("cannot listen on {}: {error}", args.listen))?;
    if is_server_url(&args.database) && args.advertise.is_none() && args.listen.ip().is_unspecified() {
        let detail = "other servers of this database cannot reach this one at an address that stands for all of its own: name one by \
            --advertise http://HOST:PORT";
        return Err(detail.into());
    }
    let mut service = Service::open(ServiceOptions {
        database: args.database.clone(),
        vocabulary: args.vocabulary,
        #[cfg(feature = "llm")]
        models: ModelChoice::Configured(Box::new(args.models)),
        #[cfg(not(feature = "llm"))]
        models: ModelChoice::None,
        keys_required: !args.listen.ip().is_loopback(),
        quotas: args.quotas,
        map_memory: args.memory.map_memory_bytes(),
        retention_every: Duration::from_secs(args.retention_every_s.into()),
        write_answer: LoopAnswer::bytes,
    })
    .await?;
    if !args.listen.ip().is_loopback() && !service.keys().has_good_key() {
        service.close().await;
        return Err(keyless(args.listen, &args.database).into());
    }
    if let Some(folder) = args.backups {
        service = service.with_backups(folder, args.backups_kept.into())?;
    }
    let files = limits::raise_open_files();
    if files.is_some_and(|files| files < args.limits.max_connections as u64 + FILES_BESIDE) {
        tracing::warn!(
            files,
            connections = args.limits.max_connections,
            "the limit of open files is below the number of connections"
        );
    }
    let addr = listener.local_addr()?;
    service.join(args.advertise.unwrap_or_else(|| format!("http://{addr}"))).await?;
    write_out(&format!("listening on http://{addr}\n"))?;
    tracing::info!(%addr, database = without_password(&args.database), version = build::VERSION, traces = traces.are_sent(), "serving");
    let served = http::serve(listener, service.clone(), args.limits, stopping).await;
    service.close().await;
    traces.flush().await;
    tracing::info!("stopped");
    Ok(served?)
}

/// Returns why a server that other machines can reach does not start without a key, and how to create one.
fn keyless(listen: SocketAddr, database: &str) -> String {
    let database = without_password(database);
    format!(
        "other machines can reach {listen}, and {database} has no API key. Create one first:\n\
         \n    revisit keys create --name admin --actions read,write,query,admin --database {database}\n\n\
         or listen on 127.0.0.1"
    )
}

/// Returns a server on a temporary database, for `replay`.
pub async fn own_server() -> Result<OwnServer, Failure> {
    let directory = tempfile::tempdir()?;
    server_in(directory.path(), None, LOCAL).await.map(|server| server.with(directory))
}

/// Returns a server with this vocabulary, whose data is in this folder.
pub(super) async fn server_in(
    folder: &Path,
    vocabulary: Option<Vocabulary>,
    listen: SocketAddr,
) -> Result<OwnServer, Failure> {
    let database = format!("sqlite://{}", folder.join("revisit.db").display());
    let mut options = ServiceOptions::on(database, LoopAnswer::bytes);
    if let Some(vocabulary) = vocabulary {
        let path = folder.join("hotel.voc");
        vocabulary.write_binary(BufWriter::new(File::create(&path)?))?;
        options.vocabulary = Some(path);
    }
    let service = Service::open(options).await?;
    let limits = limits::LimitArgs::of::<&str>(&[])?;
    let started = RunningServer::start_at(service, limits, listen).await;
    let server = started.map_err(|error| format!("cannot listen on {listen}: {error}"))?;
    Ok(OwnServer::new(server.url(), server))
}

/// Disables huge pages for this process. The kernel creates them from 2 MB regions with a single page in use, and
/// never releases the free part.
fn keep_to_small_pages() {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::thread::disable_transparent_huge_pages(true) {
        tracing::debug!(%error, "the kernel may use huge pages");
    }
}
