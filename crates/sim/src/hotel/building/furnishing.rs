//! Furnishing: the points of rooms and corridor that a camera can recognise.
//!
//! Rooms of one kind are copies of one model: the same walls, beds and desks at the same places, up to centimetres and
//! a few bits of each descriptor. Only a guest's belongings are unique. The stretches of corridor between doors are
//! copies, too. Such copies confuse both bag of words and geometry.

use super::floor_plan::{
    CEILING_M, CORRIDOR_HALF_WIDTH_M, DOORWAY_HALF_WIDTH_M, FloorPlan, ROOM_LEFT_M, Spot,
};
use super::texture::{Descriptor, Patterns, copy};
use crate::hotel::rng::SeededRng;

/// A point of the world; in a model, of the frame of a [`Spot`] (u right, v ahead, z up).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldPoint {
    /// In metres.
    pub position: [f64; 3],
    /// The direction from which it is seen best; a unit vector.
    pub normal: [f64; 3],
    /// Its descriptor from the front.
    pub descriptor: Descriptor,
    /// The distance at which it is a corner of the image pyramid's middle octave.
    pub reference_m: f64,
    /// Its orientation in the image of an upright camera, in degrees.
    pub angle_deg: f64,
}

/// Points on each wall of a room.
const POINTS_PER_WALL: usize = 700;
/// Points on each piece of furniture.
const POINTS_PER_PIECE: usize = 180;
/// Points around a door, on the corridor's side.
const POINTS_PER_DOOR_FRAME: usize = 110;
/// Points on either wall of a stretch of corridor.
const POINTS_PER_STRETCH: usize = 650;
/// Points on each wall of a corner of the corridor.
const POINTS_PER_CORNER_WALL: usize = 900;
/// Length of a corner along the corridor on either side.
const CORNER_ARM_M: f64 = 3.0;
/// Unique points of each room and each stretch.
const OWN_POINTS: usize = 120;
/// Scatter of a copy's point around the model's, in metres.
const COPY_SCATTER_M: f64 = 0.008;
/// Range of reference distances: coarse corners are found from afar, fine ones from nearby, uniformly distributed over
/// sizes.
const REFERENCE_M: [f64; 2] = [0.5, 5.0];

/// The model of rooms, and of the corridor along them.
#[derive(Clone, Debug)]
pub struct Model {
    room: Vec<WorldPoint>,
    door_frame: Vec<WorldPoint>,
    stretch: Vec<WorldPoint>,
    corner: Vec<WorldPoint>,
}

impl Model {
    /// Designs a room and its stretch of corridor.
    pub fn new(plan: &FloorPlan, patterns: &Patterns, rng: &mut SeededRng) -> Self {
        let (left, right, depth) = (-ROOM_LEFT_M, plan.room_right_m(), plan.layout.depth_m);
        let mut room = Vec::new();
        for _ in 0..POINTS_PER_WALL {
            let (v, z) = (rng.within(0.1, depth), rng.within(0.3, CEILING_M - 0.1));
            room.push(model_point([left, v, z], [1.0, 0.0, 0.0], patterns, rng));
            let (v, z) = (rng.within(0.1, depth), rng.within(0.3, CEILING_M - 0.1));
            room.push(model_point([right, v, z], [-1.0, 0.0, 0.0], patterns, rng));
            let (u, z) = (rng.within(left, right), rng.within(0.3, CEILING_M - 0.1));
            room.push(model_point([u, depth, z], [0.0, -1.0, 0.0], patterns, rng));
            let (mut u, z) = (rng.within(left, right), rng.within(0.3, CEILING_M - 0.1));
            if u.abs() < DOORWAY_HALF_WIDTH_M {
                u += DOORWAY_HALF_WIDTH_M.copysign(u);
            }
            room.push(model_point([u, 0.0, z], [0.0, 1.0, 0.0], patterns, rng));
        }
        // Boxes in the frame of the door, between two corners each.
        let pieces = [
            // A bed along the right wall, a desk along the left one, a wardrobe behind the door, a chair, a television.
            [[right - 1.5, depth - 2.4, 0.0], [right, depth - 0.4, 0.55]],
            [[left, depth - 1.9, 0.0], [left + 0.6, depth - 0.6, 0.78]],
            [[right - 0.6, 0.1, 0.0], [right, 1.2, 2.0]],
            [[left + 0.7, depth - 1.5, 0.0], [left + 1.15, depth - 1.05, 0.95]],
            [[left, 1.4, 1.0], [left + 0.12, 2.3, 1.55]],
        ];
        let shift = rng.within(-0.15, 0.15);
        for piece in pieces {
            for _ in 0..POINTS_PER_PIECE {
                room.push(on_furniture(piece, shift, patterns, rng));
            }
        }
        let frame = (0..POINTS_PER_DOOR_FRAME).map(|number| {
            let side = if number % 2 == 0 { -1.0 } else { 1.0 };
            let u = side * (DOORWAY_HALF_WIDTH_M + rng.within(0.02, 0.12));
            model_point([u, 0.0, rng.within(0.1, 2.2)], [0.0, -1.0, 0.0], patterns, rng)
        });
        let door_frame = frame.collect();
        let (pitch, across) = (plan.layout.pitch_m, -2.0 * CORRIDOR_HALF_WIDTH_M);
        let mut stretch = Vec::new();
        for _ in 0..POINTS_PER_STRETCH {
            let u = rng.within(DOORWAY_HALF_WIDTH_M + 0.15, pitch - DOORWAY_HALF_WIDTH_M - 0.15);
            let z = rng.within(0.1, CEILING_M - 0.1);
            stretch.push(model_point([u, 0.0, z], [0.0, -1.0, 0.0], patterns, rng));
            let (u, z) = (rng.within(0.0, pitch), rng.within(0.1, CEILING_M - 0.1));
            stretch.push(model_point([u, across, z], [0.0, 1.0, 0.0], patterns, rng));
        }
        // Both outer walls of a corner, and both inner ones.
        let h = CORRIDOR_HALF_WIDTH_M;
        let mut corner = Vec::new();
        for _ in 0..POINTS_PER_CORNER_WALL {
            let (outer, inner) = (rng.within(-CORNER_ARM_M, h), rng.within(-CORNER_ARM_M, -h));
            let walls = [
                ([outer, h], [0.0, -1.0]),
                ([h, outer], [-1.0, 0.0]),
                ([-h, inner], [1.0, 0.0]),
                ([inner, -h], [0.0, 1.0]),
            ];
            for ([u, v], [nu, nv]) in walls {
                let z = rng.within(0.1, CEILING_M - 0.1);
                corner.push(model_point([u, v, z], [nu, nv, 0.0], patterns, rng));
            }
        }
        Self { room, door_frame, stretch, corner }
    }

    /// Builds a corner of the corridor: `spot` is in its middle and faces the wall ahead of a robot that will turn
    /// left.
    pub fn furnish_corner(&self, spot: &Spot, plan: &FloorPlan, rng: &mut SeededRng) -> Vec<WorldPoint> {
        copied_on_walls(&self.corner, spot, plan, rng).collect()
    }

    /// Builds the room behind this door, with its guest's belongings.
    pub fn furnish_room(
        &self,
        door: &Spot,
        plan: &FloorPlan,
        patterns: &Patterns,
        rng: &mut SeededRng,
    ) -> Vec<WorldPoint> {
        let mut points: Vec<WorldPoint> =
            (self.room.iter().chain(&self.door_frame)).map(|model| copied(model, door, rng)).collect();
        for _ in 0..OWN_POINTS {
            let (u, v) = (
                rng.within(-ROOM_LEFT_M + 0.3, plan.room_right_m() - 0.3),
                rng.within(0.8, plan.layout.depth_m - 0.3),
            );
            let angle: f64 = rng.within(-3.1, 3.1);
            let own =
                model_point([u, v, rng.within(0.05, 1.0)], [angle.sin(), angle.cos(), 0.0], patterns, rng);
            points.push(copied(&own, door, rng));
        }
        points
    }

    /// Builds the stretch of corridor to the right of this door.
    pub fn furnish_stretch(
        &self,
        door: &Spot,
        plan: &FloorPlan,
        patterns: &Patterns,
        rng: &mut SeededRng,
    ) -> Vec<WorldPoint> {
        let own = (0..OWN_POINTS).map(|number| {
            let (v, normal) = if number % 2 == 0 { (0.0, -1.0) } else { (-2.0 * CORRIDOR_HALF_WIDTH_M, 1.0) };
            let u = rng.within(DOORWAY_HALF_WIDTH_M + 0.15, plan.layout.pitch_m - 0.6);
            let z = rng.within(0.1, CEILING_M - 0.1);
            model_point([u, v, z], [0.0, normal, 0.0], patterns, rng)
        });
        let own: Vec<WorldPoint> = own.collect();
        copied_on_walls(self.stretch.iter().chain(&own), door, plan, rng).collect()
    }
}

/// Draws a point on a piece of furniture, a box between two corners.
fn on_furniture(
    [min, max]: [[f64; 3]; 2],
    shift: f64,
    patterns: &Patterns,
    rng: &mut SeededRng,
) -> WorldPoint {
    let mut position: [f64; 3] = std::array::from_fn(|axis| rng.within(min[axis], max[axis]));
    // On a side visible from the door, or on top.
    let normal = match rng.below(3) {
        0 => {
            position[1] = min[1];
            [0.0, -1.0, 0.0]
        }
        1 => {
            let from_left = max[0] > 1.0;
            position[0] = if from_left { min[0] } else { max[0] };
            [if from_left { -1.0 } else { 1.0 }, 0.0, 0.0]
        }
        _ => {
            position[2] = max[2];
            [0.0, 0.0, 1.0]
        }
    };
    position[1] += shift;
    model_point(position, normal, patterns, rng)
}

fn model_point(position: [f64; 3], normal: [f64; 3], patterns: &Patterns, rng: &mut SeededRng) -> WorldPoint {
    WorldPoint {
        position,
        normal,
        descriptor: patterns.model(rng),
        reference_m: rng.within(REFERENCE_M[0].ln(), REFERENCE_M[1].ln()).exp(),
        angle_deg: rng.within(0.0, 360.0),
    }
}

/// Copies points of a model past doors and corners, and drops those that are on no wall.
fn copied_on_walls<'m>(
    model: impl IntoIterator<Item = &'m WorldPoint>,
    spot: &Spot,
    plan: &FloorPlan,
    rng: &mut SeededRng,
) -> impl Iterator<Item = WorldPoint> {
    (model.into_iter())
        .map(move |model| copied(model, spot, rng))
        .filter(move |point| plan.has_wall_at([point.position[0], point.position[1]]))
}

fn copied(model: &WorldPoint, spot: &Spot, rng: &mut SeededRng) -> WorldPoint {
    let mut scattered = model.position;
    for (axis, coordinate) in scattered.iter_mut().enumerate() {
        // Within its surface: a copy's point moves along the wall, not into it.
        *coordinate += rng.normal(COPY_SCATTER_M) * (1.0 - model.normal[axis].abs());
    }
    let [x, y] = spot.at(scattered[0], scattered[1]);
    let [nx, ny] = spot.direction(model.normal[0], model.normal[1]);
    WorldPoint {
        position: [x, y, scattered[2]],
        normal: [nx, ny, model.normal[2]],
        descriptor: copy(model.descriptor, rng),
        ..*model
    }
}
