//! Erasures over HTTP: no byte of what was erased is left in the database, its log or the next backup.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use reqwest::Method;
use serde_json::{Value, json};

use crate::exports::{keyframe, lived};
use crate::support::{Answer, Server, pose};

const MAP: &str = "/v1/maps/m";

/// Texts, and bytes as they lie in rows, that nothing else has.
fn markers() -> Vec<(&'static str, Vec<u8>)> {
    let text = |text: &'static str| (text, text.as_bytes().to_vec());
    // Rows pack them one way round, and the log the other.
    let double =
        |name, value: f64| [(name, value.to_le_bytes().to_vec()), (name, value.to_be_bytes().to_vec())];
    let mut markers = vec![
        text("kf-zanzibar-1"),
        text("kf-zanzibar-2"),
        text("session-zanzibar"),
        text("Zanzibar Suite 4711"),
        text("Zanzibar written by hand"),
        text("loop-zanzibar"),
        ("a descriptor", DESCRIPTOR.to_vec()),
    ];
    markers.extend(double("a pose as sent", 7777.125));
    markers.extend(double("a pose as corrected", 8888.375));
    markers.extend(double("a point as sent", 6666.0625));
    markers.extend(double("a point as corrected", 5555.1875));
    markers
}

const DESCRIPTOR: &[u8; 8] = b"\xf3\x91zanz\x07\xe5";

fn secret(seconds: u32, x: f64) -> Value {
    let mut body = keyframe("session-zanzibar", seconds, 3.0, "904");
    body["pose"] = pose([x, 0.1, 0.0]);
    let count = body["features"]["keypoints"].as_array().unwrap().len();
    body["features"]["descriptors"] = json!(base64(&DESCRIPTOR.repeat(count)));
    // Other sessions have a point of this number as well.
    body["map_points"]["positions"][10][0] = json!(6666.0625);
    body["detections"][0]["text"] = json!("Zanzibar Suite 4711");
    // A picture that no other robot sees.
    body["detections"][1]["position"] = json!([x, 0.5, 2.0]);
    body
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    assert_eq!(bytes.len() % 3, 0);
    let group = |three: &[u8]| {
        let number = three.iter().fold(0_usize, |number, byte| number << 8 | usize::from(*byte));
        [18, 12, 6, 0].map(|shift| char::from(LETTERS[number >> shift & 63]))
    };
    bytes.chunks(3).flat_map(group).collect()
}

/// The markers that any file of a folder holds.
fn found(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let bytes = fs::read(&path).unwrap();
        for (name, marker) in markers() {
            if bytes.windows(marker.len()).any(|window| window == marker) {
                found.push(format!("{name} in {}", path.file_name().unwrap().display()));
            }
        }
    }
    found
}

/// A map with a robot's secrets in every kind of row, and a release of it.
async fn with_secrets(server: &Server) {
    lived(server).await;
    for (id, seconds, x) in [("kf-zanzibar-1", 100, 7777.125), ("kf-zanzibar-2", 101, 7777.625)] {
        server.put(&format!("{MAP}/keyframes/{id}"), &secret(seconds, x)).await.expect(201);
    }
    let corrected = json!({"session": "session-zanzibar",
        "keyframes": {"ids": ["kf-zanzibar-1"], "poses": [pose([8888.375, 0.1, 0.0])]},
        "map_points": {"ids": [40], "positions": [[5555.1875, 0.3, 3.03]]}});
    server.post(&format!("{MAP}/poses"), &corrected).await.expect(200);
    let stored = server.get(&format!("{MAP}/keyframes/kf-zanzibar-1")).await.expect(200);
    let anchor = stored["detections"][1]["anchor"].as_str().unwrap();
    let described = server.request(Method::PATCH, &format!("{MAP}/anchors/{anchor}"));
    let described =
        described.header("if-match", "*").json(&json!({"description": "Zanzibar written by hand"}));
    Answer::of(described).await.expect(200);
    let query = server.post(&format!("{MAP}/loop-queries"), &json!({"keyframe": "kf-zanzibar-1"})).await;
    let query = query.expect(200)["id"].clone();
    let closed =
        json!({"id": "loop-zanzibar", "keyframe": "kf-zanzibar-1", "candidate": "kf-3", "query": query});
    server.post(&format!("{MAP}/loops"), &closed).await.expect(201);
    server.put(&format!("{MAP}/releases/r"), &json!({})).await.expect(201);
    let of_release = json!({"keyframe": "kf-zanzibar-2", "release": "r"});
    server.post(&format!("{MAP}/loop-queries"), &of_release).await.expect(200);
}

async fn done(server: &Server, id: &str) -> Value {
    loop {
        let erasure = server.get(&format!("{MAP}/erase/{id}")).await.expect(200);
        if erasure["state"] == "done" {
            return erasure;
        }
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}

async fn erased(what: Value) {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    with_secrets(&server).await;
    let before = found(folder.path());
    for (name, _) in markers() {
        assert!(before.iter().any(|line| line.starts_with(name)), "{name} is looked for in vain: {before:?}");
    }

    let asked = server.post(&format!("{MAP}/erase"), &what).await.expect(202);
    assert_eq!(asked["id"], "e-1", "{asked:#}");
    let erasure = done(&server, "e-1").await;
    assert_eq!((&erasure["keyframes"], &erasure["releases"]), (&json!(2), &json!(1)), "{erasure:#}");
    let sessions_stay = what.get("keyframes").is_some();
    let left = |folder: &Path| {
        let mut found = found(folder);
        // Only keyframes were to be erased: the name of their robot stays.
        found.retain(|line| !(sessions_stay && line.starts_with("session-zanzibar")));
        found
    };
    assert_eq!(left(folder.path()), Vec::<String>::new());

    // The rest lives on, in the map and in its release.
    let map = server.get(MAP).await.expect(200);
    assert_eq!((&map["keyframes"], &map["loops"]), (&json!(7), &json!(1)), "{map:#}");
    let release = server.get(&format!("{MAP}/releases/r")).await.expect(200);
    assert_eq!(release["keyframes"], 7, "{release:#}");
    assert_eq!(release["erasures"], 1);
    for release in [json!(null), json!("r")] {
        let mut question = json!({"keyframe": "kf-0"});
        if !release.is_null() {
            question["release"] = release;
        }
        server.post(&format!("{MAP}/loop-queries"), &question).await.expect(200);
    }
    server.put(&format!("{MAP}/keyframes/after"), &keyframe("robot-3", 300, 2.0, "905")).await.expect(201);
    server.event(&format!("{MAP}/events?since=0"), |_| true).await;

    let backups = tempfile::tempdir().unwrap();
    let (database, backup) = (folder.path().join("test.db"), backups.path().join("backup.db"));
    let run = |args: [String; 4]| {
        let output = Command::new(env!("CARGO_BIN_EXE_revisit")).args(args).output().unwrap();
        assert!(output.status.success(), "{output:?}");
    };
    let url = format!("sqlite://{}", database.display());
    tokio::task::spawn_blocking(move || {
        run(["backup".to_owned(), backup.display().to_string(), "--database".to_owned(), url.clone()]);
        let check =
            Command::new(env!("CARGO_BIN_EXE_revisit")).args(["check", "--database", &url]).output().unwrap();
        assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
    })
    .await
    .unwrap();
    assert_eq!(left(backups.path()), Vec::<String>::new());
    server.stop().await;
    assert_eq!(left(folder.path()), Vec::<String>::new());
}

#[tokio::test(flavor = "multi_thread")]
async fn no_byte_of_an_erased_session_is_left_in_database_log_or_backup() {
    erased(json!({"sessions": ["session-zanzibar"]})).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn no_byte_of_erased_keyframes_is_left_in_database_log_or_backup() {
    erased(json!({"keyframes": ["kf-zanzibar-1", "kf-zanzibar-2"]})).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn what_was_deleted_before_is_erased_from_what_is_left_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    with_secrets(&server).await;
    for id in ["kf-zanzibar-1", "kf-zanzibar-2"] {
        server.delete(&format!("{MAP}/keyframes/{id}")).await.expect(200);
    }
    assert_ne!(found(folder.path()), Vec::<String>::new());
    let what = json!({"keyframes": ["kf-zanzibar-1", "kf-zanzibar-2"]});
    server.post(&format!("{MAP}/erase"), &what).await.expect(202);
    server.post(&format!("{MAP}/erase"), &json!({"sessions": ["session-zanzibar"]})).await.expect(202);
    assert_eq!(done(&server, "e-1").await["keyframes"], 0);
    done(&server, "e-2").await;
    assert_eq!(found(folder.path()), Vec::<String>::new());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_session_is_erased_with_what_merged_into_it_and_with_its_names_in_loops() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    with_secrets(&server).await;
    let merge = json!({"into": "session-zanzibar-too", "into_from_session": pose([0.0, 0.0, 0.0])});
    server.post(&format!("{MAP}/sessions/session-zanzibar/merge"), &merge).await.expect(200);
    // Its loop keeps the names of both keyframes when one is deleted.
    server.delete(&format!("{MAP}/keyframes/kf-zanzibar-1")).await.expect(200);
    let old = json!({"sessions": ["session-zanzibar"]});
    let refused = server.post(&format!("{MAP}/erase"), &old).await;
    assert_eq!(refused.pointers(), ["/sessions/0"]);
    server.post(&format!("{MAP}/erase"), &json!({"sessions": ["session-zanzibar-too"]})).await.expect(202);
    assert_eq!(done(&server, "e-1").await["keyframes"], 1);
    // The release was published before the merge: there the session goes by its old name, and is erased all the same.
    server.post(&format!("{MAP}/erase"), &json!({"keyframes": ["kf-zanzibar-1"]})).await.expect(202);
    done(&server, "e-2").await;
    let mut left = found(folder.path());
    // The loop is of a keyframe that was deleted before; its own id is the client's.
    left.retain(|line| !line.starts_with("loop-zanzibar"));
    assert_eq!(left, Vec::<String>::new());
    let last = server.get(MAP).await.expect(200)["map_version"].as_u64().unwrap();
    assert!(last > 1);

    // Numbers of events are not given again, though the events were erased.
    let events = server.request(Method::GET, &format!("{MAP}/events")).header("last-event-id", 9);
    assert_eq!(events.send().await.unwrap().status(), 410, "erased");
    server.delete(MAP).await.expect(204);
    server.put(MAP, &json!({})).await.expect(201);
    let events = server.request(Method::GET, &format!("{MAP}/events")).header("last-event-id", 9);
    assert_eq!(events.send().await.unwrap().status(), 410, "of a map that was deleted");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_session_that_a_release_knows_as_a_part_of_another_is_erased_with_it_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    with_secrets(&server).await;
    server.delete(&format!("{MAP}/releases/r")).await.expect(204);
    let merge = json!({"into": "session-zanzibar-too", "into_from_session": pose([0.0, 0.0, 0.0])});
    let path = format!("{MAP}/sessions/session-zanzibar/merge");
    server.post(&path, &merge).await.expect(200);
    server.put(&format!("{MAP}/releases/joined"), &json!({})).await.expect(201);
    server.delete(&path).await.expect(200);
    // In the map it stands by itself again; in the release nobody can tell its keyframes from the others.
    let alone = server.post(&format!("{MAP}/erase"), &json!({"sessions": ["session-zanzibar"]})).await;
    assert_eq!(alone.pointers(), ["/sessions/0"]);
    assert!(alone.body.to_string().contains("release joined"), "{alone:#?}");
    let both = json!({"sessions": ["session-zanzibar-too"]});
    server.post(&format!("{MAP}/erase"), &both).await.expect(202);
    let told = done(&server, "e-1").await;
    assert_eq!((&told["keyframes"], &told["releases"]), (&json!(2), &json!(1)), "{told:#}");
    let mut left = found(folder.path());
    left.retain(|line| !line.starts_with("loop-zanzibar"));
    assert_eq!(left, Vec::<String>::new());
}

#[tokio::test(flavor = "multi_thread")]
async fn what_a_session_left_beside_its_keyframes_is_erased_with_it() {
    const NUMBER: i64 = 4_711_008_154_711;
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    lived(&server).await;
    // It asks a release in which it has no keyframe.
    server.put(&format!("{MAP}/releases/r"), &json!({})).await.expect(201);
    let asked = json!({"inline": secret(100, 7777.125), "release": "r"});
    server.post(&format!("{MAP}/loop-queries"), &asked).await.expect(200);
    server.put(&format!("{MAP}/keyframes/kf-zanzibar-1"), &secret(100, 7777.125)).await.expect(201);
    // No keyframe observes the point that is corrected, nor the one that is culled.
    let corrected = json!({"session": "session-zanzibar",
        "map_points": {"ids": [4711], "positions": [[5555.1875, 0.3, 3.03]]}});
    server.post(&format!("{MAP}/poses"), &corrected).await.expect(200);
    let culled = json!({"session": "session-zanzibar", "removed": [NUMBER]});
    server.post(&format!("{MAP}/observations"), &culled).await.expect(200);
    let holds_number = || {
        let files =
            fs::read_dir(folder.path()).unwrap().map(|entry| fs::read(entry.unwrap().path()).unwrap());
        let forms =
            [NUMBER.to_string().into_bytes(), NUMBER.to_le_bytes().to_vec(), NUMBER.to_be_bytes().to_vec()];
        files
            .into_iter()
            .any(|file| forms.iter().any(|form| file.windows(form.len()).any(|bytes| bytes == form)))
    };
    assert!(holds_number() && !found(folder.path()).is_empty());
    server.post(&format!("{MAP}/erase"), &json!({"sessions": ["session-zanzibar"]})).await.expect(202);
    done(&server, "e-1").await;
    assert_eq!(found(folder.path()), Vec::<String>::new());
    assert!(!holds_number());
    let release = server.get(&format!("{MAP}/releases/r")).await.expect(200);
    assert!(!release.to_string().contains("zanzibar"), "{release:#}");
}

#[tokio::test]
async fn a_session_whose_frame_a_plan_has_is_not_erased() {
    let server = Server::with_map("m").await;
    let sign =
        json!({"frame": "plan", "class": "door_number", "description": "901", "position": [0.0, 0.0, 1.0]});
    server.put(&format!("{MAP}/anchors/door"), &sign).await.expect(201);
    let refused = server.post(&format!("{MAP}/erase"), &json!({"sessions": ["a", "plan"]})).await;
    assert_eq!(refused.pointers(), ["/sessions/1"]);
    server.delete(&format!("{MAP}/anchors/door")).await.expect(200);
    server.post(&format!("{MAP}/erase"), &json!({"sessions": ["plan"]})).await.expect(202);
    done(&server, "e-1").await;
}

#[tokio::test]
async fn what_cannot_be_erased_is_refused_by_its_place() {
    let server = Server::with_map("m").await;
    for (body, at) in [
        (json!({}), ""),
        (json!({"keyframes": ["a"], "sessions": ["b"]}), ""),
        (json!({"keyframes": []}), "/keyframes"),
        (json!({"sessions": ["a/b"]}), "/sessions/0"),
        (json!({"sessions": ["a"], "all": true}), "/all"),
    ] {
        assert_eq!(server.post(&format!("{MAP}/erase"), &body).await.pointers(), [at], "{body}");
    }
    server.post("/v1/maps/none/erase", &json!({"sessions": ["a"]})).await.expect(404);
    for id in ["e-1", "1", "e-x"] {
        server.get(&format!("{MAP}/erase/{id}")).await.expect(404);
    }
    // A session that nobody drove is erased as well.
    server.post(&format!("{MAP}/erase"), &json!({"sessions": ["nobody"]})).await.expect(202);
    done(&server, "e-1").await;
}
