//! Signs of a session and of the plans, as far as an alignment depends on them.

use nalgebra::{Vector2, Vector3};

/// A sign that a session saw; its frame is levelled: z points up.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenSign {
    /// The mean of its sightings, in metres.
    pub position: Vector3<f64>,
    /// The variance of that mean along each axis, in m².
    pub variance: f64,
    /// The mean place of the cameras that saw it.
    pub seen_from: Vector2<f64>,
    /// The cost of the assumption that its text was misread, as a logarithm: large where it was read alike several times.
    pub misread_cost: f64,
    /// Signs of the plans with its text, by number.
    pub same: Vec<usize>,
    /// Signs of the plans with a text that differs in one character, by number.
    pub similar: Vec<usize>,
    /// Whether the plans show its text at one place.
    pub is_distinctive: bool,
    /// Whether its text is more than a word that hangs in every building (EXIT), also where no plan shows it.
    pub is_specific: bool,
}

/// A sign that a plan shows.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnSign {
    /// The number of the plan's frame.
    pub frame: usize,
    /// Its position in that frame, in metres.
    pub position: Vector3<f64>,
    /// The direction out of the wall, a unit vector along the floor.
    pub normal: Option<Vector2<f64>>,
}

/// All signs that an alignment is estimated from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signs {
    /// What the session saw.
    pub seen: Vec<SeenSign>,
    /// What the plans show with these texts, or with similar ones.
    pub drawn: Vec<DrawnSign>,
}
