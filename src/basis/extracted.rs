//! Linear combinations of the functions of another basis.

use super::{Basis, BasisStructure, Cell, Elements, Order, Polynomials, ShapeTable, TensorPatch};
use crate::linalg::{Real, Vector};

/// N_k = sum_i c_ik B_i: end-lowered, dual and truncated bases, Bezier extraction.
///
/// Active functions are listed with rising ids. There is no block: combinations may have any sign and any order. Plain sums, where every
/// inner function is in one of them, keep the patches and the polynomials that nothing joins where they are summed; of surfaces and solids
/// also those of their own space, summed in the same way.
#[derive(Clone, Debug, PartialEq)]
pub struct Extracted<B, T: Real = f64> {
    /// The underlying basis.
    pub inner: B,
    /// Number of new functions.
    pub functions: usize,
    /// `rows[i]` lists (k, c_ik): the new functions that the inner function i is part of.
    pub rows: Vec<Vec<(usize, T)>>,
}

impl<B, T: Real> Extracted<B, T> {
    /// Combinations of the functions of `inner`: `rows[i]` lists (k, c_ik).
    ///
    /// # Panics
    /// If there is not one row per inner function, or a row names a function that is not below `functions`.
    pub fn new<const D: usize>(inner: B, functions: usize, rows: Vec<Vec<(usize, T)>>) -> Self
    where
        B: Basis<D, T>,
    {
        assert_eq!(rows.len(), inner.num_functions(), "one row per inner function");
        assert!(rows.iter().flatten().all(|&(k, _)| k < functions), "rows name functions below {functions}");
        Self { inner, functions, rows }
    }

    /// The function that inner function `i` is part of, if it is part of one, as a whole.
    fn plain(&self, i: usize) -> Option<usize> {
        match self.rows[i][..] {
            [(k, c)] if c == T::one() => Some(k),
            _ => None,
        }
    }

    /// Appends the new functions to the inner ids in `ids`; returns the number of inner ones.
    fn append(&self, ids: &mut Vec<usize>) -> usize {
        let n = ids.len();
        for a in 0..n {
            for &(k, _) in &self.rows[ids[a]] {
                if !ids[n..].contains(&k) {
                    ids.push(k);
                }
            }
        }
        ids[n..].sort_unstable();
        n
    }
}

impl<B: Elements, T: Real> Elements for Extracted<B, T> {
    fn num_elements(&self) -> usize {
        self.inner.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.inner.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.inner.corners(element, ids);
    }
}

impl<const D: usize, B: Basis<D, T>, T: Real> Basis<D, T> for Extracted<B, T> {
    fn num_functions(&self) -> usize {
        self.functions
    }
    fn degree(&self, element: usize) -> [usize; D] {
        self.inner.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.inner.active(element, ids);
        let n = self.append(ids);
        ids.drain(..n);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
        let mut inner = table.inner.take().unwrap_or_default();
        let mut ids = std::mem::take(&mut table.ids);
        self.inner.tabulate(element, xi, order, &mut inner);
        self.inner.active(element, &mut ids);
        let n = self.append(&mut ids);
        let (old, new) = ids.split_at(n);
        table.reset(xi.len(), new.len(), order);
        for (a, &i) in old.iter().enumerate() {
            for &(k, c) in &self.rows[i] {
                let b = new.binary_search(&k).expect("every function of a row was appended");
                for q in 0..xi.len() {
                    table.values_mut(q)[b] += inner.values(q)[a] * c;
                    if order >= Order::Gradients {
                        table.grads_mut(q)[b] += inner.grads(q)[a] * c;
                    }
                    if order >= Order::Hessians {
                        table.hessians_mut(q)[b] += inner.hessians(q)[a] * c;
                    }
                }
            }
        }
        table.inner = Some(inner);
        table.ids = ids;
    }
    fn structure(&self) -> &dyn BasisStructure<D, T> {
        self
    }
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> {
        // sums are continuous where inner functions meet; of a lower degree, or without continuity, nothing joins them there
        let apart = matches!(wanted, Polynomials::Lowered(1..) | Polynomials::Uniform { continuity: -1, .. });
        let sums = (0..self.rows.len()).all(|i| self.plain(i).is_some());
        let own = D > 1 && wanted == Polynomials::Lowered(0);
        let found = self.inner.polynomials(wanted).filter(|_| sums && (apart || own))?;
        match own {
            false => Some(found),
            true if found.num_functions() != self.rows.len() => None,
            true => Some(Box::new(Extracted::new::<D>(found, self.functions, self.rows.clone()))),
        }
    }
}

impl<const D: usize, B: Basis<D, T>, T: Real> BasisStructure<D, T> for Extracted<B, T> {
    fn patches(&self) -> Option<Vec<TensorPatch<'_, D, T>>> {
        let mut patches = self.inner.structure().patches()?;
        for patch in &mut patches {
            patch.ids = patch.ids.iter().map(|&i| self.plain(i)).collect::<Option<_>>()?;
        }
        Some(patches)
    }
}
