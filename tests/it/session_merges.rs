//! Merges of sessions over HTTP: a client's two maps became one, and two again.

use reqwest::Method;
use serde_json::{Value, json};

use crate::support::{Answer, Server, pose};

const MAP: &str = "/v1/maps/m";

/// A keyframe of a session that sees these points, the first three of them on a plate.
fn seeing(session: &str, sec: i64, points: std::ops::Range<i64>, at: [f64; 3]) -> Value {
    let ids: Vec<i64> = points.collect();
    let positions: Vec<[f64; 3]> =
        ids.iter().map(|id| [at[0] + (id % 100) as f64 * 0.1, at[1] + 0.3, at[2] + 3.0]).collect();
    json!({
        "session": session,
        "stamp": {"sec": sec, "nanosec": 0},
        "pose": pose(at),
        "bow": {"words": [3, 17], "weights": [0.4, 0.6]},
        "observes": ids,
        "map_points": {"ids": ids, "positions": positions},
        "detections": [{"class": "door_number", "confidence": 0.9, "box": [10, 10, 50, 30], "text": "901",
            "map_points": [ids[0], ids[1], ids[2]]}]
    })
}

/// Two robots' maps of one corridor: the second began 5 m along it, and numbers its points anew.
async fn two_maps() -> Server {
    let server = Server::with_map("m").await;
    for (id, body) in [
        ("kf-1", seeing("robot-1", 1, 0..20, [5.0, 0.0, 0.0])),
        ("kf-2", seeing("robot-2", 2, 100..120, [0.0, 0.0, 0.0])),
        ("kf-3", seeing("robot-2", 3, 120..140, [1.0, 0.0, 0.0])),
    ] {
        server.put(&format!("{MAP}/keyframes/{id}"), &body).await.expect(201);
    }
    server
}

/// The points of kf-2 are those of kf-1.
fn merge() -> Value {
    let ids: Vec<Value> = (100..120).map(|id| json!([id, id - 100])).collect();
    json!({"into": "robot-1", "into_from_session": pose([5.0, 0.0, 0.0]), "map_points": {"ids": ids}})
}

/// All that is read of the map and that a merge changes.
async fn read(server: &Server) -> Value {
    let get = async |path: &str| server.get(&format!("{MAP}/{path}")).await.expect(200);
    let tum = server.request(Method::GET, &format!("{MAP}/trajectory?session=robot-2&format=tum"));
    let mut read = json!({
        "sessions": get("sessions").await["items"], "anchors": get("anchors").await["items"],
        "trajectory": Answer::text(tum).await,
    });
    for id in ["kf-1", "kf-2", "kf-3"] {
        let mut keyframe = get(&format!("keyframes/{id}")).await;
        for field in ["map_version", "version"] {
            keyframe.as_object_mut().unwrap().remove(field);
        }
        read[id] = json!([keyframe, get(&format!("keyframes/{id}/covisible")).await["items"]]);
    }
    for anchor in read["anchors"].as_array_mut().unwrap() {
        anchor.as_object_mut().unwrap().remove("version");
    }
    read
}

#[tokio::test]
async fn a_merged_session_is_in_the_others_frame_and_a_revoked_merge_leaves_nothing() {
    let server = two_maps().await;
    let before = read(&server).await;
    let path = format!("{MAP}/sessions/robot-2/merge");
    let answer = server.post(&path, &merge()).await.expect(200);
    let counts = ["keyframes", "map_points", "anchors_merged"].map(|name| answer[name].as_u64());
    assert_eq!(counts, [Some(2), Some(40), Some(1)], "{answer:#}");
    let after = read(&server).await;
    assert_eq!(after["kf-2"][0]["session"], "robot-1");
    assert_eq!(after["kf-3"][0]["pose"]["translation"], json!({"x": 6.0, "y": 0.0, "z": 0.0}));
    assert_eq!(after["kf-2"][1], json!([{"keyframe": "kf-1", "shared": 20}]));
    assert_eq!(after["anchors"].as_array().map(Vec::len), Some(2));
    assert_eq!(after["sessions"][0]["keyframes"], 3);
    // Once more changes nothing: the session has no keyframes.
    let again = server.post(&path, &merge()).await.expect(200);
    assert_eq!((&again["keyframes"], &again["map_version"]), (&json!(0), &answer["map_version"]));

    let revoked = server.delete(&path).await.expect(200);
    assert_eq!(revoked["keyframes"], 2);
    assert_eq!(read(&server).await, before);
    assert_eq!(server.delete(&path).await.expect(409)["code"], "no_open_merge");
    for kind in ["sessions_merged", "merge_revoked"] {
        let event = server.event(&format!("{MAP}/events?since=0"), |event| event["event"] == kind).await;
        assert_eq!((&event["session"], &event["into"]), (&json!("robot-2"), &json!("robot-1")), "{event:#}");
    }
}

#[tokio::test]
async fn what_is_sent_to_a_merged_session_later_is_written_on_top() {
    let server = two_maps().await;
    let path = format!("{MAP}/sessions/robot-2/merge");
    server.post(&path, &merge()).await.expect(200);
    // A retry of what was sent before is the same still.
    let retry = seeing("robot-2", 3, 120..140, [1.0, 0.0, 0.0]);
    let retry = server.put(&format!("{MAP}/keyframes/kf-3"), &retry).await;
    assert_eq!(retry.header("idempotent-replayed"), "true");
    let other = seeing("robot-3", 4, 0..9, [0.0; 3]);
    server.put(&format!("{MAP}/keyframes/kf-4"), &other).await.expect(201);
    // Another robot's keyframe does not stand in the way; one of the session's own frame does.
    let anew = seeing("robot-2", 5, 140..160, [2.0, 0.0, 0.0]);
    let anew = server.put(&format!("{MAP}/keyframes/kf-5"), &anew).await;
    anew.expect(201);
    assert_eq!(server.delete(&path).await.expect(409)["code"], "no_open_merge");
    let read = server.get(&format!("{MAP}/keyframes/kf-5")).await.expect(200);
    assert_eq!((&read["session"], &read["pose"]["translation"]["x"]), (&json!("robot-2"), &json!(2.0)));
    let moved = server.post(&path, &merge()).await.expect(200);
    assert_eq!(moved["keyframes"], 1);
}

#[tokio::test]
async fn every_fault_of_a_merge_has_its_place() {
    let server = two_maps().await;
    let path = format!("{MAP}/sessions/robot-2/merge");
    let refused = async |body: Value, places: &[&str]| {
        let answer = server.post(&path, &body).await;
        assert_eq!(answer.pointers(), places, "{body}");
        answer.expect(422);
    };
    refused(json!({}), &["/into", "/into_from_session"]).await;
    let with = |name: &str, value: Value| {
        let mut body = merge();
        body[name] = value;
        body
    };
    refused(with("into", json!("robot-2")), &["/into"]).await;
    refused(with("map_points", json!({"offset": 1, "ids": []})), &["/map_points"]).await;
    refused(with("map_points", json!({"offset": -200})), &["/map_points/offset"]).await;
    let ids = json!([[1, 2], [1, 3], [4], [5, -6]]);
    let places = ["/map_points/ids/1", "/map_points/ids/2", "/map_points/ids/3/1"];
    refused(with("map_points", json!({"ids": ids})), &places).await;
    let mut body = merge();
    body["into_from_session"]["scale"] = json!(0);
    refused(body, &["/into_from_session/scale"]).await;
    server.post(&format!("{MAP}/sessions/nobody/merge"), &merge()).await.expect(404);
    server.delete(&format!("{MAP}/sessions/nobody/merge")).await.expect(404);
}
