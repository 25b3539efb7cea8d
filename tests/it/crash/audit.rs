//! Audit: holds what a writer remembers against what the server has after a restart.

use std::path::Path;

use serde_json::Value;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions as _, Connection as _};

use super::server::{Answer, Api};
use super::writer::{Log, Sent, bulk};

/// Room for an `f32` on the way.
const RELATIVE_TOLERANCE: f64 = 1e-6;

/// SQLite finds nothing wrong with the files as the kill left them.
///
/// It looks at a copy: opening the files themselves would repair them before the server can.
pub(super) async fn database_is_sound(database: &Path) {
    let copy = database.with_extension("copy");
    for suffix in ["", "-wal"] {
        let of = |path: &Path| format!("{}{suffix}", path.display());
        match std::fs::copy(of(database), of(&copy)) {
            Ok(_) => {}
            // Without a write-ahead log; an older one must not stand in for it.
            Err(_) if suffix == "-wal" => drop(std::fs::remove_file(of(&copy))),
            Err(error) => panic!("{}: {error}", of(database)),
        }
    }
    let options = SqliteConnectOptions::new().filename(&copy);
    let mut connection = options.connect().await.expect("a database");
    let faults: Vec<String> =
        sqlx::query_scalar("pragma integrity_check").fetch_all(&mut connection).await.expect("a check");
    assert_eq!(faults, ["ok"]);
    let dangling = sqlx::query("pragma foreign_key_check").fetch_all(&mut connection).await.expect("a check");
    assert!(dangling.is_empty(), "{} rows refer to nothing", dangling.len());
    connection.close().await.expect("a connection of ours");
}

/// Everything acknowledged is there, nothing is there in part, and sending again is harmless.
pub(super) async fn log_is_kept(api: &Api, log: &Log) {
    let there = keyframes_are_whole(api, log).await;
    anchors_know_their_keyframes(api, log).await;
    loops_are_kept(api, log).await;
    for (sent, was_there) in log.keyframes.iter().zip(there) {
        send_again(api, &log.map, sent, was_there).await;
    }
}

/// Whether each keyframe is there: whole, or else never acknowledged.
pub(super) async fn keyframes_are_whole(api: &Api, log: &Log) -> Vec<bool> {
    let mut there = Vec::new();
    for sent in &log.keyframes {
        let path = format!("/v1/maps/{}/keyframes/{}", log.map, sent.id);
        let answer = api.get(&path).await;
        match answer.status {
            200 => assert_whole(&sent.body, &answer, &path),
            404 => assert!(!sent.acknowledged, "{path}: acknowledged, and lost"),
            other => panic!("{path}: {other} {}", answer.text()),
        }
        there.push(answer.status == 200);
    }
    there
}

/// Every field that was sent reads back as it was sent.
fn assert_whole(sent: &Value, answer: &Answer, path: &str) {
    let kept = answer.json();
    for (name, value) in sent.as_object().expect("a body is an object") {
        let kept = &kept[name];
        assert!(same(value, kept), "{path}: {name} was {value} and is {kept}");
    }
}

/// The same numbers, however they are written; fields that the server adds are its own.
fn same(sent: &Value, kept: &Value) -> bool {
    match (sent, kept) {
        (Value::Object(sent), Value::Object(kept)) => {
            sent.iter().all(|(name, value)| kept.get(name).is_some_and(|kept| same(value, kept)))
        }
        (Value::Array(sent), Value::Array(kept)) => {
            sent.len() == kept.len() && sent.iter().zip(kept).all(|(sent, kept)| same(sent, kept))
        }
        (Value::Number(sent), Value::Number(kept)) => {
            let numbers = sent.as_f64().zip(kept.as_f64());
            numbers
                .is_some_and(|(sent, kept)| (sent - kept).abs() <= RELATIVE_TOLERANCE * sent.abs().max(1.0))
        }
        _ => sent == kept,
    }
}

/// An acknowledged detection is in the anchor that it was said to feed, or in what that became.
async fn anchors_know_their_keyframes(api: &Api, log: &Log) {
    for sent in &log.keyframes {
        for anchor in &sent.anchors {
            let anchor = living_anchor(api, &log.map, anchor).await;
            let keyframes = anchor["keyframes"].as_array().into_iter().flatten();
            let knows = keyframes.into_iter().any(|keyframe| *keyframe == *sent.id);
            assert!(knows, "{} of {} is not in {anchor}", sent.id, log.map);
        }
    }
}

/// Follows the merges.
async fn living_anchor(api: &Api, map: &str, anchor: &str) -> Value {
    let mut id = anchor.to_owned();
    loop {
        let path = format!("/v1/maps/{map}/anchors/{id}");
        let answer = api.get(&path).await;
        assert_eq!(answer.status, 200, "{path}: {}", answer.text());
        let anchor = answer.json();
        match anchor["merged_into"].as_str() {
            Some(into) => into.clone_into(&mut id),
            None => return anchor,
        }
    }
}

async fn loops_are_kept(api: &Api, log: &Log) {
    let kept = loop_ids(api, &log.map).await;
    for sent in log.loops.iter().filter(|sent| sent.acknowledged) {
        assert!(kept.contains(&sent.id), "{} of {}: acknowledged, and lost", sent.id, log.map);
    }
}

async fn loop_ids(api: &Api, map: &str) -> Vec<String> {
    let mut ids = Vec::new();
    let mut cursor = String::new();
    loop {
        let answer = api.get(&format!("/v1/maps/{map}/loops{cursor}")).await;
        assert_eq!(answer.status, 200, "{}", answer.text());
        let page = answer.json();
        let items = page["items"].as_array().into_iter().flatten();
        let page_ids = items.filter_map(|item| item["id"].as_str());
        ids.extend(page_ids.map(str::to_owned));
        match page["next_cursor"].as_str() {
            Some(next) => cursor = format!("?cursor={next}"),
            None => return ids,
        }
    }
}

/// A retry of what is there is recognised, and of what is not there is taken.
async fn send_again(api: &Api, map: &str, sent: &Sent, was_there: bool) {
    let expected = if was_there { 200 } else { 201 };
    if sent.bulk {
        let path = format!("/v1/maps/{map}/keyframes");
        let request = bulk(api, &path, sent.as_bulk_line());
        let answer = Answer::unless_gone(request).await.expect("an answer");
        assert_eq!(answer.json()["status"], expected, "{}: {}", sent.id, answer.text());
    } else {
        let path = format!("/v1/maps/{map}/keyframes/{}", sent.id);
        let answer = api.put(&path, &sent.body).await;
        assert_eq!(answer.status, expected, "{path}: {}", answer.text());
        assert_eq!(answer.replayed, was_there, "{path}");
    }
}
