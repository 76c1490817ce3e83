//! `interface_NAME.svg`: the multiplier along its side, with the functions that are active.

use super::{BLUE_LINE, GREY, INK, PALE, PlotError, RED_LINE, document, heading, in_unit, labels, stroke, taller, text, ticks, units};
use crate::table::{InterfaceRow, short};
use faying::basis::{Elements, Order};
use faying::geometry::MapTable;
use faying::linalg::Vector;
use faying_files::vtu::Part;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// An exact multiplier at local points of an element, components point by point.
pub type ExactLambda<'a> = &'a dyn Fn(usize, &[Vector<1>]) -> Vec<f64>;

/// A slave side.
#[derive(Clone, Copy)]
pub struct SlaveCurve<'a> {
    /// Its name, shown where there are several.
    pub label: &'a str,
    /// The curve with the fields `lambda` and, where that has two components, `normal`.
    pub part: &'a Part<'a, 1, 2>,
    /// The multiplier functions.
    pub rows: &'a [InterfaceRow],
    /// The exact multiplier lambda, drawn dashed.
    pub exact: Option<ExactLambda<'a>>,
}

impl std::fmt::Debug for SlaveCurve<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SlaveCurve").field("label", &self.label).field("part", &self.part).finish_non_exhaustive()
    }
}

/// Content of the picture.
#[derive(Clone, Copy, Debug)]
pub struct SidePlot<'a> {
    /// Heading.
    pub title: &'a str,
    /// Contact: the pressure -lambda with its active functions; else lambda, in elasticity its parts along the normal of the master
    /// (tension is positive) and across it.
    pub contact: bool,
    /// Slave sides, drawn one behind the other.
    pub sides: &'a [SlaveCurve<'a>],
    /// Units of length and of force per area; empty: none is shown.
    pub units: [&'a str; 2],
}

/// Pieces an element is drawn with.
const PIECES: usize = 16;

/// Points of a curve, one run per element: multipliers may jump.
type Runs = Vec<Vec<(f64, f64)>>;

/// Curves over the arc length of all sides.
#[derive(Default)]
struct Curves {
    /// Arc length at which each side begins, and all of it.
    begins: Vec<f64>,
    length: f64,
    /// Per number that is shown.
    found: Vec<Runs>,
    exact: Vec<Runs>,
}

/// The numbers that are shown of lambda: the pressure, lambda itself, or its parts along the normal and along that turned by 90 degrees.
fn shown(contact: bool, lambda: &[f64], normal: &[f64]) -> Vec<f64> {
    match (lambda, normal) {
        ([x, y], [n, m]) => vec![x * n + y * m, y * n - x * m],
        _ => lambda.iter().map(|l| if contact { 0.0 - l } else { *l }).collect(),
    }
}

impl Curves {
    /// Appends a side.
    ///
    /// # Errors
    /// [`PlotError`] where the part lacks a field.
    fn add(&mut self, contact: bool, side: &SlaveCurve<'_>) -> Result<(), PlotError> {
        let part = side.part;
        let field = |name: &str| {
            let missing = || PlotError::NoField { part: part.name.clone(), field: name.to_owned(), component: 0 };
            part.fields.iter().find(|f| f.name == name).ok_or_else(missing)
        };
        let lambda = field("lambda")?;
        let components = lambda.components;
        let normal = if components == 2 { Some(field("normal")?) } else { None };
        let xi: Vec<Vector<1>> = (0..=PIECES).map(|i| Vector::<1>::new(i as f64 / PIECES as f64)).collect();
        self.begins.push(self.length);
        for e in 0..part.space.num_elements() {
            let s = arc_lengths(&*part.space, e, &xi, self.length);
            self.length = s.last().copied().unwrap_or(self.length);
            let normals = normal.map_or_else(Vec::new, |field| (field.sample)(e, &xi));
            let append = |curves: &mut Vec<Runs>, values: &[f64]| {
                curves.resize(curves.len().max(components), Runs::new());
                let at = |q: usize| {
                    let own = values.get(q * components..(q + 1) * components).unwrap_or_default();
                    shown(contact, own, normals.get(2 * q..2 * q + 2).unwrap_or_default())
                };
                let all: Vec<Vec<f64>> = (0..xi.len()).map(at).collect();
                for (c, runs) in curves.iter_mut().enumerate() {
                    let point = |(s, v): (&f64, &Vec<f64>)| Some((*s, *v.get(c)?)).filter(|p| p.1.is_finite());
                    runs.push(s.iter().zip(&all).filter_map(point).collect());
                }
            };
            append(&mut self.found, &(lambda.sample)(e, &xi));
            if let Some(exact) = side.exact {
                append(&mut self.exact, &exact(e, &xi));
            }
        }
        Ok(())
    }

    /// The part of all curves within a stretch of arc length.
    fn within(mut self, [from, to]: [f64; 2]) -> Self {
        for run in self.found.iter_mut().chain(&mut self.exact).flatten() {
            run.retain(|p| p.0 >= from && p.0 <= to);
        }
        self
    }
}

/// The picture of the field `lambda` of slave sides, over the arc length of one after the other in the order of their elements.
///
/// # Errors
/// [`PlotError`] where a part has no field `lambda`, and where there are no elements.
pub fn side(plot: &SidePlot<'_>) -> Result<String, PlotError> {
    let mut curves = Curves::default();
    for side in plot.sides {
        curves.add(plot.contact, side)?;
    }
    if !(curves.length.is_finite() && curves.length > 0.0) {
        return Err(PlotError::Empty(plot.title.to_owned()));
    }
    let window = window(plot, &curves);
    draw(plot, window, &curves.within(window))
}

/// The stretch of arc length to show: all of it, or the surroundings of a contact zone that is small against the side.
fn window(plot: &SidePlot<'_>, curves: &Curves) -> [f64; 2] {
    let (points, length) = (|| curves.found.iter().flatten().flatten(), curves.length);
    let greatest = points().map(|p| p.1).fold(0.0, f64::max);
    let pressed = points().filter(|p| p.1 > 1e-6 * greatest);
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

fn draw(plot: &SidePlot<'_>, [s0, s1]: [f64; 2], curves: &Curves) -> Result<String, PlotError> {
    let (length, known) = (curves.length, !curves.exact.is_empty());
    let values = || curves.found.iter().chain(&curves.exact).flatten().flatten().map(|p| p.1);
    let (lo, hi) = values().fold((0.0f64, 0.0f64), |(lo, hi), v| (lo.min(v), hi.max(v)));
    let span = if hi - lo > 0.0 { hi - lo } else { 1.0 };
    let (y0, y1) = (lo - 0.08 * span, hi + 0.08 * span);
    let (left, w, h) = (78.0, 700.0, 330.0);
    let width = left + w + 30.0;
    let more = taller(plot.title, width - left - 20.0, 17.0);
    let top = 84.0 + more;
    let height = top + h + 52.0;
    let [of_values, of_lengths] = [ticks(y0, y1, 6), ticks(s0, s1, 7)];
    let colors = [BLUE_LINE, RED_LINE];
    // the exact curve of one number differs from it by its colour, too
    let dashed = if curves.exact.len() == 1 { RED_LINE } else { INK };
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
            format!("arc length along the slave {}{}{all}", if plot.sides.len() == 1 { "side" } else { "sides" }, in_unit(plot.units[0])),
            (px(s1), base + units(28.0)),
            text(12.0, GREY, HPos::Right, VPos::Top),
        ))?;

        if plot.contact {
            for run in curves.found.iter().flatten().filter(|run| run.len() > 1) {
                let mut area = pixels(run);
                area.extend([(px(run[run.len() - 1].0), py(0.0)), (px(run[0].0), py(0.0))]);
                root.draw(&Polygon::new(area, BLUE_LINE.mix(0.12).filled()))?;
            }
        }
        for (runs, color) in curves.found.iter().zip(colors) {
            for run in runs.iter().filter(|run| run.len() > 1) {
                root.draw(&PathElement::new(pixels(run), stroke(color, 2.0)))?;
            }
        }
        for runs in &curves.exact {
            // one line per side, whose elements are as many as its runs
            let mut runs = runs.iter();
            for side in plot.sides.iter().filter(|side| side.exact.is_some()) {
                let line: Vec<(f64, f64)> = runs.by_ref().take(side.part.space.num_elements()).flatten().copied().collect();
                if line.len() > 1 {
                    root.draw(&DashedPathElement::new(pixels(&line), units(7.0), units(5.0), stroke(dashed, 1.6)))?;
                }
            }
        }
        if plot.sides.len() > 1 {
            // where sides begin, and their names
            for (from, side) in curves.begins.iter().zip(plot.sides).filter(|(from, _)| (s0..s1).contains(*from)) {
                let (x, y) = (px(*from), units(top));
                root.draw(&PathElement::new(vec![(x, y), (x, base)], stroke(GREY, 1.0)))?;
                root.draw(&Text::new(side.label.to_owned(), (x + units(5.0), y), text(11.5, GREY, HPos::Left, VPos::Top)))?;
            }
        }
        if plot.contact {
            let rows = plot.sides.iter().zip(&curves.begins).flat_map(|(side, from)| side.rows.iter().map(move |row| (row, *from)));
            let within = |(row, from): (&InterfaceRow, f64)| row.s.map(|s| (s + from, row.active)).filter(|p| p.0 >= s0 && p.0 <= s1);
            for (s, active) in rows.filter_map(within) {
                root.draw(&mark((px(s), py(0.0)), active))?;
                if !active {
                    root.draw(&Circle::new((px(s), py(0.0)), units(3.2), stroke(GREY, 1.2)))?;
                }
            }
        }
        legend(root, plot, curves.found.len(), known.then_some(dashed), [left, 50.0 + more], colors)
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
    exact: Option<RGBColor>,
    [left, top]: [f64; 2],
    colors: [RGBColor; 2],
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
        (false, _) => vec!["lambda: normal part (tension positive)", "tangential part"],
    };
    for (name, color) in names.iter().take(components).zip(colors) {
        let x = say(&format!("{name}{}", in_unit(plot.units[1])), 24.0)?;
        root.draw(&PathElement::new(vec![(units(x), middle), (units(x + 24.0), middle)], stroke(color, 2.0)))?;
    }
    if let Some(color) = exact {
        let x = say("exact", 24.0)?;
        root.draw(&DashedPathElement::new(
            vec![(units(x), middle), (units(x + 24.0), middle)],
            units(7.0),
            units(5.0),
            stroke(color, 1.6),
        ))?;
    }
    let rows = || plot.sides.iter().flat_map(|side| side.rows);
    let (active, all) = (rows().filter(|row| row.active).count(), rows().count());
    if plot.contact && all > 0 {
        let x = say(&format!("active function ({active} of {all})"), 8.0)?;
        root.draw(&mark((units(x + 4.0), middle), true))?;
        if active < all {
            let x = say("open", 8.0)?;
            root.draw(&Circle::new((units(x + 4.0), middle), units(3.2), stroke(GREY, 1.2)))?;
        }
    }
    Ok(())
}
