//! Abilities of constraint solvers: those of the library, and the check that finds a solver that lies about its own.

use faying::check;
use faying::constraint::{
    Abilities, ActiveSet, Augmented, Condensed, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Direct, Krylov, Outer,
    PenaltyElimination, Schur, SolveError,
};
use faying::linalg::Limits;

type Make = fn() -> Box<dyn ConstraintSolver>;

const NONE: Abilities = Abilities { contact: false, unsymmetric: false, more_rows_than_unknowns: false };
const ROWS: Abilities = Abilities { more_rows_than_unknowns: true, ..NONE };
const BOTH: Abilities = Abilities { unsymmetric: true, ..ROWS };

/// Solvers of exact rows, by their abilities without an active set.
const SOLVERS: [(&str, Make, Abilities); 7] = [
    ("direct", || Box::new(Direct::new()), BOTH),
    ("condensed", || Box::new(Condensed::new()), NONE),
    ("condensed, iterative", || Box::new(Condensed::iterative(Limits::default())), NONE),
    ("schur", || Box::new(Schur::new(Limits::default())), ROWS),
    ("krylov", || Box::new(Krylov::new(Limits::default())), BOTH),
    ("augmented direct", || Box::new(Augmented::new(Direct::new())), BOTH),
    ("augmented condensed", || Box::new(Augmented::new(Condensed::new())), NONE),
];

#[test]
fn solvers_say_what_they_solve_and_solve_what_they_say() {
    for (name, make, expected) in SOLVERS {
        assert_eq!(make().abilities(), expected, "{name}");
        check::solver(make).unwrap_or_else(|e| panic!("{name}: {e}"));
        let around = || ActiveSet::new(make());
        assert_eq!(around().abilities(), Abilities { contact: true, ..expected }, "{name}");
        check::solver(|| Box::new(around())).unwrap_or_else(|e| panic!("{name} in an active set: {e}"));
        assert_eq!(Outer::new(around(), Vec::new()).abilities(), around().abilities(), "{name}");
    }
    for uzawa in [&Augmented::uzawa(Limits::default()) as &dyn ConstraintSolver, &Augmented::uzawa_iterative(Limits::default())] {
        assert_eq!(uzawa.abilities(), ROWS);
    }
    // it solves no exact rows
    assert_eq!(PenaltyElimination::new().abilities(), ROWS);
}

/// A solver that says other things of itself than are true.
#[derive(Debug)]
struct Lying<C>(C, Abilities);

impl<C: ConstraintSolver> ConstraintSolver for Lying<C> {
    fn abilities(&self) -> Abilities {
        self.1
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        self.0.solve(system)
    }
}

#[test]
fn a_solver_that_claims_too_much_or_denies_what_it_can_is_found_out() {
    let all = Abilities { contact: true, ..BOTH };
    let said = |inner: Make, abilities: Abilities| check::solver(|| Box::new(Lying(inner(), abilities)));
    let direct: Make = || Box::new(Direct::new());
    let condensed: Make = || Box::new(Condensed::new());
    let set: Make = || Box::new(ActiveSet::new(Direct::new()));
    for (inner, truth) in [(direct, BOTH), (condensed, NONE), (set, all)] {
        said(inner, truth).unwrap();
        for (name, lie) in [
            ("contact", Abilities { contact: !truth.contact, ..truth }),
            ("unsymmetric", Abilities { unsymmetric: !truth.unsymmetric, ..truth }),
            ("more_rows_than_unknowns", Abilities { more_rows_than_unknowns: !truth.more_rows_than_unknowns, ..truth }),
        ] {
            let found = said(inner, lie).unwrap_err();
            assert!(found.contains(&format!("`{name}` is")) && found.contains("among its abilities"), "{found}");
        }
    }
}

/// A solver that has another ability after its first system.
#[derive(Debug)]
struct Moody(Direct, bool);

impl ConstraintSolver for Moody {
    fn abilities(&self) -> Abilities {
        Abilities { contact: self.1, ..self.0.abilities() }
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        self.1 = true;
        self.0.solve(system)
    }
}

#[test]
fn abilities_that_change_with_the_systems_solved_are_found_out() {
    let found = check::solver(|| Box::new(Moody(Direct::new(), false))).unwrap_err();
    assert!(found.contains("change"), "{found}");
}
