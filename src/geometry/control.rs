//! Maps made of basis functions and control points.

use super::hull::Boxes;
use super::{Bounds, Control, Geometry, MapBlock, MapStructure, MapTable};
use crate::basis::{Basis, BasisStructure, Cell, Elements, Order, Polynomials, ShapeTable};
use crate::linalg::{Matrix, Real, Vector};
use crate::parallel;
use std::borrow::Cow;

/// x(xi) = sum_i N_i(xi) P_i with one point per function of `basis`.
///
/// It is also a basis, and so serves as an isoparametric space.
#[derive(Clone, Debug)]
pub struct ControlPoints<B, const N: usize, T: Real = f64> {
    /// The functions N_i.
    pub basis: B,
    /// The points P_i \[length\].
    pub points: Vec<Vector<N, T>>,
}

impl<B, const N: usize, T: Real> ControlPoints<B, N, T> {
    /// Fills `table` from the tabulated functions of an element.
    ///
    /// `ids` are the active functions in the order of `shapes`; `points` local points were tabulated up to `order`.
    pub fn combine<const D: usize>(
        &self,
        ids: &[usize],
        shapes: &ShapeTable<D, T>,
        points: usize,
        order: Order,
        table: &mut MapTable<D, N, T>,
    ) {
        combine(&self.points, ids, shapes, points, order, table);
    }
}

/// Fills `table` from control points and the tabulated functions `ids` of an element at `count` local points.
pub(crate) fn combine<const D: usize, const N: usize, T: Real>(
    control: &[Vector<N, T>],
    ids: &[usize],
    shapes: &ShapeTable<D, T>,
    count: usize,
    order: Order,
    table: &mut MapTable<D, N, T>,
) {
    let MapTable { x, jacobian, hessian, .. } = table;
    fill(control, ids, shapes, count, order, Places { x, jacobian, hessian });
}

/// The places and derivatives of a table.
struct Places<'a, const D: usize, const N: usize, T: Real> {
    x: &'a mut Vec<Vector<N, T>>,
    jacobian: &'a mut Vec<Matrix<N, D, T>>,
    hessian: &'a mut Vec<[Matrix<D, D, T>; N]>,
}

fn fill<const D: usize, const N: usize, T: Real>(
    control: &[Vector<N, T>],
    ids: &[usize],
    shapes: &ShapeTable<D, T>,
    count: usize,
    order: Order,
    table: Places<'_, D, N, T>,
) {
    let of = |least: Order| if order >= least { count } else { 0 };
    table.x.resize(count, Vector::zeros());
    table.jacobian.resize(of(Order::Gradients), Matrix::zeros());
    table.hessian.resize(of(Order::Hessians), [Matrix::zeros(); N]);
    for q in 0..count {
        let mut x = Vector::<N, T>::zeros();
        for (&i, &n) in ids.iter().zip(shapes.values(q)) {
            x += control[i] * n;
        }
        table.x[q] = x;
        if order >= Order::Gradients {
            let mut jacobian = Matrix::<N, D, T>::zeros();
            for (&i, g) in ids.iter().zip(shapes.grads(q)) {
                jacobian += control[i] * g.transpose();
            }
            table.jacobian[q] = jacobian;
        }
        if order >= Order::Hessians {
            let hessian = &mut table.hessian[q];
            *hessian = [Matrix::zeros(); N];
            for (&i, h) in ids.iter().zip(shapes.hessians(q)) {
                for (c, sum) in hessian.iter_mut().enumerate() {
                    *sum += h * control[i][c];
                }
            }
        }
    }
}

impl<B: Elements, const N: usize, T: Real> Elements for ControlPoints<B, N, T> {
    fn num_elements(&self) -> usize {
        self.basis.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.basis.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.basis.corners(element, ids);
    }
}

impl<const D: usize, const N: usize, T: Real, B: Basis<D, T>> Basis<D, T> for ControlPoints<B, N, T> {
    fn num_functions(&self) -> usize {
        self.basis.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; D] {
        self.basis.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.basis.active(element, ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
        self.basis.tabulate(element, xi, order, table);
    }
    fn structure(&self) -> &dyn BasisStructure<D, T> {
        self.basis.structure()
    }
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> {
        self.basis.polynomials(wanted)
    }
}

impl<const D: usize, const N: usize, T: Real, B: Basis<D, T>> Geometry<D, N, T> for ControlPoints<B, N, T> {
    fn map(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut MapTable<D, N, T>) {
        let MapTable { x, jacobian, hessian, shapes, ids, .. } = table;
        self.basis.active(element, ids);
        self.basis.tabulate(element, xi, order, shapes);
        fill(&self.points, ids, shapes, xi.len(), order, Places { x, jacobian, hessian });
    }

    fn bounds(&self, element: usize) -> Bounds<N, T> {
        Boxes::new(self, Control { basis: &self.basis, points: &self.points }).of(element)
    }

    fn all_bounds(&self) -> Vec<Bounds<N, T>> {
        let boxes = || Boxes::new(self, Control { basis: &self.basis, points: &self.points });
        parallel::map_init(self.num_elements(), boxes, |boxes, e| boxes.of(e))
    }

    fn extent(&self) -> Option<Bounds<N, T>> {
        let boxes = || Boxes::new(self, Control { basis: &self.basis, points: &self.points });
        let hulls: Vec<_> = parallel::map_init(self.num_elements(), boxes, |boxes, e| boxes.hull(e));
        boxes().around(&hulls)
    }

    fn map_structure(&self) -> &dyn MapStructure<D, N, T> {
        self
    }
}

impl<const D: usize, const N: usize, T: Real, B: Basis<D, T>> MapStructure<D, N, T> for ControlPoints<B, N, T> {
    fn is_affine(&self, element: usize) -> bool {
        self.basis.structure().is_linear(element)
    }

    fn control(&self) -> Option<Control<'_, D, N, T>> {
        Some(Control { basis: &self.basis, points: &self.points })
    }

    fn map_block(&self, element: usize) -> Option<MapBlock<'_, D, N, T>> {
        let basis = self.basis.structure().block(element)?;
        let functions: usize = basis.axes.iter().map(|a| a.num_functions()).product();
        // a block of part of the basis has its own numbering; only whole ones are known to number functions alike
        (functions == self.points.len()).then(|| MapBlock { basis, control: Cow::Borrowed(&self.points) })
    }
}
