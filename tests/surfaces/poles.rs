//! Cells that collapse to a point, and surfaces that close on themselves.

use crate::common::{Patch, Shape, measured, one};
use faying::coupling::interface::{MergedSurface, Tolerance};
use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn both_sides_in_one_pole() {
    for (n, m) in [([2, 2], [3, 3]), ([4, 4], [6, 6]), ([1, 1], [5, 3]), ([8, 8], [12, 12])] {
        for (gap, warp) in [(0.0, 0.0), (0.0, 0.06), (0.1, 0.0), (-0.2, 0.0)] {
            let slave = Patch::grid(Shape::Cap(1.0 + gap, FRAC_PI_2), n, false, |a, b| [a, b]);
            let master = Patch::grid(Shape::Cap(1.0, FRAC_PI_2), m, false, |a, b| [a, b]).warped(warp);
            let stretch = (1.0f64 + gap).powi(2);
            // cells of 45 and 90 degrees whose lines are bent need more points
            let points = if warp > 0.0 { 10 } else { 8 };
            let rule = if gap == 0.0 { MergedSurface::tied(points, Tolerance::Exact) } else { MergedSurface::facing(points, None) };
            let found = measured(&rule, [&slave, &master], 2, &|_| stretch).unwrap();
            assert!(found.open == 0 && found.tiling < 1e-11, "{n:?} {m:?} {gap} {warp}: {found:?}");
            assert!(found.slave < 1e-10 && found.master < 1e-10, "{n:?} {m:?} {gap} {warp}: {found:?}");
        }
    }
}

#[test]
fn a_pole_inside_of_a_cell_of_the_other_side() {
    // a cap of 30 degrees about a pole that lies in a cell of a patch of 60 degrees, or at one of its vertices
    for n in [3, 4] {
        let patch = Patch::grid(Shape::Sphere(1.0, PI / 3.0 * 1.4), [n, n], false, |a, b| [a, b]);
        let cap = Patch::grid(Shape::Cap(1.0, PI / 6.0), [2, 2], false, |a, b| [a, b]);
        let found = measured(&MergedSurface::tied(10, Tolerance::Exact), [&patch, &cap], 2, &one).unwrap();
        assert!(found.tiling < 1e-11 && found.master < 1e-9, "{n}: {found:?}");
        let found = measured(&MergedSurface::tied(10, Tolerance::Exact), [&cap, &patch], 2, &one).unwrap();
        assert!(found.open == 0 && found.tiling < 1e-11 && found.slave < 1e-9, "{n}: {found:?}");
    }
}

#[test]
fn closed_cylinders_have_no_seam() {
    for kinds in [[false, false], [false, true], [true, true]] {
        for degree in [0, 2, 1] {
            let slave = Patch::grid(Shape::Cylinder(1.0, 2.0 * PI), [12, 2], kinds[0], |a, b| [a, b]);
            let mut master = Patch::grid(Shape::Cylinder(1.0, 2.0 * PI), [17, 3], kinds[1], |a, b| [a, b]).facets(degree);
            let (s, c) = 0.3f64.sin_cos();
            master.turn = faying::linalg::Matrix::<3, 3>::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c);
            let rule = MergedSurface::tied(8, Tolerance::Local);
            let found = measured(&rule, [&slave, &master], 2, &one).unwrap();
            assert!(found.open == 0 && found.tiling < 1e-11, "{kinds:?} {degree}: {found:?}");
            assert!(found.slave < 1e-10, "{kinds:?} {degree}: {found:?}");
            assert!(degree > 0 || found.master < 1e-10, "{kinds:?} {degree}: {found:?}");
        }
    }
}

#[test]
fn one_cell_around_a_cylinder_is_cut() {
    let slave = Patch::grid(Shape::Cylinder(1.0, 2.0 * PI), [1, 1], false, |a, b| [a, b]);
    let master = Patch::grid(Shape::Cylinder(1.0, 2.0 * PI), [1, 2], false, |a, b| [a, b]);
    let found = measured(&MergedSurface::tied(8, Tolerance::Exact), [&slave, &master], 2, &one).unwrap();
    assert!(found.open == 0 && found.tiling < 1e-11 && found.slave < 1e-10 && found.master < 1e-10, "{found:?}");
}
