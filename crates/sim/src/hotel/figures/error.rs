//! Errors of figures.

use plotters::drawing::DrawingAreaErrorKind;

/// The reason why a figure could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the figure cannot be drawn: {0}")]
pub struct FigureError(#[from] DrawingAreaErrorKind<std::io::Error>);
