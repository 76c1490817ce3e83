//! Curved sides that carry one surface, whose grids have nothing in common but the rim.

use crate::common::{Measured, Patch, Shape, measured, one};
use faying::coupling::interface::{MergedSurface, Tolerance};
use std::f64::consts::FRAC_PI_2;

pub const SHAPES: [Shape; 5] =
    [Shape::Plane, Shape::Wave(0.15), Shape::Cylinder(0.8, FRAC_PI_2), Shape::Sphere(1.0, FRAC_PI_2), Shape::Torus([1.5, 0.6], 1.2)];

/// Two grids on one surface, the master's lines bent in the parameters.
fn pair(shape: Shape, kinds: [bool; 2], n: [usize; 2], points: usize, p: usize) -> Measured {
    let slave = Patch::grid(shape, [n[0], n[0]], kinds[0], |a, b| [a, b]).warped(-0.05).moved(0.4, [0.2, -0.3, 0.7]);
    let master = Patch::grid(shape, [n[1], n[1] + 1], kinds[1], |a, b| [a, b]).warped(0.08).moved(0.4, [0.2, -0.3, 0.7]);
    measured(&MergedSurface::tied(points, Tolerance::Exact), [&slave, &master], p, &one).unwrap()
}

#[test]
fn both_columns_and_tilings_on_one_surface() {
    for shape in SHAPES {
        for kinds in [[false, false], [false, true], [true, false], [true, true]] {
            let found = pair(shape, kinds, [4, 5], 8, 2);
            assert_eq!(found.open, 0, "{shape:?} {kinds:?}: {found:?}");
            assert!(found.tiling < 1e-11 && found.outside < 1e-6, "{shape:?} {kinds:?}: {found:?}");
            assert!(found.master < 1e-10 && found.slave < 1e-10, "{shape:?} {kinds:?}: {found:?}");
        }
    }
}
