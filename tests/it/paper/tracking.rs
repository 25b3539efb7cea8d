//! §IV-C.1, object tracking: which anchor a detection is one more sight of (M2 boxes, M3).

use serde_json::{Value, json};

use super::scene::{Detection, Keyframe, Scene, close_to_all, keyframe, texts, thing, unread};

/// The flat box from (0,0,2) to (1,1,2).
const CORNERS: [(i64, [f64; 3]); 2] = [(1, [0.0, 0.0, 2.0]), (2, [1.0, 1.0, 2.0])];

/// Far from everything.
const AWAY: [f64; 3] = [50.0, 0.0, 2.0];

/// A plate that nobody has read: what is undescribed matches nothing, so that association alone decides.
fn plate(class: &str) -> Detection {
    thing(class, "")
}

/// A keyframe with one plate on these points, numbered from 100.
fn on_points(class: &str, positions: &[[f64; 3]]) -> Keyframe {
    let points: Vec<(i64, [f64; 3])> = (100..).zip(positions.iter().copied()).collect();
    let ids = points.iter().map(|(id, _)| *id);
    keyframe().points(&points).sees([plate(class).on(ids.collect::<Vec<_>>())])
}

async fn anchor_with_box(settings: Value) -> Scene {
    let scene = Scene::with(settings).await;
    scene.put("kf-1", keyframe().points(&CORNERS).sees([plate("door_number").on([1, 2])])).await;
    scene
}

#[tokio::test]
async fn a_detection_joins_an_anchor_that_covers_at_least_the_share_sigma_of_its_points() {
    let inside = [0.5, 0.5, 2.0];
    let some = |covered: usize, of: usize| -> Vec<[f64; 3]> {
        (0..of).map(|n| if n < covered { inside } else { AWAY }).collect()
    };
    let check = async |what: &str,
                       sigma: f64,
                       class: &str,
                       positions: &[[f64; 3]],
                       covisible: bool,
                       expected: &str| {
        let scene = anchor_with_box(json!({"association_min_point_share": sigma})).await;
        let keyframe = on_points(class, positions);
        let keyframe = if covisible { keyframe.covisible(&["kf-1"]) } else { keyframe };
        let answer = scene.put("kf-2", keyframe).await;
        assert_eq!(answer["detections"][0]["outcome"], expected, "{what}");
    };
    check("1 of 5 is 0.2, which is enough", 0.2, "door_number", &some(1, 5), true, "observed").await;
    check("1 of 6 is less", 0.2, "door_number", &some(1, 6), true, "created").await;
    check("0 of 5", 0.2, "door_number", &some(0, 5), true, "created").await;
    check("3 of 5 at 0.6", 0.6, "door_number", &some(3, 5), true, "observed").await;
    check("2 of 5 at 0.6", 0.6, "door_number", &some(2, 5), true, "created").await;
    check("another class", 0.2, "shelf", &some(5, 5), true, "created").await;
    check("no covisible keyframe saw it", 0.2, "door_number", &some(5, 5), false, "created").await;
    check("a corner of the closed box", 0.2, "door_number", &[[1.0, 1.0, 2.0]], true, "observed").await;
    check("just outside the corner", 0.2, "door_number", &[[1.000_001, 1.0, 2.0]], true, "created").await;
    check("just before the flat box", 0.2, "door_number", &[[0.5, 0.5, 1.999_999]], true, "created").await;
}

/// Two anchors, the older over x 0..2 and the newer over x 1..3; what becomes of the plates on these points.
async fn between_two(plates: &[&[f64]]) -> Vec<String> {
    let scene = Scene::new().await;
    let corners = [(1, [0.0, 0.0, 2.0]), (2, [2.0, 1.0, 2.0]), (3, [1.0, 0.0, 2.0]), (4, [3.0, 1.0, 2.0])];
    let two = [plate("door_number").on([1, 2]), plate("door_number").on([3, 4])];
    let first = scene.put("kf-1", keyframe().points(&corners).sees(two)).await;
    let known = texts(&first["detections"], "anchor");
    let (mut points, mut sights) = (Vec::new(), Vec::new());
    for xs in plates {
        let ids: Vec<i64> = (100 + points.len() as i64..).take(xs.len()).collect();
        points.extend(ids.iter().zip(*xs).map(|(id, x)| (*id, [*x, 0.5, 2.0])));
        sights.push(plate("door_number").on(ids));
    }
    let answer = scene.put("kf-2", keyframe().covisible(&["kf-1"]).points(&points).sees(sights)).await;
    let name = |anchor: String| match known.iter().position(|known| *known == anchor) {
        Some(0) => "older".to_owned(),
        Some(_) => "newer".to_owned(),
        None => "new".to_owned(),
    };
    texts(&answer["detections"], "anchor").into_iter().map(name).collect()
}

#[tokio::test]
async fn one_detection_of_a_keyframe_feeds_an_anchor_the_larger_share_first_then_the_older_anchor() {
    let check = async |what: &str, plates: &[&[f64]], expected: &[&str]| {
        assert_eq!(between_two(plates).await, expected, "{what}");
    };
    check("both cover all: the older", &[&[1.5, 1.6]], &["older"]).await;
    check("3/5 of the older, 4/5 of the newer", &[&[0.5, 1.5, 1.6, 2.5, 2.6]], &["newer"]).await;
    check("4/5 of the older, 3/5 of the newer", &[&[0.5, 0.6, 1.5, 1.6, 2.5]], &["older"]).await;
    check("two of equal share take one each", &[&[1.5], &[1.6]], &["older", "newer"]).await;
    check("the larger share wins, whatever the order", &[&[0.5, 40.0], &[0.6]], &["new", "older"]).await;
    check("the third finds no anchor left", &[&[1.5], &[1.6], &[1.7]], &["older", "newer", "new"]).await;
}

#[tokio::test]
async fn a_detection_with_only_a_position_joins_the_nearest_anchor_within_the_closed_radius() {
    // What; radius; the anchors' x; the detection's x; which it joins.
    type Case = (&'static str, f64, &'static [f64], f64, Option<usize>);
    let table: [Case; 7] = [
        ("exactly the radius", 0.75, &[0.0], 0.75, Some(0)),
        ("beyond it", 0.75, &[0.0], 0.750_001, None),
        ("another radius, exactly", 0.5, &[0.0], 0.5, Some(0)),
        ("another radius, beyond", 0.5, &[0.0], 0.75, None),
        ("the nearest", 0.75, &[0.0, 1.0], 0.625, Some(1)),
        ("the nearest is the older", 0.75, &[0.0, 1.0], 0.375, Some(0)),
        ("equally near: the older", 0.75, &[0.0, 1.0], 0.5, Some(0)),
    ];
    for (what, radius, anchors, x, joined) in table {
        let scene = Scene::with(json!({"association_position_radius_m": radius})).await;
        let known = scene.put("kf-1", keyframe().sees(anchors.iter().map(|x| unread([*x, 0.0, 2.0])))).await;
        let answer = scene.put("kf-2", keyframe().covisible(&["kf-1"]).sees([unread([x, 0.0, 2.0])])).await;
        let outcome = &answer["detections"][0];
        match joined {
            Some(number) => assert_eq!(outcome["anchor"], known["detections"][number]["anchor"], "{what}"),
            None => assert_eq!(outcome["outcome"], "created", "{what}"),
        }
    }
}

#[tokio::test]
async fn a_position_joins_only_its_class_and_only_what_a_covisible_keyframe_saw() {
    let check = async |what: &str, class: &str, covisible: &[&str], expected: &str| {
        let scene = Scene::new().await;
        scene.put("kf-1", keyframe().sees([unread([0.0, 0.0, 2.0])])).await;
        let sight = plate(class).at([0.0, 0.0, 2.0]);
        let answer = scene.put("kf-2", keyframe().covisible(covisible).sees([sight])).await;
        assert_eq!(answer["detections"][0]["outcome"], expected, "{what}");
    };
    check("the same place", "door_number", &["kf-1"], "observed").await;
    check("another class", "shelf", &["kf-1"], "created").await;
    check("not covisible", "door_number", &[], "created").await;
}

#[tokio::test]
async fn an_anchors_centre_is_the_centre_of_its_box_and_both_move_as_it_is_seen() {
    let scene = Scene::new().await;
    let see = async |id: &str, before: &[&str], x: f64| {
        scene.put(id, keyframe().covisible(before).sees([unread([x, 0.0, 2.0])])).await["detections"][0]
            .clone()
    };
    let anchor = see("kf-1", &[], 0.0).await["anchor"].clone();
    assert_eq!(see("kf-2", &["kf-1"], 0.5).await["anchor"], anchor);
    // The box is 0 to 0.5, its centre 0.25: 1.0 is 0.75 away, though the first sight is a metre away.
    assert_eq!(see("kf-3", &["kf-2"], 1.0).await["anchor"], anchor);
    let seen = scene.anchor(anchor.as_str().expect("an id")).await;
    close_to_all("center", &seen["center"], [0.5, 0.0, 2.0]);
    // Now the centre is 0.5: 1.26 is 0.76 away, though the last sight is 0.26 away.
    assert_eq!(see("kf-4", &["kf-3"], 1.26).await["outcome"], "created");
}

#[tokio::test]
async fn the_place_of_a_detection_is_its_map_points_and_position_serves_where_it_has_none() {
    let scene = Scene::new().await;
    let by_points = plate("door_number").on([1, 2]);
    let first = keyframe().points(&CORNERS).sees([by_points, unread([5.0, 0.0, 2.0])]);
    let known = texts(&scene.put("kf-1", first).await["detections"], "anchor");
    let both = |point: i64| plate("door_number").on([point]).at([5.0, 0.0, 2.0]);
    let second = keyframe().covisible(&["kf-1"]).points(&[(9, [0.5, 0.5, 2.0])]);
    let answer = scene.put("kf-2", second.sees([both(9), both(77)])).await;
    // Point 9 lies in the first anchor's box; point 77 was never triangulated, and the position serves.
    assert_eq!(texts(&answer["detections"], "anchor"), known);
}

#[tokio::test]
async fn points_that_are_not_triangulated_yet_found_no_twin() {
    let scene = Scene::new().await;
    let known = scene.put("kf-1", keyframe().sees([plate("door_number").on([1, 2, 3])])).await;
    // One of two is the anchor's own: a share of 0.5.
    let answer =
        scene.put("kf-2", keyframe().covisible(&["kf-1"]).sees([plate("door_number").on([3, 4])])).await;
    assert_eq!(answer["detections"][0]["anchor"], known["detections"][0]["anchor"]);
    let other =
        scene.put("kf-3", keyframe().covisible(&["kf-1"]).sees([plate("door_number").on([8, 9])])).await;
    assert_eq!(other["detections"][0]["outcome"], "created");
}
