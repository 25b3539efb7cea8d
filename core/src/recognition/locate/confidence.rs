//! How sure a place is, by its own evidence and by that of the other places.
//!
//! Geometry proves a view, not a place. What counts is the part of the view that this place explains and no other place does;
//! and the signs that hang in one place only.

/// The least confidence with which a place is located.
pub const LOCATED_MIN_CONFIDENCE: f64 = 0.99;

/// Cells that a place explains and no rival does, from which it is located without any sign.
pub(in crate::recognition) const LOCATED_FROM_CELLS: f64 = 42.0;
/// Log-odds of one such cell.
pub(in crate::recognition) const CELL_LOG_ODDS: f64 = 0.2;
/// Log-odds of an identifier that agrees and hangs in one place only: a reader takes one number for another now and then.
pub(in crate::recognition) const SIGN_LOG_ODDS: f64 = 4.0;
/// Log-odds that a pair of identifiers which exclude each other takes away.
pub(in crate::recognition) const CONTRADICTION_LOG_ODDS: f64 = 6.0;
/// The log-odds of [`LOCATED_MIN_CONFIDENCE`].
const LOCATED_LOG_ODDS: f64 = 4.595;

/// The evidence for one place against its strongest rivals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Evidence {
    /// The cells of the view that it explains, and the rival that explains most of them does not.
    pub cells: usize,
    /// Identifiers that agree and hang in one place only.
    pub agreeing_signs: usize,
    /// The most such identifiers that agree with one rival, and not with this place.
    pub rival_signs: usize,
    /// Pairs of identifiers that exclude each other at the same relative place.
    pub contradicting_signs: usize,
}

impl Evidence {
    /// Returns the log-odds that the camera is at this place.
    pub fn log_odds(&self) -> f64 {
        let nothing = LOCATED_LOG_ODDS - CELL_LOG_ODDS * LOCATED_FROM_CELLS;
        nothing
            + CELL_LOG_ODDS * self.cells as f64
            + SIGN_LOG_ODDS * (self.agreeing_signs as f64 - self.rival_signs as f64)
            - CONTRADICTION_LOG_ODDS * self.contradicting_signs as f64
    }

    /// Returns the confidence, 0 to 1.
    pub fn confidence(&self) -> f64 {
        1.0 / (1.0 + libm::exp(-self.log_odds()))
    }

    /// Whether the place is located.
    pub fn is_located(&self) -> bool {
        self.confidence() >= LOCATED_MIN_CONFIDENCE
    }
}
