//! The obstacle problem of deal.II's tutorial step-41: the active set alone, with sizes that others published.

use faying::constraint::{
    Abilities, ActiveSet, Condensed, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Direct, RowKind, SolveError,
};
use faying::coupling::Rows;
use faying::linalg::{Csr, Triplets};

/// Cells per direction of the square (-1, 1)²; refine_global(7) of step-41.
const CELLS: usize = 128;

struct Obstacle {
    stiffness: Csr,
    load: Vec<f64>,
    rows: Rows,
    offset: Vec<f64>,
    kind: Vec<RowKind>,
}

/// -Lap u >= -10, u = 0 on the boundary, u >= g; Q1, lumped mass; unknowns are the interior nodes.
fn obstacle() -> Obstacle {
    let (inner, h) = (CELLS - 1, 2.0 / CELLS as f64);
    let n = inner * inner;
    let at = |i: usize, j: usize| (j - 1) * inner + (i - 1);
    // grad-grad of a square Q1 cell, any size: 1/6 of these integers; corners (0,0) (1,0) (0,1) (1,1)
    let cell = [[4.0, -1.0, -1.0, -2.0], [-1.0, 4.0, -2.0, -1.0], [-1.0, -2.0, 4.0, -1.0], [-2.0, -1.0, -1.0, 4.0]];
    let mut k = Triplets::new(n, n);
    for cy in 0..CELLS {
        for cx in 0..CELLS {
            let corner = |a: usize| (cx + a % 2, cy + a / 2);
            let free = |(i, j): (usize, usize)| (1..CELLS).contains(&i) && (1..CELLS).contains(&j);
            for a in 0..4 {
                for b in 0..4 {
                    let (p, q) = (corner(a), corner(b));
                    if free(p) && free(q) {
                        k.push(at(p.0, p.1), at(q.0, q.1), cell[a][b] / 6.0);
                    }
                }
            }
        }
    }
    let mut places = vec![[0.0; 3]; n];
    let mut slave = Triplets::new(n, n);
    let mut offset = vec![0.0; n];
    for j in 1..CELLS {
        for i in 1..CELLS {
            let (x, y) = (-1.0 + h * i as f64, -1.0 + h * j as f64);
            places[at(i, j)] = [x, y, 0.0];
            let g = if x < -0.5 {
                -0.2
            } else if x < 0.0 {
                -0.4
            } else if x < 0.5 {
                -0.6
            } else {
                -0.8
            };
            slave.push(at(i, j), at(i, j), h * h); // trapezoidal rule: lumped mass of an interior node
            offset[at(i, j)] = -h * h * g;
        }
    }
    Obstacle {
        stiffness: k.to_csr().with_dof_coordinates(places),
        load: vec![-10.0 * h * h; n], // ∫ f N_i of an interior node
        rows: Rows { slave, master: Triplets::new(n, n) },
        offset,
        kind: vec![RowKind::Contact; n],
    }
}

impl Obstacle {
    fn system(&self) -> ConstrainedSystem<'_> {
        ConstrainedSystem {
            stiffness: &self.stiffness,
            load: &self.load,
            constraint: &self.rows,
            reaction: None,
            offset: &self.offset,
            kind: &self.kind,
            compliance: &[],
        }
    }
}

/// A solver of whole systems alone.
#[derive(Debug)]
struct Whole(Direct);

impl ConstraintSolver for Whole {
    fn abilities(&self) -> Abilities {
        self.0.abilities()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        self.0.solve(system)
    }
}

/// deal.II 9, step-41, results: "Size of active set: 13164", "12363", ..., "5399", "5399" after iterations 0, 1, 17, 18.
/// Entry k + 1 of our history is the set that deal.II finds after its iteration k; an unchanged set ends the iteration.
#[test]
fn obstacle_problem_meets_the_four_published_sizes_of_the_active_set() {
    let problem = obstacle();
    let n = problem.load.len();
    let mut solver = ActiveSet::new(Whole(Direct::new())).starting_from(vec![false; n]);
    let solution = solver.solve(&problem.system()).unwrap();
    let report = solution.active_set.unwrap();
    assert_eq!(report.history[..3], [0, 13164, 12363]);
    assert_eq!(report.iterations, 19);
    assert_eq!(report.history[18], 5399, "found after deal.II's iteration 17");
    assert_eq!(solution.active.iter().filter(|&&a| a).count(), 5399, "found again after iteration 18");
    assert_eq!(solver.inner.0.num_symbolic_factorizations(), 1, "open rows keep the pattern");
}

#[test]
fn obstacle_problem_by_condensation_ends_in_the_same_state() {
    let problem = obstacle();
    let n = problem.load.len();
    let a = ActiveSet::new(Direct::new()).solve(&problem.system()).unwrap();
    let b = ActiveSet::new(Condensed::new()).starting_from(vec![false; n]).solve(&problem.system()).unwrap();
    assert_eq!(a.active, b.active);
    for i in 0..n {
        assert!((a.unknowns[i] - b.unknowns[i]).abs() < 1e-9);
        assert!((a.multipliers[i] - b.multipliers[i]).abs() < 1e-9 * 1e3, "multipliers are of the order 1e3");
    }
}

/// Two squares side by side are one rectangle without a seam; a curve has its obstacle to its right.
#[test]
fn outlines_are_the_boundary_of_all_areas() {
    use faying::contact::{Surface, body_outline, curve_outline, opposed, without_seams};
    use faying::geometry::ControlNet;
    use faying::geometry::shapes::rectangle;
    use faying::linalg::Vector;
    use faying::space::{Body, Patch, PatchSpec};
    let mut all = Vec::new();
    for x in [0.0, 1.0] {
        let spec = PatchSpec::new(rectangle([x, 0.0], [x + 1.0, 1.0]).unwrap()).with_elements([2, 2]);
        let square = Patch::<1, 2>::try_new(&spec).unwrap();
        all.extend(body_outline(&square, square.sides()).unwrap());
    }
    assert_eq!(all.len(), 16);
    let outer = without_seams(all);
    assert_eq!(outer.len(), 12);
    let box_of_two = Surface::of_pieces(outer, None);
    let hit = opposed(&box_of_two, &Vector::from([1.0, 1.5]), &Vector::from([0.0, -1.0])).unwrap();
    assert!((hit.gap - 0.5).abs() < 1e-14 && (hit.normal - Vector::<2>::from([0.0, 1.0])).norm() < 1e-14);
    let line =
        |points: [[f64; 2]; 2]| ControlNet::from_knots([1], [vec![0.0, 0.0, 1.0, 1.0]], points.map(Vector::from).into(), None).unwrap();
    let floor = Surface::of_pieces(curve_outline(line([[0.0, 0.0], [1.0, 0.0]])).unwrap(), None);
    let hit = opposed(&floor, &Vector::from([0.3, 0.2]), &Vector::from([0.0, -1.0])).unwrap();
    assert!((hit.gap - 0.2).abs() < 1e-14);
    assert!(opposed(&floor, &Vector::from([0.3, -0.2]), &Vector::from([0.0, 1.0])).is_none());
    let stuck = curve_outline(line([[2.0, 1.0], [2.0, 1.0]])).unwrap_err();
    assert!(stuck.to_string().contains("stands still at (2, 1)"), "{stuck}");
}
