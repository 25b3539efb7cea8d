//! A building: its corridors and rooms, the signs in them, and what they look like.

use super::kind::{Extra, Kind, Look, Traits};
use super::texts::{BILLBOARDS, BRANDS, COMMON, NOTICES, PICTURES, pointer};
use crate::geometry::Point3;
use crate::hotel::rng::SeededRng;

/// Doors of a corridor, on both sides.
pub const DOORS: usize = 8;
/// From one door to the next, in metres.
pub const DOOR_M: f64 = 3.5;
/// The length of a corridor, in metres.
pub const CORRIDOR_M: f64 = 28.0;
/// The corridor's half width, in metres.
pub const WALL_M: f64 = 1.3;
/// Metres from floor to floor.
pub const STOREY_M: f64 = 3.6;
/// Metres from wing to wing.
const WING_M: f64 = 60.0;
/// The place of the room in which sessions may begin: its middle, in the frame of its corridor.
pub const ROOM: [f64; 2] = [4.5, 6.0];
/// The room's half width, in metres.
pub const ROOM_HALF_M: f64 = 2.5;

/// A corridor of a floor and wing, or a room beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Space {
    /// The floor, 0 is the lowest.
    pub floor: usize,
    /// The wing.
    pub wing: usize,
    /// Whether it is the room.
    pub is_room: bool,
}

impl Space {
    /// Returns the origin of its frame in the building's, in metres: x to the right, y down, z along the corridor.
    pub fn origin(self) -> Point3 {
        Point3::new(self.wing as f64 * WING_M, -(self.floor as f64) * STOREY_M, 0.0)
    }

    /// Whether the two are on one floor of one wing.
    pub fn is_beside(self, other: Self) -> bool {
        (self.floor, self.wing) == (other.floor, other.wing)
    }
}

/// The kind of a sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignKind {
    /// The plate of a door: the errors of a passage concern plates alone.
    Plate,
    /// Another text.
    Text,
    /// A picture, which a model describes.
    Picture,
}

/// A sign on a wall.
#[derive(Clone, Debug)]
pub struct Sign {
    /// The corridor or room that sees it; none: every floor of a wing sees it through the window.
    pub space: Option<Space>,
    /// Its text, or what a model describes.
    pub text: String,
    /// Its kind.
    pub kind: SignKind,
    /// Its place in the frame of its floor's corridor, in metres.
    pub at: Point3,
    /// From how far it can be read, in metres.
    pub range_m: f64,
}

/// A building.
#[derive(Clone, Debug)]
pub struct World {
    /// Its traits.
    pub traits: Traits,
    /// Its seed.
    pub seed: u64,
    /// Its signs. A number in this list is a physical sign.
    pub signs: Vec<Sign>,
}

impl World {
    /// Builds a building of a kind.
    pub fn new(kind: Kind, seed: u64) -> Self {
        let traits = kind.traits();
        let has = |extra| traits.hangs.contains(&extra);
        let mut rng = SeededRng::new(seed, &format!("building {}", kind.as_str()));
        let naming = *rng.one_of(traits.naming);
        let mut signs = Vec::new();
        let mut hang = |space: Option<Space>, text: &str, kind: SignKind, at: [f64; 3], range_m: f64| {
            signs.push(Sign { space, text: text.to_owned(), kind, at: Point3::from(at), range_m });
        };
        let first_door = 1 + rng.below(4);
        // Furnishings repeat: every corridor hangs the same ones in the same places.
        let pattern: Vec<(usize, usize, usize)> = (0..DOORS)
            .map(|_| (rng.below(NOTICES.len()), rng.below(BRANDS.len()), rng.below(PICTURES.len())))
            .collect();
        let common = rng.below(COMMON.len());
        for (floor, wing) in
            (0..traits.floors).flat_map(|floor| (0..traits.wings).map(move |wing| (floor, wing)))
        {
            let corridor = Space { floor, wing, is_room: false };
            let side = if traits.look == Look::Mirrored && (floor + wing) % 2 == 1 { -1.0 } else { 1.0 };
            for (door, (notice, brand, picture)) in pattern.iter().enumerate() {
                let z = DOOR_M * (door as f64 + 0.5);
                let x = side * if door % 2 == 0 { WALL_M } else { -WALL_M };
                let plate = naming.plate(floor, wing, first_door + door);
                hang(Some(corridor), &plate, SignKind::Plate, [x, -0.2, z], 3.6);
                if has(Extra::Notices) && door % 2 == 0 {
                    hang(Some(corridor), NOTICES[*notice], SignKind::Text, [x, 0.1, z + 0.3], 4.5);
                }
                if has(Extra::Brands) && door % 3 == 0 {
                    hang(Some(corridor), BRANDS[*brand], SignKind::Text, [x, -0.5, z - 0.4], 5.0);
                }
                if has(Extra::Pictures) && door % 4 == 1 {
                    hang(Some(corridor), PICTURES[*picture], SignKind::Picture, [-x, -0.1, z], 5.0);
                }
                if has(Extra::Directories) && door % 5 == 2 {
                    let names = [1, DOORS / 2].map(|other| naming.plate(floor, wing, first_door + other));
                    let text = pointer(&names[0], &names[1]);
                    hang(Some(corridor), &text, SignKind::Text, [0.0, -1.1, z + 0.8], 6.0);
                    let other = naming.plate((floor + 1) % traits.floors, wing, first_door + door);
                    hang(Some(corridor), &other, SignKind::Text, [x, -0.9, z + 0.6], 5.0);
                }
            }
            for at in [6.0, 20.0] {
                hang(Some(corridor), COMMON[common], SignKind::Text, [0.0, -1.2, at], 8.0);
            }
            if traits.starts_in_room {
                let room = Space { is_room: true, ..corridor };
                let [x, z] = ROOM;
                for (number, (.., picture)) in pattern.iter().take(4).enumerate() {
                    let (dx, dz) = [(2.4, 0.6), (-0.6, 2.4), (-2.4, -0.6), (0.6, -2.4)][number];
                    hang(Some(room), PICTURES[*picture], SignKind::Picture, [x + dx, -0.1, z + dz], 5.0);
                }
            }
        }
        if has(Extra::Billboards) {
            for (number, text) in BILLBOARDS.iter().enumerate() {
                let at = [8.0 * number as f64 - 12.0, -2.0, CORRIDOR_M + 25.0 + 3.0 * number as f64];
                hang(None, text, SignKind::Text, at, 45.0);
            }
        }
        Self { traits, seed, signs }
    }

    /// Returns the name of what a cell of a space looks like; cells that look alike share it.
    pub fn look(&self, space: Space, cell: usize) -> u64 {
        let own = (space.floor * 16 + space.wing) as u64;
        let own = if self.traits.look == Look::Own { own + 1 } else { 0 };
        (self.seed << 20) ^ (own << 12) ^ (u64::from(space.is_room) << 11) ^ cell as u64
    }

    /// Whether a space is the mirror image of those that look like it.
    pub fn is_mirrored(&self, space: Space) -> bool {
        self.traits.look == Look::Mirrored && (space.floor + space.wing) % 2 == 1
    }
}
