//! Features without map points: images alone.

use revisit::geometry::Pose;
use serde_json::json;

use super::scene::{DOOR, POINTS, Shot, ask, asked, flat, map, number, pose, query_pose, store};

#[tokio::test]
async fn without_map_points_a_view_alone_is_a_loop_where_most_of_it_is_the_same() {
    let check = async |points: u64, models: &str, expected: [&str; 3]| {
        let shot = |pose| Shot { points, ..Shot::of(1, pose) };
        let (candidate, query) = (flat("a", shot(Pose::identity())), flat("b", shot(query_pose())));
        let settings =
            json!({"without_anchors": "geometry", "building_repeats": false, "geometry_models": models});
        let (verdict, found) = asked(&candidate, &query, settings, "auto").await;
        let status = found["geometry"]["status"].as_str().unwrap();
        let code = found["reason"]["code"].as_str().unwrap_or("none");
        assert_eq!([verdict.as_str(), status, code], expected, "{points}: {found:#}");
    };
    check(POINTS, "auto", ["loop", "verified", "none"]).await;
    check(60, "auto", ["undecided", "verified", "too_little_evidence"]).await;
    check(POINTS, "sim3", ["undecided", "skipped", "no_anchors"]).await;
}

#[tokio::test]
async fn images_alone_that_fail_do_not_reject_an_identifier_that_returns() {
    let flat = |session, shot: Shot| flat(session, shot.plates(&[DOOR]));
    let candidate = flat("a", Shot::of(1, Pose::identity()));
    let query = flat("b", Shot::of(2, query_pose()).looking_like(1));
    for (verify, expected) in [("auto", "loop"), ("geometry", "undecided")] {
        let (verdict, found) = asked(&candidate, &query, json!({}), verify).await;
        assert_eq!(
            (verdict.as_str(), &found["geometry"]["status"]),
            (expected, &json!("failed")),
            "{found:#}"
        );
    }
}

#[tokio::test]
async fn where_no_descriptor_matches_the_sign_must_be_in_view_of_both() {
    let server = map(json!({}), true).await;
    // The two share their points; only the second sees the plate itself.
    store(&server, "a-behind", &flat("a", Shot::of(1, Pose::identity()))).await;
    store(&server, "before", &flat("a", Shot::of(1, Pose::identity()).plates(&[DOOR]))).await;
    store(&server, "query", &flat("b", Shot::of(2, query_pose()).plates(&[DOOR]))).await;
    let answer = ask(&server, "auto").await;
    for (id, expected) in [("before", ["loop", "none"]), ("a-behind", ["undecided", "too_few_inliers"])] {
        let candidates = answer["candidates"].as_array().unwrap();
        let found = candidates.iter().find(|found| found["keyframe"] == id);
        let found = found.unwrap_or_else(|| panic!("{id}: {answer:#}"));
        let code = found["reason"]["code"].as_str().unwrap_or("none");
        assert_eq!([found["verdict"].as_str().unwrap(), code], expected, "{id}: {found:#}");
        assert_eq!(found["geometry"]["status"], "skipped", "{id}: {found:#}");
    }
}

#[tokio::test]
async fn points_that_nobody_has_triangulated_are_verified_by_directions_alone() {
    let candidate = Shot::of(1, Pose::identity()).plates(&[DOOR]);
    let flat = |shot: &Shot, session: &str| {
        let mut body = shot.body(session, true);
        body["map_points"] = json!({"ids": [], "positions": []});
        body
    };
    let check = async |query: &Shot, expected: [&str; 3]| {
        let (verdict, found) = asked(&flat(&candidate, "a"), &flat(query, "b"), json!({}), "geometry").await;
        let geometry = &found["geometry"];
        let said =
            [verdict.as_str(), geometry["model"].as_str().unwrap(), geometry["status"].as_str().unwrap()];
        assert_eq!(said, expected, "{found:#}");
        found
    };
    let moved = Shot::of(1, query_pose()).plates(&[DOOR]);
    let found = check(&moved, ["loop", "essential", "verified"]).await;
    // The direction is the planted one; its length nobody knows, and 1 is said.
    let t =
        ["x", "y", "z"].map(|axis| number(&found["geometry"]["candidate_from_query"]["translation"][axis]));
    let planted = query_pose().translation_m();
    let length = planted.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((0..3).all(|axis| (t[axis] - planted[axis] / length).abs() < 0.01), "{t:?}");
    // Two rooms that share nothing have no matches to compare: that rejects nothing.
    check(&Shot::of(2, query_pose()).plates(&[DOOR]), ["undecided", "essential", "skipped"]).await;
    // A camera that only turned.
    check(&Shot::of(1, pose([0.0; 3], 12.0)).plates(&[DOOR]), ["loop", "rotation", "verified"]).await;
}
