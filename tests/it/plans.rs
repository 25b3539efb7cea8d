//! Plans over HTTP (M55): prior anchors are put, read, exported and deleted, and sessions are aligned by them.

use reqwest::Method;
use serde_json::{Value, json};

use crate::support::{Answer, Server, pose};

fn prior(text: &str, at: [f64; 3], frame: &str) -> Value {
    json!({"class": "door_number", "description": text, "position": at, "frame": frame})
}

/// A keyframe of a robot whose frame is the plan's, moved by 10 m along x; it reads texts at places in its own frame.
fn keyframe(session: &str, seconds: u32, read: &[(&str, [f64; 3])]) -> Value {
    let detection = |(text, at): &(&str, [f64; 3])| json!({"class": "door_number", "confidence": 0.9, "box": [0, 0, 9, 9], "position": at, "text": text});
    let detections: Vec<Value> = read.iter().map(detection).collect();
    let mut pose = pose([13.0, 1.0, 1.0]);
    // A level camera: z up in the frame, y down in the image.
    pose["rotation"] = json!({"x": -0.5, "y": 0.5, "z": -0.5, "w": 0.5});
    json!({"session": session, "stamp": {"sec": seconds, "nanosec": 0}, "pose": pose, "detections": detections})
}

async fn with_plan(server: &Server) {
    server.put("/v1/maps/tower", &json!({"metric": true})).await.expect(201);
    for (id, text, at) in [("door-901", "901", [0.0, 0.0, 1.5]), ("door-905", "905", [8.0, 0.0, 1.5])] {
        let path = format!("/v1/maps/tower/anchors/{id}");
        server.put(&path, &prior(text, at, "plan:9")).await.expect(201);
    }
}

#[tokio::test]
async fn a_prior_anchor_is_put_by_id_and_a_retry_is_harmless() {
    let server = Server::start().await;
    with_plan(&server).await;
    let path = "/v1/maps/tower/anchors/door-901";
    let again = server.put(path, &prior("901", [0.0, 0.0, 1.5], "plan:9")).await;
    assert_eq!(again.header("idempotent-replayed"), "true");
    let again = again.expect(200);
    assert_eq!(
        (&again["id"], &again["state"], &again["description_source"]),
        (&json!("door-901"), &json!("valid"), &json!("plan"))
    );
    assert_eq!(again["prior"], json!({"frame": "plan:9", "position": [0.0, 0.0, 1.5]}));
    assert_eq!(again["plan_position"], json!({"frame": "plan:9", "position": [0.0, 0.0, 1.5]}));
    let other = server.put(path, &prior("902", [0.0, 0.0, 1.5], "plan:9")).await.expect(409);
    assert_eq!(other["code"], "prior_exists");
    // It is described by its plan.
    let patch =
        server.request(Method::PATCH, path).header("if-match", "*").json(&json!({"description": "x"}));
    assert_eq!(Answer::of(patch).await.expect(409)["code"], "prior_anchor");
    // Its name is its only one.
    server.get("/v1/maps/tower/anchors/a-0").await.expect(404);
    let listed = server.get("/v1/maps/tower/anchors?prior=true").await.expect(200);
    assert_eq!(listed["items"].as_array().unwrap().len(), 2);
    let seen = server.get("/v1/maps/tower/anchors?prior=false").await.expect(200);
    assert_eq!(seen["items"], json!([]));
    server.delete(path).await.expect(200);
    server.get(path).await.expect(404);
    // Deleted, it may be put with another body.
    server.put(path, &prior("902", [0.0, 0.0, 1.5], "plan:9")).await.expect(201);
}

#[tokio::test]
async fn a_prior_anchor_that_cannot_be_is_rejected_with_every_fault() {
    let server = Server::start().await;
    server.put("/v1/maps/tower", &json!({"anchor_classes": ["door_number"]})).await.expect(201);
    server.put("/v1/maps/tower/keyframes/kf-1", &keyframe("robot", 1, &[])).await.expect(201);
    let path = "/v1/maps/tower/anchors/door-901";
    for id in ["a-7", "a-07", "a-4294967296"] {
        let answer =
            server.put(&format!("/v1/maps/tower/anchors/{id}"), &prior("901", [0.0; 3], "plan:9")).await;
        assert_eq!(answer.pointers(), ["{anchor}"], "{id}");
        answer.expect(422);
    }
    let wrong =
        json!({"class": "", "position": [0, 1e39, 0], "frame": "..", "normal": [1, 1, 0], "colour": "red"});
    let answer = server.put(path, &wrong).await;
    let mut pointers = answer.pointers();
    pointers.sort_unstable();
    assert_eq!(pointers, ["/class", "/colour", "/description", "/frame", "/normal", "/position/1"]);
    answer.expect(422);
    // What only the map can tell: the class, and a frame that a robot drives.
    let answer = server
        .put(path, &json!({"class": "picture", "description": "x", "position": [0, 0, 0], "frame": "robot"}))
        .await;
    assert_eq!(answer.pointers(), ["/class", "/frame"]);
    answer.expect(422);
    // And the other way round: no robot drives a plan's frame.
    server.put(path, &prior("901", [0.0; 3], "plan:9")).await.expect(201);
    let answer = server.put("/v1/maps/tower/keyframes/kf-2", &keyframe("plan:9", 2, &[])).await;
    assert_eq!(answer.pointers(), ["/session"]);
    answer.expect(422);
}

#[tokio::test]
async fn a_session_is_aligned_by_its_signs_and_shows_plan_coordinates_after_a_restart_too() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    with_plan(&server).await;
    let read = keyframe("robot", 7, &[("901", [10.0, 0.0, 1.5])]);
    let stored = server.put("/v1/maps/tower/keyframes/kf-1", &read).await.expect(201);
    let anchor = stored["detections"][0]["anchor"].as_str().unwrap().to_owned();
    let sessions = server.get("/v1/maps/tower/sessions").await.expect(200);
    assert_eq!(sessions["items"][0], json!({"session": "plan:9", "keyframes": 0, "priors": 2}));
    let stamp = json!({"sec": 7, "nanosec": 0});
    assert_eq!(
        sessions["items"][1],
        json!({"session": "robot", "keyframes": 1, "first": stamp, "last": stamp})
    );
    let read = keyframe("robot", 9, &[("905", [18.0, 0.0, 1.5]), ("Library", [14.0, 2.0, 1.5])]);
    server.put("/v1/maps/tower/keyframes/kf-2", &read).await.expect(201);
    let path = format!("/v1/maps/tower/anchors/{anchor}");
    let expect_aligned = async |server: &Server| {
        let part = server.get("/v1/maps/tower/sessions?limit=1").await.expect(200);
        let next = part["next_cursor"].as_str().expect("a second session");
        let rest = server.get(&format!("/v1/maps/tower/sessions?cursor={next}")).await.expect(200);
        let robot = rest["items"][0].clone();
        assert_eq!(
            (&robot["session"], &robot["frame"], &robot["inliers"]),
            (&json!("robot"), &json!("plan:9"), &json!(2))
        );
        assert_eq!(robot["plan_from_session"]["translation"]["x"], json!(-10.0), "{robot}");
        assert!(robot["uncertainty"]["rotation_rad"].as_f64().unwrap() < 0.14);
        let seen = server.get(&path).await.expect(200);
        assert_eq!(
            seen["plan_position"],
            json!({"frame": "plan:9", "position": [0.0, 0.0, 1.5], "session": "robot"})
        );
        let matched: Vec<&str> =
            seen["matches"].as_array().unwrap().iter().map(|m| m["anchor"].as_str().unwrap()).collect();
        assert_eq!(matched, ["door-901"]);
        rest
    };
    let before = expect_aligned(&server).await;
    server.stop().await;
    let server = Server::on(folder.path()).await;
    assert_eq!(expect_aligned(&server).await, before);
}

#[tokio::test]
async fn an_export_says_which_prior_anchors_were_put_and_deleted() {
    let server = Server::start().await;
    with_plan(&server).await;
    server.delete("/v1/maps/tower/anchors/door-905").await.expect(200);
    let text = Answer::text(server.request(Method::GET, "/v1/maps/tower/export")).await;
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(
        lines[1..],
        [
            json!({"op": "anchor", "id": "door-901", "body": prior("901", [0.0, 0.0, 1.5], "plan:9")}),
            json!({"op": "anchor", "id": "door-905", "body": prior("905", [8.0, 0.0, 1.5], "plan:9")}),
            json!({"op": "delete", "anchor": "door-905"}),
        ]
    );
}
