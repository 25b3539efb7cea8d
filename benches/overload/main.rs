//! Overload: what is left of the throughput when four times as much is asked as can be done.
//!
//! The server is a process of its own; generator and server share the machine's cores, as they do where this is run, so
//! what the generator costs is taken from the server. Each phase begins with fresh maps of the same content. First the
//! peak is looked for at rising concurrency; then phases at the peak and at four times its rate take turns, and the
//! ratio is the median over the turns, because the machine may be busy with other things.
//!
//! It needs the standard library only, so that `proofs/overload` builds it in seconds; `REVISIT` names the server.

mod health;
mod mix;
mod wire;

use std::io::{BufRead as _, BufReader};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::{Child, Command, ExitCode, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use health::{Health, Took};
use mix::Mix;
use wire::Connection;

/// Clients tried in search of the peak.
const CLIENTS: [usize; 5] = [4, 16, 48, 96, 180];
/// Connections of the overload; more than the server works on at once.
const CONNECTIONS: usize = 900;
const TIMES: f64 = 4.0;

const GOODPUT_RATIO_MIN: f64 = 0.90;
const SHED_MEDIAN_MS_MAX: f64 = 10.0;
const HEALTH_MS_MAX: f64 = 50.0;

struct Server {
    process: Child,
    addr: SocketAddr,
    folder: PathBuf,
}

impl Server {
    fn start() -> Self {
        let folder = std::env::temp_dir().join(format!("revisit-overload-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        let database = format!("sqlite://{}/overload.db", folder.display());
        let program = std::env::var("REVISIT").expect("REVISIT names the server");
        let mut command = Command::new(program);
        command.args(["serve", "--listen", "127.0.0.1:0", "--log", "error", "--database", &database]);
        let mut process = command.stdout(Stdio::piped()).spawn().expect("the server starts");
        let mut first = String::new();
        let stdout = process.stdout.take().expect("its standard output");
        BufReader::new(stdout).read_line(&mut first).expect("its first line");
        let addr = first.trim().strip_prefix("listening on http://").expect("its address");
        Self { process, addr: addr.parse().expect("an address"), folder }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// What one client saw in one phase, or all of them.
#[derive(Default)]
struct Seen {
    good_ms: Vec<f64>,
    shed_ms: Vec<f64>,
    other: u64,
}

impl Seen {
    fn take(&mut self, status: Option<u16>, took: Duration) {
        let ms = took.as_secs_f64() * 1e3;
        match status {
            Some(200..=299) => self.good_ms.push(ms),
            Some(503) => self.shed_ms.push(ms),
            _ => self.other += 1,
        }
    }

    fn join(&mut self, other: Self) {
        self.good_ms.extend(other.good_ms);
        self.shed_ms.extend(other.shed_ms);
        self.other += other.other;
    }
}

/// Asks for so long: as fast as the clients get answers, or at a rate.
fn phase(addr: SocketAddr, name: &str, clients: usize, rate: Option<f64>, lasts: Duration) -> Seen {
    let mix = Mix::new(name);
    let mut first = Connection::to(addr);
    for request in mix.first() {
        assert_eq!(first.ask(&request).expect("an answer"), 201, "what a phase begins with");
    }
    let (all, next, started) = (Mutex::new(Seen::default()), AtomicU64::new(0), Instant::now());
    let client = || {
        let (mut connection, mut seen) = (Connection::to(addr), Seen::default());
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if let Some(rate) = rate {
                let due = Duration::from_secs_f64(number as f64 / rate);
                thread::sleep(due.saturating_sub(started.elapsed()));
            }
            if started.elapsed() >= lasts {
                break;
            }
            let request = mix.nth(number);
            let sent = Instant::now();
            let status = connection.ask(&request).ok();
            // What is answered after the end belongs to no phase.
            if started.elapsed() < lasts {
                seen.take(status, sent.elapsed());
            }
        }
        all.lock().expect("no client panics").join(seen);
    };
    thread::scope(|scope| {
        for _ in 0..clients {
            let small = thread::Builder::new().stack_size(128 << 10);
            small.spawn_scoped(scope, client).expect("a thread");
        }
    });
    all.into_inner().expect("no client panics")
}

fn quantile(list: &[f64], share: f64) -> f64 {
    let mut sorted = list.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    sorted.get((share * last as f64).round() as usize).copied().unwrap_or(0.0)
}

fn measure(short: bool) -> bool {
    let (turns, lasts) = if short { (3, Duration::from_secs(3)) } else { (7, Duration::from_secs(10)) };
    let server = Server::start();
    let addr = server.addr;
    let rate = |seen: &Seen| seen.good_ms.len() as f64 / lasts.as_secs_f64();
    println!(
        "mix: 5 keyframes with words and features, 3 loop queries, 2 reads of 10; {} s a phase",
        lasts.as_secs()
    );
    let (mut best, mut peak) = (0, 0.0);
    for clients in CLIENTS {
        let seen = phase(addr, &format!("search-{clients}"), clients, None, lasts);
        println!(
            "{clients:>4} clients: {:>6.0} good answers/s, p50 {:.1} ms",
            rate(&seen),
            quantile(&seen.good_ms, 0.5)
        );
        if rate(&seen) > peak {
            (best, peak) = (clients, rate(&seen));
        }
    }
    println!("peak at {best} clients; now the peak and {TIMES} times its rate take turns");
    let (mut ratios, mut shed_ms, mut other) = (Vec::new(), Vec::new(), 0);
    let mut took = Took::default();
    for turn in 0..turns {
        let at_peak = phase(addr, &format!("peak-{turn}"), best, None, lasts);
        let offered = TIMES * rate(&at_peak).max(1.0);
        let health = Health::watch(addr);
        let over = phase(addr, &format!("over-{turn}"), CONNECTIONS, Some(offered), lasts);
        let Took { health_ms: health, echo_ms: echo } = health.took();
        println!(
            "turn {turn}: peak {:.0}/s; offered {offered:.0}/s: good {:.0}/s (p50 {:.0} ms), shed {:.0}/s (p50 {:.1} ms), other {}; healthz p50 {:.1} p99 {:.1} max {:.1} ms of {}",
            rate(&at_peak),
            rate(&over),
            quantile(&over.good_ms, 0.5),
            over.shed_ms.len() as f64 / lasts.as_secs_f64(),
            quantile(&over.shed_ms, 0.5),
            over.other,
            quantile(&health, 0.5),
            quantile(&health, 0.99),
            quantile(&health, 1.0),
            health.len(),
        );
        ratios.push(rate(&over) / rate(&at_peak));
        shed_ms.extend_from_slice(&over.shed_ms);
        took.health_ms.extend(health);
        took.echo_ms.extend(echo);
        other += at_peak.other + over.other + at_peak.shed_ms.len() as u64;
    }
    let mut passed = true;
    // What takes time is judged in the long form only, on a machine that has nothing else to do.
    let mut verdict = |what: &str, figure: f64, good: bool, limit: String, is_timed: bool| {
        let shown = match (good, is_timed && short) {
            (true, _) => "ok    ",
            (false, true) => "SLOW  ",
            (false, false) => "BROKEN",
        };
        println!("{shown} {what}: {figure:.2} (limit {limit})");
        passed &= good || is_timed && short;
    };
    let ratio = quantile(&ratios, 0.5);
    verdict(
        "goodput at 4 times the peak's load / peak, median of turns",
        ratio,
        ratio >= GOODPUT_RATIO_MIN,
        format!(">= {GOODPUT_RATIO_MIN}"),
        true,
    );
    let shed = quantile(&shed_ms, 0.5);
    verdict(
        "a shed answer, median, ms",
        shed,
        shed <= SHED_MEDIAN_MS_MAX,
        format!("<= {SHED_MEDIAN_MS_MAX}"),
        true,
    );
    println!("       a shed answer, p99, ms: {:.1} of {}", quantile(&shed_ms, 0.99), shed_ms.len());
    let [health, echo] =
        [&took.health_ms, &took.echo_ms].map(|list| [0.5, 0.99, 1.0].map(|share| quantile(list, share)));
    println!("       /healthz under overload, p50, p99, max, ms: {health:.1?} of {}", took.health_ms.len());
    println!("       an echo beside it, which is the machine's part, p50, p99, max, ms: {echo:.1?}");
    let beyond = (health[1] - echo[1]).max(0.0);
    verdict(
        "/healthz, p99 beyond the echo's, ms",
        beyond,
        beyond < HEALTH_MS_MAX,
        format!("< {HEALTH_MS_MAX}"),
        true,
    );
    verdict(
        "answers that are neither 2xx nor shed at overload, and refusals at the peak",
        other as f64,
        other == 0,
        "0".to_owned(),
        false,
    );
    passed
}

fn main() -> ExitCode {
    // `cargo test` and `cargo bench` run this, too, without a server.
    if std::env::var_os("REVISIT").is_none() {
        return ExitCode::SUCCESS;
    }
    let short = std::env::args().any(|argument| argument == "--short");
    let passed = measure(short);
    if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
