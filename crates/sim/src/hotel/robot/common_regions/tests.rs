//! Two passes along a wall of points, with expected values by hand.

use super::confirmation::{Confirmation, Proposal};
use super::projection::{Image, Search};
use super::refinement::refined;
use super::window::{WindowPoint, keyframes_around, keyframes_farther_around, points_of};
use crate::domain::keyframe::Keypoint;
use crate::geometry::{Point3, Pose, Sim3};
use crate::hotel::building::texture::Descriptor;
use crate::hotel::rng::SeededRng;
use crate::hotel::robot::slam_map::SlamMap;
use crate::hotel::route::{Place, Stop};
use crate::hotel::sensing::camera::{PINHOLE, Stand, unproject};
use crate::hotel::sensing::sensor::Feature;
use crate::hotel::sequence::{Placed, Step};

/// The octave of all observations.
const OCTAVE: u8 = 3;
/// Distance between successive keyframes along the wall, in metres.
const STEP_M: f64 = 0.05;

fn level(x: f64) -> Pose {
    Pose::new([x, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).expect("a pose")
}

fn turned(x: f64, by_rad: f64) -> Pose {
    Pose::new([x, 0.0, 0.0], [0.0, (by_rad / 2.0).sin(), 0.0, (by_rad / 2.0).cos()]).expect("a pose")
}

fn feature(point: u32, pixel: [f64; 2], depth_m: f64, octave: u8, descriptor: Descriptor) -> Feature {
    let keypoint = Keypoint { u: pixel[0], v: pixel[1], octave, angle_deg: None };
    Feature { point, keypoint, descriptor, in_camera: unproject(pixel, depth_m) }
}

/// Returns points about 3 m in front of a camera at the origin, each with its own descriptor.
fn wall(points: u32) -> Vec<(Point3, Descriptor)> {
    let mut rng = SeededRng::new(7, "wall");
    let place =
        |rng: &mut SeededRng| Point3::new(rng.within(-1.2, 1.2), rng.within(-0.9, 0.9), rng.within(2.5, 3.5));
    (0..points).map(|_| (place(&mut rng), std::array::from_fn(|_| rng.bits()))).collect()
}

/// Returns a keyframe at `x` that sees the wall, with map points numbered from `first_id`.
fn step(wall: &[(Point3, Descriptor)], x: f64, first_id: u64) -> Step {
    let features: Vec<Feature> = (wall.iter().enumerate())
        .map(|(number, (point, descriptor))| {
            let in_camera = level(x).inverse_transform(point);
            let pixel = PINHOLE.project(&in_camera.coords).expect("in front");
            feature(number as u32, pixel, in_camera.z, OCTAVE, *descriptor)
        })
        .collect();
    let map_points = (0..features.len() as u64).map(|number| first_id + number).collect();
    let stand = Stand { at: [x, 0.0], heading_rad: 0.0 };
    let stop = Stop { stand, place: Place::Corridor, visit: 0, storey: 0 };
    let placed = (features.iter().enumerate())
        .map(|(feature, seen)| Placed { feature, in_camera: seen.in_camera })
        .collect();
    Step { stop, motion: Pose::identity(), features, map_points, placed, detections: Vec::new() }
}

/// Returns `passes` along the wall of four keyframes each, without common map points.
fn passes(wall: &[(Point3, Descriptor)], passes: usize) -> Vec<Step> {
    let keyframe = |number: usize| step(wall, STEP_M * (number % 4) as f64, 1_000 * (number / 4) as u64);
    (0..4 * passes).map(keyframe).collect()
}

fn map(steps: &[Step]) -> SlamMap<'_> {
    let mut map = SlamMap::default();
    for step in steps {
        map.push(step, &Sim3::from(level(step.stop.stand.at[0])));
    }
    map
}

fn proposal(candidate: usize, candidate_from_query: Pose) -> Proposal {
    Proposal { candidate: (0, candidate), candidate_from_query, answer: String::from("q") }
}

#[test]
fn a_point_is_found_where_it_must_be_if_it_looks_alike_from_there() {
    let look: Descriptor = [0; 4];
    // 4 m ahead, first seen from slightly nearer, so that its predicted octave is the observed one.
    let point = |octave| WindowPoint {
        in_candidate: Point3::new(0.0, 0.0, 4.0),
        first_seen_from: Point3::new(0.0, 0.0, 0.1),
        octave,
        descriptor: look,
    };
    let with_bits =
        |bits: u32| [u64::MAX >> (64 - bits.min(64)), (1_u64 << bits.saturating_sub(64)) - 1, 0, 0];
    let found = |point: WindowPoint, off_px: f64, octave: u8, bits: u32, search: Search| {
        let features = [feature(0, [320.0 + off_px, 240.0], 4.0, octave, with_bits(bits))];
        !Image::new(&features).search(&[point], &Pose::identity(), search).is_empty()
    };
    for (name, search, radius_px, bits) in [
        ("first", Search::FIRST, 8.0, 75),
        ("refined", Search::REFINED, 5.0, 50),
        ("neighbours", Search::NEIGHBOURS, 3.0, 75),
    ] {
        assert!(found(point(0), radius_px - 0.1, 0, bits, search), "{name}");
        assert!(!found(point(0), radius_px + 0.1, 0, bits, search), "{name}: too far off");
        assert!(!found(point(0), 0.0, 0, bits + 1, search), "{name}: looks otherwise");
        assert!(
            found(point(2), radius_px * 1.43, 2, bits, search),
            "{name}: the radius grows with the octave"
        );
    }
    for (octave, is_found) in [(1, false), (2, true), (3, true), (4, false)] {
        assert_eq!(found(point(3), 0.0, octave, 1, Search::FIRST), is_found, "octave {octave}");
    }
    let seen_from = |x: f64, z: f64| WindowPoint { first_seen_from: Point3::new(x, 0.0, z), ..point(7) };
    // From 59 and from 61 degrees.
    for (degrees, is_found) in [(59.0_f64, true), (61.0, false)] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let from_aside = seen_from(3.9 * sine, 4.0 - 3.9 * cosine);
        assert_eq!(found(from_aside, 0.0, 7, 1, Search::FIRST), is_found, "{degrees} degrees");
    }
    // Seen in octave 0 from 3.9 m, it is not recognised beyond 1.2 times that.
    for (z, is_found) in [(0.1, true), (0.6, true), (0.7, false)] {
        let nearer = WindowPoint { octave: 0, ..seen_from(0.0, z) };
        assert_eq!(found(nearer, 0.0, 0, 1, Search::FIRST), is_found, "first seen {} m before it", 4.0 - z);
    }
}

#[test]
fn a_feature_shows_one_point() {
    let point = WindowPoint {
        in_candidate: Point3::new(0.0, 0.0, 4.0),
        first_seen_from: Point3::new(0.0, 0.0, 0.1),
        octave: 0,
        descriptor: [0; 4],
    };
    let features = [feature(0, [320.0, 240.0], 4.0, 0, [0; 4]), feature(1, [322.0, 240.0], 4.0, 0, [1; 4])];
    let found = Image::new(&features).search(&[point; 3], &Pose::identity(), Search::FIRST);
    let pairs: Vec<(usize, usize)> = found.iter().map(|found| (found.point, found.feature)).collect();
    assert_eq!(pairs, [(0, 0), (1, 1)], "the likest first, and nothing for the third");
}

#[test]
fn a_window_is_what_the_keyframes_around_see_as_the_candidate_has_it() {
    let wall = wall(40);
    // The third sees only the last points, 14 of them with the second; the fourth is another place.
    let steps = [
        step(&wall[..30], 0.0, 0),
        step(&wall[10..], 0.1, 10),
        step(&wall[26..], 0.2, 26),
        step(&wall, 0.0, 1_000),
    ];
    let map = map(&steps);
    assert_eq!(map.covisible(1, 10), [0], "20 shared points; 14 are too few");
    assert_eq!(Vec::from_iter(keyframes_around(&map, 1)), [0, 1]);
    let points = points_of(&map, &keyframes_around(&map, 1), 1);
    assert_eq!(points.len(), 40);
    assert!((points[0].in_candidate - level(0.1).inverse_transform(&wall[0].0)).norm() < 1e-9);
    assert!((points[0].first_seen_from - Point3::new(-0.1, 0.0, 0.0)).norm() < 1e-12);
    assert_eq!(points[39].first_seen_from, Point3::origin(), "the candidate saw it first itself");
}

#[test]
fn few_covisible_keyframes_bring_theirs() {
    let wall = wall(60);
    let steps = [step(&wall[..20], 0.0, 0), step(&wall[..40], 0.0, 0), step(&wall[20..], 0.0, 20)];
    let map = map(&steps);
    let around = |left_out: &[usize]| -> Vec<usize> {
        keyframes_farther_around(&map, 0, &left_out.iter().copied().collect()).into_iter().collect()
    };
    assert_eq!(around(&[]), [0, 1, 2]);
    assert_eq!(around(&[2]), [0, 1]);
}

#[test]
fn a_transformation_is_refined_to_where_the_points_are() {
    let wall = wall(100);
    let steps = passes(&wall, 2);
    let map = map(&steps);
    let window = points_of(&map, &keyframes_around(&map, 0), 0);
    let image = Image::new(map.features(6));
    let query_points: Vec<Point3> = map.features(6).iter().map(|feature| feature.in_camera).collect();
    let guess = turned(2.0 * STEP_M + 0.02, 0.008);
    let found = image.search(&window, &guess, Search::FIRST);
    let refined = refined(&guess, &image, &query_points, &window, &found).expect("a transformation");
    assert_eq!(refined.inliers, found.len());
    let off = refined.candidate_from_query.inverse().after(&level(2.0 * STEP_M));
    assert!(off.centre().coords.norm() < 1e-6 && off.rotation_xyzw()[3] > 1.0 - 1e-12, "{off:?}");
}

#[test]
fn a_loop_is_confirmed_by_three_neighbours_that_see_the_same() {
    for (points, is_confirmed) in [(100, true), (80, true), (79, false)] {
        let steps = passes(&wall(points), 2);
        let map = map(&steps);
        let confirmed = Confirmation::default().hear(&[&map], (0, 7), &[proposal(2, turned(STEP_M, 0.005))]);
        assert_eq!(confirmed.is_some(), is_confirmed, "{points} points");
        if let Some(confirmed) = confirmed {
            assert_eq!((confirmed.candidate, confirmed.answer.as_str()), ((0, 2), "q"));
            assert!((confirmed.candidate_from_query.centre() - level(STEP_M).centre()).norm() < 1e-6);
        }
    }
}

#[test]
fn a_neighbour_agrees_that_sees_thirty_points() {
    let wall = wall(100);
    for (seen, is_confirmed) in [(30, true), (29, false)] {
        let mut steps = passes(&wall, 1);
        steps.extend((0..3).map(|number| step(&wall[..seen], STEP_M * f64::from(number), 1_000)));
        steps.push(step(&wall, 3.0 * STEP_M, 1_000));
        let map = map(&steps);
        let confirmed = Confirmation::default().hear(&[&map], (0, 7), &[proposal(3, level(0.0))]);
        assert_eq!(confirmed.is_some(), is_confirmed, "{seen} points");
    }
}

#[test]
fn a_loop_with_another_robot_is_confirmed_like_one_of_its_own() {
    let wall = wall(100);
    let [first, second] = [passes(&wall, 1), passes(&wall, 1)];
    let maps = [map(&first), map(&second)];
    let told = [proposal(1, level(2.0 * STEP_M))];
    let confirmed = Confirmation::default().hear(&[&maps[0], &maps[1]], (1, 3), &told);
    assert_eq!(confirmed.expect("a loop").candidate, (0, 1));
}

#[test]
fn finds_no_loop_half_a_metre_aside_or_just_seen() {
    let steps = passes(&wall(100), 2);
    let map = map(&steps);
    let hear = |told: Proposal| Confirmation::default().hear(&[&map], (0, 7), &[told]);
    assert!(hear(proposal(3, level(0.0))).is_some());
    assert!(hear(proposal(3, level(0.5))).is_none(), "nothing is where the transformation has it");
    assert!(hear(proposal(5, level(2.0 * STEP_M))).is_none(), "it is covisible with the query");
}

#[test]
fn keyframes_that_follow_confirm_what_one_neighbour_does_and_two_failures_end_it() {
    let wall = wall(120);
    // Points visible in the query and each following keyframe; the query has one neighbour, checked only at the query.
    for (sees, confirmed_at) in [
        (&[120, 100, 100, 100][..], Some(4)),
        (&[120, 99, 100, 100][..], Some(5)),
        (&[120, 99, 0, 120, 120][..], None),
    ] {
        let mut steps = passes(&wall, 1);
        steps.push(step(&wall, 0.0, 1_000));
        for (number, sees) in sees.iter().enumerate() {
            steps.push(step(&wall[..*sees], STEP_M * number as f64, 1_000));
        }
        let (mut confirmation, mut at) = (Confirmation::default(), None);
        for (number, _) in sees.iter().enumerate() {
            let map = map(&steps[..6 + number]);
            let told = [proposal(0, level(0.0))];
            let proposals = if number == 0 { &told[..] } else { &[] };
            if confirmation.hear(&[&map], (0, 5 + number), proposals).is_some() {
                at = Some(number + 2);
                break;
            }
        }
        assert_eq!(at, confirmed_at, "{sees:?}");
    }
}

#[test]
fn the_candidate_that_shows_most_points_is_taken_whatever_the_order() {
    let wall = wall(120);
    let mut steps: Vec<Step> =
        (0..4).map(|number| step(&wall[..90], STEP_M * f64::from(number), 5_000)).collect();
    steps.extend(passes(&wall, 2));
    let map = map(&steps);
    let told = [proposal(2, level(STEP_M)), proposal(6, level(STEP_M))];
    for order in [[0, 1], [1, 0]] {
        let proposals = order.map(|place: usize| told[place].clone());
        let confirmed = Confirmation::default().hear(&[&map], (0, 11), &proposals).expect("a loop");
        assert_eq!((confirmed.candidate, confirmed.found), ((0, 6), 120), "{order:?}");
    }
}
