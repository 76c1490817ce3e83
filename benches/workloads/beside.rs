//! What stands beside the matrix: products with and without it, loads, norms of errors, stresses, terms on sides.

use crate::bodies::Jet;
use crate::measure::{Time, median, timed};
use faying::assembly::{Form, MatrixFree, errors, gauss_rules, load, trace_load, trace_springs};
use faying::linalg::{Csr, Matrix, Operator, Vector};
use faying::physics::{Material, Stress, form, stresses};
use faying::quadrature::Quadrature;
use faying::space::Body;
use std::hint::black_box;

/// Times of one product with the matrix, of one without it, of the load and of the norms; of the closures that these two ask,
/// at as many points; of the stress at the points of every element, and of a traction and springs on every side.
#[derive(Clone, Copy, Debug)]
pub struct Beside {
    pub product: Time,
    pub apply: Time,
    pub load: Time,
    pub errors: Time,
    pub force: Time,
    pub field: Time,
    pub stress: Time,
    pub traction: Time,
    pub springs: Time,
}

/// The median over `reps` of `work`, which warms up once.
fn times<R>(reps: usize, mut work: impl FnMut() -> R) -> Time {
    let all: Vec<Time> = (0..=reps).map(|_| timed(&mut work).1).collect();
    median(&all[1..])
}

/// Measures on `body`; load and norms are those of `exact`.
pub fn beside<const C: usize, const S: usize, const N: usize>(
    body: &dyn Body<S, N>,
    material: &dyn Material<C, N>,
    k: &Csr,
    exact: fn(&Vector<N>) -> Jet<C, N>,
    reps: usize,
) -> Beside {
    let space = &**body.space();
    let (rules, more, stiffness): (_, _, Form<'_, C, N>) = (gauss_rules(space, 0), gauss_rules(space, 1), form(material).unwrap());
    let free = MatrixFree::new(space, &rules, &stiffness);
    let x: Vec<f64> = (0..k.num_rows()).map(|i| (0.1 * i as f64).sin()).collect();
    let mut y = vec![0.0; x.len()];
    let f = |x: &Vector<N>| {
        let (_, gradient, hessian) = exact(x);
        -material.divergence(x, &gradient, &hessian)
    };
    let field = |x: &Vector<N>| {
        let (value, gradient, _) = exact(x);
        (value, gradient)
    };
    // places inside the body, as many as points of a rule
    let count = |rules: &dyn Quadrature<N>| (0..space.num_elements()).map(|e| rules.rule(e).points.len()).sum::<usize>();
    let place = |k: usize| Vector::<N>::from_fn(|c, _| 0.9 + 0.1 * ((k >> (4 * c)) % 16) as f64);
    let (few, many) = (count(&rules), count(&more));
    let stress = || {
        let of = |_: usize, points: &[Stress<C, N>]| points.iter().map(|s| s.spatial[0]).sum::<f64>();
        stresses(space, &rules, material, &x, &of)
    };
    let traces: Vec<_> = body.sides().iter().map(|side| body.trace(side).unwrap()).collect();
    let sides: Vec<_> = traces.iter().map(|trace| (trace, gauss_rules(&*trace.space, 0))).collect();
    let (mut loads, mut held) = (vec![0.0; x.len()], k.clone());
    let traction = times(reps, || {
        for (trace, rules) in &sides {
            trace_load::<C, S, N, _, _>(trace, rules, &|x, n| Vector::from_fn(|c, _| x[c % N] * n[c % N]), &mut loads);
        }
    });
    let springs = times(reps, || {
        for (trace, rules) in &sides {
            trace_springs::<C, S, N, _, _>(trace, rules, &|x, _| Matrix::<C, C>::identity() * x[0], &mut held);
        }
    });
    Beside {
        stress: times(reps, || black_box(stress())),
        traction,
        springs,
        force: times(reps, || black_box((0..few).fold(Vector::<C>::zeros(), |s, k| s + f(&place(k))))),
        field: times(reps, || black_box((0..many).fold(0.0, |s, k| s + field(&place(k)).1[(0, 0)]))),
        product: times(reps, || k.apply(&x, &mut y)),
        apply: times(reps, || free.apply(&x, &mut y)),
        load: times(reps, || load::<C, N, N, _, _, _>(space, &rules, &f)),
        errors: times(reps, || errors(space, &more, &stiffness, &x, &field)),
    }
}
