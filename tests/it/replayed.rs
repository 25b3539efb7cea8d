//! Replayed: every operation of a recording, played by the command against a real server, leaves there what it says.

use std::process::{Command, Output};

use serde_json::{Value, json};

use crate::support::{Server, pose};

/// A keyframe that sees a sign at every two metres.
fn keyframe(id: &str, seconds: u32, signs: &[&str]) -> Value {
    let detections: Vec<Value> = (0..)
        .zip(signs)
        .map(|(index, text)| {
            json!({"class": "sign", "confidence": 0.9, "box": [10, 10, 50, 30], "text": text,
                "position": [f64::from(index) * 2.0, 0.0, 3.0]})
        })
        .collect();
    let body = json!({"stamp": {"sec": seconds, "nanosec": 0}, "pose": pose([0.0, 0.0, 0.0]), "covisible": [],
        "detections": detections});
    json!({"op": "keyframe", "id": id, "body": body})
}

/// Plays a recording against a server; the command runs beside the server's own threads.
async fn replay(server: &Server, lines: &[Value]) -> Output {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let path = directory.path().join("recording.ndjson");
    let written: Vec<String> = lines.iter().map(Value::to_string).collect();
    std::fs::write(&path, written.join("\n")).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_revisit"));
    command.arg("replay").arg(&path).args(["--server", &server.url("")]);
    tokio::task::spawn_blocking(move || command.output().unwrap()).await.unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn every_operation_of_a_recording_leaves_in_the_map_what_it_says() {
    let server = Server::start().await;
    let output = replay(
        &server,
        &[
            json!({"op": "map", "id": "m", "body": {"settings": {"candidates_max": 3}}}),
            keyframe("k1", 1, &["901", "STAIR B", "903"]),
            keyframe("k2", 2, &["905"]),
            keyframe("k3", 3, &["907"]),
            json!({"op": "query", "keyframe": "k3", "truth": []}),
            json!({"op": "loop", "body": {"id": "stays", "keyframe": "k3", "candidate": "k1"}}),
            json!({"op": "loop", "body": {"id": "goes", "keyframe": "k3", "candidate": "k1"}}),
            json!({"op": "poses", "body": {"session": "default",
                "keyframes": {"ids": ["k3"], "poses": [pose([5.0, 0.0, 0.0])]}}}),
            json!({"op": "description", "keyframe": "k1", "detection": 1, "body": {"description": "a fire hose"}}),
            json!({"op": "delete", "keyframe": "k1", "detection": 2}),
            json!({"op": "delete", "keyframe": "k2"}),
            json!({"op": "delete", "loop": "goes"}),
            json!({"op": "map", "id": "m", "body": {"settings": {"candidates_max": 7}}}),
        ],
    )
    .await;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

    let map = server.get("/v1/maps/m").await.expect(200);
    assert_eq!(map["settings"]["candidates_max"], 7);
    let anchors = server.get("/v1/maps/m/anchors").await.expect(200);
    let described: Vec<&Value> =
        anchors["items"].as_array().unwrap().iter().map(|anchor| &anchor["description"]).collect();
    assert_eq!(described, ["901", "a fire hose", "907"]);
    server.get("/v1/maps/m/keyframes/k2").await.expect(404);
    let moved = server.get("/v1/maps/m/keyframes/k3").await.expect(200);
    assert_eq!(moved["pose"]["translation"]["x"], 5.0);
    let loops = server.get("/v1/maps/m/loops").await.expect(200);
    let standing: Vec<&Value> =
        loops["items"].as_array().unwrap().iter().map(|closed| &closed["id"]).collect();
    assert_eq!(standing, ["stays"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_detection_that_feeds_no_anchor_is_refused_with_its_line() {
    let server = Server::start().await;
    let output = replay(
        &server,
        &[
            json!({"op": "map", "id": "m"}),
            keyframe("k1", 1, &["901"]),
            json!({"op": "delete", "keyframe": "k1", "detection": 1}),
        ],
    )
    .await;
    assert!(!output.status.success());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("line 3") && said.contains("detection 1 of k1 of m"), "{said}");
}
