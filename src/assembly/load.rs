//! Linear forms: loads inside a body and on its sides, springs on sides, measures.

use super::scratch::Scratch;
use crate::basis::{Basis, Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Csr, Matrix, Real, Vector, measure as stretch};
use crate::quadrature::Quadrature;
use crate::space::{Space, Trace};
use rayon::prelude::*;

/// Elements handed to one task at a time.
const ELEMENTS_PER_TASK: usize = 64;

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
    let elements: Vec<usize> = (0..space.num_elements()).collect();
    let parts: Vec<(Vec<usize>, Vec<Vector<C, T>>)> = elements
        .par_chunks(ELEMENTS_PER_TASK)
        .map(|chunk| {
            let mut scratch = Scratch::<D, N, T>::default();
            let (mut ids, mut values): (Vec<usize>, Vec<Vector<C, T>>) = (Vec::new(), Vec::new());
            for &e in chunk {
                scratch.values(space, e, quadrature.rule(e));
                let first = ids.len();
                ids.extend_from_slice(&scratch.ids);
                values.resize(ids.len(), Vector::zeros());
                for (q, &dx) in scratch.dx.iter().enumerate() {
                    let force = f(&scratch.map.x[q]) * dx;
                    for (sum, &value) in values[first..].iter_mut().zip(scratch.shapes.values(q)) {
                        *sum += force * value;
                    }
                }
            }
            (ids, values)
        })
        .collect();
    let mut out = vec![T::zero(); C * space.num_functions()];
    for (ids, values) in &parts {
        for (&i, value) in ids.iter().zip(values) {
            for c in 0..C {
                out[C * i + c] += value[c];
            }
        }
    }
    out
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
    each_point(trace, quadrature, |ids, values, x, normal, ds| {
        let force = f(x, normal) * ds;
        for (&i, &value) in ids.iter().zip(values) {
            let dof = trace.dofs[i];
            for c in 0..C {
                load[C * dof + c] += force[c] * value;
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
    each_point(trace, quadrature, |ids, values, x, normal, ds| {
        let stiffness = k(x, normal) * ds;
        for (a, &i) in ids.iter().enumerate() {
            for (b, &j) in ids.iter().enumerate() {
                for c in 0..C {
                    for e in 0..C {
                        let value = stiffness[(c, e)] * values[a] * values[b];
                        if value != T::zero() {
                            add(matrix, C * trace.dofs[i] + c, C * trace.dofs[j] + e, value);
                        }
                    }
                }
            }
        }
    });
}

/// Adds to an entry that the pattern has.
fn add<T: Real>(matrix: &mut Csr<T>, row: usize, col: usize, value: T) {
    let (cols, vals) = matrix.row_mut(row);
    vals[cols.position_of(col).expect("functions that meet on a side share an element")] += value;
}

/// Calls `visit(functions of the side, their values, x, outward normal, ds)` at every point, elements ascending.
fn each_point<const S: usize, const N: usize, T: Real, Q: Quadrature<S, T> + ?Sized>(
    trace: &Trace<S, N, T>,
    quadrature: &Q,
    mut visit: impl FnMut(&[usize], &[T], &Vector<N, T>, &Vector<N, T>, T),
) {
    let (mut ids, mut shapes, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    for e in 0..trace.space.num_elements() {
        let rule = quadrature.rule(e);
        trace.space.active(e, &mut ids);
        trace.space.evaluate(e, &rule.points, Order::Gradients, &mut shapes, &mut map);
        for (q, &w) in rule.weights.iter().enumerate() {
            let jacobian = &map.jacobian[q];
            visit(&ids, shapes.values(q), &map.x[q], &trace.normal(e, jacobian), w * stretch(jacobian));
        }
    }
}

/// Length, area or volume of a space by a given rule: a resultant divided by it and applied by the same rule is met exactly.
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
