//! §IV-C.1, object tracking: which anchor a detection is one more sight of (M2 boxes, M3).

use revisit_core::Settings;
use revisit_core::domain::ids::AnchorSeq;

use super::scene::{Keyframe, Scene, Thing, close_to_all, keyframe, named, thing, unread};

/// The flat box from (0,0,2) to (1,1,2).
const CORNERS: [(i64, [f64; 3]); 2] = [(1, [0.0, 0.0, 2.0]), (2, [1.0, 1.0, 2.0])];

/// Far from everything.
const AWAY: [f64; 3] = [50.0, 0.0, 2.0];

/// A plate that nobody has read: what is undescribed matches nothing, so that association alone decides.
fn plate(class: &str) -> Thing {
    thing(class, "")
}

/// A keyframe with one plate on these points, numbered from 100.
fn on_points(class: &str, positions: &[[f64; 3]]) -> Keyframe {
    let points: Vec<(i64, [f64; 3])> = (100..).zip(positions.iter().copied()).collect();
    let ids = points.iter().map(|(id, _)| *id);
    keyframe().points(&points).sees([plate(class).on(ids.collect::<Vec<_>>())])
}

/// A map with one anchor, and sigma.
fn anchor_with_box(sigma: f64) -> Scene {
    let mut scene = Scene::with(Settings { association_min_point_share: sigma, ..Settings::default() });
    scene.put("kf-1", keyframe().points(&CORNERS).sees([plate("door_number").on([1, 2])]));
    scene
}

#[test]
fn a_detection_joins_an_anchor_that_covers_at_least_the_share_sigma_of_its_points() {
    let inside = [0.5, 0.5, 2.0];
    let some = |covered: usize, of: usize| -> Vec<[f64; 3]> {
        (0..of).map(|n| if n < covered { inside } else { AWAY }).collect()
    };
    let check =
        |what: &str, sigma: f64, class: &str, positions: &[[f64; 3]], covisible: bool, expected: &str| {
            let mut scene = anchor_with_box(sigma);
            let keyframe = on_points(class, positions);
            let keyframe = if covisible { keyframe.covisible(&["kf-1"]) } else { keyframe };
            let stored = scene.put("kf-2", keyframe);
            assert_eq!(named(stored.outcomes[0]), expected, "{what}");
        };
    check("1 of 5 is 0.2, which is enough", 0.2, "door_number", &some(1, 5), true, "observed");
    check("1 of 6 is less", 0.2, "door_number", &some(1, 6), true, "created");
    check("0 of 5", 0.2, "door_number", &some(0, 5), true, "created");
    check("3 of 5 at 0.6", 0.6, "door_number", &some(3, 5), true, "observed");
    check("2 of 5 at 0.6", 0.6, "door_number", &some(2, 5), true, "created");
    check("another class", 0.2, "shelf", &some(5, 5), true, "created");
    check("no covisible keyframe saw it", 0.2, "door_number", &some(5, 5), false, "created");
    check("a corner of the closed box", 0.2, "door_number", &[[1.0, 1.0, 2.0]], true, "observed");
    check("just outside the corner", 0.2, "door_number", &[[1.000_001, 1.0, 2.0]], true, "created");
    check("just before the flat box", 0.2, "door_number", &[[0.5, 0.5, 1.999_999]], true, "created");
}

/// Two anchors, the older over x 0..2 and the newer over x 1..3; what becomes of the plates on these points.
fn between_two(plates: &[&[f64]]) -> Vec<&'static str> {
    let mut scene = Scene::new();
    let corners = [(1, [0.0, 0.0, 2.0]), (2, [2.0, 1.0, 2.0]), (3, [1.0, 0.0, 2.0]), (4, [3.0, 1.0, 2.0])];
    let two = [plate("door_number").on([1, 2]), plate("door_number").on([3, 4])];
    let first = scene.put("kf-1", keyframe().points(&corners).sees(two));
    let known = scene.fed(&first);
    let (mut points, mut sights) = (Vec::new(), Vec::new());
    for xs in plates {
        let ids: Vec<i64> = (100 + points.len() as i64..).take(xs.len()).collect();
        points.extend(ids.iter().zip(*xs).map(|(id, x)| (*id, [*x, 0.5, 2.0])));
        sights.push(plate("door_number").on(ids));
    }
    let stored = scene.put("kf-2", keyframe().covisible(&["kf-1"]).points(&points).sees(sights));
    let name = |anchor: AnchorSeq| match known.iter().position(|known| *known == anchor) {
        Some(0) => "older",
        Some(_) => "newer",
        None => "new",
    };
    scene.fed(&stored).into_iter().map(name).collect()
}

#[test]
fn one_detection_of_a_keyframe_feeds_an_anchor_the_larger_share_first_then_the_older_anchor() {
    let check = |what: &str, plates: &[&[f64]], expected: &[&str]| {
        assert_eq!(between_two(plates), expected, "{what}");
    };
    check("both cover all: the older", &[&[1.5, 1.6]], &["older"]);
    check("3/5 of the older, 4/5 of the newer", &[&[0.5, 1.5, 1.6, 2.5, 2.6]], &["newer"]);
    check("4/5 of the older, 3/5 of the newer", &[&[0.5, 0.6, 1.5, 1.6, 2.5]], &["older"]);
    check("two of equal share take one each", &[&[1.5], &[1.6]], &["older", "newer"]);
    check("the larger share wins, whatever the order", &[&[0.5, 40.0], &[0.6]], &["new", "older"]);
    check("the third finds no anchor left", &[&[1.5], &[1.6], &[1.7]], &["older", "newer", "new"]);
}

#[test]
fn a_detection_with_only_a_position_joins_the_nearest_anchor_within_the_closed_radius() {
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
        let mut scene =
            Scene::with(Settings { association_position_radius_m: radius, ..Settings::default() });
        let known = scene.put("kf-1", keyframe().sees(anchors.iter().map(|x| unread([*x, 0.0, 2.0]))));
        let known = scene.fed(&known);
        let stored = scene.put("kf-2", keyframe().covisible(&["kf-1"]).sees([unread([x, 0.0, 2.0])]));
        match joined {
            Some(number) => assert_eq!(scene.fed(&stored)[0], known[number], "{what}"),
            None => assert_eq!(named(stored.outcomes[0]), "created", "{what}"),
        }
    }
}

#[test]
fn a_position_joins_only_its_class_and_only_what_a_covisible_keyframe_saw() {
    let check = |what: &str, class: &str, covisible: &[&str], expected: &str| {
        let mut scene = Scene::new();
        scene.put("kf-1", keyframe().sees([unread([0.0, 0.0, 2.0])]));
        let sight = plate(class).at([0.0, 0.0, 2.0]);
        let stored = scene.put("kf-2", keyframe().covisible(covisible).sees([sight]));
        assert_eq!(named(stored.outcomes[0]), expected, "{what}");
    };
    check("the same place", "door_number", &["kf-1"], "observed");
    check("another class", "shelf", &["kf-1"], "created");
    check("not covisible", "door_number", &[], "created");
}

#[test]
fn an_anchors_centre_is_the_centre_of_its_box_and_both_move_as_it_is_seen() {
    let mut scene = Scene::new();
    let see = |scene: &mut Scene, id: &str, before: &[&str], x: f64| {
        let stored = scene.put(id, keyframe().covisible(before).sees([unread([x, 0.0, 2.0])]));
        (scene.fed(&stored)[0], named(stored.outcomes[0]))
    };
    let (anchor, _) = see(&mut scene, "kf-1", &[], 0.0);
    assert_eq!(see(&mut scene, "kf-2", &["kf-1"], 0.5), (anchor, "observed"));
    // The box is 0 to 0.5, its centre 0.25: 1.0 is 0.75 away, though the first sight is a metre away.
    assert_eq!(see(&mut scene, "kf-3", &["kf-2"], 1.0), (anchor, "observed"));
    close_to_all("center", scene.anchor(anchor).centre(), [0.5, 0.0, 2.0]);
    // Now the centre is 0.5: 1.26 is 0.76 away, though the last sight is 0.26 away.
    assert_eq!(see(&mut scene, "kf-4", &["kf-3"], 1.26).1, "created");
}

#[test]
fn the_place_of_a_detection_is_its_map_points_and_position_serves_where_it_has_none() {
    let mut scene = Scene::new();
    let by_points = plate("door_number").on([1, 2]);
    let first = keyframe().points(&CORNERS).sees([by_points, unread([5.0, 0.0, 2.0])]);
    let known = scene.put("kf-1", first);
    let known = scene.fed(&known);
    let both = |point: i64| plate("door_number").on([point]).at([5.0, 0.0, 2.0]);
    let second = keyframe().covisible(&["kf-1"]).points(&[(9, [0.5, 0.5, 2.0])]);
    let stored = scene.put("kf-2", second.sees([both(9), both(77)]));
    // Point 9 lies in the first anchor's box; point 77 was never triangulated, and the position serves.
    assert_eq!(scene.fed(&stored), known);
}

#[test]
fn points_that_are_not_triangulated_yet_found_no_twin() {
    let mut scene = Scene::new();
    let known = scene.put("kf-1", keyframe().sees([plate("door_number").on([1, 2, 3])]));
    let next = || keyframe().covisible(&["kf-1"]);
    // One of two is the anchor's own: a share of 0.5.
    let stored = scene.put("kf-2", next().sees([plate("door_number").on([3, 4])]));
    assert_eq!(scene.fed(&stored), scene.fed(&known));
    let other = scene.put("kf-3", next().sees([plate("door_number").on([8, 9])]));
    assert_eq!(named(other.outcomes[0]), "created");
}
