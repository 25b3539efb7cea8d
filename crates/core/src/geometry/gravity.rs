//! Gravity: the direction in which things fall, in some frame.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The unit vector of gravity, in the frame of its owner.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "[f64; 3]", try_from = "[f64; 3]")]
pub struct Gravity([f64; 3]);

impl Gravity {
    /// The most that the norm of a vector may be off 1. A client's own rounding stays far below it; a vector in m/s² does not.
    pub const MAX_NORM_ERROR: f64 = 1e-3;

    /// Returns the direction; `None` if the vector is not one of unit length.
    pub fn new(vector: [f64; 3]) -> Option<Self> {
        // Not written as `>`, so that a NaN is found, too.
        let is_unit = (Vector3::from(vector).norm() - 1.0).abs() <= Self::MAX_NORM_ERROR;
        is_unit.then_some(Self(vector))
    }

    /// Returns the vector as it was given.
    pub fn as_given(&self) -> [f64; 3] {
        self.0
    }

    /// Returns the vector at unit length.
    pub fn direction(&self) -> Vector3<f64> {
        Vector3::from(self.0).normalize()
    }
}

impl From<Gravity> for [f64; 3] {
    fn from(gravity: Gravity) -> Self {
        gravity.0
    }
}

impl TryFrom<[f64; 3]> for Gravity {
    type Error = &'static str;

    fn try_from(vector: [f64; 3]) -> Result<Self, Self::Error> {
        Self::new(vector).ok_or("the vector is not of unit length")
    }
}
