//! Facets of a surface: its elements, cut where their normals turn much, collapsed ones charted as triangles.
//!
//! An element whose normals turn by more than 60 degrees along a direction is cut into equal parts in its own coordinates, and with it
//! those beside it across a kink (`parts.rs`). A part with a side of zero length (its *pole*) has the coordinates of a triangle, with the
//! pole at (0, 1):
//!
//! ```text
//! p = u (1 - v),  q = v,     x_p = x_u / (1 - v),   x_q = x_v + x_u u / (1 - v)
//! ```
//!
//! in which the map is regular in every direction from the pole, as it is not in (u, v).

use super::biquadratic::Biquadratic;
use super::parts::{PartCounts, counts, cut, evened};
use super::pole::{BESIDE_POLE, beside, from_pole, from_pole_second};
use super::polygon::Polygon;
use crate::basis::{Cell, Order};
use crate::coupling::CouplingError;
use crate::geometry::{Bounds, Geometry, MapTable, cross, unit_normal};
use crate::linalg::{Matrix, Vector, inverse};
use crate::parallel;
use std::ops::Range;

/// Elements handed to one task at a time.
const ELEMENTS_PER_TASK: usize = 256;
/// A side shorter than this share of the longest one is a point.
const COLLAPSED: f64 = 1e-12;
/// Rounding errors of the length of a side that is a point, in units of the last place of its coordinates.
const ROUNDINGS: f64 = 64.0;
/// Local coordinates outside of a facet that are rounding.
const SAME_PLACE: f64 = 1e-9;
/// Deviation from the linear map, in local coordinates, that is rounding.
const AFFINE: f64 = 2e-14;

/// Points along a side of the grid on which a facet is measured, and of an element known to be affine.
const GRID: [usize; 2] = [5, 2];

/// A facet: the cell it has, and its place in the element.
#[derive(Clone, Debug)]
pub(super) struct Facet {
    pub element: usize,
    pub polygon: Polygon,
    /// Whether the last corner of the triangle is a pole.
    pub pole: bool,
    /// Element coordinates = origin + axes (u, v).
    origin: Vector<2>,
    axes: Matrix<2, 2>,
    /// Whether it is its whole element, in its coordinates.
    whole: bool,
    /// Whether its map is affine.
    pub affine: bool,
    /// Its map, where that is such a polynomial and not affine.
    form: Option<Box<Biquadratic>>,
    /// Largest deviation of its linearised map at the centre, in local coordinates.
    pub bend: f64,
    /// Position and Jacobian at the centre, and (JᵀJ)⁻¹ Jᵀ.
    pub x: Vector<3>,
    pub jacobian: Matrix<3, 2>,
    pub back: Matrix<2, 3>,
    /// Unit normal at the centre, and the largest angle of a normal to it \[rad\].
    pub normal: Vector<3>,
    pub cone: f64,
    /// Shortest side that is no point \[length\].
    pub size: f64,
    /// Rounding error of its positions \[length\]: that of coordinates as large as its longest side and its place.
    pub rounding: f64,
}

/// The facets of all elements, in the order of elements.
#[derive(Debug)]
pub(super) struct Facets<'a> {
    pub map: &'a dyn Geometry<2, 3>,
    pub list: Vec<Facet>,
    /// Element e has the facets `start[e]..start[e + 1]`.
    pub start: Vec<usize>,
}

/// Length up to which a side is a point, of a facet around `x` with sides of these lengths: sums of chords whose ends are rounded.
fn no_length(lengths: &[f64], x: &Vector<3>) -> f64 {
    let longest = lengths.iter().fold(0.0f64, |m, &l| m.max(l));
    (COLLAPSED * longest).max(ROUNDINGS * f64::EPSILON * (x.norm() + longest))
}

impl<'a> Facets<'a> {
    /// Cuts all elements.
    ///
    /// # Errors
    /// [`CouplingError::Missing`] for a cell of which two sides are points.
    pub fn new(map: &'a dyn Geometry<2, 3>) -> Result<Self, CouplingError> {
        let (facets, counts) = Self::cut(map, None)?;
        if counts.iter().flatten().all(|&n| n == 1) {
            return Ok(facets);
        }
        let (whole, _) = Self::cut(map, Some(&vec![[1; 4]; counts.len()]))?;
        let even = evened(&whole, &counts);
        if even == counts { Ok(facets) } else { Self::cut(map, Some(&even)).map(|(facets, _)| facets) }
    }

    /// Cuts all elements into given numbers of parts, or into those that their normals need; with these numbers.
    fn cut(map: &'a dyn Geometry<2, 3>, given: Option<&[PartCounts]>) -> Result<(Self, Vec<PartCounts>), CouplingError> {
        let (mut facets, mut counts) = (Self { map, list: Vec::new(), start: vec![0] }, Vec::new());
        for own in parallel::map_ranges(map.num_elements(), ELEMENTS_PER_TASK, |elements| Self::of_elements(map, elements, given)) {
            let ((own, of_own), first) = (own?, facets.list.len());
            facets.list.extend(own.list);
            facets.start.extend(own.start[1..].iter().map(|k| first + k));
            counts.extend(of_own);
        }
        Ok((facets, counts))
    }

    /// The facets of some elements, their places counted from the first of these.
    fn of_elements(
        map: &'a dyn Geometry<2, 3>,
        elements: Range<usize>,
        given: Option<&[PartCounts]>,
    ) -> Result<(Self, Vec<PartCounts>), CouplingError> {
        let (mut facets, mut numbers) = (Self { map, list: Vec::new(), start: vec![0] }, Vec::new());
        let mut table = MapTable::new();
        for element in elements {
            let whole = Facet::of_element(element, polygon_of(map.cell(element)));
            let grid = GRID[usize::from(map.map_structure().is_affine(element))];
            let lengths = facets.add(whole, grid, &mut table);
            let first = facets.list.len() - 1;
            let own = match given {
                Some(given) => given[element],
                None if facets.list[first].affine => [1; 4],
                None => counts(&facets, first, &mut table),
            };
            numbers.push(own);
            if own == [1; 4] {
                facets.turn_to_pole(&lengths, &mut table)?;
            } else if let Some(whole) = facets.list.pop() {
                for (origin, axes) in cut(whole.polygon, &own) {
                    let lengths = facets.add(Facet { origin, axes, whole: false, ..whole.clone() }, GRID[0], &mut table);
                    facets.turn_to_pole(&lengths, &mut table)?;
                }
            }
            facets.start.push(facets.list.len());
        }
        Ok((facets, numbers))
    }

    /// A side of no length turns the facet that was added last so that its pole is the last corner of a triangle.
    fn turn_to_pole(&mut self, lengths: &[f64], table: &mut MapTable<2, 3>) -> Result<(), CouplingError> {
        let none = self.list.last().map_or(0.0, |facet| no_length(lengths, &facet.x));
        let points: Vec<usize> = (0..lengths.len()).filter(|&k| lengths[k] <= none).collect();
        let Some(mut facet) = (if points.is_empty() { None } else { self.list.pop() }) else { return Ok(()) };
        let polygon = facet.polygon;
        match points[..] {
            [k] if polygon == Polygon::Square => {
                let corner = |j: usize| facet.local(&polygon.corner(j + k + 2));
                (facet.origin, facet.axes) = (corner(0), Matrix::from_columns(&[corner(1) - corner(0), corner(3) - corner(0)]));
                (facet.polygon, facet.pole, facet.whole) = (Polygon::Triangle, true, false);
                self.add(facet, GRID[0], table);
                Ok(())
            }
            _ => Err(CouplingError::Missing(format!("element {} of a surface has no area, or two sides that are points", facet.element))),
        }
    }

    /// Adds a facet and measures it on a grid: its size, its normals, the deviation from a linear map. Returns the lengths of its sides.
    fn add(&mut self, facet: Facet, n: usize, table: &mut MapTable<2, 3>) -> Vec<f64> {
        let (polygon, f) = (facet.polygon, self.list.len());
        // not yet known to be affine: all is evaluated
        self.list.push(Facet { affine: false, form: None, ..facet });
        let mut points = polygon.grid(n);
        points.push(polygon.center());
        let center = points.len() - 1;
        self.at(f, &points, Order::Gradients, table);
        let on_side = |k: usize, i: usize| table.x[polygon.side_index(n, k, i)];
        let length = |k: usize| (1..n).map(|i| (on_side(k, i) - on_side(k, i - 1)).norm()).sum::<f64>();
        let lengths: Vec<f64> = (0..polygon.sides()).map(length).collect();
        let (x, j) = (table.x[center], table.jacobian[center]);
        let none = no_length(&lengths, &x);
        let size = lengths.iter().copied().filter(|&l| l > none).fold(f64::INFINITY, f64::min);
        let normal = unit_normal(&j, 1.0);
        let back = inverse(&j.tr_mul(&j)).unwrap_or_else(Matrix::zeros) * j.transpose();
        let (mut bend, mut cone) = (0.0f64, 0.0f64);
        for (q, at) in points.iter().enumerate() {
            let off = points[center] + back * (table.x[q] - x) - at;
            let away = (table.x[q] - x - j * (at - points[center])).norm() / j.norm();
            bend = bend.max(off.amax()).max(away);
            let other = unit_normal(&table.jacobian[q], 1.0);
            if other.norm() > 0.5 {
                cone = cone.max(angle(&normal, &other));
            }
        }
        let rounding = AFFINE * (1.0 + x.norm() / size);
        let facet = &mut self.list[f];
        (facet.x, facet.jacobian, facet.back) = (x, j, back);
        (facet.normal, facet.cone, facet.bend, facet.size) = (normal, cone, bend, size);
        facet.rounding = f64::EPSILON * lengths.iter().fold(x.norm(), |m, &l| m.max(l));
        facet.affine = !facet.pole && bend <= rounding;
        if !facet.pole && !facet.affine && n == GRID[0] {
            let form = Biquadratic::through(polygon, &x, |i, k| table.x[polygon.grid_index(n, 2 * i, 2 * k)]);
            let is_one = points.iter().enumerate().all(|(q, at)| {
                let (on, slope) = form.at(at);
                let off = on - table.x[q];
                (back * off).amax().max(off.norm() / j.norm()) <= rounding
                    && (slope - table.jacobian[q]).norm() <= 10.0 * rounding * j.norm()
            });
            facet.form = is_one.then(|| Box::new(form));
        }
        lengths
    }

    /// The facets of an element.
    pub fn of(&self, element: usize) -> Range<usize> {
        self.start[element]..self.start[element + 1]
    }

    /// Positions and derivatives in the coordinates of facet `f`.
    pub fn at(&self, f: usize, points: &[Vector<2>], order: Order, table: &mut MapTable<2, 3>) {
        let facet = &self.list[f];
        if facet.form.is_some() || facet.affine && order < Order::Hessians {
            table.reset(points.len(), order);
            for (q, p) in points.iter().enumerate() {
                let (x, jacobian) = facet.known(p).unwrap_or_default();
                table.x[q] = x;
                if order >= Order::Gradients {
                    table.jacobian[q] = jacobian;
                }
                if let (Some(form), true) = (&facet.form, order >= Order::Hessians) {
                    table.hessian[q] = form.hessian(p);
                }
            }
            return;
        }
        if facet.whole {
            return self.map.map(facet.element, points, order, table);
        }
        let local: Vec<Vector<2>> = points.iter().map(|p| facet.local(p)).collect();
        self.map.map(facet.element, &local, order, table);
        if facet.pole && order > Order::Values && points.iter().any(|p| 1.0 - p[1] < BESIDE_POLE) {
            // derivatives from beside the pole, positions as they are
            let x = table.x.clone();
            let beside: Vec<Vector<2>> = points.iter().map(|p| facet.local(&beside(p))).collect();
            self.map.map(facet.element, &beside, order, table);
            table.x.copy_from_slice(&x);
        }
        for (q, p) in points.iter().enumerate() {
            if order >= Order::Hessians {
                let j = table.jacobian[q] * facet.axes;
                for c in 0..3 {
                    let h = facet.axes.transpose() * table.hessian[q][c] * facet.axes;
                    table.hessian[q][c] = if facet.pole { from_pole_second(&beside(p), [j[(c, 0)], j[(c, 1)]], &h) } else { h };
                }
            }
            if order >= Order::Gradients {
                let j = table.jacobian[q] * facet.axes;
                table.jacobian[q] = if facet.pole { from_pole(&beside(p), &j) } else { j };
            }
        }
    }

    /// Position and Jacobian at one point of facet `f`.
    pub fn one(&self, f: usize, p: &Vector<2>, table: &mut MapTable<2, 3>) -> (Vector<3>, Matrix<3, 2>) {
        self.list[f].known(p).unwrap_or_else(|| {
            self.at(f, &[*p], Order::Gradients, table);
            (table.x[0], table.jacobian[0])
        })
    }

    /// The unit normal at the pole of a facet: the product of the tangents of the two sides that end there.
    pub fn normal_at_pole(&self, f: usize, table: &mut MapTable<2, 3>) -> Vector<3> {
        let facet = &self.list[f];
        let ends = [Vector::<2>::new(0.0, 1.0), Vector::<2>::new(1.0, 1.0)].map(|uv| facet.origin + facet.axes * uv);
        self.map.map(facet.element, &ends, Order::Gradients, table);
        let towards = [0, 1].map(|q| (table.jacobian[q] * facet.axes).column(1).into_owned());
        let product = towards[0].cross(&towards[1]);
        product / product.norm().max(f64::MIN_POSITIVE)
    }

    /// Whether facet `f` is its whole element.
    pub fn is_whole(&self, f: usize) -> bool {
        self.list[f].whole
    }

    /// A box around facet `f`, a part of an element: around its samples, inflated by their distance.
    pub fn bounds(&self, f: usize, table: &mut MapTable<2, 3>) -> Bounds<3> {
        self.at(f, &self.list[f].polygon.grid(5), Order::Values, table);
        let bounds = Bounds::around(&table.x).unwrap_or(Bounds { lo: Vector::zeros(), hi: Vector::zeros() });
        bounds.inflated(0.25 * bounds.diagonal())
    }

    /// Facet `f` in four parts of equal area in its coordinates; `None` at a pole.
    pub fn quarters(&self, f: usize) -> Option<Facets<'a>> {
        let facet = &self.list[f];
        if facet.pole {
            return None;
        }
        let mut out = Facets { map: self.map, list: Vec::new(), start: vec![0, 4] };
        let mut table = MapTable::new();
        let corners = [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]].map(Vector::<2>::from);
        for (k, corner) in corners.iter().enumerate() {
            let turned = facet.polygon == Polygon::Triangle && k == 3;
            let axes = facet.axes * if turned { -0.5 } else { 0.5 };
            let origin = facet.origin + facet.axes * corner;
            out.add(Facet { origin, axes, whole: false, ..facet.clone() }, GRID[0], &mut table);
        }
        Some(out)
    }

    /// Measure of a facet \[length^2\], with the rule of its cell.
    pub fn measure(&self, f: usize, rule: &crate::quadrature::Rule<2>, table: &mut MapTable<2, 3>) -> f64 {
        self.at(f, &rule.points, Order::Gradients, table);
        table.jacobian.iter().zip(&rule.weights).map(|(j, w)| cross(j).norm() * w).sum()
    }
}

impl Facet {
    /// A facet that is its whole element, to be measured.
    fn of_element(element: usize, polygon: Polygon) -> Self {
        Self {
            element,
            polygon,
            pole: false,
            origin: Vector::zeros(),
            axes: Matrix::identity(),
            whole: true,
            affine: false,
            form: None,
            bend: 0.0,
            x: Vector::zeros(),
            jacobian: Matrix::zeros(),
            back: Matrix::zeros(),
            normal: Vector::zeros(),
            cone: 0.0,
            size: 0.0,
            rounding: 0.0,
        }
    }

    /// Position and Jacobian at a point, where the map is known by its coefficients.
    fn known(&self, p: &Vector<2>) -> Option<(Vector<3>, Matrix<3, 2>)> {
        match &self.form {
            Some(form) => Some(form.at(p)),
            None => self.affine.then(|| (self.x + self.jacobian * (p - self.polygon.center()), self.jacobian)),
        }
    }

    /// The side of its element that is side `k` of a facet that is all of it.
    pub fn side_of_element(&self, k: usize) -> usize {
        if !self.pole {
            return k;
        }
        let middle = self.origin + self.axes.column(0) * 0.5;
        let first = (0..4).min_by(|&a, &b| Polygon::Square.distance(a, &middle).total_cmp(&Polygon::Square.distance(b, &middle)));
        // the sides before and behind it end at the pole
        (first.unwrap_or(0) + [0, 1, 3][k]) % 4
    }

    /// Whether coordinates of the element are in the facet, to rounding.
    pub fn holds(&self, xi: &Vector<2>) -> bool {
        let polygon = if self.pole { Polygon::Square } else { self.polygon };
        polygon.depth(&self.within(xi)) >= -SAME_PLACE
    }

    /// The coordinates (u, v) that the element has on the part that is the facet.
    fn within(&self, xi: &Vector<2>) -> Vector<2> {
        inverse(&self.axes).map_or_else(Vector::zeros, |inv| inv * (xi - self.origin))
    }

    /// Coordinates of the facet at a point of the element: the inverse of [`Facet::local`].
    pub fn seen(&self, xi: &Vector<2>) -> Vector<2> {
        let uv = self.within(xi);
        if self.pole { Vector::<2>::new(uv[0] * (1.0 - uv[1]), uv[1]) } else { uv }
    }

    /// Coordinates of the element at a point of the facet.
    pub fn local(&self, p: &Vector<2>) -> Vector<2> {
        if self.whole {
            return *p;
        }
        let uv = if self.pole {
            let left = 1.0 - p[1];
            let u = if left.abs() > 1e-300 { p[0] / left } else { 0.5 };
            Vector::<2>::new(u, p[1])
        } else {
            *p
        };
        self.origin + self.axes * uv
    }
}

/// The reference cell as a polygon.
pub(super) fn polygon_of(cell: Cell) -> Polygon {
    match cell {
        Cell::Tensor => Polygon::Square,
        Cell::Simplex => Polygon::Triangle,
    }
}

/// The angle of two unit vectors \[rad\].
pub(super) fn angle(a: &Vector<3>, b: &Vector<3>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}
