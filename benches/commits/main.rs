//! Group commit: how many keyframes a second one client and 64 clients get, each answer on disk.
//!
//! A keyframe is answered when its transaction is synced, so one client alone waits for the disk each time; requests
//! that arrive together share a sync. How much that gains depends on how long the disk takes. So the
//! server is measured twice: on the disk as it is, and with each sync slowed to what a server's SSD without
//! a write cache takes, by a small shim that is loaded before the C library (`slow_sync.c`, needs `cc`).

use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use serde_json::json;

const MEASURED: Duration = Duration::from_secs(4);
const CLIENTS: usize = 64;
const SLOW_SYNC_US: &str = "3000";
const WORDS: u64 = 60;

struct Server {
    process: Child,
    url: String,
    _folder: tempfile::TempDir,
}

impl Server {
    fn start(slow_sync: Option<&Path>) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let database = format!("sqlite://{}/commits.db", folder.path().display());
        let mut command = Command::new(env!("CARGO_BIN_EXE_revisit"));
        command.args(["serve", "--listen", "127.0.0.1:0", "--log", "error", "--database", &database]);
        if let Some(shim) = slow_sync {
            command.env("LD_PRELOAD", shim).env("SLOW_SYNC_US", SLOW_SYNC_US);
        }
        let mut process = command.stdout(Stdio::piped()).spawn().expect("the server starts");
        let mut first = String::new();
        let stdout = process.stdout.take().expect("its standard output");
        BufReader::new(stdout).read_line(&mut first).expect("its first line");
        let url = first.trim().strip_prefix("listening on ").expect("its address").to_owned();
        Self { process, url, _folder: folder }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn keyframe(client: usize, number: u64) -> serde_json::Value {
    let words: Vec<u64> = (0..WORDS).map(|word| word * 97 + number % 13).collect();
    json!({
        "session": format!("robot-{client}"),
        "stamp": {"sec": number, "nanosec": 0},
        "pose": {"translation": {"x": number as f64 * 0.1, "y": 0.0, "z": 0.0},
                 "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}},
        "bow": {"words": words, "weights": vec![1.0; WORDS as usize]},
    })
}

/// The rate and the latencies of so many clients, in commits a second and milliseconds.
async fn measure(url: &str, map: &str, clients: usize) -> (f64, f64, f64) {
    revisit::config::tls::install();
    let http = reqwest::Client::builder().pool_max_idle_per_host(clients).build().expect("a client");
    let made = http.put(format!("{url}/v1/maps/{map}")).json(&json!({})).send().await.expect("an answer");
    assert!(made.status().is_success());
    let done = Arc::new(AtomicU64::new(0));
    let start = Instant::now();
    let tasks: Vec<_> = (0..clients)
        .map(|client| {
            let (http, url, map, done) = (http.clone(), url.to_owned(), map.to_owned(), done.clone());
            tokio::spawn(async move {
                let mut latencies = Vec::new();
                for number in 0.. {
                    if start.elapsed() > MEASURED {
                        break;
                    }
                    let asked = Instant::now();
                    let address = format!("{url}/v1/maps/{map}/keyframes/kf-{client}-{number}");
                    let answer =
                        http.put(address).json(&keyframe(client, number)).send().await.expect("an answer");
                    assert_eq!(answer.status(), 201);
                    answer.bytes().await.expect("a body");
                    latencies.push(asked.elapsed().as_secs_f64() * 1e3);
                    done.fetch_add(1, Ordering::Relaxed);
                }
                latencies
            })
        })
        .collect();
    let mut latencies = Vec::new();
    for task in tasks {
        latencies.extend(task.await.expect("a client that ends"));
    }
    let rate = done.load(Ordering::Relaxed) as f64 / start.elapsed().as_secs_f64();
    latencies.sort_by(f64::total_cmp);
    (rate, latencies[latencies.len() / 2], latencies[latencies.len() * 99 / 100])
}

async fn round(name: &str, slow_sync: Option<&Path>) {
    let server = Server::start(slow_sync);
    let (alone, p50, p99) = measure(&server.url, "alone", 1).await;
    println!("{name:<28} {:>8} {alone:>10.0} {p50:>9.2} {p99:>9.2}", 1);
    let (together, p50, p99) = measure(&server.url, "together", CLIENTS).await;
    println!(
        "{name:<28} {CLIENTS:>8} {together:>10.0} {p50:>9.2} {p99:>9.2}   {:.1} x one client",
        together / alone
    );
}

/// The shim, built beside the benchmark; `None` where there is no C compiler.
fn build_shim() -> Option<PathBuf> {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("slow_sync.so");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/commits/slow_sync.c");
    let built = Command::new("cc")
        .args(["-shared", "-fPIC", "-O2", "-o"])
        .arg(&target)
        .arg(source)
        .args(["-ldl"])
        .status();
    built.ok()?.success().then_some(target)
}

#[tokio::main]
async fn main() {
    println!("{:<28} {:>8} {:>10} {:>9} {:>9}", "disk", "clients", "commits/s", "p50 ms", "p99 ms");
    round("as it is", None).await;
    match build_shim() {
        Some(shim) => round("each sync slowed by 3 ms", Some(&shim)).await,
        None => println!("no C compiler: the slowed disk was not measured"),
    }
}
