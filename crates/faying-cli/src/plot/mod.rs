//! Pictures as SVG: a colour field on the mesh, a multiplier along its side, the rows of an active set.
//!
//! Text uses the viewer's own sans-serif font. Equal input gives equal bytes.

mod compact;
pub mod faces;
mod field_plot;
mod fields;
mod frame;
mod iteration;
mod marks;
pub mod mesh_faces;
mod obstacles;
mod sample;
mod side;
mod simplify;
mod solids;
mod study;
mod surface;

use crate::table::short;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub use field_plot::FieldPlot;
pub use fields::fields;
pub use iteration::{IterationPlot, IterationStep, iteration};
pub use side::{ExactLambda, SidePlot, SlaveCurve, side};
pub use solids::solids;
pub use study::{Axis, MOST_LINES, StudyGroup, StudyLine, StudyPanel, StudyPlot, study};
pub use surface::{SurfaceQuantity, surface};

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

/// Number `k` of a field that a picture shows; NaN where it is missing.
fn number(plot: &FieldPlot<'_>, components: usize, values: &[f64], k: usize) -> f64 {
    let own = values.get(k * components..(k + 1) * components).unwrap_or_default();
    match plot.component {
        Some(component) => own.get(component).copied().unwrap_or(f64::NAN),
        None if own.is_empty() => f64::NAN,
        None => own.iter().map(|v| v * v).sum::<f64>().sqrt(),
    }
}

/// The error of a part that lacks the field.
fn lacks(plot: &FieldPlot<'_>, part: &str) -> PlotError {
    PlotError::NoField { part: part.to_owned(), field: plot.field.to_owned(), component: plot.component.unwrap_or(0) }
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

/// The lines of a text of at most about `pixels` at the given size, broken at blanks; the third and last one may be cut.
fn wrapped(text: &str, pixels: f64, size: f64) -> Vec<String> {
    let room = ((pixels / (0.56 * size)) as usize).max(8);
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let last = lines.len() == 3;
        match lines.last_mut().filter(|line| last || line.chars().count() + 1 + word.chars().count() <= room) {
            Some(line) => *line += &format!(" {word}"),
            None => lines.push(word.to_owned()),
        }
    }
    lines.iter().map(|line| shortened(line, pixels, size)).collect()
}

/// Height of a line of a heading over its size.
const LINE: f64 = 1.3;

/// Additional height of a heading of several lines, in pixels.
fn taller(title: &str, pixels: f64, size: f64) -> f64 {
    LINE * size * wrapped(title, pixels, size).len().saturating_sub(1) as f64
}

/// Writes a heading of at most `pixels` per line at the left, in pixels from the top.
fn heading(root: &Root<'_, '_>, title: &str, [left, top]: [f64; 2], pixels: f64, size: f64) -> Result<(), PlotError> {
    for (k, line) in wrapped(title, pixels, size).into_iter().enumerate() {
        let at = (units(left), units(top + LINE * size * k as f64));
        root.draw(&Text::new(line, at, text(size, INK, HPos::Left, VPos::Top)))?;
    }
    Ok(())
}

/// " [mm]" behind the name of a quantity with a unit; empty without.
pub(crate) fn in_unit(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" [{unit}]") }
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

/// Pictures one below the other, as one document; each begins with its width and height.
pub fn stacked(pictures: &[String]) -> String {
    let size = |svg: &str, word: &str| -> f64 {
        let value = svg.split_once(word).and_then(|(_, rest)| rest.split('"').next());
        value.and_then(|v| v.parse().ok()).unwrap_or(0.0)
    };
    let width = pictures.iter().map(|svg| size(svg, " width=\"")).fold(0.0, f64::max);
    let (mut inner, mut top) = (String::new(), 0.0);
    for svg in pictures {
        inner += &svg.replacen("<svg ", &format!("<svg y=\"{top}\" "), 1);
        top += size(svg, " height=\"");
    }
    let area = format!("width=\"{width}\" height=\"{top}\"");
    format!(
        "<svg {area} viewBox=\"0 0 {width} {top}\" xmlns=\"http://www.w3.org/2000/svg\">\n<rect {area} fill=\"#FFFFFF\"/>\n{inner}</svg>\n"
    )
}

/// Numbers as labels of at least `digits` digits, as many as it takes for all of them to differ.
fn labels(values: &[f64], digits: usize) -> Vec<String> {
    let with = |digits: usize| values.iter().map(|v| short(*v, digits)).collect::<Vec<_>>();
    let differ = |words: &Vec<String>| words.windows(2).all(|pair| pair[0] != pair[1]);
    (digits..=16).map(with).find(differ).unwrap_or_else(|| with(17))
}

/// Round numbers within `lo..=hi`, about `wanted` of them, at least three.
fn ticks(lo: f64, hi: f64, wanted: usize) -> Vec<f64> {
    let span = hi - lo;
    if !(span.is_finite() && span > 0.0) {
        return vec![lo];
    }
    let raw = span / wanted.max(1) as f64;
    let power = 10f64.powf(raw.log10().floor());
    let steps = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0].map(|m| m * power);
    let start = steps.iter().position(|s| *s >= raw * 0.999).unwrap_or(steps.len() - 1);
    let within = |step: f64| ((lo / step - 1e-9).ceil() as i64, (hi / step + 1e-9).floor() as i64);
    let step = steps[..=start].iter().rev().find(|s| within(**s).1 - within(**s).0 >= 2).copied().unwrap_or(steps[0]);
    let (first, last) = within(step);
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
        // one round number of the wanted step would lie within: finer ones
        assert_eq!(ulp(ticks(0.9, 1.4, 1)), ["1", "1.2", "1.4"]);
        assert!((1..9).all(|wanted| (0..200).all(|k| ticks(0.013 * f64::from(k), 0.02 * f64::from(k) + 0.37, wanted).len() > 2)));
    }

    #[test]
    fn labels_differ() {
        assert_eq!(labels(&[0.0, 0.5, 1.0], 4), ["0", "0.5", "1"]);
        assert_eq!(labels(&[1000.01, 1000.02, 1000.03], 4), ["1000.01", "1000.02", "1000.03"]);
    }

    #[test]
    fn long_headings_are_wrapped_at_blanks() {
        let title = "A long title of many words that does not fit into one line of the picture at this size";
        let lines = wrapped(title, 300.0, 17.0);
        assert_eq!((lines.len(), lines.join(" ").as_str()), (3, title));
        assert!(lines.iter().all(|line| line.chars().count() <= 31));
        assert!(wrapped(title, 120.0, 17.0)[2].ends_with('…'));
        assert_eq!(wrapped("", 100.0, 17.0).len(), 0);
    }
}
