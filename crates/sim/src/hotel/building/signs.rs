//! Signs: readable or describable objects on the walls: door plates, paintings, exit signs, floor signs.

use super::floor_plan::{CORRIDOR_HALF_WIDTH_M, FloorPlan, Spot};
use super::furnishing::WorldPoint;
use super::texture::{Descriptor, Patterns, copy};
use crate::hotel::rng::SeededRng;
use crate::named::named;

named! {
    /// The kind of a sign, by the class of its detections.
    SignKind {
        /// A door number beside its door.
        DoorPlate = "door_number",
        /// A painting on the corridor's wall.
        Painting = "painting",
        /// An exit sign.
        ExitSign = "exit_sign",
        /// The floor's number, the same on the whole floor.
        FloorSign = "floor_sign",
    }
}

impl SignKind {
    /// Returns the range of a detector, in metres.
    pub fn detected_within_m(self) -> f64 {
        match self {
            Self::DoorPlate | Self::FloorSign => 5.2,
            Self::Painting | Self::ExitSign => 6.5,
        }
    }

    fn half_size_m(self) -> [f64; 2] {
        match self {
            Self::DoorPlate | Self::FloorSign => [0.10, 0.07],
            Self::Painting => [0.30, 0.22],
            Self::ExitSign => [0.16, 0.08],
        }
    }
}

/// A sign on a wall.
#[derive(Clone, Debug)]
pub struct Sign {
    /// Its kind.
    pub kind: SignKind,
    /// Its true text or motif, which a reader may misread.
    pub text: String,
    /// Its middle, in metres.
    pub centre: [f64; 3],
    /// The direction that it faces; a unit vector.
    pub normal: [f64; 2],
    /// Half its width and height, in metres.
    pub half_size_m: [f64; 2],
    /// Its points among the world's.
    pub points: std::ops::Range<usize>,
}

/// The arrangement of a world's signs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SignPlan {
    /// Whether every wall has the same painting, and every door a floor number and a described exit sign.
    pub repeated: bool,
    /// The number of different paintings, hung in turn; 0: a different one on each wall.
    pub prints: usize,
}

/// Points of one sign.
const POINTS_PER_SIGN: usize = 16;
/// Stride of the plate points, from the first, that are on the digits and differ between plates.
pub const POINTS_PER_DIGIT_POINT: usize = 3;
/// Position of a plate, right of the middle of its door, and its height.
const PLATE_U_M: f64 = 0.62;
const PLATE_Z_M: f64 = 1.45;
/// Position of repeated signs, left of the middle of the door.
const REPEATED_U_M: f64 = -0.62;
/// Possible positions of a painting, right of the middle of the opposite door.
const PAINTING_U_M: [f64; 3] = [0.0, 0.5, -0.5];
/// Wall needed for a door with its plate on either side of its middle, without half a painting.
const DOOR_AND_PLATE_M: f64 = 1.05;
/// The height of a painting's middle.
const PAINTING_Z_M: f64 = 1.5;
/// The height of an exit sign's middle.
const EXIT_Z_M: f64 = 1.95;

/// Description of repeated exit signs: enough words for an anchor, and nothing that distinguishes them.
pub const REPEATED_EXIT: &str = "an illuminated pictogram of a running figure heading for a doorway";

/// Hangs the signs of a floor. The points of a sign are appended to `points`.
pub struct Decorator<'a> {
    /// The floor plan.
    pub plan: &'a FloorPlan,
    /// The patterns of corners.
    pub patterns: &'a Patterns,
    /// All points of the world so far.
    pub points: &'a mut Vec<WorldPoint>,
}

impl Decorator<'_> {
    /// Hangs all signs; `numbers` are those of the rooms, in order.
    pub fn hang(&mut self, numbers: &[String], signs: SignPlan, rng: &mut SeededRng) -> Vec<Sign> {
        let mut hung = Vec::new();
        let mut titles = paintings(self.plan.rooms.len() + 8, rng);
        let patterns = self.patterns;
        let look_like_no_other = |rng: &mut SeededRng| -> Vec<Descriptor> {
            (0..POINTS_PER_SIGN).map(|_| patterns.model(rng)).collect()
        };
        let [same_painting, exit, floor] = [(); 3].map(|()| look_like_no_other(rng));
        let prints: Vec<Vec<Descriptor>> = (0..signs.prints).map(|_| look_like_no_other(rng)).collect();
        if signs.prints > 0 {
            titles = (0..titles.len()).map(|number| titles[number % signs.prints].clone()).collect();
        }
        let painting = |number: usize, rng: &mut SeededRng| match prints.len() {
            _ if signs.repeated => (titles[0].clone(), same_painting.clone()),
            0 => (titles[number].clone(), look_like_no_other(rng)),
            different => (titles[number].clone(), prints[number % different].clone()),
        };
        let floor_number = numbers[0].chars().take(numbers[0].len().saturating_sub(2)).collect::<String>();
        for (number, room) in self.plan.rooms.iter().enumerate() {
            // Plates differ only in the points on their digits.
            let digits = look_like_no_other(rng);
            let look: Vec<Descriptor> = floor
                .iter()
                .zip(&digits)
                .enumerate()
                .map(|(i, (a, b))| if i % POINTS_PER_DIGIT_POINT == 0 { *b } else { *a })
                .collect();
            let plate = place(&room.door, PLATE_U_M, 0.0, PLATE_Z_M, -1.0);
            hung.push(self.sign(SignKind::DoorPlate, numbers[number].clone(), plate, &look, rng));
            let opposite = -2.0 * CORRIDOR_HALF_WIDTH_M;
            // Visible through the open door, if another door leaves room for it.
            let free = PAINTING_U_M.into_iter().find(|u| self.is_free(room.door.at(*u, opposite)));
            if let Some(u) = free {
                let spot = place(&room.door, u, opposite, PAINTING_Z_M, 1.0);
                let (title, look) = painting(number, rng);
                hung.push(self.sign(SignKind::Painting, title, spot, &look, rng));
            }
            if signs.repeated {
                let spot = place(&room.door, REPEATED_U_M, 0.0, PLATE_Z_M, -1.0);
                hung.push(self.sign(SignKind::FloorSign, format!("Floor {floor_number}"), spot, &floor, rng));
                let spot = place(&room.door, REPEATED_U_M - 0.1, 0.0, EXIT_Z_M, -1.0);
                hung.push(self.sign(SignKind::ExitSign, REPEATED_EXIT.to_owned(), spot, &exit, rng));
            }
        }
        let rooms = self.plan.rooms.len();
        for (corner, corner_m) in self.plan.corners_m().into_iter().enumerate() {
            // On the outer walls, visible from both directions.
            let ([x, y], heading) = self.plan.centreline(corner_m - 1e-6);
            let ahead = Spot { origin: [x, y], facing: [heading.cos(), heading.sin()] };
            let aside = Spot { origin: [x, y], facing: [heading.sin(), -heading.cos()] };
            let spot = place(&ahead, 0.0, CORRIDOR_HALF_WIDTH_M, EXIT_Z_M, -1.0);
            let text = if signs.repeated { REPEATED_EXIT } else { "EXIT" };
            hung.push(self.sign(SignKind::ExitSign, text.to_owned(), spot, &exit, rng));
            for (number, wall) in [ahead, aside].into_iter().enumerate() {
                let spot = place(&wall, 0.0, CORRIDOR_HALF_WIDTH_M, PAINTING_Z_M, -1.0);
                let (title, look) = painting(rooms + 2 * corner + number, rng);
                hung.push(self.sign(SignKind::Painting, title, spot, &look, rng));
            }
        }
        hung
    }

    /// Whether there is wall here, and no door nearby.
    fn is_free(&self, place: [f64; 2]) -> bool {
        self.plan.rooms.iter().all(|room| {
            let [x, y] = room.door.origin;
            (place[0] - x).hypot(place[1] - y) > DOOR_AND_PLATE_M
        })
    }

    fn sign(
        &mut self,
        kind: SignKind,
        text: String,
        (centre, normal): ([f64; 3], [f64; 2]),
        look: &[Descriptor],
        rng: &mut SeededRng,
    ) -> Sign {
        let half_size_m = kind.half_size_m();
        let along = [-normal[1], normal[0]];
        let start = self.points.len();
        for descriptor in look {
            let (s, z) =
                (rng.within(-half_size_m[0], half_size_m[0]), rng.within(-half_size_m[1], half_size_m[1]));
            self.points.push(WorldPoint {
                position: [centre[0] + s * along[0], centre[1] + s * along[1], centre[2] + z],
                normal: [normal[0], normal[1], 0.0],
                descriptor: copy(*descriptor, rng),
                reference_m: rng.within(1.6, 2.6),
                angle_deg: rng.within(0.0, 360.0),
            });
        }
        Sign { kind, text, centre, normal, half_size_m, points: start..self.points.len() }
    }
}

/// Returns a place on a wall: its middle and the direction that it faces.
fn place(spot: &Spot, u: f64, v: f64, z: f64, towards: f64) -> ([f64; 3], [f64; 2]) {
    let [x, y] = spot.at(u, v);
    ([x, y, z], spot.direction(0.0, towards))
}

const SUBJECTS: [&str; 36] = [
    "fox",
    "lighthouse",
    "violinist",
    "sailboat",
    "horse",
    "mill",
    "heron",
    "locomotive",
    "shepherd",
    "pumpkin",
    "castle",
    "dancer",
    "tractor",
    "owl",
    "glacier",
    "beekeeper",
    "cathedral",
    "lemon",
    "zebra",
    "canoe",
    "volcano",
    "cellist",
    "kingfisher",
    "orchard",
    "airship",
    "whale",
    "gondola",
    "juggler",
    "cheetah",
    "vineyard",
    "blacksmith",
    "parrot",
    "submarine",
    "waterfall",
    "fiddler",
    "hedgehog",
];
const COMPANIONS: [&str; 14] = [
    "barrel", "umbrella", "birch", "bicycle", "fountain", "teapot", "ladder", "lantern", "piano", "cactus",
    "wagon", "anchor", "mirror", "hammock",
];
const SETTINGS: [&str; 14] = [
    "sunset",
    "winter",
    "harvest",
    "thunderstorm",
    "fog",
    "moonlight",
    "springtime",
    "carnival",
    "dawn",
    "rain",
    "desert",
    "seaside",
    "mountains",
    "jungle",
];

/// Draws titles of different paintings.
fn paintings(count: usize, rng: &mut SeededRng) -> Vec<String> {
    let mut subjects = SUBJECTS;
    rng.shuffle(&mut subjects);
    let title = |number: usize, rng: &mut SeededRng| {
        let subject = subjects[number % subjects.len()];
        format!("a painting of a {subject} and a {}, {}", rng.one_of(&COMPANIONS), rng.one_of(&SETTINGS))
    };
    (0..count).map(|number| title(number, rng)).collect()
}
