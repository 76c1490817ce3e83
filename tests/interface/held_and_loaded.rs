//! Problems are refused that prescribe a component twice, load what is held, or have data without a value at some time.

use faying::basis::BSpline;
use faying::contact::HalfPlane;
use faying::geometry::ControlNet;
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{BodyId, Components, Data, ErrorKind, InterfaceError, Problem, Statement, Unknown};
use faying::space::{Mesh, Patch, PatchSpec};

type Say = fn(&mut Problem<1, 2>, BodyId) -> Vec<Statement>;

/// A square of 4 x 4 elements on both backends, with what `say` says of it.
fn errors(say: Say) -> Vec<(Vec<ErrorKind>, Vec<Statement>, Vec<Statement>)> {
    let spec = || PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0]).unwrap()).with_elements([4, 4]);
    let material = || Hooke::plane_strain(1.0, 0.3).unwrap();
    let of = |mut p: Problem<1, 2>, body: BodyId| {
        let said = say(&mut p, body);
        let errors = p.assemble().err().map_or(Vec::new(), |errors| errors.0);
        let of = errors.first().map_or(Vec::new(), |e| e.of.clone());
        (errors.into_iter().map(|e| e.kind).collect(), of, said)
    };
    let (mut p, mut q) = (Problem::new(), Problem::new());
    let a = p.body("square", Patch::try_new(&spec()).unwrap(), material()).unwrap();
    let b = q.body("square", Mesh::from_patch(&spec()).unwrap(), material()).unwrap();
    vec![of(p, a), of(q, b)]
}

/// The square's left part of the side v1, and its right part.
fn parts(p: &mut Problem<1, 2>, b: BodyId) -> [faying::problem::RegionId; 2] {
    let left = p.part(b.side("v1"), "x < 0.5", &|x| x[0] < 0.5).unwrap().unwrap();
    [left, p.part(b.side("v1"), "x > 0.5", &|x| x[0] > 0.5).unwrap().unwrap()]
}

fn refused(say: Say, expected: &ErrorKind) {
    for (kinds, of, said) in errors(say) {
        assert_eq!(kinds, std::slice::from_ref(expected));
        assert_eq!(of, said);
    }
}

fn accepted(say: Say) {
    for (kinds, ..) in errors(say) {
        assert_eq!(kinds, []);
    }
}

#[test]
fn loads_on_what_is_held_are_refused() {
    let x = ErrorKind::Held { component: 0 };
    refused(
        |p, b| {
            p.fix(b.side("v0"), Components::All).unwrap();
            vec![p.fix_normal(b.side("u0")).unwrap(), p.traction(b.side("u0"), 0, 1.0).unwrap()]
        },
        &x,
    );
    refused(
        |p, b| {
            p.fix(b.side("v0"), Components::All).unwrap();
            p.fix_normal(b.side("u0")).unwrap();
            vec![p.fix_tangential(b.side("u0")).unwrap(), p.pressure(b.side("u0"), 1.0).unwrap()]
        },
        &ErrorKind::Held { component: 1 },
    );
    refused(
        |p, b| {
            p.fix(b.side("v0"), Components::All).unwrap();
            vec![p.fix(b.side("u1"), Components::X).unwrap(), p.spring(b.side("u1"), 0, 2.0).unwrap()]
        },
        &x,
    );
    // tangential: the component that is free may be loaded, zero loads say nothing
    refused(
        |p, b| {
            p.fix(b.side("v0"), Components::All).unwrap();
            vec![p.fix_tangential(b.side("u1")).unwrap(), p.force(b.side("u1"), 1, 1.0).unwrap()]
        },
        &ErrorKind::Held { component: 1 },
    );
    accepted(|p, b| {
        p.fix(b.side("v0"), Components::All).unwrap();
        p.fix_tangential(b.side("u1")).unwrap();
        p.fix_normal(b.side("u0")).unwrap();
        // loads on lists of sides may act on rollers, and vanish there
        p.pressure(b.side("u0"), 1.0).unwrap();
        p.traction(b.side("u0"), 0, Data::of(|x, _| x[0])).unwrap();
        vec![
            p.traction(b.side("u1"), 0, 1.0).unwrap(),
            p.traction(b.side("u0"), 1, 1.0).unwrap(),
            p.traction(b.side("u0"), 0, 0.0).unwrap(),
        ]
    });
}

#[test]
fn parts_of_sides_are_compared_facet_by_facet() {
    refused(
        |p, b| {
            let [left, _] = parts(p, b);
            let again = p.part(b.side("v1"), "x < 0.3", &|x| x[0] < 0.3).unwrap().unwrap();
            p.fix(b.side("v0"), Components::All).unwrap();
            vec![p.fix(left, Components::Y).unwrap(), p.prescribe(again, 1, 0.1).unwrap()]
        },
        &ErrorKind::Twice { component: 1 },
    );
    refused(
        |p, b| {
            let [left, _] = parts(p, b);
            p.fix(b.side("v0"), Components::All).unwrap();
            vec![p.fix(b.side("v1"), Components::Y).unwrap(), p.traction(left, 1, 1.0).unwrap()]
        },
        &ErrorKind::Held { component: 1 },
    );
    // a part is held and the rest, or the whole side, is loaded: the load acts on what is free
    // overlaps that prescribe the same say nothing new
    accepted(|p, b| {
        let [left, _] = parts(p, b);
        vec![p.fix(left, Components::All).unwrap(), p.fix(b.side("v1"), Components::Y).unwrap()]
    });
    accepted(|p, b| {
        let [left, right] = parts(p, b);
        p.fix(left, Components::All).unwrap();
        vec![p.traction(right, 1, 1.0).unwrap(), p.traction(b.side("v1"), 0, 1.0).unwrap()]
    });
}

#[test]
fn springs_without_stiffness_hold_nothing() {
    for (kinds, ..) in errors(|p, b| vec![p.spring(b.side("v0"), 0, 0.0).unwrap(), p.spring(b.side("v0"), 1, 0.0).unwrap()]) {
        assert!(matches!(&kinds[..], [ErrorKind::Motions(motions)] if motions.len() == 1), "{kinds:?}");
    }
    // everywhere on their side, or at one of the times
    let vanish: [Say; 2] = [
        |p, b| {
            let beyond = Data::of(|x, _| (x[0] - 2.0).max(0.0));
            vec![p.spring(b.side("v0"), 0, beyond).unwrap(), p.spring(b.side("v0"), 1, 1.0).unwrap()]
        },
        |p, b| {
            p.times(&[0.0, 1.0, 2.0]);
            let late = Data::of(|_, t| if t > 1.5 { 0.0 } else { 1.0 });
            vec![p.spring(b.side("v0"), 0, late).unwrap(), p.spring(b.side("v0"), 1, 1.0).unwrap()]
        },
    ];
    for say in vanish {
        for (kinds, ..) in errors(say) {
            assert!(matches!(&kinds[..], [ErrorKind::Motions(motions)] if motions[0].ends_with("translation x")), "{kinds:?}");
        }
    }
    accepted(|p, b| vec![p.spring(b.side("v0"), 0, 1.0).unwrap(), p.spring(b.side("v0"), 1, 1.0).unwrap()]);
    accepted(|p, b| {
        let on_the_left = Data::of(|x, _| (0.2 - x[0]).max(0.0));
        vec![p.spring(b.side("v0"), 0, on_the_left).unwrap(), p.spring(b.side("v0"), 1, 1.0).unwrap()]
    });
}

#[test]
fn equations_that_prescribed_values_contradict_are_refused_with_both_statements() {
    let unknown = |body, function, component| Unknown { body, function, component };
    for (value, good) in [(0.0, true), (0.5, false)] {
        let mut p = Problem::<1, 2>::new();
        let square = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0]).unwrap()).with_elements([2, 2]);
        let b = p.body("square", Mesh::from_patch(&square).unwrap(), Hooke::plane_strain(1.0, 0.3).unwrap()).unwrap();
        p.fix(b.side("v1"), Components::All).unwrap();
        let held = p.prescribe(b.side("v0"), 0, 0.5).unwrap();
        // in the lower left corner, whose function is the first
        let equation = p.equation(&[(unknown(b, 0, 0), 1.0), (unknown(b, 0, 1), 1.0)], 0.5 + value).unwrap();
        let bound = p.prescribe(b.side("u0"), 1, 0.0).unwrap();
        let errors = p.assemble().err().map_or(Vec::new(), |e| e.0);
        if good {
            assert!(errors.is_empty(), "{errors:?}");
        } else {
            assert_eq!(errors.len(), 1, "{errors:?}");
            let ErrorKind::Contradiction { defect, t, changes } = errors[0].kind else { panic!("{errors:?}") };
            assert!((defect - 0.5).abs() < 1e-15 && t == 1.0 && !changes, "{errors:?}");
            assert_eq!(errors[0].of, [held, bound, equation]);
        }
    }
}

#[test]
fn data_whose_squares_overflow_are_refused() {
    for (kinds, ..) in errors(|p, b| {
        p.fix(b.side("v0"), Components::All).unwrap();
        vec![p.pressure(b.side("v1"), 1e160).unwrap(), p.prescribe(b.side("u1"), 0, Data::of(|x, _| -1e308 * x[1])).unwrap()]
    }) {
        assert!(matches!(kinds[..], [ErrorKind::TooLarge { .. }, ErrorKind::TooLarge { .. }]), "{kinds:?}");
    }
}

#[test]
fn loads_along_directions_that_are_held_are_refused() {
    let turned = |fix: fn(&mut Problem<1, 2>, BodyId) -> Statement, forces: &[[f64; 2]]| {
        let mut p = Problem::<1, 2>::new();
        let corners = [[0.0, 0.0], [0.8, 0.6], [-0.6, 0.8], [0.2, 1.4]].map(Vector::from).to_vec();
        let line = || BSpline::try_new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
        let spec = PatchSpec::new(ControlNet::try_new([line(), line()], corners, None).unwrap()).with_elements([2, 2]);
        let b = p.body("turned", Patch::try_new(&spec).unwrap(), Hooke::plane_strain(1.0, 0.3).unwrap()).unwrap();
        p.fix(b.side("v1"), Components::All).unwrap();
        let held = fix(&mut p, b);
        for force in forces {
            for (c, f) in force.iter().enumerate() {
                let load = p.traction(b.side("v0"), c, *f).unwrap();
                p.name(load, "load");
            }
        }
        let errors = p.assemble().err().map_or(Vec::new(), |e| e.0);
        assert!(errors.iter().all(|e| e.kind == ErrorKind::HeldAlong && e.of[0] == held), "{errors:?}");
        errors.len()
    };
    let (normal, tangent): (fn(&mut Problem<1, 2>, BodyId) -> Statement, fn(&mut Problem<1, 2>, BodyId) -> Statement) =
        (|p, b| p.fix_normal(b.side("v0")).unwrap(), |p, b| p.fix_tangential(b.side("v0")).unwrap());
    assert_eq!(turned(normal, &[[0.6, -0.8]]), 1);
    assert_eq!(turned(normal, &[[0.8, 0.6]]), 0);
    assert_eq!(turned(normal, &[[0.6, -0.8], [0.8, 0.6]]), 0);
    assert_eq!(turned(normal, &[[0.0, 0.0]]), 0);
    assert_eq!(turned(tangent, &[[0.8, 0.6]]), 1);
    assert_eq!(turned(tangent, &[[0.6, -0.8]]), 0);
}

#[test]
fn every_prescribed_value_without_a_value_is_told() {
    for (kinds, _, said) in errors(|p, b| {
        let nan = |x: &[f64; 3], _: f64| if x[0] > 0.6 { f64::NAN } else { 0.0 };
        p.fix(b.side("u0"), Components::All).unwrap();
        vec![p.prescribe(b.side("v0"), 1, Data::of(nan)).unwrap(), p.prescribe(b.side("v1"), 0, Data::of(|_, _| f64::INFINITY)).unwrap()]
    }) {
        assert!(matches!(kinds[..], [ErrorKind::NotFinite { component: 1, .. }, ErrorKind::NotFinite { component: 0, .. }]), "{kinds:?}");
        assert_eq!(said.len(), 2);
    }
}

#[test]
fn gaps_are_asked_at_all_times() {
    for (kinds, ..) in errors(|p, b| {
        p.times(&[1.0, 2.0]);
        p.fix(b.side("v1"), Components::All).unwrap();
        let floor = HalfPlane::try_new(Vector::from([0.0, 0.0]), Vector::from([0.0, 1.0])).unwrap();
        let late = Data::of_gap(|_, t, g| if t > 1.5 { f64::NAN } else { g });
        p.contact(b.side("v0"), floor).unwrap().gap(late);
        vec![]
    }) {
        assert!(matches!(&kinds[..], [ErrorKind::Interface { error: InterfaceError::Gap { t: 2.0, .. }, .. }]), "{kinds:?}");
    }
}
