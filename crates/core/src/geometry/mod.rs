//! Geometry: poses, boxes and bearings. All lengths in metres, all angles in radians.
//!
//! | concept | file |
//! |---|---|
//! | point in some frame | [`point`] |
//! | rigid transformation between two frames | [`pose`] |
//! | axis-aligned bounding box | [`aabb`] |
//! | bearing and distance of a point from a camera | [`bearing`] |
//! | direction of gravity | [`gravity`] |
//! | similarity transformation, and its closed form | [`sim3`], [`absolute_orientation`] |
//! | rigid transformation between two frames that know their vertical | [`upright_alignment`] |
//! | pinhole projection | [`pinhole`] |
//! | distances of binary descriptors | [`hamming`] |
//! | loops compiled for several instruction sets | `instruction_set` |
//! | seeded random numbers | [`sampling`] |

pub mod aabb;
pub mod absolute_orientation;
pub mod bearing;
pub mod gravity;
pub mod hamming;
pub(crate) mod instruction_set;
pub mod pinhole;
pub mod point;
pub mod pose;
pub mod sampling;
pub mod sim3;
pub mod upright_alignment;

pub use aabb::Aabb;
pub use bearing::Bearing;
pub use gravity::Gravity;
pub use point::Point3;
pub use pose::Pose;
pub use sim3::Sim3;
