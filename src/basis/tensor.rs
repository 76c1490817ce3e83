//! Products of univariate bases.

use super::{Basis, BasisStructure, Block, Elements, Order, Polynomials, ShapeTable, TensorPatch};
use crate::linalg::{Matrix, Real, Vector};
use std::marker::PhantomData;

/// N_i(xi) = prod_k N_(i_k)(xi_k); functions and elements are numbered with the first axis fastest.
///
/// Corner ids are those of the grid of the axes' corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TensorProduct<const D: usize, A, T: Real = f64> {
    /// The univariate factors.
    axes: [A; D],
    /// Corner ids per axis, the stride of the next axis; zero if an axis has no corner ids.
    corner_counts: [usize; D],
    scalar: PhantomData<T>,
}

/// Univariate coordinates of a batch are looked for among this many of those met last, so that a product of `n` points
/// per direction is tabulated in `n` points per axis.
const RECENT: usize = 16;
/// Reference cells per axis whose tuples are numbered.
const REFERENCES: usize = 1 << 8;
/// Active functions per axis that `active` holds without allocating.
const ON_STACK: usize = 20;

/// Whether all elements of a univariate basis are one block of polynomials, the basis itself.
pub(super) fn is_one_block<T: Real, A: Basis<1, T> + ?Sized>(axis: &A) -> bool {
    axis.num_elements() > 0
        && axis.structure().block(0).is_some_and(|b| b.first == 0 && b.weights.is_none() && b.axes[0].num_elements() == axis.num_elements())
}

impl<const D: usize, A: Basis<1, T>, T: Real> TensorProduct<D, A, T> {
    /// The product of `axes`.
    pub fn new(axes: [A; D]) -> Self {
        let mut ids = Vec::new();
        let corner_counts = axes.each_ref().map(|axis| {
            let mut count = 0;
            for e in 0..axis.num_elements() {
                axis.corners(e, &mut ids);
                if ids.len() != 2 {
                    return 0;
                }
                count = ids.iter().fold(count, |c, &i| c.max(i + 1));
            }
            count
        });
        Self { axes, corner_counts, scalar: PhantomData }
    }

    /// The univariate factors.
    pub fn axes(&self) -> &[A; D] {
        &self.axes
    }

    /// The element of each axis whose product is `element`.
    pub fn split(&self, element: usize) -> [usize; D] {
        let mut rest = element;
        self.axes.each_ref().map(|axis| {
            let e = rest % axis.num_elements();
            rest /= axis.num_elements();
            e
        })
    }
}

impl<const D: usize, A: Basis<1, T>, T: Real> Elements for TensorProduct<D, A, T> {
    fn num_elements(&self) -> usize {
        self.axes.iter().map(A::num_elements).product()
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        let at = self.split(element);
        let mut ends = [[0usize; 2]; D];
        for k in 0..D {
            if self.corner_counts[k] == 0 {
                ids.clear();
                return;
            }
            self.axes[k].corners(at[k], ids);
            ends[k] = [ids[0], ids[1]];
        }
        ids.clear();
        for corner in 0..1usize << D {
            let id = (0..D).rev().fold(0, |id, k| id * self.corner_counts[k] + ends[k][(corner >> k) & 1]);
            ids.push(id);
        }
    }
}

impl<const D: usize, A: Basis<1, T>, T: Real> Basis<D, T> for TensorProduct<D, A, T> {
    fn num_functions(&self) -> usize {
        self.axes.iter().map(A::num_functions).product()
    }
    fn degree(&self, element: usize) -> [usize; D] {
        let at = self.split(element);
        std::array::from_fn(|k| self.axes[k].degree(at[k])[0])
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        let at = self.split(element);
        let (mut lines, mut counts) = ([[0usize; ON_STACK]; D], [0usize; D]);
        let mut many: Vec<Vec<usize>> = Vec::new(); // allocates only for more functions than fit on the stack
        for k in 0..D {
            self.axes[k].active(at[k], ids);
            counts[k] = ids.len();
            if ids.len() <= ON_STACK {
                lines[k][..ids.len()].copy_from_slice(ids);
            } else {
                many.resize(D, Vec::new());
                many[k].clone_from(ids);
            }
        }
        let id = |k: usize, a: usize| if counts[k] <= ON_STACK { lines[k][a] } else { many[k][a] };
        ids.clear();
        rows(&counts, |_, i| {
            let (mut stride, mut first) = (self.axes[0].num_functions(), 0);
            for k in 1..D {
                first += stride * id(k, i[k]);
                stride *= self.axes[k].num_functions();
            }
            ids.extend((0..counts[0]).map(|a| first + id(0, a)));
        });
    }
    fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
        let at = self.split(element);
        let mut lines = std::mem::take(&mut table.lines);
        let mut places = std::mem::take(&mut table.ids);
        let mut points = std::mem::take(&mut table.line_points);
        lines.resize_with(D.max(lines.len()), ShapeTable::new);
        places.clear();
        for k in 0..D {
            points.clear();
            let mut last = 0;
            for x in xi {
                // grids repeat their coordinates in turn: the same again, the next, the first
                let known = |i: &usize| points.get(*i).is_some_and(|p: &Vector<1, T>| p[0] == x[k]);
                let recent = || (points.len().saturating_sub(RECENT)..points.len()).find(known);
                let met = [last, last + 1, 0].into_iter().find(known).or_else(recent);
                last = met.unwrap_or(points.len());
                places.push(last);
                if met.is_none() {
                    points.push(Vector::<1, T>::new(x[k]));
                }
            }
            self.axes[k].tabulate(at[k], &points, order, &mut lines[k]);
        }
        let counts: [usize; D] = std::array::from_fn(|k| lines[k].num_functions());
        table.resize(xi.len(), counts.iter().product(), order);
        for q in 0..xi.len() {
            let place: [usize; D] = std::array::from_fn(|k| places[k * xi.len() + q]);
            let values: [&[T]; D] = std::array::from_fn(|k| lines[k].values(place[k]));
            let (out, grads, hessians) = table.point_mut(q);
            rows(&counts, |first, i| {
                let outer: [T; D] = std::array::from_fn(|k| values[k][i[k]]);
                for (out, &v) in out[first..].iter_mut().zip(values[0]) {
                    *out = (1..D).fold(v, |v, k| v * outer[k]);
                }
            });
            if order < Order::Gradients {
                continue;
            }
            let slopes: [&[Vector<1, T>]; D] = std::array::from_fn(|k| lines[k].grads(place[k]));
            rows(&counts, |first, i| {
                let outer: [[T; 2]; D] = std::array::from_fn(|k| [values[k][i[k]], slopes[k][i[k]][0]]);
                for ((g, &v), s) in grads[first..].iter_mut().zip(values[0]).zip(slopes[0]) {
                    for d in 0..D {
                        g[d] = (1..D).fold([v, s[0]][usize::from(d == 0)], |v, k| v * outer[k][usize::from(k == d)]);
                    }
                }
            });
            if order < Order::Hessians {
                continue;
            }
            let bends: [&[Matrix<1, 1, T>]; D] = std::array::from_fn(|k| lines[k].hessians(place[k]));
            rows(&counts, |first, i| {
                let of = |k: usize, i: usize| [values[k][i], slopes[k][i][0], bends[k][i][0]];
                let outer: [[T; 3]; D] = std::array::from_fn(|k| of(k, i[k]));
                for (i, h) in hessians[first..].iter_mut().take(counts[0]).enumerate() {
                    let own = of(0, i);
                    for d in 0..D {
                        for e in 0..=d {
                            let derivatives = |k: usize| usize::from(k == d) + usize::from(k == e);
                            let value = (1..D).fold(own[derivatives(0)], |v, k| v * outer[k][derivatives(k)]);
                            h[(d, e)] = value;
                            h[(e, d)] = value;
                        }
                    }
                }
            });
        }
        table.lines = lines;
        table.ids = places;
        table.line_points = points;
    }
    fn structure(&self) -> &dyn BasisStructure<D, T> {
        self
    }
    /// The product of the axes' polynomials.
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> {
        let axes: Vec<Box<dyn Basis<1, T>>> = self.axes.iter().map(|axis| axis.polynomials(wanted)).collect::<Option<_>>()?;
        let axes: [Box<dyn Basis<1, T>>; D] = axes.try_into().ok()?;
        Some(Box::new(TensorProduct::new(axes)))
    }
}

impl<const D: usize, A: Basis<1, T>, T: Real> BasisStructure<D, T> for TensorProduct<D, A, T> {
    /// A number for every tuple of the axes' numbers, where these are small.
    fn reference(&self, element: usize) -> Option<usize> {
        let at = self.split(element);
        (0..D).try_fold(0, |number, k| {
            let own = self.axes[k].structure().reference(at[k])?;
            (own < REFERENCES).then_some(number * REFERENCES + own)
        })
    }
    fn block(&self, _element: usize) -> Option<Block<'_, D, T>> {
        let whole = self.axes.iter().all(|axis| is_one_block(axis));
        whole.then(|| Block { first: 0, axes: self.axes.each_ref().map(|a| a as &dyn Basis<1, T>), weights: None })
    }
    fn patches(&self) -> Option<Vec<TensorPatch<'_, D, T>>> {
        let ids = (0..self.num_functions()).collect();
        self.block(0).map(|block| vec![TensorPatch { block, ids }])
    }
}

/// Calls `f(a, i)` for every multi-index i below `counts` whose first entry is zero; a is its number, first entry fastest.
#[inline(always)]
fn rows<const D: usize>(counts: &[usize; D], mut f: impl FnMut(usize, &[usize; D])) {
    let mut i = [0usize; D];
    for a in (0..counts.iter().product()).step_by(counts[0].max(1)) {
        f(a, &i);
        for k in 1..D {
            i[k] += 1;
            if i[k] < counts[k] {
                break;
            }
            i[k] = 0;
        }
    }
}
