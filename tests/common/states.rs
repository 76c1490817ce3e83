//! A field at the points of all elements, beside a look at each of them.

use faying::assembly::fields;
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
