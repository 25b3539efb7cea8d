//! M6, distinctive weights: what stands in p places weighs (1/d) / p.

use serde_json::{Value, json};

use super::scene::{Scene, close_to, door, keyframe, thing};

/// A map in which EXIT is a valid description.
async fn with_signs(settings: Value) -> Scene {
    let base = json!({"description_min_information_level": 2, "single_text_needs_witness": false});
    Scene::with(super::scene::merged(base, &settings)).await
}

/// Something with this text hangs 2 m from a keyframe of its own, at each of these x.
async fn hang(scene: &Scene, session: &str, class: &str, text: &str, xs: impl IntoIterator<Item = f64>) {
    for (number, x) in xs.into_iter().enumerate() {
        let id = format!("{session}-{class}-{}-{number}", text.replace(' ', "-"));
        let sight = thing(class, text).at([x, 0.0, 2.0]);
        scene.put(&id, keyframe().session(session).at([x, 0.0, 0.0]).words(&[(99, 1.0)]).sees([sight])).await;
    }
}

/// The weight of what the keyframe sees.
async fn weight(scene: &Scene, keyframe: &str) -> f64 {
    scene.local_map(keyframe).await[0]["weight"].as_f64().expect("a weight")
}

#[tokio::test]
async fn a_description_that_stands_in_p_places_weighs_a_pth() {
    let check = async |what: &str, settings: Value, others: &[(&str, &str, &str, &[f64])], places: f64| {
        let scene = with_signs(settings).await;
        hang(&scene, "here", "sign", "EXIT", [0.0]).await;
        for (session, class, text, xs) in others {
            hang(&scene, session, class, text, xs.iter().copied()).await;
        }
        close_to(what, &json!(weight(&scene, "here-sign-EXIT-0").await), 0.5 / places);
    };
    let default = || json!({});
    check("it hangs once", default(), &[], 1.0).await;
    check("it hangs at three more places", default(), &[("here", "sign", "exit", &[10.0, 20.0, 30.0])], 4.0)
        .await;
    check("exactly 3 m apart is one place", default(), &[("here", "sign", "exit", &[3.0])], 1.0).await;
    check("more than 3 m apart are two", default(), &[("here", "sign", "exit", &[3.01])], 2.0).await;
    check(
        "another radius",
        json!({"distinctive_place_radius_m": 2.9}),
        &[("here", "sign", "exit", &[3.0])],
        2.0,
    )
    .await;
    check(
        "turned off",
        json!({"distinctive_weights": false}),
        &[("here", "sign", "exit", &[10.0, 20.0])],
        1.0,
    )
    .await;
    check("other texts are not counted", default(), &[("here", "sign", "toilet", &[10.0, 20.0])], 1.0).await;
    check("other classes are not counted", default(), &[("here", "poster", "EXIT", &[10.0, 20.0])], 1.0)
        .await;
    // Frames of different sessions cannot be compared: the largest count of any one of them, 3, and not 1 + 3.
    check("the largest of the sessions", default(), &[("there", "sign", "exit", &[0.0, 10.0, 20.0])], 3.0)
        .await;
    check("and not the smaller", default(), &[("there", "sign", "exit", &[50.0])], 1.0).await;
}

#[tokio::test]
async fn an_anchor_counts_with_those_it_matches() {
    let scene = Scene::new().await;
    hang(&scene, "here", "door_number", "901", [0.0]).await;
    hang(&scene, "here", "door_number", "room 901", [10.0]).await;
    hang(&scene, "here", "door_number", "910", [20.0]).await;
    close_to("901 and room 901", &json!(weight(&scene, "here-door_number-901-0").await), 0.25);
    close_to("910", &json!(weight(&scene, "here-door_number-910-0").await), 0.5);
}

/// Two passages 10 m apart, at which a sign and a door hang a metre from the camera, alike as the camera sees them.
async fn signs_and_doors(settings: Value, doors: [&str; 2], more_signs: usize) -> Value {
    let scene = with_signs(settings).await;
    for (id, x, plate) in [("candidate", 0.0, doors[0]), ("query", 10.0, doors[1])] {
        let sights = [thing("sign", "EXIT").at([x, 0.0, 1.0]), door(plate, [x + 1.0, 0.0, 0.0])];
        scene.put(id, keyframe().at([x, 0.0, 0.0]).sees(sights)).await;
    }
    hang(&scene, "default", "sign", "EXIT", (0..more_signs).map(|n| 20.0 + 10.0 * n as f64)).await;
    scene.compare("query", "candidate").await
}

#[tokio::test]
async fn a_sign_at_every_door_makes_no_loop_of_two_rooms() {
    let check = async |what: &str, settings: Value, doors: [&str; 2], more_signs: usize, expected: f64| {
        let veto = |settings: Value| {
            super::scene::merged(json!({"contradiction_veto": false, "company": false}), &settings)
        };
        let found = signs_and_doors(veto(settings), doors, more_signs).await;
        close_to(what, &found["anchors"]["similarity"], expected);
        assert_eq!(found["verdict"], if expected > 0.3 { "loop" } else { "rejected" }, "{what}");
    };
    // The paper's: (1 + 1) / 4, a loop between two rooms.
    check("equal weights", json!({"distinctive_weights": false}), ["901", "902"], 22, 0.5).await;
    // Signs weigh 1/24: (2/24) / (2/24 + 2) = 1/25.
    check("an EXIT sign at 24 doors", json!({}), ["901", "902"], 22, 0.04).await;
    // Signs weigh 1/2: (1/2 + 1/2) / (1/2 + 1 + 1/2 + 1) = 1/3.
    check("at two doors only", json!({}), ["901", "902"], 0, 1.0 / 3.0).await;
    // The door is one of a kind wherever it is seen, but here it is seen 10 m from itself: p = 2 for both.
    check("the same door, by a map that has drifted by 10 m", json!({}), ["901", "901"], 22, 1.0).await;
}

#[tokio::test]
async fn what_agrees_and_hangs_in_several_places_is_undecided() {
    let scene = Scene::new().await;
    hang(&scene, "here", "door_number", "901", [0.0, 10.0]).await;
    let sight = || [door("901", [0.0, 0.0, 2.0])];
    scene.put("query", keyframe().session("there").words(&[(99, 1.0)]).sees(sight())).await;
    let found = scene.compare("query", "here-door_number-901-0").await;
    let reason = &found["reason"];
    assert_eq!((&found["verdict"], &reason["code"]), (&json!("undecided"), &json!("not_distinctive")));
    assert_eq!((&reason["measured"], &reason["limit"]), (&json!(2.0), &json!(1.0)));
}

#[tokio::test]
async fn the_weight_of_a_pair_is_the_sum_of_the_two_distinctive_weights() {
    let found = signs_and_doors(json!({}), ["901", "902"], 2).await;
    // p = 4: 1/4 + 1/4.
    close_to("weight", &found["anchors"]["matches"][0]["weight"], 0.5);
}

/// A drive along x, a metre a keyframe, whose neighbours share twenty points; with an EXIT two metres ahead at each of `signs`,
/// `drift_m` farther on than it stands.
async fn drive(scene: &Scene, signs: &[(usize, f64)]) {
    let last = signs.last().map_or(0, |(at, _)| *at);
    for at in 0..=last {
        let x = at as f64;
        let sees = signs.iter().filter(|(sign, _)| *sign == at);
        let sees = sees.map(|(_, stands)| thing("sign", "EXIT").at([*stands, 0.0, 2.0])).collect::<Vec<_>>();
        let first_point = 20 * at as i64;
        let way = keyframe().at([x, 0.0, 0.0]).stamp(at).observes(first_point..first_point + 40);
        scene.put(&format!("drive-{at}"), way.words(&[(99, 1.0)]).sees(sees)).await;
    }
}

#[tokio::test]
async fn a_second_place_needs_more_than_odometry_may_have_drifted() {
    let check = async |what: &str, settings: Value, signs: &[(usize, f64)], places: f64| {
        let scene = with_signs(settings).await;
        drive(&scene, signs).await;
        let distance = ((signs[0].1).powi(2) + 4.0).sqrt();
        close_to(what, &json!(weight(&scene, "drive-0").await), 1.0 / distance / places);
    };
    // After 20 m odometry may be off by 5 % of them: 3 + 1 m.
    check("4 m apart after 20 m", json!({}), &[(0, 0.0), (20, 4.0)], 1.0).await;
    check("4.01 m apart after 20 m", json!({}), &[(0, 0.0), (20, 4.01)], 2.0).await;
    let off = json!({"odometry_max_drift_share": 0});
    check("without drift only the radius counts", off, &[(0, 0.0), (20, 4.0)], 2.0).await;
    // The third is held against the first alone: 3 + 1.5 m after 30 m.
    check("never from one to the next", json!({}), &[(0, 0.0), (20, 4.0), (30, 5.0)], 2.0).await;
}

#[tokio::test]
async fn what_one_local_anchor_map_holds_is_one_place() {
    // A room with two doors, 3.5 m apart, that bear its number; and the same from two keyframes that see nothing in common.
    let check = async |what: &str, covisible: &[&str], places: f64| {
        let scene = Scene::new().await;
        scene.put("one", keyframe().sees([door("901", [0.0, 0.0, 2.0])])).await;
        let other = keyframe().at([3.5, 0.0, 0.0]).covisible(covisible);
        scene.put("other", other.sees([door("901", [3.5, 0.0, 2.0])])).await;
        let map = scene.local_map("one").await;
        close_to(what, &map[0]["weight"], 0.5 / places);
    };
    check("in one local anchor map", &["one"], 1.0).await;
    check("in two", &[], 2.0).await;
}
