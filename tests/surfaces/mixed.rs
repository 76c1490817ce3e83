//! Mixed integration of surfaces: sums over the master's own points by closed forms, and the balance that they give up.

use crate::bodies::{KINDS, Kind, steel};
use crate::common::{Patch, Shape};
use faying::basis::{Cell, Elements, Order};
use faying::coupling::interface::{MasterSurfaceSums, MergedSurface};
use faying::coupling::{InterfaceQuadrature, Segments};
use faying::geometry::{Geometry, MapTable, cross, shapes};
use faying::linalg::Vector;
use faying::problem::{Components, Data, Integration, Problem};
use faying::quadrature::{Quadrature, Rule, TensorRule, simplex_rule};
use faying::space::PatchSpec;

/// The rule of a cell of the master.
fn rule(cell: Cell, n: usize) -> Rule<2> {
    if cell == Cell::Simplex { simplex_rule(2 * n - 1) } else { TensorRule::<2>::gauss([n; 2]).rule(0).clone() }
}

/// Every pair with its weight, its Gauss weight on the master, and the measure of the master there.
struct Pair {
    own: Vector<3>,
    other: Vector<3>,
    /// ds over the weight and the measure of the master.
    rate: f64,
}

/// The pairs, where all master cells have their Gauss points, each once.
fn pairs(segments: &Segments<2>, slave: &Patch, master: &Patch, n: usize) -> Vec<Pair> {
    let mut out = Vec::new();
    let mut seen: Vec<Vec<bool>> = (0..master.num_elements()).map(|f| vec![false; rule(master.cell(f), n).weights.len()]).collect();
    let (mut here, mut there) = (MapTable::new(), MapTable::new());
    for piece in 0..segments.num_pieces() {
        let (e, f) = (segments.slave[piece], segments.master[piece]);
        let own = rule(master.cell(f), n);
        for q in segments.points(piece) {
            let at = own.points.iter().position(|x| (x - segments.master_xi[q]).norm() < 1e-14).expect("a Gauss point of the master");
            assert!(!std::mem::replace(&mut seen[f][at], true), "point {at} of element {f} stands twice");
            slave.map(e, &[segments.slave_xi[q]], Order::Values, &mut here);
            master.map(f, &[segments.master_xi[q]], Order::Gradients, &mut there);
            let rate = segments.ds[q] / (own.weights[at] * cross(&there.jacobian[0]).norm());
            out.push(Pair { own: here.x[0], other: there.x[0], rate });
        }
    }
    assert!(seen.iter().flatten().all(|seen| *seen), "every Gauss point of the master has a partner");
    out
}

const CELLS: [[bool; 2]; 4] = [[false, false], [false, true], [true, false], [true, true]];

/// Concentric spheres: partners lie on one ray, and weights are those of the master times the square of the radii's ratio.
#[test]
fn points_of_the_master_face_the_slave_along_its_normal() {
    for (k, kinds) in CELLS.into_iter().enumerate() {
        for radius in [1.0, 1.15, 0.9] {
            let slave = Patch::grid(Shape::Sphere(radius, 1.3), [5, 4], kinds[0], |a, b| [a, b]).warped(0.05);
            let master = Patch::grid(Shape::Sphere(1.0, 1.0), [3, 4], kinds[1], |a, b| [a, b]);
            let n = 2 + k % 2;
            let segments = MasterSurfaceSums::facing(n, None).segments(&slave, &master).unwrap();
            for pair in pairs(&segments, &slave, &master, n) {
                let what = format!("{kinds:?} {radius} {:?}", pair.other);
                assert!((pair.own / radius - pair.other).norm() < 1e-12, "{what}: {:?}", pair.own);
                assert!((pair.rate - radius * radius).abs() < 1e-11, "{what}: {}", pair.rate);
            }
        }
    }
}

/// A plane master below a part of a sphere: partners have the same place in the plane, weights are 1 / cos of the slope.
#[test]
fn a_plane_master_projects_the_slave() {
    for kinds in CELLS {
        let slave = Patch::grid(Shape::Wave(0.2), [5, 6], kinds[0], |a, b| [a, b]);
        let master = Patch::grid(Shape::Plane, [4, 3], kinds[1], |a, b| [0.1 + 0.8 * a, 0.15 + 0.7 * b]).moved(0.0, [0.0, 0.0, -0.1]);
        let segments = MasterSurfaceSums::facing(3, None).segments(&slave, &master).unwrap();
        for pair in pairs(&segments, &slave, &master, 3) {
            let [a, b] = [pair.other[0], pair.other[1]];
            let jet = Shape::Wave(0.2).at(a, b);
            assert!((pair.own - jet[0]).norm() < 1e-12, "{kinds:?}: {:?} {:?}", pair.own, jet[0]);
            let slope = jet[1].cross(&jet[2]).norm();
            assert!((pair.rate - slope).abs() < 1e-11, "{kinds:?}: {} {slope}", pair.rate);
        }
    }
}

/// Where the slave ends inside master cells, these keep the points of merged integration: the covered measure is exact.
#[test]
fn what_is_covered_is_summed_and_no_more() {
    for kinds in CELLS {
        let slave = Patch::grid(Shape::Plane, [4, 3], kinds[0], |a, b| [a, b]).moved(0.0, [0.0, 0.0, 0.05]);
        let master = Patch::grid(Shape::Plane, [3, 5], kinds[1], |a, b| [0.3 + a, b]);
        let segments = MasterSurfaceSums::facing(3, None).segments(&slave, &master).unwrap();
        let merged = MergedSurface::facing(3, None).segments(&slave, &master).unwrap();
        assert!((segments.measure() - 0.7).abs() < 1e-12 && (segments.report.covered - 0.7).abs() < 1e-12, "{kinds:?}");
        assert_eq!(segments.report.share, merged.report.share, "{kinds:?}");
        let mut of_cell = vec![0.0; master.num_elements()];
        for piece in 0..segments.num_pieces() {
            of_cell[segments.master[piece]] += segments.points(piece).map(|q| segments.ds[q]).sum::<f64>();
        }
        let whole = 1.0 / master.num_elements() as f64;
        let counted = of_cell.iter().filter(|ds| (**ds - whole).abs() < 1e-13).count();
        // two of three columns of the master lie over the slave
        assert_eq!(counted * 3, master.num_elements() * 2, "{kinds:?}: {of_cell:?}");
    }
}

#[test]
fn sums_have_the_same_bits_at_any_number_of_threads() {
    let slave = Patch::grid(Shape::Sphere(1.1, 1.4), [5, 5], true, |a, b| [a, b]);
    let master = Patch::grid(Shape::Sphere(1.0, 1.2), [6, 4], false, |a, b| [a, b]).warped(0.07);
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| MasterSurfaceSums::facing(3, None).segments(&slave, &master).unwrap())
    };
    assert!(of(2) == of(1));
}

/// A tie under a traction that varies: merged integration balances the forces on both bodies to rounding; mixed integration gives that up by what
/// the rules of both sides differ for the multiplier, and keeps it where the elements of both sides are the same.
#[test]
fn mixed_integration_gives_up_the_balance_of_forces() {
    let solved = |kinds: [Kind; 2], upper: [usize; 3], rule: Integration| {
        let mut p = Problem::<2, 3>::new();
        let body = |z: f64, kind: Kind, elements: [usize; 3]| {
            let net = shapes::brick([0.0, 0.0, z], [1.0, 1.0, z + 0.5]).unwrap();
            kind.body(&PatchSpec::new(net).with_degree([2; 3]).with_elements(elements))
        };
        let lower = kinds[0].add(&mut p, "lower", body(0.0, kinds[0], [3, 3, 1]), steel());
        let upper = kinds[1].add(&mut p, "upper", body(0.5, kinds[1], upper), steel());
        p.fix(lower.side("w0"), Components::All).unwrap();
        p.traction(upper.side("w1"), 2, Data::of(|x, _| 1.0 + x[0] * x[0] + 0.5 * x[1])).unwrap();
        let tie = p.tie(upper.side("w0"), lower.side("w1")).unwrap().rule(rule).id();
        p.assemble().unwrap().solve(0.0, None).unwrap().tie(tie).unwrap().balance
    };
    for kinds in [[Kind::Spline, Kind::Hexahedra], [Kind::Tetrahedra, Kind::Spline], [Kind::Hexahedra, Kind::Tetrahedra]] {
        let [merged, mixed] = [Integration::Merged, Integration::Mixed].map(|rule| solved(kinds, [4, 5, 1], rule));
        assert!(merged < 1e-12, "{kinds:?}: {merged:e}");
        assert!(mixed > 1e-9 && mixed < 1e-2, "{kinds:?}: {mixed:e}");
    }
    for kind in KINDS {
        let same = solved([kind; 2], [3, 3, 1], Integration::Mixed);
        assert!(same < 1e-12, "{kind:?}: {same:e}");
    }
}

/// Contact between surfaces by mixed integration is refused; ties have it.
#[test]
fn contact_between_surfaces_refuses_mixed_integration() {
    let mut p = Problem::<2, 3>::new();
    let [lower, upper] = [("lower", 0.0), ("upper", 0.5)].map(|(name, z)| {
        let net = shapes::brick([0.0, 0.0, z], [1.0, 1.0, z + 0.5]).unwrap();
        Kind::Spline.add(&mut p, name, Kind::Spline.body(&PatchSpec::new(net).with_elements([2; 3])), steel())
    });
    p.fix(lower.side("w0"), Components::All).unwrap();
    p.fix(upper.side("w1"), Components::All).unwrap();
    p.contact(upper.side("w0"), lower.side("w1")).unwrap().rule(Integration::Mixed);
    let errors = p.assemble().unwrap_err();
    assert!(errors.to_string().contains("mixed integration of contact between surfaces"), "{errors}");
}
