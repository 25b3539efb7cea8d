//! Examples: one of each body and answer, as the API document shows them.
//!
//! They tell one story: a corridor, a door with the number 901, and a robot that comes back to it.

mod anchors;
mod judgements;
mod keyframes;
mod keys;
mod location;
mod loops;
mod maps;
mod operations;
mod parts;

pub use anchors::*;
pub use judgements::*;
pub use keyframes::*;
pub use keys::*;
pub use location::*;
pub use loops::*;
pub use maps::*;
pub use operations::*;
