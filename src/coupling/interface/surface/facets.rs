//! Facets of a surface: its elements, cut where their normals turn much, collapsed ones charted as triangles.
//!
//! An element whose normals turn by more than 60 degrees along a direction is cut into equal parts in its own coordinates. A
//! part with a side of zero length (its *pole*) has the coordinates of a triangle, with the pole at (0, 1):
//!
//! ```text
//! p = u (1 - v),  q = v,     x_p = x_u / (1 - v),   x_q = x_v + x_u u / (1 - v)
//! ```
//!
//! in which the map is regular in every direction from the pole, as it is not in (u, v).

use super::parts::parts;
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
/// Local coordinates outside of a facet that are rounding.
const SAME_PLACE: f64 = 1e-9;
/// Deviation from the linear map, in local coordinates, that is rounding.
const AFFINE: f64 = 2e-14;

/// A facet: the cell it has, and its place in the element.
#[derive(Clone, Copy, Debug)]
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
}

/// The facets of all elements, in the order of elements.
#[derive(Debug)]
pub(super) struct Facets<'a> {
    pub map: &'a dyn Geometry<2, 3>,
    pub list: Vec<Facet>,
    /// Element e has the facets `start[e]..start[e + 1]`.
    pub start: Vec<usize>,
}

impl<'a> Facets<'a> {
    /// Cuts all elements.
    ///
    /// # Errors
    /// [`CouplingError::Missing`] for a cell of which two sides are points.
    pub fn new(map: &'a dyn Geometry<2, 3>) -> Result<Self, CouplingError> {
        let mut facets = Self { map, list: Vec::new(), start: vec![0] };
        for own in parallel::map_ranges(map.num_elements(), ELEMENTS_PER_TASK, |elements| Self::of_elements(map, elements)) {
            let (own, first) = (own?, facets.list.len());
            facets.list.extend(own.list);
            facets.start.extend(own.start[1..].iter().map(|k| first + k));
        }
        Ok(facets)
    }

    /// The facets of some elements, their places counted from the first of these.
    fn of_elements(map: &'a dyn Geometry<2, 3>, elements: Range<usize>) -> Result<Self, CouplingError> {
        let mut facets = Self { map, list: Vec::new(), start: vec![0] };
        let mut table = MapTable::new();
        for element in elements {
            for (origin, axes) in parts(map, element, &mut table) {
                let polygon = polygon_of(map.cell(element));
                let whole = origin == Vector::<2>::zeros() && axes == Matrix::<2, 2>::identity();
                let mut facet = Facet {
                    element,
                    polygon,
                    pole: false,
                    origin,
                    axes,
                    whole,
                    affine: false,
                    bend: 0.0,
                    x: Vector::zeros(),
                    jacobian: Matrix::zeros(),
                    back: Matrix::zeros(),
                    normal: Vector::zeros(),
                    cone: 0.0,
                    size: 0.0,
                };
                facets.find_pole(&mut facet, &mut table)?;
                facets.list.push(facet);
                facets.measure_last(&mut table);
            }
            facets.start.push(facets.list.len());
        }
        Ok(facets)
    }

    /// Lengths of the sides; a side of no length turns the facet so that its pole is the last corner of a triangle.
    fn find_pole(&self, facet: &mut Facet, table: &mut MapTable<2, 3>) -> Result<(), CouplingError> {
        let polygon = facet.polygon;
        let mut lengths = Vec::with_capacity(4);
        for k in 0..polygon.sides() {
            let points: Vec<Vector<2>> = (0..5).map(|i| facet.local(&polygon.on_side(k, f64::from(i) * 0.25))).collect();
            self.map.map(facet.element, &points, Order::Values, table);
            lengths.push(table.x.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>());
        }
        let longest = lengths.iter().fold(0.0f64, |m, &l| m.max(l));
        let is_point = |k: &usize| lengths[*k] <= COLLAPSED * longest;
        let points: Vec<usize> = (0..polygon.sides()).filter(is_point).collect();
        facet.size = lengths.iter().copied().filter(|&l| l > COLLAPSED * longest).fold(f64::INFINITY, f64::min);
        match points[..] {
            [] => Ok(()),
            [k] if polygon == Polygon::Square => {
                let corner = |j: usize| facet.local(&polygon.corner(j + k + 2));
                (facet.origin, facet.axes) = (corner(0), Matrix::from_columns(&[corner(1) - corner(0), corner(3) - corner(0)]));
                (facet.polygon, facet.pole, facet.whole) = (Polygon::Triangle, true, false);
                Ok(())
            }
            _ => Err(CouplingError::Missing(format!("element {} of a surface has no area, or two sides that are points", facet.element))),
        }
    }

    /// Measures normals and the deviation from a linear map of the facet that was added last.
    fn measure_last(&mut self, table: &mut MapTable<2, 3>) {
        let f = self.list.len() - 1;
        // not yet known to be affine: all is evaluated
        self.list[f].affine = false;
        let polygon = self.list[f].polygon;
        let mut points = polygon.grid(5);
        points.push(polygon.center());
        let center = points.len() - 1;
        self.at(f, &points, Order::Gradients, table);
        let (x, j) = (table.x[center], table.jacobian[center]);
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
        let far = x.norm() / self.list[f].size;
        let facet = &mut self.list[f];
        (facet.x, facet.jacobian, facet.back) = (x, j, back);
        (facet.normal, facet.cone, facet.bend) = (normal, cone, bend);
        facet.affine = !facet.pole && bend <= AFFINE * (1.0 + far);
    }

    /// The facets of an element.
    pub fn of(&self, element: usize) -> Range<usize> {
        self.start[element]..self.start[element + 1]
    }

    /// Positions and derivatives in the coordinates of facet `f`.
    pub fn at(&self, f: usize, points: &[Vector<2>], order: Order, table: &mut MapTable<2, 3>) {
        let facet = &self.list[f];
        if facet.affine && order < Order::Hessians {
            table.reset(points.len(), order);
            table.x.iter_mut().zip(points).for_each(|(x, p)| *x = facet.x + facet.jacobian * (p - facet.polygon.center()));
            table.jacobian.fill(facet.jacobian);
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

    /// The unit normal at a corner of a facet; at a pole the product of the tangents of the two sides that end there.
    pub fn normal_at_corner(&self, f: usize, k: usize, table: &mut MapTable<2, 3>) -> Vector<3> {
        let facet = &self.list[f];
        if facet.pole && k == 2 {
            let ends = [Vector::<2>::new(0.0, 1.0), Vector::<2>::new(1.0, 1.0)].map(|uv| facet.origin + facet.axes * uv);
            self.map.map(facet.element, &ends, Order::Gradients, table);
            let towards = [0, 1].map(|q| (table.jacobian[q] * facet.axes).column(1).into_owned());
            let product = towards[0].cross(&towards[1]);
            return product / product.norm().max(f64::MIN_POSITIVE);
        }
        self.at(f, &[facet.polygon.corner(k)], Order::Gradients, table);
        unit_normal(&table.jacobian[0], 1.0)
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
        let facet = self.list[f];
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
            out.list.push(Facet { origin, axes, whole: false, size: 0.5 * facet.size, ..facet });
            out.measure_last(&mut table);
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
