//! A robot that drives on and on, and sends keyframes as SLAM makes them.
//!
//! Each keyframe keeps 85 % of the map points of the one before, so that a point is observed by seven keyframes in a
//! row; new points are numbered as they come. A keyframe therefore shares 15 points or more with some forty others.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use revisit::domain::bow::BowVector;
use revisit::domain::ids::KeyframeId;
use revisit::domain::keyframe::{
    CLIENTS_VOCABULARY, Camera, Detection, Features, Keypoint, NewKeyframe, Stamp,
};
use revisit::geometry::{Point3, Pose};

const WORDS: usize = 700;
const WORDS_IN_BUILDING: u32 = 60_000;
const WORDS_KEPT: f64 = 0.65;
const POINTS_KEPT: f64 = 0.85;
/// Keyframes of one session.
const SESSION: u32 = 1_000;
/// An object stays in sight for this many keyframes.
const SIGHT: u32 = 8;
/// Map points in the box of an object.
const POINTS_OF_OBJECT: usize = 20;
/// Numbers of the points of objects: apart from the others, of each object in a row.
const FIRST_POINT_OF_OBJECT: i64 = 1 << 32;
const DESCRIPTOR_BYTES: usize = 32;

/// How much each keyframe brings beside its words.
#[derive(Clone, Copy)]
pub struct Sends {
    pub points: usize,
    pub detections: u32,
    pub features: usize,
}

/// The robot, and what it sees.
pub struct Robot {
    sends: Sends,
    rng: ChaCha8Rng,
    driven: u32,
    words: Vec<u32>,
    points: Vec<i64>,
    next_point: i64,
}

impl Robot {
    pub fn new(sends: Sends) -> Self {
        let rng = ChaCha8Rng::seed_from_u64(7);
        Self { sends, rng, driven: 0, words: Vec::new(), points: Vec::new(), next_point: 0 }
    }

    /// The name of a keyframe.
    pub fn id(number: u32) -> KeyframeId {
        format!("run-{}-{:05}", number / SESSION, number).parse().expect("an id")
    }

    /// The next keyframe.
    pub fn drive(&mut self) -> NewKeyframe {
        let number = self.driven;
        self.driven += 1;
        if number.is_multiple_of(SESSION) {
            (self.points, self.next_point) = (Vec::new(), 0);
        }
        let known = self.next_point;
        self.look();
        let centre = [f64::from(number % SESSION) * 0.4, f64::from(number / SESSION) * 3.0, 0.0];
        let position = |id: i64| {
            Point3::new(centre[0] + (id % 61) as f64 * 0.1, centre[1] + 1.5, (id % 23) as f64 * 0.1)
        };
        let mut observes = self.points.clone();
        let objects: Vec<u32> = (0..self.sends.detections).map(|side| object(number, side)).collect();
        observes.extend(objects.iter().flat_map(|object| points_of(*object)));
        observes.sort_unstable();
        // The points of an object are placed as it comes into sight.
        let placed = objects.iter().filter(|object| number == 0 || first_sight(**object) >= number);
        let placed: Vec<i64> = placed.flat_map(|object| points_of(*object)).collect();
        let pose = Pose::new(centre, [0.0, 0.0, 0.0, 1.0]).expect("a pose");
        NewKeyframe {
            session: format!("run-{}", number / SESSION).parse().expect("an id"),
            camera: Some(Camera { fx: 500.0, fy: 500.0, cx: 320.0, cy: 240.0, width: 640, height: 480 }),
            bow: self.read(),
            vocabulary: Some(CLIENTS_VOCABULARY.into()),
            features: (self.sends.features > 0).then(|| self.features()),
            map_points: (known..self.next_point).chain(placed).map(|id| (id, position(id))).collect(),
            detections: (0..self.sends.detections).map(|side| detection(number, side, centre)).collect(),
            observes,
            ..NewKeyframe::at(Self::id(number), Stamp { sec: i64::from(number), nanosec: 0 }, pose)
        }
    }

    fn look(&mut self) {
        self.points.shuffle(&mut self.rng);
        self.points.truncate((self.sends.points as f64 * POINTS_KEPT) as usize);
        let of_objects = self.sends.detections as usize * POINTS_OF_OBJECT;
        while self.points.len() + of_objects < self.sends.points {
            self.points.push(self.next_point);
            self.next_point += 1;
        }
    }

    fn read(&mut self) -> BowVector {
        self.words.shuffle(&mut self.rng);
        self.words.truncate((WORDS as f64 * WORDS_KEPT) as usize);
        while self.words.len() < WORDS {
            let word = (self.rng.random::<f64>().powf(1.72) * f64::from(WORDS_IN_BUILDING)) as u32;
            if !self.words.contains(&word) {
                self.words.push(word);
            }
        }
        let weighed = self.words.iter().map(|word| (*word, 1.0 + f64::from(word % 7)));
        BowVector::normalised(weighed.collect()).expect("distinct words")
    }

    fn features(&mut self) -> Features {
        let count = self.sends.features;
        let keypoint = |rng: &mut ChaCha8Rng| Keypoint {
            u: rng.random_range(0.0..640.0),
            v: rng.random_range(0.0..480.0),
            octave: 0,
            angle_deg: Some(0.0),
        };
        Features {
            descriptor_bytes: DESCRIPTOR_BYTES,
            descriptors: (0..count * DESCRIPTOR_BYTES).map(|_| self.rng.random()).collect(),
            keypoints: (0..count).map(|_| keypoint(&mut self.rng)).collect(),
            map_points: (0..count).map(|feature| self.points.get(feature).copied()).collect(),
        }
    }
}

/// The object that is in sight on this side of the corridor; it stays for eight keyframes.
fn object(number: u32, side: u32) -> u32 {
    (number + side * SIGHT / 2) / SIGHT * 2 + side
}

/// The first keyframe that sees an object.
fn first_sight(object: u32) -> u32 {
    (object / 2 * SIGHT).saturating_sub(object % 2 * SIGHT / 2)
}

fn points_of(object: u32) -> std::ops::Range<i64> {
    let first = FIRST_POINT_OF_OBJECT + i64::from(object) * POINTS_OF_OBJECT as i64;
    first..first + POINTS_OF_OBJECT as i64
}

/// A plate of its own on each side of the corridor.
fn detection(number: u32, side: u32, centre: [f64; 3]) -> Detection {
    let object = object(number, side);
    Detection {
        map_points: points_of(object).collect(),
        position_in_session: Some(Point3::new(centre[0], centre[1] + f64::from(side) * 2.0, 1.5)),
        text: Some(format!("room {object:05}")),
        ..Detection::of("door_number", 0.9, [100.0, 100.0, 160.0, 130.0])
    }
}
