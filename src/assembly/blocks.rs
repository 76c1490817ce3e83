//! The matrix of several bodies: their own on the diagonal, and what soft couplings add between them.

use crate::linalg::{Csr, Operator, Real};

/// The matrix of all bodies: blocks on the diagonal and, where couplings add stiffness, entries between them.
#[derive(Clone, Copy, Debug)]
pub struct Blocks<'a, T: Real = f64> {
    /// One matrix per body, in the order of their unknowns.
    pub bodies: &'a [&'a Csr<T>],
    /// A matrix in all unknowns that is added to the blocks.
    pub between: Option<&'a Csr<T>>,
}

impl<'a, T: Real> From<&'a [&'a Csr<T>]> for Blocks<'a, T> {
    fn from(bodies: &'a [&'a Csr<T>]) -> Self {
        Self { bodies, between: None }
    }
}

impl<'a, T: Real, const K: usize> From<&'a [&'a Csr<T>; K]> for Blocks<'a, T> {
    fn from(bodies: &'a [&'a Csr<T>; K]) -> Self {
        Self { bodies, between: None }
    }
}

impl<'a, T: Real> From<&'a Vec<&'a Csr<T>>> for Blocks<'a, T> {
    fn from(bodies: &'a Vec<&'a Csr<T>>) -> Self {
        Self { bodies, between: None }
    }
}

impl<T: Real> Blocks<'_, T> {
    /// Number of unknowns of all bodies.
    pub fn num_unknowns(&self) -> usize {
        self.bodies.iter().map(|k| k.num_rows()).sum()
    }

    /// First unknown of every block.
    pub(super) fn starts(&self) -> Vec<usize> {
        self.bodies
            .iter()
            .scan(0, |next, m| {
                let start = *next;
                *next += m.num_rows();
                Some(start)
            })
            .collect()
    }

    /// Row `i` of the sum, `starts` as above.
    pub(super) fn row(&self, starts: &[usize], i: usize) -> Row<'_, T> {
        let block = starts.partition_point(|&s| s <= i) - 1;
        let own = self.bodies[block].row(i - starts[block]);
        Row { start: starts[block], own, between: self.between.map_or((&[], &[]), |m| m.row(i)) }
    }

    /// K u.
    pub fn product(&self, u: &[T]) -> Vec<T> {
        let mut y = vec![T::zero(); u.len()];
        for (m, start) in self.bodies.iter().zip(self.starts()) {
            let range = start..start + m.num_rows();
            m.apply(&u[range.clone()], &mut y[range]);
        }
        if let Some(between) = self.between {
            let mut added = vec![T::zero(); u.len()];
            between.apply(u, &mut added);
            y.iter_mut().zip(added).for_each(|(y, a)| *y += a);
        }
        y
    }

    /// The diagonal of the bodies alone: what penalties are measured by.
    pub fn bodies_diagonal(&self) -> Vec<T> {
        self.bodies.iter().flat_map(|k| k.diagonal()).collect()
    }
}

/// A row of [`Blocks`]: (column, value) with ascending columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<'a, T> {
    start: usize,
    own: (&'a [u32], &'a [T]),
    between: (&'a [u32], &'a [T]),
}

impl<T: Real> Iterator for Row<'_, T> {
    type Item = (usize, T);

    fn next(&mut self) -> Option<(usize, T)> {
        let a = self.own.0.first().map(|&j| self.start + j as usize);
        let b = self.between.0.first().map(|&j| j as usize);
        let (take, add) = match (a, b) {
            (None, None) => return None,
            (Some(a), Some(b)) => (a <= b, b <= a),
            (a, b) => (a.is_some(), b.is_some()),
        };
        let mut sum = T::zero();
        if take {
            sum += self.own.1[0];
            self.own = (&self.own.0[1..], &self.own.1[1..]);
        }
        if add {
            sum += self.between.1[0];
            self.between = (&self.between.0[1..], &self.between.1[1..]);
        }
        Some((if take { a? } else { b? }, sum))
    }
}
