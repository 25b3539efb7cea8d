//! Route: the robot starts in a room, visits others through the corridor in some order, and returns (§VI-A).
//!
//! It makes a keyframe after a certain distance or turn. In each room it looks around once. On leaving it turns once
//! in front of the door, so that it has read the plate.

use std::f64::consts::{PI, TAU};

use super::building::floor_plan::{CORRIDOR_HALF_WIDTH_M, FloorPlan};
use super::rng::SeededRng;
use super::sensing::camera::Stand;

/// Maximum metres between keyframes.
pub const KEYFRAME_EVERY_M: f64 = 0.6;
/// Maximum turn between keyframes.
pub const KEYFRAME_EVERY_RAD: f64 = 18.0 / 180.0 * PI;
/// Distance of a room's middle from its door.
const ROOM_MIDDLE_M: f64 = 2.3;
/// Distance from the door at which the robot looks out of a room.
const THRESHOLD_M: f64 = 0.4;
/// Lateral deviation of a pass from the line, in metres, so that no two passes are the same.
const PASS_SCATTER_M: f64 = 0.12;
/// Scatter of the heading between keyframes.
const HEADING_SCATTER_RAD: f64 = 0.02;

/// The place of a visit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Place {
    /// In this room, behind its door.
    Room(usize),
    /// In the corridor.
    Corridor,
}

/// A keyframe's true pose and visit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Its pose.
    pub stand: Stand,
    /// The number of the visit, from 0: a stay in a room, or a walk between two.
    pub visit: usize,
    /// The visit's place.
    pub place: Place,
    /// The floor, of several identical-looking ones, from 0.
    pub storey: usize,
}

/// The robot's walk so far.
struct Walk<'a> {
    plan: &'a FloorPlan,
    rng: &'a mut SeededRng,
    stops: Vec<Stop>,
    at: Stand,
    visit: usize,
    place: Place,
}

/// Returns the keyframes of a tour through these rooms, starting in the first.
pub fn tour(plan: &FloorPlan, rooms: &[usize], rng: &mut SeededRng) -> Vec<Stop> {
    let Some(&first) = rooms.first() else { return Vec::new() };
    let door = plan.rooms[first].door;
    let at = Stand { at: door.at(0.0, ROOM_MIDDLE_M), heading_rad: door.heading_rad() };
    let mut walk = Walk { plan, rng, stops: Vec::new(), at, visit: 0, place: Place::Room(first) };
    walk.stop();
    walk.look_around();
    for pair in rooms.windows(2) {
        walk.leave(pair[0]);
        walk.follow_corridor(pair[0], pair[1]);
        walk.enter(pair[1]);
        walk.look_around();
    }
    // Back in the first room, it again sees its first view, the way out.
    walk.head_out(rooms[rooms.len() - 1], THRESHOLD_M);
    walk.stops
}

impl Walk<'_> {
    fn stop(&mut self) {
        let mut stand = self.at;
        stand.heading_rad += self.rng.normal(HEADING_SCATTER_RAD);
        let place = self.plan.room_around(stand.at).map_or(Place::Corridor, Place::Room);
        if place != self.place {
            self.visit += 1;
            self.place = place;
        }
        self.stops.push(Stop { stand, visit: self.visit, place, storey: 0 });
    }

    /// Turns to a heading in the shorter direction.
    fn turn_to(&mut self, heading_rad: f64) {
        let turn = (heading_rad - self.at.heading_rad + PI).rem_euclid(TAU) - PI;
        self.turn_by(turn);
    }

    fn turn_by(&mut self, turn_rad: f64) {
        let steps = (turn_rad.abs() / KEYFRAME_EVERY_RAD).ceil();
        let from = self.at.heading_rad;
        for step in 1..=steps as usize {
            self.at.heading_rad = from + turn_rad * step as f64 / steps;
            self.stop();
        }
    }

    fn look_around(&mut self) {
        let turn = if self.rng.happens(0.5) { TAU } else { -TAU };
        self.turn_by(turn);
    }

    /// Drives straight to approximately this point, looking ahead.
    fn drive_to(&mut self, [x, y]: [f64; 2]) {
        let mut scatter = || self.rng.within(-PASS_SCATTER_M, PASS_SCATTER_M);
        let to = [x + scatter(), y + scatter()];
        let from = self.at.at;
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let steps = (dx.hypot(dy) / KEYFRAME_EVERY_M).ceil();
        for step in 1..=steps as usize {
            let share = step as f64 / steps;
            self.at.at = [from[0] + share * dx, from[1] + share * dy];
            self.stop();
        }
    }

    /// Turns to the door and drives up to so far behind it.
    fn head_out(&mut self, room: usize, behind_m: f64) {
        let door = self.plan.rooms[room].door;
        self.turn_to(door.heading_rad() + PI);
        self.drive_to(door.at(0.0, behind_m));
    }

    fn leave(&mut self, room: usize) {
        self.head_out(room, -CORRIDOR_HALF_WIDTH_M);
        self.look_around();
    }

    fn enter(&mut self, room: usize) {
        let door = self.plan.rooms[room].door;
        self.turn_to(door.heading_rad());
        self.drive_to(door.at(0.0, ROOM_MIDDLE_M));
    }

    /// Drives from one door to another, the shorter way around the ring.
    fn follow_corridor(&mut self, from: usize, to: usize) {
        let ring_m = self.plan.ring_m();
        let (from_m, to_m) = (self.plan.rooms[from].along_m, self.plan.rooms[to].along_m);
        let ahead_m = (to_m - from_m).rem_euclid(ring_m);
        let forward = ahead_m <= ring_m / 2.0;
        let total_m = if forward { ahead_m } else { ring_m - ahead_m };
        let sign = if forward { 1.0 } else { -1.0 };
        let travelled_m = |corner_m: f64| (sign * (corner_m - from_m)).rem_euclid(ring_m);
        let mut ends: Vec<f64> =
            self.plan.corners_m().into_iter().map(travelled_m).filter(|m| *m < total_m).collect();
        ends.sort_by(f64::total_cmp);
        ends.push(total_m);
        let mut start_m = 0.0;
        for end_m in ends {
            let middle_m = from_m + sign * (start_m + end_m) / 2.0;
            let (_, along) = self.plan.centreline(middle_m);
            self.turn_to(if forward { along } else { along + PI });
            let (at, _) = self.plan.centreline(from_m + sign * end_m);
            self.drive_to(at);
            start_m = end_m;
        }
    }
}

/// Returns a number of rooms in random order, followed by the first again.
pub fn some_rooms(plan: &FloorPlan, count: usize, rng: &mut SeededRng) -> Vec<usize> {
    let mut rooms: Vec<usize> = (0..plan.rooms.len()).collect();
    rng.shuffle(&mut rooms);
    rooms.truncate(count);
    rooms.push(rooms[0]);
    rooms
}

/// Returns the angle between two headings, in `[0, pi]`.
pub fn heading_difference_rad(a: f64, b: f64) -> f64 {
    ((a - b + PI).rem_euclid(TAU) - PI).abs()
}

#[cfg(test)]
mod tests {
    use super::super::building::floor_plan::{Layout, is_hidden};
    use super::*;

    #[test]
    fn a_tour_goes_through_no_wall_and_ends_where_it_began() {
        for (seed, layout) in [Layout::SE1, Layout::SE2].into_iter().cycle().take(8).enumerate() {
            let plan = FloorPlan::new(layout);
            let mut rng = SeededRng::new(seed as u64, "route");
            let rooms = some_rooms(&plan, 6, &mut rng);
            let stops = tour(&plan, &rooms, &mut rng);
            for pair in stops.windows(2) {
                let (a, b) = (pair[0].stand, pair[1].stand);
                assert!(!is_hidden(a.at, b.at, &plan.walls), "{a:?} -> {b:?}");
                let step_m = (a.at[0] - b.at[0]).hypot(a.at[1] - b.at[1]);
                assert!(step_m < KEYFRAME_EVERY_M + 1e-9);
                let turn = heading_difference_rad(a.heading_rad, b.heading_rad);
                assert!(turn < KEYFRAME_EVERY_RAD + 8.0 * HEADING_SCATTER_RAD, "{turn}");
            }
            let (first, last) = (stops[0].stand.at, stops[stops.len() - 1].stand.at);
            assert!((first[0] - last[0]).hypot(first[1] - last[1]) < ROOM_MIDDLE_M + 0.5);
            assert_eq!(stops[stops.len() - 1].place, stops[0].place);
            assert_eq!(stops[stops.len() - 1].visit, 12);
        }
    }
}
