//! One factor for all sets of a contact: the same sets, the same answers, and counted operations.
//!
//! `FAYING_ONE_FACTOR=200` takes that many random graded cases (`.ci/long`), 12 otherwise.

use faying::constraint::{
    Abilities, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Direct, InterfaceWork, RowsAlone, SolveError,
};
use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::run::run;
use faying_cli::{Finished, Registry, RunControl, RunOptions, Status};
use std::sync::{Arc, Mutex};

/// A direct solver that has a factor for every set.
#[derive(Debug)]
struct Apart(Direct);

impl ConstraintSolver for Apart {
    fn abilities(&self) -> Abilities {
        self.0.abilities()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        self.0.solve(system)
    }
}

/// What a direct solver counted: its Schur complement's work, analyses, factors.
type Counts = Arc<Mutex<(InterfaceWork, usize, usize)>>;

/// A direct solver that shares a factor and writes down what it counted.
#[derive(Debug)]
struct Counted(Direct, Counts);

impl ConstraintSolver for Counted {
    fn abilities(&self) -> Abilities {
        self.0.abilities()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        self.0.solve(system)
    }

    fn solve_set(&mut self, system: &ConstrainedSystem<'_>, closed: &[bool], again: bool) -> Result<ConstrainedSolution, SolveError> {
        let solution = self.0.solve_set(system, closed, again);
        *self.1.lock().unwrap() = (self.0.interface_work(), self.0.num_symbolic_factorizations(), self.0.factorisations());
        solution
    }

    fn rows_alone(&mut self, system: &ConstrainedSystem<'_>, groups: &[Vec<usize>], again: bool) -> Result<Option<RowsAlone>, SolveError> {
        self.0.rows_alone(system, groups, again)
    }

    fn factors(&self) -> usize {
        self.0.factors()
    }
}

fn solved(text: &str, solver: &str) -> (Finished, Counts) {
    let counts = Counts::default();
    let mut registry = Registry::default();
    let list = counts.clone();
    registry.solvers.add("apart", Box::new(|_| Ok(Box::new(Apart(Direct::new())))));
    registry.solvers.add("counted", Box::new(move |_| Ok(Box::new(Counted(Direct::new(), list.clone())))));
    let options = ReadOptions { names: registry.case_names(), ..ReadOptions::default() };
    let text = format!("{text}[solver]\nconstraint = \"{solver}\"\n");
    let case = Case::parse("case.toml", &text, &options).unwrap_or_else(|e| panic!("{e}\n{text}"));
    (run(&case, &registry, &RunOptions::default(), &RunControl::default()), counts)
}

fn said(finished: &Finished) -> String {
    finished.result.diagnostics.iter().map(|d| d.render()).collect()
}

/// Multipliers and gaps apart, relative to the largest.
fn apart(a: &Finished, b: &Finished) -> f64 {
    let rows = |f: &Finished| -> Vec<(f64, f64)> {
        let sides = &f.output.as_ref().unwrap().sides;
        sides.iter().flat_map(|s| s.rows.iter().map(|r| (r.lambda[0], r.gap.unwrap_or(0.0)))).collect()
    };
    let (x, y) = (rows(a), rows(b));
    assert_eq!(x.len(), y.len());
    let top = y.iter().fold((0.0f64, 0.0f64), |m, r| (m.0.max(r.0.abs()), m.1.max(r.1.abs())));
    let share = |d: f64, top: f64| if d == 0.0 { 0.0 } else { d.abs() / top };
    x.iter().zip(&y).fold(0.0f64, |m, (p, q)| m.max(share(p.0 - q.0, top.0)).max(share(p.1 - q.1, top.1.max(1e-3))))
}

/// SplitMix64.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % n as u64) as usize
    }
    fn one<'a>(&mut self, of: &[&'a str]) -> &'a str {
        of[self.below(of.len())]
    }
}

/// A graded disc or block, held or floating, alone on a plane, on a body, or on two that are tied.
fn random_case(number: usize) -> String {
    let mut dice = Dice(1000 + number as u64);
    let d = &mut dice;
    let degree = 1 + d.below(3);
    let (backend, multiplier) = (d.one(&["iga", "fe"]), if degree == 1 { "p/p" } else { d.one(&["p/p", "p/p-2"]) });
    let ratio = d.one(&["0.3", "0.05", "0.01"]);
    let load = d.one(&["-1e-3", "-3e-4", "-5e-3*(1 - 0.9*x)"]);
    let hold = d.one(&["fix = [\"x\"]", "fix = [\"x\"]\n[[boundary]]\non = \"b.u1\"\nspring = { y = 1e-2 }", "spring = { x = 0.5 }"]);
    let start = d.one(&["\"all\"", "\"gap\"", "{ seed = 7 }"]);
    let upper = format!(
        "[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 1], radius = [0.2, 1], angle_deg = [-90, 0] }}\n\
         elements = [{}, {}]\ngrade = {{ toward = {{ u = 0.0, v = 1.0 }}, ratio = {ratio} }}\n[[boundary]]\non = \"b.u0\"\n{hold}\n\
         [[boundary]]\non = \"b.u1\"\ntraction = {{ y = \"{load}\" }}\n",
        10 + d.below(14),
        4 + d.below(4)
    );
    let block = |name: &str, y: [f64; 2], nx: usize| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [0, {}], max = [1.5, {}] }}\nelements = [{nx}, 3]\n",
            y[0], y[1]
        )
    };
    let rule = format!("multiplier = \"{multiplier}\"\nactive_set = {{ start = {start} }}\n");
    let rest = match d.below(3) {
        0 => format!(
            "[[contact]]\nname = \"c\"\nslave = \"b.v1\"\nrigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n{rule}"
        ),
        1 => {
            block("a", [-0.5, 0.0], 9 + d.below(9))
                + &format!(
                    "[[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n[[contact]]\nname = \"c\"\nslave = \"b.v1\"\nmaster = \"a.top\"\n{rule}"
                )
        }
        _ => {
            block("a", [-0.5, 0.0], 9 + d.below(9))
                + &block("t", [-1.0, -0.5], 5)
                + "[[boundary]]\non = \"t.bottom\"\nfix = [\"x\", \"y\"]\n[[interface]]\nname = \"i\"\nslave = \"a.bottom\"\nmaster = \"t.top\"\n"
                + &format!("[[contact]]\nname = \"c\"\nslave = \"b.v1\"\nmaster = \"a.top\"\n{rule}")
        }
    };
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n\
         [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n{upper}{rest}"
    )
}

#[test]
fn random_graded_contacts_take_the_same_sets_to_the_same_answer() {
    let count = std::env::var("FAYING_ONE_FACTOR").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    let (mut sets, mut factors, mut converged) = (0, 0, 0);
    for number in 0..count {
        let text = random_case(number);
        let ((one, counts), (other, _)) = (solved(&text, "counted"), solved(&text, "apart"));
        let set = |f: &Finished| f.result.solve.as_ref().unwrap().active_set.clone();
        assert_eq!((one.result.status, one.result.exit), (other.result.status, other.result.exit), "{number}: {}\n{text}", said(&one));
        if one.result.status != Status::Ok {
            continue;
        }
        let (rows, systems) = (set(&one).unwrap(), set(&other).unwrap());
        assert_eq!(rows.history.last(), systems.history.last(), "{number}: the same set\n{text}");
        assert!(rows.iterations <= 2, "{number}: {rows:?} and {systems:?}\n{text}");
        converged += 1;
        let difference = apart(&one, &other);
        assert!(difference < 1e-10, "{number}: {difference:e}\n{text}");
        let (work, analyses, own) = *counts.lock().unwrap();
        assert_eq!(analyses, 1, "{number}");
        assert!(work.sets > 0 && own == one.result.solve.as_ref().unwrap().factors, "{number}: {work:?}");
        sets += work.sets + rows.sets.len();
        factors += own;
    }
    println!("{converged} of {count} converged: {sets} sets by {factors} factors");
    assert!(2 * converged > count && 2 * factors < sets, "{converged} of {count}, {sets} sets, {factors} factors");
}

#[test]
fn dense_sets_cost_a_twentieth_of_a_factor_and_the_columns_are_made_forward_alone() {
    let text = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"iga\"\ndegree = 2\n\
        [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
        [[patch]]\nname = \"b\"\ngeometry = { kind = \"annulus-sector\", center = [0, 1], radius = [0.2, 1], angle_deg = [-90, 0] }\n\
        elements = [96, 60]\ngrade = { toward = { u = 0.0, v = 1.0 }, ratio = 0.1 }\n\
        [[boundary]]\non = \"b.u0\"\nfix = [\"x\"]\n[[boundary]]\non = \"b.u1\"\ntraction = { y = \"-2e-3\" }\n\
        [[contact]]\nname = \"c\"\nslave = \"b.v1\"\nmultiplier = \"p/p\"\nactive_set = { start = \"all\" }\n\
        rigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }\n";
    let (finished, counts) = solved(text, "counted");
    assert_eq!(finished.result.status, Status::Ok, "{}", said(&finished));
    let (work, analyses, factors) = *counts.lock().unwrap();
    let sets = finished.result.solve.as_ref().unwrap().active_set.as_ref().unwrap().sets.len();
    println!("{work:?}, {analyses} analyses, {factors} factors, {sets} sets of the rows alone");
    assert_eq!((analyses, factors, work.complements), (1, 1, 1));
    let dense = (work.rows as f64).powi(3) / 3.0;
    assert!(sets >= 2 && work.sets == 1 && (1 + sets) as f64 * dense <= 0.05 * work.factor, "{work:?}");
    assert!(work.columns + work.complement <= 0.25 * work.factor, "{work:?}");
}

#[test]
fn the_named_schur_solver_shares_its_factor_too_and_gives_the_same_answer() {
    for number in 0..4 {
        let text = random_case(number);
        let ((one, _), (other, _)) = (solved(&text, "schur"), solved(&text, "apart"));
        assert_eq!(one.result.status, other.result.status, "{number}: {}", said(&one));
        if one.result.status == Status::Ok {
            let difference = apart(&one, &other);
            assert!(difference < 1e-8, "{number}: {difference:e}");
        }
    }
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    let bits = |threads: usize| -> Vec<u64> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let finished: Vec<Finished> = pool.install(|| (0..3).map(|number| solved(&random_case(number), "saddle-point").0).collect());
        let sides = finished.iter().filter_map(|f| f.output.as_ref()).flat_map(|o| &o.sides);
        sides.flat_map(|s| s.rows.iter().flat_map(|r| [r.lambda[0].to_bits(), r.gap.unwrap_or(0.0).to_bits()])).collect()
    };
    assert_eq!(bits(1), bits(4));
}
