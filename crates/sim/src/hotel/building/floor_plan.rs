//! Floor plan: a ring corridor with rooms around it, as in the paper's Figure 5, seen from above.
//!
//! Lengths in metres, z up, the floor at 0. The corridor's centreline is a rectangle of about 100 m with corners at
//! (0, 0) and (length, width); rooms lie outside the outer wall, and in some layouts inside the inner one as well.

use crate::hotel::rng::SeededRng;

/// A point or direction on the floor.
pub type Flat = [f64; 2];

/// Half the corridor's width of 2.2 m (§VI-A).
pub const CORRIDOR_HALF_WIDTH_M: f64 = 1.1;
/// Half the width of a doorway.
pub const DOORWAY_HALF_WIDTH_M: f64 = 0.45;
/// The height of walls.
pub const CEILING_M: f64 = 2.6;
/// The distance of a room's left wall from the middle of its door, looking in.
pub const ROOM_LEFT_M: f64 = 1.0;

/// A wall as seen from above: everything from floor to ceiling between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// One end.
    pub from: Flat,
    /// The other.
    pub to: Flat,
}

/// A place on a wall with its own frame: `u` to the right when looking along `facing`, `v` along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The origin of u and v.
    pub origin: Flat,
    /// A unit vector.
    pub facing: Flat,
}

impl Spot {
    /// Returns a point of the spot's frame on the floor.
    pub fn at(&self, u: f64, v: f64) -> Flat {
        let [right, facing] = [self.right(), self.facing];
        [self.origin[0] + u * right[0] + v * facing[0], self.origin[1] + u * right[1] + v * facing[1]]
    }

    /// Returns a direction of the spot's frame.
    pub fn direction(&self, u: f64, v: f64) -> Flat {
        let [right, facing] = [self.right(), self.facing];
        [u * right[0] + v * facing[0], u * right[1] + v * facing[1]]
    }

    /// Returns the heading of `facing`, in radians from x towards y.
    pub fn heading_rad(&self) -> f64 {
        self.facing[1].atan2(self.facing[0])
    }

    fn right(&self) -> Flat {
        [self.facing[1], -self.facing[0]]
    }
}

/// A room behind its door.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// The middle of the doorway, facing into the room.
    pub door: Spot,
    /// The position of its door along the corridor's centreline.
    pub along_m: f64,
}

/// The parameters of a layout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// The centreline's long side, in metres.
    pub length_m: f64,
    /// Its short side.
    pub width_m: f64,
    /// The distance between doors.
    pub pitch_m: f64,
    /// Rooms outside each long side, outside each short side, and inside each long side.
    pub rooms: [usize; 3],
    /// The depth of a room.
    pub depth_m: f64,
}

impl Layout {
    /// 24 rooms outside a slim ring.
    pub const SE1: Self =
        Self { length_m: 34.0, width_m: 16.0, pitch_m: 4.2, rooms: [8, 4, 0], depth_m: 5.0 };
    /// 24 rooms outside and inside a wider one.
    pub const SE2: Self =
        Self { length_m: 29.0, width_m: 21.0, pitch_m: 4.6, rooms: [6, 4, 2], depth_m: 5.6 };

    /// Draws a random layout similar to these, with 24 rooms.
    pub fn random(rng: &mut SeededRng) -> Self {
        let rooms = *rng.one_of(&[[8, 4, 0], [7, 4, 1], [6, 4, 2], [6, 3, 3]]);
        let pitch_m = rng.within(3.9, 4.5);
        let length_m = (rooms[0] as f64 * pitch_m + rng.within(0.0, 1.5)).max(26.0);
        let width_m = (50.0 - length_m).max(rooms[1] as f64 * pitch_m + 0.2);
        Self { length_m, width_m, pitch_m, rooms, depth_m: rng.within(4.6, 5.6) }
    }
}

/// A floor plan.
#[derive(Clone, Debug)]
pub struct FloorPlan {
    /// Its dimensions.
    pub layout: Layout,
    /// Every wall; doorways are gaps between them.
    pub walls: Vec<Wall>,
    /// The rooms, in the order of their doors along the corridor.
    pub rooms: Vec<Room>,
    /// The places where the corridor's pattern repeats: each door of its outer wall, and further on up to the corners.
    pub bays: Vec<Spot>,
}

impl FloorPlan {
    /// Draws the plan of a layout.
    pub fn new(layout: Layout) -> Self {
        let Layout { length_m: l, width_m: w, .. } = layout;
        let h = CORRIDOR_HALF_WIDTH_M;
        let mut plan = Self { layout, walls: Vec::new(), rooms: Vec::new(), bays: Vec::new() };
        // Around the ring, anticlockwise: each side's start and direction, and the corridor before it.
        let sides: [(Flat, Flat, f64, f64); 4] = [
            ([0.0, 0.0], [1.0, 0.0], l, 0.0),
            ([l, 0.0], [0.0, 1.0], w, l),
            ([l, w], [-1.0, 0.0], l, l + w),
            ([0.0, w], [0.0, -1.0], w, 2.0 * l + w),
        ];
        for (number, (start, along, side_m, before_m)) in sides.into_iter().enumerate() {
            let is_long = number % 2 == 0;
            let outside = [along[1], -along[0]];
            let inside = [-along[1], along[0]];
            let (outer, inner) = (layout.rooms[number % 2], if is_long { layout.rooms[2] } else { 0 });
            plan.side(start, along, side_m, before_m, outside, outer, h);
            plan.side(start, along, side_m, before_m, inside, inner, -h);
        }
        plan.rooms.sort_by(|a, b| a.along_m.total_cmp(&b.along_m));
        plan
    }

    /// Returns the length of the corridor along its centreline.
    pub fn ring_m(&self) -> f64 {
        2.0 * (self.layout.length_m + self.layout.width_m)
    }

    /// Returns a point of the centreline, and the heading of the corridor there (anticlockwise).
    pub fn centreline(&self, along_m: f64) -> (Flat, f64) {
        let Layout { length_m: l, width_m: w, .. } = self.layout;
        let s = along_m.rem_euclid(self.ring_m());
        let quarter = std::f64::consts::FRAC_PI_2;
        if s < l {
            ([s, 0.0], 0.0)
        } else if s < l + w {
            ([l, s - l], quarter)
        } else if s < 2.0 * l + w {
            ([2.0 * l + w - s, w], 2.0 * quarter)
        } else {
            ([0.0, self.ring_m() - s], 3.0 * quarter)
        }
    }

    /// Returns the positions of the corridor's corners along its centreline.
    pub fn corners_m(&self) -> [f64; 4] {
        let Layout { length_m: l, width_m: w, .. } = self.layout;
        [0.0, l, l + w, 2.0 * l + w]
    }

    /// Builds one side of the corridor: its wall with gaps for doors, and the rooms behind. At both ends, the wall is
    /// longer than the centreline by `overhang_m` (an inner wall is shorter).
    #[expect(clippy::too_many_arguments, reason = "one call site, a row of a table")]
    fn side(
        &mut self,
        start: Flat,
        along: Flat,
        side_m: f64,
        before_m: f64,
        facing: Flat,
        rooms: usize,
        overhang_m: f64,
    ) {
        let h = CORRIDOR_HALF_WIDTH_M;
        let on_wall =
            |s: f64| [start[0] + s * along[0] + h * facing[0], start[1] + s * along[1] + h * facing[1]];
        let Layout { pitch_m, depth_m, .. } = self.layout;
        let first = side_m / 2.0 - (rooms as f64 - 1.0) / 2.0 * pitch_m;
        if overhang_m > 0.0 {
            let before = ((first + overhang_m) / pitch_m).ceil();
            let bays = (0..).map(|number| first + (f64::from(number) - before) * pitch_m);
            let within = bays.take_while(|s| *s < side_m + overhang_m + pitch_m);
            self.bays.extend(within.map(|s| Spot { origin: on_wall(s), facing }));
        }
        let mut free_from = -overhang_m;
        for number in 0..rooms {
            let s = first + number as f64 * pitch_m;
            self.walls.push(Wall { from: on_wall(free_from), to: on_wall(s - DOORWAY_HALF_WIDTH_M) });
            free_from = s + DOORWAY_HALF_WIDTH_M;
            let door = Spot { origin: on_wall(s), facing };
            self.rooms.push(Room { door, along_m: before_m + s });
            let right_m = pitch_m - ROOM_LEFT_M - 0.1;
            let corners = [
                door.at(-ROOM_LEFT_M, 0.0),
                door.at(-ROOM_LEFT_M, depth_m),
                door.at(right_m, depth_m),
                door.at(right_m, 0.0),
            ];
            self.walls.extend(corners.windows(2).map(|pair| Wall { from: pair[0], to: pair[1] }));
        }
        self.walls.push(Wall { from: on_wall(free_from), to: on_wall(side_m + overhang_m) });
    }

    /// Returns the room that contains this point, if any.
    pub fn room_around(&self, [x, y]: Flat) -> Option<usize> {
        self.rooms.iter().position(|room| {
            let ([ox, oy], [fx, fy]) = (room.door.origin, room.door.facing);
            let (dx, dy) = (x - ox, y - oy);
            let (u, v) = (dx * fy - dy * fx, dx * fx + dy * fy);
            (-ROOM_LEFT_M..=self.room_right_m()).contains(&u) && (0.0..=self.layout.depth_m).contains(&v)
        })
    }

    /// Returns the distance of a room's right wall from the middle of its door, looking in.
    pub fn room_right_m(&self) -> f64 {
        self.layout.pitch_m - ROOM_LEFT_M - 0.1
    }

    /// Whether a point is on a wall.
    pub fn has_wall_at(&self, at: Flat) -> bool {
        self.walls.iter().any(|wall| {
            let (dx, dy) = (wall.to[0] - wall.from[0], wall.to[1] - wall.from[1]);
            let length = dx.hypot(dy);
            let (tx, ty) = (at[0] - wall.from[0], at[1] - wall.from[1]);
            let (along, off) = ((tx * dx + ty * dy) / length, (tx * dy - ty * dx) / length);
            (0.0..=length).contains(&along) && off.abs() < 0.05
        })
    }

    /// Returns the walls within this range of a point.
    pub fn walls_around(&self, eye: Flat, range_m: f64) -> Vec<Wall> {
        self.walls.iter().copied().filter(|wall| distance_m(eye, wall) < range_m).collect()
    }
}

/// Whether a wall stands between two points.
pub fn is_hidden(eye: Flat, point: Flat, walls: &[Wall]) -> bool {
    // A point on a wall is visible from its own side, so the line of sight ends just before it.
    let before = |axis: usize| eye[axis] + (point[axis] - eye[axis]) * 0.995;
    let end = [before(0), before(1)];
    walls.iter().any(|wall| cross(eye, end, wall.from, wall.to))
}

fn cross(a: Flat, b: Flat, c: Flat, d: Flat) -> bool {
    let side = |p: Flat, q: Flat, r: Flat| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

fn distance_m(point: Flat, wall: &Wall) -> f64 {
    let span = [wall.to[0] - wall.from[0], wall.to[1] - wall.from[1]];
    let towards = [point[0] - wall.from[0], point[1] - wall.from[1]];
    let length = span[0].mul_add(span[0], span[1] * span[1]);
    let share = if length > 0.0 { (towards[0] * span[0] + towards[1] * span[1]) / length } else { 0.0 };
    let share = share.clamp(0.0, 1.0);
    (towards[0] - share * span[0]).hypot(towards[1] - share * span[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_layouts_have_24_rooms_around_a_ring_of_100_metres() {
        for layout in [Layout::SE1, Layout::SE2] {
            let plan = FloorPlan::new(layout);
            assert_eq!(plan.rooms.len(), 24);
            assert!((plan.ring_m() - 100.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_room_is_seen_through_its_door_and_not_through_a_wall() {
        let plan = FloorPlan::new(Layout::SE1);
        let door = plan.rooms[3].door;
        let inside = door.at(0.0, 2.0);
        assert!(!is_hidden(door.at(0.0, -1.1), inside, &plan.walls));
        assert!(is_hidden(door.at(2.0, -1.1), door.at(1.5, 2.0), &plan.walls));
        let next = plan.rooms[4].door.at(0.0, 2.0);
        assert!(is_hidden(inside, next, &plan.walls));
    }

    #[test]
    fn random_layouts_have_24_rooms_that_fit_their_sides() {
        for seed in 0..200 {
            let layout = Layout::random(&mut SeededRng::new(seed, "layout"));
            let plan = FloorPlan::new(layout);
            assert_eq!(plan.rooms.len(), 24, "seed {seed}");
            assert!((85.0..120.0).contains(&plan.ring_m()), "seed {seed}: {}", plan.ring_m());
            assert!(layout.rooms[0] as f64 * layout.pitch_m <= layout.length_m + 1e-9);
            assert!(layout.rooms[1] as f64 * layout.pitch_m <= layout.width_m + 1e-9);
        }
    }
}
