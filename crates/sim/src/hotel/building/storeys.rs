//! Storeys: identical-looking floors of one hotel.
//!
//! Each floor is furnished from the same models and has the same prints. Floors differ only in door numbers, guests'
//! belongings, centimetres and a few bits.

use super::floor_plan::Layout;
use super::signs::SignPlan;
use super::texture::Patterns;
use super::world::{World, WorldPlan};

/// The number of floors.
const STOREYS: usize = 3;
/// The number of different prints on the walls of a floor.
const PRINTS: usize = 6;

/// Builds the floors, from the lowest.
pub fn storeys(layout: Layout, lowest: u32, patterns: &Patterns, seed: u64) -> Vec<World> {
    let signs = SignPlan { prints: PRINTS, ..SignPlan::default() };
    let plan = WorldPlan { layout, floor: lowest, signs, seed };
    (0..STOREYS).map(|storey| World::storey(&plan, storey, patterns)).collect()
}
