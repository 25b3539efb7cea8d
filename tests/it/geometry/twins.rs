//! M16: a building that shows one view in two places is told so.

use reqwest::Method;
use revisit::geometry::Pose;
use serde_json::{Value, json};

use super::scene::{Shot, ask, pose, query_pose, store};
use crate::support::{Answer, Server};

const PLATE: [f64; 3] = [0.5, 0.0, 3.0];

/// The `nth` keyframe of a passage through a room whose plate says this.
fn seen(session: &str, plate: &'static str, nth: u32) -> Value {
    let shot = Shot::of(1, pose([0.05 * f64::from(nth), 0.0, 0.0], 0.0)).plates(&[(plate, PLATE)]);
    let mut body = shot.body(session, true);
    body["stamp"]["sec"] = json!(nth);
    body["observes"] = body["map_points"]["ids"].clone();
    body
}

/// A map of two floors that look alike: two keyframes of each, whose plates say these.
async fn floors(server: &Server, settings: &Value, plates: [&'static str; 2]) {
    server.put("/v1/maps/m", &json!({"settings": settings})).await.expect(201);
    for (session, plate) in ["a", "b"].into_iter().zip(plates) {
        for nth in 0..2 {
            store(server, &format!("{session}-{nth}"), &seen(session, plate, nth)).await;
        }
    }
}

/// A keyframe of the same view, without its plate.
async fn come_back(server: &Server) {
    store(server, "query", &Shot::of(1, query_pose()).body("c", true)).await;
}

async fn twins(server: &Server) -> Value {
    server.get("/v1/maps/m").await.expect(200)["twins"].clone()
}

async fn describe(server: &Server, sign: &str, text: Value) {
    let request = server.request(Method::PATCH, sign).header("if-match", "*");
    Answer::of(request.json(&json!({"description": text}))).await.expect(200);
}

async fn answered(server: &Server) -> (String, Vec<String>, bool) {
    let answer = ask(server, "auto").await;
    let codes = answer["candidates"].as_array().unwrap().iter();
    let codes = codes.map(|candidate| candidate["reason"]["code"].as_str().unwrap_or("loop").to_owned());
    let has_twins = answer["has_twins"].as_bool().unwrap_or(false);
    (answer["verdict"].as_str().unwrap().to_owned(), codes.collect(), has_twins)
}

fn geometry_alone() -> Value {
    json!({"without_anchors": "geometry"})
}

#[tokio::test]
async fn a_view_that_two_plates_tell_apart_is_listed_as_twins() {
    let cases = [
        (geometry_alone(), ["901", "902"], 1, "undecided", "no_anchors"),
        // What every check of the paper leaves to geometry stays with it.
        (json!({"method": "paper", "without_anchors": "geometry"}), ["901", "902"], 0, "loop", "loop"),
        // Nothing tells these two apart, and nothing says that they are two.
        (geometry_alone(), ["901", "901"], 0, "undecided", "no_anchors"),
        (geometry_alone(), ["exit", "exit"], 0, "undecided", "no_anchors"),
        (json!({}), ["901", "902"], 0, "undecided", "no_anchors"),
    ];
    for (settings, plates, count, verdict, code) in cases {
        let server = Server::start().await;
        floors(&server, &settings, plates).await;
        let found = twins(&server).await;
        assert_eq!(found.as_array().unwrap().len(), count, "{settings} {plates:?}: {found}");
        come_back(&server).await;
        let (answer, codes, has_twins) = answered(&server).await;
        assert_eq!((answer.as_str(), has_twins), (verdict, count > 0), "{settings} {plates:?}: {codes:?}");
        assert!(codes.iter().any(|own| own == code), "{settings} {plates:?}: {codes:?}");
    }
}

#[tokio::test]
async fn twins_are_named_and_last_as_long_as_their_signs_and_keyframes() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    floors(&server, &geometry_alone(), ["901", "902"]).await;
    come_back(&server).await;
    let found = twins(&server).await;
    let [pair] = found.as_array().unwrap().as_slice() else { panic!("{found}") };
    // 902 is read alike with the second keyframe of its floor, and not before.
    assert_eq!(pair["keyframe"], "b-1", "{pair}");
    assert!(pair["candidate"].as_str().unwrap().starts_with("a-"), "{pair}");
    let sign = format!("/v1/maps/m/anchors/{}", pair["anchor"].as_str().unwrap());
    assert_eq!(server.get(&sign).await.expect(200)["description"], "902");
    let before = ask(&server, "auto").await;
    server.stop().await;
    let server = Server::on(folder.path()).await;
    assert_eq!(twins(&server).await, found, "after a restart");
    assert_eq!(ask(&server, "auto").await, before, "after a restart");
    // Whoever knows better says that both plates are one: they are twins no longer, until he takes it back.
    describe(&server, &sign, json!("901")).await;
    assert_eq!(twins(&server).await, json!([]));
    describe(&server, &sign, json!(null)).await;
    assert_eq!(twins(&server).await, found);
    server.delete("/v1/maps/m/keyframes/b-1").await.expect(200);
    assert_eq!(twins(&server).await, json!([]));
}

#[tokio::test]
async fn twins_are_a_version_of_their_own_and_the_same_however_keyframes_are_sent() {
    let server = Server::start().await;
    floors(&server, &geometry_alone(), ["901", "902"]).await;
    let one_by_one = server.get("/v1/maps/m").await.expect(200);
    assert_eq!(one_by_one["twins"].as_array().unwrap().len(), 1, "{one_by_one}");
    // The map, its four keyframes, and the twins.
    assert_eq!(one_by_one["map_version"], 1 + 4 + 1, "{one_by_one}");

    server.put("/v1/maps/bulk", &json!({"settings": geometry_alone()})).await.expect(201);
    let lines = [("a", "901"), ("b", "902")].into_iter().flat_map(|(session, plate)| {
        (0..2).map(move |nth| {
            let mut line = seen(session, plate, nth);
            line["id"] = json!(format!("{session}-{nth}"));
            format!("{line}\n")
        })
    });
    let body: String = lines.collect();
    server.send(Method::POST, "/v1/maps/bulk/keyframes", "application/x-ndjson", body).await.expect(200);
    let at_once = server.get("/v1/maps/bulk").await.expect(200);
    assert_eq!(
        (&at_once["twins"], &at_once["map_version"]),
        (&one_by_one["twins"], &one_by_one["map_version"])
    );
}

#[tokio::test]
async fn a_description_by_hand_shows_twins_too() {
    let server = Server::start().await;
    // A plate that nobody could read twice alike.
    server.put("/v1/maps/m", &json!({"settings": geometry_alone()})).await.expect(201);
    for nth in 0..2 {
        store(&server, &format!("a-{nth}"), &seen("a", "901", nth)).await;
    }
    store(&server, "b-0", &Shot::of(1, Pose::identity()).plates(&[("902", PLATE)]).body("b", true)).await;
    assert_eq!(twins(&server).await, json!([]), "902 was read once");
    let anchors = server.get("/v1/maps/m/anchors?text=902").await.expect(200);
    let sign = anchors["items"][0]["id"].as_str().expect("an anchor").to_owned();
    describe(&server, &format!("/v1/maps/m/anchors/{sign}"), json!("902")).await;
    let found = twins(&server).await;
    assert_eq!((&found[0]["keyframe"], &found[0]["anchor"]), (&json!("b-0"), &json!(sign)), "{found}");
}

#[tokio::test]
async fn a_map_shows_the_numbering_that_it_has_learned() {
    let server = Server::with_map("m").await;
    for room in 0..10 {
        let shown = server.get("/v1/maps/m").await.expect(200)["numbering"].clone();
        assert_eq!(shown, json!({}), "after {room} rooms");
        for (time, session) in ["a", "b"].into_iter().enumerate() {
            let body = json!({
                "session": session, "stamp": {"sec": room, "nanosec": time},
                "pose": {"translation": {"x": 10 * room, "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}},
                "bow": {"words": [room], "weights": [1]},
                "detections": [{"class": "door_number", "confidence": 0.9, "box": [0, 0, 10, 10],
                    "text": format!("7.{room:02}"), "position": [10 * room, 1, 2]}],
            });
            store(&server, &format!("{session}-{room}"), &body).await;
        }
    }
    let shown = async || server.get("/v1/maps/m").await.expect(200)["numbering"].clone();
    assert_eq!(shown().await, json!({"door_number": ["#.99"]}));
    server
        .patch("/v1/maps/m", &json!({"settings": {"identifier_patterns": ["[A-Z]\\d+"]}}))
        .await
        .expect(200);
    assert_eq!(shown().await, json!({}), "what was given stands in the settings");
}
