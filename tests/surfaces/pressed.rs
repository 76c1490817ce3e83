//! A block pressed on a rigid plane: the pressure is uniform, whatever the cells, the degree, the method, the cone and the direction.

use crate::bodies::{KINDS, Kind, steel, turns};
use faying::contact::{Augmented, Cone, ContactMethod, HalfPlane, Lagrange};
use faying::coupling::multiplier::MultiplierKind;
use faying::coupling::nitsche::Variant;
use faying::coupling::{Nitsche, Penalty};
use faying::linalg::{Matrix, Vector};
use faying::problem::{BodyId, ContactId, ErrorKind, InterfaceError, Problem, Solution};
use std::sync::Arc;

const PRESSURE: f64 = 1.25e-3;
const POISSON: f64 = 0.3;
const EXACT: f64 = 1e-12;
/// A penalty of the default factor gives way by a billionth.
const SOFT: f64 = 1e-8;

/// What is varied; the box is [0, 1] x [0, 0.8] x [0, 0.5].
#[derive(Clone, Debug)]
struct Case {
    kind: Kind,
    degree: usize,
    turn: Matrix<3, 3>,
    method: Arc<dyn ContactMethod<2, 3>>,
    multiplier: MultiplierKind,
    cone: Cone,
}

impl Case {
    fn new(kind: Kind, degree: usize) -> Self {
        let (multiplier, cone) = (MultiplierKind::Auto, Cone::Coefficients);
        Self { kind, degree, turn: Matrix::identity(), method: Arc::new(Lagrange), multiplier, cone }
    }

    fn problem(&self) -> (Problem<2, 3>, BodyId, ContactId) {
        let block = self.kind.turned_box(([0.0; 3], [1.0, 0.8, 0.5]), &self.turn, self.degree, [3, 2, 2]);
        let mut p = Problem::<2, 3>::new();
        let block = self.kind.add(&mut p, "block", block, steel());
        for side in ["u0", "v0"] {
            p.fix_normal(block.side(side)).unwrap();
        }
        p.pressure(block.side("w1"), PRESSURE).unwrap();
        let plane = HalfPlane::try_new(Vector::<3>::zeros(), self.turn * Vector::<3>::z()).unwrap();
        let contact = p.contact(block.side("w0"), plane).unwrap().method(self.method.clone()).multiplier(self.multiplier).cone(self.cone);
        let contact = contact.extra_points(self.kind.extra_points()).id();
        (p, block, contact)
    }

    fn solution(&self) -> (Solution<2, 3>, BodyId, ContactId) {
        let (p, block, contact) = self.problem();
        let mut system = p.assemble().unwrap_or_else(|e| panic!("{self:?}: {e}"));
        (system.solve(0.0, None).unwrap_or_else(|e| panic!("{self:?}: {e}")), block, contact)
    }

    /// Largest errors of what is known: pressure at points, force, stress, displacement, and the conditions of contact, all relative.
    fn errors(&self) -> Vec<(&'static str, f64)> {
        let (solution, block, contact) = self.solution();
        let result = solution.contact(contact).unwrap();
        let normal = self.turn * Vector::<3>::z();
        let mut errors = vec![
            ("force", (result.force - normal * (0.8 * PRESSURE)).norm() / PRESSURE),
            ("largest", (result.largest_pressure / PRESSURE - 1.0).abs()),
            ("least", (result.least_pressure / PRESSURE - 1.0).abs()),
            ("balance", Vector::<3>::from(solution.balance().force).norm() / PRESSURE),
            ("area", (result.area - 0.8).abs()),
        ];
        let centre = self.turn * Vector::<3>::new(0.5, 0.4, 0.0);
        let moment = centre.cross(&(normal * (0.8 * PRESSURE))) - Vector::<3>::from(result.moment);
        errors.push(("moment", moment.norm() / PRESSURE));
        let mut off = [0.0f64; 2];
        for x in [[0.1, 0.2, 0.05], [0.9, 0.7, 0.45], [0.5, 0.4, 0.0], [1.0, 0.8, 0.5], [0.31, 0.11, 0.26]] {
            let inner = Vector::<3>::from(x);
            let at = solution.at(block, &(self.turn * inner).into()).unwrap();
            let wanted = self.turn * Vector::<3>::new(POISSON * inner[0], POISSON * inner[1], -inner[2]) * PRESSURE;
            off[0] = off[0].max((Vector::<3>::from(at.u) - wanted).norm() / PRESSURE);
            let stress = |i: usize, j: usize| {
                let place = [[0, 3, 5], [3, 1, 4], [5, 4, 2]][i][j];
                at.stress[place] + PRESSURE * normal[i] * normal[j]
            };
            (0..3).for_each(|i| (0..3).for_each(|j| off[1] = off[1].max(stress(i, j).abs() / PRESSURE)));
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

#[test]
fn the_pressure_is_uniform_on_all_cells_at_all_degrees() {
    let mut failures = Vec::new();
    for kind in KINDS {
        for degree in 1..=3 {
            failures.extend(Case::new(kind, degree).check(EXACT));
        }
    }
    assert_none(&failures);
}

#[test]
fn the_pressure_is_uniform_on_oblique_planes() {
    let mut failures = Vec::new();
    for kind in KINDS {
        for turn in turns() {
            failures.extend(Case { turn, ..Case::new(kind, 2) }.check(EXACT));
        }
    }
    assert_none(&failures);
}

#[test]
fn the_pressure_is_uniform_for_every_multiplier_and_cone() {
    let mut failures = Vec::new();
    for (kind, degree) in [(Kind::Spline, 2), (Kind::Spline, 3), (Kind::Hexahedra, 2), (Kind::Tetrahedra, 2), (Kind::Tetrahedra, 3)] {
        let lowest = if kind == Kind::Tetrahedra { 1 } else { 2 };
        for multiplier in [MultiplierKind::Lowered(0), MultiplierKind::Lowered(lowest), MultiplierKind::Constant] {
            for cone in [Cone::Coefficients, Cone::Weights, Cone::Values] {
                if kind == Kind::Tetrahedra && (cone == Cone::Values || multiplier == MultiplierKind::Constant) {
                    continue;
                }
                failures.extend(Case { multiplier, cone, ..Case::new(kind, degree) }.check(EXACT));
            }
        }
    }
    assert_none(&failures);
}

#[test]
fn the_pressure_is_uniform_for_every_method() {
    let mut failures = Vec::new();
    for kind in KINDS {
        for degree in 1..=2 {
            let methods: [Arc<dyn ContactMethod<2, 3>>; 4] = [
                Arc::new(Augmented::default()),
                Arc::new(Nitsche::default()),
                Arc::new(Nitsche { variant: Variant::Unsymmetric, ..Nitsche::default() }),
                Arc::new(Nitsche { variant: Variant::Incomplete, ..Nitsche::default() }),
            ];
            for method in methods {
                failures.extend(Case { method, ..Case::new(kind, degree) }.check(EXACT));
            }
        }
    }
    assert_none(&failures);
}

/// A penalty lets the block sink into the plane by the pressure over its stiffness, and changes nothing else.
#[test]
fn a_penalty_lets_the_block_sink_by_its_factor() {
    for kind in KINDS {
        let sinks = |factor: f64| {
            let case = Case { method: Arc::new(Penalty { factor }), ..Case::new(kind, 2) };
            let (solution, block, contact) = case.solution();
            let force = solution.contact(contact).unwrap().force[2];
            assert!((force / PRESSURE - 0.8).abs() < EXACT, "{kind:?}: {force}");
            -solution.at(block, &[0.5, 0.4, 0.0]).unwrap().u[2] / PRESSURE
        };
        let (soft, stiff) = (sinks(1e4), sinks(1e6));
        assert!(soft > 0.0 && (soft / stiff - 100.0).abs() < 0.1, "{kind:?}: {soft} {stiff}");
        assert_none(&Case { method: Arc::new(Penalty::default()), ..Case::new(kind, 2) }.check(SOFT));
    }
}

#[test]
fn what_is_not_there_is_refused_with_what_is() {
    let refused = |case: &Case| case.problem().0.assemble().expect_err("refused").0.remove(0);
    let error = refused(&Case { multiplier: MultiplierKind::Dual, ..Case::new(Kind::Tetrahedra, 2) });
    assert!(error.to_string().contains("this side has p/p, p/p-1, constant"), "{error}");
    let error = refused(&Case { multiplier: MultiplierKind::Lowered(2), ..Case::new(Kind::Tetrahedra, 2) });
    assert!(error.to_string().contains("this side has p/p, p/p-1, constant"), "{error}");
    let error = refused(&Case { cone: Cone::Values, ..Case::new(Kind::Tetrahedra, 2) });
    assert!(matches!(&error.kind, ErrorKind::Interface { error: InterfaceError::Contact(_), .. }), "{error:?}");
    assert!(error.to_string().contains("Greville"), "{error}");
}
