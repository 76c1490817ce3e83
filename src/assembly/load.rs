//! Linear forms: loads inside a body and on its sides, springs on sides, measures.

use super::kernels::{Kernels, map_of};
use super::scratch::Scratch;
use super::sum_factorization::QuadraturePoints;
use crate::basis::{Basis, Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Csr, Matrix, Real, Vector, lit, measure as stretch, to_f64};
use crate::parallel;
use crate::quadrature::Quadrature;
use crate::space::{Space, Trace};

/// Elements handed to one task at a time.
const ELEMENTS_PER_TASK: usize = 64;

/// The integral of a force over a body, and its first moments. Units: that of f times length^D, and length^(D + 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments<const C: usize, const N: usize, T: Real = f64> {
    /// ∫ f dx.
    pub total: Vector<C, T>,
    /// ∫ f_c x_k dx at (c, k).
    pub first: Matrix<C, N, T>,
}

/// ∫ f(x) . N dx, unknown = C * function + component.
///
/// Unit: that of f times length^D. Same bits for any number of threads.
pub fn load<const C: usize, const D: usize, const N: usize, T, S, Q>(
    space: &S,
    quadrature: &Q,
    f: &(impl Fn(&Vector<N, T>) -> Vector<C, T> + Sync + ?Sized),
) -> Vec<T>
where
    T: Real,
    S: Space<D, N, T> + ?Sized,
    Q: Quadrature<D, T> + ?Sized,
{
    load_with_moments(space, quadrature, f).0
}

/// Computes [`load`] with the integral and the first moments of the force by the same rule: one call of f per point.
pub fn load_with_moments<const C: usize, const D: usize, const N: usize, T, S, Q>(
    space: &S,
    quadrature: &Q,
    f: &(impl Fn(&Vector<N, T>) -> Vector<C, T> + Sync + ?Sized),
) -> (Vec<T>, Moments<C, N, T>)
where
    T: Real,
    S: Space<D, N, T> + ?Sized,
    Q: Quadrature<D, T> + ?Sized,
{
    let map = || map_of::<D, N, T, S>(space);
    let answer = |sites: &QuadraturePoints, out: &mut [f64]| {
        for (x, out) in sites.x.chunks_exact(N).zip(out.chunks_exact_mut(C)) {
            let force = f(&Vector::from_fn(|k, _| lit(x[k])));
            out.iter_mut().zip(force.iter()).for_each(|(out, &f)| *out = to_f64(f));
        }
    };
    let moments = |sums: &[f64]| Moments {
        total: Vector::from_fn(|c, _| lit(sums[c * (N + 1) + N])),
        first: Matrix::from_fn(|c, k| lit(sums[c * (N + 1) + k])),
    };
    match Kernels::new(space, quadrature, &map).load(space, C, &answer) {
        Some((load, sums)) => (load, moments(&sums)),
        None => plain_load(space, quadrature, f),
    }
}

/// The ids and values of some elements, and the moments there.
type Part<const C: usize, const N: usize, T> = (Vec<usize>, Vec<Vector<C, T>>, Moments<C, N, T>);

/// The load element by element, for any space.
fn plain_load<const C: usize, const D: usize, const N: usize, T, S, Q>(
    space: &S,
    quadrature: &Q,
    f: &(impl Fn(&Vector<N, T>) -> Vector<C, T> + Sync + ?Sized),
) -> (Vec<T>, Moments<C, N, T>)
where
    T: Real,
    S: Space<D, N, T> + ?Sized,
    Q: Quadrature<D, T> + ?Sized,
{
    let none = Moments { total: Vector::zeros(), first: Matrix::zeros() };
    let parts: Vec<Part<C, N, T>> = parallel::map_ranges(space.num_elements(), ELEMENTS_PER_TASK, |chunk| {
        let mut scratch = Scratch::<D, N, T>::default();
        let (mut ids, mut values, mut moments): Part<C, N, T> = (Vec::new(), Vec::new(), none);
        for e in chunk {
            scratch.values(space, e, quadrature.rule(e));
            let first = ids.len();
            ids.extend_from_slice(&scratch.ids);
            values.resize(ids.len(), Vector::zeros());
            for (q, &dx) in scratch.dx.iter().enumerate() {
                let x = &scratch.map.x[q];
                let force = f(x) * dx;
                moments.total += force;
                moments.first += force * x.transpose();
                for (sum, &value) in values[first..].iter_mut().zip(scratch.shapes.values(q)) {
                    *sum += force * value;
                }
            }
        }
        (ids, values, moments)
    });
    let mut out = vec![T::zero(); C * space.num_functions()];
    let mut moments = none;
    for (ids, values, own) in &parts {
        for (&i, value) in ids.iter().zip(values) {
            for c in 0..C {
                out[C * i + c] += value[c];
            }
        }
        moments.total += own.total;
        moments.first += own.first;
    }
    (out, moments)
}

/// Adds ∫ f(x, n) . N ds over a side to the `load` of its body, n the outward unit normal.
///
/// # Panics
/// If `load` is shorter than C times the body's functions.
pub fn trace_load<const C: usize, const S: usize, const N: usize, T, Q>(
    trace: &Trace<S, N, T>,
    quadrature: &Q,
    f: &(impl Fn(&Vector<N, T>, &Vector<N, T>) -> Vector<C, T> + ?Sized),
    load: &mut [T],
) where
    T: Real,
    Q: Quadrature<S, T> + ?Sized,
{
    each_element(trace, quadrature, |ids, points| {
        for point in points {
            let force = f(point.x, &point.normal) * point.ds;
            for (&i, &value) in ids.iter().zip(point.values) {
                let dof = trace.dofs[i];
                for c in 0..C {
                    load[C * dof + c] += force[c] * value;
                }
            }
        }
    });
}

/// Adds ∫ N k(x, n) N ds over a side to the `matrix` of its body: springs to the ground.
///
/// Unit of k: force/area per length.
///
/// # Panics
/// If the pattern of `matrix` is not that of the body.
pub fn trace_springs<const C: usize, const S: usize, const N: usize, T, Q>(
    trace: &Trace<S, N, T>,
    quadrature: &Q,
    k: &(impl Fn(&Vector<N, T>, &Vector<N, T>) -> Matrix<C, C, T> + ?Sized),
    matrix: &mut Csr<T>,
) where
    T: Real,
    Q: Quadrature<S, T> + ?Sized,
{
    let mut block: Vec<T> = Vec::new();
    each_element(trace, quadrature, |ids, points| {
        // the matrix of the element first: its places in the rows are searched once, not at every point
        let width = C * ids.len();
        block.clear();
        block.resize(width * width, T::zero());
        for point in points {
            let stiffness = k(point.x, &point.normal) * point.ds;
            for (&va, rows) in point.values.iter().zip(block.chunks_exact_mut((C * width).max(1))) {
                for (c, row) in rows.chunks_exact_mut(width).enumerate() {
                    for (&vb, entries) in point.values.iter().zip(row.as_chunks_mut::<C>().0) {
                        let product = va * vb;
                        for e in 0..C {
                            entries[e] += stiffness[(c, e)] * product;
                        }
                    }
                }
            }
        }
        for (row, entries) in block.chunks_exact(width.max(1)).enumerate() {
            let (cols, vals) = matrix.row_mut(C * trace.dofs[ids[row / C]] + row % C);
            let mut next = 0;
            for (col, &value) in entries.iter().enumerate().filter(|(_, value)| **value != T::zero()) {
                let j = C * trace.dofs[ids[col / C]] + col % C;
                // functions of a side mostly follow one another in the row
                if cols.get(next) != Some(j) {
                    next = cols.position_of(j).expect("functions that meet on a side share an element");
                }
                vals[next] += value;
                next += 1;
            }
        }
    });
}

/// A point of a side.
struct SidePoint<'a, const N: usize, T: Real> {
    /// Values of the element's functions.
    values: &'a [T],
    x: &'a Vector<N, T>,
    /// Outward unit normal.
    normal: Vector<N, T>,
    /// Weight times measure.
    ds: T,
}

/// Calls `visit(functions of the side, points)` for every element, ascending.
fn each_element<const S: usize, const N: usize, T: Real, Q: Quadrature<S, T> + ?Sized>(
    trace: &Trace<S, N, T>,
    quadrature: &Q,
    mut visit: impl FnMut(&[usize], &mut dyn Iterator<Item = SidePoint<'_, N, T>>),
) {
    let (mut ids, mut shapes, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    for e in 0..trace.space.num_elements() {
        let rule = quadrature.rule(e);
        trace.space.active(e, &mut ids);
        trace.space.evaluate(e, &rule.points, Order::Gradients, &mut shapes, &mut map);
        let mut points = rule.weights.iter().enumerate().map(|(q, &w)| SidePoint {
            values: shapes.values(q),
            x: &map.x[q],
            normal: trace.normal(e, &map.jacobian[q]),
            ds: w * stretch(&map.jacobian[q]),
        });
        visit(&ids, &mut points);
    }
}

/// Length, area or volume of a space by a given rule: a resultant divided by it and applied by the same rule is exact.
///
/// The exact value is [`space::measure`](crate::space::measure).
pub fn measure<const D: usize, const N: usize, T, S, Q>(space: &S, quadrature: &Q) -> T
where
    T: Real,
    S: Space<D, N, T> + ?Sized,
    Q: Quadrature<D, T> + ?Sized,
{
    let mut map = MapTable::new();
    let mut sum = T::zero();
    for e in 0..space.num_elements() {
        let rule = quadrature.rule(e);
        space.map(e, &rule.points, Order::Gradients, &mut map);
        for (&w, j) in rule.weights.iter().zip(&map.jacobian) {
            sum += w * stretch(j);
        }
    }
    sum
}
