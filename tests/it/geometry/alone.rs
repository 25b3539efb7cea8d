//! Geometry without anchors: it decides where the map says so, and tells no room from its twin.

use revisit::geometry::Pose;
use serde_json::{Value, json};

use super::scene::{Shot, ask, asked, map, number, pose, query_pose, store};

#[tokio::test]
async fn without_anchors_geometry_decides_only_where_the_map_says_so() {
    let candidate = Shot::of(1, Pose::identity());
    let check = async |room: u64, features: bool, policy: &str, expected: [&str; 2]| {
        let query = Shot::of(room, query_pose()).body("b", features);
        let settings = json!({"without_anchors": policy});
        let (verdict, found) = asked(&candidate.body("a", true), &query, settings, "auto").await;
        assert_eq!(
            [verdict.as_str(), found["reason"]["code"].as_str().unwrap_or("none")],
            expected,
            "{found:#}"
        );
    };
    check(1, true, "geometry", ["loop", "none"]).await;
    check(2, true, "geometry", ["undecided", "no_features"]).await;
    check(1, false, "geometry", ["undecided", "no_features"]).await;
    check(1, true, "undecided", ["undecided", "no_anchors"]).await;
    check(1, true, "reject", ["no_loop", "no_anchors"]).await;
}

/// A twin of room 1, forty metres along the corridor: the same view, and map points of its own.
fn twin(session: &str, at_m: f64, sec: u32) -> Value {
    let mut shot = Shot::of(1, Pose::identity());
    shot.session_from_world = pose([at_m, 0.0, 0.0], 0.0);
    let mut body = shot.body(session, true);
    let ids: Vec<u64> =
        body["map_points"]["ids"].as_array().unwrap().iter().filter_map(Value::as_u64).collect();
    let own: Vec<u64> = ids.iter().map(|id| id + 1000 * u64::from(sec)).collect();
    body["map_points"]["ids"] = json!(own);
    body["features"]["map_points"] = json!(own);
    body["stamp"]["sec"] = json!(sec);
    body
}

#[tokio::test]
async fn geometry_alone_does_not_tell_a_room_from_its_twin() {
    let check = async |settings: Value, tracked: bool, expected: [&str; 2]| {
        let mut settings = settings;
        settings["without_anchors"] = json!("geometry");
        let server = map(settings, true).await;
        // Each keyframe shares twenty points with the next, unless tracking is lost.
        for at in 0..5_u32 {
            let mut body = match at {
                0 => twin("a", 0.0, 0),
                4 => twin("a", 40.0, 4),
                _ => {
                    let mut body = Shot::of(9, Pose::identity()).body("a", false);
                    body["pose"]["translation"]["x"] = json!(10 * at);
                    body["stamp"]["sec"] = json!(at);
                    body["bow"] = json!({"words": [50 + at], "weights": [1]});
                    body
                }
            };
            let first = 90_000 + if tracked || at < 2 { 20 * at } else { 20 * at + 500 };
            body["observes"] = json!((first..first + 40).collect::<Vec<u32>>());
            store(&server, &format!("a-{at}"), &body).await;
        }
        store(&server, "query", &Shot::of(1, query_pose()).body("b", true)).await;
        let answer = ask(&server, "auto").await;
        let first = &answer["candidates"][0];
        let code = first["reason"]["code"].as_str().unwrap_or("none");
        assert_eq!([answer["verdict"].as_str().unwrap(), code], expected, "{answer:#}");
        answer
    };
    let answer = check(json!({}), true, ["undecided", "ambiguous_places"]).await;
    let reason = &answer["candidates"][0]["reason"];
    let rival = &answer["candidates"][1]["geometry"]["inliers"];
    assert_eq!(number(&reason["limit"]), 2.0 * number(rival), "{answer:#}");
    check(json!({"rival_min_ratio": 0}), true, ["loop", "none"]).await;
    // Where tracking was lost nobody knows how far apart the two are.
    check(json!({}), false, ["loop", "none"]).await;
}
