//! `fields.svg` of solids: their outer surface, seen from the front, the right and above, coloured, with element edges.
//!
//! Painter's algorithm: pieces of faces that look at the viewer are painted from the farthest to the nearest, element edges
//! together with their pieces. Where pieces are more than a picture needs they are put into a raster of small squares, each
//! coloured as its nearest piece: the size of the file is bounded.

use super::compact::compact;
use super::fields::{Scale, overlapping};
use super::frame::bar;
use super::marks::{draw as draw_marks, words as words_of_marks};
use super::obstacles::SeenFaces;
use super::sample::moved;
use super::{FieldPlot, GREY, INK, PlotError, document, heading, lacks, number, stroke, taller, text, units};
use crate::marks::Mark;
use crate::table::short;
use faying::basis::{Cell, Order};
use faying::geometry::MapTable;
use faying::linalg::Vector;
use faying::space::Space;
use faying_files::vtu::Part;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Direction to the viewer: x to the right, y to the back, z up.
const VIEWER: [f64; 3] = [0.5, -0.75, 0.43];
/// Most pieces of a picture.
const PIECES: usize = 7000;
/// Most pieces per direction of a face.
const FINEST: usize = 12;
/// Side of a square of the raster in pixels.
const SQUARE: f64 = 5.0;
/// Edges lie this share of the size in front of their pieces.
const IN_FRONT: f64 = 2e-3;
/// Width and height of the drawing in pixels.
const FRAME: [f64; 2] = [720.0, 560.0];

/// Screen axes and the direction to the viewer.
pub(super) struct Camera {
    right: Vector<3>,
    up: Vector<3>,
    toward: Vector<3>,
}

impl Camera {
    /// From in front, from the right and from above.
    pub(super) fn new() -> Self {
        Self::from(&Vector::from(VIEWER))
    }

    /// From a direction; z is up, or where that is the direction, y.
    pub(super) fn from(toward: &Vector<3>) -> Self {
        let toward = toward.normalize();
        let level = Vector::<3>::new(0.0, 0.0, 1.0).cross(&toward);
        let right = if level.norm() > 1e-3 { level.normalize() } else { Vector::<3>::new(0.0, 1.0, 0.0).cross(&toward).normalize() };
        Self { right, up: toward.cross(&right), toward }
    }

    /// Whether what has this normal looks at the viewer.
    pub(super) fn faces(&self, normal: &Vector<3>) -> bool {
        self.toward.dot(normal) > 0.0
    }

    /// Right, up, and how near.
    pub(super) fn see(&self, x: &Vector<3>) -> [f64; 3] {
        [self.right.dot(x), self.up.dot(x), self.toward.dot(x)]
    }
}

/// A piece of a face: corners as the camera sees them, the value in its middle, and which of its sides are element edges.
pub(super) struct SolidPiece {
    pub corners: Vec<[f64; 3]>,
    pub value: f64,
    pub edges: Vec<bool>,
}

impl SolidPiece {
    fn depth(&self) -> f64 {
        self.corners.iter().map(|c| c[2]).sum::<f64>() / self.corners.len() as f64
    }

    /// From its farthest to its nearest corner.
    fn extent(&self) -> f64 {
        let (far, near) = self.corners.iter().fold((f64::MAX, f64::MIN), |(a, b), c| (a.min(c[2]), b.max(c[2])));
        near - far
    }
}

/// A face of an element: reference corners, in order around it.
pub(super) struct SolidFace {
    pub element: usize,
    corners: Vec<Vector<3>>,
}

impl SolidFace {
    /// Whether it is a triangle.
    pub fn is_triangle(&self) -> bool {
        self.corners.len() == 3
    }

    /// The point of the face at a point of the unit square or triangle.
    pub fn place(&self, [s, t]: [f64; 2]) -> Vector<3> {
        let c = &self.corners;
        if self.is_triangle() {
            c[0] * (1.0 - s - t) + c[1] * s + c[2] * t
        } else {
            c[0] * (1.0 - s) * (1.0 - t) + c[1] * s * (1.0 - t) + c[2] * s * t + c[3] * (1.0 - s) * t
        }
    }
}

/// Faces of the reference cell as corner numbers, first axis fastest.
fn faces_of(cell: Cell) -> (&'static [&'static [usize]], usize) {
    match cell {
        Cell::Simplex => (&[&[0, 1, 2], &[0, 1, 3], &[0, 2, 3], &[1, 2, 3]], 4),
        Cell::Tensor => (&[&[0, 2, 6, 4], &[1, 3, 7, 5], &[0, 1, 5, 4], &[2, 3, 7, 6], &[0, 1, 3, 2], &[4, 5, 7, 6]], 8),
    }
}

fn corner_of(cell: Cell, number: usize) -> Vector<3> {
    match cell {
        Cell::Simplex => Vector::from_fn(|k, _| f64::from(u8::from(number == k + 1))),
        Cell::Tensor => Vector::from_fn(|k, _| f64::from(u8::from(number >> k & 1 == 1))),
    }
}

/// Faces that belong to one element only; all faces of elements without corner ids.
pub(super) fn outer_faces(space: &dyn Space<3, 3>) -> Vec<SolidFace> {
    let mut owners: BTreeMap<Vec<usize>, (usize, usize, usize)> = BTreeMap::new();
    let mut ids = Vec::new();
    let mut out = Vec::new();
    let face = |e: usize, k: usize| {
        let cell = space.cell(e);
        SolidFace { element: e, corners: faces_of(cell).0[k].iter().map(|&c| corner_of(cell, c)).collect() }
    };
    for e in 0..space.num_elements() {
        space.corners(e, &mut ids);
        let (faces, corners) = faces_of(space.cell(e));
        for (k, numbers) in faces.iter().enumerate() {
            if ids.len() == corners {
                let mut key: Vec<usize> = numbers.iter().map(|&c| ids[c]).collect();
                key.sort_unstable();
                owners.entry(key).and_modify(|o| o.2 += 1).or_insert((e, k, 1));
            } else {
                out.push(face(e, k));
            }
        }
    }
    let mut single: Vec<(usize, usize)> = owners.values().filter(|o| o.2 == 1).map(|o| (o.0, o.1)).collect();
    single.sort_unstable();
    out.extend(single.into_iter().map(|(e, k)| face(e, k)));
    out
}

/// A piece of the unit square or triangle: its corners in order, and which of its sides are sides of the whole.
type Part2 = (Vec<[f64; 2]>, Vec<bool>);

/// The unit square or triangle in `m` pieces per direction.
pub(super) fn divided(simplex: bool, m: usize) -> Vec<Part2> {
    let h = 1.0 / m as f64;
    let mut cells = Vec::new();
    for j in 0..m {
        for i in 0..m {
            let at = |a: usize, b: usize| [(i + a) as f64 * h, (j + b) as f64 * h];
            let (low, left) = (j == 0, i == 0);
            if !simplex {
                cells.push((vec![at(0, 0), at(1, 0), at(1, 1), at(0, 1)], vec![low, i + 1 == m, j + 1 == m, left]));
            } else if i + j < m {
                cells.push((vec![at(0, 0), at(1, 0), at(0, 1)], vec![low, i + j + 1 == m, left]));
                if i + j + 1 < m {
                    cells.push((vec![at(1, 0), at(1, 1), at(0, 1)], vec![false; 3]));
                }
            }
        }
    }
    cells
}

/// The mean of the corners of a piece.
pub(super) fn middle(corners: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / corners.len() as f64)
}

/// Pieces of a face that the camera sees from outside; `m` per direction.
fn pieces(plot: &FieldPlot<'_>, part: &Part<'_, 3, 3>, field: usize, face: &SolidFace, m: usize, camera: &Camera) -> Vec<SolidPiece> {
    let field = &part.fields[field];
    let mut table = MapTable::new();
    let cells = divided(face.is_triangle(), m);
    let middles: Vec<Vector<3>> = cells.iter().map(|(c, _)| face.place(middle(c))).collect();
    let values = (field.sample)(face.element, &middles);
    part.space.map(face.element, &middles, Order::Gradients, &mut table);
    // outward: away from the cell's middle, turned into space by the inverse transpose of the Jacobian
    let own = face.corners.iter().sum::<Vector<3>>() / face.corners.len() as f64;
    let inner = Vector::repeat(if part.space.cell(face.element) == Cell::Simplex { 0.25 } else { 0.5 });
    let tangents = (face.corners[1] - face.corners[0], face.corners[face.corners.len() - 1] - face.corners[0]);
    let seen: Vec<bool> = table
        .jacobian
        .iter()
        .map(|jacobian| {
            let normal = (jacobian * tangents.0).cross(&(jacobian * tangents.1));
            let outward = normal * normal.dot(&(jacobian * (own - inner))).signum();
            camera.faces(&outward)
        })
        .collect();
    let corners: Vec<Vector<3>> = cells.iter().flat_map(|(c, _)| c.iter().map(|p| face.place(*p))).collect();
    part.space.map(face.element, &corners, Order::Values, &mut table);
    moved(part, plot.moved, face.element, &corners, &mut table.x);
    let mut from = 0;
    let mut out = Vec::new();
    for (k, (c, edges)) in cells.into_iter().enumerate() {
        let range = from..from + c.len();
        from += c.len();
        let corners: Vec<[f64; 3]> = table.x[range].iter().map(|x| camera.see(x)).collect();
        if seen[k] && corners.iter().flatten().all(|v| v.is_finite()) {
            let value = number(plot, field.components, &values, k);
            out.push(SolidPiece { corners, value, edges });
        }
    }
    out
}

/// The picture of the outer surfaces of all `parts`.
///
/// # Errors
/// [`PlotError`] where a part lacks the field or there is nothing to draw.
pub fn solids(plot: &FieldPlot<'_>, parts: &[Part<'_, 3, 3>]) -> Result<String, PlotError> {
    let camera = Camera::new();
    let faces: Vec<Vec<SolidFace>> = parts.iter().map(|p| outer_faces(&*p.space)).collect();
    let count = faces.iter().map(Vec::len).sum::<usize>().max(1);
    // about half of the faces look away
    let m = ((2 * PIECES) as f64 / count as f64).sqrt().floor().clamp(1.0, FINEST as f64) as usize;
    let mut all: Vec<SolidPiece> = Vec::new();
    for (part, faces) in parts.iter().zip(&faces) {
        let field = part.fields.iter().position(|f| f.name == plot.field && plot.component.unwrap_or(0) < f.components);
        let field = field.ok_or_else(|| lacks(plot, &part.name))?;
        let made: Vec<Vec<SolidPiece>> = faces.par_iter().map(|f| pieces(plot, part, field, f, m, &camera)).collect();
        all.extend(made.into_iter().flatten());
    }
    if all.is_empty() {
        return Err(PlotError::Empty(plot.title.to_owned()));
    }
    let scale = Scale::of_values(all.iter().map(|p| p.value).chain(plot.range.into_iter().flatten()));
    draw(plot, all, &scale, &camera)
}

/// Pieces per direction of each of `faces` of which all are seen.
pub(super) fn fineness(faces: usize) -> usize {
    (PIECES as f64 / faces.max(1) as f64).sqrt().floor().clamp(1.0, FINEST as f64) as usize
}

/// Draws pieces in any order.
pub(super) fn draw(plot: &FieldPlot<'_>, mut all: Vec<SolidPiece>, scale: &Scale, camera: &Camera) -> Result<String, PlotError> {
    // nearest last; equal depths keep their order
    all.sort_by(|a, b| a.depth().total_cmp(&b.depth()));
    let obstacles = SeenFaces::of(plot.obstacles, camera);
    let corners = || all.iter().flat_map(|p| &p.corners).chain(obstacles.iter().flat_map(SeenFaces::corners));
    let range = |k: usize| corners().fold((f64::MAX, f64::MIN), |(a, b), c| (a.min(c[k]), b.max(c[k])));
    let ((x0, x1), (y0, y1), (z0, z1)) = (range(0), range(1), range(2));
    let size = (x1 - x0).max(y1 - y0).max(z1 - z0).max(f64::MIN_POSITIVE);
    let per_length = (FRAME[0] / (x1 - x0).max(1e-3 * size)).min(FRAME[1] / (y1 - y0).max(1e-3 * size));
    let (left, right, bottom) = (40.0, 132.0, 92.0);
    let (w, h) = (((x1 - x0) * per_length).max(260.0), ((y1 - y0) * per_length).max(150.0));
    let width = left + w + right;
    let more = taller(plot.title, width - left - 20.0, 17.0);
    let top = 80.0 + more;
    let pixel = |c: &[f64; 3]| [left + (c[0] - x0) * per_length, top + (y1 - c[1]) * per_length];
    let drawn = document(width, top + h + bottom, |root| {
        heading(root, plot.title, [left, 16.0], width - left - 20.0, 17.0)?;
        let words = scale.words(plot.label) + &words_of_marks(plot);
        root.draw(&Text::new(words, (units(left), units(42.0 + more)), text(12.0, GREY, HPos::Left, VPos::Top)))?;
        obstacles.iter().try_for_each(|o| o.draw(root, camera, false, &pixel))?;
        let polygon = |p: &SolidPiece| p.corners.iter().map(pixel).map(|p| (units(p[0]), units(p[1]))).collect::<Vec<_>>();
        if all.len() <= 2 * PIECES {
            let mut strokes: Vec<(f64, Vec<(i32, i32)>)> = Vec::new();
            for piece in &all {
                let points = polygon(piece);
                for (k, _) in piece.edges.iter().enumerate().filter(|(_, e)| **e) {
                    let next = (k + 1) % points.len();
                    // in front of both pieces that meet there, which are about as deep
                    let depth = 0.5 * (piece.corners[k][2] + piece.corners[next][2]) + piece.extent() + IN_FRONT * size;
                    if points[k] != points[next] {
                        strokes.push((depth, vec![points[k], points[next]]));
                    }
                }
            }
            strokes.sort_by(|a, b| a.0.total_cmp(&b.0));
            let line = stroke(INK.mix(0.55), 0.7);
            let mut next = strokes.into_iter().peekable();
            for piece in &all {
                while let Some((_, points)) = next.next_if(|s| s.0 < piece.depth()) {
                    root.draw(&PathElement::new(points, line))?;
                }
                let corners: Vec<[f64; 2]> = piece.corners.iter().map(pixel).collect();
                let points: Vec<_> = overlapping(&corners, 0.3).iter().map(|p| (units(p[0]), units(p[1]))).collect();
                root.draw(&Polygon::new(points, scale.color(piece.value).filled()))?;
            }
            for (_, points) in next {
                root.draw(&PathElement::new(points, line))?;
            }
        } else {
            for ([i, j], value) in raster(&all, &pixel) {
                let at = |k: i64| units(k as f64 * SQUARE);
                root.draw(&Rectangle::new([(at(i), at(j)), (at(i + 1), at(j + 1))], scale.color(value).filled()))?;
            }
        }
        obstacles.iter().try_for_each(|o| o.draw(root, camera, true, &pixel))?;
        let seen = |mark: &Mark| camera.faces(&Vector::from(mark.normal));
        draw_marks(root, plot, &seen, &|x| {
            let [a, b] = pixel(&camera.see(&Vector::from(*x)));
            (units(a), units(b))
        })?;
        let zero = [left + 34.0, top + h + 52.0];
        for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
            let [a, b, _] = camera.see(&Vector::from_fn(|i, _| f64::from(u8::from(i == k))));
            let tip = |length: f64| (units(zero[0] + length * a), units(zero[1] - length * b));
            root.draw(&PathElement::new(vec![tip(0.0), tip(30.0)], stroke(GREY, 1.2)))?;
            root.draw(&Text::new(name.to_owned(), tip(40.0), text(11.5, GREY, HPos::Center, VPos::Center)))?;
        }
        let unit = if plot.length.is_empty() { String::new() } else { format!(" {}", plot.length) };
        let words = format!("largest extent in view: {}{unit}", short(size, 3));
        root.draw(&Text::new(words, (units(left + 90.0), units(top + h + 52.0)), text(11.5, GREY, HPos::Left, VPos::Center)))?;
        bar(root, [left + w + 26.0, top, 18.0, h], scale.least, scale.most, scale.uniform, &|v| scale.color(v))
    });
    drawn.map(|svg| compact(&svg))
}

/// Squares of the drawing with the value of the nearest piece whose middle or corners lie in them; pieces come from far to near.
fn raster(all: &[SolidPiece], pixel: &dyn Fn(&[f64; 3]) -> [f64; 2]) -> BTreeMap<[i64; 2], f64> {
    let mut squares = BTreeMap::new();
    for piece in all {
        let points: Vec<[f64; 2]> = piece.corners.iter().map(pixel).collect();
        let range = |k: usize| {
            let (a, b) = points.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[k]), b.max(p[k])));
            (a / SQUARE).floor() as i64..=(b / SQUARE).floor() as i64
        };
        for i in range(0) {
            for j in range(1) {
                squares.insert([i, j], piece.value);
            }
        }
    }
    squares
}
