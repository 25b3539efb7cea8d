//! Anchors beside geometry: held against its transformation, and borne out by it.

use revisit::geometry::Pose;
use serde_json::json;

use super::scene::{Shot, ask, asked, described, map, number, pose, query_pose, store};

#[tokio::test]
async fn geometry_on_map_points_is_a_witness_of_a_text_without_an_identifier() {
    let shot = |room, pose, session, features| {
        Shot::of(room, pose).plates(&[("Be Updated", [0.5, 0.0, 3.0])]).body(session, features)
    };
    let check = async |room: u64, features: bool, verify: &str, expected: [&str; 3]| {
        let candidate = shot(1, Pose::identity(), "a", true);
        let query = shot(room, query_pose(), "b", features);
        let (verdict, found) = asked(&candidate, &query, json!({}), verify).await;
        let code = found["reason"]["code"].as_str().unwrap_or("none");
        let status = found["geometry"]["status"].as_str().unwrap();
        assert_eq!([verdict.as_str(), status, code], expected, "{verify}: {found:#}");
    };
    check(1, true, "auto", ["loop", "verified", "none"]).await;
    check(1, true, "anchors", ["undecided", "skipped", "no_witness"]).await;
    check(1, false, "auto", ["undecided", "skipped", "no_witness"]).await;
    check(2, true, "auto", ["undecided", "skipped", "no_witness"]).await;
}

#[tokio::test]
async fn matched_anchors_must_stand_where_the_transformation_puts_them() {
    // 40 degrees apart at 4 m: within pi/3 and at the same distance, and 2.7 m from each other.
    let angle = 40.0_f64.to_radians();
    let candidate = Shot::of(1, Pose::identity()).plates(&[("room 901", [0.0, 0.0, 4.0])]).body("a", true);
    let query = Shot::of(1, Pose::identity())
        .plates(&[("room 901", [4.0 * angle.sin(), 0.0, 4.0 * angle.cos()])])
        .body("b", true);
    let (verdict, found) = asked(&candidate, &query, json!({}), "auto").await;
    assert_eq!(verdict, "no_loop", "{found:#}");
    assert_eq!(found["reason"]["code"], "anchors_disagree_with_transform");
    assert_eq!((number(&found["reason"]["measured"]), number(&found["reason"]["limit"])), (0.0, 0.3));
    let (verdict, _) = asked(&candidate, &query, json!({"aligned_anchors": false}), "auto").await;
    assert_eq!(verdict, "loop");
}

#[tokio::test]
async fn identifiers_contradict_under_the_transformation_where_bearings_cannot_tell() {
    // From 1.5 m nearer a plate's distance changes by 1.5 m: no contradiction by the gates of §V-B, but the same
    // place. Weights: 1/2.5 + 1/1 against 1/5.39 + 1/5.02 of the plate that matches.
    let near = |text| (text, [0.0, 0.0, 2.5]);
    let side = ("room 901", [5.0, 0.0, 2.0]);
    let settings = json!({"anchor_map_min_similarity": 0.1});
    let candidate =
        described(Shot::of(1, Pose::identity()).plates(&[side, near("room 777")]).body("a", true));
    let closer = || Shot::of(1, pose([0.0, 0.0, 1.5], 0.0));
    let query = described(closer().plates(&[side, near("room 955")]).body("b", true));
    let (verdict, found) = asked(&candidate, &query, settings.clone(), "anchors").await;
    assert_eq!(verdict, "loop", "{found:#}");
    let (verdict, found) = asked(&candidate, &query, settings.clone(), "auto").await;
    assert_eq!(
        (verdict.as_str(), &found["reason"]["code"]),
        ("no_loop", &json!("contradiction")),
        "{found:#}"
    );
    assert_eq!(found["anchors"]["contradictions"][0]["reason"], "reads 955 where 777 hung");
    // A metre away it is another plate.
    let query = described(closer().plates(&[side, ("room 955", [1.0, 0.0, 2.5])]).body("b", true));
    assert_eq!(asked(&candidate, &query, settings, "auto").await.0, "loop");
}

#[tokio::test]
async fn a_reading_of_one_passage_contradicts_only_where_geometry_cannot_run() {
    // Room 901 agrees with 1/5.10 + 1/5.10, and 777 contradicts 955 with 1/2 + 1/2.
    let plates = |text| [("room 901", [5.0, 0.0, 1.0]), (text, [0.0, 0.0, 2.0])];
    let shot = |text| Shot::of(1, Pose::identity()).plates(&plates(text));
    let server = map(json!({"anchor_map_min_similarity": 0.1, "company": false}), true).await;
    for (id, text) in
        [("first", "room 777"), ("candidate", "room 777"), ("before", "room 955"), ("query", "room 955")]
    {
        store(&server, id, &shot(text).body(id, true)).await;
    }
    let candidate = async |verify: &str| {
        let answer = ask(&server, verify).await;
        let found =
            answer["candidates"].as_array().unwrap().iter().find(|found| found["keyframe"] == "candidate");
        found.unwrap_or_else(|| panic!("{answer:#}")).clone()
    };
    let by_anchors = candidate("anchors").await;
    assert_eq!(
        (&by_anchors["verdict"], &by_anchors["reason"]["code"]),
        (&json!("rejected"), &json!("contradiction"))
    );
    let by_geometry = candidate("auto").await;
    assert_eq!(by_geometry["verdict"], "loop", "{by_geometry:#}");
    let difference = &by_geometry["anchors"]["differences"][0];
    assert_eq!(difference["reason"], "not_sure", "{by_geometry:#}");
    assert_eq!((number(&difference["measured"]), number(&difference["limit"])), (1.0, 2.0), "passages");
    // Confirmed loops make one plate of the two that a passage each read alike.
    for (id, keyframe, seen_before) in [("loop-1", "candidate", "first"), ("loop-2", "query", "before")] {
        let body = json!({"id": id, "keyframe": keyframe, "candidate": seen_before});
        server.post("/v1/maps/m/loops", &body).await.expect(201);
    }
    let read_twice = candidate("auto").await;
    assert_eq!(
        (&read_twice["verdict"], &read_twice["reason"]["code"]),
        (&json!("rejected"), &json!("contradiction"))
    );
}
