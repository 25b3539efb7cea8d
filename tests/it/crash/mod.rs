//! Crash: what was acknowledged survives SIGKILL, and what was not is there whole or not at all.
//!
//! `REVISIT_CRASH_ROUNDS=50` is the long form; `REVISIT_CRASH_SEED` repeats a failed one, as far
//! as a race can be repeated.

mod audit;
mod quiet;
pub mod server;
mod writer;

use std::time::Duration;

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::json;
use tokio::sync::mpsc;
use tokio::task::JoinSet;

use quiet::QuietMap;
use server::Server;
use writer::{Log, Writer};

const DEFAULT_ROUNDS: u64 = 5;
const DEFAULT_SEED: u64 = 20_260;
/// Robots that write at the same time.
const WRITERS: u64 = 16;
/// Fewer than writers, so that each map has several.
const MAPS: u64 = 4;
/// The longest that a server may take to acknowledge what a round waits for.
const ROUND_TIMEOUT: Duration = Duration::from_mins(2);

/// When to kill: a moment that no commit, no answer and no timer of the server knows of.
#[derive(Clone, Copy, Debug)]
struct KillMoment {
    acknowledged: u64,
    then: Duration,
}

#[tokio::test(flavor = "multi_thread")]
async fn acknowledged_writes_survive_a_kill_at_any_moment() {
    let rounds = number_from_env("REVISIT_CRASH_ROUNDS", DEFAULT_ROUNDS);
    let seed = number_from_env("REVISIT_CRASH_SEED", DEFAULT_SEED);
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let directory = tempfile::tempdir().expect("a temporary directory");
    let database = directory.path().join("revisit.db");

    let mut server = Server::start(&database);
    let quiet = QuietMap::prepare(server.api()).await;
    let mut logs = Vec::new();
    for round in 0..rounds {
        let moment = KillMoment {
            acknowledged: chance.random_range(1..=400),
            then: Duration::from_micros(chance.random_range(0..20_000)),
        };
        println!("seed {seed}, round {round}: {moment:?}");
        let written = write_until_killed(server, round, moment).await;
        audit::database_is_sound(&database).await;
        server = Server::start(&database);
        quiet.answers_as_before(server.api()).await;
        for log in &written {
            audit::log_is_kept(server.api(), log).await;
        }
        logs.extend(written);
    }
    // Also after the kills that came later.
    for log in &logs {
        audit::keyframes_are_whole(server.api(), log).await;
    }
    server.kill();
    audit::database_is_sound(&database).await;
}

/// Lets every writer write into maps of this round, kills the server, and returns what was sent.
async fn write_until_killed(mut server: Server, round: u64, moment: KillMoment) -> Vec<Log> {
    let (acknowledge, mut acknowledged) = mpsc::unbounded_channel();
    let mut logs = Vec::new();
    for map in 0..MAPS {
        let map = map_name(round, map);
        let path = format!("/v1/maps/{map}");
        let answer = server.api().put(&path, &json!({})).await;
        assert_eq!(answer.status, 201, "{path}: {}", answer.text());
        logs.push(Writer::walk_ahead(server.api(), &map, acknowledge.clone()).await);
    }
    while acknowledged.try_recv().is_ok() {} // The kill counts what is written from here on.

    let mut writers = JoinSet::new();
    for number in 0..WRITERS {
        let map = map_name(round, number % MAPS);
        let session = format!("robot-{number}");
        let writer = Writer::new(server.api(), &map, &session, acknowledge.clone());
        writers.spawn(writer.write_until_the_server_is_gone());
    }
    drop(acknowledge);

    let enough = async {
        for _ in 0..moment.acknowledged {
            if acknowledged.recv().await.is_none() {
                break; // Every writer gave up: joining them says why.
            }
        }
    };
    let waited = tokio::time::timeout(ROUND_TIMEOUT, enough).await;
    assert!(waited.is_ok(), "no acknowledgement within {ROUND_TIMEOUT:?}");
    tokio::time::sleep(moment.then).await;
    server.kill();
    logs.extend(writers.join_all().await);
    logs
}

fn map_name(round: u64, map: u64) -> String {
    format!("busy-{round}-{map}")
}

fn number_from_env(name: &str, default: u64) -> u64 {
    match std::env::var(name) {
        Ok(text) => text.parse().unwrap_or_else(|_| panic!("{name}={text:?} is no number")),
        Err(_) => default,
    }
}
