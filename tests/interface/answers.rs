//! Answers of solutions: fields at points, results of ties and contacts, and errors with the best state.

use faying::constraint::{Abilities, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Direct, SolveError};
use faying::contact::HalfPlane;
use faying::coupling::{Coupling, Mortar, Nitsche, Penalty};
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{BodyId, Components, Data, ErrorKind, InterfaceId, Problem, Solution, System, TieId};
use faying::space::{Patch, PatchSpec, locate};
use std::error::Error;

fn steel() -> Hooke<2> {
    Hooke::plane_strain(1.0, 0.3).unwrap()
}

/// A square of n x n bilinear elements, bent by a traction that changes along its top.
fn bent(n: usize) -> (Solution<1, 2>, BodyId) {
    let spec = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0]).unwrap()).with_degree([1, 1]).with_elements([n, n]);
    let mut p = Problem::<1, 2>::new();
    let body = p.body("square", Patch::try_new(&spec).unwrap(), steel()).unwrap();
    p.fix(body.side("v0"), Components::All).unwrap();
    p.traction(body.side("v1"), 0, Data::of(|x, _| 0.1 * x[0])).unwrap();
    (p.assemble().unwrap().solve(1.0, None).unwrap(), body)
}

#[test]
fn many_points_have_the_answers_of_single_points() {
    let (solution, body) = bent(80);
    // of the 1,000 points some are outside
    let points: Vec<[f64; 2]> = (0..1000).map(|k| [(k as f64 * 0.618_034).fract() * 1.05, (k as f64 * 0.414_214).fract()]).collect();
    let many = solution.at_many(body, &points);
    assert_eq!(many.len(), points.len());
    let mut outside = 0;
    for (x, found) in points.iter().zip(&many) {
        let bits =
            |s: &faying::problem::PointState<2>| s.x.iter().chain(&s.u).chain(s.stress.iter()).map(|v| v.to_bits()).collect::<Vec<_>>();
        match (found, solution.at(body, x)) {
            (Ok(a), Ok(b)) => assert_eq!(bits(a), bits(&b), "{x:?}"),
            (Err(a), Err(b)) => {
                assert_eq!(a, &b);
                outside += 1;
            }
            (a, b) => panic!("{a:?}, {b:?}"),
        }
    }
    assert!(outside > 20 && outside < 100, "{outside}");
    // the same as without the tree that is kept
    let space = solution.contents().body(0).space();
    for x in points.iter().take(3) {
        let (element, xi) = locate(&**space, &(*x).into()).unwrap();
        assert_eq!(solution.in_element(body, element, &[xi.into()]).unwrap(), [solution.at(body, x).unwrap()]);
    }
}

#[test]
fn elements_answer_by_number() {
    let (solution, body) = bent(4);
    let states = solution.in_element(body, 5, &[[0.25, 0.5], [0.75, 0.5]]).unwrap();
    assert_eq!(states.len(), 2);
    for state in states {
        let x: faying::nalgebra::SVector<f64, 2> = state.x;
        let found = solution.at(body, &x.into()).unwrap();
        assert!((0..2).all(|c| (state.u[c] - found.u[c]).abs() < 1e-14), "{state:?}, {found:?}");
    }
    assert_eq!(solution.in_element(body, 16, &[[0.5; 2]]).unwrap_err().kind, ErrorKind::NoElement { element: 16, elements: 16 });
    let (_, other) = bent(1);
    assert_eq!(solution.in_element(other, 0, &[]).unwrap_err().kind, ErrorKind::OtherProblem);
    let errors = solution.at_many(other, &[[0.5; 2]; 3]);
    assert!(errors.len() == 3 && errors.iter().all(|e| e.as_ref().is_err_and(|e| e.kind == ErrorKind::OtherProblem)));
}

/// A beam over a floor, pulled off it near its fixed end and pressed on it beyond.
fn half_pressed() -> (Problem<1, 2>, BodyId) {
    let spec = PatchSpec::new(rectangle([0.0, 0.0], [4.0, 1.0]).unwrap()).with_elements([12, 2]);
    let mut p = Problem::<1, 2>::new();
    let beam = p.body("beam", Patch::try_new(&spec).unwrap(), steel()).unwrap();
    p.fix(beam.side("u0"), Components::All).unwrap();
    p.traction(beam.side("v1"), 1, Data::of(|x, _| if x[0] < 2.0 { 1e-2 } else { -1e-2 })).unwrap();
    let floor = HalfPlane::try_new(Vector::from([0.0, 0.0]), Vector::from([0.0, 1.0])).unwrap();
    p.contact(beam.side("v0"), floor).unwrap().named("floor");
    (p, beam)
}

/// A solver that never is content with its answer.
#[derive(Debug)]
struct Never;

impl ConstraintSolver for Never {
    fn abilities(&self) -> Abilities {
        Direct::new().abilities()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        let best = Box::new(Direct::new().solve(system)?);
        Err(SolveError::TooManyIterations { iterations: 7, best })
    }
}

#[test]
fn an_unsolved_step_says_its_error_alone_and_carries_the_best_solution() {
    let (p, tie, lower) = pulled(Mortar);
    let unsolved = p.assemble().unwrap().with_solver(Never).solve(1.0, None).unwrap_err();
    let text = format!("{unsolved:?}");
    assert!(text.len() < 400 && text.contains('7') && text == unsolved.to_string(), "{text}");
    assert_eq!(unsolved.source().map(ToString::to_string), Some(text.clone()));
    let (best, right) = (unsolved.best.as_ref().unwrap(), p.assemble().unwrap().solve(1.0, None).unwrap());
    assert_eq!(best.at(lower, &[1.3, 0.6]).unwrap(), right.at(lower, &[1.3, 0.6]).unwrap());
    assert_eq!(best.tie(tie).unwrap(), right.tie(tie).unwrap());
    let boxed: Box<dyn Error + Send + Sync> = unsolved.into();
    assert_eq!(format!("{boxed:?}"), text);
}

#[test]
fn problems_systems_and_solutions_go_between_threads() {
    fn send<T: Send>() {}
    fn shared<T: Send + Sync + Clone>() {}
    send::<System<1, 2>>();
    send::<System<2, 3>>();
    shared::<Problem<1, 2>>();
    shared::<Problem<2, 3>>();
    shared::<Solution<1, 2>>();
    shared::<Solution<2, 3>>();
    let (p, beam) = half_pressed();
    let here = p.assemble().unwrap().solve(1.0, None).unwrap();
    let mut system = p.clone().assemble().unwrap();
    let there = std::thread::spawn(move || system.solve(1.0, None).unwrap()).join().unwrap();
    assert_eq!(here.coefficients(beam).unwrap(), there.coefficients(beam).unwrap());
}

#[test]
fn a_clone_knows_the_handles_of_its_original_and_no_later_ones() {
    let (mut p, beam) = half_pressed();
    let top = p.region(beam.side("v1")).unwrap();
    let mut copy = p.clone();
    assert_eq!(copy.region(beam.side("v1")).unwrap(), top);
    let square = |p: &mut Problem<1, 2>, name: &str| {
        let spec = PatchSpec::new(rectangle([9.0, 0.0], [10.0, 1.0]).unwrap());
        let body = p.body(name, Patch::try_new(&spec).unwrap(), steel()).unwrap();
        p.fix(body.side("v0"), Components::All).unwrap();
        body
    };
    let (of_original, of_copy) = (square(&mut p, "one"), square(&mut copy, "other"));
    assert_ne!(of_original, of_copy);
    let refused = |p: &mut Problem<1, 2>, body: BodyId| p.fix(body.side("u0"), Components::X).unwrap_err().kind;
    assert_eq!(refused(&mut copy, of_original), ErrorKind::OtherProblem);
    assert_eq!(refused(&mut p, of_copy), ErrorKind::OtherProblem);
    let later = p.region(of_original.side("v1")).unwrap();
    assert_eq!(copy.pressure(later, 1.0).unwrap_err().kind, ErrorKind::OtherProblem);
    // the copy is loaded twice as much at its top, its original as before
    copy.pressure(top, 1e-2).unwrap();
    let [one, two] = [p, copy].map(|p| p.assemble().unwrap().solve(1.0, None).unwrap());
    assert!(two.at(of_copy, &[9.5, 0.5]).is_ok() && two.at(of_original, &[9.5, 0.5]).is_err());
    assert!(one.at(beam, &[4.0, 1.0]).unwrap().u[1] > two.at(beam, &[4.0, 1.0]).unwrap().u[1]);
}

/// Two squares, the upper one pulled upwards by 2 and to the right by 0.6.
fn pulled(coupling: impl Coupling<1, 2> + 'static) -> (Problem<1, 2>, TieId, BodyId) {
    let block = |p: &mut Problem<1, 2>, name: &str, low: f64, n: usize| {
        let spec = PatchSpec::new(rectangle([0.0, low], [2.0, low + 1.0]).unwrap()).with_elements([n, 2]);
        p.body(name, Patch::try_new(&spec).unwrap(), steel()).unwrap()
    };
    let mut p = Problem::<1, 2>::new();
    let (lower, upper) = (block(&mut p, "lower", 0.0, 3), block(&mut p, "upper", 1.0, 4));
    p.fix(lower.side("v0"), Components::All).unwrap();
    p.traction(upper.side("v1"), 1, 1.0).unwrap();
    p.traction(upper.side("u1"), 0, 0.6).unwrap();
    let tie = p.tie(upper.side("v0"), lower.side("v1")).unwrap().coupling(coupling).id();
    (p, tie, lower)
}

#[test]
fn a_tie_answers_with_force_and_jump_by_every_coupling() {
    let check = |(p, tie, lower): (Problem<1, 2>, TieId, BodyId), rows: bool, soft: bool| {
        let solution = p.assemble().unwrap().solve(1.0, None).unwrap();
        let (result, support) = (solution.tie(tie).unwrap(), solution.reaction(lower.side("v0")).unwrap());
        // the supports hold what the tie holds; about the origin the load turns by 2 x 1 - 0.6 x 1.5
        for (c, load) in [0.6, 2.0].into_iter().enumerate() {
            assert!((support[c] + load).abs() < 1e-10 && (result.force[c] + load).abs() < 1e-10, "{result:?}, {support:?}");
        }
        assert!((result.moment[2] + 2.0 - 0.9).abs() < 1e-10 && result.moment[..2] == [0.0; 2], "{result:?}");
        assert!((result.area - 2.0).abs() < 1e-12 && result.distance < 1e-12, "{result:?}");
        assert!(result.multiplier > 2.0_f64.sqrt() && result.jump <= result.largest_jump * 2.0_f64.sqrt(), "{result:?}");
        assert!(result.largest_jump > 0.0 && (result.largest_jump < 0.5) && (!soft || result.largest_jump > 1e-3), "{result:?}");
        assert_eq!(!solution.multiplier(tie).unwrap().is_empty(), rows);
    };
    check(pulled(Mortar), true, false);
    check(pulled(Penalty { factor: 10.0 }), true, true);
    check(pulled(Nitsche::default()), false, false);
}

#[test]
fn ties_and_contacts_of_other_problems_are_refused() {
    let (mut p, tie, lower) = pulled(Mortar);
    let solution = p.assemble().unwrap().solve(1.0, None).unwrap();
    let (mut other, _) = half_pressed();
    let floor = other.contact(lower.side("u0"), HalfPlane::try_new(Vector::from([0.0, 0.0]), Vector::from([0.0, 1.0])).unwrap());
    assert_eq!(floor.unwrap_err().kind, ErrorKind::OtherProblem);
    let pressed = other.assemble().unwrap().solve(1.0, None).unwrap();
    let InterfaceId::Contact(contact) = pressed.contents().contacts().next().unwrap().id() else { unreachable!() };
    assert!(pressed.contact(contact).unwrap().force[1] > 0.0 && !pressed.multiplier(contact).unwrap().is_empty());
    assert_eq!(pressed.tie(tie).unwrap_err().kind, ErrorKind::OtherProblem);
    assert_eq!(pressed.multiplier(tie).unwrap_err().kind, ErrorKind::OtherProblem);
    assert_eq!(solution.contact(contact).unwrap_err().kind, ErrorKind::OtherProblem);
    // one that was said after the system
    let plane = HalfPlane::try_new(Vector::from([0.0, 0.0]), Vector::from([1.0, 0.0])).unwrap();
    let later = p.contact(lower.side("u0"), plane).unwrap().id();
    assert_eq!(solution.contact(later).unwrap_err().kind, ErrorKind::OtherProblem);
    let InterfaceId::Contact(same) = later.into() else { panic!("a contact") };
    assert_eq!(same, later);
}
