//! Figures: the paper's Figure 6 and a precision-recall curve, as SVG.

mod precision_recall;
mod trajectories;

pub use precision_recall::{Curve, precision_recall};
pub use trajectories::{Panel, trajectories};

/// Why a figure could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the figure cannot be drawn: {0}")]
pub struct FigureError(String);

impl FigureError {
    fn of(error: impl std::fmt::Display) -> Self {
        Self(error.to_string())
    }
}
