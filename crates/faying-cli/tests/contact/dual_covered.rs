//! Dual multipliers of contact where the master ends within an element: weights, sum, diagonality, bounds, pressure.

use crate::common::coupled;
use crate::common::pressed;
use coupled::{KINDS, Kind, weighted};
use faying::basis::{BSpline, Basis, Order, ShapeTable};
use faying::check;
use faying::coupling::Segments;
use faying::coupling::multiplier::{MOST, MultiplierError, MultiplierKind, build, build_covered};
use faying::geometry::MapTable;
use faying::geometry::shapes::{annulus_sector, rectangle};
use faying::linalg::{Vector, measure};
use faying::quadrature::gauss_legendre;
use faying::space::{PatchSpec, Space};
use faying_cli::Registry;
use pressed::{contact, read, solve};
use std::sync::Arc;

type Curve = Arc<dyn Space<1, 2>>;

/// A side of four elements, straight or an arc.
fn side(kind: Kind, degree: usize, curved: bool) -> Curve {
    let mut net =
        if curved { annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap() } else { rectangle([0.0, 0.0], [1.0, 1.0]).unwrap() };
    if kind == Kind::Nurbs && !curved {
        net = weighted(&net, degree.min(2));
    }
    let spec = PatchSpec::new(net).with_degree([degree; 2]).with_elements([4, 1]);
    kind.body(&spec).trace(if curved { "v1" } else { "v0" }).unwrap().space
}

/// Gauss points of a piece [from, to] of every element; none where both are equal.
fn cover(space: &dyn Space<1, 2>, pieces: &[[f64; 2]], points: usize) -> Segments<1> {
    let (rule, mut segments, mut map) = (gauss_legendre::<f64>(points), Segments::new(), MapTable::new());
    for (e, &[from, to]) in pieces.iter().enumerate().filter(|(_, p)| p[0] < p[1]) {
        let xi: Vec<Vector<1>> = rule.points.iter().map(|x| Vector::<1>::new(from + (to - from) * x[0])).collect();
        space.map(e, &xi, Order::Gradients, &mut map);
        let ds: Vec<f64> = map.jacobian.iter().zip(&rule.weights).map(|(j, w)| w * (to - from) * measure(j)).collect();
        segments.push_piece(e, 0, xi.iter().zip(ds).map(|(&x, ds)| (x, x, ds)));
    }
    segments
}

/// What the functions of an element are read as: Bernstein polynomials where the trace's have both signs.
fn values(space: &dyn Space<1, 2>, element: usize, xi: &[Vector<1>]) -> ShapeTable<1> {
    let (mut table, mut all) = (ShapeTable::new(), ShapeTable::new());
    let grid: Vec<Vector<1>> = (0..=40).map(|k| Vector::<1>::new(f64::from(k) / 40.0)).collect();
    space.tabulate(element, &grid, Order::Values, &mut all);
    if (0..grid.len()).any(|q| all.values(q).iter().any(|v| *v < -1e-9)) {
        BSpline::bernstein(all.num_functions() - 1, &[0.0, 1.0]).tabulate(0, xi, Order::Values, &mut table);
    } else {
        space.tabulate(element, xi, Order::Values, &mut table);
    }
    table
}

const SHARES: [f64; 7] = [0.9, 0.5, 0.3, 0.1, 0.01, 1e-3, 1e-6];

#[test]
fn over_a_part_of_an_element_weights_are_positive_sums_are_one_and_d_is_diagonal() {
    let (mut tested, mut diagonal, mut worst, mut largest) = (0, 0, 0.0f64, 0.0f64);
    for kind in KINDS {
        for degree in 1..=4 {
            for curved in [false, true] {
                if curved && kind == Kind::Nurbs && degree < 2 {
                    continue; // an arc has degree two
                }
                let space = side(kind, degree, curved);
                for share in SHARES {
                    // the master ends in the third element, begins in the second, or is shorter than an element
                    for pieces in [
                        [[0.0, 1.0], [0.0, 1.0], [0.0, share], [0.0, 0.0]],
                        [[0.0, 0.0], [1.0 - share, 1.0], [0.0, 1.0], [0.0, 1.0]],
                        [[0.0, 0.0], [0.5 - 0.5 * share, 0.5 + 0.5 * share], [0.0, 0.0], [0.0, 0.0]],
                        [[1.0 - share, 1.0], [0.0, 1.0], [0.0, 1.0], [0.0, share]],
                    ] {
                        for ends in [[false, false], [true, false], [true, true]] {
                            let what = format!("{kind:?} of degree {degree}, curved {curved}, {pieces:?}, ends {ends:?}");
                            let segments = cover(&*space, &pieces, degree + 10);
                            let made = build_covered(&space, &ends, &segments);
                            let smooth = degree >= 3 && matches!(kind, Kind::Spline | Kind::Nurbs);
                            if smooth {
                                let Err(MultiplierError::NoDual { reason, known }) = made else { panic!("{what}: no bound") };
                                assert!(reason.contains("covered in part") && known.contains("p/p-2"), "{what}: {reason}, {known}");
                                continue;
                            }
                            let made = made.unwrap_or_else(|e| panic!("{what}: {e}"));
                            let (psi, reading) = (&made.functions, &made.reading);
                            check::basis(reading).unwrap_or_else(|e| panic!("{what}: {e}"));
                            check::partition_of_unity(reading).unwrap_or_else(|e| panic!("{what}: {e}"));
                            // on slivers the functions that live there alone give all they have to a neighbour: at most those of both elements covered in part
                            let n = space.num_functions() - ends.iter().filter(|e| **e).count();
                            let lost = n - psi.num_functions();
                            assert_eq!(psi.num_functions(), reading.num_functions(), "{what}");
                            assert!(lost <= if share < 0.9 { 2 * degree } else { 0 }, "{what}: {lost} functions are lost");
                            let mut weights = vec![0.0; psi.num_functions()];
                            let mut read = weights.clone();
                            let (mut own, mut ids, mut all) = (ShapeTable::new(), Vec::new(), Vec::new());
                            let mut other = ShapeTable::new();
                            for piece in 0..segments.num_pieces() {
                                let (e, points) = (segments.slave[piece], segments.points(piece));
                                let xi = &segments.slave_xi[points.clone()];
                                psi.active(e, &mut ids);
                                psi.tabulate(e, xi, Order::Values, &mut own);
                                reading.active(e, &mut all);
                                reading.tabulate(e, xi, Order::Values, &mut other);
                                let in_part = pieces[e][1] - pieces[e][0] < 1.0;
                                for (k, q) in points.clone().enumerate() {
                                    let sum: f64 = own.values(k).iter().sum();
                                    let size = own.values(k).iter().fold(0.0f64, |m, v| m.max(v.abs()));
                                    worst = worst.max((sum - 1.0).abs() / size.max(1.0));
                                    ids.iter().zip(own.values(k)).for_each(|(&j, v)| weights[j] += segments.ds[q] * v);
                                    all.iter().zip(other.values(k)).for_each(|(&j, v)| read[j] += segments.ds[q] * v);
                                    if in_part {
                                        largest = largest.max(size);
                                        assert!(size <= MOST, "{what}: {size}");
                                        assert!(other.values(k).iter().all(|v| *v >= -1e-12), "{what}");
                                    }
                                }
                                // D, in the form that the element is read in
                                if in_part && ids.len() == degree + 1 {
                                    let table = values(&*space, e, xi);
                                    let d = |j: usize, i: usize| -> f64 {
                                        points
                                            .clone()
                                            .enumerate()
                                            .map(|(k, q)| segments.ds[q] * own.values(k)[j] * table.values(k)[i])
                                            .sum()
                                    };
                                    let all: Vec<Vec<f64>> = (0..=degree).map(|j| (0..=degree).map(|i| d(j, i)).collect()).collect();
                                    let most = all.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
                                    for row in &all {
                                        let mut sizes: Vec<f64> = row.iter().map(|v| v.abs()).collect();
                                        sizes.sort_by(f64::total_cmp);
                                        assert!(sizes[degree - 1] <= 1e-8 * most, "{what}: {all:?}");
                                    }
                                    diagonal += 1;
                                }
                            }
                            // functions of constrained ends of elements that are covered as a whole keep what they have in ties
                            let free = ends == [false, false];
                            let scale = weights.iter().fold(0.0f64, |m, w| m.max(*w));
                            let whole_end = (ends[0] && pieces[0] == [0.0, 1.0]) || (ends[1] && pieces[3] == [0.0, 1.0]);
                            if !whole_end {
                                assert!(weights.iter().all(|&w| w >= -1e-14 * scale), "{what}: {weights:?}");
                            }
                            if free {
                                for (w, r) in weights.iter().zip(&read) {
                                    assert!((w - r).abs() <= 1e-9 * scale, "{what}: the same force per function: {w} {r}");
                                }
                            }
                            let whole: f64 = segments.measure();
                            assert!((weights.iter().sum::<f64>() / whole - 1.0).abs() < 1e-9, "{what}");
                            tested += 1;
                        }
                    }
                }
            }
        }
    }
    println!("{tested} sides, {diagonal} elements with a diagonal of their own; sums to {worst:.1e}, greatest |psi| {largest:.1}");
    assert!(tested > 1000 && diagonal > 300 && worst < 1e-8, "{tested} {diagonal} {worst:e}");
}

#[test]
fn where_all_is_covered_nothing_changes() {
    for kind in KINDS {
        for degree in 1..=4 {
            let space = side(kind, degree, false);
            let made = build_covered(&space, &[true, false], &cover(&*space, &[[0.0, 1.0]; 4], degree + 1)).unwrap();
            let plain = build(&space, MultiplierKind::Dual, &[true, false]).unwrap();
            let (mut a, mut b, xi) = (ShapeTable::new(), ShapeTable::new(), [Vector::<1>::new(0.0), Vector::<1>::new(0.3)]);
            for e in 0..4 {
                made.functions.tabulate(e, &xi, Order::Values, &mut a);
                plain.tabulate(e, &xi, Order::Values, &mut b);
                assert_eq!(a.values(1), b.values(1));
            }
        }
    }
}

#[test]
fn points_of_an_element_that_several_masters_share_cover_it() {
    // as slave integration has them: a Gauss rule per element, its points shared out
    let space = side(Kind::Spline, 3, false);
    let whole = cover(&*space, &[[0.0, 1.0]; 4], 6);
    for shares in [[1, 5], [2, 4], [3, 3], [5, 1]] {
        let mut shared = Segments::new();
        for piece in 0..whole.num_pieces() {
            let points = whole.points(piece);
            let mut from = points.start;
            for (master, count) in shares.into_iter().enumerate() {
                let own = (from..from + count).map(|q| (whole.slave_xi[q], whole.slave_xi[q], whole.ds[q]));
                shared.push_piece(whole.slave[piece], master, own);
                from += count;
            }
        }
        let of = |segments: &Segments<1>| build_covered(&space, &[], segments);
        let (a, b) = (of(&shared).unwrap(), of(&whole).unwrap());
        let (mut one, mut other) = (ShapeTable::new(), ShapeTable::new());
        for element in 0..4 {
            let xi = [Vector::<1>::new(0.37)];
            a.functions.tabulate(element, &xi, Order::Values, &mut one);
            b.functions.tabulate(element, &xi, Order::Values, &mut other);
            assert_eq!(one.values(0), other.values(0), "{shares:?}");
        }
    }
    // a point that is missing is a part that is not covered
    let mut lost = Segments::new();
    for piece in 0..whole.num_pieces() {
        let points = if piece == 1 { whole.points(piece).start + 1..whole.points(piece).end } else { whole.points(piece) };
        lost.push_piece(whole.slave[piece], 0, points.map(|q| (whole.slave_xi[q], whole.slave_xi[q], whole.ds[q])));
    }
    assert!(matches!(build_covered(&space, &[], &lost), Err(MultiplierError::NoDual { .. })));
}

/// A block on another that ends at x = 1 + `share` / 5, within an element of its own, the rest hanging over.
fn overhang(backend: &str, degree: usize, share: f64, multiplier: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n\
         [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
         [[patch]]\nname = \"lower\"\ngeometry = {{ kind = \"box\", min = [0, -1], max = [{}, 0] }}\nelements = [6, 5]\n\
         [[patch]]\nname = \"upper\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [2, 1] }}\nelements = [10, 5]\n\
         [[boundary]]\non = \"lower.bottom\"\nfix = [\"y\"]\n[[boundary]]\non = [\"lower.left\", \"upper.left\"]\nfix = [\"x\"]\n\
         [[boundary]]\non = \"upper.top\"\ndirichlet = {{ y = -0.01 }}\n\
         [[contact]]\nname = \"c\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\nmultiplier = \"{multiplier}\"\n",
        1.0 + 0.2 * share
    )
}

/// A ring pressed on a plane, closed far from the zone of contact, beside it and in the middle of it: the same grid, the same pressure.
#[test]
fn a_ring_may_close_anywhere() {
    let ring = |backend: &str, from: f64, multiplier: &str| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\n\
             [[material]]\nname = \"m\"\nyoung = 1000.0\npoisson = 0.3\n\
             [[patch]]\nname = \"r\"\nelements = [80, 4]\nclosed = \"u\"\n\
             geometry = {{ kind = \"annulus-sector\", center = [0, 1], radius = [0.3, 1], angle_deg = [{from:?}, {:?}] }}\n\
             [[boundary]]\non = \"r.v0\"\ndirichlet = [\"0\", \"-0.01\"]\n\
             [[contact]]\nname = \"c\"\nslave = \"r.v1\"\nmultiplier = \"{multiplier}\"\n\
             rigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n",
            from + 360.0
        )
    };
    for backend in ["iga", "fe"] {
        let of = |from: f64, multiplier: &str| {
            let result = solve(&ring(backend, from, multiplier), &[]);
            let c = contact(&result, "c");
            (c.force[1], c.pressure.max, c.active)
        };
        let far = of(90.0, "dual");
        for from in [0.0, -90.0] {
            let (force, pressure, active) = of(from, "dual");
            println!("{backend} {from}: {force} {pressure} {active}, far {far:?}");
            assert!((force / far.0 - 1.0).abs() < 1e-9 && (pressure / far.1 - 1.0).abs() < 1e-7 && active == far.2, "{backend} {from}");
        }
        let other = of(90.0, "p/p");
        assert!((far.0 / other.0 - 1.0).abs() < 0.05, "{backend}: {far:?} {other:?}");
    }
}

#[test]
fn a_master_that_ends_within_an_element_presses_without_tension_and_without_oscillation() {
    for backend in ["iga", "fe"] {
        for degree in [1, 2, 3] {
            for share in [0.1, 0.5, 0.9] {
                let what = format!("{backend} {degree} {share}");
                let text = overhang(backend, degree, share, "dual");
                if backend == "iga" && degree >= 3 {
                    let fault = read(&text, &[]).run(&Registry::default()).unwrap_err();
                    let first = &fault.items[0];
                    assert_eq!(first.code, "E064", "{what}: {fault}");
                    assert_eq!(first.help.as_deref(), Some("write multiplier = \"p/p-2\""), "{what}");
                    // what the help says can be done
                    solve(&overhang(backend, degree, share, "p/p-2"), &[]);
                    continue;
                }
                let result = solve(&text, &[]);
                let c = contact(&result, "c");
                let other = solve(&overhang(backend, degree, share, "p/p"), &[]);
                let o = contact(&other, "c");
                println!("{what}: force {} {}, pressure {:?} {:?}", c.force[1], o.force[1], c.pressure, o.pressure);
                assert!(c.balance < 1e-12 && result.balance.force.iter().all(|f| f.abs() < 1e-12), "{what}");
                assert!((c.force[1] / o.force[1] - 1.0).abs() < 0.02, "{what}: {} {}", c.force[1], o.force[1]);
                assert!(
                    c.pressure.min >= if backend == "iga" || degree == 1 { -1e-15 } else { -0.2 * c.pressure.max },
                    "{what}: {:?}",
                    c.pressure
                );
                assert!(c.pressure.max < 2.0 * o.pressure.max, "{what}: {:?} {:?}", c.pressure, o.pressure);
            }
        }
    }
}

/// Half of a block pressed on a shorter one, which ends at `end` within an element of the slave.
fn beyond(backend: &str, degree: usize, end: f64, multiplier: &str, method: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
         [discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [{end}, 0.5] }}\nelements = [5, 3]\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0.5], max = [1, 1] }}\nelements = [10, 4]\n\
         [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = [\"b.left\", \"a.left\"]\nfix = [\"x\"]\n\
         [[boundary]]\non = \"b.top\"\ndirichlet = {{ y = \"-0.01\" }}\n\
         [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\nmethod = \"{method}\"\n{multiplier}"
    )
}

#[test]
fn a_sliver_of_an_element_carries_no_more_pressure_than_its_neighbours() {
    for backend in ["iga", "fe"] {
        for degree in 1..=3 {
            for end in [0.501, 0.52, 0.55, 0.70001] {
                let wanted = solve(&beyond(backend, degree, end, "", "nitsche"), &[]);
                let force = contact(&wanted, "c").force[1];
                for multiplier in ["p/p", "p/p-2", "dual"] {
                    // p/p-2 exists from degree 2 on, duals of smooth splines of degree 3 on no part of an element
                    if multiplier == "p/p-2" && degree == 1 || multiplier == "dual" && degree == 3 && backend == "iga" {
                        continue;
                    }
                    let words = format!("multiplier = \"{multiplier}\"\n");
                    let found = solve(&beyond(backend, degree, end, &words, "lagrange"), &[]);
                    let c = contact(&found, "c");
                    let about = format!("{backend} {degree} {end} {multiplier}");
                    println!(
                        "{about}: pressure {:?}, half width {:?}, force {} of {force}",
                        c.pressure.max,
                        c.half_width.unwrap(),
                        c.force[1]
                    );
                    assert!((c.force[1] / force - 1.0).abs() < 0.02, "{about}: {} and {force}", c.force[1]);
                    // the last rows of p/p may be open, as where the master ends with an element; the zone of the others is whole
                    let whole = multiplier != "p/p" || degree == 1;
                    assert!(c.area <= end + 1e-9 && (!whole || (c.area - end).abs() < 1e-9), "{about}: area {}", c.area);
                    // the pressure has a root singularity at the end; half an element wide means stay below five times the mean
                    assert!(c.pressure.max < 5.0 * force.abs() / end, "{about}: {}", c.pressure.max);
                    // where the last rows are open the zone ends within the slave, too coarse for a half width
                    let width = c.half_width.unwrap() / (0.5 * end);
                    assert!((width.is_nan() && !whole) || (width - 1.0).abs() < 0.01, "{about}: {:?}", c.half_width.unwrap());
                }
            }
        }
    }
}

/// Shares of elements that are equal, or a tenth: rounding, which other units change, decides nothing.
#[test]
fn units_do_not_change_what_lives_on_slivers() {
    let plane = |scale: f64| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 300.0\npoisson = 0.2\n\
             [[patch]]\nname = \"lo\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [2, 1], scale = {scale:?} }}\nelements = [4, 2]\n\
             [[patch]]\nname = \"up\"\ngeometry = {{ kind = \"box\", min = [0.25, 1], max = [1.55, 2], scale = {scale:?} }}\nelements = [3, 3]\n\
             [[boundary]]\non = \"lo.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"up.top\"\ndirichlet = {{ x = 0, y = {:e} }}\n\
             [[contact]]\nname = \"c\"\nslave = \"lo.top\"\nmaster = \"up.bottom\"\n",
            -1e-3 * scale
        )
    };
    // an element at a corner has the same in common with both of its neighbours
    let space = |scale: f64| {
        let block = |name: &str, min: [f64; 3], max: [f64; 3], elements: [usize; 3], kind: &str| {
            format!(
                "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = {min:?}, max = {max:?}, scale = {scale:?} }}\n\
                 elements = {elements:?}\n{kind}"
            )
        };
        String::from("[model]\nphysics = \"elasticity\"\ndimension = 3\n[[material]]\nname = \"m\"\nyoung = 300.0\npoisson = 0.2\n")
            + &block("lo", [0.0, 0.0, 0.0], [2.0, 1.5, 1.0], [8, 6, 1], "")
            + &block("up", [0.25, 0.2, 1.0], [1.55, 1.1, 2.0], [2, 2, 1], "backend = \"fe\"\ncells = \"simplex\"\n")
            + &format!(
                "[[boundary]]\non = \"lo.bottom\"\nfix = [\"x\", \"y\", \"z\"]\n\
                 [[boundary]]\non = \"up.top\"\ndirichlet = {{ x = 0, y = 0, z = {:e} }}\n\
                 [[contact]]\nname = \"c\"\nslave = \"lo.top\"\nmaster = \"up.bottom\"\n",
                -1e-3 * scale
            )
    };
    for text in [&plane as &dyn Fn(f64) -> String, &space] {
        let wanted = contact(&solve(&text(1.0), &[]), "c").pressure.max;
        for scale in [3.0, 0.7, 1e6, 1e-6] {
            let found = contact(&solve(&text(scale), &[]), "c").pressure.max;
            assert!((found / wanted - 1.0).abs() < 1e-8, "{scale}: {found} and {wanted}");
        }
    }
}
