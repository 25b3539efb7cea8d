//! §V-A, the local anchor map M_k: which anchors, where, and how heavy (M1, M2).

use revisit_core::domain::anchor::AnchorState;
use revisit_core::recognition::loops::anchor_map::LocalName;

use super::scene::{NAMES, Scene, close_to, close_to_all, descriptions, door, keyframe, thing, unread};

/// Half a right angle's sine, for quarter turns.
const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

fn around(scene: &Scene, keyframe: &str) -> Vec<String> {
    descriptions(&scene.local_map(keyframe))
}

#[test]
fn a_keyframe_without_neighbours_has_what_it_sees_itself() {
    let mut scene = Scene::new();
    scene.put("kf-1", keyframe().sees([door("901", [0.0, 0.0, 2.0])]));
    scene.put("kf-2", keyframe().sees([door("902", [0.0, 0.0, 2.0])]));
    assert_eq!(around(&scene, "kf-1"), ["901"]);
    assert_eq!(around(&scene, "kf-2"), ["902"]);
}

#[test]
fn anchors_of_keyframes_two_hops_away_are_in_and_three_hops_away_are_out() {
    // K_A^cov of the door of kf-n is {n-1, n, n+1}, and K_0^cov is {0, 1}: they meet for n = 0, 1, 2.
    let mut scene = Scene::new();
    let chain = ["kf-0", "kf-1", "kf-2", "kf-3", "kf-4"];
    for (n, id) in chain.into_iter().enumerate() {
        let before = if n == 0 { vec![] } else { vec![chain[n - 1]] };
        let x = n as f64 * 10.0;
        let sees = [door(NAMES[n], [x, 0.0, 2.0])];
        scene.put(id, keyframe().covisible(&before).at([x, 0.0, 0.0]).sees(sees));
    }
    let check = |id: &str, expected: &[&str]| assert_eq!(around(&scene, id), expected, "{id}");
    check("kf-0", &NAMES[..3]);
    check("kf-1", &NAMES[..4]);
    check("kf-2", &NAMES[..5]);
    check("kf-4", &NAMES[2..5]);
}

#[test]
fn a_bearing_is_a_unit_vector_in_the_camera_frame_and_the_distance_is_euclidean() {
    let check = |what: &str, rotation: [f64; 4], offset: [f64; 3], bearing: [f64; 3], distance_m: f64| {
        let mut scene = Scene::new();
        let place = [1.0, 2.0, 3.0];
        let anchor = [0, 1, 2].map(|axis| place[axis] + offset[axis]);
        scene.put("kf-1", keyframe().turned(place, rotation).sees([door("901", anchor)]));
        let found = scene.local_map("kf-1").remove(0);
        close_to_all(what, found.bearing.direction_in_camera(), bearing);
        close_to(what, found.bearing.distance_m(), distance_m);
        close_to(what, found.weight, 1.0 / distance_m);
    };
    let straight = [0.0, 0.0, 0.0, 1.0];
    check("ahead", straight, [0.0, 0.0, 2.0], [0.0, 0.0, 1.0], 2.0);
    check("right, 3-4-5", straight, [3.0, 0.0, 4.0], [0.6, 0.0, 0.8], 5.0);
    check("behind", straight, [0.0, 0.0, -4.0], [0.0, 0.0, -1.0], 4.0);
    check("2-3-6 is 7 away", straight, [2.0, 3.0, 6.0], [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0], 7.0);
    // A quarter turn about y (down): the camera looks along x of the map, and z of the map is on its left.
    let right = [0.0, HALF, 0.0, HALF];
    check("turned right, x is ahead", right, [2.0, 0.0, 0.0], [0.0, 0.0, 1.0], 2.0);
    check("turned right, z is left", right, [0.0, 0.0, 2.0], [-1.0, 0.0, 0.0], 2.0);
    check("turned right, down stays down", right, [0.0, 3.0, 0.0], [0.0, 1.0, 0.0], 3.0);
    check("turned right, 3-4-5", right, [3.0, 0.0, 4.0], [-0.8, 0.0, 0.6], 5.0);
    // A quarter turn about z (the camera rolls): x of the map is up in the image, that is -y.
    let rolled = [0.0, 0.0, HALF, HALF];
    check("rolled", rolled, [2.0, 0.0, 0.0], [0.0, -1.0, 0.0], 2.0);
    // -q is the same turn as q.
    let otherwise = [0.0, -HALF, 0.0, -HALF];
    check("turned right, otherwise written", otherwise, [2.0, 0.0, 0.0], [0.0, 0.0, 1.0], 2.0);
}

#[test]
fn where_an_anchor_stands_is_the_centre_of_its_box() {
    let mut scene = Scene::new();
    // Three of the four points are left; the box's centre is in the middle all the same.
    let points = [(1, [-1.0, 0.0, 2.0]), (2, [-0.9, 0.0, 2.0]), (3, [-0.8, 0.0, 2.0]), (4, [1.0, 0.0, 2.0])];
    scene.put("kf-1", keyframe().points(&points).sees([thing("door_number", "901").on(1..=4)]));
    let found = scene.local_map("kf-1").remove(0);
    close_to_all("bearing", found.bearing.direction_in_camera(), [0.0, 0.0, 1.0]);
    close_to("distance", found.bearing.distance_m(), 2.0);
}

#[test]
fn the_weight_is_one_over_the_distance_bounded_by_the_least_distance() {
    for (distance_m, weight) in [(4.0, 0.25), (0.5, 2.0), (0.1, 10.0), (0.05, 10.0), (0.0, 10.0)] {
        let mut scene = Scene::new();
        scene.put("kf-1", keyframe().sees([door("901", [0.0, 0.0, distance_m])]));
        close_to("weight", scene.local_map("kf-1")[0].weight, weight);
    }
}

#[test]
fn the_map_shows_every_anchor_around_with_its_class_and_state() {
    let mut scene = Scene::new();
    let sights =
        [door("901", [0.0, 0.0, 2.0]), thing("sign", "exit").at([3.0, 0.0, 2.0]), unread([-3.0, 0.0, 2.0])];
    let stored = scene.put("kf-1", keyframe().sees(sights));
    let found = scene.local_map("kf-1");
    let names: Vec<LocalName> = scene.fed(&stored).into_iter().map(LocalName::MergedAnchor).collect();
    assert_eq!(found.iter().map(|anchor| anchor.name).collect::<Vec<_>>(), names);
    let classes: Vec<&str> = found.iter().map(|anchor| &*anchor.class).collect();
    assert_eq!(classes, ["door_number", "sign", "door_number"]);
    let states: Vec<AnchorState> = found.iter().map(|anchor| anchor.state).collect();
    assert_eq!(states, [AnchorState::Valid, AnchorState::Uninformative, AnchorState::Pending]);
}
