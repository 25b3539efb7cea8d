//! Overload: what is left of the throughput when four times as much is asked as can be done.
//!
//! The server is a process of its own; generator and server share the machine's cores, as they do where this is run, so
//! what the generator costs is taken from the server. Each phase begins with fresh maps of the same content. First the
//! peak is looked for at rising concurrency; then phases at the peak and at four times its rate take turns, and the
//! ratio is the median over the turns, because the machine may be busy with other things.
//!
//! `cargo bench --bench overload -- [--short]`; `REVISIT=path/to/revisit` takes another server.

mod health;
mod mix;
mod wire;

use std::cell::{Cell, RefCell};
use std::io::{BufRead as _, BufReader};
use std::net::SocketAddr;
use std::process::{Child, Command, ExitCode, Stdio};
use std::rc::Rc;
use std::time::{Duration, Instant};

use health::Health;
use mix::Mix;
use wire::Connection;

/// Clients tried in search of the peak.
const CLIENTS: [usize; 5] = [4, 12, 32, 64, 128];
/// Connections of the overload; more than the server works on at once.
const CONNECTIONS: usize = 900;
const TIMES: f64 = 4.0;

const GOODPUT_RATIO_MIN: f64 = 0.90;
const SHED_MEDIAN_MS_MAX: f64 = 10.0;
const HEALTH_MS_MAX: f64 = 50.0;

struct Server {
    process: Child,
    addr: SocketAddr,
    _folder: tempfile::TempDir,
}

impl Server {
    fn start() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let database = format!("sqlite://{}/overload.db", folder.path().display());
        let program = std::env::var("REVISIT").unwrap_or_else(|_| env!("CARGO_BIN_EXE_revisit").to_owned());
        let mut command = Command::new(program);
        command.args(["serve", "--listen", "127.0.0.1:0", "--log", "error", "--database", &database]);
        let mut process = command.stdout(Stdio::piped()).spawn().expect("the server starts");
        let mut first = String::new();
        let stdout = process.stdout.take().expect("its standard output");
        BufReader::new(stdout).read_line(&mut first).expect("its first line");
        let addr = first.trim().strip_prefix("listening on http://").expect("its address");
        Self { process, addr: addr.parse().expect("an address"), _folder: folder }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// What one phase saw.
#[derive(Default)]
struct Seen {
    good: Cell<u64>,
    shed: Cell<u64>,
    other: Cell<u64>,
    good_ms: RefCell<Vec<f64>>,
    shed_ms: RefCell<Vec<f64>>,
}

impl Seen {
    fn take(&self, status: Option<u16>, took: Duration) {
        let ms = took.as_secs_f64() * 1e3;
        let (count, list) = match status {
            Some(200..=299) => (&self.good, Some(&self.good_ms)),
            Some(503) => (&self.shed, Some(&self.shed_ms)),
            _ => (&self.other, None),
        };
        count.set(count.get() + 1);
        if let Some(list) = list {
            list.borrow_mut().push(ms);
        }
    }
}

/// Asks for so long: as fast as the clients get answers, or at a rate.
async fn phase(addr: SocketAddr, name: &str, clients: usize, rate: Option<f64>, lasts: Duration) -> Rc<Seen> {
    let mix = Rc::new(Mix::new(name));
    let mut first = Connection::to(addr);
    for request in mix.first() {
        assert_eq!(first.ask(&request).await.expect("an answer"), 201, "what a phase begins with");
    }
    let (seen, next) = (Rc::new(Seen::default()), Rc::new(Cell::new(0)));
    let started = Instant::now();
    let tasks = (0..clients).map(|_| {
        let (mix, seen, next) = (mix.clone(), seen.clone(), next.clone());
        tokio::task::spawn_local(async move {
            let mut connection = Connection::to(addr);
            loop {
                let number: u64 = next.replace(next.get() + 1);
                if let Some(rate) = rate {
                    let due = started + Duration::from_secs_f64(number as f64 / rate);
                    tokio::time::sleep_until(due.into()).await;
                }
                if started.elapsed() >= lasts {
                    return;
                }
                let request = mix.nth(number);
                let sent = Instant::now();
                let status = connection.ask(&request).await.ok();
                // What is answered after the end belongs to no phase.
                if started.elapsed() < lasts {
                    seen.take(status, sent.elapsed());
                }
            }
        })
    });
    for task in tasks.collect::<Vec<_>>() {
        task.await.expect("a client");
    }
    seen
}

fn quantile(list: &[f64], share: f64) -> f64 {
    let mut sorted = list.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    sorted.get((share * last as f64).round() as usize).copied().unwrap_or(0.0)
}

async fn measure(short: bool) -> bool {
    let (turns, lasts) = if short { (3, Duration::from_secs(4)) } else { (7, Duration::from_secs(10)) };
    let server = Server::start();
    let addr = server.addr;
    let rate = |seen: &Seen| seen.good.get() as f64 / lasts.as_secs_f64();
    println!(
        "mix: 5 keyframes with words and features, 3 loop queries, 2 reads of 10; {} s a phase",
        lasts.as_secs()
    );
    let (mut best, mut peak) = (0, 0.0);
    for clients in CLIENTS {
        let seen = phase(addr, &format!("search-{clients}"), clients, None, lasts).await;
        println!(
            "{clients:>4} clients: {:>6.0} good answers/s, p50 {:.1} ms",
            rate(&seen),
            quantile(&seen.good_ms.borrow(), 0.5)
        );
        if rate(&seen) > peak {
            (best, peak) = (clients, rate(&seen));
        }
    }
    println!("peak at {best} clients; now the peak and {TIMES} times its rate take turns");
    let (mut ratios, mut shed_ms, mut health_ms, mut other) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for turn in 0..turns {
        let at_peak = phase(addr, &format!("peak-{turn}"), best, None, lasts).await;
        let offered = TIMES * rate(&at_peak).max(1.0);
        let health = Health::watch(addr);
        let over = phase(addr, &format!("over-{turn}"), CONNECTIONS, Some(offered), lasts).await;
        let health = health.took_ms();
        println!(
            "turn {turn}: peak {:.0}/s; offered {offered:.0}/s: good {:.0}/s (p50 {:.0} ms), shed {:.0}/s (p50 {:.1} ms), other {}; healthz p50 {:.1} p99 {:.1} max {:.1} ms of {}",
            rate(&at_peak),
            rate(&over),
            quantile(&over.good_ms.borrow(), 0.5),
            over.shed.get() as f64 / lasts.as_secs_f64(),
            quantile(&over.shed_ms.borrow(), 0.5),
            over.other.get(),
            quantile(&health, 0.5),
            quantile(&health, 0.99),
            quantile(&health, 1.0),
            health.len(),
        );
        ratios.push(rate(&over) / rate(&at_peak));
        shed_ms.extend_from_slice(&over.shed_ms.borrow());
        health_ms.extend(health);
        other += at_peak.other.get() + over.other.get() + at_peak.shed.get();
    }
    let mut passed = true;
    let mut verdict = |what: &str, figure: f64, good: bool, limit: String| {
        println!("{} {what}: {figure:.2} (limit {limit})", if good { "ok    " } else { "BROKEN" });
        passed &= good;
    };
    let ratio = quantile(&ratios, 0.5);
    verdict(
        "goodput at 4 times the peak's load / peak, median of turns",
        ratio,
        ratio >= GOODPUT_RATIO_MIN,
        format!(">= {GOODPUT_RATIO_MIN}"),
    );
    let shed = quantile(&shed_ms, 0.5);
    verdict(
        "a shed answer, median, ms",
        shed,
        shed <= SHED_MEDIAN_MS_MAX,
        format!("<= {SHED_MEDIAN_MS_MAX}"),
    );
    println!("       a shed answer, p99, ms: {:.1} of {}", quantile(&shed_ms, 0.99), shed_ms.len());
    let p99 = quantile(&health_ms, 0.99);
    verdict("/healthz under overload, p99, ms", p99, p99 < HEALTH_MS_MAX, format!("< {HEALTH_MS_MAX}"));
    println!(
        "       /healthz under overload, max, ms: {:.1} of {}",
        quantile(&health_ms, 1.0),
        health_ms.len()
    );
    verdict(
        "answers that are neither 2xx nor shed at overload, and refusals at the peak",
        other as f64,
        other == 0,
        "0".to_owned(),
    );
    passed
}

fn main() -> ExitCode {
    // `cargo test --benches` runs this, too, and shall not wait for it.
    if std::env::args().any(|argument| argument == "--test") {
        return ExitCode::SUCCESS;
    }
    let short = std::env::args().any(|argument| argument == "--short");
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    let passed = tokio::task::LocalSet::new().block_on(&runtime, measure(short));
    if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
