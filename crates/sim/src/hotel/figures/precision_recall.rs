//! Precision over recall, as the threshold of each arm varies from strict to lenient.

use plotters::prelude::*;

use super::error::FigureError;

/// One arm's curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The name in the legend.
    pub name: String,
    /// (recall, precision), from the strictest threshold.
    pub points: Vec<(f64, f64)>,
    /// The point of the default threshold.
    pub operating_point: Option<(f64, f64)>,
}

const SIZE_PX: (u32, u32) = (640, 460);
/// Okabe and Ito's palette, which colour-blind readers can distinguish, too.
const COLOURS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(230, 159, 0), RGBColor(204, 121, 167), RGBColor(0, 158, 115)];

/// Draws the curves.
pub fn precision_recall(curves: &[Curve]) -> Result<String, FigureError> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE_PX).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .margin(16)
            .x_label_area_size(44)
            .y_label_area_size(54)
            .build_cartesian_2d(0.0..1.0, 0.0..1.02)?;
        chart
            .configure_mesh()
            .x_desc("recall, by query")
            .y_desc("precision, by query")
            .light_line_style(TRANSPARENT)
            .draw()?;
        for (curve, colour) in curves.iter().zip(COLOURS.iter().cycle()) {
            let colour = *colour;
            chart
                .draw_series(LineSeries::new(curve.points.iter().copied(), colour.stroke_width(2)))?
                .label(&curve.name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
            let point = curve.operating_point.into_iter().map(|at| Circle::new(at, 5, colour.filled()));
            chart.draw_series(point)?;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerLeft)
            .background_style(WHITE.mix(0.9))
            .border_style(RGBColor(200, 200, 200))
            .draw()?;
        root.present()?;
    }
    Ok(svg)
}
