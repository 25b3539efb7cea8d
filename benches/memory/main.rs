//! Memory of the process for each keyframe, and what it costs where very many keyframes or texts resemble each other.
//!
//! `cargo bench --bench memory [-- KEYFRAMES]` prints the memory; `cargo bench --bench memory -- curves` the curves.
//! Each figure is taken in a process of its own: the growth of its resident memory, with the server's allocator.

mod crowds;
mod process;
mod robot;

use std::process::Command;
use std::sync::Arc;

use revisit::api::verdict::LoopAnswer;
use revisit::domain::ids::MapId;
use revisit::domain::keyframe::NewKeyframe;
use revisit::domain::map::MapProperties;
use revisit::domain::request::{LoopQuery, Subject};
use revisit::domain::verdict::Verify;
use revisit::engine::{Service, ServiceOptions};
use revisit::recognition::anchors::ingest::ingest;
use revisit::recognition::map::index::MapIndex;

use robot::{Robot, Sends};

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const KEYFRAMES: u32 = 10_000;
/// Loop queries that fill the server's caches: each reads the features of some tens of keyframes.
const QUERIES: u32 = 300;
/// Keyframes that clients send at once.
const AT_ONCE: usize = 16;

/// What a keyframe brings, row by row of the table.
const ROWS: [(&str, Sends); 5] = [
    ("words only", Sends { points: 0, detections: 0, features: 0 }),
    ("words, 300 map points", Sends { points: 300, detections: 0, features: 0 }),
    ("words, 700 map points", Sends { points: 700, detections: 0, features: 0 }),
    ("words, 500 map points, 2 detections", Sends { points: 500, detections: 2, features: 0 }),
    ("the same with 1,000 features", Sends { points: 500, detections: 2, features: 1_000 }),
];

fn main() {
    let arguments: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let number = |at: usize| arguments.get(at).and_then(|argument| argument.parse::<u32>().ok());
    match arguments.first().map(String::as_str) {
        Some("index") => of_index(ROWS[number(1).unwrap_or(0) as usize].1, number(2).unwrap_or(KEYFRAMES)),
        Some("server") => {
            let runtime = tokio::runtime::Runtime::new().expect("a runtime");
            runtime
                .block_on(of_server(ROWS[number(1).unwrap_or(4) as usize].1, number(2).unwrap_or(KEYFRAMES)));
        }
        Some("curves") => crowds::print_curves(),
        Some("crowd") => crowds::measure(&arguments[1], number(2).unwrap_or(1_000)),
        _ => print_table(number(0).unwrap_or(KEYFRAMES)),
    }
}

fn print_table(keyframes: u32) {
    println!("bytes of resident memory a keyframe, {keyframes} keyframes of 700 words");
    println!("{:<40}{:>12}", "a map's index alone", "");
    for (row, (name, _)) in ROWS.iter().enumerate().take(4) {
        print!("{}", again(&["index", &row.to_string(), &keyframes.to_string()], name));
    }
    println!("the server's whole process, without what it takes when empty");
    for (row, (name, _)) in ROWS.iter().enumerate() {
        print!("{}", again(&["server", &row.to_string(), &keyframes.to_string()], name));
    }
}

/// Runs this program again, so that each figure has a process of its own; lines begin with `name`.
fn again(arguments: &[&str], name: &str) -> String {
    let program = std::env::current_exe().expect("the path of this program");
    let output = Command::new(program).args(arguments).output().expect("a process");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8_lossy(&output.stdout);
    let named: Vec<String> = printed.lines().map(|line| format!("  {name:<38}{line}")).collect();
    named.join("\n") + "\n"
}

/// Grows an index by whole keyframes as ingest does, and prints the growth.
fn of_index(sends: Sends, keyframes: u32) {
    let mut index = MapIndex::default();
    let mut robot = Robot::new(sends);
    let before = process::resident_bytes();
    for _ in 0..keyframes {
        ingest(&mut index, &robot.drive());
    }
    print_growth(before, keyframes, "");
    assert_eq!(index.keyframe_count(), keyframes as usize);
}

fn print_growth(before: u64, keyframes: u32, what: &str) {
    let grown = process::resident_bytes().saturating_sub(before);
    println!("{:>12}  {what}", grown / u64::from(keyframes));
}

/// Fills a service with keyframes, opens it anew, and asks it until its caches are full.
async fn of_server(sends: Sends, keyframes: u32) {
    let folder = tempfile::tempdir().expect("a folder");
    let options =
        || ServiceOptions::on(format!("sqlite://{}/memory.db", folder.path().display()), LoopAnswer::bytes);
    let map: MapId = "hotel".parse().expect("an id");
    let service = Service::open(options()).await.expect("a service");
    service
        .put_map(map.clone(), MapProperties { metric: true, ..MapProperties::default() }, None)
        .await
        .expect("a map");
    let before = process::resident_bytes();
    let mut robot = Robot::new(sends);
    let mut sent = 0;
    while sent < keyframes {
        let batch: Vec<NewKeyframe> = (0..AT_ONCE).map(|_| robot.drive()).collect();
        sent += batch.len() as u32;
        let (service, map) = (Arc::new(service.clone()), map.clone());
        let puts = batch.into_iter().map(|keyframe| {
            let (service, map) = (service.clone(), map.clone());
            tokio::spawn(async move { service.put_keyframe(&map, keyframe, [0; 32]).await.map(drop) })
        });
        for put in puts.collect::<Vec<_>>() {
            put.await.expect("a task").expect("a keyframe is stored");
        }
    }
    print_growth(before, sent, "as written");
    if sends.features > 0 {
        for query in 0..QUERIES {
            let keyframe = Robot::id(query * (sent / QUERIES));
            let query = LoopQuery {
                release: None,
                subject: Subject::Stored(keyframe),
                verify: Verify::Auto,
                max_wait_ms: 0,
                seed: 0,
                again: false,
            };
            service.loop_query(&map, query).await.expect("an answer");
        }
        print_growth(before, sent, "and its caches, after 300 loop queries");
    }
    service.close().await;
}
