//! Observed rates of mortar coupling: every pair of backends, both pairings, slave finer and coarser; the quadrature study.

use crate::cases::solved;
use crate::choices::{Choices, Discretisation};
use crate::exact::{Expr, Solved};
use crate::setting::{Setting, Shape};
use crate::tied::How;
use faying::basis::Cell;
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::shapes::rectangle;
use faying::physics::Conductor;
use faying::problem::{Exact, Integration, Value};
use faying::space::BasisKind;
use rayon::prelude::*;
use std::f64::consts::PI;

/// The solution of benchmarks that others published rates for.
fn smooth() -> impl Exact + Clone {
    Solved(|[x, y, _]: [Expr; 3]| [(0.3 + 3.0 * x).cos() * y.exp() + (2.0 * PI * x * y).sin()])
}

/// A backend with its cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Spline,
    Tensor,
    Triangle,
}

/// One half of the square: elements along and across the interface.
#[derive(Clone, Copy, Debug)]
struct Half {
    kind: Kind,
    degree: usize,
    elements: [usize; 2],
}

impl Half {
    /// The patch from height y0 to y1.
    fn shape(self, name: &'static str, [y0, y1]: [f64; 2]) -> Shape<2> {
        let by_default = Discretisation {
            is_fe: self.kind != Kind::Spline,
            cells: if self.kind == Kind::Triangle { Cell::Simplex } else { Cell::Tensor },
            basis: if self.kind == Kind::Spline { BasisKind::BSpline } else { BasisKind::Auto },
            degree: self.degree,
            ..Discretisation::default()
        };
        Shape { by_default, ..Shape::new(name, rectangle([0.0, y0], [1.0, y1]).unwrap(), self.elements) }
    }
}

/// Poisson on (0,1)² cut at y = 1/2, tied across the cut.
#[derive(Clone, Copy, Debug)]
struct Squares {
    lower: Half,
    upper: Half,
    slave_is_lower: bool,
    how: How,
    /// Neumann data on the four sides that meet the interface; Dirichlet data there otherwise.
    neumann: bool,
}

/// Errors of u in L2 and H1, of lambda in L2; and the share of forces that are not in balance.
#[derive(Clone, Copy, Debug)]
struct Errors {
    errors: [f64; 3],
    balance: f64,
}

impl Squares {
    fn run(&self) -> Errors {
        let (mut s, none, one) = (Setting::new(), Choices::of(&[]), Conductor::<2>::try_new(1.0).unwrap());
        let lower = s.shape(&none, self.lower.shape("lower", [0.0, 0.5]), one.clone());
        let upper = s.shape(&none, self.upper.shape("upper", [0.5, 1.0]), one);
        s.exact(smooth());
        s.problem.prescribe(lower.side("v0"), 0, Value::Exact).unwrap();
        s.problem.prescribe(upper.side("v1"), 0, Value::Exact).unwrap();
        for side in [lower.side("u0"), lower.side("u1"), upper.side("u0"), upper.side("u1")] {
            if self.neumann {
                s.problem.traction(side, 0, Value::Exact).unwrap();
            } else {
                s.problem.prescribe(side, 0, Value::Exact).unwrap();
            }
        }
        let sides = [(lower, "v1"), (upper, "v0")];
        let (slave, master) = if self.slave_is_lower { (sides[0], sides[1]) } else { (sides[1], sides[0]) };
        s.tie("i", slave, master, self.how);
        let (solution, tie) = (solved(&s.problem), s.ties[0].id);
        let norms = solution.errors(&smooth()).into_iter().reduce(|a, b| a.hypot(b)).unwrap().error;
        let lambda = solution.lambda_error(tie).unwrap().error.sqrt();
        Errors { errors: [norms.l2, norms.h1, lambda], balance: solution.tie(tie).unwrap().balance }
    }
}

/// log2 of the errors of a level over those of the next.
fn rates(coarse: &Errors, fine: &Errors) -> [f64; 3] {
    std::array::from_fn(|k| (coarse.errors[k] / fine.errors[k]).log2())
}

/// Mortar with multipliers of so many degrees less.
fn lowered(by: usize) -> How {
    How::mortar(MultiplierKind::Lowered(by))
}

/// Levels of a sequence: three elements face two, times 2^level.
fn sequence(kinds: [Kind; 2], degree: usize, slave_is_finer: bool, how: How, levels: &[u32]) -> Vec<Errors> {
    levels
        .iter()
        .map(|&level| {
            let n = |k: usize| k << level;
            // squares: half as many across as along
            let half = |kind: Kind, k: usize| Half { kind, degree, elements: [n(k), n(k).div_ceil(2)] };
            let (lower, upper) = (half(kinds[0], 3), half(kinds[1], 2));
            Squares { lower, upper, slave_is_lower: slave_is_finer, how, neumann: false }.run()
        })
        .collect()
}

const PAIRS: [[Kind; 2]; 5] = [
    [Kind::Spline, Kind::Spline],
    [Kind::Tensor, Kind::Tensor],
    [Kind::Spline, Kind::Tensor],
    [Kind::Tensor, Kind::Spline],
    [Kind::Triangle, Kind::Spline],
];

/// Brivadis et al. (2015): L2(u) and L2(lambda) fall with p + 1 and p - 1/2 for p/p, with p + 1/2 and p - 1 for p/p-2; H1 with one order
/// less than L2(u). Lower bounds.
fn rates_of_theory(kinds: [Kind; 2]) {
    let mut cases = Vec::new();
    for degree in 1..=4usize {
        for finer in [true, false] {
            for lower in [0, 2] {
                if lower == 0 || degree >= 2 {
                    cases.push((degree, finer, lower));
                }
            }
        }
    }
    assert_eq!(cases.len(), 14);
    let failures: Vec<String> = cases
        .par_iter()
        .filter_map(|&(degree, finer, lower)| {
            let levels: &[u32] = if degree <= 2 { &[3, 4] } else { &[2, 3] };
            let found = sequence(kinds, degree, finer, lowered(lower), levels);
            let p = degree as f64;
            let theory = if lower == 0 { [p + 1.0, p, p - 0.5] } else { [p + 0.5, p - 0.5, p - 1.0] };
            let observed = rates(&found[0], &found[1]);
            let balance = found.iter().fold(0.0f64, |m, e| m.max(e.balance));
            let bad = (0..3).any(|k| observed[k].is_nan() || observed[k] < theory[k] - 0.1) || balance.is_nan() || balance > 1e-12;
            bad.then(|| {
                format!("{kinds:?} p = {degree} p/p-{lower}, slave finer: {finer}: {observed:?} below {theory:?}, balance {balance:e}")
            })
        })
        .collect();
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), cases.len(), failures.join("\n"));
}

#[test]
fn splines_tied_to_splines_converge_at_the_rates_of_theory() {
    rates_of_theory(PAIRS[0]);
}

#[test]
fn quadrilaterals_tied_to_quadrilaterals_converge_at_the_rates_of_theory() {
    rates_of_theory(PAIRS[1]);
}

#[test]
fn splines_tied_to_quadrilaterals_converge_at_the_rates_of_theory() {
    rates_of_theory(PAIRS[2]);
}

#[test]
fn quadrilaterals_tied_to_splines_converge_at_the_rates_of_theory() {
    rates_of_theory(PAIRS[3]);
}

#[test]
fn triangles_tied_to_splines_converge_at_the_rates_of_theory() {
    rates_of_theory(PAIRS[4]);
}

/// Two levels with Neumann ends; elements along on the slave (lower) and master side, half as many across, rounded down.
fn neumann(kind: Kind, degree: usize, slave: [usize; 2], how: How) -> ([Errors; 2], [f64; 3]) {
    let found: Vec<Errors> = slave
        .par_iter()
        .map(|&n| {
            let half = |k: usize| Half { kind, degree, elements: [k, k / 2] };
            Squares { lower: half(n), upper: half(n * 2 / 3), slave_is_lower: true, how, neumann: true }.run()
        })
        .collect();
    let observed = rates(&found[0], &found[1]);
    ([found[0], found[1]], observed)
}

// the last observed rates of L2(u), H1, L2(lambda) of the same study, to the digit they are printed with
#[test]
fn last_rates_of_splines_are_those_of_the_table() {
    let table: [(usize, usize, [usize; 2], [Option<&str>; 3]); 6] = [
        (2, 0, [48, 96], [Some("3.0"), Some("2.0"), Some("2.5")]),
        (3, 0, [24, 48], [Some("4.0"), Some("3.0"), Some("3.5")]),
        (4, 0, [24, 48], [Some("5.1"), Some("4.0"), Some("4.5")]),
        (2, 2, [48, 96], [Some("3.0"), None, Some("1.0")]),
        (3, 2, [24, 48], [Some("4.0"), None, Some("2.0")]),
        (4, 2, [24, 48], [Some("5.1"), None, Some("3.0")]),
    ];
    let failures: Vec<String> = table
        .par_iter()
        .filter_map(|&(degree, lower, slave, expected)| {
            let (_, observed) = neumann(Kind::Spline, degree, slave, lowered(lower));
            let differs = (0..3).any(|k| expected[k].is_some_and(|printed| format!("{:.1}", observed[k]) != printed));
            differs.then(|| format!("p = {degree} p/p-{lower}: {observed:?} for {expected:?}"))
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// p/p by a rule with so many points more.
fn by(rule: Integration, extra: usize) -> How {
    How::Mortar(MultiplierKind::Lowered(0), rule, extra)
}

// the quadrature study of p = 3 with p/p, within 5 % of its last rates
#[test]
fn the_quadrature_study_has_the_rates_of_the_table() {
    let study = [
        (Integration::Merged, 0, [4.01, 3.00, 3.49]),
        (Integration::Slave, 0, [2.29, 1.58, 0.20]),
        (Integration::Slave, 2, [3.68, 2.80, 0.22]),
        (Integration::Slave, 10, [4.01, 3.00, 1.23]),
        (Integration::Mixed, 0, [4.01, 3.00, 3.49]),
    ];
    let failures: Vec<String> = study
        .par_iter()
        .filter_map(|&(rule, extra, table)| {
            let (found, observed) = neumann(Kind::Spline, 3, [48, 96], by(rule, extra));
            println!("splines, {rule:?} +{extra}: {:?}, rates {observed:?}", found[1].errors);
            let far = |k: usize| observed[k].is_nan() || (observed[k] / table[k] - 1.0).abs() > 0.05;
            (0..3).any(far).then(|| format!("{rule:?} +{extra}: {observed:?} for {table:?}"))
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

// splines are less sensitive to the slave's quadrature than finite elements of the same degree
#[test]
fn finite_elements_lose_more_to_the_slave_rule_than_splines() {
    for extra in [0, 2] {
        let (splines, a) = neumann(Kind::Spline, 3, [24, 48], by(Integration::Slave, extra));
        let (elements, b) = neumann(Kind::Tensor, 3, [24, 48], by(Integration::Slave, extra));
        println!("slave +{extra}: splines {:?} {a:?}, finite elements {:?} {b:?}", splines[1].errors, elements[1].errors);
        // 3/2 in L2(u), 1/2 in H1, none in lambda: the kinks of C0 functions, against those of C2 functions
        assert!(b[0] < 1.6 && b[1] < 0.6 && b[2] < 0.1, "{b:?}");
        assert!(a[0] > b[0] + 1.0, "{a:?} {b:?}");
        assert!((0..3).all(|k| elements[1].errors[k] > 10.0 * splines[1].errors[k]), "{elements:?} {splines:?}");
    }
    let (merged, rates) = neumann(Kind::Tensor, 3, [24, 48], by(Integration::Merged, 0));
    println!("finite elements, merged: {:?} {rates:?}", merged[1].errors);
    assert!(rates[0] > 3.9 && rates[1] > 2.9 && rates[2] > 2.4, "{rates:?}");
}
