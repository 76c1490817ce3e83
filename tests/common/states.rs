//! A field and its stress at the points of all elements, beside a look at each of them.
#![allow(dead_code)]

use faying::assembly::{fields, gauss_rules};
use faying::linalg::{Matrix, Vector};
use faying::physics::{Hooke, Stress, stress_at, stresses};
use faying::quadrature::Quadrature;
use faying::space::{Field, FieldAt, Space, field_at};

/// Numbers between -1 and 1 without an order.
fn noise(k: usize) -> f64 {
    (78.233 * k as f64 + 12.9898).sin()
}

/// Asserts that positions, values and gradients of a field are those of each element to 1e-13 of the largest (gradients
/// 1e-12: the Jacobian is inverted), element after element, with the same bits for any number of threads.
pub fn states_are_those_of_each_element<const C: usize, const N: usize>(space: &dyn Space<N, N>, rules: &dyn Quadrature<N>) {
    let u: Vec<f64> = (0..C * space.num_functions()).map(noise).collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fields::<C, N, f64, _, _, _>(space, rules, &u, &|e, states: &[FieldAt<C, N>]| (e, states.to_vec())))
    };
    let all = run(1);
    assert!(all.iter().enumerate().all(|(k, (e, _))| k == *e) && all.len() == space.num_elements(), "every element, ascending");
    assert!(run(3) == all, "the same bits for any number of threads");
    let of_nothing = fields::<C, N, f64, _, _, _>(space, rules, &[], &|_, states: &[FieldAt<C, N>]| states.to_vec());
    for (state, nothing) in all.iter().flat_map(|(_, states)| states).zip(of_nothing.iter().flatten()) {
        assert!(nothing.value == Vector::<C>::zeros() && nothing.gradient == Matrix::<C, N>::zeros(), "an empty field is zero");
        assert!((nothing.x - state.x).amax() == 0.0, "where the other one is");
    }
    assert_eq!(of_nothing.iter().map(Vec::len).sum::<usize>(), all.iter().map(|(_, states)| states.len()).sum::<usize>());
    let (mut apart, mut most) = ([0.0f64; 3], [0.0f64; 3]);
    for (e, states) in &all {
        let own = field_at::<C, N, f64, _>(space, &Field { first: 0, components: C }, &u, *e, &rules.rule(*e).points);
        assert_eq!(own.len(), states.len());
        for (a, b) in states.iter().zip(&own) {
            let sizes = [
                ((a.x - b.x).amax(), b.x.amax()),
                ((a.value - b.value).amax(), b.value.amax()),
                ((a.gradient - b.gradient).amax(), b.gradient.amax()),
            ];
            for (k, (difference, size)) in sizes.into_iter().enumerate() {
                assert!(difference.is_finite() && size.is_finite());
                (apart[k], most[k]) = (apart[k].max(difference), most[k].max(size));
            }
        }
    }
    for (k, allowed) in [1e-13, 1e-13, 1e-12].into_iter().enumerate() {
        assert!(apart[k] <= allowed * most[k], "number {k} is apart by {:e} of {:e}", apart[k], most[k]);
    }
}

/// The stresses of all elements are those of each to 1e-12 of the largest.
pub fn stresses_are_those_of_each_element<const N: usize>(space: &dyn Space<N, N>, steel: &Hooke<N>) {
    let rules = gauss_rules(space, 0);
    let u: Vec<f64> = (0..N * space.num_functions()).map(|k| (0.7 * k as f64).sin()).collect();
    let all = stresses(space, &rules, steel, &u, &|_, own: &[Stress<N, N>]| own.to_vec());
    let one = |e: usize| stress_at(space, steel, &u, e, &rules.rule(e).points);
    let numbers = |all: Vec<Stress<N, N>>| all.into_iter().flat_map(|s| s.stress.iter().copied().chain(s.spatial).collect::<Vec<f64>>());
    let expected: Vec<f64> = (0..space.num_elements()).flat_map(|e| numbers(one(e))).collect();
    let found: Vec<f64> = all.into_iter().flat_map(numbers).collect();
    assert_eq!(found.len(), expected.len());
    let most = expected.iter().fold(0.0f64, |m, s| m.max(s.abs()));
    for (a, b) in found.iter().zip(&expected) {
        assert!((a - b).abs() <= 1e-12 * most, "{a:e} for {b:e}, the largest is {most:e}");
    }
}
