//! Abilities of a constraint solver against the truth: each is asked of small systems that need it.

use super::Problem;
use crate::constraint::{Abilities, ConstraintSolver, RowKind, SolveError};
use crate::linalg::LinearError;

/// An ability, the systems that need it, and the error of a solver without it.
struct Claim {
    name: &'static str,
    of: fn(Abilities) -> bool,
    systems: Vec<Problem>,
    refused: fn(&SolveError) -> bool,
}

/// Checks that the solvers made by `make`, and `one` that has solved other systems before, solve what they claim and refuse, with the error
/// that says so, what they deny.
///
/// # Errors
/// A sentence that names the ability and the system.
pub(super) fn honest(make: impl Fn() -> Box<dyn ConstraintSolver>, one: &mut dyn ConstraintSolver) -> Result<(), String> {
    let abilities = make().abilities();
    for Claim { name, of, systems, refused } in claims() {
        for system in systems {
            for solver in [&mut *make(), &mut *one] {
                let solved = system.solve(solver);
                match (of(abilities), solved) {
                    (true, Ok(solution)) => system.compare(&solution)?,
                    (true, Err(error)) => return Err(format!("solver: {}: {error}; but `{name}` is among its abilities", system.name)),
                    (false, Ok(_)) => {
                        return Err(format!("solver: {}: it is solved, but `{name}` is not among its abilities", system.name));
                    }
                    (false, Err(error)) if refused(&error) => {}
                    (false, Err(error)) => return Err(format!("solver: {}: {error}", system.name)),
                }
            }
        }
    }
    if one.abilities() == abilities { Ok(()) } else { Err("solver: its abilities change with the systems that it solves".into()) }
}

fn claims() -> [Claim; 3] {
    [
        Claim {
            name: "contact",
            of: |abilities| abilities.contact,
            systems: contacts(),
            refused: |error| matches!(error, SolveError::ContactRow { row: 0 }),
        },
        Claim {
            name: "unsymmetric",
            of: |abilities| abilities.unsymmetric,
            systems: vec![other_reaction(), other_stiffness()],
            refused: |error| matches!(error, SolveError::NotSymmetric | SolveError::Linear(LinearError::NotSymmetric)),
        },
        Claim {
            name: "more_rows_than_unknowns",
            of: |abilities| abilities.more_rows_than_unknowns,
            systems: vec![more_rows(), more_rows().units(1e12, 1e-6, 1e-3), more_rows().units(1e-9, 1e6, 1e6)],
            refused: |error| matches!(error, SolveError::OverConstrained { .. }),
        },
    ]
}

/// A spring of stiffness 1 pushed by f towards a wall at distance 1: gap 1 - u.
fn wall(force: f64, unknown: f64, multiplier: f64) -> Problem {
    Problem::new(&format!("wall, force {force}"), &[&[1.0]], &[force], &[(&[(0, -1.0)], &[])])
        .offset(&[1.0])
        .kind(&[RowKind::Contact])
        .answer(&[unknown], &[multiplier])
}

pub(super) fn contacts() -> Vec<Problem> {
    let mut problems = vec![wall(2.0, 1.0, -1.0), wall(0.5, 0.5, 0.0), wall(-3.0, -3.0, 0.0), wall(1.0, 1.0, 0.0)];
    for (stiffness, length, weight) in [(1e12, 1e-6, 1e-3), (1e-9, 1e6, 1e6)] {
        problems.push(wall(2.0, 1.0, -1.0).units(stiffness, length, weight));
        problems.push(wall(0.5, 0.5, 0.0).units(stiffness, length, weight));
    }
    // two springs between walls: one touches, one does not; a third row is open though the spring passes through it
    problems.push(
        Problem::new(
            "three walls",
            &[&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0], &[0.0, 0.0, 1.0]],
            &[3.0, 0.5, 4.0],
            &[(&[(0, -1.0)], &[]), (&[(1, -1.0)], &[]), (&[(2, -1.0)], &[])],
        )
        .offset(&[1.0, 1.0, 1.0])
        .kind(&[RowKind::Contact, RowKind::Contact, RowKind::Open])
        .answer(&[1.0, 0.5, 4.0], &[-2.0, 0.0, 0.0]),
    );
    problems
}

/// C u = 1 on the first of two unknowns, reaction (1, 1/2): lambda = -1, u = (1, 1/2).
fn other_reaction() -> Problem {
    let mut problem = Problem::new("other reaction", &[&[1.0, 0.0], &[0.0, 1.0]], &[0.0, 0.0], &[(&[(0, 1.0)], &[])])
        .offset(&[-1.0])
        .answer(&[1.0, 0.5], &[-1.0]);
    let mut reaction = problem.rows.clone();
    reaction.slave.push(0, 1, 0.5);
    problem.reaction = Some(reaction);
    problem
}

/// K = [[2, 1], [0, 1]], f = (3, 1).
fn other_stiffness() -> Problem {
    Problem::new("stiffness that is not symmetric", &[&[2.0, 1.0], &[0.0, 1.0]], &[3.0, 1.0], &[]).answer(&[1.0, 1.0], &[])
}

/// A spring of stiffness 1 pulled by 1, and two soft rows that hold it: u = l_0 = l_1 = (1 - u) / 2.
fn more_rows() -> Problem {
    let third = 1.0 / 3.0;
    Problem::new("two soft rows on one unknown", &[&[1.0]], &[1.0], &[(&[(0, 1.0)], &[]), (&[(0, 1.0)], &[])])
        .compliance(&[1.0, 1.0])
        .answer(&[third], &[third, third])
}
