//! Observations over HTTP: a client's map fuses and culls points, and finds edges, after it has sent the keyframes.

use serde_json::{Value, json};

use crate::support::{Server, keyframe, pose};

const MAP: &str = "/v1/maps/m";

/// A keyframe that sees these points, the first three of them on a plate.
fn seeing(sec: i64, points: std::ops::Range<i64>, plate: &str) -> Value {
    let ids: Vec<i64> = points.clone().collect();
    let positions: Vec<[f64; 3]> = ids.iter().map(|id| [(id % 100) as f64 * 0.1, 0.3, 3.0]).collect();
    json!({
        "stamp": {"sec": sec, "nanosec": 0},
        "pose": pose([0.0, 0.0, 0.0]),
        "bow": {"words": [3, 17], "weights": [0.4, 0.6]},
        "observes": ids,
        "map_points": {"ids": ids, "positions": positions},
        "detections": [{"class": "door_number", "confidence": 0.9, "box": [10, 10, 50, 30], "text": plate,
            "map_points": [ids[0], ids[1], ids[2]]}]
    })
}

fn fused(old: std::ops::Range<i64>, by: i64) -> Value {
    old.map(|id| json!([id, id - by])).collect()
}

async fn put(server: &Server, id: &str, body: &Value) -> Value {
    server.put(&format!("{MAP}/keyframes/{id}"), body).await.expect(201)
}

async fn ask(server: &Server, keyframe: &str) -> Value {
    let query = json!({"keyframe": keyframe, "verify": "anchors"});
    server.post(&format!("{MAP}/loop-queries"), &query).await.expect(200)
}

async fn shared(server: &Server, keyframe: &str) -> Value {
    let path = format!("{MAP}/keyframes/{keyframe}/covisible");
    server.get(&path).await.expect(200)["items"].take()
}

#[tokio::test]
async fn what_the_clients_map_has_fused_is_covisible_and_no_loop() {
    let server = Server::with_map("m").await;
    // Tracking took the points of the second for new ones: the same wall, and the same plate.
    let sent = [seeing(1, 0..20, "901"), seeing(2, 100..120, "901")];
    put(&server, "kf-1", &sent[0]).await;
    put(&server, "kf-2", &sent[1]).await;
    let before = ask(&server, "kf-2").await;
    assert_eq!(before["verdict"], "loop", "{before:#}");
    assert_eq!(before["best"], "kf-1");
    assert_eq!(shared(&server, "kf-2").await, json!([]));
    let anchors = async || server.get(&format!("{MAP}/anchors")).await.expect(200)["items"].clone();
    assert_eq!(anchors().await.as_array().map(Vec::len), Some(2));

    let body = json!({"replaced": fused(100..120, 100)});
    let answer = server.post(&format!("{MAP}/observations"), &body).await.expect(200);
    let counts = ["keyframes", "map_points", "anchors_merged"].map(|name| answer[name].as_u64());
    assert_eq!(counts, [Some(1), Some(20), Some(1)], "{answer:#}");
    assert_eq!(shared(&server, "kf-2").await, json!([{"keyframe": "kf-1", "shared": 20}]));
    let after = ask(&server, "kf-2").await;
    assert_eq!(
        (&after["verdict"], &after["excluded_covisible"]),
        (&json!("no_loop"), &json!(1)),
        "{after:#}"
    );
    assert_eq!(after["candidates"], json!([]));
    let now = anchors().await;
    assert_eq!(now.as_array().map(Vec::len), Some(1), "{now:#}");
    assert_eq!((&now[0]["keyframes"], &now[0]["map_points"]), (&json!(["kf-1", "kf-2"]), &json!(3)));
    let read = server.get(&format!("{MAP}/keyframes/kf-2")).await.expect(200);
    assert_eq!(read["observes"], json!((0..20).collect::<Vec<i64>>()));
    assert_eq!(read["detections"][0]["map_points"], json!([0, 1, 2]));

    // A retry of the keyframe is still the same, and one of the request changes nothing.
    let again = server.put(&format!("{MAP}/keyframes/kf-2"), &sent[1]).await;
    assert_eq!(again.header("idempotent-replayed"), "true");
    again.expect(200);
    let again = server.post(&format!("{MAP}/observations"), &body).await.expect(200);
    assert_eq!(["keyframes", "map_points", "anchors_merged"].map(|name| again[name].as_u64()), [Some(0); 3]);
    assert_eq!(anchors().await, now);
}

#[tokio::test]
async fn culled_points_and_declared_edges_count_and_a_keyframe_observes_what_is_listed() {
    let server = Server::with_map("m").await;
    for (number, id) in ["kf-1", "kf-2", "kf-3"].into_iter().enumerate() {
        let first = if id == "kf-3" { 500 } else { 0 };
        put(&server, id, &seeing(number as i64, first..first + 20, "901")).await;
    }
    assert_eq!(shared(&server, "kf-1").await, json!([{"keyframe": "kf-2", "shared": 20}]));
    // Fourteen are not enough.
    let body = json!({
        "removed": [5, 6],
        "keyframes": [
            {"keyframe": "kf-2", "observes": (0..16).filter(|id| ![5, 6].contains(id)).collect::<Vec<i64>>()},
            {"keyframe": "kf-1", "covisible": [{"keyframe": "kf-3", "shared": 31}]}
        ]
    });
    server.post(&format!("{MAP}/observations"), &body).await.expect(200);
    assert_eq!(shared(&server, "kf-1").await, json!([{"keyframe": "kf-3", "shared": 31}]));
    assert_eq!(shared(&server, "kf-2").await, json!([]));
    // Declared besides, and with another number.
    let edges = json!([{"keyframe": "kf-2", "shared": 9}, {"keyframe": "kf-3", "shared": 30}]);
    let body = json!({"keyframes": [{"keyframe": "kf-1", "covisible": edges}]});
    server.post(&format!("{MAP}/observations"), &body).await.expect(200);
    let expected = json!([{"keyframe": "kf-3", "shared": 30}, {"keyframe": "kf-2", "shared": 9}]);
    assert_eq!(shared(&server, "kf-1").await, expected);
    server.delete(&format!("{MAP}/keyframes/kf-3")).await.expect(200);
    assert_eq!(shared(&server, "kf-1").await, json!([{"keyframe": "kf-2", "shared": 9}]));
}

#[tokio::test]
async fn every_fault_has_its_place_and_nothing_is_changed() {
    let server = Server::with_map("m").await;
    put(&server, "kf-1", &seeing(1, 0..20, "901")).await;
    let mut other = keyframe();
    other["session"] = json!("robot-2");
    put(&server, "kf-2", &other).await;
    let before = server.get(&format!("{MAP}/keyframes/kf-1")).await.expect(200);
    let refused = async |body: Value, places: &[&str]| {
        let answer = server.post(&format!("{MAP}/observations"), &body).await;
        assert_eq!(answer.pointers(), places, "{body}");
        answer.expect(422);
    };
    let body = json!({
        "replaced": [[1, 2], [1, 3], [2, 4], [4, 1], [7, 7], [8], [9, -1]],
        "removed": [2, 30, 30],
        "keyframes": [
            {"keyframe": "kf-1", "observes": [3, 2, 30], "covisible": [{"keyframe": "kf-1", "shared": 1}]},
            {"keyframe": "kf-1"}
        ]
    });
    refused(
        body,
        &[
            "/replaced/1",
            "/replaced/3",
            "/replaced/4",
            "/replaced/5",
            "/replaced/6/1",
            "/removed/2",
            "/keyframes/0/covisible/0/keyframe",
            "/keyframes/1/keyframe",
        ],
    )
    .await;
    let body =
        json!({"replaced": [[1, 2]], "removed": [1], "keyframes": [{"keyframe": "kf-1", "observes": [1]}]});
    refused(body, &["/removed/0", "/keyframes/0/observes/0"]).await;
    refused(json!({"session": "robot-9", "removed": [1]}), &["/session"]).await;
    let edges = json!([{"keyframe": "none", "shared": 1}]);
    let body = json!({"removed": [3], "keyframes": [{"keyframe": "kf-2"}, {"keyframe": "kf-1", "covisible": edges}]});
    refused(body, &["/keyframes/0/keyframe", "/keyframes/1/covisible/0/keyframe"]).await;
    assert_eq!(server.get(&format!("{MAP}/keyframes/kf-1")).await.expect(200), before);
}

#[tokio::test]
async fn what_may_go_when_a_quota_nears_is_listed_and_stays() {
    let server = Server::with_map("m").await;
    let list = async || {
        let page = server.get(&format!("{MAP}/keyframes?redundant=true")).await.expect(200);
        assert_eq!(page["next_cursor"], Value::Null);
        page["items"].as_array().unwrap().iter().map(|item| item["id"].clone()).collect::<Vec<_>>()
    };
    put(&server, "kf-1", &seeing(1, 0..20, "901")).await;
    put(&server, "kf-2", &seeing(2, 40..60, "902")).await;
    assert!(list().await.is_empty());
    // Its twin sees the same plate, by nine points in ten.
    put(&server, "kf-3", &seeing(3, 0..22, "901")).await;
    assert_eq!(list().await, ["kf-1"]);
    let all = server.get(&format!("{MAP}/keyframes")).await.expect(200);
    assert_eq!(all["items"].as_array().map(Vec::len), Some(3));
    let refused = server.get(&format!("{MAP}/keyframes?redundant=maybe")).await;
    assert_eq!(refused.pointers(), ["?redundant"]);
}
