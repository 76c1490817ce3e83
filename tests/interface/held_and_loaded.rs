//! Problems are refused that prescribe a component twice, load what is held, or have data without a value at some time.

use faying::contact::{ContactError, HalfPlane};
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{BodyId, Components, Data, ErrorKind, InterfaceError, Problem, Statement};
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
    accepted(|p, b| vec![p.spring(b.side("v0"), 0, 1.0).unwrap(), p.spring(b.side("v0"), 1, 1.0).unwrap()]);
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
        assert!(matches!(&kinds[..], [ErrorKind::Interface { error: InterfaceError::Contact(ContactError::Gap { .. }), .. }]), "{kinds:?}");
    }
}
