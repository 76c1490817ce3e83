//! Implementations from outside with one fault each: a checker or the library refuses every one, and the same without a fault passes.

use super::common::coupled::Kind;
use faying::assembly::gauss_rules;
use faying::basis::{Basis, Cell, Elements, Order, ShapeTable};
use faying::check::{self, SegmentLimits};
use faying::constraint::{Abilities, ActiveSet, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Direct, SolveError};
use faying::coupling::interface::{MergedCurve, Partners, Tolerance};
use faying::coupling::multiplier::{MultiplierKind, build};
use faying::coupling::{Coupling, CouplingBlocks, CouplingError, Interface, InterfaceQuadrature, Mortar, Segments, Side};
use faying::geometry::Geometry;
use faying::geometry::shapes::rectangle;
use faying::linalg::{LinearError, Vector};
use faying::physics::Hooke;
use faying::problem::{BodyId, Components, ErrorKind, Problem, ProblemError, Rule, StepError};
use faying::space::{Body, Field, FunctionSpace, Patch, PatchSpec, SideError, Space, Trace};
use std::sync::Arc;

/// The functions of a space with a fault.
#[derive(Debug)]
struct Faulty(Arc<dyn Space<2, 2>>, &'static str);

impl Elements for Faulty {
    fn num_elements(&self) -> usize {
        self.0.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.0.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.0.corners(element, ids);
        if self.1.contains("without corners") {
            ids.clear();
        }
    }
}

impl Basis<2> for Faulty {
    fn num_functions(&self) -> usize {
        self.0.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; 2] {
        self.0.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.0.active(element, ids);
        let last = ids.len() - 1;
        match self.1 {
            "reversed" | "reversed, without corners" => ids.reverse(),
            "swapped" | "swapped, without corners" => ids.swap(0, 1),
            "turned" => ids.rotate_left(1),
            "swapped on one element" if element == 1 => ids.swap(0, last),
            _ => {}
        }
    }
    fn tabulate(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut ShapeTable<2>) {
        self.0.tabulate(element, xi, order, table);
        for q in 0..xi.len() {
            if order >= Order::Gradients && self.1 == "doubled gradients" {
                table.grads_mut(q).iter_mut().for_each(|g| *g *= 2.0);
            }
            if order >= Order::Hessians && self.1 == "doubled second derivatives" {
                table.hessians_mut(q).iter_mut().for_each(|h| *h *= 2.0);
            }
        }
    }
}

/// A body on such a space, with the sides of the body inside.
#[derive(Debug)]
struct FaultyBody {
    space: Arc<dyn Space<2, 2>>,
    inner: Box<dyn Body<1, 2>>,
}

impl FaultyBody {
    fn new(inner: Box<dyn Body<1, 2>>, fault: &'static str) -> Self {
        let own = Arc::clone(inner.space());
        Self { space: Arc::new(FunctionSpace { basis: Faulty(Arc::clone(&own), fault), geometry: own }), inner }
    }
}

impl Body<1, 2> for FaultyBody {
    fn space(&self) -> &Arc<dyn Space<2, 2>> {
        &self.space
    }
    fn sides(&self) -> Vec<String> {
        self.inner.sides()
    }
    fn trace(&self, side: &str) -> Result<Trace<1, 2>, SideError> {
        Trace::from_facets(&self.space, self.inner.trace(side)?.facets, Cell::Tensor)
    }
}

#[test]
fn the_checker_of_bodies_refuses_wrong_derivatives_and_orders() {
    for (kind, degree) in
        [(Kind::Spline, 1), (Kind::Spline, 2), (Kind::Nurbs, 3), (Kind::Tensor, 1), (Kind::Tensor, 3), (Kind::Triangle, 2)]
    {
        let body = |fault| FaultyBody::new(kind.rectangle([-1.0, 0.0], [1.0, 0.7], degree, [3, 2]), fault);
        for fault in ["nothing", "nothing, without corners"] {
            check::body(&body(fault)).unwrap_or_else(|e| panic!("{kind:?}, degree {degree}: {e}"));
        }
        for (fault, said) in [
            ("doubled gradients", "derivative"),
            ("doubled second derivatives", "second derivative"),
            ("reversed", "jumps"),
            ("reversed, without corners", "jumps"),
            ("swapped", "jumps"),
            ("swapped, without corners", "jumps"),
            ("turned", "jumps"),
            ("swapped on one element", "jumps"),
        ] {
            // linear functions have no second derivatives on straight cells
            if fault == "doubled second derivatives" && degree == 1 {
                continue;
            }
            let refused = check::body(&body(fault)).expect_err(fault);
            assert!(refused.contains(said), "{kind:?}, degree {degree}, {fault}: {refused}");
        }
    }
}

/// Merged integration with a fault.
#[derive(Debug)]
struct FaultyRule {
    inner: MergedCurve,
    fault: &'static str,
}

impl InterfaceQuadrature<1, 2> for FaultyRule {
    fn segments(&self, slave: &dyn Geometry<1, 2>, master: &dyn Geometry<1, 2>) -> Result<Segments<1>, CouplingError> {
        let mut s = self.inner.segments(slave, master)?;
        let masters = master.num_elements();
        match self.fault {
            "a slave element that does not exist" => s.slave[0] = 1000,
            "a master element that does not exist" => s.master[0] = 1000,
            "other master elements" => s.master.iter_mut().for_each(|m| *m = (*m + 1) % masters),
            "partners at the other end" => s.master_xi.iter_mut().for_each(|xi| xi[0] = 1.0 - xi[0]),
            "nothing, said to be covered" => s = Segments { report: s.report.clone(), ..Segments::new() },
            "half of the pieces, said to be all" => {
                let pieces = s.num_pieces() / 2;
                let report = s.report.clone();
                let kept: Vec<_> = (0..pieces).map(|k| (s.slave[k], s.master[k], s.points(k))).collect();
                let mut half = Segments::new();
                for (slave, master, points) in kept {
                    half.push_piece(slave, master, points.map(|q| (s.slave_xi[q], s.master_xi[q], s.ds[q])));
                }
                s = Segments { report, ..half };
            }
            "every piece twice" => {
                let mut twice = Segments::new();
                for k in 0..s.num_pieces() {
                    for _ in 0..2 {
                        twice.push_piece(s.slave[k], s.master[k], s.points(k).map(|q| (s.slave_xi[q], s.master_xi[q], s.ds[q])));
                    }
                }
                s = Segments { report: s.report.clone(), ..twice };
            }
            "a weight that is no number" => s.ds[0] = f64::NAN,
            "a negative weight" => s.ds[0] = -s.ds[0],
            "a start too few" => s.start.truncate(s.start.len() - 1),
            "a point too few" => s.slave_xi.truncate(s.slave_xi.len() - 1),
            "falling starts" => s.start[1] = s.ds.len() + 5,
            "no order" => s.slave.reverse(),
            "shares of no element" => s.report.share.clear(),
            "no report" => s.report = Default::default(),
            _ => {}
        }
        Ok(s)
    }
}

/// Faults of rules, and whether the library must refuse them in a tie and in contact.
const RULES: [(&str, bool, bool); 14] = [
    ("a slave element that does not exist", true, true),
    ("a master element that does not exist", true, true),
    ("other master elements", true, true),
    ("partners at the other end", true, true),
    ("nothing, said to be covered", true, true),
    // contact on half of a side is contact
    ("half of the pieces, said to be all", true, false),
    ("every piece twice", true, true),
    ("a weight that is no number", true, true),
    ("a negative weight", true, true),
    ("a start too few", true, true),
    ("a point too few", true, true),
    ("falling starts", true, true),
    ("no order", true, true),
    // the library measures itself
    ("no report", false, false),
];

#[test]
fn the_checker_of_rules_refuses_every_fault() {
    let body = |low: f64, elements| Kind::Spline.rectangle([0.0, low], [1.0, low + 1.0], 2, elements);
    let sides = [body(0.0, [6, 2]).trace("v1").unwrap(), body(1.0, [5, 2]).trace("v0").unwrap()];
    let own = [gauss_rules(&*sides[0].space, 0), gauss_rules(&*sides[1].space, 0)];
    let checked = |fault| {
        let rule = FaultyRule { inner: MergedCurve { points: 4, partners: Partners::Touching(Tolerance::Exact) }, fault };
        check::interface_quadrature(&rule, &*sides[0].space, &*sides[1].space, [&own[0], &own[1]], SegmentLimits::default())
    };
    checked("none").unwrap();
    for fault in RULES.iter().map(|r| r.0).chain(["shares of no element"]) {
        assert!(checked(fault).is_err(), "{fault}");
    }
}

/// A block on another one, both of width 2, tied or pressed by a load of 1.
struct Blocks {
    problem: Problem<1, 2>,
    upper: BodyId,
}

/// The blocks with a rule of integration that has this fault; `None`: with that of the library.
fn blocks(pressed: bool, rule: Option<&'static str>) -> Blocks {
    let mut p = Problem::<1, 2>::new();
    let mut body = |name: &str, low: f64, elements: [usize; 2]| {
        let net = rectangle([0.0, low], [2.0, low + 1.0]).unwrap();
        let body = Patch::try_new(&PatchSpec::new(net).with_elements(elements)).unwrap();
        p.body(name, body, Hooke::plane_strain(1.0, 0.3).unwrap()).unwrap()
    };
    let (lower, upper) = (body("lower", 0.0, [5, 2]), body("upper", 1.0, [4, 2]));
    p.fix(lower.side("v0"), Components::All).unwrap();
    if pressed {
        p.fix(upper.side("u0"), Components::X).unwrap();
        p.traction(upper.side("v1"), 1, -1.0).unwrap();
        let contact = p.contact(upper.side("v0"), lower.side("v1")).unwrap();
        if let Some(fault) = rule {
            contact.rule(Rule::of(move |points, partners| Box::new(FaultyRule { inner: MergedCurve { points, partners }, fault })));
        }
    } else {
        p.traction(upper.side("v1"), 1, 1.0).unwrap();
        let tie = p.tie(upper.side("v0"), lower.side("v1")).unwrap();
        if let Some(fault) = rule {
            tie.rule(Rule::of(move |points, partners| Box::new(FaultyRule { inner: MergedCurve { points, partners }, fault })));
        }
    }
    Blocks { problem: p, upper }
}

impl Blocks {
    fn displacement(&self, solver: impl ConstraintSolver + 'static) -> Result<f64, StepError> {
        let solution = self.problem.assemble().unwrap().with_solver(solver).solve(1.0, None).map_err(|e| e.error)?;
        Ok(solution.at(self.upper, &[1.3, 2.0]).unwrap().u[1])
    }
}

#[test]
fn the_library_refuses_faulty_rules_and_measures_what_they_cover() {
    for pressed in [false, true] {
        let right = blocks(pressed, None).displacement(Direct::new()).unwrap();
        let same = blocks(pressed, Some("none")).displacement(Direct::new()).unwrap();
        assert_eq!(right, same);
        for (fault, tied, in_contact) in RULES {
            let blocks = blocks(pressed, Some(fault));
            let refused = match blocks.problem.assemble() {
                Ok(_) => false,
                Err(errors) => {
                    assert!(matches!(errors.0[..], [ProblemError { kind: ErrorKind::Interface { .. }, .. }]), "{fault}: {errors}");
                    true
                }
            };
            assert_eq!(refused, if pressed { in_contact } else { tied }, "{fault}, pressed {pressed}");
            if fault == "no report" {
                let measured = blocks.displacement(Direct::new()).unwrap();
                assert!((measured - right).abs() < 1e-13, "{measured} and {right}");
            }
        }
    }
}

/// A solver whose answers are spoiled.
#[derive(Debug)]
struct Spoiled<C> {
    inner: C,
    spoil: fn(&mut ConstrainedSolution),
    tolerance: f64,
}

impl<C: ConstraintSolver> ConstraintSolver for Spoiled<C> {
    fn abilities(&self) -> Abilities {
        self.inner.abilities()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        let mut solution = self.inner.solve(system)?;
        (self.spoil)(&mut solution);
        Ok(solution)
    }
    fn tolerance(&self) -> f64 {
        self.tolerance
    }
}

const SPOILS: [(&str, fn(&mut ConstrainedSolution)); 13] = [
    ("no unknowns", |s| s.unknowns.clear()),
    ("an unknown too few", |s| s.unknowns.truncate(s.unknowns.len().saturating_sub(1))),
    ("an unknown too many", |s| s.unknowns.push(0.0)),
    ("a multiplier too few", |s| s.multipliers.truncate(s.multipliers.len().saturating_sub(1))),
    ("no gaps", |s| s.gap.clear()),
    ("no states", |s| s.active.clear()),
    ("zero", |s| {
        s.unknowns.fill(0.0);
        s.multipliers.fill(0.0);
        s.residual = 0.0;
    }),
    ("zero, residual one", |s| {
        s.unknowns.fill(0.0);
        s.multipliers.fill(0.0);
        s.residual = 1.0;
    }),
    ("a thousandth too large", |s| s.unknowns.iter_mut().for_each(|u| *u *= 1.001)),
    ("multipliers a thousandth too large", |s| s.multipliers.iter_mut().for_each(|l| *l *= 1.001)),
    ("one unknown moved", |s| {
        if let Some(u) = s.unknowns.last_mut() {
            *u += 1e-4;
        }
    }),
    ("not a number", |s| s.unknowns.iter_mut().for_each(|u| *u = f64::NAN)),
    ("other signs", |s| s.multipliers.iter_mut().for_each(|l| *l = -*l)),
];

#[test]
fn wrong_answers_of_solvers_are_refused() {
    for (what, spoil) in SPOILS {
        assert!(check::solver(|| Box::new(Spoiled { inner: Direct::new(), spoil, tolerance: 1e-10 })).is_err(), "{what}");
        for pressed in [false, true] {
            let one = blocks(pressed, None);
            let refused = |found: Result<f64, StepError>, how: &str| match found {
                Err(StepError::Solve(
                    SolveError::Shape { .. }
                    | SolveError::Residual { .. }
                    | SolveError::Conditions { .. }
                    | SolveError::Linear(LinearError::NotFinite),
                )) => {}
                // the active set may not settle on wrong multipliers
                Err(StepError::Solve(_)) if pressed && how == "within an active set" => {}
                other => panic!("{what}, pressed {pressed}, {how}: {other:?}"),
            };
            refused(one.displacement(Spoiled { inner: Direct::new(), spoil, tolerance: 1e-10 }), "within an active set");
            refused(one.displacement(Spoiled { inner: ActiveSet::new(Direct::new()), spoil, tolerance: 1e-10 }), "deciding contact itself");
        }
    }
}

/// Answers with all contact rows open, or all closed.
#[derive(Debug)]
struct Careless(bool);

impl ConstraintSolver for Careless {
    fn abilities(&self) -> Abilities {
        Abilities { contact: true, ..Direct::new().abilities() }
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        Direct::new().solve_set(system, &vec![self.0; system.kind.len()], false)
    }
}

#[test]
fn answers_that_break_the_conditions_of_contact_are_refused() {
    // pulled off a floor near its fixed end and pressed on it beyond: neither all open nor all closed
    let mut p = Problem::<1, 2>::new();
    let net = rectangle([0.0, 0.0], [4.0, 1.0]).unwrap();
    let body = Patch::try_new(&PatchSpec::new(net).with_elements([12, 2])).unwrap();
    let block = p.body("block", body, Hooke::plane_strain(1.0, 0.3).unwrap()).unwrap();
    p.fix(block.side("u0"), Components::All).unwrap();
    p.traction(block.side("v1"), 1, faying::problem::Data::of(|x, _| if x[0] < 2.0 { 1e-2 } else { -1e-2 })).unwrap();
    let floor = faying::contact::HalfPlane::try_new(Vector::from([0.0, 0.0]), Vector::from([0.0, 1.0])).unwrap();
    p.contact(block.side("v0"), floor).unwrap();
    let solved = |solver: Box<dyn ConstraintSolver>| {
        let solution = p.assemble().unwrap().with_solver(solver).solve(1.0, None).map_err(|e| e.error)?;
        Ok::<f64, StepError>(solution.at(block, &[3.0, 1.0]).unwrap().u[1])
    };
    let right = solved(Box::new(Direct::new())).unwrap();
    let itself = solved(Box::new(ActiveSet::new(Direct::new()))).unwrap();
    assert!((right - itself).abs() < 1e-12 * right.abs());
    for closed in [false, true] {
        match solved(Box::new(Careless(closed))) {
            Err(StepError::Solve(SolveError::Conditions { row, multiplier, gap })) => {
                assert!(if closed { multiplier > 0.0 } else { gap < 0.0 }, "row {row}: {multiplier} at {gap}");
            }
            other => panic!("closed {closed}: {other:?}"),
        }
    }
}

#[test]
fn a_solver_that_promises_less_is_taken_at_its_word_and_reported_with_its_true_residual() {
    let spoil: fn(&mut ConstrainedSolution) = |s| {
        s.unknowns.iter_mut().for_each(|u| *u *= 1.0 + 1e-7);
        s.residual = 0.0;
    };
    let one = blocks(false, None);
    let right = one.displacement(Direct::new()).unwrap();
    assert!(matches!(
        one.displacement(Spoiled { inner: Direct::new(), spoil, tolerance: 1e-10 }),
        Err(StepError::Solve(SolveError::Residual { .. }))
    ));
    let loose = Spoiled { inner: Direct::new(), spoil, tolerance: 1e-5 };
    let solution = one.problem.assemble().unwrap().with_solver(loose).solve(1.0, None).unwrap();
    let found = solution.at(one.upper, &[1.3, 2.0]).unwrap().u[1];
    assert!((found - right).abs() < 1e-6 * right.abs());
    assert!(solution.linear().residual > 1e-9, "{:e}", solution.linear().residual);
}

/// Mortar rows that are changed.
#[derive(Debug)]
struct Changed(fn(usize, f64, usize) -> f64);

impl Coupling<1, 2> for Changed {
    fn assemble(&self, interface: &Interface<'_, 1, 2>, unknowns: usize) -> Result<CouplingBlocks, CouplingError> {
        let mut blocks = Mortar.assemble(interface, unknowns)?;
        for part in [&mut blocks.constraint.slave, &mut blocks.constraint.master] {
            part.entries.iter_mut().for_each(|(i, j, v)| *v = (self.0)(*i, *v, *j));
        }
        Ok(blocks)
    }
}

/// Mortar rows with the weight 1 + x (x + 0.3)² under the integral.
#[derive(Debug)]
struct Weighted;

impl Coupling<1, 2> for Weighted {
    fn assemble(&self, interface: &Interface<'_, 1, 2>, unknowns: usize) -> Result<CouplingBlocks, CouplingError> {
        let mut segments = interface.segments.clone();
        let mut map = faying::geometry::MapTable::new();
        for piece in 0..segments.num_pieces() {
            let points = segments.points(piece);
            interface.slave.trace.space.map(segments.slave[piece], &segments.slave_xi[points.clone()], Order::Values, &mut map);
            for (k, q) in points.enumerate() {
                segments.ds[q] *= 1.0 + map.x[k][0] * (map.x[k][0] + 0.3).powi(2);
            }
        }
        Mortar.assemble(&Interface { segments: &segments, ..*interface }, unknowns)
    }
}

#[test]
fn the_checker_of_couplings_takes_weights_and_refuses_rows_without_them() {
    let body = |low: f64, elements| Kind::Spline.rectangle([0.0, low], [1.0, low + 1.0], 2, elements);
    let bodies = [body(0.0, [6, 2]), body(1.0, [5, 2])];
    let sides = [bodies[0].trace("v1").unwrap(), bodies[1].trace("v0").unwrap()];
    let psi = build(&sides[0].space, MultiplierKind::Lowered(0), &[]).unwrap();
    let segments = MergedCurve::tied(4, Tolerance::Exact).segments(&*sides[0].space, &*sides[1].space).unwrap();
    let count = |k: usize| 2 * bodies[k].space().num_functions();
    let side = |k: usize| Side { trace: &sides[k], field: Field { first: k * count(0), components: 2 }, flux: None };
    let multiplier: [&dyn Basis<1>; 1] = [&*psi];
    let interface = Interface {
        slave: side(0),
        master: Some(side(1)),
        multiplier: &multiplier,
        segments: &segments,
        master_segments: None,
        direction: None,
    };
    let checked = |coupling: &dyn Coupling<1, 2>| check::coupling(coupling, &interface, count(0) + count(1));
    checked(&Mortar).unwrap();
    checked(&Weighted).unwrap();
    checked(&Changed(|_, v, _| 3.0 * v)).unwrap();
    for (what, change) in [
        ("negative rows", (|_, v, _| -v) as fn(usize, f64, usize) -> f64),
        ("no rows of one function of the multiplier", |i, v, _| if i == 0 { 0.0 * v } else { v }),
        ("one component half as much", |i, v, _| if i >= 8 { 0.5 * v } else { v }),
        ("nothing", |_, v, _| 0.0 * v),
        ("slave and master apart", |_, v, _| if v < 0.0 { 1.01 * v } else { v }),
    ] {
        assert!(checked(&Changed(change)).is_err(), "{what}");
    }
}
