//! Two blocks of two materials pressed together on an oblique plane across grids that do not match: the pressure is uniform.

use crate::bodies::{KINDS, Kind, turns};
use faying::contact::{Augmented, Cone, ContactMethod, Lagrange};
use faying::coupling::interface::MergedSurface;
use faying::coupling::multiplier::MultiplierKind;
use faying::coupling::nitsche::Variant;
use faying::coupling::{CouplingError, InterfaceQuadrature, Nitsche, Penalty, Segments};
use faying::geometry::Geometry;
use faying::linalg::{Matrix, Vector};
use faying::physics::Hooke;
use faying::problem::{BodyId, ContactId, Integration, Problem, Rule, Solution, Warning};
use std::sync::Arc;

const PRESSURE: f64 = 1.25e-3;
const YOUNG: [f64; 2] = [1.0, 3.0];
const POISSON: [f64; 2] = [0.3, 0.2];
const EXACT: f64 = 1e-8;
const AREA: f64 = 0.8;

/// What is varied; the blocks are [0, 1] x [0, 0.8] x [-0.5, 0] and [0, 1] x [0, 0.8] x [0, 0.6], the upper one the slave unless `swapped`.
#[derive(Clone, Debug)]
struct Case {
    kinds: [Kind; 2],
    degree: usize,
    turn: Matrix<3, 3>,
    method: Arc<dyn ContactMethod<2, 3>>,
    multiplier: MultiplierKind,
    cone: Cone,
    swapped: bool,
    rule: Integration,
    extra: usize,
    grids: Grids,
}

/// Elements of the lower and the upper block.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Grids {
    Fine,
    /// Methods with a row per point have many of them.
    Coarse,
    Matching,
}

impl Case {
    fn new(kinds: [Kind; 2], degree: usize) -> Self {
        let (multiplier, cone) = (MultiplierKind::Auto, Cone::Coefficients);
        let (turn, method, rule) = (turns()[2], Arc::new(Lagrange), Integration::Merged);
        Self { kinds, degree, turn, method, multiplier, cone, swapped: false, rule, extra: 0, grids: Grids::Fine }
    }

    fn solution(&self) -> (Solution<2, 3>, [BodyId; 2], ContactId) {
        self.solution_by(self.rule.into())
    }

    fn solution_by(&self, rule: Rule<2, 3>) -> (Solution<2, 3>, [BodyId; 2], ContactId) {
        let (p, bodies, contact) = self.problem_by(rule);
        let mut system = p.assemble().unwrap_or_else(|e| panic!("{self:?}: {e}"));
        (system.solve(0.0, None).unwrap_or_else(|e| panic!("{self:?}: {e}")), bodies, contact)
    }

    fn problem_by(&self, rule: Rule<2, 3>) -> (Problem<2, 3>, [BodyId; 2], ContactId) {
        let boxes = [([0.0, 0.0, -0.5], [1.0, 0.8, 0.0]), ([0.0; 3], [1.0, 0.8, 0.6])];
        let elements = match self.grids {
            Grids::Fine => [[3, 2, 1], [2, 3, 1]],
            Grids::Coarse => [[2, 1, 1], [1, 2, 1]],
            Grids::Matching => [[2, 3, 1]; 2],
        };
        let mut p = Problem::<2, 3>::new();
        let bodies: [BodyId; 2] = std::array::from_fn(|b| {
            let body = self.kinds[b].turned_box(boxes[b], &self.turn, self.degree, elements[b]);
            let body = self.kinds[b].add(&mut p, ["lower", "upper"][b], body, Hooke::solid(YOUNG[b], POISSON[b]).unwrap());
            for side in ["u0", "v0"] {
                p.fix_normal(body.side(side)).unwrap();
            }
            body
        });
        p.fix_normal(bodies[0].side("w0")).unwrap();
        p.pressure(bodies[1].side("w1"), PRESSURE).unwrap();
        let mut sides = [bodies[1].side("w0"), bodies[0].side("w1")];
        if self.swapped {
            sides.reverse();
        }
        let contact = p.contact(sides[0], sides[1]).unwrap().method(self.method.clone()).multiplier(self.multiplier).cone(self.cone);
        let extra = self.kinds.into_iter().map(Kind::extra_points).max().unwrap() + self.extra;
        let contact = contact.rule(rule).extra_points(extra).id();
        (p, bodies, contact)
    }

    /// Largest errors of what is known, all relative.
    fn errors(&self) -> Vec<(&'static str, f64)> {
        let (solution, bodies, contact) = self.solution();
        self.errors_of(&solution, bodies, contact)
    }

    fn errors_of(&self, solution: &Solution<2, 3>, bodies: [BodyId; 2], contact: ContactId) -> Vec<(&'static str, f64)> {
        let result = solution.contact(contact).unwrap();
        let normal = self.turn * Vector::<3>::z();
        let up = normal * (AREA * PRESSURE * if self.swapped { -1.0 } else { 1.0 });
        let centre = self.turn * Vector::<3>::new(0.5, 0.4, 0.0);
        let mut errors = vec![
            ("force", (result.force - up).norm() / PRESSURE),
            ("moment", (centre.cross(&up) - Vector::<3>::from(result.moment)).norm() / PRESSURE),
            ("largest", (result.largest_pressure / PRESSURE - 1.0).abs()),
            ("least", (result.least_pressure / PRESSURE - 1.0).abs()),
            ("area", (result.area - AREA).abs()),
            ("action and reaction", result.balance * 1e4),
            ("supports", Vector::<3>::from(solution.balance().force).norm() / PRESSURE * 1e4),
        ];
        let mut off = [0.0f64; 2];
        for (b, heights) in [[-0.5, -0.27, 0.0], [0.0, 0.3, 0.6]].into_iter().enumerate() {
            for (z, [x, y]) in heights.into_iter().zip([[0.1, 0.2], [0.31, 0.11], [1.0, 0.8]]) {
                let at = solution.at(bodies[b], &(self.turn * Vector::<3>::new(x, y, z)).into()).unwrap();
                let side = POISSON[b] / YOUNG[b];
                let down = if b == 0 { -(z + 0.5) / YOUNG[0] } else { -0.5 / YOUNG[0] - z / YOUNG[1] };
                let wanted = self.turn * Vector::<3>::new(side * x, side * y, down) * PRESSURE;
                off[0] = off[0].max((Vector::<3>::from(at.u) - wanted).norm() / PRESSURE);
                for (i, row) in [[0, 3, 5], [3, 1, 4], [5, 4, 2]].iter().enumerate() {
                    let stress = |j: usize| at.stress[row[j]] + PRESSURE * normal[i] * normal[j];
                    (0..3).for_each(|j| off[1] = off[1].max(stress(j).abs() / PRESSURE));
                }
            }
        }
        errors.extend([("displacement", off[0]), ("stress", off[1])]);
        let worst = result.violation;
        errors.extend([("lambda > 0", worst.lambda / PRESSURE), ("gap < 0", worst.gap), ("lambda gap", worst.product / PRESSURE)]);
        errors
    }

    fn check(&self, tolerance: f64) -> Vec<String> {
        let wrong = self.errors().into_iter().filter(|(_, error)| error.is_nan() || *error > tolerance);
        let told: Vec<String> = wrong.map(|(what, error)| format!("{what} {error:.1e}")).collect();
        if told.is_empty() { Vec::new() } else { vec![format!("{self:?}: {}", told.join(", "))] }
    }
}

fn assert_none(failures: &[String]) {
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
}

fn pairs() -> impl Iterator<Item = [Kind; 2]> {
    KINDS.into_iter().flat_map(|a| KINDS.into_iter().map(move |b| [a, b]))
}

#[test]
fn the_pressure_between_all_pairs_of_cells_is_uniform() {
    let mut failures = Vec::new();
    for degree in 1..=2 {
        for (k, kinds) in pairs().enumerate() {
            failures.extend(Case { turn: turns()[k % 3], ..Case::new(kinds, degree) }.check(EXACT));
        }
    }
    for kinds in [[Kind::Spline, Kind::Hexahedra], [Kind::Tetrahedra, Kind::Spline]] {
        failures.extend(Case::new(kinds, 3).check(EXACT));
    }
    assert_none(&failures);
}

#[test]
fn slave_and_master_may_be_exchanged() {
    let mut failures = Vec::new();
    for kinds in pairs() {
        failures.extend(Case { swapped: true, ..Case::new(kinds, 2) }.check(EXACT));
    }
    assert_none(&failures);
}

#[test]
fn the_pressure_between_bodies_is_uniform_for_every_multiplier_and_cone() {
    let mut failures = Vec::new();
    for kinds in [[Kind::Tetrahedra, Kind::Spline], [Kind::Spline, Kind::Hexahedra], [Kind::Hexahedra, Kind::Tetrahedra]] {
        let on_triangles = kinds[1] == Kind::Tetrahedra;
        for multiplier in [MultiplierKind::Lowered(0), MultiplierKind::Lowered(if on_triangles { 1 } else { 2 }), MultiplierKind::Constant]
        {
            for cone in [Cone::Coefficients, Cone::Weights, Cone::Values] {
                if on_triangles && (cone == Cone::Values || multiplier == MultiplierKind::Constant) {
                    continue;
                }
                failures.extend(Case { multiplier, cone, ..Case::new(kinds, 2) }.check(EXACT));
            }
        }
    }
    assert_none(&failures);
}

/// Every method on every pair of cells once, in turn with the degree.
#[test]
fn the_pressure_between_bodies_is_uniform_for_every_method() {
    let mut failures = Vec::new();
    for (k, kinds) in pairs().enumerate() {
        let methods: [Arc<dyn ContactMethod<2, 3>>; 4] = [
            Arc::new(Augmented::default()),
            Arc::new(Nitsche::default()),
            Arc::new(Nitsche { variant: Variant::Unsymmetric, ..Nitsche::default() }),
            Arc::new(Nitsche { variant: Variant::Incomplete, ..Nitsche::default() }),
        ];
        for (m, method) in methods.into_iter().enumerate() {
            failures.extend(Case { method, grids: Grids::Coarse, ..Case::new(kinds, 1 + (k + m) % 2) }.check(EXACT));
        }
    }
    assert_none(&failures);
}

/// The slave rule is exact where the grids match, and elsewhere the better the more points it has.
#[test]
fn the_slave_rule_is_exact_on_grids_that_match() {
    // weights of NURBS differ between the blocks, and so do their points on the plane
    for kind in [Kind::Spline, Kind::Hexahedra, Kind::Tetrahedra] {
        let case = Case { rule: Integration::Slave, grids: Grids::Matching, ..Case::new([kind; 2], 2) };
        assert_none(&case.check(EXACT));
    }
    let of = |extra: usize| {
        let case = Case { rule: Integration::Slave, extra, ..Case::new([Kind::Spline, Kind::Hexahedra], 2) };
        let errors = case.errors();
        let exact = ["force", "action and reaction", "supports"];
        assert!(errors.iter().filter(|(what, _)| exact.contains(what)).all(|(_, error)| *error < EXACT), "{errors:?}");
        errors.iter().find(|(what, _)| *what == "stress").unwrap().1
    };
    let (few, many) = (of(0), of(20));
    assert!(few > 1e-4 && many < 0.1 * few, "{few} {many}");
}

/// A uniform pressure passes by the points of either side, where neither is rational: no defect of action and reaction.
#[test]
fn the_pressure_is_uniform_by_mixed_integration() {
    let mut failures = Vec::new();
    let polynomial = |kinds: &[Kind; 2]| !kinds.contains(&Kind::Nurbs);
    for (k, kinds) in pairs().filter(polynomial).enumerate() {
        for (degree, swapped) in [(1, k % 2 == 0), (2, k % 2 == 1)] {
            failures.extend(Case { rule: Integration::Mixed, swapped, ..Case::new(kinds, degree) }.check(EXACT));
        }
    }
    assert_none(&failures);
}

/// A penalty lets the bodies sink into each other by the pressure over its stiffness, and changes nothing else.
#[test]
fn a_penalty_lets_the_bodies_sink_into_each_other_by_its_factor() {
    for kinds in pairs() {
        let sinks = |factor: f64| {
            let case = Case { turn: Matrix::identity(), method: Arc::new(Penalty { factor }), ..Case::new(kinds, 2) };
            let (solution, bodies, contact) = case.solution();
            let force = solution.contact(contact).unwrap().force[2];
            assert!((force / PRESSURE - AREA).abs() < 1e-11, "{kinds:?}: {force}");
            let [lower, upper] = bodies.map(|body| solution.at(body, &[0.5, 0.4, 0.0]).unwrap().u[2]);
            (lower - upper) / PRESSURE
        };
        let (soft, stiff) = (sinks(1e4), sinks(1e6));
        assert!(soft > 0.0 && (soft / stiff - 100.0).abs() < 0.1, "{kinds:?}: {soft} {stiff}");
        assert_none(&Case { method: Arc::new(Penalty::default()), ..Case::new(kinds, 2) }.check(EXACT));
    }
}

/// Merged integration that reports the first slave element as lost in part.
#[derive(Debug)]
struct Losing(MergedSurface);

impl InterfaceQuadrature<2, 3> for Losing {
    fn segments(&self, slave: &dyn Geometry<2, 3>, master: &dyn Geometry<2, 3>) -> Result<Segments<2>, CouplingError> {
        let mut segments = self.0.segments(slave, master)?;
        segments.report.lost.push(0);
        Ok(segments)
    }
}

#[test]
fn parts_that_are_lost_are_told() {
    let case = Case { turn: Matrix::identity(), ..Case::new([Kind::Spline; 2], 1) };
    let told = |rule: Rule<2, 3>| {
        let (solution, ..) = case.solution_by(rule);
        solution.warnings().into_iter().find(|w| matches!(w, Warning::LostParts { .. }))
    };
    assert!(told(Integration::Merged.into()).is_none());
    let losing = Rule::of(|points, partners| Box::new(Losing(MergedSurface { points, partners })));
    let Some(Warning::LostParts { of, elements, x }) = told(losing) else { panic!("a warning") };
    // the first of 2 x 3 elements of the upper block's bottom
    assert!(elements == 1 && of.number == 0 && (Vector::<3>::from(x) - Vector::<3>::new(0.25, 0.4 / 3.0, 0.0)).norm() < 1e-14, "{x:?}");
}

/// Merged integration with a fault.
#[derive(Debug)]
struct Faulty(MergedSurface, Fault);

type Fault = fn(&mut Vec<Piece>);

/// Slave element, master element and points of a piece.
type Piece = (usize, usize, Vec<(Vector<2>, Vector<2>, f64)>);

impl InterfaceQuadrature<2, 3> for Faulty {
    fn segments(&self, slave: &dyn Geometry<2, 3>, master: &dyn Geometry<2, 3>) -> Result<Segments<2>, CouplingError> {
        let found = self.0.segments(slave, master)?;
        let points = |piece: usize| found.points(piece).map(|q| (found.slave_xi[q], found.master_xi[q], found.ds[q])).collect();
        let mut pieces: Vec<Piece> = (0..found.num_pieces()).map(|k| (found.slave[k], found.master[k], points(k))).collect();
        (self.1)(&mut pieces);
        let mut out = Segments::new();
        pieces.into_iter().for_each(|(slave, master, points)| out.push_piece(slave, master, points));
        out.report = found.report;
        Ok(out)
    }
}

/// Faults put into segments are refused, or spoil the uniform pressure.
#[test]
fn faults_of_segments_are_found() {
    let faults: [(&str, Fault); 7] = [
        ("none", |_| {}),
        ("a piece is missing", |pieces| drop(pieces.remove(1))),
        ("a piece stands twice", |pieces| pieces.insert(1, pieces[1].clone())),
        ("master elements are exchanged", |pieces| {
            let k = (1..pieces.len()).find(|&k| pieces[k].1 != pieces[0].1).unwrap();
            (pieces[0].1, pieces[k].1) = (pieces[k].1, pieces[0].1);
        }),
        ("a master element is walked backwards", |pieces| pieces[0].2.iter_mut().for_each(|p| p.1[0] = 1.0 - p.1[0])),
        ("a partner is moved", |pieces| pieces[0].2[0].1[1] += 1e-3),
        ("a weight is off", |pieces| pieces[0].2[0].2 *= 1.0 + 1e-4),
    ];
    let case = Case::new([Kind::Spline, Kind::Hexahedra], 2);
    for (what, fault) in faults {
        let rule = Rule::of(move |points, partners| Box::new(Faulty(MergedSurface { points, partners }, fault)));
        let (p, bodies, contact) = case.problem_by(rule);
        let solution = p.assemble().ok().and_then(|mut system| system.solve(0.0, None).ok());
        let is_found = solution
            .is_none_or(|solution| case.errors_of(&solution, bodies, contact).iter().any(|(_, error)| error.is_nan() || *error > EXACT));
        assert_eq!(is_found, what != "none", "{what}");
    }
}
