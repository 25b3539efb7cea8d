//! M52: the same question gets the same bytes, again and after a restart.

use reqwest::Method;
use serde_json::{Value, json};
use tempfile::TempDir;

use super::scene::{Keyframe, NAMES, Scene, door, keyframe, thing, unread};
use crate::support::{Server, pose};

/// The bytes that a request is answered.
async fn bytes(request: reqwest::RequestBuilder) -> Vec<u8> {
    let response = request.send().await.expect("an answer");
    assert!(response.status().is_success(), "{}", response.status());
    response.bytes().await.expect("a whole answer").into()
}

/// Passages with several candidates each, by words and by anchors.
fn passages() -> Vec<(String, Keyframe)> {
    let visit = |number: usize| {
        let room = number % 3;
        let x = number as f64;
        let sights = [
            door(&format!("{}", 901 + 9 * room), [x, 0.0, 2.0 + 0.1 * x]),
            thing("poster", NAMES[room]).at([x + 1.0, 0.3, 1.0]).confidence(0.7),
            thing("sign", "EXIT").at([x - 2.0, 0.0, 1.0]),
            unread([x, 5.0, 1.0]),
        ];
        let words = [(1, 0.3), (10 + room as u32, 0.6), (100 + number as u32, 0.1)];
        (format!("kf-{number}"), keyframe().at([x, 0.0, 0.0]).words(&words).sees(sights))
    };
    (0..9).map(visit).collect()
}

async fn scene_with_passages() -> Scene {
    let scene = Scene::new().await;
    for (id, keyframe) in passages() {
        scene.put(&id, keyframe).await;
    }
    scene
}

#[tokio::test]
async fn the_same_question_at_the_same_version_gets_the_same_bytes() {
    let scene = scene_with_passages().await;
    let ask = async |body: Value| {
        bytes(scene.server.request(Method::POST, &scene.path("/loop-queries")).json(&body)).await
    };
    let inline = passages().remove(4).1.0;
    for body in [
        json!({"keyframe": "kf-8"}),
        json!({"keyframe": "kf-3", "verify": "geometry", "seed": 7}),
        json!({"inline": inline, "verify": "anchors"}),
    ] {
        let first = ask(body.clone()).await;
        assert_eq!(ask(body.clone()).await, first, "{body}");
        let id =
            serde_json::from_slice::<Value>(&first).expect("JSON")["id"].as_str().expect("an id").to_owned();
        let path = scene.path(&format!("/loop-queries/{id}"));
        assert_eq!(bytes(scene.server.request(Method::GET, &path)).await, first, "read back: {body}");
    }
}

#[tokio::test]
async fn the_name_of_a_query_says_what_was_asked_and_of_which_version() {
    let scene = scene_with_passages().await;
    let name = async |body: Value| {
        scene.post("/loop-queries", &body).await["id"].as_str().expect("an id").to_owned()
    };
    let first = name(json!({"keyframe": "kf-8"})).await;
    assert_eq!(
        name(json!({"keyframe": "kf-8", "verify": "auto", "seed": 0})).await,
        first,
        "these are the defaults"
    );
    let mut names = vec![first];
    for body in [
        json!({"keyframe": "kf-7"}),
        json!({"keyframe": "kf-8", "seed": 1}),
        json!({"keyframe": "kf-8", "verify": "anchors"}),
        json!({"inline": passages().remove(8).1.0}),
    ] {
        names.push(name(body).await);
    }
    scene.set(json!({"candidates_max": 21})).await;
    names.push(name(json!({"keyframe": "kf-8"})).await);
    let all = names.len();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), all, "{names:?}");
}

#[tokio::test]
async fn a_query_does_not_change_the_maps_version() {
    let scene = scene_with_passages().await;
    let version = async || scene.get("").await["map_version"].clone();
    let before = version().await;
    assert_eq!(scene.ask("kf-8").await["map_version"], before);
    assert_eq!(version().await, before);
    scene.put("kf-9", keyframe()).await;
    assert_eq!(version().await, json!(before.as_u64().expect("a number") + 1));
}

/// A server on a folder that outlives it.
async fn open(folder: &TempDir) -> Server {
    Server::on(folder.path()).await
}

/// The bytes that a request with a body is answered.
async fn sent(server: &Server, method: Method, path: &str, body: Value) -> Vec<u8> {
    bytes(server.request(method, &format!("/v1/maps/tower{path}")).json(&body)).await
}

async fn read(server: &Server, path: &str) -> Vec<u8> {
    bytes(server.request(Method::GET, &format!("/v1/maps/tower{path}"))).await
}

async fn describe(server: &Server, anchor: usize, description: &str) {
    let by_hand = server.request(Method::PATCH, &format!("/v1/maps/tower/anchors/a-{anchor}"));
    bytes(by_hand.header("if-match", "*").json(&json!({"description": description}))).await;
}

/// All that a client can read of the map, and every verdict.
async fn everything(server: &Server) -> Vec<(String, Vec<u8>)> {
    let mut paths: Vec<String> =
        ["", "/keyframes", "/anchors?merged=true&limit=1000", "/loops"].map(str::to_owned).to_vec();
    let kept: Vec<usize> = (0..9).filter(|number| *number != 5).collect();
    for number in &kept {
        paths.extend(
            ["", "/covisible", "/local-anchor-map"].map(|rest| format!("/keyframes/kf-{number}{rest}")),
        );
    }
    let mut found = Vec::new();
    for path in paths {
        let answer = read(server, &path).await;
        found.push((path, answer));
    }
    for number in kept {
        let body = json!({"keyframe": format!("kf-{number}"), "seed": 3});
        found.push((format!("{body}"), sent(server, Method::POST, "/loop-queries", body).await));
    }
    found
}

#[tokio::test]
async fn a_second_server_on_the_same_database_gives_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let server = open(&folder).await;
    sent(&server, Method::PUT, "", json!({"settings": {"description_min_information_level": 2}})).await;
    for (id, keyframe) in passages() {
        sent(&server, Method::PUT, &format!("/keyframes/{id}"), keyframe.0).await;
    }
    // Something of everything that can happen to a map.
    for (id, keyframe, candidate) in [("l-1", "kf-6", "kf-0"), ("l-2", "kf-7", "kf-1")] {
        let body = json!({"id": id, "keyframe": keyframe, "candidate": candidate});
        sent(&server, Method::POST, "/loops", body).await;
    }
    for gone in ["loops/l-2", "keyframes/kf-5"] {
        server.delete(&format!("/v1/maps/tower/{gone}")).await.expect(200);
    }
    let moved = json!({"keyframes": {"ids": ["kf-3"], "poses": [pose([0.1, 0.2, 0.3])]}});
    sent(&server, Method::POST, "/poses", moved).await;
    describe(&server, 3, "room 950").await;
    sent(&server, Method::PATCH, "", json!({"settings": {"anchor_map_min_similarity": 0.25}})).await;

    let before = everything(&server).await;
    server.stop().await;
    let server = open(&folder).await;
    let after = everything(&server).await;
    for ((what, before), (_, after)) in before.iter().zip(&after) {
        assert_eq!(String::from_utf8_lossy(after), String::from_utf8_lossy(before), "{what}");
    }
    server.stop().await;
}

#[tokio::test]
async fn a_crowd_of_texts_that_all_match_gives_the_same_bytes_after_a_restart() {
    const KEYFRAMES: usize = 8;
    const DOORS: usize = 25;
    let asked = async |server: &Server| {
        let mut answers = Vec::new();
        for anchor in [1, 2, 60, 150, 200] {
            answers.push(read(server, &format!("/anchors/a-{anchor}")).await);
        }
        for number in 0..KEYFRAMES {
            let body = json!({"keyframe": format!("kf-{number}")});
            answers.push(sent(server, Method::POST, "/loop-queries", body).await);
        }
        answers
    };
    let folder = tempfile::tempdir().expect("a temporary directory");
    let server = open(&folder).await;
    sent(&server, Method::PUT, "", json!({})).await;
    let passage = |number: usize| {
        let doors = (0..DOORS).map(|door| {
            let x = (10 * (number * DOORS + door)) as f64;
            let letter = |n: usize| char::from(b'b' + n as u8);
            thing("plate", &format!("a plate with room 901, x{}{}", letter(number), letter(door)))
                .at([x, 0.0, 2.0])
        });
        keyframe().sees(doors.collect::<Vec<_>>())
    };
    for number in 0..KEYFRAMES {
        sent(&server, Method::PUT, &format!("/keyframes/kf-{number}"), passage(number).0).await;
    }
    // Old anchors get new texts, and new ones the places of old: what is oldest must not depend on when a text arrived.
    for (anchor, word) in [(1, "quill"), (3, "fern"), (61, "moss")] {
        describe(&server, anchor, &format!("a plate with room 901, {word}")).await;
    }
    server.delete("/v1/maps/tower/keyframes/kf-1").await.expect(200);
    sent(&server, Method::PUT, "/keyframes/kf-1", passage(KEYFRAMES).0).await;

    let told = server.get("/v1/maps/tower/anchors/a-1").await.expect(200);
    assert_eq!(told["matches_total"], KEYFRAMES * DOORS - 1, "{told}");
    let before = asked(&server).await;
    server.stop().await;
    let server = open(&folder).await;
    let after = asked(&server).await;
    for (before, after) in before.iter().zip(&after) {
        assert_eq!(String::from_utf8_lossy(after), String::from_utf8_lossy(before));
    }
    server.stop().await;
}
