//! Lesson 3: a contact algorithm from outside the crate, in case files under a name of its own.
//!
//! `InteriorPoint` is Mehrotra's predictor-corrector method. No row is open or closed on the way: all gaps s and pressures z stay
//! positive, and their products fall to zero together. A Newton step is a system of soft rows,
//!
//!   K u + Cᵀ lambda = f,   C u + g - r = (s / z) lambda,   r = s + (sigma mu - ds dz) / z,   z = -lambda,
//!
//! which the crate's own solver of equalities answers. Rows that have parted ways are solved exactly at the end. A solver that answers
//! rows of kind `Contact` is used as it is; one that refuses them gets an active set around it. Both must find the same state.
//!
//! Source: Mehrotra, SIAM J. Optim. 2 (1992) 575-601; Nocedal, Wright, Numerical Optimization, Springer 2006, section 16.6.
//!
//! `cargo run --release --example 03_own_contact`

use faying::constraint::scale::row_scales;
use faying::constraint::{Abilities, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Direct, RowKind, SolveError};
use faying::linalg::LinearError;
use std::error::Error;

/// Steps allowed; ten to thirty are usual.
const MAX_STEPS: usize = 80;
/// Share of the way to where a gap or a pressure would vanish.
const SHORT_OF: f64 = 0.99;
/// A row is decided where gap and pressure, both as lengths, differ by this factor.
const DECIDED: f64 = 1e3;
/// Products this small against the square of the largest length are rounding: rows with neither gap nor pressure never decide.
const ROUNDING: f64 = 1e-22;
/// Tension and penetration allowed at the end, against the largest length.
const ALLOWED: f64 = 1e-11;

/// Contact by an interior point method.
#[derive(Debug, Default)]
struct InteriorPoint {
    equalities: Direct,
}

/// Gaps s and pressures z of the contact rows, both as lengths.
struct Point {
    gap: Vec<f64>,
    press: Vec<f64>,
}

/// The contact rows of a system, and what makes lengths of their gaps and multipliers.
struct Rows<'a> {
    system: &'a ConstrainedSystem<'a>,
    contact: Vec<usize>,
    weight: Vec<f64>,
    per_pressure: Vec<f64>,
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// The largest step up to 1 that keeps `x + step dx` from becoming negative.
fn reach(x: &[f64], dx: &[f64]) -> f64 {
    x.iter().zip(dx).filter(|(_, d)| **d < 0.0).map(|(x, d)| -x / d).fold(1.0, f64::min)
}

impl<'a> Rows<'a> {
    fn of(system: &'a ConstrainedSystem<'a>) -> Self {
        let m = system.offset.len();
        let scale = row_scales(&system.stiffness.diagonal(), system.constraint, m);
        let contact: Vec<usize> = (0..m).filter(|&j| system.kind[j] == RowKind::Contact).collect();
        let weight = contact.iter().map(|&j| if scale.weight[j] > 0.0 { scale.weight[j] } else { 1.0 });
        let per_pressure = contact.iter().map(|&j| scale.weight[j] / scale.stiffness[j]);
        Self { system, weight: weight.collect(), per_pressure: per_pressure.collect(), contact }
    }

    /// Gaps beyond a row's own softness, and pressures.
    fn point(&self, solution: &ConstrainedSolution, shift: &[f64]) -> Point {
        let soft = |j: usize| self.system.compliance.get(j).copied().unwrap_or(0.0) * solution.multipliers[j];
        let rows = || self.contact.iter().enumerate();
        Point {
            gap: rows().map(|(k, &j)| (solution.gap[j] - soft(j)) / self.weight[k] + shift[k]).collect(),
            press: rows().map(|(k, &j)| -solution.multipliers[j] * self.per_pressure[k]).collect(),
        }
    }

    /// Where a Newton step leads: rows of softness `ratio` = s / z whose gaps are taken from `shift` = r on.
    fn step(&self, solver: &mut Direct, ratio: &[f64], shift: &[f64]) -> Result<Point, SolveError> {
        let m = self.system.offset.len();
        let (mut kind, mut offset) = (self.system.kind.to_vec(), self.system.offset.to_vec());
        let mut compliance = if self.system.compliance.is_empty() { vec![0.0; m] } else { self.system.compliance.to_vec() };
        for (k, &j) in self.contact.iter().enumerate() {
            kind[j] = RowKind::Equal;
            compliance[j] += ratio[k] * self.weight[k] * self.per_pressure[k];
            offset[j] -= shift[k] * self.weight[k];
        }
        let soft = ConstrainedSystem { kind: &kind, offset: &offset, compliance: &compliance, ..*self.system };
        Ok(self.point(&solver.solve(&soft)?, shift))
    }

    /// The solution with rows closed or open as said, if it keeps the conditions of contact.
    fn exact(&self, solver: &mut Direct, closed: &[bool]) -> Result<Option<ConstrainedSolution>, SolveError> {
        let mut kind = self.system.kind.to_vec();
        for (&j, &c) in self.contact.iter().zip(closed) {
            kind[j] = if c { RowKind::Equal } else { RowKind::Open };
        }
        let solution = match solver.solve(&ConstrainedSystem { kind: &kind, ..*self.system }) {
            Ok(solution) => solution,
            Err(SolveError::Linear(LinearError::Singular { .. })) => return Ok(None),
            Err(error) => return Err(error),
        };
        let at = self.point(&solution, &vec![0.0; self.contact.len()]);
        let size = largest(&at.gap).max(largest(&at.press)).max(largest(&solution.unknowns));
        let good = |k: usize| if closed[k] { at.press[k] >= -ALLOWED * size } else { at.gap[k] >= -ALLOWED * size };
        Ok((0..closed.len()).all(good).then_some(solution))
    }
}

impl Point {
    /// All gaps and pressures positive, by Mehrotra's shifts.
    fn made_positive(mut self) -> Self {
        for list in [&mut self.gap, &mut self.press] {
            let least = list.iter().copied().fold(f64::INFINITY, f64::min);
            list.iter_mut().for_each(|x| *x += (-1.5 * least).max(0.0));
        }
        let product: f64 = self.gap.iter().zip(&self.press).map(|(s, z)| s * z).sum();
        let (gap, press) = (self.gap.iter().sum::<f64>(), self.press.iter().sum::<f64>());
        if gap > 0.0 && press > 0.0 {
            self.gap.iter_mut().for_each(|s| *s += 0.5 * product / press);
            self.press.iter_mut().for_each(|z| *z += 0.5 * product / gap);
        }
        self
    }

    /// The mean product of gap and pressure.
    fn mu(&self) -> f64 {
        self.gap.iter().zip(&self.press).map(|(s, z)| s * z).sum::<f64>() / self.gap.len() as f64
    }

    fn to(&self, other: &Self) -> (Vec<f64>, Vec<f64>) {
        let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| b - a).collect();
        (difference(&self.gap, &other.gap), difference(&self.press, &other.press))
    }
}

impl ConstraintSolver for InteriorPoint {
    fn abilities(&self) -> Abilities {
        Abilities { contact: true, ..self.equalities.abilities() }
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        if !system.kind.contains(&RowKind::Contact) {
            return self.equalities.solve(system);
        }
        let (rows, solver) = (Rows::of(system), &mut self.equalities);
        let n = rows.contact.len();
        // springs of the rows' own stiffness first: bodies that contact alone holds are held
        let mut at = rows.step(solver, &vec![1.0; n], &vec![0.0; n])?.made_positive();
        for done in 0..MAX_STEPS {
            let apart = |k: usize| at.gap[k].max(at.press[k]) >= DECIDED * at.gap[k].min(at.press[k]);
            let size = largest(&at.gap).max(largest(&at.press));
            if (0..n).all(apart) || at.mu() <= ROUNDING * size * size {
                let closed: Vec<bool> = (0..n).map(|k| at.press[k] >= at.gap[k]).collect();
                if let Some(solution) = rows.exact(solver, &closed)? {
                    return Ok(ConstrainedSolution { method: format!("interior point, {done} steps, {}", solution.method), ..solution });
                }
            }
            let (mu, ratio): (f64, Vec<f64>) = (at.mu(), (0..n).map(|k| at.gap[k] / at.press[k]).collect());
            // predictor: straight to where all products vanish
            let (ds, dz) = at.to(&rows.step(solver, &ratio, &at.gap)?);
            let (a, b) = (reach(&at.gap, &ds), reach(&at.press, &dz));
            let ahead = (0..n).map(|k| (at.gap[k] + a * ds[k]) * (at.press[k] + b * dz[k])).sum::<f64>() / n as f64;
            let sigma = (ahead / mu).max(0.0).powi(3);
            // corrector: to equal products, with the curvature that the predictor met
            let shift: Vec<f64> = (0..n).map(|k| at.gap[k] + (sigma * mu - ds[k] * dz[k]) / at.press[k]).collect();
            let (ds, dz) = at.to(&rows.step(solver, &ratio, &shift)?);
            let (a, b) = ((SHORT_OF * reach(&at.gap, &ds)).min(1.0), (SHORT_OF * reach(&at.press, &dz)).min(1.0));
            (0..n).for_each(|k| at.gap[k] += a * ds[k]);
            (0..n).for_each(|k| at.press[k] += b * dz[k]);
        }
        Err(SolveError::TooManyIterations { iterations: MAX_STEPS, best: Box::default() })
    }
}

/// The cases of the folder `examples/cases` that are solved by both.
const CASES: [(&str, &str, &[&str]); 3] = [
    ("contact-patch", "pad", &[]),
    ("contact-patch", "pad", &["patch.upper.backend=fe", "contact.pad.gap=\"if(x > 0.45, g + 1, g)\""]),
    ("hertz", "plane", &["patch.cylinder.elements=[32, 20]", "patch.cylinder.grade.ratio=0.04", "let.a_R=0.03"]),
];

/// Checks the algorithm by the rules of every contact solver, and runs cases that name it beside the active set.
pub fn main() -> Result<(), Box<dyn Error>> {
    faying::check::contact_solver(|| Box::new(InteriorPoint::default()))?;

    {
        use faying_cli::{Case, case::ReadOptions};
        use faying_cli::{Registry, RunResult};

        let mut registry = Registry::default();
        registry.solvers.add("interior-point", Box::new(|_| Ok(Box::new(InteriorPoint::default()))));
        for (name, contact, sets) in CASES {
            let path = format!("{}/cases/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            let solved = |solver: &str| -> Result<RunResult, Box<dyn Error>> {
                let mut sets: Vec<String> = sets.iter().map(|s| (*s).to_owned()).collect();
                sets.push(format!("solver.constraint={solver}"));
                let options = ReadOptions { names: registry.case_names(), sets, ..ReadOptions::default() };
                Ok(Case::read_with(&path, &options)?.run(&registry)?)
            };
            let (set, point) = (solved("saddle-point")?, solved("interior-point")?);
            let report = |r: &RunResult| r.contact.get(contact).cloned().ok_or("no contact");
            let (a, b) = (report(&set)?, report(&point)?);
            let linear = point.solve.as_ref().map_or("", |s| &s.linear);
            println!(
                "{name}: largest pressure {:.9e} and {:.9e}, {} and {} rows active; {linear}",
                a.pressure.max, b.pressure.max, a.active, b.active
            );
            assert!(linear.starts_with("interior point") && point.solve.as_ref().is_some_and(|s| s.active_set.is_none()));
            let near = |x: f64, y: f64, size: f64| (x - y).abs() <= 1e-8 * size.abs();
            assert!(near(a.pressure.max, b.pressure.max, a.pressure.max) && near(set.energy, point.energy, set.energy));
            assert!(near(a.force[1], b.force[1], a.force[1]) && near(a.area, b.area, a.area) && a.active == b.active);
            for (p, q) in set.probes.iter().zip(&point.probes) {
                assert!(near(p.value, q.value, p.value), "{}: {} and {}", p.name, p.value, q.value);
            }
        }
    }
    Ok(())
}

#[test]
fn the_lesson_runs() {
    main().unwrap();
}
