//! Figure 6: estimated trajectories over the truth and the floor plan, side by side.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::error::FigureError;
use crate::hotel::building::floor_plan::{Flat, Wall};

/// One trajectory with its background.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Its title.
    pub title: String,
    /// One line below the title.
    pub caption: String,
    /// The robot's true positions.
    pub truth: Vec<Flat>,
    /// Its estimated positions, aligned with the truth.
    pub estimate: Vec<Flat>,
    /// The loops that it closed, by the indices of their ends in `estimate`, and whether they were correct.
    pub loops: Vec<(usize, usize, bool)>,
    /// The floor plan.
    pub walls: Vec<Wall>,
}

const PANEL_PX: (u32, u32) = (430, 400);
const TITLE_PX: u32 = 52;
const MARGIN_M: f64 = 3.0;
const WALLS: RGBColor = RGBColor(200, 200, 200);
const TRUTH: RGBColor = RGBColor(120, 120, 120);
const ESTIMATE: RGBColor = RGBColor(0, 90, 181);
const RIGHT: RGBColor = RGBColor(26, 133, 80);
const WRONG: RGBColor = RGBColor(220, 50, 32);

/// Draws panels side by side, all to one scale.
pub fn trajectories(panels: &[Panel]) -> Result<String, FigureError> {
    let mut svg = String::new();
    {
        let size = (PANEL_PX.0 * panels.len() as u32, PANEL_PX.1 + TITLE_PX);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let bounds = bounds(panels);
        for (area, panel) in root.split_evenly((1, panels.len())).iter().zip(panels) {
            draw(area, panel, bounds)?;
        }
        root.present()?;
    }
    Ok(svg)
}

/// Returns `[x0, x1, y0, y1]` around everything, with one scale for both axes.
fn bounds(panels: &[Panel]) -> [f64; 4] {
    let ends = panels.iter().flat_map(|panel| panel.walls.iter().flat_map(|wall| [wall.from, wall.to]));
    let points = panels.iter().flat_map(|panel| panel.truth.iter().chain(&panel.estimate).copied());
    let [mut x0, mut x1, mut y0, mut y1] = [f64::MAX, f64::MIN, f64::MAX, f64::MIN];
    for [x, y] in ends.chain(points) {
        (x0, x1, y0, y1) = (x0.min(x), x1.max(x), y0.min(y), y1.max(y));
    }
    let (width, height) = (x1 - x0 + 2.0 * MARGIN_M, y1 - y0 + 2.0 * MARGIN_M);
    let metres_per_px = (width / f64::from(PANEL_PX.0)).max(height / f64::from(PANEL_PX.1));
    let half = |px: u32| f64::from(px) * metres_per_px / 2.0;
    let (x, y) = (f64::midpoint(x0, x1), f64::midpoint(y0, y1));
    [x - half(PANEL_PX.0), x + half(PANEL_PX.0), y - half(PANEL_PX.1), y + half(PANEL_PX.1)]
}

fn draw(
    area: &DrawingArea<SVGBackend<'_>, Shift>,
    panel: &Panel,
    [x0, x1, y0, y1]: [f64; 4],
) -> Result<(), FigureError> {
    area.draw_text(&panel.title, &("sans-serif", 17).into_text_style(area), (14, 10))?;
    let small = ("sans-serif", 13).into_text_style(area).color(&TRUTH);
    area.draw_text(&panel.caption, &small, (14, 32))?;
    let (_, below) = area.split_vertically(TITLE_PX);
    let mut chart = ChartBuilder::on(&below).build_cartesian_2d(x0..x1, y0..y1)?;
    let tuple = |[x, y]: Flat| (x, y);
    for wall in &panel.walls {
        let line = [tuple(wall.from), tuple(wall.to)];
        chart.draw_series([PathElement::new(line, WALLS.stroke_width(1))])?;
    }
    let truth = panel.truth.iter().copied().map(tuple);
    let dashed = DashedLineSeries::new(truth, 5, 4, TRUTH.stroke_width(2));
    chart.draw_series(dashed)?;
    let estimate = panel.estimate.iter().copied().map(tuple);
    chart.draw_series(LineSeries::new(estimate, ESTIMATE.stroke_width(2)))?;
    for (from, to, is_right) in &panel.loops {
        let line = [tuple(panel.estimate[*from]), tuple(panel.estimate[*to])];
        let style = if *is_right { RIGHT.stroke_width(3) } else { WRONG.mix(0.5).stroke_width(1) };
        chart.draw_series([PathElement::new(line, style)])?;
    }
    // A scale bar of five metres.
    let (x, y) = (x0 + 2.0, y0 + 1.5);
    chart.draw_series([PathElement::new([(x, y), (x + 5.0, y)], BLACK.stroke_width(2))])?;
    let label = Text::new("5 m", (x + 5.4, y + 0.8), ("sans-serif", 13));
    chart.draw_series([label])?;
    Ok(())
}
