//! `fields.svg`: bodies with their curved element edges over a colour field, and a detail view of a small peak.

use super::compact::compact;
use super::frame::{axes, bar, outline};
use super::marks::{draw as draw_marks, words as words_of_marks};
use super::obstacles::{draw as draw_obstacles, reached};
use super::sample::{Drawn, boxes, division, divisions, sampled};
use super::simplify::{PIECES, ShadedPolygon, chained, few_lines, joined, straightened};
use super::{FieldPlot, GREY, INK, PlotError, Root, document, heading, stroke, taller, text, units};
use crate::table::short;
use faying::geometry::Bounds;
use faying::linalg::Vector;
use faying_files::vtu::Part;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::collections::BTreeMap;

/// A peak that is smaller than this share of the bodies is shown in detail.
const SMALL: f64 = 0.15;
/// Share of an element's size that it may bulge beyond its box.
const BULGE: f64 = 0.1;
/// Number of colours.
const LEVELS: f64 = 128.0;
/// Width and height of the detail in pixels.
const DETAIL: f64 = 300.0;

/// The picture of all `parts`.
///
/// # Errors
/// [`PlotError`] where a part lacks the field or there is nothing to draw.
pub fn fields(plot: &FieldPlot<'_>, parts: &[Part<'_, 2, 2>]) -> Result<String, PlotError> {
    let around: Vec<Vec<Bounds<2>>> = parts.iter().map(|p| boxes(p, plot.moved)).collect();
    let all = drawn(plot, parts, &divisions(&around))?;
    let points: Vec<Vector<2>> =
        all.iter().flatten().flat_map(|d| d.edges.iter().flat_map(|(line, _)| line)).map(|p| Vector::<2>::from(*p)).collect();
    let finite: Vec<Vector<2>> = points.into_iter().filter(|p| p.iter().all(|x| x.is_finite())).collect();
    let bounds = Bounds::around(&finite).filter(|b| b.diagonal() > 0.0).ok_or_else(|| PlotError::Empty(plot.title.to_owned()))?;
    let shown = reached(plot.obstacles, &finite, bounds);
    let scale = Scale::of(&all, plot.range);
    let detail = match peak(&all, &scale, &bounds) {
        None => None,
        Some(window) => {
            let near = |b: &Bounds<2>| b.inflated(BULGE * b.diagonal()).meets(&window);
            let inside = |b: &Bounds<2>| near(b).then(|| division(b, window.hi[0] - window.lo[0], DETAIL).round() as usize);
            let wanted: Vec<Vec<_>> = around.iter().map(|part| part.iter().map(inside).collect()).collect();
            Some((window, drawn(plot, parts, &wanted)?))
        }
    };
    let detail = detail.map(|(window, close)| (window, fewer(close)));
    draw(plot, &fewer(all), &shown, &scale, detail.as_ref())
}

/// The bodies with fewer pieces, merged after the scale is made of all values.
fn fewer(mut bodies: Vec<Vec<Drawn>>) -> Vec<Drawn> {
    let count = |body: &Vec<Drawn>| body.iter().map(|d| d.pieces.len()).sum::<usize>();
    let total = bodies.iter().map(count).sum::<usize>();
    if total > PIECES {
        // a coarse body beside fine ones keeps its pieces: merged across a hollow side they would reach out of it
        let least = PIECES / (4 * bodies.len());
        for body in &mut bodies {
            let share = PIECES as f64 * count(body) as f64 / total as f64;
            let pieces = body.iter_mut().flat_map(|d| std::mem::take(&mut d.pieces)).collect();
            if let Some(first) = body.first_mut() {
                (first.pieces, first.row) = (joined(pieces, least.max(share as usize)), 1);
            }
        }
    }
    bodies.into_iter().flatten().collect()
}

fn drawn(plot: &FieldPlot<'_>, parts: &[Part<'_, 2, 2>], divisions: &[Vec<Option<usize>>]) -> Result<Vec<Vec<Drawn>>, PlotError> {
    parts.iter().zip(divisions).map(|(part, divisions)| sampled(plot, part, divisions)).collect()
}

/// Values and their colours.
pub(super) struct Scale {
    pub least: f64,
    pub most: f64,
    /// Constant up to rounding: one colour.
    pub uniform: bool,
}

impl Scale {
    fn of(drawn: &[Vec<Drawn>], range: Option<[f64; 2]>) -> Self {
        Self::of_values(drawn.iter().flatten().flat_map(|d| d.pieces.iter().map(|(_, v)| *v)).chain(range.into_iter().flatten()))
    }

    /// From the least to the largest finite value.
    pub fn of_values(values: impl Iterator<Item = f64>) -> Self {
        let (least, most) = values.filter(|v| v.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let (least, most) = if least > most { (0.0, 0.0) } else { (least, most) };
        Self { least, most, uniform: most - least <= 1e-9 * most.abs().max(least.abs()) }
    }

    /// The label and the range of the field in words.
    pub fn words(&self, label: &str) -> String {
        if self.uniform {
            format!("{label}: {} everywhere", short(0.5 * (self.least + self.most), 4))
        } else {
            format!("{label}: from {} to {}", short(self.least, 4), short(self.most, 4))
        }
    }

    /// Number of the colour of a value; `None` for one that is not finite.
    pub fn level(&self, v: f64) -> Option<usize> {
        let share = if self.uniform { 0.5 } else { (v - self.least) / (self.most - self.least) };
        v.is_finite().then(|| ((share * LEVELS) as usize).min(LEVELS as usize - 1))
    }

    pub fn color(&self, v: f64) -> RGBColor {
        let at = |level: usize| ViridisRGB.get_color(level as f64 / (LEVELS - 1.0));
        self.level(v).map_or(RGBColor(190, 190, 190), at)
    }
}

/// A square around all that is above half of the range, where that is a small part of the bodies.
fn peak(drawn: &[Vec<Drawn>], scale: &Scale, bounds: &Bounds<2>) -> Option<Bounds<2>> {
    let high = |v: f64| v - scale.least > 0.5 * (scale.most - scale.least);
    let corners = drawn.iter().flatten().flat_map(|d| &d.pieces).filter(|(_, v)| high(*v)).flat_map(|(corners, _)| corners);
    let around = Bounds::around(&corners.map(|p| Vector::<2>::from(*p)).collect::<Vec<_>>())?;
    let size = (bounds.hi - bounds.lo).amax();
    let extent = (around.hi - around.lo).amax();
    if scale.uniform || !(extent > 0.0 && extent < SMALL * size) {
        return None;
    }
    let half = Vector::<2>::repeat((1.1 * extent).max(1e-4 * size));
    Some(Bounds { lo: around.center() - half, hi: around.center() + half })
}

/// A window of the plane and the frame it fills: left, top, width, height in pixels.
pub(super) struct View {
    pub window: Bounds<2>,
    pub frame: [f64; 4],
}

impl View {
    pub fn per_length(&self) -> f64 {
        self.frame[2] / (self.window.hi[0] - self.window.lo[0])
    }

    pub fn pixel(&self, p: &[f64; 2]) -> (i32, i32) {
        let k = self.per_length();
        (units(self.frame[0] + k * (p[0] - self.window.lo[0])), units(self.frame[1] + k * (self.window.hi[1] - p[1])))
    }
}

fn draw(
    plot: &FieldPlot<'_>,
    all: &[Drawn],
    bounds: &Bounds<2>,
    scale: &Scale,
    detail: Option<&(Bounds<2>, Vec<Drawn>)>,
) -> Result<String, PlotError> {
    let room = if plot.marks.is_empty() && plot.obstacles.is_empty() { 0.03 } else { 0.06 };
    let padded = bounds.inflated(room * (bounds.hi - bounds.lo).amax());
    let extent = padded.hi - padded.lo;
    let per_length = (720.0 / extent[0]).min(560.0 / extent[1]);
    let (left, right, bottom) = (62.0, 132.0, 46.0);
    let (w, h) = ((extent[0] * per_length).max(260.0), (extent[1] * per_length).max(150.0));
    // the frame may be wider or higher than the bodies; the scale is the same in both directions
    let half = Vector::<2>::new(w, h) * (0.5 / per_length);
    let width = left + w + right + if detail.is_some() { left + DETAIL + 8.0 } else { 0.0 };
    let more = taller(plot.title, width - left - 20.0, 17.0);
    let top = 80.0 + more;
    let view = View { window: Bounds { lo: padded.center() - half, hi: padded.center() + half }, frame: [left, top, w, h] };
    let height = top + if detail.is_some() { h.max(DETAIL) } else { h } + bottom;
    let drawn = document(width, height, |root| {
        heading(root, plot.title, [left, 16.0], width - left - 20.0, 17.0)?;
        let words = scale.words(plot.label) + &words_of_marks(plot);
        root.draw(&Text::new(words, (units(left), units(42.0 + more)), text(12.0, GREY, HPos::Left, VPos::Top)))?;
        paint(root, &view, all, scale)?;
        draw_obstacles(root, plot.obstacles, &view, true)?;
        draw_marks(root, plot, &|_| true, &|x| view.pixel(&[x[0], x[1]]))?;
        let ranges = |v: &View| [0, 1].map(|k| [v.window.lo[k], v.window.hi[k]]);
        axes(root, ranges(&view), plot.length, view.frame)?;
        bar(root, [left + w + 26.0, top, 18.0, h], scale.least, scale.most, scale.uniform, &|v| scale.color(v))?;
        let Some((window, close)) = detail else { return Ok(()) };
        let detail = View { window: *window, frame: [left + w + right + left, top, DETAIL, DETAIL] };
        outline(root, [window.lo, window.hi].map(|p| view.pixel(&p.into())), stroke(INK, 1.0))?;
        let words = format!("detail, {} times as large", short(detail.per_length() / per_length, 2));
        // beside the line on the field, which may be longer than the bodies are wide
        let at = (units(detail.frame[0] + DETAIL), units(top - 18.0));
        root.draw(&Text::new(words, at, text(12.0, GREY, HPos::Right, VPos::Top)))?;
        paint(root, &detail, close, scale)?;
        draw_obstacles(root, plot.obstacles, &detail, false)?;
        axes(root, ranges(&detail), plot.length, detail.frame)?;
        outline(root, [window.lo, window.hi].map(|p| detail.pixel(&p.into())), stroke(INK, 1.0))
    });
    drawn.map(|svg| compact(&svg))
}

/// Draws the pieces, then the lines between elements if they are few enough, then the outlines, all clipped to the window.
fn paint(root: &Root<'_, '_>, view: &View, drawn: &[Drawn], scale: &Scale) -> Result<(), PlotError> {
    let by = 0.4 / view.per_length();
    // pieces do not lie over each other but for their seams: those of one colour are drawn together
    let mut colours: BTreeMap<Option<usize>, (RGBColor, Vec<Vec<(i32, i32)>>)> = BTreeMap::new();
    for d in drawn {
        for run in d.pieces.chunks(d.row).flat_map(|row| row.chunk_by(|a, b| scale.level(a.1) == scale.level(b.1))) {
            let inside = clipped(&overlapping(&around_row(run), by), &view.window);
            let mut around: Vec<(i32, i32)> = inside.iter().map(|p| view.pixel(p)).collect();
            around.extend(around.first().copied());
            around = straightened(&around, 1.0);
            around.pop();
            if around.len() > 2 {
                let of_colour = colours.entry(scale.level(run[0].1));
                of_colour.or_insert_with(|| (scale.color(run[0].1), Vec::new())).1.push(around);
            }
        }
    }
    for (color, polygons) in colours.into_values() {
        polygons.into_iter().try_for_each(|points| root.draw(&Polygon::new(points, color.filled())))?;
    }
    let lines = |d: &Drawn, outer: bool| -> Vec<Vec<(i32, i32)>> {
        let of_kind = d.edges.iter().filter(|(_, o)| *o == outer);
        of_kind.flat_map(|(line, _)| runs_inside(line, &view.window)).map(|run| run.iter().map(|p| view.pixel(p)).collect()).collect()
    };
    let trace = |line: &[(i32, i32)], style: ShapeStyle| -> Result<(), PlotError> {
        let line = straightened(line, 1.0);
        // a line shorter than a unit is not drawn
        if line.len() > 2 || line.first() != line.last() {
            root.draw(&PathElement::new(line, style))?;
        }
        Ok(())
    };
    if few_lines(drawn) {
        // lines of elements that are about as wide are one where they follow each other
        let mut alike: BTreeMap<usize, Vec<Vec<(i32, i32)>>> = BTreeMap::new();
        for d in drawn {
            alike.entry(shade(d, view.per_length())).or_default().extend(lines(d, false));
        }
        for (shade, lines) in alike {
            let share = shade as f64 / SHADES;
            let style = stroke(BLACK.mix(0.06 + 0.22 * share), 0.25 + 0.35 * share);
            chained(lines).iter().try_for_each(|line| trace(line, style))?;
        }
    }
    let outlines = chained(drawn.iter().flat_map(|d| lines(d, true)).collect());
    outlines.iter().try_for_each(|line| trace(line, stroke(INK, 1.5)))?;
    Ok(())
}

/// The part of a convex polygon inside a box, one side of the box after the other (Sutherland and Hodgman, CACM 17, 1974).
fn clipped(polygon: &[[f64; 2]], window: &Bounds<2>) -> Vec<[f64; 2]> {
    let mut points = polygon.to_vec();
    if points.iter().all(|p| (0..2).all(|k| p[k] >= window.lo[k] && p[k] <= window.hi[k])) {
        return points;
    }
    for (k, sign, limit) in [(0, 1.0, window.lo[0]), (0, -1.0, -window.hi[0]), (1, 1.0, window.lo[1]), (1, -1.0, -window.hi[1])] {
        let over = |p: &[f64; 2]| sign * p[k] - limit;
        let mut kept = Vec::with_capacity(points.len() + 1);
        for (i, p) in points.iter().enumerate() {
            let before = points[(i + points.len() - 1) % points.len()];
            let (a, b) = (over(&before), over(p));
            if (a < 0.0) != (b < 0.0) {
                let t = a / (a - b);
                kept.push([before[0] + t * (p[0] - before[0]), before[1] + t * (p[1] - before[1])]);
            }
            if b >= 0.0 {
                kept.push(*p);
            }
        }
        points = kept;
    }
    points
}

/// The runs of a line inside a box.
fn runs_inside(line: &[[f64; 2]], window: &Bounds<2>) -> Vec<Vec<[f64; 2]>> {
    let mut runs: Vec<Vec<[f64; 2]>> = Vec::new();
    for pair in line.windows(2) {
        // a segment is a polygon of two corners
        let inside = clipped(pair, window);
        let along = |p: &[f64; 2]| (p[0] - pair[0][0]) * (pair[1][0] - pair[0][0]) + (p[1] - pair[0][1]) * (pair[1][1] - pair[0][1]);
        let order = |p: &&[f64; 2], q: &&[f64; 2]| along(p).total_cmp(&along(q));
        let (Some(&a), Some(&b)) = (inside.iter().min_by(order), inside.iter().max_by(order)) else { continue };
        match runs.last_mut() {
            Some(run) if run.last() == Some(&a) => run.push(b),
            _ => runs.push(vec![a, b]),
        }
    }
    runs
}

/// The polygon with every edge pushed out by `by`, so that neighbours leave no seam; no corner moves by more than three times as much.
pub(super) fn overlapping(corners: &[[f64; 2]], by: f64) -> Vec<[f64; 2]> {
    let n = corners.len();
    let pairs = (0..n).map(|k| (corners[k], corners[(k + 1) % n]));
    let sign = pairs.clone().map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>().signum();
    let normal = |(a, b): ([f64; 2], [f64; 2])| {
        let d = [b[0] - a[0], b[1] - a[1]];
        let length = d[0].hypot(d[1]);
        if length > 0.0 { [sign * d[1] / length, -sign * d[0] / length] } else { [0.0; 2] }
    };
    let normals: Vec<[f64; 2]> = pairs.map(normal).collect();
    (0..n)
        .map(|k| {
            let (a, b) = (normals[(k + n - 1) % n], normals[k]);
            let sum = [a[0] + b[0], a[1] + b[1]];
            // (a + b) / (1 + a . b) has the component 1 along both; its length is 3 where a . b = -7/9, sharper corners move less
            let scale = by / (1.0 + a[0] * b[0] + a[1] * b[1]).max(2.0 / 9.0);
            [corners[k][0] + scale * sum[0], corners[k][1] + scale * sum[1]]
        })
        .collect()
}

/// The outline of quadrilaterals in a row, whose second and third corners are next to the first and fourth of the following one; of one
/// piece of any shape its corners.
fn around_row(pieces: &[ShadedPolygon]) -> Vec<[f64; 2]> {
    let first = &pieces[0].0;
    if pieces.len() == 1 {
        return first.clone();
    }
    let lower = [first[0]].into_iter().chain(pieces.iter().map(|(corners, _)| corners[1]));
    let upper = pieces.iter().rev().map(|(corners, _)| corners[2]).chain([first[3]]);
    lower.chain(upper).collect()
}

/// Number of shades of lines between elements.
const SHADES: f64 = 16.0;

/// Shade of the lines of an element: they fade where it is only a few pixels wide.
fn shade(element: &Drawn, per_length: f64) -> usize {
    let length = |line: &[[f64; 2]]| line.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum::<f64>();
    let width = element.edges.iter().map(|(line, _)| length(line)).fold(f64::INFINITY, f64::min) * per_length;
    ((width / 12.0).clamp(0.0, 1.0) * SHADES).round() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_and_lines_are_cut_at_the_window() {
        let window = Bounds { lo: Vector::<2>::new(0.0, 0.0), hi: Vector::<2>::new(1.0, 1.0) };
        let area = |p: &[[f64; 2]]| {
            (0..p.len()).map(|i| (p[i], p[(i + 1) % p.len()])).map(|(a, b)| 0.5 * (a[0] * b[1] - b[0] * a[1])).sum::<f64>()
        };
        let square = [[0.5, 0.5], [2.0, 0.5], [2.0, 2.0], [0.5, 2.0]];
        assert_eq!(area(&clipped(&square, &window)), 0.25);
        assert!(clipped(&[[2.0, 2.0], [3.0, 2.0], [2.0, 3.0]], &window).is_empty());
        let runs = runs_inside(&[[-1.0, 0.5], [0.5, 0.5], [0.5, 2.0], [0.25, 2.0], [0.25, 0.5]], &window);
        assert_eq!(runs, [vec![[0.0, 0.5], [0.5, 0.5], [0.5, 1.0]], vec![[0.25, 1.0], [0.25, 0.5]]]);
    }
    #[test]
    fn every_edge_is_pushed_out_and_coarse_bodies_keep_their_pieces() {
        // a square with a corner in the middle of its lower edge, both ways round
        let mut square = vec![[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let out = [[-0.1, -0.1], [0.5, -0.1], [1.1, -0.1], [1.1, 1.1], [-0.1, 1.1]];
        let near = |a: &[[f64; 2]], b: &[[f64; 2]]| a.iter().flatten().zip(b.iter().flatten()).all(|(x, y)| (x - y).abs() < 1e-14);
        assert!(near(&overlapping(&square, 0.1), &out));
        square.reverse();
        let back: Vec<_> = out.into_iter().rev().collect();
        assert!(near(&overlapping(&square, 0.1), &back));
        let needle = overlapping(&[[0.0, 0.0], [1.0, -0.001], [1.0, 0.001]], 0.1);
        assert!(needle[0][0] < 0.0 && needle.iter().flatten().all(|x| x.abs() < 1.3), "{needle:?}");
        let body = |n: usize| -> Vec<Drawn> {
            let at = |k: usize| k as f64 / n as f64;
            let piece = |k: usize| vec![[at(k), 0.0], [at(k + 1), 0.0], [at(k + 1), 1.0], [at(k), 1.0]];
            (0..n).map(|k| Drawn { pieces: vec![(piece(k), 0.0)], row: 1, edges: Vec::new() }).collect()
        };
        let few = fewer(vec![body(3 * PIECES), body(100)]);
        let counts: Vec<usize> = few.iter().map(|d| d.pieces.len()).filter(|n| *n > 0).collect();
        assert_eq!(counts[1], 100);
        assert!(counts[0] <= PIECES && counts[0] > 9 * PIECES / 10, "{counts:?}");
    }
}
