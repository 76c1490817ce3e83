//! `interface_NAME.svg`: the multiplier along its side, with the functions that are active.

use super::{BLUE_LINE, GREY, INK, PALE, PlotError, RED_LINE, document, heading, in_unit, labels, stroke, taller, text, ticks, units};
use crate::table::{InterfaceRow, short};
use faying::basis::{Elements, Order};
use faying::geometry::{Geometry, MapTable};
use faying::linalg::Vector;
use faying_files::vtu::Part;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// An exact multiplier at a point of the side.
pub type ExactCurve<'a> = &'a dyn Fn(&Vector<2>) -> f64;

/// Content of the picture.
#[derive(Clone, Copy)]
pub struct SidePlot<'a> {
    /// Heading.
    pub title: &'a str,
    /// Contact: the pressure -lambda with its active functions; else the components of lambda.
    pub contact: bool,
    /// The multiplier functions.
    pub rows: &'a [InterfaceRow],
    /// The exact multiplier lambda, drawn dashed.
    pub exact: Option<ExactCurve<'a>>,
    /// Units of length and of force per area; empty: none is shown.
    pub units: [&'a str; 2],
}

impl std::fmt::Debug for SidePlot<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SidePlot").field("title", &self.title).field("contact", &self.contact).finish_non_exhaustive()
    }
}

/// Pieces an element is drawn with.
const PIECES: usize = 16;

/// Points of a curve, one run per element: multipliers may jump.
type Runs = Vec<Vec<(f64, f64)>>;

/// The picture of the field `lambda` of `part`, over the arc length of the side in the order of its elements.
///
/// # Errors
/// [`PlotError`] where the part has no field `lambda` or no elements.
pub fn side(plot: &SidePlot<'_>, part: &Part<'_, 1, 2>) -> Result<String, PlotError> {
    let missing = || PlotError::NoField { part: part.name.clone(), field: "lambda".to_owned(), component: 0 };
    let field = part.fields.iter().find(|f| f.name == "lambda").ok_or_else(missing)?;
    let sign = if plot.contact { -1.0 } else { 1.0 };
    let xi: Vec<Vector<1>> = (0..=PIECES).map(|i| Vector::<1>::new(i as f64 / PIECES as f64)).collect();
    let mut curves: Vec<Runs> = vec![Vec::new(); field.components];
    let mut exact: Vec<(f64, f64)> = Vec::new();
    let mut from = 0.0;
    for e in 0..part.space.num_elements() {
        let s = arc_lengths(&*part.space, e, &xi, from);
        from = s.last().copied().unwrap_or(from);
        let values = (field.sample)(e, &xi);
        for (c, runs) in curves.iter_mut().enumerate() {
            runs.push(
                (0..xi.len())
                    .map(|q| (s[q], sign * values.get(q * field.components + c).copied().unwrap_or(f64::NAN)))
                    .filter(|p| p.1.is_finite())
                    .collect(),
            );
        }
        if let Some(lambda) = plot.exact {
            let mut table = MapTable::new();
            part.space.map(e, &xi, Order::Values, &mut table);
            exact.extend(table.x.iter().zip(&s).map(|(x, s)| (*s, sign * lambda(x))).filter(|p| p.1.is_finite()));
        }
    }
    if !(from.is_finite() && from > 0.0) {
        return Err(PlotError::Empty(plot.title.to_owned()));
    }
    let window = window(plot, from, &curves);
    let within = |p: &(f64, f64)| p.0 >= window[0] && p.0 <= window[1];
    let curves: Vec<Runs> =
        curves.iter().map(|runs| runs.iter().map(|run| run.iter().copied().filter(within).collect()).collect()).collect();
    exact.retain(within);
    draw(plot, from, window, &curves, &exact)
}

/// The stretch of arc length to show: all of it, or the surroundings of a contact zone that is small against the side.
fn window(plot: &SidePlot<'_>, length: f64, curves: &[Runs]) -> [f64; 2] {
    let greatest = curves.iter().flatten().flatten().map(|p| p.1).fold(0.0, f64::max);
    let pressed = curves.iter().flatten().flatten().filter(|p| p.1 > 1e-6 * greatest);
    let (a, b) = pressed.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.0), b.max(p.0)));
    let zone = b - a;
    if !(plot.contact && zone > 0.0 && zone < 0.25 * length) {
        return [0.0, length];
    }
    [(a - 0.6 * zone).max(0.0), (b + 0.6 * zone).min(length)]
}

/// Arc length up to the points `xi` of an element, by three Gauss points between neighbours.
fn arc_lengths(curve: &dyn faying::space::Space<1, 2>, element: usize, xi: &[Vector<1>], from: f64) -> Vec<f64> {
    let (node, outer, inner) = (0.6f64.sqrt(), 5.0 / 18.0, 4.0 / 9.0);
    let mut s = vec![from];
    let mut table = MapTable::new();
    for pair in xi.windows(2) {
        let (a, b) = (pair[0][0], pair[1][0]);
        let at = |t: f64| Vector::<1>::new(0.5 * (a + b) + 0.5 * t * (b - a));
        curve.map(element, &[at(-node), at(0.0), at(node)], Order::Gradients, &mut table);
        let speed = |q: usize| table.jacobian[q].norm();
        s.push(s[s.len() - 1] + (b - a) * (outer * (speed(0) + speed(2)) + inner * speed(1)));
    }
    s
}

fn draw(plot: &SidePlot<'_>, length: f64, [s0, s1]: [f64; 2], curves: &[Runs], exact: &[(f64, f64)]) -> Result<String, PlotError> {
    let values = || curves.iter().flatten().flatten().chain(exact).map(|p| p.1);
    let (lo, hi) = values().fold((0.0f64, 0.0f64), |(lo, hi), v| (lo.min(v), hi.max(v)));
    let span = if hi - lo > 0.0 { hi - lo } else { 1.0 };
    let (y0, y1) = (lo - 0.08 * span, hi + 0.08 * span);
    let (left, w, h) = (78.0, 700.0, 330.0);
    let width = left + w + 30.0;
    let more = taller(plot.title, width - left - 20.0, 17.0);
    let top = 84.0 + more;
    let height = top + h + 52.0;
    let [of_values, of_lengths] = [ticks(y0, y1, 6), ticks(s0, s1, 7)];
    let colors = [BLUE_LINE, RED_LINE, INK];
    let px = |s: f64| units(left + w * (s - s0) / (s1 - s0));
    let py = |v: f64| units(top + h * (y1 - v) / (y1 - y0));
    let pixels = |line: &[(f64, f64)]| line.iter().map(|p| (px(p.0), py(p.1))).collect::<Vec<_>>();
    document(width, height, |root| {
        heading(root, plot.title, [left, 16.0], width - left - 20.0, 17.0)?;
        for (&v, word) in of_values.iter().zip(labels(&of_values, 5)) {
            root.draw(&PathElement::new(vec![(px(s0), py(v)), (px(s1), py(v))], stroke(PALE, 0.8)))?;
            root.draw(&Text::new(word, (px(s0) - units(8.0), py(v)), text(11.5, GREY, HPos::Right, VPos::Center)))?;
        }
        let base = units(top + h);
        for (&s, word) in of_lengths.iter().zip(labels(&of_lengths, 5)) {
            root.draw(&PathElement::new(vec![(px(s), base), (px(s), base + units(4.0))], stroke(GREY, 0.8)))?;
            root.draw(&Text::new(word, (px(s), base + units(8.0)), text(11.5, GREY, HPos::Center, VPos::Top)))?;
        }
        root.draw(&PathElement::new(vec![(px(s0), base), (px(s1), base)], stroke(GREY, 0.8)))?;
        root.draw(&PathElement::new(vec![(px(s0), py(0.0)), (px(s1), py(0.0))], stroke(GREY, 1.0)))?;
        let all = if s1 - s0 < length { format!(" ({} in all)", short(length, 4)) } else { String::new() };
        root.draw(&Text::new(
            format!("arc length along the slave side{}{all}", in_unit(plot.units[0])),
            (px(s1), base + units(28.0)),
            text(12.0, GREY, HPos::Right, VPos::Top),
        ))?;

        if plot.contact {
            for run in curves.iter().flatten().filter(|run| run.len() > 1) {
                let mut area = pixels(run);
                area.extend([(px(run[run.len() - 1].0), py(0.0)), (px(run[0].0), py(0.0))]);
                root.draw(&Polygon::new(area, BLUE_LINE.mix(0.12).filled()))?;
            }
        }
        for (runs, color) in curves.iter().zip(colors) {
            for run in runs.iter().filter(|run| run.len() > 1) {
                root.draw(&PathElement::new(pixels(run), stroke(color, 2.0)))?;
            }
        }
        if exact.len() > 1 {
            root.draw(&DashedPathElement::new(pixels(exact), units(7.0), units(5.0), stroke(RED_LINE, 1.6)))?;
        }
        if plot.contact {
            let within = |row: &InterfaceRow| row.s.filter(|&s| s >= s0 && s <= s1).map(|s| (s, row.active));
            for (s, active) in plot.rows.iter().filter_map(within) {
                root.draw(&mark((px(s), py(0.0)), active))?;
                if !active {
                    root.draw(&Circle::new((px(s), py(0.0)), units(3.2), stroke(GREY, 1.2)))?;
                }
            }
        }
        legend(root, plot, curves.len(), !exact.is_empty(), [left, 50.0 + more], &colors)
    })
}

/// The dot of a multiplier function: filled where active, white where not.
fn mark(at: (i32, i32), active: bool) -> Circle<(i32, i32), i32> {
    if active { Circle::new(at, units(3.6), BLUE_LINE.filled()) } else { Circle::new(at, units(3.2), WHITE.filled()) }
}

fn legend(
    root: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
    plot: &SidePlot<'_>,
    components: usize,
    exact: bool,
    [left, top]: [f64; 2],
    colors: &[RGBColor; 3],
) -> Result<(), PlotError> {
    let mut at = left;
    let middle = units(top + 7.0);
    let mut say = |words: &str, width: f64| -> Result<f64, PlotError> {
        root.draw(&Text::new(words.to_owned(), (units(at + width + 6.0), middle), text(12.0, INK, HPos::Left, VPos::Center)))?;
        let start = at;
        at += width + 6.0 + 6.6 * words.chars().count() as f64 + 22.0;
        Ok(start)
    };
    let names: Vec<&str> = match (plot.contact, components) {
        (true, _) => vec!["pressure"],
        (false, 1) => vec!["lambda"],
        (false, _) => vec!["lambda.x", "lambda.y", "lambda.z"],
    };
    for (name, color) in names.iter().take(components).zip(colors) {
        let x = say(&format!("{name}{}", in_unit(plot.units[1])), 24.0)?;
        root.draw(&PathElement::new(vec![(units(x), middle), (units(x + 24.0), middle)], stroke(*color, 2.0)))?;
    }
    if exact {
        let x = say("exact", 24.0)?;
        root.draw(&DashedPathElement::new(
            vec![(units(x), middle), (units(x + 24.0), middle)],
            units(7.0),
            units(5.0),
            stroke(RED_LINE, 1.6),
        ))?;
    }
    if plot.contact && !plot.rows.is_empty() {
        let active = plot.rows.iter().filter(|row| row.active).count();
        let x = say(&format!("active function ({active} of {})", plot.rows.len()), 8.0)?;
        root.draw(&mark((units(x + 4.0), middle), true))?;
        if active < plot.rows.len() {
            let x = say("open", 8.0)?;
            root.draw(&Circle::new((units(x + 4.0), middle), units(3.2), stroke(GREY, 1.2)))?;
        }
    }
    Ok(())
}
