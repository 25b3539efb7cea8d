//! Geometry: poses, boxes and bearings. All lengths in metres, all angles in radians.
//!
//! | concept | file |
//! |---|---|
//! | rigid transformation between two frames | [`pose`] |
//! | axis-aligned bounding box | [`aabb`] |
//! | bearing and distance of a point from a camera | [`bearing`] |

pub mod aabb;
pub mod bearing;
pub mod pose;

/// A point in some frame, in metres; the name of the variable says which frame.
pub type Point3 = nalgebra::Point3<f64>;

pub use aabb::Aabb;
pub use bearing::Bearing;
pub use pose::Pose;
