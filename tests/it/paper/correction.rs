//! What moves and what goes (M33): corrected poses and map points, and culled keyframes.

use serde_json::{Value, json};

use super::scene::{NAMES, Scene, close_to, close_to_all, door, keyframe, list, texts, thing, turned};
use crate::support::pose;

const STRAIGHT: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

fn poses(keyframes: &[(&str, Value)], points: &[(i64, [f64; 3])]) -> Value {
    let (ids, poses): (Vec<&str>, Vec<&Value>) = keyframes.iter().map(|(id, pose)| (*id, pose)).unzip();
    let (points, positions): (Vec<i64>, Vec<[f64; 3]>) = points.iter().copied().unzip();
    json!({"keyframes": {"ids": ids, "poses": poses}, "map_points": {"ids": points, "positions": positions}})
}

#[tokio::test]
async fn a_box_follows_its_map_points() {
    let scene = Scene::new().await;
    let points = [(1, [0.0, 0.0, 2.0]), (2, [1.0, 1.0, 2.0]), (3, [9.0, 9.0, 9.0])];
    scene.put("kf-1", keyframe().points(&points).sees([thing("door_number", "901").on([1, 2])])).await;
    scene.post("/poses", &poses(&[], &[(2, [3.0, 1.0, 4.0])])).await;
    let anchor = scene.anchors().await.remove(0);
    close_to_all("min", &anchor["box"]["min"], [0.0, 0.0, 2.0]);
    close_to_all("max", &anchor["box"]["max"], [3.0, 1.0, 4.0]);
    close_to_all("center", &anchor["center"], [1.5, 0.5, 3.0]);
    // It shrinks too, and the keyframe's pose alone moves no point.
    scene.post("/poses", &poses(&[("kf-1", pose([0.0, 0.0, 1.0]))], &[(2, [0.0, 0.0, 2.0])])).await;
    let around = scene.local_map("kf-1").await;
    close_to("distance", &around[0]["distance_m"], 1.0);
}

#[tokio::test]
async fn points_that_a_later_keyframe_moves_or_triangulates_move_the_box_too() {
    let scene = Scene::new().await;
    scene
        .put(
            "kf-1",
            keyframe().points(&[(1, [0.0, 0.0, 2.0])]).sees([thing("door_number", "901").on([1, 2])]),
        )
        .await;
    close_to_all("one point", &scene.anchors().await[0]["center"], [0.0, 0.0, 2.0]);
    scene.put("kf-2", keyframe().points(&[(2, [4.0, 0.0, 2.0])])).await;
    close_to_all("two points", &scene.anchors().await[0]["center"], [2.0, 0.0, 2.0]);
    scene.put("kf-3", keyframe().points(&[(1, [2.0, 0.0, 2.0])])).await;
    close_to_all("one moved", &scene.anchors().await[0]["center"], [3.0, 0.0, 2.0]);
}

#[tokio::test]
async fn an_anchor_known_by_position_alone_moves_with_its_keyframe() {
    let scene = Scene::new().await;
    scene.put("kf-1", keyframe().at([1.0, 0.0, 0.0]).sees([door("901", [1.0, 0.0, 2.0])])).await;
    let before = scene.local_map("kf-1").await;
    // A quarter turn about y takes ahead (z) to x: 2 m ahead of (10, 5, 0) is (12, 5, 0).
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let answer = scene
        .post("/poses", &poses(&[("kf-1", turned([10.0, 5.0, 0.0], [0.0, half, 0.0, half]))], &[]))
        .await;
    assert_eq!([&answer["keyframes"], &answer["map_points"]], [1, 0]);
    close_to_all("center", &scene.anchors().await[0]["center"], [12.0, 5.0, 0.0]);
    assert_eq!(scene.local_map("kf-1").await, before, "what the camera sees has not changed");
    close_to_all(
        "pose",
        &vector(&scene.get("/keyframes/kf-1").await["pose"]["translation"]),
        [10.0, 5.0, 0.0],
    );
}

fn vector(translation: &Value) -> Value {
    json!([translation["x"], translation["y"], translation["z"]])
}

#[tokio::test]
async fn each_sight_by_position_moves_with_its_own_keyframe() {
    let scene = Scene::new().await;
    scene.put("kf-1", keyframe().sees([door("901", [0.0, 0.0, 2.0])])).await;
    scene.put("kf-2", keyframe().covisible(&["kf-1"]).sees([door("901", [0.5, 0.0, 2.0])])).await;
    scene.post("/poses", &poses(&[("kf-2", turned([1.0, 0.0, 0.0], STRAIGHT))], &[])).await;
    let anchor = scene.anchors().await.remove(0);
    close_to_all("min", &anchor["box"]["min"], [0.0, 0.0, 2.0]);
    close_to_all("max", &anchor["box"]["max"], [1.5, 0.0, 2.0]);
}

#[tokio::test]
async fn corrected_poses_change_the_verdict() {
    let scene = Scene::new().await;
    // By points, so that only the keyframe moves: 901 is 2 m ahead, and then 5 m.
    let seen =
        |id: i64| keyframe().points(&[(id, [0.0, 0.0, 2.0])]).sees([thing("door_number", "901").on([id])]);
    scene.put("kf-1", seen(1)).await;
    scene.put("kf-9", seen(2)).await;
    close_to("S", &scene.compare("kf-9", "kf-1").await["anchors"]["similarity"], 1.0);
    scene.post("/poses", &poses(&[("kf-9", pose([0.0, 0.0, -3.0]))], &[])).await;
    close_to("S", &scene.compare("kf-9", "kf-1").await["anchors"]["similarity"], 0.0);
}

#[tokio::test]
async fn a_correction_is_taken_over_whole_or_not_at_all() {
    let scene = Scene::new().await;
    scene
        .put("kf-1", keyframe().points(&[(1, [0.0, 0.0, 2.0])]).sees([thing("door_number", "901").on([1])]))
        .await;
    let before = (scene.get("/keyframes/kf-1").await, scene.get("/anchors").await);
    let body = poses(
        &[("kf-1", pose([9.0, 0.0, 0.0])), ("kf-none", pose([9.0, 0.0, 0.0]))],
        &[(1, [5.0, 5.0, 5.0])],
    );
    let answer = scene.server.post(&scene.path("/poses"), &body).await;
    assert_eq!(answer.status.as_u16(), 422);
    assert_eq!(answer.pointers(), ["/keyframes/ids/1"]);
    assert_eq!((scene.get("/keyframes/kf-1").await, scene.get("/anchors").await), before);
}

#[tokio::test]
async fn a_culled_keyframe_takes_its_covisibility_and_its_sights_with_it() {
    let scene = Scene::new().await;
    let chain = [("kf-0", 0.0, "901"), ("kf-1", 0.5, "907"), ("kf-2", 0.75, "907")];
    for (n, (id, x, text)) in chain.into_iter().enumerate() {
        let before = if n == 0 { vec![] } else { vec![chain[n - 1].0] };
        let plate = door(text, [x, 0.0, 2.0]).confidence(0.75);
        scene
            .put(id, keyframe().covisible(&before).sees([plate, door(NAMES[n], [n as f64 * 9.0, 9.0, 2.0])]))
            .await;
    }
    let [plate, own, lost, far] = scene.anchors().await.try_into().expect("four anchors");
    assert_eq!(plate["description"], "907");
    close_to_all("max", &plate["box"]["max"], [0.75, 0.0, 2.0]);
    assert_eq!(scene.local_map("kf-0").await.len(), 4);

    scene.delete("/keyframes/kf-1").await;
    assert_eq!(scene.server.get(&scene.path("/keyframes/kf-1")).await.status.as_u16(), 404);
    for id in ["kf-0", "kf-2"] {
        assert_eq!(scene.covisible(id).await, Vec::<String>::new(), "{id}");
    }
    let id = |anchor: &Value| anchor["id"].as_str().expect("an id").to_owned();
    // It had been seen by no other keyframe.
    assert_eq!(scene.server.get(&scene.path(&format!("/anchors/{}", id(&lost)))).await.status.as_u16(), 404);
    let plate = scene.anchor(&id(&plate)).await;
    assert_eq!(plate["keyframes"], json!(["kf-0", "kf-2"]));
    assert_eq!(texts(&plate["readings"], "text"), ["907", "901"], "a tie goes to the newest");
    assert_eq!(texts(&json!(scene.local_map("kf-0").await), "anchor"), [id(&plate), id(&own)]);

    scene.delete("/keyframes/kf-2").await;
    let plate = scene.anchor(&id(&plate)).await;
    assert_eq!(plate["description"], "901");
    close_to_all("max", &plate["box"]["max"], [0.0, 0.0, 2.0]);
    assert_eq!(list(&json!(scene.anchors().await)).len(), 2, "and {} is gone too", id(&far));
}

#[tokio::test]
async fn a_culled_keyframe_is_no_candidate_and_counts_for_nothing() {
    let scene = Scene::new().await;
    scene.put("kf-1", keyframe().sees([door("901", [0.0, 0.0, 2.0])])).await;
    scene.put("kf-2", keyframe().covisible(&["kf-1"])).await;
    scene.put("kf-9", keyframe().sees([door("901", [0.0, 0.0, 2.0])])).await;
    assert_eq!(scene.ask("kf-9").await["best"], "kf-1");
    scene.delete("/keyframes/kf-1").await;
    let answer = scene.ask("kf-9").await;
    assert_eq!(texts(&answer["candidates"], "keyframe"), ["kf-2"]);
    assert_eq!(answer["verdict"], "undecided");
    assert_eq!(scene.ask("kf-2").await["excluded_covisible"], 0);
}

#[tokio::test]
async fn a_map_point_goes_with_the_last_keyframe_that_observed_it() {
    let scene = Scene::new().await;
    let at = [0.0, 0.0, 2.0];
    let sent =
        keyframe().points(&[(1, at), (2, at), (3, at), (4, at)]).sees([thing("door_number", "901").on([1])]);
    scene.put("kf-1", sent.observes([1, 2, 3])).await;
    scene.put("kf-2", keyframe().observes([2])).await;
    scene.delete("/keyframes/kf-1").await;
    // Whoever sees them later has no place for them, but for the one that stayed observed and the one nobody has observed yet.
    for (point, placed) in [(1, false), (2, true), (3, false), (4, true)] {
        let id = format!("kf-later-{point}");
        scene.put(&id, keyframe().sees([thing("sign", &format!("sign {point}")).on([point])])).await;
        let anchor = scene.anchors().await.pop().expect("an anchor");
        assert_eq!(anchor["center"].is_array(), placed, "point {point}: {anchor}");
    }
}
