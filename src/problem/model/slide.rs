//! Curved sides that slide: rows of their conditions.

use super::BodySide;
use crate::basis::{Basis, Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Triplets, Vector, measure};
use crate::problem::handles::Statement;
use crate::problem::resultant::Resultant;
use crate::quadrature::Quadrature;
use std::sync::Arc;

/// A curved side that is held along its normals, or along its tangents.
#[derive(Clone, Debug)]
pub struct CurvedSlide<const S: usize, const N: usize> {
    /// The statement.
    pub of: Statement,
    /// The side.
    pub side: Arc<BodySide<S, N>>,
    /// Whether it is held along its normals n, else along its tangents.
    pub along_normal: bool,
}

/// A curved side that slides, with a multiplier function ψ_j per condition on u:
///
/// ```text
/// ∫ ψ_j d . u ds = 0,   d = n,   or   d = the tangent in the plane,   d = (1 - n nᵀ) t_jk, k = 1, 2, in space
/// ```
///
/// with tangents t_j1, t_j2 at the place where ψ_j is largest: they do not ask how elements are turned.
#[derive(Debug)]
pub struct SlidePart<const S: usize, const N: usize> {
    slide: CurvedSlide<S, N>,
    functions: Box<dyn Basis<S>>,
    /// Orthonormal tangents of every function, in space.
    tangents: Vec<Vec<Vector<N>>>,
    /// The rows in unknowns of the model.
    pub rows: Triplets,
    /// First row in the system.
    pub first_row: usize,
}

/// A point of a side that slides.
#[derive(Debug)]
pub struct SlidePoint<'a, const N: usize> {
    /// The element of the side.
    pub element: usize,
    /// Its place.
    pub x: Vector<N>,
    /// Functions of the trace.
    ids: &'a [usize],
    /// Their values.
    values: &'a [f64],
}

impl<const S: usize, const N: usize> SlidePart<S, N> {
    /// The rows of `slide` with these functions, for a model of so many `unknowns`; the first is `first_row` in the system.
    pub fn new(slide: CurvedSlide<S, N>, functions: Box<dyn Basis<S>>, unknowns: usize, first_row: usize) -> Self {
        let mut part = Self { tangents: Vec::new(), rows: Triplets::new(0, unknowns), first_row, slide, functions };
        if N == 3 && !part.slide.along_normal {
            part.tangents = part.normals().iter().map(tangents).collect();
        }
        let mut rows = Triplets::new(part.num_rows(), unknowns);
        let side = part.side();
        part.visit(|at, row, d| {
            for (&i, value) in at.ids.iter().zip(at.values) {
                (0..N).for_each(|c| rows.push(row, side.field.unknown(side.trace.dofs[i], c), d[c] * value));
            }
        });
        part.rows = rows;
        part
    }

    /// Whether the side is held along its normals, else along its tangents.
    pub fn along_normal(&self) -> bool {
        self.slide.along_normal
    }

    /// The side.
    pub fn side(&self) -> &Arc<BodySide<S, N>> {
        &self.slide.side
    }

    /// Number of rows.
    pub fn num_rows(&self) -> usize {
        self.functions.num_functions() * if self.slide.along_normal { 1 } else { S }
    }

    /// Force of the side's support on the body and its moment, from the multipliers of all rows of the system: - ∫ sum_j lambda_j ψ_j d ds.
    pub fn force(&self, lambda: &[f64]) -> Resultant {
        let mut sum = Resultant::default();
        self.visit(|at, row, d| sum.add(&at.x, d.as_slice(), -lambda[self.first_row + row]));
        sum
    }

    /// Visits the points of the side with every row that acts there: the row among those of the side, and its ψ d ds.
    pub fn visit(&self, mut act: impl FnMut(&SlidePoint<'_, N>, usize, &Vector<N>)) {
        let space = &*self.side().trace.space;
        let (mut table, mut own, mut map) = (ShapeTable::new(), ShapeTable::new(), MapTable::new());
        let (mut ids, mut functions, mut common) = (Vec::new(), Vec::new(), Vec::new());
        for element in 0..space.num_elements() {
            let rule = self.side().rules.rule(element);
            space.active(element, &mut ids);
            space.evaluate(element, &rule.points, Order::Gradients, &mut table, &mut map);
            self.functions.active(element, &mut functions);
            self.functions.tabulate(element, &rule.points, Order::Values, &mut own);
            for (q, w) in rule.weights.iter().enumerate() {
                let ds = w * measure(&map.jacobian[q]);
                let normal = self.side().trace.normal(element, &map.jacobian[q]);
                // an element that is a line or a point has no normal
                if ds == 0.0 || !normal.iter().all(|v| v.is_finite()) {
                    continue;
                }
                let at = SlidePoint { element, x: map.x[q], ids: &ids, values: table.values(q) };
                // those of all functions, unless each has tangents of its own
                common.clear();
                if self.slide.along_normal {
                    common.push(normal);
                } else if self.tangents.is_empty() {
                    common.extend(tangents(&normal));
                }
                for (&j, psi) in functions.iter().zip(own.values(q)) {
                    let own = self.tangents.get(j).unwrap_or(&common);
                    let across = |t: &Vector<N>| if self.tangents.is_empty() { *t } else { t - normal * normal.dot(t) };
                    own.iter().enumerate().for_each(|(k, d)| act(&at, j * own.len() + k, &(across(d) * (psi * ds))));
                }
            }
        }
    }

    /// The normal at the point where each function is largest, of the points of the side's rule.
    fn normals(&self) -> Vec<Vector<N>> {
        let space = &*self.side().trace.space;
        let mut best = vec![(0.0, Vector::zeros()); self.functions.num_functions()];
        let (mut own, mut map, mut functions) = (ShapeTable::new(), MapTable::new(), Vec::new());
        for element in 0..space.num_elements() {
            let points = &self.side().rules.rule(element).points;
            space.map(element, points, Order::Gradients, &mut map);
            self.functions.active(element, &mut functions);
            self.functions.tabulate(element, points, Order::Values, &mut own);
            for (q, jacobian) in map.jacobian.iter().enumerate() {
                let normal = self.side().trace.normal(element, jacobian);
                for (&j, psi) in functions.iter().zip(own.values(q)) {
                    if psi.abs() > best[j].0 && normal.iter().all(|v| v.is_finite()) {
                        best[j] = (psi.abs(), normal);
                    }
                }
            }
        }
        best.into_iter().map(|(_, normal)| normal).collect()
    }
}

/// Unit vectors perpendicular to `normal` and to each other; in the plane the normal turned by a quarter to the left.
pub fn tangents<const N: usize>(normal: &Vector<N>) -> Vec<Vector<N>> {
    if N == 2 {
        return vec![Vector::from_fn(|k, _| if k == 0 { -normal[1] } else { normal[0] })];
    }
    let mut basis: Vec<Vector<N>> = vec![*normal];
    for k in 0..N {
        let mut v = Vector::<N>::from_fn(|i, _| f64::from(u8::from(i == k)));
        for b in &basis {
            v -= b * b.dot(&v);
        }
        if v.norm() > 0.1 && basis.len() < N {
            basis.push(v / v.norm());
        }
    }
    basis.split_off(1)
}
