//! Answers of solutions: fields at points, results of ties and contacts, and errors with the best state.

use faying::contact::HalfPlane;
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{BodyId, Components, Data, ErrorKind, Problem, Solution, System};
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
    let space = solution.model().patches[0].body.space();
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
        let found = solution.at(body, &state.x.into()).unwrap();
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

#[test]
fn an_unsolved_step_says_its_error_alone_and_carries_the_best_solution() {
    let (mut p, beam) = half_pressed();
    p.active_set(1.0, 1);
    let unsolved = p.assemble().unwrap().solve(1.0, None).unwrap_err();
    let text = format!("{unsolved:?}");
    assert!(text.len() < 400 && text == unsolved.to_string(), "{text}");
    assert_eq!(unsolved.source().map(ToString::to_string), Some(text.clone()));
    let best = unsolved.best.as_ref().unwrap();
    assert!(best.at(beam, &[3.0, 1.0]).unwrap().u[1] != 0.0);
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
