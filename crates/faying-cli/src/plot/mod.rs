//! Pictures as SVG: a colour field on the mesh, a multiplier along its side, the rows of an active set.
//!
//! Text uses the viewer's own sans-serif font. Equal input gives equal bytes.

pub mod faces;
mod fields;
mod frame;
mod iteration;
mod sample;
mod side;
mod simplify;
mod solids;
mod study;
mod surface;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub use fields::{FieldPlot, fields};
pub use iteration::{IterationPlot, iteration};
pub use side::{ExactCurve, SidePlot, side};
pub use solids::solids;
pub use study::{Axis, MOST_LINES, StudyGroup, StudyLine, StudyPanel, StudyPlot, study};
pub use surface::{Shown, surface};

/// Error of drawing a picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// Nothing to draw.
    #[error("the picture of \"{0}\" has nothing to draw")]
    Empty(String),
    /// A part lacks the field.
    #[error("part \"{part}\" has no field \"{field}\" with component {component}")]
    NoField {
        /// The part.
        part: String,
        /// The field.
        field: String,
        /// Its component.
        component: usize,
    },
    /// The drawing library failed.
    #[error("drawing failed: {0}")]
    Drawing(String),
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for PlotError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self::Drawing(error.to_string())
    }
}

/// Drawing area of a picture.
type Root<'a, 'b> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// Units of the drawing per pixel of the picture: the backend rounds to whole units, so curves stay smooth.
const FINE: f64 = 8.0;

const INK: RGBColor = RGBColor(38, 43, 51);
const GREY: RGBColor = RGBColor(120, 127, 138);
const PALE: RGBColor = RGBColor(226, 229, 234);
const BLUE_LINE: RGBColor = RGBColor(31, 103, 173);
const RED_LINE: RGBColor = RGBColor(201, 76, 51);

/// `pixels` in units of the drawing.
fn units(pixels: f64) -> i32 {
    (pixels * FINE).round() as i32
}

/// A stroke of the given width in pixels.
fn stroke(color: impl Color, pixels: f64) -> ShapeStyle {
    ShapeStyle { color: color.to_rgba(), filled: false, stroke_width: units(pixels).max(1) as u32 }
}

/// Sans-serif text of the given size in pixels.
fn text(pixels: f64, color: RGBColor, h: HPos, v: VPos) -> TextStyle<'static> {
    ("sans-serif", pixels * FINE).into_font().color(&color).pos(Pos::new(h, v))
}

/// Text that fits a line of about `pixels` at the given size.
fn shortened(text: &str, pixels: f64, size: f64) -> String {
    let room = ((pixels / (0.56 * size)) as usize).max(8);
    let line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if line.chars().count() <= room { line } else { line.chars().take(room - 1).chain(['…']).collect() }
}

/// Draws in units and returns the text of an SVG that is `width` x `height` pixels large.
fn document(width: f64, height: f64, draw: impl FnOnce(&Root<'_, '_>) -> Result<(), PlotError>) -> Result<String, PlotError> {
    let (w, h) = (units(width).max(1) as u32, units(height).max(1) as u32);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (w, h)).into_drawing_area();
        root.fill(&WHITE)?;
        draw(&root)?;
        root.present()?;
    }
    // the viewBox keeps the fine units
    let size = format!("width=\"{w}\" height=\"{h}\" viewBox");
    Ok(svg.replacen(&size, &format!("width=\"{width:.0}\" height=\"{height:.0}\" viewBox"), 1))
}

/// Round numbers within `lo..=hi`, about `wanted` of them.
fn ticks(lo: f64, hi: f64, wanted: usize) -> Vec<f64> {
    let span = hi - lo;
    if !(span.is_finite() && span > 0.0) {
        return vec![lo];
    }
    let raw = span / wanted.max(1) as f64;
    let power = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= raw * 0.999).unwrap_or(10.0 * power);
    let (first, last) = ((lo / step - 1e-9).ceil() as i64, (hi / step + 1e-9).floor() as i64);
    (first..=last).map(|k| k as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let ulp = |t: Vec<f64>| t.iter().map(|t| crate::table::short(*t, 4)).collect::<Vec<_>>();
        assert_eq!(ulp(ticks(0.0, 1.0, 5)), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(ulp(ticks(-0.13, 0.21, 4)), ["-0.1", "0", "0.1", "0.2"]);
        assert_eq!(ticks(2.0, 2.0, 4), [2.0]);
    }
}
