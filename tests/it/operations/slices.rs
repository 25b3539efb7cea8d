//! Slices: large deletions and corrections are answered at once, and a crash in the middle of their slices undoes nothing.

use std::path::Path;

use reqwest::Method;
use serde_json::{Value, json};

use super::{keyframe, revisit, sound, url};
use crate::crash::server::{Api, Server};

/// Enough for a correction to be deferred, and for a deletion to take several slices.
const KEYFRAMES: u64 = 500;

async fn build(api: &Api, map: &str) {
    assert_eq!(api.put(&format!("/v1/maps/{map}"), &json!({})).await.status, 201);
    let line = |number: u64| {
        let mut body = keyframe("a", number);
        body["id"] = json!(format!("kf-{number}"));
        body.to_string()
    };
    let lines: Vec<String> = (0..KEYFRAMES).map(line).collect();
    let request = api.request(Method::POST, &format!("/v1/maps/{map}/keyframes"));
    let answer = request.header("content-type", "application/x-ndjson").body(lines.join("\n")).send().await;
    assert_eq!(answer.unwrap().status(), 200);
}

async fn delete(api: &Api, path: &str) -> u16 {
    api.request(Method::DELETE, path).send().await.unwrap().status().as_u16()
}

fn correction(height: f64) -> Value {
    let pose = |number: u64| {
        json!({"translation": {"x": number as f64 * 0.5, "y": height, "z": 0.0},
            "rotation": {"x": 0.5, "y": 0.5, "z": 0.5, "w": 0.5}})
    };
    let points = 0..KEYFRAMES * 10;
    json!({
        "session": "a",
        "keyframes": {"ids": (0..KEYFRAMES).map(|n| format!("kf-{n}")).collect::<Vec<_>>(),
            "poses": (0..KEYFRAMES).map(pose).collect::<Vec<_>>()},
        "map_points": {"ids": points.clone().collect::<Vec<_>>(),
            "positions": points.map(|n| [n as f64 * 0.0625, height, 2.0]).collect::<Vec<_>>()},
    })
}

/// The heights of a keyframe, of a map point, and of a detection known by its position.
async fn heights(api: &Api, number: u64) -> [f64; 3] {
    let answer = api.get(&format!("/v1/maps/tower/keyframes/kf-{number}")).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let body = answer.json();
    // A detection's position was moved by arithmetic.
    let height = |pointer: &str| (body.pointer(pointer).and_then(Value::as_f64).unwrap() * 1e6).round() / 1e6;
    [height("/pose/translation/y"), height("/map_points/positions/0/1"), height("/detections/1/position/1")]
}

async fn is_sound(database: &Path) -> (u64, u64) {
    let found = sound(database).await;
    let holds = found.holds.unwrap();
    (holds.maps, holds.keyframes)
}

#[tokio::test(flavor = "multi_thread")]
async fn large_corrections_are_read_back_at_once_and_after_a_crash_in_their_order() {
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("revisit.db");
    let mut server = Server::start(&database);
    build(server.api(), "tower").await;
    for height in [1.0, 3.0] {
        let answer = server.api().post("/v1/maps/tower/poses", &correction(height)).await;
        assert_eq!(answer.status, 200, "{}", answer.text());
        assert_eq!(heights(server.api(), KEYFRAMES - 1).await, [height, height, 0.5 + height]);
    }
    // A small one follows behind them.
    let last = json!({"session": "a", "map_points": {"ids": [0], "positions": [[0.0, 7.0, 2.0]]}});
    assert_eq!(server.api().post("/v1/maps/tower/poses", &last).await.status, 200);
    server.kill();
    assert_eq!(is_sound(&database).await, (1, KEYFRAMES));
    let mut server = Server::start(&database);
    assert_eq!(heights(server.api(), 0).await, [3.0, 7.0, 3.5]);
    for number in [1, 250, KEYFRAMES - 1] {
        assert_eq!(heights(server.api(), number).await, [3.0, 3.0, 3.5]);
    }
    assert!(server.terminate().success());
    assert_eq!(is_sound(&database).await, (1, KEYFRAMES));
}

#[tokio::test(flavor = "multi_thread")]
async fn the_name_of_a_deleted_map_is_free_at_once_and_its_rows_come_back_from_no_crash_and_no_backup() {
    let folder = tempfile::tempdir().unwrap();
    let (database, backup) = (folder.path().join("revisit.db"), folder.path().join("backup.db"));
    let mut server = Server::start(&database);
    build(server.api(), "tower").await;
    assert_eq!(server.api().post("/v1/maps/tower/poses", &correction(1.0)).await.status, 200);
    assert_eq!(delete(server.api(), "/v1/maps/tower").await, 204);
    assert_eq!(server.api().get("/v1/maps/tower").await.status, 404);
    assert_eq!(server.api().get("/v1/maps").await.json()["items"], json!([]));
    assert_eq!(server.api().put("/v1/maps/tower", &json!({"description": "new"})).await.status, 201);
    let answer = server.api().put("/v1/maps/tower/keyframes/kf-0", &keyframe("a", 0)).await;
    assert_eq!(answer.status, 201, "{}", answer.text());
    server.kill();
    assert_eq!(is_sound(&database).await, (1, 1));
    revisit(&["backup", "--database", &url(&database), &backup.display().to_string()]).well();
    let restored = folder.path().join("restored.db");
    revisit(&["restore", "--database", &url(&restored), &backup.display().to_string()]).well();
    for database in [&database, &restored] {
        let mut server = Server::start(database);
        assert_eq!(heights(server.api(), 0).await, [0.0, 1.0, 0.5]);
        let page = server.api().get("/v1/maps/tower/keyframes").await.json();
        assert_eq!(page["items"].as_array().map(Vec::len), Some(1));
        assert!(server.terminate().success());
        assert_eq!(is_sound(database).await, (1, 1));
    }
}
