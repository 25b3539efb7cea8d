//! Releases over HTTP: a named version of a map answers as the map did then, whatever happens to the map.

use std::process::Command;

use reqwest::Method;
use serde_json::{Value, json};

use crate::exports::{exported, keyframe, lived, verdicts};
use crate::support::{Answer, Server};

const MAP: &str = "/v1/maps/m";
const KEYFRAMES: [&str; 7] = ["kf-0", "kf-1", "kf-2", "kf-3", "again-0", "again-1", "again-3"];

/// The answers about every keyframe that the release has, and about one that is not stored, but for their ids.
async fn answers(server: &Server, release: Option<&str>) -> Vec<Value> {
    let stored = KEYFRAMES.iter().map(|id| json!({"keyframe": id}));
    let inline = json!({"inline": keyframe("robot-9", 99, 2.1, "903")});
    let mut answers = Vec::new();
    for mut question in stored.chain([inline]) {
        if let Some(release) = release {
            question["release"] = json!(release);
        }
        let mut answer = server.post(&format!("{MAP}/loop-queries"), &question).await.expect(200);
        let id = answer.as_object_mut().unwrap().remove("id").unwrap();
        let read = format!("{MAP}/loop-queries/{}", id.as_str().unwrap());
        assert_eq!(server.get(&read).await.expect(200)["id"], id, "a verdict is read again");
        answers.push(answer);
    }
    answers
}

/// Changes of every kind, so that the map answers otherwise than before.
async fn live_on(server: &Server) {
    server.patch(MAP, &json!({"settings": {"anchor_map_min_similarity": 0.9}})).await.expect(200);
    server.delete(&format!("{MAP}/keyframes/kf-1")).await.expect(200);
    server.delete(&format!("{MAP}/loops/stays")).await.expect(200);
    server.put(&format!("{MAP}/keyframes/new"), &keyframe("robot-3", 200, 2.0, "905")).await.expect(201);
    let moved = json!({"session": "robot-1", "keyframes": {"ids": ["kf-0"], "poses": [crate::support::pose([0.0, 2.1, 0.0])]}});
    server.post(&format!("{MAP}/poses"), &moved).await.expect(200);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_release_answers_as_the_map_did_and_nothing_changes_it() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    lived(&server).await;
    let version = server.get(MAP).await.expect(200)["map_version"].clone();
    let before = answers(&server, None).await;
    let of_map = exported(&server, "m").await;

    let path = format!("{MAP}/releases/2026-11");
    let body = json!({"description": "two floors", "map_version": version});
    let published = server.put(&path, &body).await.expect(201);
    assert_eq!((&published["map_version"], &published["keyframes"]), (&version, &json!(7)), "{published:#}");
    live_on(&server).await;
    let again = server.put(&path, &body).await;
    assert_eq!(again.header("idempotent-replayed"), "true");
    assert_eq!(again.expect(200), published);
    assert_eq!(server.put(&path, &json!({})).await.expect(409)["code"], "release_exists");
    let refused = server.put(&format!("{MAP}/releases/late"), &body).await.expect(409);
    assert_eq!(refused["code"], "map_version_differs");

    assert_ne!(answers_now(&server).await, before, "the map goes on");
    assert_eq!(answers(&server, Some("2026-11")).await, before);
    server.stop().await;
    let server = Server::on(folder.path()).await;
    assert_eq!(answers(&server, Some("2026-11")).await, before, "after a restart");
    assert_eq!(exported_release(&server).await, of_map);
    server.event(&format!("{MAP}/events?since=0"), |event| event["event"] == "release_published").await;

    // The map lists no release beside it, and no robot writes to one.
    let maps = server.get("/v1/maps").await.expect(200);
    assert_eq!(maps["items"].as_array().unwrap().len(), 1, "{maps:#}");
    assert_eq!(server.get("/v1/maps/m%2F2026-11").await.pointers(), ["{map}"]);
    let missing = json!({"keyframe": "new", "release": "2026-11"});
    server.post(&format!("{MAP}/loop-queries"), &missing).await.expect(404);
    let unknown = json!({"keyframe": "kf-0", "release": "2026-12"});
    server.post(&format!("{MAP}/loop-queries"), &unknown).await.expect(404);

    let asked_by = asked_by(&server, 3).await;
    let sessions: Vec<&str> = asked_by.iter().map(|of| of["session"].as_str().unwrap()).collect();
    assert_eq!(sessions, ["robot-9", "robot-2", "robot-1"], "{asked_by:?}");
    assert_eq!(asked_by[2]["queries"], 8);

    let database = format!("sqlite://{}", folder.path().join("test.db").display());
    let check = tokio::task::spawn_blocking(move || {
        Command::new(env!("CARGO_BIN_EXE_revisit")).args(["check", "--database", &database]).output().unwrap()
    });
    let check = check.await.unwrap();
    assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));

    server.delete(&path).await.expect(204);
    server
        .post(&format!("{MAP}/loop-queries"), &json!({"keyframe": "kf-0", "release": "2026-11"}))
        .await
        .expect(404);
    server.get(&path).await.expect(404);
    server.put(&path, &json!({})).await.expect(201);
    server.delete(MAP).await.expect(204);
    server.put(MAP, &json!({})).await.expect(201);
    assert_eq!(server.get(&format!("{MAP}/releases")).await.expect(200)["items"], json!([]));
    server
        .post(&format!("{MAP}/loop-queries"), &json!({"keyframe": "kf-0", "release": "2026-11"}))
        .await
        .expect(404);
}

/// The answers of the map as it stands about what is left of it.
async fn answers_now(server: &Server) -> Vec<Value> {
    let mut answers = Vec::new();
    for id in KEYFRAMES.iter().filter(|id| **id != "kf-1") {
        answers.push(server.post(&format!("{MAP}/loop-queries"), &json!({"keyframe": id})).await.expect(200));
    }
    answers
}

async fn exported_release(server: &Server) -> Vec<Value> {
    let text = Answer::text(server.request(Method::GET, &format!("{MAP}/export?release=2026-11"))).await;
    text.lines().map(|line| serde_json::from_str(line).expect("a line of JSON")).collect()
}

/// The robots that asked the release, once so many are on disk.
async fn asked_by(server: &Server, sessions: usize) -> Vec<Value> {
    loop {
        let listed = server.get(&format!("{MAP}/releases")).await.expect(200);
        let asked_by = listed["items"][0]["asked_by"].as_array().unwrap().clone();
        let queries: u64 = asked_by.iter().map(|of| of["queries"].as_u64().unwrap()).sum();
        if asked_by.len() == sessions && queries == 16 {
            return asked_by;
        }
        tokio::task::yield_now().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_map_begins_as_a_copy_and_both_go_different_ways() {
    let server = Server::start().await;
    lived(&server).await;
    server.put(&format!("{MAP}/releases/r"), &json!({})).await.expect(201);
    let before = verdicts(&server, "m").await;
    let mut of_map = exported(&server, "m").await;
    live_on(&server).await;

    let body = json!({"base": {"map": "m", "release": "r"}, "description": "the annex"});
    let made = server.put("/v1/maps/annex", &body).await.expect(201);
    assert_eq!((&made["description"], &made["keyframes"]), (&json!("the annex"), &json!(7)));
    assert_eq!(made["settings"]["candidates_max"], 20, "as in the base");
    let again = server.put("/v1/maps/annex", &body).await;
    assert_eq!(again.header("idempotent-replayed"), "true");
    let other = json!({"base": {"map": "m"}});
    assert_eq!(server.put("/v1/maps/annex", &other).await.expect(409)["code"], "map_exists");
    assert_eq!(verdicts(&server, "annex").await, before);
    let mut of_copy = exported(&server, "annex").await;
    assert_eq!(of_copy.pop().unwrap()["body"], json!({"description": "the annex"}));
    for line in of_map.iter_mut().filter(|line| line["op"] == "map") {
        line["id"] = json!("annex");
    }
    assert_eq!(of_copy, of_map);

    // Each goes its own way, also for a client that sends the same keyframe again.
    let sent = keyframe("robot-1", 1, 0.0, "901");
    let replay = server.put("/v1/maps/annex/keyframes/kf-0", &sent).await;
    assert_eq!(replay.header("idempotent-replayed"), "true");
    server.put("/v1/maps/annex/keyframes/own", &keyframe("robot-1", 300, 0.5, "901")).await.expect(201);
    server.get(&format!("{MAP}/keyframes/own")).await.expect(404);
    server.delete(MAP).await.expect(204);
    assert_eq!(server.get("/v1/maps/annex").await.expect(200)["keyframes"], 8);
    server.event("/v1/maps/annex/events?since=0", |_| true).await;

    let fork =
        server.put("/v1/maps/fork", &json!({"base": {"map": "annex"}, "metric": false})).await.expect(201);
    assert_eq!((&fork["metric"], &fork["keyframes"]), (&json!(false), &json!(8)));
    for (base, status) in [
        (json!({"map": "m"}), 404),
        (json!({"map": "annex", "release": "r"}), 404),
        (json!({"map": "x"}), 422),
    ] {
        server.put("/v1/maps/x", &json!({"base": base})).await.expect(status);
    }
}

#[tokio::test]
async fn changes_between_releases_name_keyframes_and_signs() {
    let server = Server::start().await;
    lived(&server).await;
    server.put(&format!("{MAP}/releases/old"), &json!({})).await.expect(201);
    let none = server.get(&format!("{MAP}/changes?since=old")).await.expect(200);
    assert_eq!((&none["keyframes"], &none["anchors"]), (&json!([]), &json!([])));
    live_on(&server).await;
    let stored = server.get(&format!("{MAP}/keyframes/kf-2")).await.expect(200);
    let anchor = stored["detections"][0]["anchor"].as_str().unwrap();
    let described = server.request(Method::PATCH, &format!("{MAP}/anchors/{anchor}"));
    let described = described.header("if-match", "*").json(&json!({"description": "room 953"}));
    Answer::of(described).await.expect(200);
    server.put(&format!("{MAP}/releases/new"), &json!({})).await.expect(201);

    let now = server.get(&format!("{MAP}/changes?since=old")).await.expect(200);
    let changes = server.get(&format!("{MAP}/changes?since=old&until=new")).await.expect(200);
    assert_eq!(changes, now);
    let keyframes: Vec<_> = changes["keyframes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|of| (of["change"].as_str().unwrap(), of["keyframe"].as_str().unwrap()))
        .collect();
    assert_eq!(keyframes, [("added", "new"), ("removed", "kf-1"), ("moved", "kf-0")]);
    assert!((changes["keyframes"][2]["moved_m"].as_f64().unwrap() - 2.0).abs() < 1e-9, "{changes:#}");
    let described =
        changes["anchors"].as_array().unwrap().iter().find(|of| of["change"] == "described").unwrap();
    assert_eq!(
        (&described["anchor"], &described["before"], &described["after"]),
        (&json!(anchor), &json!("903"), &json!("room 953"))
    );

    let back = server.get(&format!("{MAP}/changes?since=new&until=old&limit=1")).await.expect(200);
    assert_eq!((&back["keyframes_added"], &back["keyframes_removed"]), (&json!(1), &json!(1)));
    for (query, at) in [("", "?since"), ("?since=old&limit=0", "?limit"), ("?since=old&since=new", "?since")]
    {
        assert_eq!(server.get(&format!("{MAP}/changes{query}")).await.pointers(), [at], "{query}");
    }
    server.get(&format!("{MAP}/changes?since=none")).await.expect(404);
}

#[tokio::test]
async fn where_am_i_is_asked_of_releases_too() {
    let server = Server::start().await;
    lived(&server).await;
    server.put("/v1/maps/other", &json!({})).await.expect(201);
    let asked = json!({"keyframe": keyframe("robot-9", 99, 2.1, "903"), "maps": ["m"]});
    let before = server.post("/v1/locate", &asked).await.expect(200);
    server.put(&format!("{MAP}/releases/r"), &json!({})).await.expect(201);
    live_on(&server).await;
    let mut of_release = asked.clone();
    of_release["release"] = json!("r");
    assert_eq!(server.post("/v1/locate", &of_release).await.expect(200), before);
    // A pattern leaves out the maps that have no release of this name, and a name does not.
    of_release["maps"] = json!(["*"]);
    assert_eq!(server.post("/v1/locate", &of_release).await.expect(200), before);
    of_release["maps"] = json!(["other"]);
    server.post("/v1/locate", &of_release).await.expect(404);
}
