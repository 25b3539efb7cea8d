//! Sight: the signs and points that a keyframe sees, and the body that its client sends.

use std::collections::BTreeSet;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};

use super::kind::Client;
use super::motion::believed;
use super::reader::Reader;
use super::route::Stand;
use super::world::{CORRIDOR_M, ROOM, ROOM_HALF_M, Sign, SignKind, Space, WALL_M, World};
use crate::api::keyframe::CameraShape;
use crate::api::space::Transform;
use crate::geometry::{Point3, Pose};
use crate::hotel::building::texture::{Descriptor, bytes};
use crate::hotel::rng::SeededRng;
use crate::hotel::robot::message::{DESCRIPTOR_BYTES, tenths_of_millimetres as rounded};
use crate::hotel::sensing::camera::{CAMERA, FOCAL_LENGTH_PX, IMAGE_PX};

/// Points of a cell of wall.
const POINTS: usize = 18;
/// The length of a cell, in metres.
const CELL_M: f64 = 2.0;
/// From how near and how far points are seen, in metres.
const POINT_RANGE_M: std::ops::Range<f64> = 0.8..9.0;
/// The share of descriptor bits that differ from view to view.
const BIT_NOISE: f64 = 0.06;
/// The share of points that no other cell has, however alike the two look.
const OWN_POINTS: f64 = 0.2;
/// Words of a cell.
const WORDS: usize = 10;
/// The depth camera's error, as a share of the distance.
const DEPTH_NOISE: f64 = 0.015;

/// A keyframe as it is sent, and what the simulator knows of it.
#[derive(Clone, Debug)]
pub struct Keyframe {
    /// Its id.
    pub id: String,
    /// Its session, from 0.
    pub session: usize,
    /// The place at which it was taken.
    pub stand: Stand,
    /// The way that its robot had driven, in metres.
    pub driven_m: f64,
    /// The physical signs in view.
    pub signs: BTreeSet<usize>,
    /// The body that its client sends.
    pub body: Map<String, Value>,
}

/// A point on a wall.
struct WallPoint {
    id: i64,
    at: Point3,
    descriptor: u64,
    words: u64,
}

/// Returns the keyframes of a session.
pub fn session(world: &World, number: usize, stands: &[Stand]) -> Vec<Keyframe> {
    let mut reader = Reader::new(world, number);
    let mut rng = SeededRng::new(world.seed, &format!("sight {number}"));
    let mut placed = BTreeSet::new();
    let mut driven_m = 0.0;
    let mut keyframes: Vec<Keyframe> = Vec::with_capacity(stands.len());
    for (at, (stand, pose)) in stands.iter().zip(believed(world, number, stands)).enumerate() {
        if let Some(before) = keyframes.last() {
            driven_m += (stand.place() - before.stand.place()).norm();
        }
        let id = format!("s{number}-{at:03}");
        let signs = in_view(world, stand);
        let mut body = head(world, number, stand, &pose);
        body.insert(
            "detections".into(),
            detections(world, stand, &pose, &signs, &mut reader, &mut rng).into(),
        );
        if world.traits.client != Client::Bare {
            see(world, stand, &pose, &mut placed, &mut rng, &mut body);
        }
        if world.traits.client == Client::Photographs {
            let before = keyframes.last().filter(|before| before.stand.space == stand.space);
            let listed = before.map(|before| json!({"keyframe": before.id, "shared": 30}));
            body.insert("covisible".into(), listed.into_iter().collect());
        }
        keyframes.push(Keyframe { id, session: number, stand: *stand, driven_m, signs, body });
    }
    keyframes
}

fn head(world: &World, number: usize, stand: &Stand, pose: &Pose) -> Map<String, Value> {
    let mut head = Map::new();
    head.insert("session".into(), format!("robot-{number}").into());
    // Sessions are an hour apart.
    let second = 3_600 * number as u32 + stand.second;
    head.insert("stamp".into(), json!({"sec": second, "nanosec": 0}));
    head.insert("pose".into(), json!(Transform::from(*pose)));
    if world.traits.client != Client::Bare {
        head.insert("camera".into(), json!(CameraShape::from(CAMERA)));
    }
    head
}

/// Returns where a sign is in the camera's frame; none if it is behind a wall, out of view or too far.
fn seen(stand: &Stand, sign: &Sign) -> Option<Point3> {
    if sign.space.is_some_and(|space| space != stand.space) || (sign.space.is_none() && stand.space.is_room) {
        return None;
    }
    let at = stand.corridor_from_camera().inverse_transform(&sign.at);
    let is_in_image = at.z > 0.5 && (at.x / at.z).abs() < 0.75 && (at.y / at.z).abs() < 0.6;
    (is_in_image && at.coords.norm() < sign.range_m).then_some(at)
}

fn in_view(world: &World, stand: &Stand) -> BTreeSet<usize> {
    let signs = world.signs.iter().enumerate();
    signs.filter(|(_, sign)| seen(stand, sign).is_some()).map(|(number, _)| number).collect()
}

fn detections(
    world: &World,
    stand: &Stand,
    pose: &Pose,
    signs: &BTreeSet<usize>,
    reader: &mut Reader<'_>,
    rng: &mut SeededRng,
) -> Vec<Value> {
    let mut found = Vec::new();
    let mut tell = |text: String, is_picture: bool, at: Point3, rng: &mut SeededRng| {
        let noisy = Point3::from(at.coords * (1.0 + rng.normal(DEPTH_NOISE)));
        let [u, v] = pixel(&at);
        let mut told = json!({"class": if is_picture { "picture" } else { "text" }, "confidence": rounded(rng.within(0.82, 0.99)),
            "box": [rounded(u - 20.0), rounded(v - 8.0), rounded(u + 20.0), rounded(v + 8.0)]});
        told[if is_picture { "description" } else { "text" }] = text.into();
        let place = if world.traits.client == Client::Photographs {
            told["range"] = "assumed".into();
            // The bearing, three metres away.
            pose.transform(&Point3::from(at.coords.normalize() * 3.0))
        } else {
            pose.transform(&noisy)
        };
        told["position"] = json!([rounded(place.x), rounded(place.y), rounded(place.z)]);
        found.push(told);
    };
    for number in signs {
        let sign = &world.signs[*number];
        if let (Some(at), Some(text)) = (seen(stand, sign), reader.read(*number, sign)) {
            tell(text, sign.kind == SignKind::Picture, at, rng);
        }
    }
    if let Some(text) = reader.railing() {
        tell(text, false, Point3::new(rng.within(-0.8, 0.8), 0.4, rng.within(1.5, 4.0)), rng);
    }
    found
}

/// Adds the words and features of a keyframe.
fn see(
    world: &World,
    stand: &Stand,
    pose: &Pose,
    placed: &mut BTreeSet<i64>,
    rng: &mut SeededRng,
    body: &mut Map<String, Value>,
) {
    let has_depth = world.traits.client == Client::Depth;
    let (mut keypoints, mut descriptors, mut ids) = (Vec::new(), Vec::new(), Vec::new());
    let (mut new_ids, mut positions) = (Vec::new(), Vec::new());
    let mut words = BTreeSet::new();
    for point in wall_points(world, stand.space) {
        let at = stand.corridor_from_camera().inverse_transform(&point.at);
        let [u, v] = pixel(&at);
        let is_inside = (0.0..IMAGE_PX[0]).contains(&u) && (0.0..IMAGE_PX[1]).contains(&v);
        if !POINT_RANGE_M.contains(&at.z) || !is_inside || rng.happens(0.15) {
            continue;
        }
        keypoints.push(json!([rounded(u + rng.normal(0.6)), rounded(v + rng.normal(0.6)), 0]));
        descriptors.extend(bytes(&descriptor(point.descriptor, rng)));
        ids.push(point.id);
        words.insert(point.words);
        if has_depth && placed.insert(point.id) {
            let noisy = Point3::from(at.coords * (1.0 + rng.normal(DEPTH_NOISE)));
            let place = pose.transform(&noisy);
            new_ids.push(point.id);
            positions.push(json!([rounded(place.x), rounded(place.y), rounded(place.z)]));
        }
    }
    let mut features = json!({"descriptor_bytes": DESCRIPTOR_BYTES, "keypoints": keypoints, "descriptors": STANDARD.encode(descriptors)});
    if has_depth {
        features["map_points"] = json!(ids);
        body.insert("map_points".into(), json!({"ids": new_ids, "positions": positions}));
    }
    body.insert("features".into(), features);
    // What every corridor shows, what this cell shows, and what is different each time.
    let cell_words =
        words.iter().flat_map(|cell| (0..WORDS as u64).map(move |word| mixed(*cell, word) % 9_000 + 100));
    let mut bag: BTreeSet<u64> = cell_words.filter(|_| !rng.happens(0.3)).collect();
    bag.extend(0..6);
    bag.extend((0..5).map(|_| 10_000 + rng.below(5_000) as u64));
    let bag: Vec<u64> = bag.into_iter().collect();
    body.insert("bow".into(), json!({"words": bag, "weights": vec![1; bag.len()]}));
}

/// Returns the points on the walls of a space, in the frame of its corridor.
fn wall_points(world: &World, space: Space) -> impl Iterator<Item = WallPoint> {
    let cells = if space.is_room { 4 } else { (CORRIDOR_M / CELL_M) as usize };
    let side = if world.is_mirrored(space) { -1.0 } else { 1.0 };
    let own = mixed(world.seed, (space.floor * 64 + space.wing * 8 + usize::from(space.is_room)) as u64);
    let looks: Vec<u64> = (0..cells).map(|cell| world.look(space, cell)).collect();
    (0..cells * POINTS).map(move |number| {
        let (cell, point) = (number / POINTS, (number % POINTS) as u64);
        let look = mixed(looks[cell], point);
        let draw = |axis: u64| (mixed(look, axis) >> 11) as f64 / (1_u64 << 53) as f64;
        let across = if draw(1) < 0.5 { -1.0 } else { 1.0 };
        let (along, height) = (draw(2), draw(3) * 2.2 - 1.2);
        let at = if space.is_room {
            let (wall, along) = (ROOM_HALF_M, (2.0 * along - 1.0) * ROOM_HALF_M);
            let [dx, dz] = [[along, wall], [wall, along], [along, -wall], [-wall, along]][cell];
            Point3::new(ROOM[0] + dx, height, ROOM[1] + dz)
        } else {
            Point3::new(side * across * WALL_M, height, CELL_M * (cell as f64 + along))
        };
        let is_own = draw(4) < OWN_POINTS;
        let id = ((space.floor * 64 + space.wing * 8 + usize::from(space.is_room)) * 1_000 + number) as i64;
        WallPoint { id, at, descriptor: if is_own { mixed(look, own) } else { look }, words: looks[cell] }
    })
}

fn descriptor(name: u64, rng: &mut SeededRng) -> Descriptor {
    std::array::from_fn(|word| {
        let noise = (0..64).filter(|_| rng.happens(BIT_NOISE)).fold(0_u64, |noise, bit| noise | 1 << bit);
        mixed(name, 100 + word as u64) ^ noise
    })
}

/// Returns a number that two others make, alike on every machine (the finaliser of SplitMix64, Steele et al. 2014).
fn mixed(a: u64, b: u64) -> u64 {
    let mut x = a.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(b).wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

fn pixel(at: &Point3) -> [f64; 2] {
    [FOCAL_LENGTH_PX * at.x / at.z + CAMERA.cx, FOCAL_LENGTH_PX * at.y / at.z + CAMERA.cy]
}
