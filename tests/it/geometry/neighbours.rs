//! Neighbours: the plates of the drive count for a keyframe without an anchor near it, and covisible keyframes are verified in a
//! near miss's stead.

use base64::Engine as _;
use revisit::geometry::Pose;
use serde_json::{Value, json};

use super::scene::{DOOR, Shot, ask, asked, map, number, off, pose, query_pose, store};
use crate::support::Server;

/// A keyframe of another room, which shares twenty points with the next and the one before.
fn link(session: &str, at: u32, plates: &[(&'static str, [f64; 3])]) -> Value {
    let on_the_way = pose([0.2 * f64::from(at) - 0.6, 0.0, 0.0], 0.0);
    let mut body = Shot::of(9, on_the_way).plates(plates).body(session, false);
    body["bow"] = json!({"words": [50 + at], "weights": [1]});
    observing(body, at)
}

fn observing(mut body: Value, at: u32) -> Value {
    body["stamp"]["sec"] = json!(at);
    body["observes"] = json!((90_000 + 20 * at..90_040 + 20 * at).collect::<Vec<u32>>());
    body
}

/// Two drives to one view: four keyframes each, of which the first sees a plate, and the last is beyond its local map.
async fn drive_twice(server: &Server, plates: [&'static str; 2], room: u64) {
    for (session, plate) in ["a", "b"].into_iter().zip(plates) {
        store(server, &format!("{session}-0"), &link(session, 0, &[(plate, DOOR.1)])).await;
        for at in 1..=2 {
            store(server, &format!("{session}-{at}"), &link(session, at, &[])).await;
        }
    }
    store(server, "candidate", &observing(Shot::of(1, Pose::identity()).body("a", true), 3)).await;
    store(server, "query", &observing(Shot::of(room, query_pose()).body("b", true), 3)).await;
}

async fn found(server: &Server, verify: &str) -> Value {
    let answer = ask(server, verify).await;
    let candidates = answer["candidates"].as_array().unwrap();
    let found = candidates.iter().find(|found| found["keyframe"] == "candidate");
    found.unwrap_or_else(|| panic!("{answer:#}")).clone()
}

#[tokio::test]
async fn what_was_read_on_the_way_is_evidence_for_a_keyframe_without_an_anchor_near_it() {
    let check = async |settings: Value, plates, room, verify: &str, expected: [&str; 2]| {
        let server = map(settings, true).await;
        drive_twice(&server, plates, room).await;
        let found = found(&server, verify).await;
        let said = [&found["verdict"], &found["reason"]["code"]].map(|said| said.as_str().unwrap_or("none"));
        assert_eq!(said, expected, "{found:#}");
        found
    };
    let same = ["room 901"; 2];
    let found = check(json!({}), same, 1, "auto", ["loop", "none"]).await;
    assert_eq!([&found["geometry"]["status"], &found["evidence"][0]["about"]], ["verified", "room 901"]);
    assert_eq!(found["anchors"]["matches"], json!([]), "the plates are beyond the local maps");
    // Without a view nobody knows at which keyframe of the two drives they meet.
    check(json!({}), same, 1, "anchors", ["undecided", "too_little_evidence"]).await;
    // Another room that geometry finds speaks against it, and so do plates that differ.
    check(json!({}), same, 2, "auto", ["undecided", "too_few_inliers"]).await;
    check(json!({}), ["room 901", "room 777"], 1, "auto", ["rejected", "contradiction"]).await;
}

/// A view of room 1 in which all but the first points are taken for the next one: fourteen of thirty matches are right.
fn half_wrong() -> Value {
    const BYTES: usize = 32;
    let mut shot = Shot::of(1, Pose::identity()).plates(&[DOOR]);
    shot.points = 30;
    let mut body = shot.body("a", true);
    let base64 = &base64::engine::general_purpose::STANDARD;
    let mut descriptors = base64.decode(body["features"]["descriptors"].as_str().unwrap()).unwrap();
    assert_eq!(descriptors.len(), 30 * BYTES);
    descriptors[14 * BYTES..].rotate_left(BYTES);
    body["features"]["descriptors"] = json!(base64.encode(descriptors));
    body
}

#[tokio::test]
async fn a_covisible_keyframe_stands_in_for_a_near_miss() {
    let query = Shot::of(1, query_pose()).plates(&[DOOR]).body("b", true);
    let (_, alone) = asked(&half_wrong(), &query, json!({}), "auto").await;
    assert_eq!(alone["reason"]["code"], "too_few_inliers", "{alone:#}");
    let inliers = number(&alone["geometry"]["inliers"]);
    assert!((10.0..20.0).contains(&inliers), "{inliers}");

    let near_pose = pose([-0.3, 0.0, 0.2], -8.0);
    let mut near = Shot::of(1, near_pose).plates(&[DOOR]).body("a", true);
    // It shares a word with the query, and the candidate two.
    near["bow"] = json!({"words": [1, 77], "weights": [1, 9]});
    // Whose anchors alone agree does not stand in for what geometry rejects.
    let mut blind = near.clone();
    blind["observes"] = blind["features"]["map_points"].take();
    blind.as_object_mut().unwrap().remove("features");
    let cases = [
        ("revisit", &near, ["loop", "near"]),
        ("paper", &near, ["no_loop", "candidate"]),
        ("revisit", &blind, ["undecided", "candidate"]),
    ];
    for (method, near, expected) in cases {
        let server = map(json!({"method": method}), true).await;
        store(&server, "near", near).await;
        store(&server, "candidate", &half_wrong()).await;
        store(&server, "query", &query).await;
        let answer = ask(&server, "auto").await;
        let found = &answer["candidates"][0];
        assert_eq!([&answer["verdict"], &found["keyframe"]], expected, "{answer:#}");
        assert_eq!(answer["candidates"].as_array().unwrap().len(), 1);
        if expected[0] == "loop" {
            let geometry = &found["geometry"];
            assert!(number(&geometry["inliers"]) >= 20.0, "{geometry:#}");
            assert!(geometry["reason"].as_str().unwrap().starts_with("stands in for candidate"));
            let planted = near_pose.inverse().after(&query_pose());
            let (metres, degrees) = off(&geometry["candidate_from_query"], &planted);
            assert!(metres < 0.01 && degrees < 0.2, "{metres} m, {degrees} degrees");
        }
    }
}
