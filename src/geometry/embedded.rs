//! A basis or a map on affine cells inside its elements: refined cells, simplices cut from cells, facets.

use super::{Bounds, Embedding, Geometry, MapTable, cell, hull};
use crate::basis::{Basis, Cell, Elements, Order, Polynomials, ShapeTable};
use crate::linalg::{Matrix, Real, Vector, lit, num};

/// A function vanishes on a cell if its absolute value is at most this at all sample points.
const VANISHES: f64 = 1e-10;

/// A basis or a geometry of dimension D on cells of dimension S <= D inside its elements.
///
/// The derivatives follow from the chain rule: d/dxi_S = axesᵀ d/dxi_D. A warm table keeps those of the inner dimension; specialised maps
/// of dimension S evaluate fewer functions.
#[derive(Clone, Debug)]
pub struct Embedded<const S: usize, const D: usize, X, T: Real = f64> {
    /// The inner basis or geometry.
    pub inner: X,
    /// One cell per element.
    pub cells: Vec<Embedding<S, D, T>>,
    kind: Cell,
    corners: Vec<Vec<usize>>,
    kept: Option<Kept>,
}

/// The functions that do not vanish on the cells.
#[derive(Clone, Debug)]
struct Kept {
    functions: usize,
    /// Per cell: index in the table of the parent element, id.
    local: Vec<Vec<(usize, usize)>>,
}

impl<const S: usize, const D: usize, X, T: Real> Embedded<S, D, X, T> {
    /// Restricts `inner` to `cells`, all of the shape `kind`; functions keep their ids.
    pub fn new(inner: X, cells: Vec<Embedding<S, D, T>>, kind: Cell) -> Self {
        Self { inner, cells, kind, corners: Vec::new(), kept: None }
    }

    /// Sets topological corner ids per cell.
    ///
    /// # Panics
    /// If there is not one list per cell.
    #[must_use]
    pub fn with_corners(mut self, corners: Vec<Vec<usize>>) -> Self {
        assert_eq!(corners.len(), self.cells.len(), "one list of corners per cell");
        self.corners = corners;
        self
    }

    /// Removes the functions that vanish on all cells; also returns the former ids of the others.
    #[must_use]
    pub fn restricted(mut self) -> (Self, Vec<usize>)
    where
        X: Basis<D, T>,
    {
        let mut shapes = ShapeTable::new();
        let mut ids = Vec::new();
        let mut kept: Vec<Vec<(usize, usize)>> = Vec::with_capacity(self.cells.len());
        for embedding in &self.cells {
            let degree: usize = self.inner.degree(embedding.element).into_iter().sum();
            // interior points of an unusual grid, off the nodes of any common basis
            let line: Vec<T> = (0..degree + 2).map(|j| (num::<T>(j) + lit(0.37)) / num(degree + 2)).collect();
            let points: Vec<Vector<D, T>> = cell::spread::<S, T>(self.kind, &line).iter().map(|xi| embedding.lift(xi)).collect();
            self.inner.active(embedding.element, &mut ids);
            self.inner.tabulate(embedding.element, &points, Order::Values, &mut shapes);
            let lives = |a: usize| (0..points.len()).any(|q| shapes.values(q)[a].abs() > lit(VANISHES));
            kept.push(ids.iter().enumerate().filter(|&(a, _)| lives(a)).map(|(a, &i)| (a, i)).collect());
        }
        let mut dofs: Vec<usize> = kept.iter().flatten().map(|&(_, i)| i).collect();
        dofs.sort_unstable();
        dofs.dedup();
        for (_, id) in kept.iter_mut().flatten() {
            *id = dofs.binary_search(id).expect("every kept function is in the list");
        }
        self.kept = Some(Kept { functions: dofs.len(), local: kept });
        (self, dofs)
    }
}

impl<const S: usize, const D: usize, X: Elements, T: Real> Elements for Embedded<S, D, X, T> {
    fn num_elements(&self) -> usize {
        self.cells.len()
    }
    fn cell(&self, _element: usize) -> Cell {
        self.kind
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        if let Some(list) = self.corners.get(element) {
            ids.extend_from_slice(list);
        }
    }
}

impl<const S: usize, const D: usize, X: Basis<D, T>, T: Real> Basis<S, T> for Embedded<S, D, X, T> {
    fn num_functions(&self) -> usize {
        self.kept.as_ref().map_or_else(|| self.inner.num_functions(), |k| k.functions)
    }

    fn degree(&self, element: usize) -> [usize; S] {
        let embedding = &self.cells[element];
        let inner = self.inner.degree(embedding.element);
        if self.inner.cell(embedding.element) == Cell::Simplex {
            return [inner.into_iter().max().unwrap_or(0); S];
        }
        let along = |s: usize| (0..D).filter(|&k| embedding.axes[(k, s)] != T::zero()).map(|k| inner[k]).sum::<usize>();
        let degree: [usize; S] = std::array::from_fn(along);
        match self.kind {
            Cell::Tensor => degree,
            Cell::Simplex => [inner.into_iter().sum::<usize>().min(degree.into_iter().sum()); S],
        }
    }

    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        match &self.kept {
            None => self.inner.active(self.cells[element].element, ids),
            Some(kept) => {
                ids.clear();
                ids.extend(kept.local[element].iter().map(|&(_, i)| i));
            }
        }
    }

    /// The polynomials of the inner basis, where the cells are whole elements of it.
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<S, T>>> {
        let is_whole = |cell: &Embedding<S, D, T>| cell.origin == Vector::<D, T>::zeros() && cell.axes == Matrix::<D, S, T>::identity();
        if S != D || !self.cells.iter().all(is_whole) {
            return None;
        }
        let part = Embedded::<S, D, _, T>::new(self.inner.polynomials(wanted)?, self.cells.clone(), self.kind);
        Some(Box::new(part.with_corners(self.corners.clone()).restricted().0))
    }

    fn tabulate(&self, element: usize, xi: &[Vector<S, T>], order: Order, table: &mut ShapeTable<S, T>) {
        let embedding = &self.cells[element];
        let mut inner = table.embedded.take::<(Vec<Vector<D, T>>, ShapeTable<D, T>)>();
        let (points, parent) = &mut *inner;
        points.clear();
        points.extend(xi.iter().map(|xi| embedding.lift(xi)));
        self.inner.tabulate(embedding.element, points, order, parent);
        let local = self.kept.as_ref().map(|k| &k.local[element]);
        let functions = local.map_or(parent.num_functions(), Vec::len);
        let place = |b: usize| local.map_or(b, |l| l[b].0);
        table.reset(xi.len(), functions, order);
        for q in 0..xi.len() {
            for b in 0..functions {
                let a = place(b);
                table.values_mut(q)[b] = parent.values(q)[a];
                if order >= Order::Gradients {
                    table.grads_mut(q)[b] = embedding.axes.tr_mul(&parent.grads(q)[a]);
                }
                if order >= Order::Hessians {
                    table.hessians_mut(q)[b] = embedding.axes.tr_mul(&(parent.hessians(q)[a] * embedding.axes));
                }
            }
        }
        table.embedded.keep(inner);
    }
}

impl<const S: usize, const D: usize, const N: usize, X: Geometry<D, N, T>, T: Real> Geometry<S, N, T> for Embedded<S, D, X, T> {
    fn map(&self, element: usize, xi: &[Vector<S, T>], order: Order, table: &mut MapTable<S, N, T>) {
        let embedding = &self.cells[element];
        let mut inner = table.embedded.take::<(Vec<Vector<D, T>>, MapTable<D, N, T>)>();
        let (points, parent) = &mut *inner;
        points.clear();
        points.extend(xi.iter().map(|xi| embedding.lift(xi)));
        self.inner.map(embedding.element, points, order, parent);
        std::mem::swap(&mut table.x, &mut parent.x);
        table.jacobian.clear();
        table.hessian.clear();
        if order >= Order::Gradients {
            table.jacobian.extend(parent.jacobian.iter().map(|j| j * embedding.axes));
        }
        if order >= Order::Hessians {
            let turned = |h: &[crate::linalg::Matrix<D, D, T>; N]| std::array::from_fn(|c| embedding.axes.tr_mul(&(h[c] * embedding.axes)));
            table.hessian.extend(parent.hessian.iter().map(turned));
        }
        table.embedded.keep(inner);
    }

    fn bounds(&self, element: usize) -> Bounds<N, T> {
        hull::tightened(self, element, self.inner.bounds(self.cells[element].element))
    }
}
