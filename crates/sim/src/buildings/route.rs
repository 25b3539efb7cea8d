//! Routes of the robots: sessions of stands, one after the other.

use std::f64::consts::{FRAC_PI_6, PI};

use super::world::{CORRIDOR_M, ROOM, Space, World};
use crate::geometry::{Point3, Pose};
use crate::hotel::rng::SeededRng;

/// From one keyframe to the next, in metres.
const STEP_M: f64 = 0.8;
/// Keyframes of a robot that looks round in a room.
const LOOKS: usize = 7;

/// The place at which a keyframe is taken.
#[derive(Clone, Copy, Debug)]
pub struct Stand {
    /// The corridor or room.
    pub space: Space,
    /// x and z in the frame of its corridor, in metres.
    pub at: [f64; 2],
    /// The heading about the vertical, in radians; 0 looks along the corridor.
    pub yaw_rad: f64,
    /// The second at which it is taken.
    pub second: u32,
}

impl Stand {
    /// Returns `corridor_from_camera`.
    pub fn corridor_from_camera(&self) -> Pose {
        let half = self.yaw_rad / 2.0;
        let rotation = [0.0, half.sin(), 0.0, half.cos()];
        Pose::new([self.at[0], 0.0, self.at[1]], rotation).unwrap_or_else(Pose::identity)
    }

    /// Returns where it stands in the building, in metres.
    pub fn place(&self) -> Point3 {
        let origin = self.space.origin();
        Point3::new(origin.x + self.at[0], origin.y, origin.z + self.at[1])
    }
}

/// Returns the corridor from one metre on, seen along it or against it.
fn corridor(space: Space, from_m: f64, to_m: f64, offset_m: f64) -> Vec<Stand> {
    let steps = ((to_m - from_m).abs() / STEP_M) as usize;
    let (sign, yaw_rad) = if to_m > from_m { (1.0, 0.0) } else { (-1.0, PI) };
    let stand = |step: usize| {
        let z = from_m + sign * STEP_M * step as f64;
        Stand { space, at: [offset_m, z], yaw_rad, second: 0 }
    };
    (0..steps).map(stand).collect()
}

/// Returns a look round the room.
fn look_round(space: Space, rng: &mut SeededRng) -> Vec<Stand> {
    let space = Space { is_room: true, ..space };
    let at = [ROOM[0] + rng.normal(0.15), ROOM[1] + rng.normal(0.15)];
    (0..LOOKS).map(|look| Stand { space, at, yaw_rad: look as f64 * FRAC_PI_6, second: 0 }).collect()
}

/// Returns the corridors of a building. Nobody drives in the last one but to ask where it is.
fn corridors(world: &World) -> Vec<Space> {
    let of_floor = |floor| (0..world.traits.wings).map(move |wing| Space { floor, wing, is_room: false });
    (0..world.traits.floors).flat_map(of_floor).collect()
}

/// Returns two drives that ask where they are: in a corridor that was mapped, and in one that was not.
pub fn questions(world: &World) -> [Vec<Stand>; 2] {
    let mut rng = SeededRng::new(world.seed, "questions");
    let spaces = corridors(world);
    let mapped = spaces[rng.below(3)];
    [mapped, spaces[3]]
        .map(|space| corridor(space, 1.0 + rng.within(0.0, STEP_M), CORRIDOR_M - 2.0, rng.normal(0.2)))
}

/// Returns the sessions of a world, in the order in which they are driven.
pub fn sessions(world: &World) -> Vec<Vec<Stand>> {
    let mut rng = SeededRng::new(world.seed, "route");
    let traits = &world.traits;
    let spaces = corridors(world);
    let whole = (0.5, CORRIDOR_M - 2.0);
    let part = (CORRIDOR_M / 2.0 - 2.0, CORRIDOR_M - 2.0);
    let [a, b, c] = [spaces[0], spaces[1], spaces[2]];
    let plan: &[&[(Space, (f64, f64))]] = if traits.lift {
        &[&[(a, whole), (b, whole)], &[(c, whole)], &[(b, whole), (a, part)], &[(c, part), (a, part)]]
    } else {
        &[&[(a, whole)], &[(b, whole)], &[(a, whole)], &[(c, whole)], &[(b, part)], &[(a, part)]]
    };
    let session = |legs: &&[(Space, (f64, f64))]| {
        let mut stands = Vec::new();
        let mut second = 0;
        for (leg, (space, (from_m, to_m))) in legs.iter().copied().enumerate() {
            // Between two floors a minute passes.
            second += 60 * leg as u32;
            let offset_m = rng.normal(0.2);
            let start = from_m + rng.within(0.0, STEP_M);
            let looks = if traits.starts_in_room { look_round(space, &mut rng) } else { Vec::new() };
            for stand in looks.into_iter().chain(corridor(space, start, to_m, offset_m)) {
                stands.push(Stand { second, ..stand });
                second += 2;
            }
        }
        stands
    };
    plan.iter().map(session).collect()
}
