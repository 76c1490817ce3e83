//! Linear solvers, orderings and constraint solvers: contracts, agreement with each other, hard cases.

use crate::common::blocks;
use blocks::{Blocks, contact_blocks, difference, differences, largest};
use faying::basis::{BSpline, Basis, LagrangeLine, Order, ShapeTable};
use faying::check;
use faying::constraint::{
    Abilities, ActiveSet, ActiveSetEvent, Condensed, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Cycle, Direct, RowKind,
    SolveError, penalty,
};
use faying::coupling::Rows;
use faying::linalg::{Cg, Csr, Ldlt, LinearError, LinearSolver, Lu, Operator, Triplets, ordering, product};
use faying::quadrature::gauss_legendre;
use proptest::prelude::*;

// ---------------------------------------------------------------------------------------------- contracts

#[test]
fn matrices_and_their_pointers_keep_the_contract_of_operators() {
    let blocks = Blocks::new((3, 1.0), (4, 2.0), &[0, 1]);
    check::operator(&blocks.stiffness).unwrap();
    check::operator(&Box::new(blocks.stiffness)).unwrap();
}

#[test]
fn linear_solvers_keep_their_contract() {
    check::linear_solver(|| Box::new(Ldlt::new())).unwrap();
    check::linear_solver(|| Box::new(Lu::new())).unwrap();
    check::linear_solver(|| Box::new(Cg::new(1e-13))).unwrap();
}

#[test]
fn constraint_solvers_keep_their_contract() {
    check::solver(|| Box::new(Direct::new())).unwrap();
    check::solver(|| Box::new(Condensed::new())).unwrap();
    check::solver(|| Box::new(ActiveSet::new(Direct::new()))).unwrap();
    check::solver(|| Box::new(ActiveSet::new(Condensed::new()))).unwrap();
    let boxed = || -> Box<dyn ConstraintSolver> { Box::new(Direct::new()) };
    check::solver(|| Box::new(ActiveSet::new(boxed()))).unwrap();
}

/// A solver that returns its inner answer with one number changed.
#[derive(Debug)]
struct Wrong(Direct, fn(&mut ConstrainedSolution));
impl ConstraintSolver for Wrong {
    fn abilities(&self) -> Abilities {
        self.0.abilities()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        let mut solution = self.0.solve(system)?;
        (self.1)(&mut solution);
        Ok(solution)
    }
}

#[test]
fn the_contract_of_constraint_solvers_notices_wrong_answers() {
    for spoil in [
        (|s| s.unknowns[0] *= 1.0 + 1e-6) as fn(&mut ConstrainedSolution),
        |s| s.multipliers.iter_mut().for_each(|l| *l = -*l),
        |s| s.gap.iter_mut().for_each(|g| *g += 1e-3),
        |s| s.active.iter_mut().for_each(|a| *a = true),
        |s| s.residual = 1.0,
    ] {
        assert!(check::solver(|| Box::new(Wrong(Direct::new(), spoil))).is_err());
    }
}

/// -u'' on n points, no matrix stored.
#[derive(Debug)]
struct Chain(usize);
impl Operator for Chain {
    fn size(&self) -> usize {
        self.0
    }
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        for i in 0..self.0 {
            let at = |k: usize| x.get(k).copied().unwrap_or(0.0);
            y[i] = 2.0 * x[i] - at(i.wrapping_sub(1)) - at(i + 1);
        }
    }
    fn diagonal(&self) -> Vec<f64> {
        vec![2.0; self.0]
    }
}

#[test]
fn conjugate_gradients_solve_an_operator_without_a_matrix_and_direct_solvers_refuse_it() {
    let a = Chain(50);
    check::operator(&a).unwrap();
    let mut cg = Cg::new(1e-12);
    cg.prepare(&a).unwrap();
    let mut x = vec![0.0; 50];
    let iterations = cg.solve(&a, &[1.0; 50], &mut x).unwrap();
    assert!(iterations <= 50);
    // -u'' = 1 with u_0 = u_51 = 0: u_i = i (51 - i) / 2
    assert!((0..50).all(|i| (x[i] - ((i + 1) * (50 - i)) as f64 / 2.0).abs() < 1e-8));
    assert_eq!(Ldlt::new().prepare(&a), Err(LinearError::NoMatrix));
    assert_eq!(Lu::new().prepare(&a), Err(LinearError::NoMatrix));
    let mut few = Cg::new(1e-12);
    few.max_iterations = 3;
    few.prepare(&a).unwrap();
    assert!(matches!(few.solve(&a, &[1.0; 50], &mut [0.0; 50]), Err(LinearError::NotConverged { iterations: 3, .. })));
}

#[test]
fn conjugate_gradients_work_in_single_precision() {
    let a = Csr::from_parts(2, vec![0, 2, 4], vec![0, 1, 0, 1], vec![2.0f32, 1.0, 1.0, 3.0]);
    let mut cg = Cg::<f32>::new(1e-6);
    cg.prepare(&a).unwrap();
    let mut x = [0.0f32; 2];
    cg.solve(&a, &[3.0, 4.0], &mut x).unwrap();
    assert!((x[0] - 1.0).abs() < 1e-5 && (x[1] - 1.0).abs() < 1e-5);
}

// ---------------------------------------------------------------------------------------------- agreement

/// rust-notes 1.5: the recipe meets LU from contrast 1e-8 to 1e8, also with a floating body.
#[test]
fn saddle_point_condensed_and_lu_agree_across_contrasts_of_stiffness() {
    for exponent in [-8, -4, 0, 4, 8] {
        for unit in [1.0, 210e9] {
            let blocks = Blocks::new((12, unit), (8, unit * 10f64.powi(exponent)), &[0, 1]);
            let direct = Direct::new().solve(&blocks.system()).unwrap();
            assert_eq!(direct.method, "saddle-point, direct");
            let condensed = Condensed::new().solve(&blocks.system()).unwrap();
            let d = differences(&blocks, &direct, &condensed);
            assert!(d.iter().all(|&x| x < 1e-9), "contrast 1e{exponent}, unit {unit:.0e}, condensed: {d:?}");
            // the force on the lower body is the load: lambda sums to it, whatever the stiffness (row sums of D are ∫ psi)
            if unit == 1.0 {
                let (n, m) = (blocks.load.len(), blocks.offset.len());
                let mut b = blocks.load.clone();
                b.resize(n + m, 0.0);
                let saddle = blocks.saddle();
                let (mut lu, mut x) = (Lu::new(), vec![0.0; n + m]);
                lu.prepare(&saddle).unwrap();
                lu.solve(&saddle, &b, &mut x).unwrap();
                let reference =
                    ConstrainedSolution { multipliers: x[n..].to_vec(), unknowns: x[..n].to_vec(), ..ConstrainedSolution::default() };
                let d = differences(&blocks, &direct, &reference);
                assert!(d.iter().all(|&x| x < 1e-9), "contrast 1e{exponent}, LU: {d:?}");
            }
        }
    }
}

#[test]
fn redundant_rows_share_their_multiplier_and_condensation_names_them() {
    let mut blocks = Blocks::new((6, 1.0), (4, 1.0), &[0, 1]);
    let once = Direct::new().solve(&blocks.system()).unwrap();
    let m = blocks.offset.len();
    let copy = |t: &Triplets| {
        let mut all = t.clone();
        all.append_below(t, m);
        all
    };
    blocks.rows = Rows { slave: copy(&blocks.rows.slave), master: copy(&blocks.rows.master) };
    blocks.offset = vec![0.0; 2 * m];
    blocks.kind = vec![RowKind::Equal; 2 * m];
    let twice = Direct::new().solve(&blocks.system()).unwrap();
    assert!(difference(&twice.unknowns, &once.unknowns) < 1e-9);
    for j in 0..m {
        assert!((twice.multipliers[j] + twice.multipliers[m + j] - once.multipliers[j]).abs() < 1e-9 * largest(&once.multipliers));
    }
    assert_eq!(Condensed::new().solve(&blocks.system()).unwrap_err(), SolveError::OverConstrained { row: m, rows: 2 * m });
}

#[test]
fn soft_rows_agree_and_approach_exact_ones_like_the_reciprocal_of_the_factor() {
    let blocks = Blocks::new((6, 70e9), (4, 210e9), &[0, 1]);
    let exact = Direct::new().solve(&blocks.system()).unwrap();
    let mut errors = Vec::new();
    for factor in [1e-3, 1e2, 1e4, 1e6, 1e12] {
        let compliance = penalty(&blocks.stiffness.diagonal(), &blocks.rows, blocks.offset.len(), factor);
        let system = ConstrainedSystem { compliance: &compliance, ..blocks.system() };
        let direct = Direct::new().solve(&system).unwrap();
        let condensed = Condensed::new().solve(&system).unwrap();
        let d = differences(&blocks, &direct, &condensed);
        assert!(d.iter().all(|&x| x < 1e-9), "factor {factor:.0e}: {d:?}");
        errors.push(difference(&direct.unknowns, &exact.unknowns));
    }
    assert!((errors[1] / errors[2] - 100.0).abs() < 10.0 && (errors[2] / errors[3] - 100.0).abs() < 1.0, "{errors:?}");
}

#[test]
fn memory_is_predicted_by_the_analysis_that_the_solve_then_uses() {
    let blocks = contact_blocks(0.006);
    let mut solver = ActiveSet::new(Direct::new());
    let bytes = solver.inner.predicted_memory(&blocks.system()).unwrap();
    solver.solve(&blocks.system()).unwrap();
    assert_eq!(solver.inner.num_symbolic_factorizations(), 1);
    let factor = 8 * solver.inner.factor_entries();
    assert!(bytes > factor && bytes < 10 * factor, "{bytes} bytes, factor {factor}");
}

#[test]
fn a_prediction_with_another_reaction_does_not_change_what_is_solved_next() {
    let blocks = Blocks::new((6, 1.0), (4, 1.0), &[0, 1]);
    let expected = Direct::new().solve(&blocks.system()).unwrap();
    // a reaction without the entries of one unknown
    let mut reaction = blocks.rows.clone();
    let lost = reaction.slave.entries[0].1;
    reaction.slave.entries.retain(|&(_, j, _)| j != lost);
    let mut solver = Direct::new();
    solver.predicted_memory(&ConstrainedSystem { reaction: Some(&reaction), ..blocks.system() }).unwrap();
    let found = solver.solve(&blocks.system()).unwrap();
    assert_eq!(found.method, expected.method);
    assert_eq!(found.unknowns, expected.unknowns);
}

#[test]
fn a_residual_whose_terms_overflow_is_not_taken_for_small() {
    let mut all = Triplets::new(2, 2);
    (0..2).for_each(|i| all.push(i, i, 1e308));
    let a = all.to_csr();
    let mut solver = Ldlt::new();
    solver.prepare(&a).unwrap();
    let mut x = [0.0; 2];
    assert!(matches!(solver.solve(&a, &[1e308; 2], &mut x), Err(LinearError::Singular { .. })), "{x:?}");
}

#[test]
fn another_reaction_is_solved_by_lu() {
    let blocks = Blocks::new((6, 1.0), (4, 1.0), &[0, 1]);
    let exact = Direct::new().solve(&blocks.system()).unwrap();
    // the same reaction in other parts is still the same: split one entry
    let mut reaction = blocks.rows.clone();
    let (i, j, v) = reaction.slave.entries[0];
    reaction.slave.entries[0].2 = 0.5 * v;
    reaction.slave.push(i, j, 0.5 * v);
    let system = ConstrainedSystem { reaction: Some(&reaction), ..blocks.system() };
    let lu = Direct::new().solve(&system).unwrap();
    assert_eq!(lu.method, "saddle-point, LU");
    let d = differences(&blocks, &lu, &exact);
    assert!(d.iter().all(|&x| x < 1e-9), "{d:?}");
    assert_eq!(Condensed::new().solve(&system).unwrap_err(), SolveError::NotSymmetric);
}

#[test]
fn a_body_that_slides_freely_is_singular_for_both_solvers() {
    // only the normal component is tied: the upper block slides
    let blocks = Blocks::new((6, 210e9), (4, 210e9), &[1]);
    for (name, solver) in [("direct", &mut Direct::new() as &mut dyn ConstraintSolver), ("condensed", &mut Condensed::new())] {
        let error = solver.solve(&blocks.system()).unwrap_err();
        assert!(matches!(error, SolveError::Linear(LinearError::Singular { .. })), "{name}: {error}");
    }
}

// ---------------------------------------------------------------------------------------------- active set

#[test]
fn a_tilting_block_opens_in_part_with_equal_states_of_both_solvers_and_one_analysis() {
    let blocks = contact_blocks(0.006);
    let mut direct = ActiveSet::new(Direct::new());
    let a = direct.solve(&blocks.system()).unwrap();
    let b = ActiveSet::new(Condensed::new()).solve(&blocks.system()).unwrap();
    let active = a.active.iter().filter(|&&x| x).count();
    assert!(active > 0 && active < a.active.len(), "{:?}", a.active);
    assert_eq!(a.active, b.active);
    assert!(differences(&blocks, &a, &b).iter().all(|&x| x < 1e-9));
    assert_eq!(direct.inner.num_symbolic_factorizations(), 1);
    let report = a.active_set.unwrap();
    let cases = report.sign_cases.last().unwrap();
    // at rest every row is closed under pressure (0) or open without (4)
    assert_eq!(cases[0] + cases[4], a.active.len());
    assert_eq!(cases[0], active);
    assert_eq!(report.history.len(), report.iterations);
    for j in 0..a.active.len() {
        assert!(a.multipliers[j] <= 0.0);
        assert!(a.gap[j] >= -1e-12 * largest(&a.unknowns));
    }
}

#[test]
fn an_active_set_stops_before_the_system_its_watcher_refuses_and_keeps_its_last_state() {
    let blocks = contact_blocks(0.006);
    let whole = ActiveSet::new(Silent(Direct::new())).solve(&blocks.system()).unwrap().active_set.unwrap();
    assert!(whole.iterations > 1);
    for allowed in 0..whole.iterations {
        let mut seen = Vec::new();
        let error = ActiveSet::new(Silent(Direct::new()))
            .solve_observed(&blocks.system(), &mut |news| {
                seen.push(news.active);
                assert_eq!((news.iteration, news.rows), (seen.len(), blocks.offset.len()));
                news.iteration <= allowed
            })
            .unwrap_err();
        let SolveError::Stopped { iterations, best } = error else { panic!("{error}") };
        assert_eq!((iterations, &seen[..]), (allowed, &whole.history[..=allowed]));
        match best {
            None => assert_eq!(allowed, 0),
            Some(best) => assert_eq!(best.active_set.unwrap().history, whole.history[..allowed]),
        }
    }
}

#[test]
fn a_lifted_block_is_told_apart_from_a_block_without_support() {
    let blocks = contact_blocks(1.0);
    for solver in [&mut ActiveSet::new(Direct::new()) as &mut dyn ConstraintSolver, &mut ActiveSet::new(Condensed::new())] {
        match solver.solve(&blocks.system()).unwrap_err() {
            SolveError::RigidMotion { iteration, open, best } => {
                assert!(iteration > 1);
                assert!(!open.is_empty());
                let best = best.unwrap();
                assert_eq!(best.unknowns.len(), blocks.load.len());
                assert_eq!(best.active_set.unwrap().iterations, iteration - 1);
            }
            other => panic!("{other}"),
        }
    }
    // sliding is free even with all rows closed
    let mut free = Blocks::new((4, 1.0), (3, 1.0), &[1]);
    free.kind.fill(RowKind::Contact);
    let error = ActiveSet::new(Direct::new()).solve(&free.system()).unwrap_err();
    assert!(matches!(error, SolveError::Linear(LinearError::Singular { .. })), "{error}");
}

#[test]
fn contact_does_not_depend_on_units_or_on_the_first_state() {
    let blocks = contact_blocks(0.006);
    let reference = ActiveSet::new(Direct::new()).solve(&blocks.system()).unwrap();
    for (stiffness, length, weight) in [(210e9, 1e-6, 1e-6), (1e-6, 1e6, 1e6)] {
        let mut other = contact_blocks(0.006);
        other.stiffness.vals_mut().iter_mut().for_each(|v| *v *= stiffness);
        other.load.iter_mut().for_each(|v| *v *= stiffness * length);
        for part in [&mut other.rows.slave, &mut other.rows.master] {
            part.entries.iter_mut().for_each(|e| e.2 *= weight);
        }
        let solution = ActiveSet::new(Direct::new()).solve(&other.system()).unwrap();
        assert_eq!(solution.active, reference.active);
        assert_eq!(solution.active_set, reference.active_set);
        let scaled: Vec<f64> = solution.unknowns.iter().map(|u| u / length).collect();
        assert!(difference(&scaled, &reference.unknowns) < 1e-9);
    }
    let m = blocks.offset.len();
    for k in 0..m {
        let mut start = vec![false; m];
        start[k] = true;
        start[m - 1] = true;
        start[0] = true;
        let solution = ActiveSet::new(Direct::new()).starting_from(start).solve(&blocks.system()).unwrap();
        assert_eq!(solution.active, reference.active, "start {k}");
    }
}

/// Says of its first answer that none of its digits are right.
#[derive(Debug)]
struct Doubtful(Direct, bool);

impl ConstraintSolver for Doubtful {
    fn abilities(&self) -> Abilities {
        self.0.abilities()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        let first = std::mem::take(&mut self.1);
        let solution = self.0.solve(system)?;
        Ok(ConstrainedSolution { condition: if first { Some(1e17) } else { solution.condition }, ..solution })
    }
}

#[test]
fn a_state_whose_digits_say_nothing_gives_way_as_a_singular_one_does() {
    let blocks = contact_blocks(-1e-3);
    let m = blocks.offset.len();
    let mut start = vec![true; m];
    start[0] = false;
    let usual = ActiveSet::new(Direct::new()).solve(&blocks.system()).unwrap();
    let solution = ActiveSet::new(Doubtful(Direct::new(), true)).starting_from(start).solve(&blocks.system()).unwrap();
    assert_eq!(solution.active, usual.active);
    let report = solution.active_set.unwrap();
    assert_eq!((report.history[0], &report.events[0]), (m, &ActiveSetEvent::AllClosed { iteration: 1 }));
    // of all rows closed there is nothing to give way to
    let only = ActiveSet::new(Doubtful(Direct::new(), true)).solve(&blocks.system()).unwrap();
    assert!(only.active_set.unwrap().events.is_empty());
}

#[test]
fn rows_that_neither_press_nor_part_keep_their_state() {
    // no load, closed gaps: lambda = 0 and gap = 0 everywhere
    let mut blocks = contact_blocks(0.0);
    blocks.load.fill(0.0);
    let closed = ActiveSet::new(Direct::new()).solve(&blocks.system()).unwrap();
    assert!(closed.active.iter().all(|&a| a));
    let m = blocks.offset.len();
    let mut start = vec![true; m];
    start[1] = false;
    let kept = ActiveSet::new(Direct::new()).starting_from(start.clone()).solve(&blocks.system()).unwrap();
    assert_eq!(kept.active, start);
    assert_eq!(kept.active_set.unwrap().sign_cases, [[0, 0, 0, m, 0, 0, 0, 0, 0]]);
}

/// min u K u / 2 - f u over u >= 0. The matrix is positive definite; its iteration runs in a circle of three states (found by trial).
fn circle() -> (Csr, Vec<f64>, Rows, Vec<RowKind>) {
    let (mut k, mut rows) = (Triplets::new(3, 3), Triplets::new(3, 3));
    for (i, row) in [[17.0, -5.0, 15.0], [-5.0, 2.0, -4.0], [15.0, -4.0, 14.0]].iter().enumerate() {
        row.iter().enumerate().for_each(|(j, &v)| k.push(i, j, v));
        rows.push(i, i, 1.0);
    }
    (k.to_csr(), vec![5.0, -3.0, 1.0], Rows { slave: rows, master: Triplets::new(3, 3) }, vec![RowKind::Contact; 3])
}

#[test]
fn active_sets_keep_the_contract_of_contact_solvers() {
    faying::check::contact_solver(|| Box::new(ActiveSet::new(Direct::new()))).unwrap();
    faying::check::contact_solver(|| Box::new(ActiveSet::new(Condensed::new()))).unwrap();
    // a solver of equalities alone is none
    let refused = faying::check::contact_solver(|| Box::new(Direct::new())).unwrap_err();
    assert!(refused.contains("contact row"), "{refused}");
}

/// A soft row whose unknowns are all prescribed keeps entries of rounding only: lambda = g / s, whatever their size.
#[test]
fn soft_rows_of_rounding_keep_their_multiplier() {
    let mut k = Triplets::new(3, 3);
    for i in 0..3 {
        k.push(i, i, 2e5);
        if i > 0 {
            k.push(i, i - 1, -1e5);
            k.push(i - 1, i, -1e5);
        }
    }
    let stiffness = k.to_csr();
    for rounding in [1e-6, 1e-12, 1e-18, 1e-24, 1e-30] {
        let rows = |factor: f64| {
            let mut rows = Triplets::new(3, 3);
            [(0, 0, 1.0), (1, 1, rounding), (1, 2, -0.7 * rounding), (2, 2, 0.3)].iter().for_each(|&(i, j, v)| rows.push(i, j, factor * v));
            Rows { slave: rows, master: Triplets::new(3, 3) }
        };
        for reaction in [None, Some(rows(1.0)), Some(rows(0.9))] {
            let system = ConstrainedSystem {
                stiffness: &stiffness,
                load: &[0.0; 3],
                constraint: &rows(1.0),
                reaction: reaction.as_ref(),
                offset: &[-1e-3, -2e-4, -1e-3],
                kind: &[RowKind::Contact; 3],
                compliance: &[1e-6; 3],
            };
            let solution = ActiveSet::new(Direct::new()).solve(&system).unwrap();
            let off = (solution.multipliers[1] / -200.0 - 1.0).abs();
            assert!(off < 1e-5 && solution.residual < 1e-12, "{rounding:e}: {:?}", solution.multipliers);
        }
    }
}

#[test]
fn a_circle_of_states_is_left_by_single_exchanges() {
    let (stiffness, load, constraint, kind) = circle();
    let system = ConstrainedSystem {
        stiffness: &stiffness,
        load: &load,
        constraint: &constraint,
        reaction: None,
        offset: &[0.0; 3],
        kind: &kind,
        compliance: &[],
    };
    let solution = ActiveSet::new(Silent(Direct::new())).solve(&system).unwrap();
    let report = solution.active_set.unwrap();
    let cycles: Vec<_> = report.cycles().collect();
    assert_eq!(cycles[0], &Cycle { first: 1, second: 4, rows: vec![0, 1, 2] });
    assert!(report.iterations > 3 && report.best == report.iterations, "{report:?}");
    assert!(report.sign_cases.iter().all(|c| c.iter().sum::<usize>() == 3));
    for j in 0..3 {
        assert!(solution.multipliers[j] <= 0.0 && solution.gap[j] >= -1e-12 && (solution.multipliers[j] * solution.gap[j]).abs() < 1e-12);
    }
    // the limit falls after the cycle: that is what is reported, with the iterate that is least wrong
    let mut short = ActiveSet::new(Silent(Direct::new()));
    short.max_iterations = 3;
    match short.solve(&system).unwrap_err() {
        SolveError::Cycling { first: 1, second: 4, rows, iterations: 3, best } => {
            assert_eq!(rows, [0, 1, 2]);
            let kept = best.active_set.as_ref().unwrap();
            assert_eq!((kept.iterations, kept.best), (3, least_violation(&system)));
            assert!(!best.unknowns.is_empty());
        }
        other => panic!("{other}"),
    }
    short.max_iterations = 2;
    match short.solve(&system).unwrap_err() {
        SolveError::TooManyIterations { iterations: 2, best } => assert_eq!(best.active_set.unwrap().iterations, 2),
        other => panic!("{other}"),
    }
}

/// The iteration of the circle with the least norm of lambda_j s_j - min(0, lambda_j s_j + k_j gap_j / s_j): here s_j = 1, k_j = K_jj.
fn least_violation(system: &ConstrainedSystem<'_>) -> usize {
    let norm = |limit: usize| {
        let mut seen = Vec::new();
        let mut set = ActiveSet::new(Spy(&mut seen));
        set.max_iterations = limit;
        let _ = set.solve(system);
        let s = seen.pop().unwrap();
        (0..3)
            .map(|j| {
                let (p, q) = (s.multipliers[j], [17.0, 2.0, 14.0][j] * if s.active[j] { 0.0 } else { s.gap[j] });
                (p - f64::min(0.0, p + q)).powi(2)
            })
            .sum::<f64>()
    };
    (1..=3).min_by(|&a, &b| norm(a).total_cmp(&norm(b))).unwrap()
}

/// Has no rows alone.
#[derive(Debug)]
struct Silent(Direct);

impl ConstraintSolver for Silent {
    fn abilities(&self) -> Abilities {
        self.0.abilities()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        self.0.solve(system)
    }
}

#[test]
fn a_first_guess_that_fails_does_not_fail_the_solution() {
    let blocks = contact_blocks(0.006);
    let mut reaction = blocks.rows.clone();
    reaction.slave.entries[0].2 *= 1.0 + 1e-9;
    let system = ConstrainedSystem { reaction: Some(&reaction), ..blocks.system() };
    let guessed = ActiveSet::new(Direct::new()).solve(&system).unwrap();
    assert!(matches!(guessed.active_set.as_ref().unwrap().events[..], [ActiveSetEvent::Symmetric { .. }]), "{:?}", guessed.active_set);
    let silent = ActiveSet::new(Silent(Direct::new())).solve(&system).unwrap();
    assert!(silent.active_set.unwrap().events.is_empty());
    assert_eq!((silent.active, silent.unknowns), (guessed.active, guessed.unknowns));
}

/// Keeps every solution.
#[derive(Debug)]
struct Spy<'a>(&'a mut Vec<ConstrainedSolution>);

impl ConstraintSolver for Spy<'_> {
    fn abilities(&self) -> Abilities {
        Direct::new().abilities()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        let solution = Direct::new().solve(system)?;
        self.0.push(solution.clone());
        Ok(solution)
    }
}

#[test]
fn penalty_contact_approaches_the_exact_contact() {
    let blocks = contact_blocks(0.006);
    let exact = ActiveSet::new(Direct::new()).solve(&blocks.system()).unwrap();
    let mut errors = Vec::new();
    for factor in [1e3, 1e5] {
        let compliance = penalty(&blocks.stiffness.diagonal(), &blocks.rows, blocks.offset.len(), factor);
        let system = ConstrainedSystem { compliance: &compliance, ..blocks.system() };
        let soft = ActiveSet::new(Direct::new()).solve(&system).unwrap();
        assert_eq!(soft.active, exact.active);
        let condensed = ActiveSet::new(Condensed::new()).solve(&system).unwrap();
        assert!(differences(&blocks, &soft, &condensed).iter().all(|&x| x < 1e-9));
        for j in 0..compliance.len() {
            if soft.active[j] {
                assert!((soft.gap[j] - compliance[j] * soft.multipliers[j]).abs() < 1e-9 * soft.gap[j].abs());
            }
        }
        errors.push(difference(&soft.unknowns, &exact.unknowns));
    }
    assert!((errors[0] / errors[1] - 100.0).abs() < 10.0, "{errors:?}");
}

// ---------------------------------------------------------------------------------------------- linear systems

/// -Lap on the unit square or cube in products of a univariate basis, one side held: K ⊗ M + M ⊗ K (⊗ M + ..).
fn laplace(basis: &dyn Basis<1>, dimensions: u32) -> Csr {
    let n = basis.num_functions();
    let (mut k, mut m) = (Triplets::new(n, n), Triplets::new(n, n));
    let (mut ids, mut table) = (Vec::new(), ShapeTable::default());
    for e in 0..basis.num_elements() {
        let rule = gauss_legendre::<f64>(basis.degree(e)[0] + 1);
        basis.active(e, &mut ids);
        basis.tabulate(e, &rule.points, Order::Gradients, &mut table);
        let h = 1.0 / basis.num_elements() as f64;
        for (q, w) in rule.weights.iter().enumerate() {
            for (a, &i) in ids.iter().enumerate() {
                for (b, &j) in ids.iter().enumerate() {
                    m.push(i, j, w * h * table.values(q)[a] * table.values(q)[b]);
                    k.push(i, j, w / h * table.grads(q)[a][0] * table.grads(q)[b][0]);
                }
            }
        }
    }
    let (k, m) = (k.to_csr(), m.to_csr());
    let total = n.pow(dimensions);
    let mut all = Triplets::new(total, total);
    for i in 0..total {
        let digit = |x: usize, d: u32| x / n.pow(d) % n;
        let mut columns = vec![0usize];
        for d in 0..dimensions {
            let line = m.row(digit(i, d)).0;
            columns = columns.iter().flat_map(|c| line.map(move |j| c + j * n.pow(d))).collect();
        }
        for j in columns {
            let mass = |d: u32| m.get(digit(i, d), digit(j, d));
            let value: f64 = (0..dimensions)
                .map(|a| k.get(digit(i, a), digit(j, a)) * (0..dimensions).filter(|&d| d != a).map(mass).product::<f64>())
                .sum();
            all.push(i, j, value);
        }
    }
    // hold the functions of the side x_1 = 0
    for e in &mut all.entries {
        if e.0 % n == 0 || e.1 % n == 0 {
            e.2 = if e.0 == e.1 { 1.0 } else { 0.0 };
        }
    }
    all.to_csr()
}

/// Splines of high degree have small eigenvalues of their own (4^-pd of the diagonal): ill-conditioned is not singular.
#[test]
fn high_degrees_are_not_taken_for_singular_and_free_bodies_are() {
    for (basis, dimensions) in [
        (Box::new(BSpline::uniform(8, 8, 7)) as Box<dyn Basis<1>>, 2),
        (Box::new(BSpline::uniform(5, 3, 4)), 3),
        (Box::new(LagrangeLine::new(8, 3)), 2),
        (Box::new(LagrangeLine::new(4, 2)), 3),
        (Box::new(BSpline::uniform(3, 40, 2)), 2),
    ] {
        let a = laplace(&*basis, dimensions);
        let n = a.size();
        let expected: Vec<f64> = (0..n).map(|i| 1.0 + (i as f64).sin()).collect();
        let (mut b, mut x) = (vec![0.0; n], vec![0.0; n]);
        a.apply(&expected, &mut b);
        for solver in [&mut Ldlt::new() as &mut dyn LinearSolver, &mut Lu::new()] {
            solver.prepare(&a).unwrap();
            solver.solve(&a, &b, &mut x).unwrap();
            assert!(difference(&x, &expected) < 1e-6, "degree {:?} in {dimensions}D: {:.1e}", basis.degree(0), difference(&x, &expected));
        }
    }
    // the upper block alone floats: three rigid motions
    for cells in [1, 5, 40] {
        let blocks = Blocks::new((1, 1.0), (cells, 210e9), &[]);
        let free: Vec<usize> = (blocks.lower..blocks.load.len()).collect();
        let mut k = Triplets::new(free.len(), free.len());
        for &i in &free {
            let (cols, vals) = blocks.stiffness.row(i);
            cols.zip(vals).for_each(|(j, &v)| k.push(i - blocks.lower, j - blocks.lower, v));
        }
        // with nothing held, and with one corner pinned (it still turns)
        for pinned in [0, 2] {
            let mut entries = k.clone();
            entries.entries.extend((0..pinned).map(|c| (c, c, 210e9)));
            let a = entries.to_csr();
            assert!(matches!(Ldlt::new().prepare(&a), Err(LinearError::Singular { .. })), "LDLT, {cells} cells, {pinned} held");
            assert!(matches!(Lu::new().prepare(&a), Err(LinearError::Singular { .. })), "LU, {cells} cells, {pinned} held");
        }
        let mut entries = k.clone();
        entries.entries.extend([0, 1, 3].map(|c| (c, c, 210e9)));
        Ldlt::new().prepare(&entries.to_csr()).unwrap();
    }
}

#[test]
fn results_are_the_same_bits_on_one_and_two_threads() {
    let run = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let blocks = Blocks::new((70, 1.0), (60, 3.0), &[0, 1]);
            let a = Direct::new().solve(&blocks.system()).unwrap();
            let b = Condensed::new().solve(&blocks.system()).unwrap();
            let order =
                ordering::nested_dissection(&usizes(&blocks.stiffness).0, &usizes(&blocks.stiffness).1, blocks.stiffness.dof_coordinates());
            (a, b, order)
        })
    };
    assert_eq!(run(1), run(2));
}

fn usizes(a: &Csr) -> (Vec<usize>, Vec<usize>) {
    let cols: Vec<usize> = (0..a.num_rows()).flat_map(|i| a.row(i).0).collect();
    ((0..a.num_rows()).map(|i| a.entries(i).start).chain([cols.len()]).collect(), cols)
}

// ---------------------------------------------------------------------------------------------- orderings

/// Pattern of nodes joined where they share a cell of an nx x ny x nz grid, `components` unknowns per node, and the places by `map`.
fn grid(n: [usize; 3], components: usize, map: impl Fn([f64; 3]) -> [f64; 3]) -> Csr {
    let node = |i: usize, j: usize, k: usize| (k * n[1] + j) * n[0] + i;
    let total = n[0] * n[1] * n[2] * components;
    let (mut ptr, mut cols, mut vals, mut places) = (vec![0usize], Vec::new(), Vec::new(), Vec::new());
    for k in 0..n[2] {
        for j in 0..n[1] {
            for i in 0..n[0] {
                for c in 0..components {
                    let own = components * node(i, j, k) + c;
                    for kk in k.saturating_sub(1)..(k + 2).min(n[2]) {
                        for jj in j.saturating_sub(1)..(j + 2).min(n[1]) {
                            for ii in i.saturating_sub(1)..(i + 2).min(n[0]) {
                                for cc in 0..components {
                                    let other = components * node(ii, jj, kk) + cc;
                                    cols.push(other as u32);
                                    vals.push(if other == own { 30.0 * components as f64 } else { -1.0 });
                                }
                            }
                        }
                    }
                    ptr.push(cols.len());
                    let at = |a: usize, x: usize| if n[a] > 1 { x as f64 / (n[a] - 1) as f64 } else { 0.0 };
                    places.push(map([at(0, i), at(1, j), at(2, k)]));
                }
            }
        }
    }
    Csr::from_parts(total, ptr, cols, vals).with_dof_coordinates(places)
}

/// Numbers in the factor with dissection and with minimum degree.
fn fills(a: &Csr) -> (usize, usize) {
    let (mut with, mut without) = (Ldlt::new(), Ldlt::new());
    with.prepare(a).unwrap();
    assert!(with.uses_nested_dissection());
    without.prepare(&a.clone().with_dof_coordinates(Vec::new())).unwrap();
    assert!(!without.uses_nested_dissection());
    (with.factor_entries(), without.factor_entries())
}

#[test]
fn dissection_fills_no_more_than_minimum_degree_on_flat_curved_thin_and_solid_grids() {
    let quarter = |x: [f64; 3]| {
        let (r, t) = (1.0 + x[0], 1.5 * x[1]);
        [r * t.cos(), r * t.sin(), x[2]]
    };
    for (name, a, bound) in [
        ("square", grid([120, 120, 1], 2, |x| x), 1.1),
        ("rectangle", grid([60, 120, 1], 2, |x| [x[0], 2.0 * x[1], 0.0]), 1.1),
        ("quarter ring", grid([60, 120, 1], 2, quarter), 1.2),
        ("thin strip", grid([1000, 6, 1], 2, |x| [100.0 * x[0], x[1], 0.0]), 1.4),
        ("thin strip along the diagonal", grid([600, 6, 1], 2, |x| [100.0 * x[0] - x[1], 100.0 * x[0] + x[1], 0.0]), 1.4),
        ("cube", grid([18, 18, 18], 1, |x| x), 0.8),
    ] {
        let (dissection, degree) = fills(&a);
        assert!((dissection as f64) < bound * degree as f64, "{name}: dissection {dissection}, minimum degree {degree}");
    }
}

#[test]
fn unknowns_without_places_of_their_own_are_not_dissected() {
    let a = grid([10, 10, 1], 1, |x| x);
    let (ptr, cols) = usizes(&a);
    assert!(ordering::nested_dissection(&ptr, &cols, &[]).is_none());
    assert!(ordering::nested_dissection(&ptr, &cols, &vec![[f64::NAN; 3]; 100]).is_none());
    let b = grid([40, 40, 1], 1, |_| [0.0; 3]);
    let (ptr, cols) = usizes(&b);
    assert!(ordering::nested_dissection(&ptr, &cols, b.dof_coordinates()).is_none());
    let mut solver = Ldlt::new();
    solver.prepare(&b).unwrap();
    assert!(!solver.uses_nested_dissection());
}

/// An unknown tied to all others (the motion of a rigid body) comes last and does not spoil the rest.
#[test]
fn an_unknown_tied_to_all_others_comes_last() {
    let a = grid([40, 40, 1], 1, |x| x);
    let n = a.size();
    let mut all = Triplets::new(n + 1, n + 1);
    for i in 0..n {
        let (cols, vals) = a.row(i);
        cols.zip(vals).for_each(|(j, &v)| all.push(i, j, v));
        all.push(i, n, -0.1);
        all.push(n, i, -0.1);
    }
    all.push(n, n, 1e3);
    let mut places = a.dof_coordinates().to_vec();
    places.push([0.5, 0.5, 1.0]);
    let b = all.to_csr().with_dof_coordinates(places);
    let (ptr, cols) = usizes(&b);
    let order = ordering::nested_dissection(&ptr, &cols, b.dof_coordinates()).unwrap();
    assert_eq!(order[n], n);
    let (plain_ptr, plain_cols) = usizes(&a);
    let plain = ordering::nested_dissection(&plain_ptr, &plain_cols, a.dof_coordinates()).unwrap();
    assert_eq!(ordering::factor_entries(&ptr, &cols, &order), ordering::factor_entries(&plain_ptr, &plain_cols, &plain) + n + 1);
}

// ---------------------------------------------------------------------------------------------- properties

proptest! {
    #![proptest_config(crate::random::inputs(64))]

    #[test]
    fn dissection_of_any_points_and_edges_is_a_permutation_and_its_postorder_fills_the_same(
        points in prop::collection::vec(prop::array::uniform3(-1.0f64..1.0), 2..600),
        edges in prop::collection::vec((0usize..600, 0usize..600), 0..2000),
        flat in any::<bool>(),
    ) {
        let n = points.len();
        let points: Vec<[f64; 3]> = points.iter().map(|p| if flat { [(p[0] * 8.0).round(), (p[1] * 8.0).round(), 0.0] } else { *p }).collect();
        let mut pattern = Triplets::new(n, n);
        (0..n).for_each(|i| pattern.push(i, i, 1.0));
        edges.iter().for_each(|&(i, j)| pattern.push((i % n).min(j % n), (i % n).max(j % n), 1.0));
        let (ptr, cols) = usizes(&pattern.to_csr());
        let order = ordering::nested_dissection(&ptr, &cols, &points).unwrap();
        let post = ordering::postordered(&ptr, &cols, &order);
        for o in [&order, &post] {
            let mut sorted = o.clone();
            sorted.sort_unstable();
            prop_assert_eq!(sorted, (0..n).collect::<Vec<_>>());
        }
        prop_assert_eq!(ordering::factor_entries(&ptr, &cols, &order), ordering::factor_entries(&ptr, &cols, &post));
    }

    #[test]
    fn products_are_those_of_dense_matrices(
        a in prop::collection::vec((0usize..7, 0usize..5, -3i32..4), 0..30),
        b in prop::collection::vec((0usize..5, 0usize..6, -3i32..4), 0..30),
    ) {
        let (mut s, mut t) = (Triplets::new(7, 5), Triplets::new(5, 6));
        a.iter().for_each(|&(i, j, v)| s.push(i, j, f64::from(v)));
        b.iter().for_each(|&(i, j, v)| t.push(i, j, f64::from(v)));
        let (s, t) = (s.to_csr(), t.to_csr());
        let p = product(&s, &t);
        for i in 0..7 {
            for j in 0..6 {
                let expected: f64 = (0..5).map(|k| s.get(i, k) * t.get(k, j)).sum();
                prop_assert_eq!(p.get(i, j), expected);
            }
        }
    }

    /// K = A Aᵀ + 1, rows of random numbers, soft and open ones among them: both methods answer the same.
    #[test]
    fn saddle_point_and_condensed_agree_on_random_systems(
        a in prop::collection::vec(-1.0f64..1.0, 12 * 12),
        c in prop::collection::vec(-1.0f64..1.0, 5 * 12),
        f in prop::collection::vec(-1.0f64..1.0, 12),
        g in prop::collection::vec(-1.0f64..1.0, 5),
        kinds in prop::collection::vec(0u8..3, 5),
        unit in -9i32..10,
    ) {
        let (n, m, unit) = (12, 5, 10f64.powi(unit));
        let mut k = Triplets::new(n, n);
        for i in 0..n {
            for j in 0..n {
                let v: f64 = (0..n).map(|q| a[i * n + q] * a[j * n + q]).sum();
                k.push(i, j, unit * (v + if i == j { 1.0 } else { 0.0 }));
            }
        }
        let (mut slave, mut master) = (Triplets::new(m, n), Triplets::new(m, n));
        for i in 0..m {
            (0..8).for_each(|j| slave.push(i, j, c[i * n + j]));
            (8..n).for_each(|j| master.push(i, j, c[i * n + j]));
        }
        let stiffness = k.to_csr();
        let rows = Rows { slave, master };
        let kind: Vec<RowKind> = kinds.iter().map(|&k| if k == 2 { RowKind::Open } else { RowKind::Equal }).collect();
        let compliance: Vec<f64> = kinds.iter().map(|&k| if k == 1 { 0.3 / unit } else { 0.0 }).collect();
        let load: Vec<f64> = f.iter().map(|v| v * unit).collect();
        let system = ConstrainedSystem {
            stiffness: &stiffness, load: &load, constraint: &rows, reaction: None, offset: &g, kind: &kind, compliance: &compliance,
        };
        let a = Direct::new().solve(&system).unwrap();
        let b = Condensed::new().solve(&system).unwrap();
        prop_assert!(difference(&a.unknowns, &b.unknowns) < 1e-9);
        prop_assert!(difference(&a.multipliers, &b.multipliers) < 1e-9 || largest(&b.multipliers) == 0.0);
        for i in 0..m {
            if kinds[i] == 0 {
                prop_assert!(a.gap[i].abs() < 1e-9 * (1.0 + largest(&a.unknowns)));
            }
        }
    }

    /// A string over an uneven floor: the iteration ends from any state in the one answer that is feasible, pressed and complementary.
    #[test]
    fn a_string_over_any_floor_ends_in_the_only_complementary_state(
        floor in prop::collection::vec(0.0f64..1.0, 5..60),
        start in any::<u64>(),
        pull in 0.0f64..0.05,
    ) {
        let n = floor.len();
        let (mut k, mut rows) = (Triplets::new(n, n), Triplets::new(n, n));
        for i in 0..n {
            k.push(i, i, 2.0);
            rows.push(i, i, 1.0);
            if i > 0 {
                k.push(i, i - 1, -1.0);
                k.push(i - 1, i, -1.0);
            }
        }
        let stiffness = k.to_csr();
        let rows = Rows { slave: rows, master: Triplets::new(n, n) };
        let system = ConstrainedSystem {
            stiffness: &stiffness, load: &vec![-pull; n], constraint: &rows, reaction: None, offset: &floor, kind: &vec![RowKind::Contact; n], compliance: &[],
        };
        let mut solver = ActiveSet::new(Direct::new()).starting_from((0..n).map(|i| start >> (i % 64) & 1 == 1).collect());
        solver.max_iterations = 2 * n;
        let s = solver.solve(&system).unwrap();
        let reference = ActiveSet { start: Vec::new(), ..solver }.solve(&system).unwrap();
        prop_assert_eq!(&s.active, &reference.active);
        for i in 0..n {
            prop_assert!(s.gap[i] > -1e-12 && s.multipliers[i] < 1e-12 && (s.gap[i] * s.multipliers[i]).abs() < 1e-12);
        }
    }
}
