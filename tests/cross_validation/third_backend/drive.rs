//! Ties and presses any two bodies by library calls alone: the lower one on [0, 1]², the upper one on [0, 1] x [1, 2].

use faying::assembly::Norms;
use faying::constraint::{Condensed, ConstraintSolver, Direct};
use faying::coupling::multiplier::MultiplierKind;
use faying::linalg::{Matrix, Vector};
use faying::physics::{Hooke, Material};
use faying::problem::{Derivatives, Exact, Point, Problem, SideOf, Solution, Value};
use faying::space::Body;
use std::sync::Arc;

/// A body with the names of its sides in the order left, right, bottom, top.
#[derive(Clone)]
pub struct Part {
    pub body: Arc<dyn Body<1, 2>>,
    pub sides: [&'static str; 4],
}

/// Largest errors of a run: displacement (L2, energy), multiplier; and the iterations of the active set.
#[derive(Debug)]
pub struct Outcome {
    pub displacement: Norms,
    pub multiplier: f64,
    pub iterations: usize,
}

/// u = G x.
#[derive(Clone, Copy, Debug)]
struct Linear(Matrix<2, 2>);

impl Exact for Linear {
    fn value(&self, component: usize, at: &Point) -> f64 {
        (self.0 * Vector::<2>::new(at.x[0], at.x[1]))[component]
    }
    fn slope(&self, component: usize, at: &Point) -> Derivatives {
        let gradient = [self.0[(component, 0)], self.0[(component, 1)], 0.0];
        Derivatives { value: self.value(component, at), gradient, ..Derivatives::default() }
    }
    fn derivatives(&self, component: usize, at: &Point) -> Derivatives {
        self.slope(component, at)
    }
    fn depends_on_time(&self) -> bool {
        false
    }
}

fn steel() -> Hooke<2> {
    Hooke::plane_strain(1.0, 0.3).expect("valid constants")
}

/// The problem of both bodies under `exact`, and the top of the lower body and the bottom of the upper one.
///
/// `fixed(part, side)`: components of a side that take the exact values; the others get the exact traction.
fn problem(parts: &[Part; 2], exact: Linear, fixed: impl Fn(usize, usize) -> Vec<usize>) -> (Problem<1, 2>, [SideOf<'static>; 2]) {
    let mut p = Problem::<1, 2>::new();
    p.exact(exact);
    let bodies = [0, 1].map(|b| p.body(["lower", "upper"][b], parts[b].body.clone(), steel()).expect("a body"));
    let interface = [bodies[0].side(parts[0].sides[3]), bodies[1].side(parts[1].sides[2])];
    for b in 0..2 {
        for k in (0..4).filter(|&k| k != 3 - b) {
            let (side, fixed) = (bodies[b].side(parts[b].sides[k]), fixed(b, k));
            for c in 0..2 {
                if fixed.contains(&c) {
                    p.prescribe(side, c, Value::Exact).expect("a side");
                } else {
                    p.traction(side, c, Value::Exact).expect("a side");
                }
            }
        }
    }
    (p, interface)
}

fn solved(problem: &Problem<1, 2>, condensed: bool) -> Solution<1, 2> {
    let solver: Box<dyn ConstraintSolver> = if condensed { Box::new(Condensed::new()) } else { Box::new(Direct::new()) };
    problem.assemble().expect("a sound problem").with_solver(solver).solve(1.0, None).expect("a solution")
}

fn displacement(solution: &Solution<1, 2>, exact: Linear) -> Norms {
    solution.errors(&exact).into_iter().map(|e| e.error).reduce(|a, b| a.hypot(b)).expect("two bodies")
}

/// Ties the top of the lower body to the bottom of the upper one under a linear field; `slave` is 0 (lower) or 1.
pub fn tied_patch(parts: &[Part; 2], slave: usize, multiplier: MultiplierKind, condensed: bool) -> Outcome {
    let exact = Linear(Matrix::<2, 2>::new(0.3, -0.2, 0.5, 0.1));
    // bottom and top take the exact values, left and right the exact traction: the ends of the interface stay free
    let (mut p, sides) = problem(parts, exact, |_, side| if side >= 2 { vec![0, 1] } else { vec![] });
    let tie = p.tie(sides[slave], sides[1 - slave]).expect("sides").multiplier(multiplier).id();
    let solution = solved(&p, condensed);
    // lambda = -sigma n of the slave: compared as a function, since the multipliers need not sum to one
    let outward = if slave == 0 { 1.0 } else { -1.0 };
    let expected = -steel().respond(&Vector::<2>::zeros(), &exact.0).stress * Vector::<2>::new(0.0, outward);
    let lambda = solution.lambda(tie, 0).expect("a tie").expect("a slave side");
    let elements = parts[slave].body.trace(parts[slave].sides[3 - slave]).expect("a side").space.num_elements();
    let mut worst = 0.0_f64;
    for element in 0..elements {
        let values = lambda.at(element, &[Vector::<1>::new(0.3)]);
        assert!(values.len() == 2 && values.iter().all(|v| v[0].is_finite()));
        worst = values.iter().zip(&expected).fold(worst, |worst, (value, wanted)| worst.max((value[0] - wanted).abs()));
    }
    Outcome { displacement: displacement(&solution, exact), multiplier: worst, iterations: 1 }
}

/// Presses two bodies on each other by sigma_yy = -1.25e-3.
pub fn contact_patch(parts: &[Part; 2], slave: usize, condensed: bool) -> Outcome {
    let (young, nu, p) = (1.0, 0.3, 1.25e-3);
    // plane strain, sigma_yy = -p, sigma_xx = 0
    let exact = Linear(Matrix::<2, 2>::from_diagonal(&Vector::<2>::new(p * nu * (1.0 + nu) / young, -p * (1.0 - nu * nu) / young)));
    // symmetry on the left, support at the bottom; pressure (the exact traction) on top, the right side free
    let (mut problem, sides) = problem(parts, exact, |b, side| match (b, side) {
        (_, 0) => vec![0],
        (0, 2) => vec![1],
        _ => vec![],
    });
    let pad = problem.contact(sides[slave], sides[1 - slave]).expect("sides").multiplier(MultiplierKind::Constant).id();
    let solution = solved(&problem, condensed);
    let worst = solution.multiplier(pad).expect("a contact").iter().map(|l| (l + p).abs()).fold(0.0, f64::max);
    let iterations = solution.active_set().map_or(0, |a| a.iterations);
    Outcome { displacement: displacement(&solution, exact), multiplier: worst, iterations }
}
