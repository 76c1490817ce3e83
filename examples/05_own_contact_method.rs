//! Lesson 5: a method of contact from outside the crate, beside those of the library. `cargo run --release --example 05_own_contact_method`
//!
//! `InteriorPoint` keeps all gaps s and pressures z = -lambda positive and lets their products fall to zero together. The Newton step for
//! s z = mu is a system of soft equalities,
//!
//! ```text
//! C u + g - (s + mu / z) = (s / z) lambda,
//! ```
//!
//! which is what an iteration says of its rows: their kind, a shift of their offset, a compliance. Rows that have parted ways are solved
//! exactly at the end.
//!
//! Source: Nocedal, Wright, Numerical Optimization, Springer 2006, chapter 16.6.

use faying::constraint::{Answered, Next, RowChange, RowIteration, RowKind};
use faying::contact::{Begun, ContactMethod, ContactRows, Lagrange};
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{Components, ContactId, Data, Problem, Solution};
use faying::space::{Mesh, Patch, PatchSpec};
use std::sync::Arc;

/// Contact by an interior point method.
#[derive(Clone, Copy, Debug)]
pub struct InteriorPoint;

impl<const S: usize, const N: usize> ContactMethod<S, N> for InteriorPoint {
    fn begin(&self, rows: &ContactRows<S, N>, unit: &dyn Fn(usize) -> f64) -> Begun {
        let unit = (0..rows.offset.len()).map(unit).collect();
        let path = Path { stage: Stage::Springs, unit, facing: rows.facing.clone(), gap: Vec::new(), press: Vec::new(), steps: 0 };
        Begun { iteration: Some(Box::new(path)), ..Begun::default() }
    }
}

/// Stage of the iteration.
#[derive(Debug)]
enum Stage {
    /// Springs of the rows' own stiffness: bodies that contact alone holds are held.
    Springs,
    /// On the central path.
    Path,
    /// Rows are closed or open.
    Decided(Vec<bool>),
}

/// Gaps and pressures of the rows on their way.
#[derive(Debug)]
struct Path {
    stage: Stage,
    unit: Vec<f64>,
    facing: Vec<bool>,
    gap: Vec<f64>,
    press: Vec<f64>,
    steps: usize,
}

/// Steps allowed; ten to forty are usual.
const MAX_STEPS: usize = 80;
/// Share of a pressure or a gap, as lengths, at which the other one is rounding.
const DECIDED: f64 = 1e-6;
/// Tension and penetration allowed at the end, against the largest.
const ALLOWED: f64 = 1e-10;

impl Path {
    fn rows(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.unit.len()).filter(|&j| self.facing[j])
    }

    /// A tenth of the mean product of gap and pressure.
    fn mu(&self) -> f64 {
        0.1 * self.rows().map(|j| self.gap[j] * self.press[j]).sum::<f64>() / self.rows().count().max(1) as f64
    }
}

impl RowIteration for Path {
    fn name(&self) -> &'static str {
        "interior point"
    }

    fn tolerance(&self) -> f64 {
        ALLOWED
    }

    fn row(&self, j: usize) -> RowChange {
        let row = |kind, shift, compliance| RowChange { kind: Some(kind), shift, compliance };
        match &self.stage {
            _ if !self.facing[j] => row(RowKind::Open, 0.0, None),
            Stage::Springs => row(RowKind::Equal, 0.0, Some(self.unit[j])),
            Stage::Path => {
                let (s, z) = (self.gap[j], self.press[j]);
                row(RowKind::Equal, -(s + self.mu() / z), Some(s / z))
            }
            Stage::Decided(closed) => row(if closed[j] { RowKind::Equal } else { RowKind::Open }, 0.0, None),
        }
    }

    fn next(&mut self, answered: &Answered<'_>) -> Next {
        let (lambda, gap) = (&answered.solution.multipliers[answered.range.clone()], &answered.solution.gap[answered.range.clone()]);
        // pressures as lengths, by the compliance of the rows at their own stiffness
        let largest = self.rows().fold(0.0f64, |m, j| m.max(gap[j].abs()).max((lambda[j] * self.unit[j]).abs()));
        self.steps += 1;
        match &self.stage {
            Stage::Springs => {
                self.gap = gap.iter().map(|g| g.max(0.1 * largest)).collect();
                self.press = lambda.iter().zip(&self.unit).map(|(l, u)| (-l).max(0.1 * largest / u.max(f64::MIN_POSITIVE))).collect();
                self.stage = Stage::Path;
            }
            Stage::Path => {
                let short = |x: &[f64], new: &dyn Fn(usize) -> f64| {
                    self.rows().map(|j| (x[j], new(j))).filter(|(x, new)| new < x).map(|(x, new)| 0.99 * x / (x - new)).fold(1.0, f64::min)
                };
                let step = short(&self.gap, &|j| gap[j]).min(short(&self.press, &|j| -lambda[j]));
                for j in 0..gap.len() {
                    self.gap[j] += step * (gap[j] - self.gap[j]);
                    self.press[j] += step * (-lambda[j] - self.press[j]);
                }
                let parted = |j: usize| {
                    let (s, z) = (self.gap[j], self.press[j] * self.unit[j]);
                    s.min(z) <= DECIDED * s.max(z)
                };
                if self.rows().all(parted) || self.steps > MAX_STEPS / 2 {
                    self.stage = Stage::Decided((0..gap.len()).map(|j| self.press[j] * self.unit[j] > self.gap[j]).collect());
                }
            }
            Stage::Decided(_) => {
                let wrong = self.rows().map(|j| (lambda[j] * self.unit[j]).max(-gap[j])).fold(0.0, f64::max);
                let error = if largest > 0.0 { wrong / largest } else { 0.0 };
                return if error <= ALLOWED { Next::Done } else { Next::Failed { error, tolerance: ALLOWED } };
            }
        }
        Next::Again { error: 1.0, tolerance: ALLOWED }
    }
}

/// A NURBS body that leans on a mesh and on a wall, by a method for each.
pub fn pressed(methods: [Arc<dyn ContactMethod<1, 2>>; 2]) -> Result<(Solution<1, 2>, [ContactId; 2]), Box<dyn std::error::Error>> {
    let mut p = Problem::<1, 2>::new();
    let steel = || Hooke::plane_strain(1.0, 0.3);
    let lower = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 0.5])?).with_elements([7, 3]);
    let upper = PatchSpec::new(rectangle([0.0, 0.5], [1.0, 1.0])?).with_elements([9, 4]);
    let lower = p.body("lower", Mesh::from_patch(&lower)?, steel()?)?;
    let upper = p.body("upper", Patch::try_new(&upper)?, steel()?)?;
    p.fix(lower.side("v0"), Components::All)?;
    p.traction(upper.side("v1"), 1, Data::of(|x, _| -1e-3 * (1.0 - 1.3 * x[0])))?;
    p.traction(upper.side("u0"), 0, 1e-4)?;
    let [of_table, of_wall] = methods;
    let table = p.contact(upper.side("v0"), lower.side("v1"))?.method(of_table).id();
    let wall = faying::contact::HalfPlane::try_new(Vector::from([1.0, 0.0]), Vector::from([-1.0, 0.0])).ok_or("a normal of length 1")?;
    let wall = p.contact(upper.side("u1"), wall)?.method(of_wall).id();
    Ok((p.assemble()?.solve(1.0, None)?, [table, wall]))
}

/// Checks the method by the rules of all methods, and solves by it, beside Lagrange multipliers and instead of them.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    faying::check::contact_method(Arc::new(InteriorPoint))?;
    let lagrange = || -> Arc<dyn ContactMethod<1, 2>> { Arc::new(Lagrange) };
    let (exact, [table, wall]) = pressed([lagrange(), lagrange()])?;
    let (exact_table, exact_wall) = (exact.contact(table)?, exact.contact(wall)?);
    for (what, methods) in [
        ("both contacts", [Arc::new(InteriorPoint) as _, Arc::new(InteriorPoint) as _]),
        ("one", [Arc::new(InteriorPoint) as _, lagrange()]),
    ] {
        let (own, [table, wall]) = pressed(methods)?;
        let (own_table, own_wall) = (own.contact(table)?, own.contact(wall)?);
        println!("{what} by {}: table {:.9e}, wall {:.9e}", own.linear().method, own_table.force[1], own_wall.force[0]);
        for (a, b) in [(own_table.largest_pressure, exact_table.largest_pressure), (own_wall.largest_pressure, exact_wall.largest_pressure)]
        {
            assert!((a - b).abs() <= 1e-9 * b.abs(), "{a} and {b}");
        }
    }
    Ok(())
}

#[test]
fn the_lesson_runs() {
    main().unwrap();
}
