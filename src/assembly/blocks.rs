//! The matrix of several bodies: their own matrices on the diagonal, and the stiffness of couplings between them.

use crate::linalg::{Columns, Csr, Operator, Real};

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

    /// Row `i` of the sum, with `starts` from [`Self::starts`].
    pub(super) fn row(&self, starts: &[usize], i: usize) -> BlockRow<'_, T> {
        let block = starts.partition_point(|&s| s <= i) - 1;
        let own = Line::of(self.bodies[block].row(i - starts[block]));
        BlockRow { start: starts[block], own, between: self.between.map(|m| Line::of(m.row(i))) }
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

    /// The diagonal of the bodies' matrices alone, the scale of penalties.
    pub fn bodies_diagonal(&self) -> Vec<T> {
        self.bodies.iter().flat_map(|k| k.diagonal()).collect()
    }
}

/// A row of [`Blocks`]: (column, value) with ascending columns.
#[derive(Clone, Debug)]
pub(super) struct BlockRow<'a, T> {
    start: usize,
    own: Line<'a, T>,
    between: Option<Line<'a, T>>,
}

/// Unread rest of a row of one matrix.
#[derive(Clone, Debug)]
struct Line<'a, T> {
    first: Option<usize>,
    cols: Columns<'a>,
    vals: std::slice::Iter<'a, T>,
}

impl<'a, T: Real> Line<'a, T> {
    fn of((mut cols, vals): (Columns<'a>, &'a [T])) -> Self {
        Self { first: cols.next(), cols, vals: vals.iter() }
    }

    /// The value at `first`; goes on to the next column.
    #[inline]
    fn take(&mut self) -> T {
        self.first = self.cols.next();
        self.vals.next().copied().unwrap_or_else(T::zero)
    }
}

impl<T: Real> Iterator for BlockRow<'_, T> {
    type Item = (usize, T);

    fn next(&mut self) -> Option<(usize, T)> {
        let a = self.own.first.map(|j| self.start + j);
        let b = self.between.as_ref().and_then(|b| b.first);
        let (take, add) = match (a, b) {
            (None, None) => return None,
            (Some(a), Some(b)) => (a <= b, b <= a),
            (a, b) => (a.is_some(), b.is_some()),
        };
        let mut sum = T::zero();
        if take {
            sum += self.own.take();
        }
        if let Some(between) = self.between.as_mut().filter(|_| add) {
            sum += between.take();
        }
        Some((if take { a? } else { b? }, sum))
    }
}
