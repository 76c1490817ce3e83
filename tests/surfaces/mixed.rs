//! Mixed integration of surfaces: sums over the master's own points by closed forms, and the balance that they give up.

use crate::bodies::{KINDS, Kind, steel};
use crate::common::{Patch, Shape};
use faying::basis::{BSpline, Cell, Elements, Order};
use faying::coupling::interface::{MasterSurfaceSums, MergedSurface};
use faying::coupling::multiplier::MultiplierKind;
use faying::coupling::{InterfaceQuadrature, Segments};
use faying::geometry::{ControlNet, Geometry, MapTable, cross};
use faying::linalg::Vector;
use faying::problem::{Components, Data, Integration, Problem};
use faying::quadrature::{Quadrature, Rule, TensorRule, simplex_rule};
use faying::space::PatchSpec;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// The rule of a cell of the master.
fn rule(cell: Cell, n: usize) -> Rule<2> {
    if cell == Cell::Simplex { simplex_rule(2 * n - 1) } else { TensorRule::<2>::gauss([n; 2]).rule(0).clone() }
}

/// A point of the master and its partner.
struct Pair {
    own: Vector<3>,
    other: Vector<3>,
    /// ds over the weight and the measure of the master.
    rate: f64,
}

/// The pairs, where all master cells have their Gauss points, each once; those on a side that slave elements share, in parts for each.
fn pairs(segments: &Segments<2>, slave: &Patch, master: &Patch, n: usize) -> Vec<Pair> {
    let mut found: BTreeMap<(usize, usize), Pair> = BTreeMap::new();
    let (mut here, mut there) = (MapTable::new(), MapTable::new());
    for piece in 0..segments.num_pieces() {
        let (e, f) = (segments.slave[piece], segments.master[piece]);
        let own = rule(master.cell(f), n);
        for q in segments.points(piece) {
            let at = own.points.iter().position(|x| (x - segments.master_xi[q]).norm() < 1e-14).expect("a Gauss point of the master");
            slave.map(e, &[segments.slave_xi[q]], Order::Values, &mut here);
            master.map(f, &[segments.master_xi[q]], Order::Gradients, &mut there);
            let rate = segments.ds[q] / (own.weights[at] * cross(&there.jacobian[0]).norm());
            let pair = found.entry((f, at)).or_insert(Pair { own: here.x[0], other: there.x[0], rate: 0.0 });
            assert!((pair.own - here.x[0]).norm() < 1e-8, "point {at} of element {f} stands twice");
            pair.rate += rate;
        }
    }
    let all: usize = (0..master.num_elements()).map(|f| rule(master.cell(f), n).weights.len()).sum();
    assert_eq!(found.len(), all, "every Gauss point of the master has a partner");
    found.into_values().collect()
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

/// Where the slave ends inside master cells, what it covers of them has points of its own: the covered measure is exact, and a strip of a
/// cell has n x n points.
#[test]
fn what_is_covered_is_summed_and_no_more() {
    for kinds in CELLS {
        for turned in [0.0, 30.0] {
            let slave = Patch::grid(Shape::Plane, [4, 3], kinds[0], |a, b| [a, b]).moved(0.0, [0.0, 0.0, 0.05]);
            let (s, c) = f64::to_radians(turned).sin_cos();
            let master = Patch::grid(Shape::Plane, [3, 5], kinds[1], |a, b| [0.3 + c * a - s * b, s * a + c * b]);
            let segments = MasterSurfaceSums::facing(3, None).segments(&slave, &master).unwrap();
            let merged = MergedSurface::facing(3, None).segments(&slave, &master).unwrap();
            let what = format!("{kinds:?} {turned}");
            assert!((segments.measure() - merged.measure()).abs() < 1e-12, "{what}: {} {}", segments.measure(), merged.measure());
            assert_eq!(segments.report.share, merged.report.share, "{what}");
            let of_cell = |segments: &Segments<2>| {
                let (mut of_cell, mut points) = (vec![0.0; master.num_elements()], vec![0; master.num_elements()]);
                for piece in 0..segments.num_pieces() {
                    of_cell[segments.master[piece]] += segments.points(piece).map(|q| segments.ds[q]).sum::<f64>();
                    points[segments.master[piece]] += segments.points(piece).len();
                }
                (of_cell, points)
            };
            let ((own, points), (others, _)) = (of_cell(&segments), of_cell(&merged));
            let apart = own.iter().zip(&others).map(|(a, b): (&f64, &f64)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-13, "{what}: {apart:e}");
            if turned == 0.0 && !kinds[1] {
                assert!(points.iter().all(|n| *n == 9), "{what}: {points:?}");
            }
        }
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

/// The box of the unit square from z to z + 0.5; its elements along x grow, those along y shrink, by `uneven`.
fn uneven_box(z: f64, uneven: f64) -> ControlNet<3, 3> {
    let at = |k: usize, middle: f64| [0.0, middle, 1.0][k];
    let points =
        (0..18).map(|k| Vector::<3>::new(at(k % 3, 0.5 - uneven), at(k / 3 % 3, 0.5 + uneven), z + 0.5 * (k / 9) as f64)).collect();
    ControlNet::<3, 3>::try_new([BSpline::uniform(2, 1, 1), BSpline::uniform(2, 1, 1), BSpline::uniform(1, 1, 0)], points, None).unwrap()
}

/// Two blocks on as many elements each, those of the upper one, the slave, of lengths that vary by `uneven`; all sides are held along their
/// normals, and the load has a smooth even continuation, so that the multiplier has no layer at its ends. The largest difference of the forces
/// on both, relative, tied or in contact.
fn balance(kinds: [Kind; 2], elements: [[usize; 3]; 2], uneven: f64, tied: bool, rule: Integration) -> f64 {
    let mut p = Problem::<2, 3>::new();
    let [lower, upper] = std::array::from_fn(|b| {
        let net = uneven_box(0.5 * b as f64, uneven * b as f64);
        let spec = PatchSpec::new(net).with_degree([2; 3]).with_elements(elements[b]);
        let body = kinds[b].add(&mut p, ["lower", "upper"][b], kinds[b].body(&spec), steel());
        ["u0", "u1", "v0", "v1"].into_iter().for_each(|side| p.fix_normal(body.side(side)).map(drop).unwrap());
        body
    });
    p.fix(lower.side("w0"), Components::All).unwrap();
    p.pressure(upper.side("w1"), Data::of(|x, _| 0.01 * (2.0 + (PI * x[0]).cos() + 0.5 * (PI * x[1]).cos()))).unwrap();
    let (slave, master, kind) = (upper.side("w0"), lower.side("w1"), MultiplierKind::Lowered(0));
    if tied {
        let tie = p.tie(slave, master).unwrap().rule(rule).multiplier(kind).id();
        return p.assemble().unwrap().solve(0.0, None).unwrap().tie(tie).unwrap().balance;
    }
    let contact = p.contact(slave, master).unwrap().rule(rule).multiplier(kind).id();
    p.assemble().unwrap().solve(0.0, None).unwrap().contact(contact).unwrap().balance
}

/// Merged integration balances the forces on both bodies to rounding; mixed integration gives that up by what the rules of both sides differ
/// for the multiplier, and keeps it where the elements of both sides are the same. Slopes of the multiplier are known to the order h at degree
/// 2, so that they jump by no more from element to element; rules that do not see the jumps err by h² times that: the order is 2 at least. With
/// `FAYING_RATES=all` every pair tied and in contact.
#[test]
fn mixed_integration_gives_up_the_balance_of_forces_by_an_error_of_second_order() {
    let pairs = [[Kind::Spline, Kind::Hexahedra], [Kind::Hexahedra, Kind::Spline], [Kind::Hexahedra, Kind::Tetrahedra]];
    let all = std::env::var("FAYING_RATES").is_ok_and(|v| v == "all");
    let sample = [[false, true], [true, false], [false, true]].map(|list| if all { [true; 2] } else { list });
    let both = pairs.into_iter().zip(sample).flat_map(|(kinds, [tied, pressed])| [(kinds, true, tied), (kinds, false, pressed)]);
    for (kinds, tied, _) in both.filter(|(.., is_taken)| *is_taken) {
        let of = |k: usize, rule| balance(kinds, [[3 * k, 3 * k, k], [4 * k, 5 * k, k]], 0.1, tied, rule);
        let levels = if tied { 2 } else { 3 };
        let (merged, mixed) = (of(1, Integration::Merged), (1..=levels).map(|k| of(k, Integration::Mixed)).collect::<Vec<_>>());
        println!("{kinds:?}, tied {tied}: {merged:e} merged, mixed {mixed:?}");
        assert!(merged < 1e-12, "{kinds:?}, tied {tied}: {merged:e}");
        let falls = |k: usize| mixed[k] < mixed[k - 1] * (k as f64 / (k + 1) as f64).powi(2);
        assert!(mixed[levels - 1] > 1e-9 && (1..levels).all(falls), "{kinds:?}, tied {tied}: {mixed:?}");
    }
    for (kind, tied) in KINDS.into_iter().flat_map(|kind| [true, false].map(|tied| (kind, tied))) {
        let same = balance([kind; 2], [[3, 3, 1]; 2], 0.0, tied, Integration::Mixed);
        assert!(same < 1e-12, "{kind:?}, tied {tied}: {same:e}");
    }
}
