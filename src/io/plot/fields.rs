//! `fields.svg`: bodies with their curved element edges over a colour field.

use super::{FINE, GREY, INK, PALE, PlotError, document, shortened, stroke, text, ticks, units};
use crate::basis::{Cell, Elements, Order};
use crate::geometry::{Geometry, MapTable};
use crate::io::table::short;
use crate::io::vtu::Part;
use crate::linalg::Vector;
use crate::space::Space;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What the picture shows.
#[derive(Clone, Copy, Debug)]
pub struct FieldPlot<'a> {
    /// Heading.
    pub title: &'a str,
    /// What the colour bar says.
    pub label: &'a str,
    /// Name of a field of every part.
    pub field: &'a str,
    /// Component of it.
    pub component: usize,
}

/// Coloured pieces and edges of one element.
struct Drawn {
    /// Corners and value of every piece.
    pieces: Vec<(Vec<[f64; 2]>, f64)>,
    /// Points along every edge, with whether it is an outer one.
    edges: Vec<(Vec<[f64; 2]>, bool)>,
}

/// Most pieces of a picture; small elements are coloured whole.
const PIECES: f64 = 7000.0;
/// Size of a piece in pixels, where that makes not too many.
const PIECE: f64 = 8.0;
/// Most pieces per direction of an element.
const FINEST: f64 = 24.0;

/// Pieces per direction of every element of every part: by size, within [`PIECES`] in total.
fn divisions(parts: &[Part<'_, 2, 2>]) -> Vec<Vec<usize>> {
    let boxes: Vec<Vec<_>> = parts.iter().map(|p| (0..p.space.num_elements()).map(|e| p.space.bounds(e)).collect()).collect();
    let size = boxes.iter().flatten().copied().reduce(|a, b| a.union(&b)).map_or(1.0, |b| b.diagonal());
    let wanted = |diagonal: f64, scale: f64| (scale * diagonal / size * 900.0 / PIECE).clamp(1.0, FINEST);
    let total: f64 = boxes.iter().flatten().map(|b| wanted(b.diagonal(), 1.0).powi(2)).sum();
    let scale = (PIECES / total).sqrt().min(1.0);
    boxes.iter().map(|part| part.iter().map(|b| wanted(b.diagonal(), scale).round() as usize).collect()).collect()
}

/// The picture of all `parts`.
///
/// # Errors
/// [`PlotError`] where a part lacks the field or there is nothing to draw.
pub fn fields(plot: &FieldPlot<'_>, parts: &[Part<'_, 2, 2>]) -> Result<String, PlotError> {
    let mut drawn = Vec::new();
    for (part, divisions) in parts.iter().zip(divisions(parts)) {
        drawn.extend(part_drawn(plot, part, &divisions)?);
    }
    let points = || drawn.iter().flat_map(|d| d.edges.iter().flat_map(|(p, _)| p)).filter(|p| p[0].is_finite() && p[1].is_finite());
    let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in points() {
        for k in 0..2 {
            lo[k] = lo[k].min(p[k]);
            hi[k] = hi[k].max(p[k]);
        }
    }
    let size = (hi[0] - lo[0]).max(hi[1] - lo[1]);
    if !(size.is_finite() && size > 0.0) {
        return Err(PlotError::Empty(plot.title.to_owned()));
    }
    draw(plot, &drawn, lo, hi, size)
}

fn part_drawn(plot: &FieldPlot<'_>, part: &Part<'_, 2, 2>, divisions: &[usize]) -> Result<Vec<Drawn>, PlotError> {
    let field = part.fields.iter().find(|f| f.name == plot.field && plot.component < f.components);
    let field =
        field.ok_or_else(|| PlotError::NoField { part: part.name.clone(), field: plot.field.to_owned(), component: plot.component })?;
    let outer = outer_edges(&*part.space);
    Ok((0..part.space.num_elements())
        .into_par_iter()
        .map(|e| {
            let m = divisions[e];
            let curved = if m == 1 { 4 } else { m.max(8) };
            let simplex = part.space.cell(e) == Cell::Simplex;
            let (cells, middles) = pieces(simplex, m);
            let values = (field.sample)(e, &middles);
            let corners: Vec<Vector<2>> = cells.iter().flatten().map(|c| Vector::<2>::new(c[0], c[1])).collect();
            let mut table = MapTable::new();
            part.space.map(e, &corners, Order::Values, &mut table);
            let mut at = table.x.iter().map(|x| [x[0], x[1]]);
            let pieces = cells
                .iter()
                .enumerate()
                .map(|(k, c)| {
                    (at.by_ref().take(c.len()).collect(), values.get(k * field.components + plot.component).copied().unwrap_or(f64::NAN))
                })
                .collect();
            let edges = element_edges(simplex)
                .iter()
                .enumerate()
                .map(|(k, [a, b])| {
                    let line: Vec<Vector<2>> =
                        (0..=curved).map(|i| Vector::<2>::from(*a).lerp(&Vector::<2>::from(*b), i as f64 / curved as f64)).collect();
                    part.space.map(e, &line, Order::Values, &mut table);
                    (table.x.iter().map(|x| [x[0], x[1]]).collect(), outer.get(&(e, k)).copied().unwrap_or(false))
                })
                .collect();
            Drawn { pieces, edges }
        })
        .collect())
}

/// Edges of the cell as local end points.
fn element_edges(simplex: bool) -> &'static [[[f64; 2]; 2]] {
    if simplex {
        &[[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, 1.0]], [[0.0, 1.0], [0.0, 0.0]]]
    } else {
        &[[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 1.0]], [[1.0, 1.0], [0.0, 1.0]], [[0.0, 1.0], [0.0, 0.0]]]
    }
}

/// Whether edge k of element e belongs to no other element; edges of elements without corner ids are left out.
fn outer_edges(space: &dyn Space<2, 2>) -> BTreeMap<(usize, usize), bool> {
    let mut owners: BTreeMap<[usize; 2], Vec<(usize, usize)>> = BTreeMap::new();
    let mut ids = Vec::new();
    for e in 0..space.num_elements() {
        space.corners(e, &mut ids);
        let ends: &[[usize; 2]] = match (space.cell(e), ids.len()) {
            (Cell::Simplex, 3) => &[[0, 1], [1, 2], [2, 0]],
            (Cell::Tensor, 4) => &[[0, 1], [1, 3], [3, 2], [2, 0]],
            _ => &[],
        };
        for (k, [a, b]) in ends.iter().enumerate() {
            let key = [ids[*a].min(ids[*b]), ids[*a].max(ids[*b])];
            owners.entry(key).or_default().push((e, k));
        }
    }
    owners.values().flat_map(|who| who.iter().map(|at| (*at, who.len() == 1))).collect()
}

/// Local corners of the pieces of a cell and a point inside each.
///
/// Each piece reaches a little over its neighbours: later ones paint over it, and no seam shows between them.
fn pieces(simplex: bool, m: usize) -> (Vec<Vec<[f64; 2]>>, Vec<Vector<2>>) {
    let at = |i: usize, j: usize| Vector::<2>::new(i as f64 / m as f64, j as f64 / m as f64);
    let mut cells: Vec<Vec<Vector<2>>> = Vec::new();
    for j in 0..m {
        for i in 0..m {
            if !simplex {
                cells.push(vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            } else if i + j < m {
                cells.push(vec![at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < m {
                    cells.push(vec![at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    let middles: Vec<Vector<2>> = cells.iter().map(|c| c.iter().sum::<Vector<2>>() / c.len() as f64).collect();
    let grown = |p: &Vector<2>, middle: &Vector<2>| {
        let mut p = (middle + (p - middle) * 1.3).map(|t| t.clamp(0.0, 1.0));
        if simplex && p.sum() > 1.0 {
            p /= p.sum();
        }
        [p[0], p[1]]
    };
    let cells = cells.iter().zip(&middles).map(|(c, middle)| c.iter().map(|p| grown(p, middle)).collect()).collect();
    (cells, middles)
}

fn draw(plot: &FieldPlot<'_>, drawn: &[Drawn], lo: [f64; 2], hi: [f64; 2], size: f64) -> Result<String, PlotError> {
    let values = drawn.iter().flat_map(|d| d.pieces.iter().map(|(_, v)| *v)).filter(|v| v.is_finite());
    let (mut least, mut most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if least > most {
        (least, most) = (0.0, 0.0);
    }
    // a constant field up to rounding has one colour
    let uniform = most - least <= 1e-9 * most.abs().max(least.abs());
    let color = |v: f64| match v.is_finite() {
        false => RGBColor(190, 190, 190),
        true if uniform => ViridisRGB.get_color(0.5),
        true => ViridisRGB.get_color((v - least) / (most - least)),
    };

    let pad = 0.03 * size;
    let (x0, x1, y0, y1) = (lo[0] - pad, hi[0] + pad, lo[1] - pad, hi[1] + pad);
    let per_length = (720.0 / (x1 - x0)).min(560.0 / (y1 - y0));
    let (plot_w, plot_h) = ((x1 - x0) * per_length, (y1 - y0) * per_length);
    let (left, top, right, bottom) = (62.0, 80.0, 132.0, 46.0);
    let frame_h = plot_h.max(150.0);
    let frame_w = plot_w.max(260.0);
    let (width, height) = (left + frame_w + right, top + frame_h + bottom);
    // keeps the aspect where the picture is wider or higher than the bodies
    let (grow_x, grow_y) = (0.5 * (frame_w - plot_w) / per_length, 0.5 * (frame_h - plot_h) / per_length);

    document(width, height, |root| {
        root.draw(&Text::new(
            shortened(plot.title, width - left - 20.0, 17.0),
            (units(left), units(16.0)),
            text(17.0, INK, HPos::Left, VPos::Top),
        ))?;
        let range = if uniform {
            format!("{}: {} everywhere", plot.label, short(0.5 * (least + most), 4))
        } else {
            format!("{}: from {} to {}", plot.label, short(least, 4), short(most, 4))
        };
        root.draw(&Text::new(range, (units(left), units(42.0)), text(12.0, GREY, HPos::Left, VPos::Top)))?;

        let area = root.margin(units(top), units(bottom), 0, units(right));
        let mut chart = ChartBuilder::on(&area)
            .set_label_area_size(LabelAreaPosition::Left, units(left))
            .build_cartesian_2d(x0 - grow_x..x1 + grow_x, y0 - grow_y..y1 + grow_y)?;
        for d in drawn {
            chart.draw_series(
                d.pieces.iter().map(|(corners, v)| Polygon::new(overlapping(corners, 0.4 / per_length), color(*v).filled())),
            )?;
        }
        for outer in [false, true] {
            for d in drawn {
                let style = if outer { stroke(INK, 1.5) } else { inner_edges(d, per_length) };
                let lines = d.edges.iter().filter(|(_, o)| *o == outer);
                chart.draw_series(lines.map(|(line, _)| PathElement::new(line.iter().map(|p| (p[0], p[1])).collect::<Vec<_>>(), style)))?;
            }
        }

        axes(root, [x0 - grow_x, x1 + grow_x], [y0 - grow_y, y1 + grow_y], [left, top, frame_w, frame_h])?;
        bar(root, [left + frame_w + 26.0, top, 18.0, frame_h], least, most, uniform, &color)
    })
}

/// The polygon pushed out by about `by` along its edges, so that neighbours leave no seam.
fn overlapping(corners: &[[f64; 2]], by: f64) -> Vec<(f64, f64)> {
    let n = corners.len();
    let unit = |from: [f64; 2], to: [f64; 2]| {
        let d = [to[0] - from[0], to[1] - from[1]];
        let length = d[0].hypot(d[1]);
        if length > 0.0 { [d[0] / length, d[1] / length] } else { [0.0; 2] }
    };
    (0..n)
        .map(|k| {
            let (a, b) = (unit(corners[(k + n - 1) % n], corners[k]), unit(corners[(k + 1) % n], corners[k]));
            (corners[k][0] + by * (a[0] + b[0]), corners[k][1] + by * (a[1] + b[1]))
        })
        .collect()
}

/// Lines between elements fade where the elements are only a few pixels wide.
fn inner_edges(element: &Drawn, per_length: f64) -> ShapeStyle {
    let length = |line: &[[f64; 2]]| line.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum::<f64>();
    let width = element.edges.iter().map(|(line, _)| length(line)).fold(f64::INFINITY, f64::min) * per_length;
    let share = (width / 12.0).clamp(0.0, 1.0);
    stroke(BLACK.mix(0.06 + 0.22 * share), 0.25 + 0.35 * share)
}

type Root<'a, 'b> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn axes(root: &Root<'_, '_>, x: [f64; 2], y: [f64; 2], [left, top, w, h]: [f64; 4]) -> Result<(), PlotError> {
    let line = stroke(PALE, 1.0);
    let place = |v: f64, [a, b]: [f64; 2], from: f64, length: f64| units(from + length * (v - a) / (b - a));
    let (base, corner) = (units(top + h), units(left));
    root.draw(&PathElement::new(vec![(corner, units(top)), (corner, base), (units(left + w), base)], line))?;
    for v in ticks(x[0], x[1], (w / 110.0).ceil() as usize) {
        let at = place(v, x, left, w);
        root.draw(&PathElement::new(vec![(at, base), (at, base + units(4.0))], line))?;
        root.draw(&Text::new(short(v, 5), (at, base + units(8.0)), text(11.5, GREY, HPos::Center, VPos::Top)))?;
    }
    for v in ticks(y[0], y[1], (h / 90.0).ceil() as usize) {
        let at = units(top + h) - (place(v, y, 0.0, h));
        root.draw(&PathElement::new(vec![(corner - units(4.0), at), (corner, at)], line))?;
        root.draw(&Text::new(short(v, 5), (corner - units(8.0), at), text(11.5, GREY, HPos::Right, VPos::Center)))?;
    }
    root.draw(&Text::new("x".to_owned(), (units(left + w), base + units(24.0)), text(11.5, GREY, HPos::Right, VPos::Top)))?;
    root.draw(&Text::new("y".to_owned(), (corner - units(8.0), units(top - 18.0)), text(11.5, GREY, HPos::Right, VPos::Top)))?;
    Ok(())
}

fn bar(
    root: &Root<'_, '_>,
    [left, top, w, h]: [f64; 4],
    least: f64,
    most: f64,
    uniform: bool,
    color: &dyn Fn(f64) -> RGBColor,
) -> Result<(), PlotError> {
    let steps = 160;
    let value = |k: f64| least + (most - least) * k / f64::from(steps);
    for k in 0..steps {
        let level = |k: i32| units(top + h * (1.0 - f64::from(k) / f64::from(steps)));
        let overlap = if k + 1 < steps { units(0.5) } else { 0 };
        root.draw(&Rectangle::new(
            [(units(left), level(k + 1) - overlap), (units(left + w), level(k))],
            color(value(f64::from(k) + 0.5)).filled(),
        ))?;
    }
    root.draw(&Rectangle::new([(units(left), units(top)), (units(left + w), units(top + h))], stroke(GREY, 0.8)))?;
    let marks = if uniform { vec![0.5 * (least + most)] } else { ticks(least, most, ((h / 60.0) as usize).clamp(3, 8)) };
    for v in marks {
        let share = if uniform { 0.5 } else { (v - least) / (most - least) };
        let at = units(top) + (h * (1.0 - share) * FINE).round() as i32;
        root.draw(&PathElement::new(vec![(units(left + w), at), (units(left + w + 4.0), at)], stroke(GREY, 0.8)))?;
        root.draw(&Text::new(short(v, 4), (units(left + w + 8.0), at), text(11.5, INK, HPos::Left, VPos::Center)))?;
    }
    Ok(())
}
