//! Segments of two curves: published unit values, tilings of random grids, vertices that nearly coincide.

use faying::assembly::gauss_rules;
use faying::basis::{BSpline, Basis, Elements, Order, ShapeTable};
use faying::check::{SegmentLimits, coupling, interface_quadrature, obstacle};
use faying::contact::{ContactKinematics, HalfPlane, Hit, Moved, Obstacle, Sphere, Surface};
use faying::coupling::interface::{Chain, MasterSums, MergedCurve, SlaveRule, Tolerance, crossing, slave_segments};
use faying::coupling::multiplier::{Ends, MultiplierError, MultiplierKind, build, side_ends};
use faying::coupling::{Coupling, CouplingError, Interface, InterfaceQuadrature, Mortar, Side};
use faying::geometry::shapes::rectangle;
use faying::geometry::{Bounds, ControlPoints, Geometry, MapTable};
use faying::linalg::Vector;
use faying::quadrature::{PerElement, Quadrature, TensorRule};
use faying::space::{Body, Field, FunctionSpace, Patch, PatchSpec, Space, Trace};
use rayon::prelude::*;
use std::sync::Arc;

/// A curve given by a formula: (x, dx/dt, d2x/dt2) at t.
type Shape = fn(f64) -> [Vector<2>; 3];

fn line(t: f64) -> [Vector<2>; 3] {
    [Vector::<2>::new(0.3 + 2.0 * t, 0.1 - t), Vector::<2>::new(2.0, -1.0), Vector::<2>::zeros()]
}

/// 120 degrees of a circle of radius 1.5.
fn arc(t: f64) -> [Vector<2>; 3] {
    let (r, w) = (1.5, 2.0 * std::f64::consts::PI / 3.0);
    let (s, c) = (w * t).sin_cos();
    [Vector::<2>::new(r * c, r * s), Vector::<2>::new(-s, c) * (r * w), Vector::<2>::new(-c, -s) * (r * w * w)]
}

/// Elements of a curve: intervals of t, walked backwards where from > to.
#[derive(Debug, Clone)]
struct Curve {
    intervals: Vec<(f64, f64)>,
    shape: Shape,
    /// Replaces every element by a Lagrange facet of this degree through points of the curve; 0: the curve itself.
    facet_degree: usize,
}

impl Curve {
    fn new(breakpoints: &[f64], shape: Shape, reversed: bool) -> Self {
        let mut intervals: Vec<(f64, f64)> = breakpoints.windows(2).map(|w| (w[0], w[1])).collect();
        if reversed {
            intervals.reverse();
            intervals.iter_mut().for_each(|i| *i = (i.1, i.0));
        }
        Self { intervals, shape, facet_degree: 0 }
    }
}

impl Elements for Curve {
    fn num_elements(&self) -> usize {
        self.intervals.len()
    }
}

impl Geometry<1, 2> for Curve {
    fn map(&self, element: usize, xi: &[Vector<1>], order: Order, table: &mut MapTable<1, 2>) {
        let (a, b) = self.intervals[element];
        let p = self.facet_degree;
        let facet = |s: f64| {
            // Lagrange interpolation at equidistant points, derivatives by the product rule
            let mut out = [Vector::<2>::zeros(); 3];
            for i in 0..=p {
                let x = (self.shape)(a + (b - a) * i as f64 / p as f64)[0];
                let (mut l, mut d, mut dd) = (1.0, 0.0, 0.0);
                for j in (0..=p).filter(|&j| j != i) {
                    let (factor, slope) = ((s * p as f64 - j as f64) / (i as f64 - j as f64), p as f64 / (i as f64 - j as f64));
                    (l, d, dd) = (l * factor, d * factor + l * slope, dd * factor + 2.0 * d * slope);
                }
                out = [out[0] + x * l, out[1] + x * d, out[2] + x * dd];
            }
            out
        };
        table.reset(xi.len(), order);
        for (q, xi) in xi.iter().enumerate() {
            let [x, d, dd] = if p > 0 {
                facet(xi[0])
            } else {
                let [x, d, dd] = (self.shape)(a + (b - a) * xi[0]);
                [x, d * (b - a), dd * (b - a) * (b - a)]
            };
            table.x[q] = x;
            if order >= Order::Gradients {
                table.jacobian[q].set_column(0, &d);
            }
            if order >= Order::Hessians {
                (0..2).for_each(|i| table.hessian[q][i][(0, 0)] = dd[i]);
            }
        }
    }
    fn bounds(&self, element: usize) -> Bounds<2> {
        let mut table = MapTable::new();
        let points: Vec<Vector<1>> = (0..=16).map(|k| Vector::<1>::new(k as f64 / 16.0)).collect();
        self.map(element, &points, Order::Values, &mut table);
        let b = Bounds::around(&table.x).unwrap();
        b.inflated(0.02 * b.diagonal())
    }
}

/// Splines of degree p and most continuity on a curve.
fn spline_on(breakpoints: &[f64], degree: usize, shape: Shape, reversed: bool) -> Arc<dyn Space<1, 2>> {
    let curve = Curve::new(breakpoints, shape, reversed);
    let mut own: Vec<f64> = breakpoints.to_vec();
    if reversed {
        own = own.iter().rev().map(|t| 1.0 - t).collect();
    }
    let basis = BSpline::<f64>::from_breakpoints(degree, &own, &vec![degree as isize - 1; own.len() - 2]);
    Arc::new(FunctionSpace { basis, geometry: curve })
}

/// A side without a body behind it: all that mortar rows need.
fn bare_trace(space: &Arc<dyn Space<1, 2>>, first: usize) -> Trace<1, 2> {
    let n = space.num_functions();
    Trace { space: Arc::clone(space), dofs: (first..first + n).collect(), facets: Vec::new(), outward: vec![1.0; space.num_elements()] }
}

fn gauss(n: usize, elements: usize) -> PerElement<1> {
    PerElement::new(vec![Arc::new(TensorRule::<1>::gauss([n]))], vec![0; elements])
}

fn uniform(n: usize) -> Vec<f64> {
    (0..=n).map(|k| k as f64 / n as f64).collect()
}

/// A grid on [0, 1] with sizes drawn by a small linear congruential generator.
fn random_grid(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    let mut sizes = Vec::new();
    for _ in 0..n {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        sizes.push(0.05 + (state >> 11) as f64 / (1u64 << 53) as f64);
    }
    let total: f64 = sizes.iter().sum();
    let mut at = 0.0;
    let mut grid = vec![0.0];
    for s in &sizes[..n - 1] {
        at += s / total;
        grid.push(at);
    }
    grid.push(1.0);
    grid
}

/// Dense rows of one part, columns of one component.
fn dense(entries: &[(usize, usize, f64)], rows: usize, cols: std::ops::Range<usize>) -> Vec<Vec<f64>> {
    let mut out = vec![vec![0.0; cols.len()]; rows];
    entries.iter().for_each(|&(i, j, v)| out[i][j - cols.start] += v);
    out
}

// Mortar2D.jl, documentation of its segment calculations: slave (1,2)-(3,2), master (2,2)-(0,2).
#[test]
fn segment_values_are_those_of_mortar2d() {
    fn slave_shape(t: f64) -> [Vector<2>; 3] {
        [Vector::<2>::new(1.0 + 2.0 * t, 2.0), Vector::<2>::new(2.0, 0.0), Vector::<2>::zeros()]
    }
    fn master_shape(t: f64) -> [Vector<2>; 3] {
        [Vector::<2>::new(2.0 - 2.0 * t, 2.0), Vector::<2>::new(-2.0, 0.0), Vector::<2>::zeros()]
    }
    let (slave, master) = (spline_on(&[0.0, 1.0], 1, slave_shape, false), spline_on(&[0.0, 1.0], 1, master_shape, false));
    let segments = MergedCurve::tied(2, Tolerance::Exact).segments(&*slave, &*master).unwrap();
    assert_eq!(segments.num_pieces(), 1);
    assert!((segments.report.covered - 1.0).abs() < 1e-15 && (segments.report.share[0] - 0.5).abs() < 1e-15);
    let (a, b) = (bare_trace(&slave, 0), bare_trace(&master, 2));
    let psi = build(&slave, MultiplierKind::Lowered(0), &[]).unwrap();
    let field = Field { first: 0, components: 1 };
    let interface = Interface {
        slave: Side { trace: &a, field, flux: None },
        master: Some(Side { trace: &b, field, flux: None }),
        multiplier: &[&*psi],
        segments: &segments,
        master_segments: None,
        direction: None,
    };
    let rows = Mortar.assemble(&interface, 4).unwrap().constraint;
    let (d, m) = (dense(&rows.slave.entries, 2, 0..2), dense(&rows.master.entries, 2, 2..4));
    let (expected_d, expected_m) = ([[14.0, 4.0], [4.0, 2.0]], [[13.0, 5.0], [5.0, 1.0]]);
    for j in 0..2 {
        for k in 0..2 {
            assert!((d[j][k] - expected_d[j][k] / 24.0).abs() < 1e-15, "D = {d:?}");
            assert!((-m[j][k] - expected_m[j][k] / 24.0).abs() < 1e-15, "M = {m:?}");
        }
    }
    coupling(&Mortar, &interface, 4).unwrap();
}

// Mortar2D.jl: from (0,0) along (3/5, -4/5) to the line (7,2)-(4,-2), xi = 11/6 on [-1, 1].
#[test]
fn projection_along_a_normal_is_that_of_mortar2d() {
    fn shape(t: f64) -> [Vector<2>; 3] {
        [Vector::<2>::new(7.0 - 3.0 * t, 2.0 - 4.0 * t), Vector::<2>::new(-3.0, -4.0), Vector::<2>::zeros()]
    }
    let master = Curve::new(&[0.0, 1.0], shape, false);
    // the line along n is the plane at right angles to (4/5, 3/5)
    let xi = crossing(&master, 0, &Vector::<2>::zeros(), &Vector::<2>::new(0.8, 0.6), [-1.0, 3.0], &mut MapTable::new());
    assert!((2.0 * xi - 1.0 - 11.0 / 6.0).abs() < 1e-15, "{xi}");
}

#[test]
fn random_grids_on_straight_and_curved_sides_are_tiled_and_keep_both_column_sums() {
    let mut cases = Vec::new();
    for shape in [line as Shape, arc as Shape] {
        for reversed in [false, true] {
            for (n, m) in [(1, 1), (1, 7), (3, 2), (5, 8), (13, 12), (40, 17), (1, 1000), (1000, 1)] {
                for seed in 0..3u64 {
                    cases.push((shape, reversed, n, m, seed));
                }
            }
        }
    }
    cases.par_iter().for_each(|&(shape, reversed, n, m, seed)| {
        let (slave, master) =
            (spline_on(&random_grid(n, seed), 2, shape, false), spline_on(&random_grid(m, seed + 77), 2, shape, reversed));
        // on an arc of 120 degrees in one element a map of degree 2 needs many points; the shapes here are smooth
        let points = if n.min(m) == 1 { 20 } else { 12 };
        let rules = [gauss(points, n), gauss(points, m)];
        let own: [&dyn Quadrature<1>; 2] = [&rules[0], &rules[1]];
        let rule = MergedCurve::tied(points, Tolerance::Exact);
        interface_quadrature(&rule, &*slave, &*master, own, SegmentLimits::default())
            .unwrap_or_else(|e| panic!("n = {n}, m = {m}, seed {seed}, reversed {reversed}: {e}"));
    });
}

#[test]
fn vertices_that_nearly_coincide_lose_and_double_nothing() {
    let mut shifts = vec![0.0];
    for k in 1..=16 {
        shifts.extend([10f64.powi(-k), -(10f64.powi(-k))]);
    }
    let mut cases = Vec::new();
    for shape in [line as Shape, arc as Shape] {
        for reversed in [false, true] {
            for &shift in &shifts {
                cases.push((shape, reversed, shift));
            }
        }
    }
    cases.par_iter().for_each(|&(shape, reversed, shift)| {
        let slave_grid = uniform(8);
        let master_grid: Vec<f64> = slave_grid
            .iter()
            .enumerate()
            .map(|(k, t)| if k % 8 == 0 { *t } else { t + shift / 8.0 * if k % 3 == 0 { -0.5 } else { 1.0 } })
            .collect();
        let (slave, master) = (spline_on(&slave_grid, 1, shape, false), spline_on(&master_grid, 1, shape, reversed));
        let rules = [gauss(8, 8), gauss(8, 8)];
        let rule = MergedCurve::tied(8, Tolerance::Exact);
        interface_quadrature(&rule, &*slave, &*master, [&rules[0], &rules[1]], SegmentLimits::default())
            .unwrap_or_else(|e| panic!("shift {shift:e}, reversed {reversed}: {e}"));
        let pieces = rule.segments(&*slave, &*master).unwrap().num_pieces();
        assert!((8..=16).contains(&pieces), "{pieces} pieces for shift {shift:e}");
    });
}

#[test]
fn a_slave_rule_tiles_but_misses_the_masters_columns() {
    let (slave, master) = (spline_on(&uniform(5), 2, line, false), spline_on(&uniform(8), 2, line, true));
    let rules = [gauss(4, 5), gauss(4, 8)];
    let own: [&dyn Quadrature<1>; 2] = [&rules[0], &rules[1]];
    let rule = SlaveRule::tied(4, Tolerance::Exact);
    interface_quadrature(&rule, &*slave, &*master, own, SegmentLimits { columns: None, ..SegmentLimits::default() }).unwrap();
    let answer = interface_quadrature(&rule, &*slave, &*master, own, SegmentLimits::default());
    assert!(answer.is_err_and(|e| e.contains("over the master")));
}

#[test]
fn kinked_facets_of_one_arc_are_paired_within_a_quarter_of_an_element() {
    for (n, m, p, q) in [(6, 9, 1, 1), (9, 6, 1, 2), (7, 5, 2, 1), (12, 40, 2, 2), (40, 12, 3, 1)] {
        for reversed in [false, true] {
            let (mut a, mut b) = (Curve::new(&uniform(n), arc, false), Curve::new(&uniform(m), arc, reversed));
            (a.facet_degree, b.facet_degree) = (p, q);
            let slave = FunctionSpace { basis: BSpline::<f64>::uniform(1, n, 0), geometry: a };
            let master = FunctionSpace { basis: BSpline::<f64>::uniform(1, m, 0), geometry: b };
            let rules = [gauss(8, n), gauss(8, m)];
            let rule = MergedCurve::tied(8, Tolerance::Local);
            // the sagitta of a chord: h^2 / 8 r; columns agree to the gap only
            let h = std::f64::consts::PI / n.min(m) as f64;
            let limits = SegmentLimits { outside: 0.2, distance: h * h / 8.0, columns: Some(0.1), ..SegmentLimits::default() };
            interface_quadrature(&rule, &slave, &master, [&rules[0], &rules[1]], limits)
                .unwrap_or_else(|e| panic!("{n} of degree {p} on {m} of degree {q}: {e}"));
            let exact = MergedCurve::tied(8, Tolerance::Exact).segments(&slave, &master);
            assert!(matches!(exact, Err(CouplingError::Apart { .. })), "{exact:?}");
        }
    }
}

#[test]
fn sides_apart_say_how_far_and_where() {
    fn outer(t: f64) -> [Vector<2>; 3] {
        arc(t).map(|v| v * (1.75 / 1.5))
    }
    let (slave, master) = (Curve::new(&uniform(4), arc, false), Curve::new(&uniform(3), outer, false));
    match MergedCurve::tied(4, Tolerance::Exact).segments(&slave, &master) {
        Err(CouplingError::Apart { distance, at, .. }) => {
            assert!((distance - 0.25).abs() < 1e-12);
            assert!((at[0].hypot(at[1]) - 1.5).abs() < 1e-12);
        }
        other => panic!("{other:?}"),
    }
    // across the same gap contact pairs every point, and a short reach pairs none
    let facing = MergedCurve::facing(4, None).segments(&slave, &master).unwrap();
    assert!((facing.report.covered - facing.report.slave_measure).abs() < 1e-12);
    assert_eq!(MergedCurve::facing(4, Some(0.2)).segments(&slave, &master).unwrap().num_pieces(), 0);
}

#[test]
fn what_lies_beyond_the_masters_ends_faces_nothing() {
    fn long(t: f64) -> [Vector<2>; 3] {
        [Vector::<2>::new(4.0 * t - 1.0, 0.5), Vector::<2>::new(4.0, 0.0), Vector::<2>::zeros()]
    }
    fn short(t: f64) -> [Vector<2>; 3] {
        [Vector::<2>::new(t, 0.0), Vector::<2>::new(1.0, 0.0), Vector::<2>::zeros()]
    }
    let (slave, master) = (Curve::new(&uniform(3), long, false), Curve::new(&uniform(5), short, true));
    for rule in [&MergedCurve::facing(3, None) as &dyn InterfaceQuadrature<1, 2>, &SlaveRule::facing(2, None)] {
        let s = rule.segments(&slave, &master).unwrap();
        assert!((s.report.covered - 1.0).abs() < 1e-12, "{}", s.report.covered);
        assert!((s.report.slave_measure - 4.0).abs() < 1e-12);
    }
    let merged = MergedCurve::facing(3, None).segments(&slave, &master).unwrap();
    assert!((merged.report.covered - 1.0).abs() < 1e-12);
    // elements are 4/3 long: the master lies in the first (a third of it: 0 to 1/3) and the second (1/3 to 1)
    for (share, expected) in merged.report.share.iter().zip([0.25, 0.5, 0.0]) {
        assert!((share - expected).abs() < 1e-12, "{share}");
    }
}

// A concave corner: the closest point jumps over the elements in it.
#[test]
fn jumps_of_the_closest_point_are_cut() {
    fn valley(t: f64) -> [Vector<2>; 3] {
        let s = 2.0 * t - 1.0;
        [Vector::<2>::new(s, 2.0 * s * s), Vector::<2>::new(2.0, 8.0 * s), Vector::<2>::new(0.0, 16.0)]
    }
    fn lid(t: f64) -> [Vector<2>; 3] {
        [Vector::<2>::new(0.8 * t - 0.41, 1.5), Vector::<2>::new(0.8, 0.0), Vector::<2>::zeros()]
    }
    let (slave, master) = (Curve::new(&uniform(3), lid, false), Curve::new(&uniform(16), valley, false));
    let s = MergedCurve::facing(4, Some(5.0)).segments(&slave, &master).unwrap();
    assert!((s.measure() - 0.8).abs() < 1e-12);
    let (mut here, mut there, mut grid) = (MapTable::new(), MapTable::new(), MapTable::new());
    for piece in 0..s.num_pieces() {
        slave.map(s.slave[piece], &s.slave_xi[s.points(piece)], Order::Values, &mut here);
        master.map(s.master[piece], &s.master_xi[s.points(piece)], Order::Values, &mut there);
        for (x, y) in here.x.iter().zip(&there.x) {
            let mut brute = f64::INFINITY;
            for e in 0..16 {
                let points: Vec<Vector<1>> = (0..=200).map(|k| Vector::<1>::new(k as f64 / 200.0)).collect();
                master.map(e, &points, Order::Values, &mut grid);
                brute = grid.x.iter().fold(brute, |m, p| m.min((p - x).norm()));
            }
            assert!((x - y).norm() < brute + 1e-9, "{x:?}: {} against {brute}", (x - y).norm());
        }
    }
}

#[test]
fn chains_are_walked_from_end_to_end_in_any_order_of_elements() {
    let mut curve = Curve::new(&uniform(6), arc, false);
    curve.intervals = [3usize, 0, 5, 1, 4, 2].iter().map(|&k| curve.intervals[k]).collect();
    curve.intervals[1] = (curve.intervals[1].1, curve.intervals[1].0);
    let walk = Chain::of(&curve).walk();
    let order: Vec<usize> = walk.iter().map(|w| w.0).collect();
    assert!(order == [1, 3, 5, 0, 4, 2] || order == [2, 4, 0, 5, 3, 1], "{order:?}");
    assert!(walk.iter().filter(|w| w.1).count() == 1 || walk.iter().filter(|w| w.1).count() == 5);
}

#[test]
fn multipliers_follow_the_words_of_a_case() {
    let names = ["auto", "p/p", "p/p-1", "p/p-2", "p/p-4", "constant", "dual"];
    for name in names {
        assert_eq!(name.parse::<MultiplierKind>().unwrap().to_string(), name);
    }
    for wrong in ["p/q", "p/p-", "p/p-0", "p/p-x", "p/p-02", ""] {
        assert!(matches!(wrong.parse::<MultiplierKind>(), Err(MultiplierError::Unknown { .. })), "{wrong}");
    }
    assert!(
        MultiplierKind::Lowered(1).is_unstable() && MultiplierKind::Lowered(3).is_unstable() && !MultiplierKind::Lowered(2).is_unstable()
    );
    let count = |p: usize, name: &str, ends: &[bool]| {
        let space = spline_on(&uniform(5), p, line, false);
        build(&space, name.parse().unwrap(), ends).map(|b| b.num_functions())
    };
    // n elements, most continuity: n + p functions
    assert_eq!(count(3, "p/p", &[false, false]).unwrap(), 8);
    assert_eq!(count(3, "p/p", &[true, false]).unwrap(), 7);
    assert_eq!(count(3, "p/p", &[true, true]).unwrap(), 6);
    assert_eq!(count(3, "p/p-2", &[true, true]).unwrap(), 6);
    assert_eq!(count(3, "auto", &[true, true]).unwrap(), 6);
    assert_eq!(count(1, "auto", &[true, true]).unwrap(), 4);
    assert_eq!(count(4, "p/p-4", &[]).unwrap(), 5);
    assert_eq!(count(3, "constant", &[]).unwrap(), 5);
    let error = count(1, "p/p-2", &[]).unwrap_err();
    assert_eq!(error.to_string(), "there is no multiplier \"p/p-2\" with degree 1; this side has p/p, p/p-1, constant, dual");
    let full = MultiplierKind::Uniform { degree: 2, continuity: None, ends: Ends::Full };
    let space = spline_on(&uniform(5), 2, line, false);
    assert_eq!(build(&space, full, &[true, true]).unwrap().num_functions(), 7);
    let data = MultiplierKind::Uniform { degree: 1, continuity: Some(0), ends: Ends::Auto };
    assert_eq!(build(&space, data, &[true, true]).unwrap().num_functions(), 6);
    assert_eq!(side_ends(&*space).len(), 2);
}

#[test]
fn lowered_ends_lose_a_degree_there_and_still_sum_to_one() {
    for p in 1..=5 {
        for elements in [2, 3, 7] {
            let space = spline_on(&random_grid(elements, p as u64), p, line, false);
            let psi = build(&space, MultiplierKind::Lowered(0), &[true, true]).unwrap();
            let mut table = ShapeTable::new();
            for element in [0, elements - 1] {
                let points: Vec<Vector<1>> = (0..=p).map(|k| Vector::<1>::new(k as f64 / p as f64)).collect();
                psi.tabulate(element, &points, Order::Values, &mut table);
                for q in 0..=p {
                    assert!((table.values(q).iter().sum::<f64>() - 1.0).abs() < 1e-12);
                }
                for a in 0..table.num_functions() {
                    // the p-th difference of a polynomial of degree p - 1 vanishes
                    let mut d: Vec<f64> = (0..=p).map(|q| table.values(q)[a]).collect();
                    for _ in 0..p {
                        d = d.windows(2).map(|w| w[1] - w[0]).collect();
                    }
                    assert!(d[0].abs() < 1e-12, "degree {p}, element {element}, function {a}: {}", d[0]);
                }
            }
        }
    }
}

#[test]
fn lowered_ends_keep_splines_of_any_smoothness_non_negative() {
    for p in 1..=6_usize {
        for continuity in 0..p as isize {
            for elements in [2, 3, 7] {
                let spline = BSpline::<f64>::from_breakpoints(p, &random_grid(elements, 3 + p as u64), &vec![continuity; elements - 1]);
                let ends = side_ends(&spline);
                let full = spline.num_functions();
                let psi = faying::coupling::multiplier::end_lowered(Box::new(spline), &ends).unwrap();
                assert_eq!(psi.num_functions(), full - 2);
                faying::check::non_negative(&*psi).unwrap();
                faying::check::partition_of_unity(&*psi).unwrap();
            }
        }
    }
    // the end element of a Lagrange trace has the Bernstein functions of one degree less
    let cubic = BSpline::<f64>::uniform(3, 2, 0);
    let ends = side_ends(&cubic);
    let psi = faying::coupling::multiplier::end_lowered(Box::new(cubic), &ends).unwrap();
    let (mut table, t) = (ShapeTable::new(), 0.3);
    psi.tabulate(0, &[Vector::<1>::new(t)], Order::Values, &mut table);
    for (found, expected) in table.values(0).iter().zip([(1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t), t * t]) {
        assert!((found - expected).abs() < 1e-14);
    }
}

#[test]
fn one_element_lowered_at_both_ends_loses_two_degrees() {
    let space = spline_on(&uniform(1), 3, line, false);
    assert_eq!(build(&space, MultiplierKind::Lowered(0), &[true, true]).unwrap().num_functions(), 2);
    let linear = spline_on(&uniform(1), 1, line, false);
    assert!(matches!(build(&linear, MultiplierKind::Lowered(0), &[true, true]), Err(MultiplierError::NothingLeft { .. })));
}

#[test]
fn obstacles_project_to_their_closest_points() {
    let points: Vec<Vector<2>> = (0..60).map(|k| Vector::<2>::new((k % 10) as f64 * 0.31 - 1.2, (k / 10) as f64 * 0.27 - 0.4)).collect();
    let plane = HalfPlane::try_new(Vector::<2>::new(0.1, 0.2), Vector::<2>::new(1.0, 3.0)).unwrap();
    obstacle::<1, 2, f64>(&plane, &points, 1e-12).unwrap();
    obstacle::<1, 2, f64>(&Moved { target: plane, by: Vector::<2>::new(0.0, -0.7) }, &points, 1e-12).unwrap();
    for inside in [false, true] {
        let circle = Sphere { center: Vector::<2>::new(0.05, 0.02), radius: 0.7, inside };
        obstacle::<1, 2, f64>(&circle, &points, 1e-12).unwrap();
        let hit = Obstacle::<1, 2>::project(&circle, &Vector::<2>::new(0.05, 1.02), &Vector::<2>::new(0.0, -1.0)).unwrap();
        assert!((hit.gap - if inside { -0.3 } else { 0.3 }).abs() < 1e-14);
    }
    assert!(HalfPlane::try_new(Vector::<2>::zeros(), Vector::<2>::zeros()).is_none());
}

#[test]
fn a_corner_between_faces_that_both_oppose_gives_the_one_that_opposes_more() {
    // a punch from above, flat for |x| < 0.5, with chamfers beside; the obstacle is to the right of its outline
    for degrees in [15.0, 40.0, 58.0] {
        let (s, c) = f64::to_radians(degrees).sin_cos();
        let points: Vec<Vector<2>> = [[0.5 + c, s], [0.5, 0.0], [-0.5, 0.0], [-0.5 - c, s]].map(Vector::from).to_vec();
        let punch = Surface::left_of(Arc::new(ControlPoints { basis: BSpline::uniform(1, 3, 0), points }), None);
        for depth in [1e-3, 0.05, 0.1] {
            for beside in [0.02, 0.1, 0.3] {
                let at = |x: f64| punch.project(&Vector::<2>::new(x, depth), &Vector::<2>::new(0.0, 1.0)).unwrap();
                for sign in [1.0, -1.0] {
                    // straight above the flat face, also where a chamfer is nearer
                    let flat = at(sign * (0.5 - beside * depth));
                    assert!(
                        (flat.gap + depth).abs() < 1e-14 && (flat.normal[1] + 1.0).abs() < 1e-14,
                        "{degrees} {depth} {beside}: {flat:?}"
                    );
                    let chamfer = at(sign * (0.5 + beside * depth));
                    let known = beside * depth * s - depth * c;
                    assert!(
                        (chamfer.gap - known).abs() < 1e-14 && chamfer.normal[0] * sign > 0.0,
                        "{degrees} {depth} {beside}: {chamfer:?}"
                    );
                }
            }
        }
    }
}

/// A half-plane with a fault in its hits.
#[derive(Debug)]
struct Faulty(HalfPlane<2>, fn(&mut Hit<1, 2>));

impl Obstacle<1, 2> for Faulty {
    fn project(&self, x: &Vector<2>, outward: &Vector<2>) -> Option<Hit<1, 2>> {
        let mut hit = self.0.project(x, outward)?;
        (self.1)(&mut hit);
        Some(hit)
    }
}

#[test]
fn faults_of_obstacles_are_found_by_their_checker_and_where_contact_meets_them() {
    let plane = HalfPlane::try_new(Vector::<2>::new(0.0, -0.1), Vector::<2>::new(0.0, 1.0)).unwrap();
    let points: Vec<Vector<2>> = (0..20).map(|k| Vector::<2>::new(0.1 * f64::from(k), 0.03 * f64::from(k))).collect();
    obstacle(&Faulty(plane, |_| {}), &points, 1e-12).unwrap();
    let faults: [(fn(&mut Hit<1, 2>), &str); 6] = [
        (|hit| hit.normal *= 3.0, "length"),
        (|hit| (hit.normal, hit.gap) = (hit.normal * 3.0, hit.gap * 3.0), "length"),
        (|hit| hit.normal *= 1.0 - 1e-9, "length"),
        (|hit| hit.normal = -hit.normal, "along the normal it is"),
        (|hit| hit.gap = f64::NAN, "the gap at"),
        (|hit| (hit.x[1], hit.gap) = (hit.x[1] + 0.1 * hit.gap, 0.9 * hit.gap), "not on the surface"),
    ];
    for (fault, words) in faults {
        let error = obstacle(&Faulty(plane, fault), &points, 1e-12).unwrap_err();
        assert!(error.contains(words), "{words}: {error}");
    }
    // the bottom of a square above the half-plane
    let square = Patch::<1, 2>::try_new(&PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0]).unwrap())).unwrap();
    let mut trace = square.trace("v0").unwrap();
    let segments = slave_segments(&*trace.space, &gauss_rules(&*trace.space, 0));
    let frames = |trace: &Trace<1, 2>, fault| ContactKinematics::against_obstacle(trace, &Faulty(plane, fault), &segments, None);
    assert_eq!(frames(&trace, |_| {}).unwrap().1.x.len(), segments.ds.len());
    assert!(matches!(frames(&trace, |hit| hit.normal *= 3.0), Err(CouplingError::Missing(text)) if text.contains("length 3")));
    // a side whose normal points into its body faces nothing
    trace.outward.iter_mut().for_each(|sign| *sign = -*sign);
    assert!(frames(&trace, |_| {}).unwrap().1.x.is_empty());
}

#[test]
fn segments_and_rows_are_the_same_bits_for_any_number_of_threads() {
    let (slave, master) = (spline_on(&random_grid(40, 5), 3, arc, false), spline_on(&random_grid(33, 6), 2, arc, true));
    let (a, b) = (bare_trace(&slave, 0), bare_trace(&master, slave.num_functions()));
    let psi = build(&slave, MultiplierKind::Auto, &[]).unwrap();
    let unknowns = 2 * (slave.num_functions() + master.num_functions());
    let make = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let segments = MergedCurve::tied(5, Tolerance::Exact).segments(&*slave, &*master).unwrap();
            let field = Field { first: 0, components: 2 };
            let interface = Interface {
                slave: Side { trace: &a, field, flux: None },
                master: Some(Side { trace: &b, field, flux: None }),
                multiplier: &[&*psi],
                segments: &segments,
                master_segments: None,
                direction: None,
            };
            let rows = Mortar.assemble(&interface, unknowns).unwrap();
            (segments, rows)
        })
    };
    let one = make(1);
    for threads in [2, 3, 7] {
        assert!(make(threads) == one, "{threads} threads give other numbers");
    }
}

#[test]
fn a_slave_side_that_ends_in_no_number_is_told_by_the_sums_over_the_master() {
    // an offset line whose last point is no number: every point within is
    fn broken(t: f64) -> [Vector<2>; 3] {
        let [x, d, dd] = line(t);
        [if t < 1.0 { x + Vector::<2>::new(0.0, 0.01) } else { x * f64::NAN }, d, dd]
    }
    let [slave, master] = [(uniform(3), broken as Shape), (uniform(2), line as Shape)].map(|(grid, shape)| Curve::new(&grid, shape, false));
    let found = MasterSums::facing(3, None).segments(&slave, &master);
    assert!(matches!(found, Err(CouplingError::NotFinite { element: 2 })), "{found:?}");
}
