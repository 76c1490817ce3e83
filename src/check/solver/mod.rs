//! Contract of `ConstraintSolver`: small systems with solutions found by hand.

mod abilities;

use crate::constraint::{ConstrainedSolution, ConstrainedSystem, ConstraintSolver, RowKind, SolveError};
use crate::coupling::Rows;
use crate::linalg::{Csr, Operator, Triplets};
use abilities::{contacts, honest};

/// Checks solvers made by `make`: tied, shifted, soft and open rows, floating bodies, rows that share unknowns, extreme units, one object
/// for many systems; errors for systems without solution; [abilities](ConstraintSolver::abilities) that are neither more nor less than what
/// it solves: contact, systems without symmetry, more soft rows than unknowns.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn solver(make: impl Fn() -> Box<dyn ConstraintSolver>) -> Result<(), String> {
    let mut one = make();
    for problem in known() {
        problem.check(&mut *make())?;
        // an object used for other systems must not keep their values
        problem.check(&mut *one)?;
    }
    for (problem, why) in impossible() {
        if problem.solve(&mut *make()).is_ok() {
            return Err(format!("solver: {}: {why}", problem.name));
        }
    }
    honest(&make, &mut *one)?;
    let mut short = tie();
    short.load.pop();
    if !matches!(short.solve(&mut *make()), Err(SolveError::Shape { .. })) {
        return Err("solver: a load of another length is not refused as `Shape`".into());
    }
    Ok(())
}

/// Checks contact algorithms made by `make`: all of [`solver`], and contact rows must be solved, with signs and complementarity;
/// bodies held by contact alone, rows that only touch, a matrix on which the plain active set cycles, loads that nothing holds.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn contact_solver(make: impl Fn() -> Box<dyn ConstraintSolver>) -> Result<(), String> {
    solver(&make)?;
    let mut one = make();
    for problem in contacts().into_iter().chain(coupled_contacts()) {
        for solver in [&mut make(), &mut one] {
            problem.check(&mut **solver)?;
            problem.signs(&problem.solve(&mut **solver).map_err(|e| format!("solver: {}: {e}", problem.name))?)?;
        }
    }
    // a spring that only a wall could hold, pulled away from it
    let away = hanging(-1.0);
    if away.solve(&mut *make()).is_ok() {
        return Err(format!("solver: {}: no pressure holds it, and it is answered", away.name));
    }
    Ok(())
}

/// Two points joined by a spring of stiffness 2, pushed by `force` at the first; the second is 1/2 from a wall.
fn hanging(force: f64) -> Problem {
    Problem::new(
        &format!("spring held by a wall alone, force {force}"),
        &[&[2.0, -2.0], &[-2.0, 2.0]],
        &[force, 0.0],
        &[(&[(1, -1.0)], &[])],
    )
    .offset(&[0.5])
    .kind(&[RowKind::Contact])
    .answer(&[0.5 + force / 2.0, 0.5], &[-force])
}

fn coupled_contacts() -> Vec<Problem> {
    use RowKind::{Contact, Equal};
    let rows: &[(&[(usize, f64)], &[(usize, f64)])] = &[(&[(0, 1.0)], &[]), (&[(1, 1.0)], &[]), (&[(2, 1.0)], &[])];
    // found by trial: positive definite, and changing all wrong rows at once repeats three states
    let circle = || {
        Problem::new("circle", &[&[17.0, -5.0, 15.0], &[-5.0, 2.0, -4.0], &[15.0, -4.0, 14.0]], &[5.0, -3.0, 1.0], rows)
            .kind(&[Contact; 3])
            .answer(&[5.0 / 17.0, 0.0, 0.0], &[0.0, -26.0 / 17.0, -58.0 / 17.0])
    };
    // pushing the first point down lifts the second off
    let lever = || {
        Problem::new("lever", &[&[2.0, 1.0], &[1.0, 2.0]], &[2.0, -1.0], &rows[..2]).kind(&[Contact; 2]).answer(&[1.0, 0.0], &[0.0, -2.0])
    };
    // u_0 = u_1 by a tie, and a wall for both at 1
    let tied = || {
        Problem::new("tie and wall", &[&[1.0, 0.0], &[0.0, 3.0]], &[8.0, 0.0], &[(&[(0, 1.0)], &[(1, -1.0)]), (&[(1, -1.0)], &[])])
            .offset(&[0.0, 1.0])
            .kind(&[Equal, Contact])
            .answer(&[1.0, 1.0], &[7.0, -4.0])
    };
    let mut problems = vec![circle(), lever(), tied(), hanging(1.0), hanging(0.25)];
    problems.push(
        Problem::new("closed gaps without load", &[&[2.0, 1.0], &[1.0, 2.0]], &[0.0, 0.0], &rows[..2])
            .kind(&[Contact; 2])
            .answer(&[0.0, 0.0], &[0.0, 0.0]),
    );
    for (stiffness, length, weight) in [(1e12, 1e-6, 1e-3), (1e-9, 1e6, 1e6)] {
        for problem in [circle(), lever(), tied(), hanging(1.0)] {
            problems.push(problem.units(stiffness, length, weight));
        }
    }
    problems
}

impl Problem {
    /// Checks signs and complementarity: contact rows press or are open, and not both.
    fn signs(&self, solution: &ConstrainedSolution) -> Result<(), String> {
        let weight = self.rows.slave.entries.iter().fold(0.0, |m: f64, e| m.max(e.2.abs()));
        let length = weight * largest(&self.unknowns).max(largest(&self.offset) / weight.max(f64::MIN_POSITIVE));
        let force = largest(&self.stiffness.diagonal()) * length / weight.powi(2).max(f64::MIN_POSITIVE);
        for i in (0..self.kind.len()).filter(|&i| self.kind[i] == RowKind::Contact) {
            let (lambda, gap) = (solution.multipliers[i], solution.gap[i]);
            if above(lambda, 1e-9 * force) || above(-gap, 1e-9 * length) || above((lambda * gap).abs(), 1e-9 * force * length) {
                return Err(format!("solver: {}: row {i} has the multiplier {lambda} and the gap {gap}", self.name));
            }
        }
        Ok(())
    }
}

/// A system and its solution.
struct Problem {
    name: String,
    stiffness: Csr,
    load: Vec<f64>,
    rows: Rows,
    /// The rows that act on the bodies; `None`: `rows`.
    reaction: Option<Rows>,
    offset: Vec<f64>,
    kind: Vec<RowKind>,
    compliance: Vec<f64>,
    unknowns: Vec<f64>,
    multipliers: Vec<f64>,
}

impl Problem {
    /// Dense stiffness, rows as (slave entries, master entries).
    fn new(name: &str, stiffness: &[&[f64]], load: &[f64], rows: &[(&[(usize, f64)], &[(usize, f64)])]) -> Self {
        let (n, m) = (load.len(), rows.len());
        let mut k = Triplets::new(n, n);
        for (i, row) in stiffness.iter().enumerate() {
            for (j, &v) in row.iter().enumerate() {
                if v != 0.0 {
                    k.push(i, j, v);
                }
            }
        }
        let (mut slave, mut master) = (Triplets::new(m, n), Triplets::new(m, n));
        for (i, (s, p)) in rows.iter().enumerate() {
            s.iter().for_each(|&(j, v)| slave.push(i, j, v));
            p.iter().for_each(|&(j, v)| master.push(i, j, v));
        }
        Self {
            name: name.into(),
            stiffness: k.to_csr(),
            load: load.to_vec(),
            rows: Rows { slave, master },
            reaction: None,
            offset: vec![0.0; m],
            kind: vec![RowKind::Equal; m],
            compliance: Vec::new(),
            unknowns: vec![0.0; n],
            multipliers: vec![0.0; m],
        }
    }

    fn offset(mut self, offset: &[f64]) -> Self {
        self.offset = offset.to_vec();
        self
    }

    fn kind(mut self, kind: &[RowKind]) -> Self {
        self.kind = kind.to_vec();
        self
    }

    fn compliance(mut self, compliance: &[f64]) -> Self {
        self.compliance = compliance.to_vec();
        self
    }

    fn answer(mut self, unknowns: &[f64], multipliers: &[f64]) -> Self {
        self.unknowns = unknowns.to_vec();
        self.multipliers = multipliers.to_vec();
        self
    }

    /// Converts the problem to other units of stiffness and length, and another weight of the rows.
    fn units(mut self, stiffness: f64, length: f64, weight: f64) -> Self {
        self.name = format!("{} (stiffness {stiffness:.0e}, length {length:.0e}, weight {weight:.0e})", self.name);
        let force = stiffness * length;
        self.stiffness.vals_mut().iter_mut().for_each(|v| *v *= stiffness);
        self.load.iter_mut().for_each(|v| *v *= force);
        for part in std::iter::once(&mut self.rows).chain(&mut self.reaction).flat_map(|rows| [&mut rows.slave, &mut rows.master]) {
            part.entries.iter_mut().for_each(|e| e.2 *= weight);
        }
        self.offset.iter_mut().for_each(|v| *v *= length * weight);
        self.compliance.iter_mut().for_each(|v| *v *= weight * weight / stiffness);
        self.unknowns.iter_mut().for_each(|v| *v *= length);
        self.multipliers.iter_mut().for_each(|v| *v *= force / weight);
        self
    }

    fn solve(&self, solver: &mut dyn ConstraintSolver) -> Result<ConstrainedSolution, SolveError> {
        solver.solve(&ConstrainedSystem {
            stiffness: &self.stiffness,
            load: &self.load,
            constraint: &self.rows,
            reaction: self.reaction.as_ref(),
            offset: &self.offset,
            kind: &self.kind,
            compliance: &self.compliance,
        })
    }

    fn check(&self, solver: &mut dyn ConstraintSolver) -> Result<(), String> {
        self.compare(&self.solve(solver).map_err(|e| format!("solver: {}: {e}", self.name))?)
    }

    fn compare(&self, solution: &ConstrainedSolution) -> Result<(), String> {
        near(&self.name, "unknown", &solution.unknowns, &self.unknowns, 0.0)?;
        // multipliers that are all zero are compared with the force that would give the same displacement
        let weight = self.rows.slave.entries.iter().fold(0.0, |m: f64, e| m.max(e.2.abs()));
        let force = largest(&self.stiffness.diagonal()) * largest(&self.unknowns) / if weight > 0.0 { weight } else { 1.0 };
        near(&self.name, "multiplier", &solution.multipliers, &self.multipliers, force)?;
        let mut gap = self.offset.clone();
        for part in [&self.rows.slave, &self.rows.master] {
            part.entries.iter().for_each(|&(i, j, v)| gap[i] += v * self.unknowns[j]);
        }
        let scale = self.rows.slave.entries.iter().fold(0.0, |m: f64, e| m.max(e.2.abs() * largest(&self.unknowns)));
        if solution.gap.len() != gap.len() || (0..gap.len()).any(|i| above((solution.gap[i] - gap[i]).abs(), 1e-9 * scale)) {
            return Err(format!("solver: {}: the gaps are {:?} instead of {gap:?}", self.name, solution.gap));
        }
        if solution.active.len() != gap.len() {
            return Err(format!("solver: {}: {} states for {} rows", self.name, solution.active.len(), gap.len()));
        }
        for i in 0..gap.len() {
            if self.kind[i] == RowKind::Open && solution.multipliers[i] != 0.0 {
                return Err(format!("solver: {}: the multiplier of open row {i} is not zero", self.name));
            }
            let expected = match self.kind[i] {
                RowKind::Equal => true,
                RowKind::Open => false,
                // a row that just touches may be either
                RowKind::Contact if self.multipliers[i] == 0.0 && gap[i] == 0.0 => solution.active[i],
                RowKind::Contact => self.multipliers[i] != 0.0,
            };
            if solution.active[i] != expected {
                return Err(format!("solver: {}: row {i} is reported {}", self.name, if expected { "open" } else { "active" }));
            }
        }
        if above(solution.residual, 1e-10) {
            return Err(format!("solver: {}: the residual is {:.1e}", self.name, solution.residual));
        }
        Ok(())
    }
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// Whether a value is above the bound, or NaN.
fn above(x: f64, bound: f64) -> bool {
    x.is_nan() || x > bound
}

/// Checks equality to 1e-9 of the largest expected value, or of `size` if zeros are expected.
fn near(name: &str, what: &str, found: &[f64], expected: &[f64], size: f64) -> Result<(), String> {
    if found.len() != expected.len() {
        return Err(format!("solver: {name}: {} {what}s instead of {}", found.len(), expected.len()));
    }
    let scale = if largest(expected) > 0.0 { largest(expected) } else { size };
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        if above((a - b).abs(), 1e-9 * scale) {
            return Err(format!("solver: {name}: {what} {i} is {a} instead of {b}"));
        }
    }
    Ok(())
}

/// Two springs to the ground, stiffness 1 and 3, pulled by 4 at the first; u_0 = u_1.
fn tie() -> Problem {
    Problem::new("tie", &[&[1.0, 0.0], &[0.0, 3.0]], &[4.0, 0.0], &[(&[(0, 1.0)], &[(1, -1.0)])]).answer(&[1.0, 1.0], &[3.0])
}

fn known() -> Vec<Problem> {
    use RowKind::{Equal, Open};
    let shifted = || Problem { name: "shifted tie".into(), ..tie() }.offset(&[-2.0]).answer(&[2.5, 0.5], &[1.5]);
    // u_0 = 4 - l, u_1 = l / 3, u_0 - u_1 = l / 2
    let soft = || Problem { name: "soft tie".into(), ..tie() }.compliance(&[0.5]).answer(&[20.0 / 11.0, 8.0 / 11.0], &[24.0 / 11.0]);
    // a spring of stiffness 2 that hangs on a support of stiffness 1 by its row alone, pulled by 1 at its end
    let floating = || {
        Problem::new(
            "floating body",
            &[&[1.0, 0.0, 0.0], &[0.0, 2.0, -2.0], &[0.0, -2.0, 2.0]],
            &[0.0, 0.0, 1.0],
            &[(&[(1, 1.0)], &[(0, -1.0)])],
        )
        .answer(&[1.0, 1.0, 1.5], &[1.0])
    };
    let identity: &[&[f64]] = &[&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0], &[0.0, 0.0, 1.0]];
    // u_0 + u_1 = 0 and u_0 + u_1 + u_2 = 0: two rows over three slave unknowns
    let shared = || {
        Problem::new(
            "rows that share unknowns",
            identity,
            &[1.0, 3.0, 5.0],
            &[(&[(0, 1.0), (1, 1.0)], &[]), (&[(0, 1.0), (1, 1.0), (2, 1.0)], &[])],
        )
        .answer(&[-1.0, 1.0, 0.0], &[-3.0, 5.0])
    };
    let mixed = || {
        Problem::new("exact, soft and open rows", identity, &[0.0, 2.0, 3.0], &[(&[(0, 1.0)], &[]), (&[(1, 1.0)], &[]), (&[(2, 1.0)], &[])])
            .offset(&[-1.0, 0.0, 0.0])
            .kind(&[Equal, Equal, Open])
            .compliance(&[0.0, 1.0, 0.0])
            .answer(&[1.0, 1.0, 3.0], &[-1.0, 1.0, 0.0])
    };
    // a body held by a soft row only: 1 = l, u_1 = u_0 + 5 l
    let soft_floating =
        || Problem { name: "body held by a soft row".into(), ..floating() }.compliance(&[5.0]).answer(&[1.0, 6.0, 6.5], &[1.0]);
    // entries given in parts that are summed
    let mut parts = Problem { name: "entries in parts".into(), ..tie() };
    parts.rows.slave.entries = vec![(0, 0, 0.25), (0, 0, 0.75)];
    let mut problems = vec![
        Problem::new("no rows", &[&[2.0, -1.0], &[-1.0, 2.0]], &[1.0, 0.0], &[]).answer(&[2.0 / 3.0, 1.0 / 3.0], &[]),
        tie(),
        shifted(),
        soft(),
        Problem { name: "open tie".into(), ..tie() }.kind(&[Open]).answer(&[4.0, 0.0], &[0.0]),
        tie(),
        floating(),
        shared(),
        mixed(),
        soft_floating(),
        parts,
        Problem { name: "no load".into(), ..tie() }.with_load(&[0.0, 0.0]).answer(&[0.0, 0.0], &[0.0]),
    ];
    for (stiffness, length, weight) in [(1e12, 1e-6, 1e-3), (1e9, 1e3, 1.0), (1e-9, 1e6, 1e6), (1.0, 1e-6, 1e-9)] {
        for problem in [tie(), shifted(), soft(), floating(), shared(), mixed(), soft_floating()] {
            problems.push(problem.units(stiffness, length, weight));
        }
    }
    problems
}

impl Problem {
    fn with_load(mut self, load: &[f64]) -> Self {
        self.load = load.to_vec();
        self
    }
}

fn impossible() -> Vec<(Problem, &'static str)> {
    let twice = Problem::new("contradicting rows", &[&[1.0]], &[0.0], &[(&[(0, 1.0)], &[]), (&[(0, 1.0)], &[])]).offset(&[0.0, -1.0]);
    let free = Problem::new("free spring", &[&[1.0, -1.0], &[-1.0, 1.0]], &[0.0, 1.0], &[]);
    let balanced = Problem::new("free spring, balanced load", &[&[1.0, -1.0], &[-1.0, 1.0]], &[-1.0, 1.0], &[]);
    let mut nan = tie();
    nan.name = "load that is not a number".into();
    nan.load[0] = f64::NAN;
    let empty = Problem::new("row without entries", &[&[1.0]], &[0.0], &[(&[], &[])]).offset(&[1.0]);
    vec![
        (twice, "u = 0 and u = 1 at once are answered"),
        (free, "a body without support is answered"),
        (balanced, "a body without support is answered: its rigid motion is not determined"),
        (nan, "it is answered"),
        (empty, "0 = 1 is answered"),
    ]
}
