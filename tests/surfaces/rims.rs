//! Curved rims of both sides that are one curve.

use crate::common::{Patch, Shape, measured, one};
use faying::coupling::interface::{MergedSurface, Tolerance};

/// Rings and discs about one axis, turned against each other: elements of one side end within those of the other along the rims.
#[test]
fn curved_rims_that_coincide_are_one_line_whatever_their_elements() {
    for radii in [[0.5, 1.0], [10.0, 20.0], [0.0, 1.0]] {
        for (n, m) in [(4, 6), (6, 4), (12, 7), (12, 12), (8, 40), (40, 9)] {
            for degrees in [0.0f64, 1e-7, 3.0, 17.0, 30.0, 45.0] {
                let slave = Patch::grid(Shape::Ring(radii), [n, 1], false, |a, b| [a, b]);
                let (s, c) = degrees.to_radians().sin_cos();
                let mut master = Patch::grid(Shape::Ring(radii), [m, 2], false, |a, b| [a, b]);
                master.turn = faying::linalg::Matrix::<3, 3>::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
                let found = measured(&MergedSurface::tied(8, Tolerance::Local), [&slave, &master], 2, &one).unwrap();
                assert!(found.open == 0 && found.lost == 0, "{radii:?} {n} {m} {degrees}: {found:?}");
                assert!(found.tiling < 1e-9, "{radii:?} {n} {m} {degrees}: {found:?}");
            }
        }
    }
}
