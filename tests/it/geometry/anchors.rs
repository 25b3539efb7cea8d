//! Anchors beside geometry: held against its transformation, and borne out by it.

use revisit::geometry::Pose;
use serde_json::json;

use super::scene::{Shot, asked, described, number, pose, query_pose};

#[tokio::test]
async fn a_picture_and_a_view_are_a_loop_only_where_nothing_repeats() {
    let shot = |room, pose, session, features| {
        Shot::of(room, pose).plates(&[("Be Updated", [0.5, 0.0, 3.0])]).body(session, features)
    };
    let check = async |room: u64, features: bool, repeats: bool, expected: [&str; 3]| {
        let candidate = shot(1, Pose::identity(), "a", true);
        let query = shot(room, query_pose(), "b", features);
        let settings = json!({"building_repeats": repeats});
        let (verdict, found) = asked(&candidate, &query, settings, "auto").await;
        let code = found["reason"]["code"].as_str().unwrap_or("none");
        let status = found["geometry"]["status"].as_str().unwrap();
        assert_eq!([verdict.as_str(), status, code], expected, "{found:#}");
    };
    check(1, true, true, ["undecided", "skipped", "too_little_evidence"]).await;
    check(1, true, false, ["loop", "verified", "none"]).await;
    check(1, false, false, ["undecided", "skipped", "too_little_evidence"]).await;
    check(2, true, false, ["no_loop", "skipped", "too_few_inliers"]).await;
}

#[tokio::test]
async fn beside_a_name_a_picture_and_a_view_say_no_more_than_that_there_is_no_copy() {
    let plates = [("room 901", [0.5, 0.0, 3.0]), ("a painting of a red ship in a storm", [-1.0, 0.0, 3.0])];
    let candidate = Shot::of(1, Pose::identity()).plates(&plates).body("a", true);
    let query = Shot::of(1, query_pose()).plates(&plates).body("b", true);
    let (verdict, found) = asked(&candidate, &query, json!({}), "auto").await;
    let terms = found["evidence"].as_array().unwrap();
    let kinds: Vec<&str> = terms.iter().map(|term| term["kind"].as_str().unwrap()).collect();
    assert_eq!((verdict.as_str(), kinds), ("loop", vec!["name", "texts", "view", "copy"]), "{found:#}");
    let beside: f64 = terms[1..].iter().map(|term| number(&term["log_odds"])).sum();
    assert!((beside - 0.7).abs() < 1e-9, "{found:#}");
}

#[tokio::test]
async fn a_name_that_would_hang_in_two_places_under_the_transformation_speaks_against_it() {
    // 40 degrees apart at 4 m: within pi/3 and at the same distance, and 2.7 m from each other.
    let angle = 40.0_f64.to_radians();
    let candidate = Shot::of(1, Pose::identity()).plates(&[("room 901", [0.0, 0.0, 4.0])]).body("a", true);
    let query = Shot::of(1, Pose::identity())
        .plates(&[("room 901", [4.0 * angle.sin(), 0.0, 4.0 * angle.cos()])])
        .body("b", true);
    let (verdict, found) = asked(&candidate, &query, json!({}), "auto").await;
    assert_eq!(
        (verdict.as_str(), &found["reason"]["code"]),
        ("undecided", &json!("anchors_displaced")),
        "{found:#}"
    );
    let (verdict, _) = asked(&candidate, &query, json!({"method": "paper"}), "auto").await;
    assert_eq!(verdict, "loop", "the letter holds no anchor against a transformation");
}

#[tokio::test]
async fn identifiers_contradict_under_the_transformation_where_bearings_cannot_tell() {
    // From 1.5 m nearer a plate's distance changes by 1.5 m: no contradiction by the gates of §V-B, but the same
    // place.
    let near = |text| (text, [0.0, 0.0, 2.5]);
    let side = ("room 901", [5.0, 0.0, 2.0]);
    let candidate =
        described(Shot::of(1, Pose::identity()).plates(&[side, near("room 777")]).body("a", true));
    let closer = || Shot::of(1, pose([0.0, 0.0, 1.5], 0.0));
    let query = described(closer().plates(&[side, near("room 955")]).body("b", true));
    let (verdict, found) = asked(&candidate, &query, json!({}), "anchors").await;
    assert_eq!(verdict, "loop", "{found:#}");
    let (verdict, found) = asked(&candidate, &query, json!({}), "auto").await;
    assert_eq!(
        (verdict.as_str(), &found["reason"]["code"]),
        ("undecided", &json!("contradiction")),
        "{found:#}"
    );
    assert_eq!(found["reason"]["detail"], "reads room 955 where room 777 hung");
    // A metre away it is another plate.
    let query = described(closer().plates(&[side, ("room 955", [1.0, 0.0, 2.5])]).body("b", true));
    assert_eq!(asked(&candidate, &query, json!({}), "auto").await.0, "loop");
}
