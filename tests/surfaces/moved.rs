//! Vertices that nearly coincide, and cells of very different sizes.

use crate::common::{Patch, Shape, measured, one};
use crate::curved::SHAPES;
use faying::coupling::CouplingError;
use faying::coupling::interface::{MergedSurface, Tolerance};

/// Vertices moved from the coincidence of rounding to a tenth of a cell. Cells that are cut by slivers of 1e-12 of their size may have no rule with positive weights: they are refused, one pair of these, and never lose a part in silence.
#[test]
fn vertices_moved_by_any_share_of_a_cell_tile() {
    let mut refused = 0;
    for shape in SHAPES {
        for kinds in [[false, false], [false, true], [true, false], [true, true]] {
            for power in [None, Some(16), Some(15), Some(14), Some(13), Some(12), Some(10), Some(8), Some(6), Some(4), Some(2), Some(1)] {
                let by = power.map_or(0.0, |k| 0.25 * 10f64.powi(-k));
                let slave = Patch::grid(shape, [4, 4], kinds[0], |a, b| [a, b]).moved(0.4, [0.2, -0.3, 0.7]);
                let master = Patch::grid(shape, [4, 4], kinds[1], |a, b| [a, b]).shaken(by, 5).moved(0.4, [0.2, -0.3, 0.7]);
                for sides in [[&slave, &master], [&master, &slave]] {
                    match measured(&MergedSurface::tied(9, Tolerance::Exact), sides, 1, &one) {
                        Ok(found) => {
                            assert!(found.open == 0 && found.tiling < 1e-11, "{shape:?} {kinds:?} {by:e}: {found:?}");
                            assert!(found.slave < 1e-9 && found.master < 1e-9, "{shape:?} {kinds:?} {by:e}: {found:?}");
                        }
                        Err(CouplingError::Lost { .. }) => refused += 1,
                        Err(other) => panic!("{shape:?} {kinds:?} {by:e}: {other:?}"),
                    }
                }
            }
        }
    }
    assert!(refused <= 1, "{refused} pairs are refused");
}

/// One cell on a thousand strips, and the other way round. With `FAYING_MERGING` on all surfaces.
#[test]
fn cells_a_thousand_times_as_long_tile() {
    let shapes = [Shape::Wave(0.15), Shape::Cylinder(1.0, 0.8), Shape::Plane, Shape::Sphere(1.0, 0.8)];
    for shape in shapes.into_iter().take(if std::env::var("FAYING_MERGING").is_ok() { 4 } else { 2 }) {
        for kinds in [[false, false], [true, true]] {
            let one_cell = Patch::grid(shape, [1, 1], kinds[0], |a, b| [a, b]);
            let strips = Patch::grid(shape, [1000, 1], kinds[1], |a, b| [a, b]);
            for sides in [[&one_cell, &strips], [&strips, &one_cell]] {
                let found = measured(&MergedSurface::tied(8, Tolerance::Exact), sides, 1, &one).unwrap();
                assert!(found.open == 0 && found.tiling < 1e-11, "{shape:?} {kinds:?}: {found:?}");
                assert!(found.slave < 1e-9 && found.master < 1e-9, "{shape:?} {kinds:?}: {found:?}");
            }
        }
    }
}
