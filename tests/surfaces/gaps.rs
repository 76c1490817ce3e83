//! Sides apart: partners are the closest points of the master, so sums over its functions are known in closed form.

use crate::common::{Patch, Shape, measured};
use faying::coupling::InterfaceQuadrature;
use faying::coupling::interface::MergedSurface;
use faying::linalg::Vector;

fn facing(points: usize) -> MergedSurface {
    MergedSurface::facing(points, None)
}

#[test]
fn columns_across_gaps_are_those_of_the_closed_forms() {
    let gaps = [-0.3, -0.1, 0.02, 0.1, 0.4];
    for kinds in [[false, false], [false, true], [true, false], [true, true]] {
        for gap in gaps {
            // concentric spheres and coaxial cylinders: measures are as the squares of the radii, and as the radii
            let cases: [(Shape, Shape, f64); 3] = [
                (Shape::Sphere(1.0 + gap, 1.9), Shape::Sphere(1.0, 1.3), (1.0 + gap).powi(2)),
                (Shape::Cylinder(1.0 + gap, 1.9), Shape::Cylinder(1.0, 1.3), 1.0 + gap),
                (Shape::Torus([1.5, 0.5 + gap * 0.5], 1.5), Shape::Torus([1.5, 0.5], 1.0), f64::NAN),
            ];
            for (slave, master, stretch) in cases {
                let slave = Patch::grid(slave, [5, 5], kinds[0], |a, b| [a, b]).warped(0.05);
                let master = Patch::grid(master, [4, 5], kinds[1], |a, b| [a, b]).warped(-0.08);
                let torus = |x: &Vector<3>| {
                    // the distance from the axis tells the angle about the tube
                    let cosine = ((x[0].hypot(x[2]) - 1.5) / 0.5).clamp(-1.0, 1.0);
                    (1.0 + gap) * (1.5 + (0.5 + 0.5 * gap) * cosine) / (1.5 + 0.5 * cosine)
                };
                let of = |x: &Vector<3>| if stretch.is_nan() { torus(x) } else { stretch };
                let found = measured(&facing(8), [&slave, &master], 2, &of).unwrap();
                assert!(found.tiling < 1e-11, "{:?} {kinds:?} {gap}: {found:?}", slave.shape);
                assert!(found.master < 1e-9, "{:?} {kinds:?} {gap}: {found:?}", slave.shape);
                assert!(found.outside < 1e-6, "{:?} {kinds:?} {gap}: {found:?}", slave.shape);
            }
        }
    }
}

#[test]
fn a_flat_slave_above_a_sphere_has_the_columns_of_its_closest_points() {
    for kinds in [[false, false], [true, true]] {
        for gap in [0.0, 0.2, 0.4] {
            // a plane at the height h = 1 + gap faces the solid angle dω by h² / cos³ dω
            let h = 1.0 + gap;
            let slave =
                Patch::grid(Shape::Plane, [8, 8], kinds[0], |a, b| [3.0 * h * (a - 0.5), 3.0 * h * (b - 0.5)]).moved(0.0, [0.0, 0.0, h]);
            let master = Patch::grid(Shape::Sphere(1.0, 1.2), [4, 5], kinds[1], |a, b| [a, b]).warped(-0.06);
            let found = measured(&facing(9), [&slave, &master], 2, &|x| h * h / x[2].powi(3)).unwrap();
            assert!(found.tiling < 1e-11 && found.master < 1e-9, "{kinds:?} {gap}: {found:?}");
        }
    }
}

/// Points are paired up to 60 degrees between the normals: the corners of a plane on a sphere of radius 1 are 58 degrees off, those of a
/// piece of a sphere over a plane 54.
#[test]
fn slanted_elements_that_are_opposed_are_tiled() {
    for kinds in [[false, false], [false, true], [true, false], [true, true]] {
        for (n, gap) in [([3, 3], 0.0), ([5, 4], 0.1), ([9, 8], 0.0)] {
            for outward in [None, Some(1.0)] {
                let with = |mut patch: Patch, sign: f64| {
                    patch.outward = outward.map(|o| o * sign);
                    patch
                };
                let plane = |width: f64, n, kind| Patch::grid(Shape::Plane, n, kind, |a, b| [width * (a - 0.5), width * (b - 0.5)]);
                let half = 1.15 * (1.0 + gap);
                let above = with(plane(2.0 * half, n, kinds[0]).moved(0.0, [0.0, 0.0, 1.0 + gap]), -1.0);
                let ball = with(Patch::grid(Shape::Sphere(1.0, 2.7), [9, 10], kinds[1], |a, b| [a, b]), 1.0);
                let dome = with(Patch::grid(Shape::Sphere(1.0, 1.4), n, kinds[0], |a, b| [a, b]), 1.0);
                let sheet = with(plane(4.0, [6, 5], kinds[1]).moved(0.0, [0.0, 0.0, 1.0 + gap]), -1.0);
                for (slave, master) in [(&above, &ball), (&dome, &sheet)] {
                    let found = measured(&facing(6), [slave, master], 1, &|_| 1.0).unwrap();
                    let what = format!("{:?} {kinds:?} {n:?} {gap} {outward:?}: {found:?}", slave.shape);
                    assert!(found.open == 0 && found.tiling < 1e-11 && found.outside < 1e-6, "{what}");
                    let farthest = match slave.shape {
                        Shape::Plane => (2.0 * half * half + (1.0 + gap).powi(2)).sqrt() - 1.0,
                        _ => 1.0 + gap - 0.7f64.cos().powi(2),
                    };
                    assert!(found.distance < farthest + 1e-12 && found.distance > 0.9 * farthest, "{farthest} {what}");
                }
            }
        }
    }
}

/// Above a ridge between a flat face and one that is 65 degrees off, the half of the fan that belongs to the steep face finds no partner that
/// opposes it, though the ridge is the closest point there: what is not covered is told.
#[test]
fn a_part_of_a_fan_without_a_partner_is_told() {
    let slope = 65f64.to_radians().tan();
    let mut slave = Patch::grid(Shape::Plane, [4, 3], false, |a, b| [0.2 + 0.8 * a, 0.3 + 0.4 * b]).moved(0.0, [0.0, 0.0, 0.4]);
    let mut master = lifted(&|p: [f64; 2]| -slope * (p[0] - 0.5).max(0.0));
    (slave.outward, master.outward) = (Some(-1.0), Some(1.0));
    let report = facing(4).segments(&slave, &master).unwrap().report;
    // the fan is halved by its bisector
    let covered = 0.4 * (0.3 + 0.4 * 32.5f64.to_radians().tan());
    assert!((report.covered - covered).abs() < 1e-12, "{covered} {report:?}");
    let open: Vec<usize> = (0..12).filter(|&e| report.share[e] < 1.0 - 1e-9).collect();
    assert_eq!((open.len(), &open), (6, &report.lost), "{report:?}");
}

#[test]
fn the_fan_of_a_kink_is_halved_and_tiles_the_slave() {
    for height in [0.2, -0.2] {
        for gap in [0.0, 0.1, 0.3] {
            // a roof along b, and a pyramid, seen from above, larger than the slave
            let roof = |p: [f64; 2]| height * (1.0 - 2.0 * (p[0] - 0.5).abs());
            let pyramid = |p: [f64; 2]| height * (1.0 - 2.0 * (p[0] - 0.5).abs().max((p[1] - 0.5).abs()));
            for (name, of) in [("roof", &roof as &dyn Fn([f64; 2]) -> f64), ("pyramid", &pyramid)] {
                let slave = Patch::grid(Shape::Plane, [5, 5], false, |a, b| [0.3 + 0.4 * a, 0.3 + 0.4 * b])
                    .moved(0.0, [0.0, 0.0, height.max(0.0) + gap]);
                let master = lifted(of);
                let segments = facing(4).segments(&slave, &master).unwrap();
                let report = &segments.report;
                assert!(report.lost.is_empty() && report.share.iter().all(|&s| s == 1.0), "{name} {height} {gap}: {report:?}");
                assert!((report.covered - 0.16).abs() < 1e-12, "{name} {height} {gap}: {report:?}");
                // points of the fan lie outside of their facet by up to the gap times the slope
                assert!(report.outside < 2.0, "{name} {height} {gap}: {report:?}");
            }
        }
    }
}

/// Flat facets over a 4 x 4 grid, in triangles, with these heights at their vertices.
pub fn lifted(of: &dyn Fn([f64; 2]) -> f64) -> Patch {
    let mut master = Patch::grid(Shape::Plane, [4, 4], true, |a, b| [a, b]).facets(1);
    master.heights = Some(master.points.iter().map(|p| of(*p)).collect());
    master
}

#[test]
fn rims_end_the_part_that_is_covered() {
    // the overlap of two unit squares, one turned by 17 degrees about the centre and shifted by 0.3
    for (degrees, shift, expected) in [(0.0, 0.3, 0.7), (45.0, 0.0, 2.0 * (2f64.sqrt() - 1.0))] {
        for gap in [0.0, 0.1] {
            for kinds in [[false, false], [true, true]] {
                let (s, c) = f64::to_radians(degrees).sin_cos();
                let slave = Patch::grid(Shape::Plane, [4, 3], kinds[0], |a, b| [a, b]).moved(0.0, [0.0, 0.0, gap]);
                let master = Patch::grid(Shape::Plane, [3, 5], kinds[1], |a, b| {
                    let (x, y) = (a - 0.5, b - 0.5);
                    [0.5 + shift + c * x - s * y, 0.5 + s * x + c * y]
                });
                let segments = facing(3).segments(&slave, &master).unwrap();
                assert!((segments.report.covered - expected).abs() < 1e-12, "{degrees} {gap} {kinds:?}: {:?}", segments.report);
                assert!((segments.report.slave_measure - 1.0).abs() < 1e-12 && segments.report.lost.is_empty());
                let verified = segments.clone().verified(&slave, &master).unwrap();
                assert_eq!(verified.report, segments.report);
            }
        }
    }
}

#[test]
fn nothing_is_paired_beyond_the_reach() {
    let slave = Patch::grid(Shape::Plane, [3, 3], false, |a, b| [a, b]).moved(0.0, [0.0, 0.0, 0.2]);
    let master = Patch::grid(Shape::Plane, [4, 4], false, |a, b| [a, b]);
    let near = MergedSurface::facing(3, Some(0.21)).segments(&slave, &master).unwrap();
    let far = MergedSurface::facing(3, Some(0.19)).segments(&slave, &master).unwrap();
    assert!((near.report.covered - 1.0).abs() < 1e-12);
    assert_eq!((far.num_pieces(), far.report.share.iter().sum::<f64>()), (0, 0.0));
}
