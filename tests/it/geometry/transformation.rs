//! The planted transformation is found, and what it is not is refused.

use revisit::geometry::Pose;
use serde_json::{Value, json};

use super::scene::{DOOR, POINTS, Shot, ask, asked, map, number, off, pose, query_pose, store};

#[tokio::test]
async fn the_same_room_is_verified_and_the_planted_transformation_found() {
    let candidate = Shot::of(1, Pose::identity()).plates(&[DOOR]);
    let mut query = Shot::of(1, query_pose()).plates(&[DOOR]);
    // The second robot's frame lies elsewhere and is turned.
    query.session_from_world = pose([10.0, -3.0, 2.0], 70.0);
    let (verdict, found) = asked(&candidate.body("a", true), &query.body("b", true), json!({}), "auto").await;
    assert_eq!((verdict.as_str(), &found["geometry"]["status"]), ("loop", &json!("verified")), "{found:#}");
    assert!(number(&found["geometry"]["inliers"]) >= 20.0, "{found:#}");
    let transform = &found["geometry"]["candidate_from_query"];
    let (metres, degrees) = off(transform, &query_pose());
    assert!(metres < 0.01 && degrees < 0.2, "{metres} m, {degrees} degrees");
    assert_eq!(number(&transform["scale"]), 1.0);
    assert_eq!(found["geometry"]["model"], "se3");
    assert!(number(&found["geometry"]["log10_false_alarms"]) < -6.0);
    let covariance = found["geometry"]["covariance"].as_array().expect("a full transform has one");
    assert!(covariance.len() == 36 && (0..6).all(|i| number(&covariance[i * 7]) > 0.0), "{covariance:?}");
}

#[tokio::test]
async fn another_room_with_the_same_plate_is_kept_from_a_loop_by_geometry_and_by_nothing_else() {
    let candidate = Shot::of(1, Pose::identity()).plates(&[DOOR]);
    let query = Shot::of(2, query_pose()).looking_like(1).plates(&[DOOR]);
    let check = async |features: bool, verify: &str, expected: [&str; 3]| {
        let (verdict, found) =
            asked(&candidate.body("a", true), &query.body("b", features), json!({}), verify).await;
        let code = found["reason"]["code"].as_str().unwrap_or("none");
        let status = found["geometry"]["status"].as_str().unwrap();
        assert_eq!([verdict.as_str(), status, code], expected, "{verify}: {found:#}");
    };
    check(true, "auto", ["undecided", "failed", "too_few_inliers"]).await;
    check(true, "geometry", ["undecided", "failed", "too_few_inliers"]).await;
    check(true, "anchors", ["loop", "skipped", "none"]).await;
    check(false, "auto", ["loop", "skipped", "none"]).await;
    check(false, "geometry", ["undecided", "skipped", "no_features"]).await;
    // With nothing to compare geometry cannot run; map points of both would have matched, so that it speaks against it.
    let query = Shot::of(2, query_pose()).plates(&[DOOR]);
    for verify in ["auto", "geometry"] {
        let (verdict, found) =
            asked(&candidate.body("a", true), &query.body("b", true), json!({}), verify).await;
        let said = (verdict.as_str(), found["geometry"]["status"].as_str().unwrap());
        assert_eq!(said, ("undecided", "skipped"), "{found:#}");
    }
}

#[tokio::test]
async fn the_best_loop_is_the_one_with_most_inliers() {
    let server = map(json!({"without_anchors": "geometry"}), true).await;
    for (id, points) in [("a-few", 45), ("b-most", POINTS)] {
        let mut shot = Shot::of(1, Pose::identity()).plates(&[DOOR]);
        shot.points = points;
        store(&server, id, &shot.body(id, true)).await;
    }
    store(&server, "query", &Shot::of(1, query_pose()).plates(&[DOOR]).body("q", true)).await;
    let answer = ask(&server, "auto").await;
    assert_eq!(answer["loops"], json!(["b-most", "a-few"]), "{answer:#}");
}

#[tokio::test]
async fn a_map_without_metres_finds_the_scale_and_settings_gate() {
    let server = map(json!({"without_anchors": "geometry"}), false).await;
    let mut candidate = Shot::of(1, Pose::identity()).plates(&[DOOR]);
    // The first robot's unit is half a metre: its numbers are twice as large.
    candidate.unit_m = 0.5;
    store(&server, "candidate", &candidate.body("a", true)).await;
    store(&server, "query", &Shot::of(1, query_pose()).plates(&[DOOR]).body("b", true)).await;
    let found = ask(&server, "auto").await["candidates"][0].clone();
    assert_eq!(found["verdict"], "loop", "{found:#}");
    let scale = number(&found["geometry"]["candidate_from_query"]["scale"]);
    assert!((scale - 2.0).abs() < 0.02, "{scale}");
    let counted = json!({"settings": {"geometry_min_inliers": 1000, "geometry_acceptance": "count"}});
    server.patch("/v1/maps/m", &counted).await.expect(200);
    let found = ask(&server, "auto").await["candidates"][0].clone();
    assert_eq!([&found["reason"]["code"], &found["geometry"]["status"]], ["too_few_inliers", "failed"]);
}

#[tokio::test]
async fn a_pose_that_its_points_do_not_share_is_taken_from_the_image() {
    // Odometry has the second robot's camera 0.3 m beside where its points have it.
    let server = map(json!({"without_anchors": "geometry"}), true).await;
    store(&server, "candidate", &Shot::of(1, Pose::identity()).plates(&[DOOR]).body("a", true)).await;
    let mut query = Shot::of(1, query_pose()).plates(&[DOOR]).body("b", true);
    query["pose"]["translation"]["x"] = json!(number(&query["pose"]["translation"]["x"]) + 0.3);
    store(&server, "query", &query).await;
    for resection in [true, false, true] {
        // The paper's method believes the pose; geometry counts alike in both.
        let method = if resection { "revisit" } else { "paper" };
        let settings = json!({"settings": {"method": method, "geometry_models": "auto",
            "geometry_landmark_sigma_px": 3.35}});
        server.patch("/v1/maps/m", &settings).await.expect(200);
        let found = ask(&server, "auto").await["candidates"][0].clone();
        let expected = if resection { "verified" } else { "failed" };
        assert_eq!(found["geometry"]["status"], expected, "{found:#}");
        if resection {
            let (apart_m, _) = off(&found["geometry"]["candidate_from_query"], &query_pose());
            assert!(apart_m < 0.02, "{apart_m} m, {found:#}");
        }
    }
}

/// An inlier is off by less than sqrt(9.21 (1 + 3.35^2)) = 10.6 px, and by the letter by less than sqrt(9.21) = 3.03 px.
#[tokio::test]
async fn map_points_a_hands_breadth_off_are_inliers_unless_keypoints_alone_scatter() {
    let server = map(json!({"without_anchors": "geometry"}), true).await;
    store(&server, "candidate", &Shot::of(1, Pose::identity()).plates(&[DOOR]).body("a", true)).await;
    let mut query = Shot::of(1, query_pose()).plates(&[DOOR]).body("b", true);
    let keypoints = query["features"]["keypoints"].as_array_mut().expect("keypoints");
    for (at, keypoint) in keypoints.iter_mut().enumerate() {
        let turn = at as f64 * 2.4;
        keypoint[0] = json!(number(&keypoint[0]) + 6.0 * turn.cos());
        keypoint[1] = json!(number(&keypoint[1]) + 6.0 * turn.sin());
    }
    store(&server, "query", &query).await;
    for (sigma_px, expected) in [(3.35, "verified"), (0.0, "failed"), (3.35, "verified")] {
        let settings = json!({"settings": {"geometry_landmark_sigma_px": sigma_px}});
        server.patch("/v1/maps/m", &settings).await.expect(200);
        let found = ask(&server, "auto").await["candidates"][0].clone();
        assert_eq!(found["geometry"]["status"], expected, "{sigma_px} px: {found:#}");
    }
}

#[tokio::test]
async fn a_thousand_times_the_same_question_from_eight_clients_gets_the_same_bytes() {
    let server = map(json!({}), true).await;
    store(&server, "candidate", &Shot::of(1, Pose::identity()).plates(&[DOOR]).body("a", true)).await;
    store(&server, "query", &Shot::of(1, query_pose()).plates(&[DOOR]).body("b", true)).await;
    let question = json!({"keyframe": "query", "seed": 7});
    let first = server
        .request(reqwest::Method::POST, "/v1/maps/m/loop-queries")
        .json(&question)
        .send()
        .await
        .unwrap();
    let timing = first.headers()["server-timing"].to_str().unwrap().to_owned();
    assert!(["queue", "screen", "features", "geometry"].iter().all(|step| timing.contains(step)), "{timing}");
    let first = first.bytes().await.unwrap();
    let clients = (0..8).map(|_| {
        let (request, first) =
            (server.request(reqwest::Method::POST, "/v1/maps/m/loop-queries"), first.clone());
        let request = request.json(&question);
        tokio::spawn(async move {
            for _ in 0..125 {
                let answer = request.try_clone().unwrap().send().await.unwrap();
                assert_eq!(answer.bytes().await.unwrap(), first);
            }
        })
    });
    for client in clients.collect::<Vec<_>>() {
        client.await.unwrap();
    }
    let other =
        server.post("/v1/maps/m/loop-queries", &json!({"keyframe": "query", "seed": 8})).await.expect(200);
    assert_ne!(other["id"], serde_json::from_slice::<Value>(&first).unwrap()["id"]);
}
