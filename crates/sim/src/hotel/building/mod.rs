//! The building: floor plan, furniture, signs, and their changes.

pub mod floor_plan;
pub mod furnishing;
#[cfg(test)]
mod realism;
pub mod renumbering;
pub mod signs;
pub mod storeys;
pub mod texture;
pub mod world;
