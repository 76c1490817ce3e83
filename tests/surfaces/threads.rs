//! The same bits at any number of threads.

use crate::common::{Patch, Shape};
use faying::coupling::InterfaceQuadrature;
use faying::coupling::interface::{MergedSurface, Tolerance};

#[test]
fn segments_have_the_same_bits_at_any_number_of_threads() {
    let slave = Patch::grid(Shape::Sphere(1.0, 1.4), [5, 5], true, |a, b| [a, b]);
    let master = Patch::grid(Shape::Sphere(1.0, 1.4), [6, 4], false, |a, b| [a, b]).warped(0.07);
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| MergedSurface::tied(3, Tolerance::Exact).segments(&slave, &master).unwrap())
    };
    let one = of(1);
    for threads in [2, 16] {
        assert!(of(threads) == one, "{threads} threads");
    }
}
