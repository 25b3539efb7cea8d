//! Figures: the paper's Figure 6 and a precision-recall curve, as SVG.

mod error;
mod precision_recall;
mod trajectories;

pub use error::FigureError;
pub use precision_recall::{Curve, precision_recall};
pub use trajectories::{Panel, trajectories};
