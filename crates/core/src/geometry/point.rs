//! Points.

/// A point in some frame, in metres; the name of the variable says which frame.
pub type Point3 = nalgebra::Point3<f64>;
