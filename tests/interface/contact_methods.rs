//! Methods of contact: the rules that all keep, faults that the rules find, what they refuse, and a contact solved by hand.

#[path = "../../examples/05_own_contact_method.rs"]
mod own_contact_method;

use faying::check::contact_method;
use faying::constraint::{ActiveSet, ConstraintSolver, Direct, RowIteration};
use faying::contact::{Augmented, Begun, ContactAt, ContactError, ContactMethod, ContactRows, HalfPlane, Lagrange, Needs, PointValues};
use faying::coupling::nitsche::Variant;
use faying::coupling::{Nitsche, Penalty};
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{Components, ErrorKind, Integration, InterfaceError, Problem, StepError};
use faying::space::{Mesh, Patch, PatchSpec};
use own_contact_method::{InteriorPoint, pressed};
use std::sync::Arc;

#[test]
fn the_methods_of_the_library_and_one_from_outside_keep_the_rules() {
    let nitsche = |variant| Arc::new(Nitsche { variant, ..Nitsche::default() });
    let methods: [Arc<dyn ContactMethod<1, 2>>; 7] = [
        Arc::new(Lagrange),
        Arc::new(Penalty::default()),
        Arc::new(Augmented::default()),
        nitsche(Variant::Symmetric),
        nitsche(Variant::Unsymmetric),
        nitsche(Variant::Incomplete),
        Arc::new(InteriorPoint),
    ];
    for method in methods {
        contact_method(method.clone()).unwrap_or_else(|e| panic!("{method:?}: {e}"));
    }
}

/// A fault of a method of multiplier functions.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Faulty {
    HeavyRow,
    PullsTogether,
    HalfOffset,
    HalfWeights,
    ShortCompliance,
    Soft,
    NothingSaid,
    TooFewRows,
    NoMultiplier,
    NoOffset,
    NoWeight,
    NoCompliance,
}

impl ContactMethod<1, 2> for Faulty {
    fn needs(&self) -> Needs {
        if *self == Self::NoMultiplier { Needs::POINTS } else { Needs::FUNCTIONS }
    }

    fn rows(&self, at: &ContactAt<'_, 1, 2>) -> Result<ContactRows<1, 2>, ContactError> {
        let mut rows = at.rows_of_functions()?;
        let entries = |rows: &mut ContactRows<1, 2>| rows.rows.slave.entries.iter_mut().filter(|e| e.0 == 1).for_each(|e| e.2 *= 2.0);
        match self {
            Self::HeavyRow => entries(&mut rows),
            Self::PullsTogether => {
                let mut reaction = rows.rows.clone();
                reaction.slave.entries.iter_mut().for_each(|e| e.2 *= 0.5);
                rows.reaction = Some(reaction);
            }
            Self::HalfOffset => rows.offset.iter_mut().for_each(|g| *g *= 0.5),
            Self::HalfWeights => {
                for e in rows.rows.slave.entries.iter_mut().chain(&mut rows.rows.master.entries) {
                    e.2 *= 0.5;
                }
                rows.weights.iter_mut().chain(&mut rows.offset).for_each(|w| *w *= 0.5);
            }
            Self::TooFewRows => {
                rows.offset.pop();
            }
            Self::NoOffset => rows.offset[1] = f64::NAN,
            Self::NoWeight => rows.weights[1] = f64::NAN,
            _ => {}
        }
        Ok(rows)
    }

    fn begin(&self, rows: &ContactRows<1, 2>, unit: &dyn Fn(usize) -> f64) -> Begun {
        let compliance = match self {
            Self::ShortCompliance => vec![0.0; rows.offset.len() - 1],
            Self::Soft => (0..rows.offset.len()).map(unit).collect(),
            Self::NoCompliance => vec![f64::NAN; rows.offset.len()],
            _ => Vec::new(),
        };
        let iteration = (*self == Self::NothingSaid).then(|| Box::new(Open) as Box<dyn RowIteration>);
        Begun { compliance, iteration, ..Begun::default() }
    }
}

/// An iteration that opens all rows and is content.
#[derive(Debug)]
struct Open;

impl RowIteration for Open {
    fn name(&self) -> &'static str {
        "open"
    }
    fn tolerance(&self) -> f64 {
        1e-12
    }
    fn row(&self, _: usize) -> faying::constraint::RowChange {
        faying::constraint::RowChange { kind: Some(faying::constraint::RowKind::Open), ..Default::default() }
    }
    fn next(&mut self, _: &faying::constraint::Answered<'_>) -> faying::constraint::Next {
        faying::constraint::Next::Done
    }
}

#[test]
fn faults_of_a_method_are_found_and_named() {
    for (fault, part) in [
        (Faulty::HeavyRow, "row 1 of C"),
        (Faulty::PullsTogether, "of B"),
        (Faulty::HalfOffset, "the offset is"),
        (Faulty::HalfWeights, "the weights add up to"),
        (Faulty::ShortCompliance, "compliances of"),
        (Faulty::Soft, "the patch test has the"),
        (Faulty::NothingSaid, "the patch test"),
        (Faulty::TooFewRows, "multiplier functions"),
        (Faulty::NoMultiplier, "there is no multiplier"),
        (Faulty::NoOffset, "the offset NaN of row 1"),
        (Faulty::NoWeight, "the weight NaN of row 1"),
        (Faulty::NoCompliance, "row 0 has the compliance NaN"),
    ] {
        let error = contact_method(Arc::new(fault)).expect_err("a fault");
        assert!(error.contains(part), "{fault:?}: {error}");
    }
}

/// A block above a half-plane that may be pressed on it.
fn pressed_plane(method: impl ContactMethod<1, 2> + 'static, force: bool) -> Problem<1, 2> {
    let mut p = Problem::<1, 2>::new();
    let block = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0]).unwrap()).with_elements([4, 3]);
    let block = p.body("block", Patch::try_new(&block).unwrap(), Hooke::plane_strain(1.0, 0.3).unwrap()).unwrap();
    p.fix(block.side("v1"), Components::All).unwrap();
    let plane = HalfPlane::try_new(Vector::from([0.0, 0.0]), Vector::from([0.0, 1.0])).unwrap();
    let contact = p.contact(block.side("v0"), plane).unwrap().method(method);
    if force {
        contact.pressed(1, 1e-3);
    } else {
        contact.moved(1, 1e-3).rule(Integration::Mixed);
    }
    p
}

#[test]
fn a_method_refuses_what_it_does_not_accept() {
    for (force, expected) in
        [(true, InterfaceError::Refused { pressed: true, mixed: false }), (false, InterfaceError::Refused { pressed: false, mixed: true })]
    {
        let error = pressed_plane(Nitsche::default(), force).assemble().expect_err("refused").0.remove(0);
        assert_eq!(error.kind, ErrorKind::Interface { slave: 0, error: expected });
        pressed_plane(Lagrange, force).assemble().unwrap();
    }
}

#[test]
fn two_augmented_contacts_are_judged_each_by_itself() {
    let lagrange = || Arc::new(Lagrange) as Arc<dyn ContactMethod<1, 2>>;
    let (exact, of_exact) = pressed([lagrange(), lagrange()]).unwrap();
    for [a, b] in [[1e2, 1e4], [1e4, 1e4]] {
        let augmented = |factor| Arc::new(Augmented { factor, ..Augmented::default() }) as Arc<dyn ContactMethod<1, 2>>;
        let (own, of_own) = pressed([augmented(a), augmented(b)]).unwrap();
        for k in 0..2 {
            let (found, right) = (own.contact(of_own[k]).unwrap(), exact.contact(of_exact[k]).unwrap());
            assert!((found.largest_pressure - right.largest_pressure).abs() < 1e-10 * right.largest_pressure, "{found:?} {right:?}");
        }
    }
}

/// A NURBS block on a mesh of other cells, pressed on half of its top.
fn problem() -> (Problem<1, 2>, faying::problem::ContactId, faying::problem::BodyId) {
    let mut p = Problem::<1, 2>::new();
    let steel = || Hooke::plane_strain(1.0, 0.3).unwrap();
    let lower = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 0.5]).unwrap()).with_elements([7, 3]);
    let upper = PatchSpec::new(rectangle([0.0, 0.5], [1.0, 1.0]).unwrap()).with_elements([9, 4]);
    let lower = p.body("lower", Mesh::from_patch(&lower).unwrap(), steel()).unwrap();
    let upper = p.body("upper", Patch::try_new(&upper).unwrap(), steel()).unwrap();
    p.fix(lower.side("v0"), Components::All).unwrap();
    p.fix(upper.side("u0"), Components::X).unwrap();
    p.traction(upper.side("v1"), 1, faying::problem::Data::of(|x, t| -1e-3 * t * (1.0 - 1.3 * x[0]))).unwrap();
    let contact = p.contact(upper.side("v0"), lower.side("v1")).unwrap().id();
    (p, contact, upper)
}

#[test]
fn a_contact_is_solved_by_hand_from_its_linearised_system() {
    let (p, contact, upper) = problem();
    let mut system = p.assemble().unwrap();
    let linearised = system.linearise(1.0, None).unwrap();
    let mut solver = ActiveSet::new(Direct::new()).starting_from(linearised.start().to_vec());
    let answer = solver.solve(&linearised.constrained()).unwrap();
    let by_hand = system.accept(&linearised, answer).unwrap();
    let own = system.solve(1.0, None).unwrap();
    let (a, b) = (by_hand.contact(contact).unwrap(), own.contact(contact).unwrap());
    assert_eq!((a.active, linearised.unknowns(), linearised.time()), (b.active, own.linear().free, 1.0));
    assert!((a.force[1] - b.force[1]).abs() < 1e-15 && (a.largest_pressure - b.largest_pressure).abs() < 1e-12);
    let (a, b) = (by_hand.at(upper, &[0.3, 0.8]).unwrap(), own.at(upper, &[0.3, 0.8]).unwrap());
    assert!((a.u[1] - b.u[1]).abs() < 1e-13);
}

#[test]
fn answers_that_do_not_solve_a_linearised_system_are_refused() {
    let (p, ..) = problem();
    let (mut system, mut other) = (p.assemble().unwrap(), p.assemble().unwrap());
    let linearised = system.linearise(1.0, None).unwrap();
    let answer = ActiveSet::new(Direct::new()).solve(&linearised.constrained()).unwrap();
    let refused = other.accept(&linearised, answer.clone()).expect_err("another system");
    assert_eq!(refused.error, StepError::OtherSystem);
    let spoiled = |change: &dyn Fn(&mut faying::constraint::ConstrainedSolution)| {
        let mut wrong = answer.clone();
        change(&mut wrong);
        wrong
    };
    for wrong in [
        spoiled(&|s| s.unknowns[5] += 1e-4),
        spoiled(&|s| s.multipliers[2] *= 1.01),
        spoiled(&|s| s.unknowns.clear()),
        spoiled(&|s| s.multipliers.push(0.0)),
        spoiled(&|s| s.unknowns[0] = f64::NAN),
    ] {
        let error = system.accept(&linearised, wrong).expect_err("no solution").error;
        assert!(matches!(error, StepError::Solve(_)), "{error}");
    }
    system.accept(&linearised, answer).unwrap();
}

#[test]
fn the_strictest_of_several_iterations_counts_for_all() {
    let lagrange = || Arc::new(Lagrange) as Arc<dyn ContactMethod<1, 2>>;
    let (exact, of_exact) = pressed([lagrange(), lagrange()]).unwrap();
    let augmented = |factor, tolerance| Arc::new(Augmented { factor, tolerance }) as Arc<dyn ContactMethod<1, 2>>;
    let (own, of_own) = pressed([augmented(1e3, 1e-12), augmented(10.0, 0.5)]).unwrap();
    for k in 0..2 {
        let (found, right) = (own.contact(of_own[k]).unwrap(), exact.contact(of_exact[k]).unwrap());
        assert!((found.largest_pressure - right.largest_pressure).abs() < 1e-10 * right.largest_pressure, "{found:?} {right:?}");
    }
}

#[test]
fn a_method_with_too_few_compliances_is_an_error_of_the_step() {
    let error = pressed([Arc::new(Lagrange), Arc::new(Faulty::ShortCompliance)]).expect_err("a fault").to_string();
    assert!(error.contains("compliances of"), "{error}");
}

#[test]
fn rows_of_a_method_that_are_no_numbers_are_errors() {
    for fault in [Faulty::NoOffset, Faulty::NoWeight, Faulty::NoCompliance] {
        let error = pressed([Arc::new(Lagrange), Arc::new(fault)]).expect_err("a fault").to_string();
        assert!(error.contains("NaN") || error.contains("not finite"), "{fault:?}: {error}");
    }
}

/// A fault of the values at points of a method without multiplier, which is else Nitsche's.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FaultyValues {
    ShortLambda,
    LongGap,
    NoSuchPoint,
    NoNumber,
}

impl ContactMethod<1, 2> for FaultyValues {
    fn needs(&self) -> Needs {
        Needs::FLUXES
    }

    fn rows(&self, at: &ContactAt<'_, 1, 2>) -> Result<ContactRows<1, 2>, ContactError> {
        ContactMethod::rows(&Nitsche::default(), at)
    }

    fn begin(&self, rows: &ContactRows<1, 2>, unit: &dyn Fn(usize) -> f64) -> Begun {
        Nitsche::default().begin(rows, unit)
    }

    fn values(&self, at: &ContactAt<'_, 1, 2>, unknowns: &[f64]) -> Option<Result<PointValues, ContactError>> {
        let spoiled = |mut values: PointValues| {
            match self {
                Self::ShortLambda => drop(values.lambda.pop()),
                Self::LongGap => values.gap.push(0.0),
                Self::NoSuchPoint => values.point[0] = at.segments.ds.len(),
                Self::NoNumber => values.lambda[0] = f64::NAN,
            }
            values
        };
        Nitsche::default().values(at, unknowns).map(|values| values.map(spoiled))
    }
}

#[test]
fn values_at_points_that_do_not_fit_together_are_no_numbers() {
    let nitsche = || Arc::new(Nitsche::default()) as Arc<dyn ContactMethod<1, 2>>;
    let (right, of_right) = pressed([nitsche(), nitsche()]).unwrap();
    let xi = [0.2, 0.7].map(|xi| Vector::from([xi]));
    for (fault, part) in [
        (FaultyValues::ShortLambda, "numbers of lambda"),
        (FaultyValues::LongGap, "gaps"),
        (FaultyValues::NoSuchPoint, "at point"),
        (FaultyValues::NoNumber, "the lambda at a point NaN"),
    ] {
        let error = contact_method(Arc::new(fault)).expect_err("a fault");
        assert!(error.contains(part), "{fault:?}: {error}");
        // the rows are sound: all but values between their points is right
        let (own, of_own) = pressed([Arc::new(fault), Arc::new(fault)]).unwrap();
        for k in 0..2 {
            assert_eq!(own.contact(of_own[k]).unwrap().force, right.contact(of_right[k]).unwrap().force);
            let lambda = own.lambda(of_own[k], 0).unwrap().unwrap().at(1, &xi).concat();
            let none: Vec<bool> = lambda.iter().map(|l| l.is_nan()).collect();
            assert_eq!(none, [true, fault != FaultyValues::NoNumber], "{fault:?}: {lambda:?}");
        }
    }
}
