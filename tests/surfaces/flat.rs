//! Flat sides: every number is exact to rounding.

use crate::common::{Patch, Shape, measured, one};
use faying::coupling::InterfaceQuadrature;
use faying::coupling::interface::{MergedSurface, Tolerance};

/// A square of parameters about the centre of the unit square, turned by `degrees`, its sides `size` long.
fn turned(degrees: f64, size: f64) -> impl Fn(f64, f64) -> [f64; 2] {
    let (s, c) = degrees.to_radians().sin_cos();
    move |a, b| {
        let (x, y) = ((a - 0.5) * size, (b - 0.5) * size);
        [0.5 + c * x - s * y, 0.5 + s * x + c * y]
    }
}

fn rule(p: usize) -> MergedSurface {
    MergedSurface::tied(p + 1, Tolerance::Exact)
}

#[test]
fn a_slave_that_covers_a_turned_master_gives_its_columns_exactly() {
    for degrees in [0.0, 17.0, 45.0] {
        for kinds in [[false, false], [false, true], [true, false], [true, true]] {
            for p in 1..=3 {
                // the slave's columns are products of p and p
                let slave = Patch::grid(Shape::Plane, [7, 6], kinds[0], turned(0.0, 1.7)).moved(0.7, [1.0, 2.0, 3.0]);
                let master = Patch::grid(Shape::Plane, [5, 4], kinds[1], turned(degrees, 1.0)).moved(0.7, [1.0, 2.0, 3.0]);
                let found = measured(&rule(p), [&slave, &master], p, &one).unwrap();
                assert!(found.tiling < 1e-12 && found.master < 1e-12, "{degrees} {kinds:?} {p}: {found:?}");
                assert!(found.distance < 1e-14 && found.outside < 1e-12, "{degrees} {kinds:?} {p}: {found:?}");
            }
        }
    }
}

#[test]
fn a_master_that_covers_the_slave_tiles_every_slave_element() {
    for degrees in [0.0, 17.0, 45.0] {
        for kinds in [[false, false], [false, true], [true, false], [true, true]] {
            let slave = Patch::grid(Shape::Plane, [7, 6], kinds[0], turned(0.0, 1.0)).moved(-0.4, [0.0, 0.5, 0.0]);
            let master = Patch::grid(Shape::Plane, [9, 8], kinds[1], turned(degrees, 1.7)).moved(-0.4, [0.0, 0.5, 0.0]);
            // total degree 2p of a product of p and p on squares
            let p = 2;
            let points = if kinds[0] { p } else { 2 * p };
            let segments = rule(points).segments(&slave, &master).unwrap();
            assert!(segments.report.share.iter().all(|&s| s == 1.0));
            let found = measured(&rule(points), [&slave, &master], p, &one).unwrap();
            assert_eq!(found.open, 0);
            assert!(found.tiling < 1e-12 && found.slave < 1e-12, "{degrees} {kinds:?}: {found:?}");
        }
    }
}

#[test]
fn squares_with_other_numbers_of_elements_and_moved_vertices_have_both_columns() {
    for kinds in [[false, false], [false, true], [true, false], [true, true]] {
        for ([n, m], by) in [([4, 4], 0.0), ([5, 3], 0.0), ([5, 4], 0.03), ([12, 11], 0.01)] {
            let slave = Patch::grid(Shape::Plane, [4, 4], kinds[0], |a, b| [a, b]).shaken(by, 3);
            let master = Patch::grid(Shape::Plane, [n, m], kinds[1], |a, b| [a, b]).shaken(by, 7);
            let points = if by > 0.0 { 10 } else { 3 };
            let found = measured(&rule(points), [&slave, &master], 2, &one).unwrap();
            assert_eq!(found.open, 0);
            assert!(found.tiling < 1e-12 && found.slave < 1e-12, "{kinds:?} {n} {m} {by}: {found:?}");
            // moved quadrilaterals are no parallelograms: the inverse of their map is no polynomial
            let limit = if by > 0.0 && !kinds[1] { 1e-9 } else { 1e-12 };
            assert!(found.master < limit, "{kinds:?} {n} {m} {by}: {found:?}");
        }
    }
}

#[test]
fn equal_grids_have_one_piece_per_element() {
    for triangles in [false, true] {
        let side = Patch::grid(Shape::Plane, [6, 5], triangles, |a, b| [a, b]).moved(0.3, [10.0, 0.0, 0.0]);
        let found = measured(&rule(2), [&side, &side], 2, &one).unwrap();
        assert_eq!(found.pieces, if triangles { 60 } else { 30 });
        assert!(found.tiling < 1e-13, "{found:?}");
    }
}
