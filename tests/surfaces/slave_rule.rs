//! The slave rule of surfaces: own Gauss points with their closest points on the master.

use crate::common::{Patch, Shape};
use crate::gaps::lifted;
use faying::basis::{Cell, Elements, Order};
use faying::coupling::interface::{MergedSurface, SlaveSurface, Tolerance};
use faying::coupling::{InterfaceQuadrature, Segments};
use faying::geometry::shapes::brick;
use faying::geometry::{ClosestPoint, Geometry, MapTable};
use faying::linalg::Vector;
use faying::space::{Body, Mesh, PatchSpec};

fn places(patch: &Patch, element: usize, xi: &[Vector<2>]) -> Vec<Vector<3>> {
    let mut table = MapTable::new();
    patch.map(element, xi, Order::Values, &mut table);
    table.x.clone()
}

/// Places of all points on both sides.
fn partners(segments: &Segments<2>, slave: &Patch, master: &Patch) -> Vec<[Vector<3>; 2]> {
    let pairs = (0..segments.num_pieces()).flat_map(|piece| {
        let q = segments.points(piece);
        let own = places(slave, segments.slave[piece], &segments.slave_xi[q.clone()]);
        own.into_iter().zip(places(master, segments.master[piece], &segments.master_xi[q])).map(|(a, b)| [a, b])
    });
    pairs.collect()
}

#[test]
fn every_point_has_its_closest_point() {
    for kinds in [[false, false], [false, true], [true, false], [true, true]] {
        for gap in [0.0, 0.02, 0.3] {
            let slave = Patch::grid(Shape::Plane, [5, 4], kinds[0], |a, b| [a - 0.5, b - 0.5]).moved(0.0, [0.0, 0.0, 1.0 + gap]);
            let master = Patch::grid(Shape::Sphere(1.0, 2.4), [6, 5], kinds[1], |a, b| [a, b]).warped(0.06);
            let segments = SlaveSurface::facing(4, None).segments(&slave, &master).unwrap();
            let what = format!("{kinds:?} {gap}");
            assert!(segments.report.share.iter().all(|&s| s == 1.0) && segments.report.lost.is_empty(), "{what}: {:?}", segments.report);
            assert!((segments.measure() - 1.0).abs() < 1e-13 && segments.report.outside < 1e-9, "{what}: {:?}", segments.report);
            for [x, foot] in partners(&segments, &slave, &master) {
                assert!((foot - x.normalize()).norm() < 1e-13, "{what}: {x:?} {foot:?}");
            }
            if !kinds[0] {
                assert_eq!(segments.ds.len(), 20 * 16, "{what}: Gauss points of the cells and no others");
            }
        }
    }
}

/// Cells that the master's rim crosses take regions of merged integration, all others their own Gauss points.
#[test]
fn what_is_covered_is_integrated_and_no_more() {
    for (degrees, shift, expected) in [(0.0, 0.3, 0.7), (45.0, 0.0, 2.0 * (2f64.sqrt() - 1.0))] {
        for gap in [0.0, 0.1] {
            for kinds in [[false, false], [true, true]] {
                let (s, c) = f64::to_radians(degrees).sin_cos();
                let slave = Patch::grid(Shape::Plane, [4, 3], kinds[0], |a, b| [a, b]).moved(0.0, [0.0, 0.0, gap]);
                let master = Patch::grid(Shape::Plane, [3, 5], kinds[1], |a, b| {
                    let (x, y) = (a - 0.5, b - 0.5);
                    [0.5 + shift + c * x - s * y, 0.5 + s * x + c * y]
                });
                let segments = SlaveSurface::facing(3, None).segments(&slave, &master).unwrap();
                let merged = MergedSurface::facing(3, None).segments(&slave, &master).unwrap();
                let what = format!("{degrees} {gap} {kinds:?}");
                assert!((segments.report.covered - expected).abs() < 1e-12, "{what}: {:?}", segments.report);
                assert!((segments.measure() - expected).abs() < 1e-12 && segments.report.lost.is_empty(), "{what}");
                assert!(segments.report.share.iter().zip(&merged.report.share).all(|(a, b)| (a - b).abs() < 1e-12), "{what}");
                let whole = (0..slave.num_elements()).filter(|&e| segments.report.share[e] == 1.0).count();
                let counts = |e: usize| {
                    let own = (0..segments.num_pieces()).filter(|&piece| segments.slave[piece] == e);
                    own.map(|piece| segments.points(piece).len()).sum::<usize>()
                };
                let least = (0..slave.num_elements()).filter(|&e| segments.report.share[e] == 1.0).map(counts).max();
                assert!(whole > 0 && least <= Some(9), "{what}: whole cells have their own points only: {least:?}");
            }
        }
    }
}

/// Above a ridge the points whose closest point lies on it are halved between its faces; in a valley they are as near to both.
#[test]
fn the_fan_of_a_kink_is_halved() {
    for height in [0.2, -0.2] {
        let master = lifted(&|p: [f64; 2]| height * (1.0 - 2.0 * (p[0] - 0.5).abs()));
        let slave =
            Patch::grid(Shape::Plane, [3, 5], false, |a, b| [0.3 + 0.4 * a, 0.3 + 0.4 * b]).moved(0.0, [0.0, 0.0, height.max(0.0) + 0.1]);
        let segments = SlaveSurface::facing(6, None).segments(&slave, &master).unwrap();
        assert!((segments.measure() - 0.16).abs() < 1e-14, "{:?}", segments.report);
        let slope = Vector::<3>::new(2.0 * height, 0.0, 0.0);
        let (mut q, mut fan) = (0, 0);
        for piece in 0..segments.num_pieces() {
            let middle = places(&master, segments.master[piece], &[Vector::<2>::new(1.0 / 3.0, 1.0 / 3.0)])[0];
            for [x, foot] in &partners(&segments, &slave, &master)[q..q + segments.points(piece).len()] {
                assert!((x[0] < 0.5) == (middle[0] < 0.5), "{height}: {x:?} is paired with the face about {middle:?}");
                // the foot lies on the plane of the face, along its normal
                let normal = Vector::<3>::new(if x[0] < 0.5 { -slope[0] } else { slope[0] }, 0.0, 1.0).normalize();
                assert!((x - foot).cross(&normal).norm() < 1e-13, "{height}: {x:?} {foot:?}");
                fan += usize::from((x[0] < 0.5) != (foot[0] < 0.5));
            }
            q += segments.points(piece).len();
        }
        assert!(height < 0.0 || fan > 0, "some points lie in the fan of the ridge");
    }
}

/// Poles, seams and both orientations: points of tied sides coincide with their partners, whatever the cells.
#[test]
fn tied_points_coincide_also_at_poles() {
    for shape in [Shape::Cap(1.0, 1.2), Shape::Cylinder(1.0, 2.0 * std::f64::consts::PI), Shape::Torus([1.5, 0.5], 1.4), Shape::Wave(0.2)] {
        for triangles in [false, true] {
            if triangles && matches!(shape, Shape::Cap(..)) {
                continue;
            }
            let slave = Patch::grid(shape, [6, 5], triangles, |a, b| [a, b]);
            let master = Patch::grid(shape, [8, 3], triangles, |a, b| [a, b]);
            let segments = SlaveSurface::tied(3, Tolerance::Exact).segments(&slave, &master).unwrap();
            assert!(segments.report.share.iter().all(|&s| s == 1.0), "{shape:?} {triangles}: {:?}", segments.report);
            let apart = partners(&segments, &slave, &master).iter().map(|[a, b]| (a - b).norm()).fold(0.0, f64::max);
            assert!(apart < 1e-12 && segments.report.outside < 1e-9, "{shape:?} {triangles}: {apart:e} {:?}", segments.report);
        }
    }
}

#[test]
fn the_slave_rule_has_the_same_bits_at_any_number_of_threads() {
    let slave = Patch::grid(Shape::Sphere(1.1, 1.4), [5, 5], true, |a, b| [a, b]);
    let master = Patch::grid(Shape::Sphere(1.0, 1.2), [6, 4], false, |a, b| [a, b]).warped(0.07);
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| SlaveSurface::facing(3, None).segments(&slave, &master).unwrap())
    };
    assert!(of(2) == of(1));
}

/// Points beyond the rim of a side of triangles, also where the closest one is a vertex of a triangle that has no edge on the rim.
#[test]
fn all_points_beyond_a_rim_of_triangles_are_known() {
    let spec = PatchSpec::new(brick([0.0; 3], [1.0, 0.7, 1.0]).unwrap()).with_elements([2, 2, 1]).with_cells(Cell::Simplex);
    let side = Mesh::from_patch(&spec).unwrap().trace("w1").unwrap();
    let closest = ClosestPoint::<2, 3, _>::new(&*side.space);
    let line = [-0.2, 0.0, 0.1, 0.25, 0.5, 0.7, 1.0, 1.1];
    for (x, y) in line.iter().flat_map(|&x| [-0.1, 0.0, 0.35, 0.5, 0.7, 0.9].map(|y| (x, y))) {
        for z in [1.0, 1.1, 0.8] {
            let foot = closest.project(&Vector::<3>::new(x, y, z)).unwrap();
            let beyond = !(0.0..=1.0).contains(&x) || !(0.0..=0.7).contains(&y);
            assert_eq!(foot.rim, beyond, "{x} {y} {z}: {foot:?}");
        }
    }
}
