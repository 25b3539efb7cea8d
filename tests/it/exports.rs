//! Exports: a map as a recording. Played again it is the same map, whatever happened to the first.

use std::process::{Command, Output};

use reqwest::Method;
use serde_json::{Value, json};

use crate::support::{Answer, Server, pose};

async fn run(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_revisit"));
    command.args(args);
    tokio::task::spawn_blocking(move || command.output().unwrap()).await.unwrap()
}

fn expect_success(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// A keyframe at `x` of a corridor that sees points from 10 * x on, a plate among them, and a picture with a crop.
pub fn keyframe(session: &str, seconds: u32, x: f64, plate: &str) -> Value {
    let first = 10 * x as i64;
    let ids: Vec<i64> = (first..first + 24).collect();
    let positions: Vec<[f64; 3]> = ids.iter().map(|id| [*id as f64 * 0.1, 0.3, 3.0 + x * 0.01]).collect();
    let keypoints: Vec<[f64; 4]> = ids.iter().map(|id| [*id as f64 * 7.5, 200.25, 1.0, 30.0]).collect();
    let png =
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";
    json!({
        "session": session,
        "stamp": {"sec": seconds, "nanosec": 7},
        "pose": pose([x, 0.1, 0.0]),
        "camera": {"fx": 525.0, "fy": 525.0, "cx": 320.0, "cy": 240.0, "width": 640, "height": 480},
        "gravity": [0.6, 0.8, 0.0],
        "height_m": 37.5,
        "global_descriptor": {"model": "test", "encoding": "int8", "data": "ZFqwAw=="},
        "bow": {"words": [3, 17, 40 + first, 41 + first], "weights": [0.4, 0.1, 1.0, 0.35]},
        "features": {"descriptor_bytes": 8, "descriptors": base64_zeros(ids.len() * 8), "keypoints": keypoints, "map_points": ids},
        "map_points": {"ids": ids, "positions": positions},
        "observes": [first + 900],
        "detections": [
            {"class": "door_number", "confidence": 0.9, "box": [10, 10, 50, 30.5], "text": plate, "map_points": [first, first + 1, first + 2]},
            {"class": "picture", "confidence": 0.7, "box": [100, 10, 150, 60], "position": [x + 1.0, 0.5, 2.0], "range": "assumed", "crop": png}
        ]
    })
}

fn base64_zeros(bytes: usize) -> String {
    assert_eq!(bytes % 3, 0);
    "A".repeat(bytes / 3 * 4)
}

/// Exports a map of one server into a file, and plays it to another server.
async fn copy(map: &str, from: &Server, to: &Server, file: &str) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(file);
    let file = file.to_str().unwrap();
    expect_success(&run(&["export", map, file, "--server", &from.url("")]).await);
    expect_success(&run(&["replay", file, "--server", &to.url("")]).await);
}

pub async fn exported(server: &Server, map: &str) -> Vec<Value> {
    let text = Answer::text(server.request(Method::GET, &format!("/v1/maps/{map}/export"))).await;
    text.lines().map(|line| serde_json::from_str(line).expect("a line of JSON")).collect()
}

/// Changes that the client's map made to its points and edges.
fn observations() -> Value {
    json!({"session": "robot-1", "replaced": [[23, 24], [910, 30]], "removed": [31],
        "keyframes": [{"keyframe": "kf-0", "observes": [0, 1, 2, 24], "covisible": [{"keyframe": "kf-3", "shared": 20}]}]})
}

/// A map to which everything has happened that a client can do.
pub async fn lived(server: &Server) {
    server
        .put(
            "/v1/maps/m",
            &json!({"description": "two floors", "code_classes": ["tag"], "settings": {"candidates_max": 9}}),
        )
        .await
        .expect(201);
    let rooms = [("kf-0", 0.0, "901"), ("kf-1", 1.0, "902"), ("kf-2", 2.0, "903"), ("kf-3", 3.0, "904")];
    for (number, (id, x, plate)) in rooms.into_iter().enumerate() {
        let seconds = number as u32 + 1;
        server
            .put(&format!("/v1/maps/m/keyframes/{id}"), &keyframe("robot-1", seconds, x, plate))
            .await
            .expect(201);
    }
    server
        .patch("/v1/maps/m", &json!({"settings": {"candidates_max": 20, "building_repeats": false}}))
        .await
        .expect(200);
    let verdict = json!({"operation": "describe", "keyframe": "kf-1", "detection": 1, "text": "a red boat at sea", "source": "model:elsewhere"});
    assert_eq!(server.post("/v1/maps/m/model-verdicts", &verdict).await.expect(200)["applied"], true);
    assert_eq!(server.post("/v1/maps/m/model-verdicts", &verdict).await.expect(200)["applied"], false);
    let corrected = json!({"session": "robot-1", "keyframes": {"ids": ["kf-1", "kf-2"], "poses": [pose([1.1, 0.1, 0.0]), pose([2.3, 0.1, 0.0])]},
        "map_points": {"ids": [12, 5000], "positions": [[1.25, 0.3, 3.1], [0.0, 0.0, 1.0]]}});
    server.post("/v1/maps/m/poses", &corrected).await.expect(200);
    server.post("/v1/maps/m/observations", &observations()).await.expect(200);
    for (id, seconds, x, plate) in
        [("again-0", 60, 0.2, "901"), ("again-1", 61, 1.2, "902"), ("again-3", 62, 3.2, "904")]
    {
        server
            .put(&format!("/v1/maps/m/keyframes/{id}"), &keyframe("robot-2", seconds, x, plate))
            .await
            .expect(201);
    }
    for (id, keyframe, candidate) in [("stays", "again-0", "kf-0"), ("goes", "again-1", "kf-1")] {
        server
            .post(
                "/v1/maps/m/loops",
                &json!({"id": id, "keyframe": keyframe, "candidate": candidate, "query": "q-1"}),
            )
            .await
            .expect(201);
    }
    server.delete("/v1/maps/m/loops/goes").await.expect(200);
    let stored = server.get("/v1/maps/m/keyframes/kf-2").await.expect(200);
    let anchor = stored["detections"][1]["anchor"].as_str().unwrap().to_owned();
    let described = server.request(Method::PATCH, &format!("/v1/maps/m/anchors/{anchor}"));
    let described = described.header("if-match", "*").json(&json!({"description": "a fire hose"}));
    Answer::of(described).await.expect(200);
    let stored = server.get("/v1/maps/m/keyframes/kf-3").await.expect(200);
    let anchor = stored["detections"][1]["anchor"].as_str().unwrap().to_owned();
    server.delete(&format!("/v1/maps/m/anchors/{anchor}")).await.expect(200);
}

/// The verdict about every keyframe of a map, without what a copy has of its own.
pub async fn verdicts(server: &Server, map: &str) -> Vec<Value> {
    let page = server.get(&format!("/v1/maps/{map}/keyframes?limit=1000")).await.expect(200);
    let mut verdicts = Vec::new();
    for keyframe in page["items"].as_array().unwrap() {
        let question = json!({"keyframe": keyframe["id"], "verify": "anchors"});
        let mut verdict = server.post(&format!("/v1/maps/{map}/loop-queries"), &question).await.expect(200);
        for own in ["id", "map_version"] {
            verdict.as_object_mut().unwrap().remove(own);
        }
        verdicts.push(verdict);
    }
    verdicts
}

fn line<'l>(lines: &'l [Value], op: &str, id: &str) -> &'l Value {
    lines.iter().find(|line| line["op"] == op && (id.is_empty() || line["id"] == id)).expect("the line")
}

#[tokio::test(flavor = "multi_thread")]
async fn a_map_is_exported_as_it_was_sent_and_played_again_it_answers_alike() {
    let (first, second) = (Server::start().await, Server::start().await);
    lived(&first).await;
    let lines = exported(&first, "m").await;
    let ops: Vec<&str> = lines.iter().map(|line| line["op"].as_str().unwrap()).collect();
    let expected = [
        "map",
        "keyframe",
        "keyframe",
        "keyframe",
        "keyframe",
        "map",
        "judgement",
        "poses",
        "observations",
        "keyframe",
        "keyframe",
        "keyframe",
        "loop",
        "loop",
        "delete",
        "description",
        "delete",
    ];
    assert_eq!(ops, expected);
    let made =
        json!({"description": "two floors", "code_classes": ["tag"], "settings": {"candidates_max": 9}});
    assert_eq!(lines[0]["body"], made);
    assert_eq!(lines[5]["body"], json!({"settings": {"candidates_max": 20, "building_repeats": false}}));
    // What was corrected since is as it was sent.
    let sent = keyframe("robot-1", 2, 1.0, "902");
    let again = &line(&lines, "keyframe", "kf-1")["body"];
    for field in ["session", "stamp", "pose", "camera", "features", "map_points", "observes", "detections"] {
        let as_numbers = |value: &Value| {
            serde_json::to_string(value).unwrap().replace(".0,", ",").replace(".0]", "]").replace(".0}", "}")
        };
        assert_eq!(as_numbers(&again[field]), as_numbers(&sent[field]), "{field}");
    }
    let poses = &line(&lines, "poses", "")["body"];
    assert_eq!(poses["keyframes"]["ids"], json!(["kf-1", "kf-2"]));
    assert_eq!(poses["keyframes"]["poses"][1]["translation"]["x"], 2.3);
    assert_eq!(
        poses["map_points"],
        json!({"ids": [12, 5000], "positions": [[1.25, 0.3, 3.1], [0.0, 0.0, 1.0]]})
    );
    assert_eq!(line(&lines, "observations", "")["body"], observations());
    assert_eq!(lines[14], json!({"op": "delete", "loop": "goes"}));
    assert_eq!(
        lines[15],
        json!({"op": "description", "keyframe": "kf-2", "detection": 1, "body": {"description": "a fire hose"}})
    );

    copy("m", &first, &second, "m.ndjson.zst").await;
    assert_eq!(exported(&second, "m").await, lines);
    let (copied, original) = (verdicts(&second, "m").await, verdicts(&first, "m").await);
    assert_eq!(original.len(), 7);
    assert!(original.iter().any(|verdict| verdict["verdict"] == "loop"), "{original:#?}");
    assert_eq!(copied, original);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_real_tower_that_is_exported_and_played_again_answers_to_the_byte() {
    let (first, second) = (Server::start().await, Server::start().await);
    let recording = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/recordings/tower.ndjson.zst");
    expect_success(&run(&["replay", recording, "--server", &first.url("")]).await);
    let map = first.get("/v1/maps").await.expect(200)["items"][0]["id"].as_str().unwrap().to_owned();
    copy(&map, &first, &second, "tower.ndjson.gz").await;
    assert!(exported(&second, &map).await == exported(&first, &map).await);
    let (copied, original) = (verdicts(&second, &map).await, verdicts(&first, &map).await);
    assert!(original.len() > 100);
    assert!(copied == original);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_large_correction_is_exported_before_and_after_it_reached_its_rows() {
    let server = Server::with_map("m").await;
    let ids: Vec<i64> = (0..30_000).collect();
    let at = |z: f64| -> Vec<[f64; 3]> { ids.iter().map(|id| [*id as f64 * 0.01, 0.0, z]).collect() };
    let body = json!({"stamp": {"sec": 1, "nanosec": 0}, "pose": pose([0.0; 3]), "map_points": {"ids": ids, "positions": at(1.0)}, "observes": ids});
    server.put("/v1/maps/m/keyframes/a", &body).await.expect(201);
    for z in [2.0, 3.0] {
        let corrected = json!({"map_points": {"ids": ids, "positions": at(z)}});
        server.post("/v1/maps/m/poses", &corrected).await.expect(200);
    }
    // At once, while slices bring them to their rows; and when they have.
    for _ in 0..8 {
        let lines = exported(&server, "m").await;
        let heights: Vec<&Value> =
            lines[1..].iter().map(|line| &line["body"]["map_points"]["positions"][29_999][2]).collect();
        assert_eq!(heights, [1.0, 2.0, 3.0]);
        tokio::time::sleep(std::time::Duration::from_millis(50)).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn deleted_keyframes_are_left_out_and_the_points_that_they_brought_stay() {
    let (first, second) = (Server::start().await, Server::start().await);
    first.put("/v1/maps/m", &json!({})).await.expect(201);
    first.put("/v1/maps/m/keyframes/gone", &keyframe("robot-1", 1, 1.0, "901")).await.expect(201);
    let mut heir = keyframe("robot-1", 2, 1.0, "901");
    heir.as_object_mut().unwrap().remove("map_points");
    first.put("/v1/maps/m/keyframes/heir", &heir).await.expect(201);
    let closed = json!({"id": "l", "keyframe": "heir", "candidate": "gone"});
    first.post("/v1/maps/m/loops", &closed).await.expect(201);
    first.delete("/v1/maps/m/keyframes/gone").await.expect(200);
    let lines = exported(&first, "m").await;
    let names: Vec<(&str, Option<&str>)> =
        lines.iter().map(|line| (line["op"].as_str().unwrap(), line["id"].as_str())).collect();
    assert_eq!(names, [("map", Some("m")), ("keyframe", Some("heir"))]);
    assert_eq!(lines[1]["body"]["map_points"], keyframe("robot-1", 1, 1.0, "901")["map_points"]);
    for line in &lines {
        let path = if line["op"] == "map" { "/v1/maps/m" } else { "/v1/maps/m/keyframes/heir" };
        second.put(path, &line["body"]).await.expect(201);
    }
    assert_eq!(exported(&second, "m").await, lines);
}

#[tokio::test(flavor = "multi_thread")]
async fn settings_that_were_changed_to_and_fro_end_as_they_were() {
    let (first, second) = (Server::start().await, Server::start().await);
    first.put("/v1/maps/m", &json!({})).await.expect(201);
    for repeats in [false, true] {
        first.patch("/v1/maps/m", &json!({"settings": {"building_repeats": repeats}})).await.expect(200);
    }
    copy("m", &first, &second, "m.ndjson").await;
    assert_eq!(second.get("/v1/maps/m").await.expect(200)["settings"]["building_repeats"], true);
    assert_eq!(exported(&second, "m").await, exported(&first, "m").await);
}

#[tokio::test(flavor = "multi_thread")]
async fn without_history_a_map_is_exported_as_last_corrected_with_every_point() {
    let (first, second) = (Server::start().await, Server::start().await);
    first.put("/v1/maps/m", &json!({"settings": {"keep_history": false}})).await.expect(201);
    let mut seen = keyframe("robot-1", 1, 1.0, "901");
    let points = seen.as_object_mut().unwrap().remove("map_points").unwrap();
    let boot = json!({"session": "robot-1", "stamp": {"sec": 0, "nanosec": 0}, "pose": pose([0.0; 3])});
    first.put("/v1/maps/m/keyframes/boot", &boot).await.expect(201);
    // As ORB-SLAM does: the map point is made first, and observed afterwards.
    first.post("/v1/maps/m/poses", &json!({"session": "robot-1", "map_points": points})).await.expect(200);
    first.put("/v1/maps/m/keyframes/seen", &seen).await.expect(201);
    let moved =
        json!({"session": "robot-1", "keyframes": {"ids": ["seen"], "poses": [pose([1.5, 0.1, 0.0])]}});
    first.post("/v1/maps/m/poses", &moved).await.expect(200);
    let lines = exported(&first, "m").await;
    let ops: Vec<&str> = lines.iter().map(|line| line["op"].as_str().unwrap()).collect();
    assert_eq!(ops, ["map", "keyframe", "keyframe"]);
    assert_eq!(lines[2]["body"]["map_points"], points);
    assert_eq!(lines[2]["body"]["pose"]["translation"]["x"], 1.5);
    copy("m", &first, &second, "m.ndjson").await;
    assert_eq!(exported(&second, "m").await, lines);
    assert_eq!(verdicts(&second, "m").await, verdicts(&first, "m").await);
}

#[tokio::test(flavor = "multi_thread")]
async fn corrections_while_a_map_kept_no_history_are_exported_as_one_at_the_end() {
    let (first, second) = (Server::start().await, Server::start().await);
    first.put("/v1/maps/m", &json!({})).await.expect(201);
    first.put("/v1/maps/m/keyframes/kf", &keyframe("robot-1", 1, 1.0, "901")).await.expect(201);
    let correct = |x: f64, points: Value| {
        json!({"session": "robot-1", "keyframes": {"ids": ["kf"], "poses": [pose([x, 0.1, 0.0])]},
            "map_points": points})
    };
    let point = |x: f64| json!({"ids": [0], "positions": [[x, 0.25, 2.5]]});
    first.post("/v1/maps/m/poses", &correct(2.5, point(0.5))).await.expect(200);
    for (kept, x) in [(false, 3.5), (true, 4.5)] {
        let setting = json!({"settings": {"keep_history": kept}});
        first.patch("/v1/maps/m", &setting).await.expect(200);
        first.post("/v1/maps/m/poses", &correct(x, point(x))).await.expect(200);
        let lines = exported(&first, "m").await;
        let poses = || lines.iter().filter(|line| line["op"] == "poses");
        let x_of = |line: &Value| line["body"]["keyframes"]["poses"][0]["translation"]["x"].clone();
        let corrected: Vec<Value> = poses().map(x_of).collect();
        // The last one is of what stands, where no version tells of it.
        assert_eq!(corrected, if kept { [2.5, 4.5] } else { [2.5, 3.5] });
        assert_eq!(lines.last().unwrap()["body"]["map_points"], point(x));
        copy("m", &first, &second, "m.ndjson").await;
        let stored = second.get("/v1/maps/m/keyframes/kf").await.expect(200);
        assert_eq!(stored["pose"]["translation"]["x"], x);
        assert_eq!(verdicts(&second, "m").await, verdicts(&first, "m").await);
        second.delete("/v1/maps/m").await.expect(204);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_command_reads_a_database_beside_its_server_and_after_it_and_overwrites_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    let database = format!("sqlite://{}/test.db", folder.path().display());
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    server.put("/v1/maps/m/keyframes/kf-0", &keyframe("robot-1", 1, 0.0, "901")).await.expect(201);
    let beside = expect_success(&run(&["export", "m", "-", "--database", &database]).await);
    assert_eq!(beside.lines().count(), 2, "{beside}");
    server.stop().await;
    let file = folder.path().join("m.ndjson");
    let name = file.to_str().unwrap();
    expect_success(&run(&["export", "m", name, "--database", &database]).await);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), beside);

    let refused = run(&["export", "m", name, "--database", &database]).await;
    assert!(!refused.status.success() && String::from_utf8_lossy(&refused.stderr).contains("--force"));
    let refused = run(&["export", "other", "-", "--database", &database]).await;
    assert!(!refused.status.success() && String::from_utf8_lossy(&refused.stderr).contains("no map other"));
}

#[tokio::test(flavor = "multi_thread")]
async fn rejects_a_model_verdict_from_elsewhere_with_its_faults() {
    let server = Server::with_map("m").await;
    server.get("/v1/maps/nowhere/export").await.expect(404);
    let faults = [
        (json!({"operation": "guess", "source": "model:x"}), "/operation"),
        (
            json!({"operation": "similarity", "class": "sign", "texts": ["a"], "level": 4, "source": "model:x"}),
            "/texts",
        ),
        (
            json!({"operation": "information", "class": "sign", "texts": ["a"], "level": 6, "source": "model:x"}),
            "/level",
        ),
        (json!({"operation": "merge", "class": "sign", "texts": ["a", "b"], "source": "model:x"}), "/text"),
        (
            json!({"operation": "describe", "keyframe": "kf", "detection": 500, "text": "a", "source": "model:x"}),
            "/detection",
        ),
        (
            json!({"operation": "describe", "keyframe": "kf", "detection": 0, "text": "a", "source": "model:x"}),
            "/keyframe",
        ),
        (json!({"operation": "describe", "keyframe": "kf", "detection": 0, "text": "a"}), "/source"),
    ];
    for (body, pointer) in faults {
        let problem = server.post("/v1/maps/m/model-verdicts", &body).await.expect(422);
        assert!(
            problem["errors"].as_array().unwrap().iter().any(|fault| fault["pointer"] == pointer),
            "{pointer}: {problem}"
        );
    }
}
