//! Problems that are refused, and statements that the lessons of `examples` do not show.

/// The only error of a problem.
fn refused(p: &faying::problem::Problem<1, 2>) -> faying::problem::ProblemError {
    let mut errors = p.assemble().expect_err("an error").0;
    assert_eq!(errors.len(), 1, "{errors:?}");
    errors.remove(0)
}

/// A square on [0, 1] x [low, low + 1] in a problem of its own.
fn square(p: &mut faying::problem::Problem<1, 2>, name: &str, low: f64) -> faying::problem::BodyId {
    let spec = faying::space::PatchSpec::new(faying::geometry::shapes::rectangle([0.0, low], [1.0, low + 1.0]).unwrap());
    let body = faying::space::Patch::try_new(&spec.with_elements([2, 2])).unwrap();
    p.body(name, body, faying::physics::Hooke::plane_strain(1.0, 0.3).unwrap()).unwrap()
}

#[test]
fn wrong_problems_are_refused_with_what_is_wrong() {
    use faying::contact::HalfPlane;
    use faying::linalg::Vector;
    use faying::problem::{Components, ErrorKind as E, Problem};
    assert_eq!(refused(&Problem::new()).kind, E::Empty);
    let mut p = Problem::<1, 2>::new();
    let (a, b) = (square(&mut p, "a", 0.0), square(&mut p, "b", 1.0));
    let other = square(&mut Problem::new(), "a", 0.0);
    assert_eq!(p.fix(other.side("v0"), Components::All).unwrap_err().kind, E::OtherProblem);
    assert_eq!(p.fix(a.side("v0"), Components::Z).unwrap_err().kind, E::NoComponent { component: 2, components: 2 });
    assert!(matches!(p.fix(a.side("w0"), Components::All).unwrap_err().kind, E::Side(_)));
    p.fix(a.side("v0"), Components::All).unwrap();
    assert!(matches!(refused(&p).kind, E::Motions(motions) if motions.len() == 1 && motions[0].contains("\"b\"")));
    p.tie(a.side("v1"), b.side("v1")).unwrap();
    let error = refused(&p);
    assert!(matches!(error.kind, E::Interface { .. }) && error.names()[1] == "a.v1");
    let mut p = Problem::<1, 2>::new();
    let (a, b) = (square(&mut p, "a", 0.0), square(&mut p, "b", 1.0));
    p.fix(a.side("v0"), Components::All).unwrap();
    p.tie(a.side("v1"), b.side("v0")).unwrap();
    p.tie(a.side("v1"), b.side("v0")).unwrap().named("again");
    assert_eq!((refused(&p).kind, refused(&p).names()), (E::SlaveTwice, &["a.v1".to_owned(), "a.v1".to_owned()][..]));
    let mut p = Problem::<1, 2>::new();
    let a = square(&mut p, "a", 0.0);
    p.fix(a.side("v1"), Components::All).unwrap();
    let floor = HalfPlane::try_new(Vector::from([0.0, 0.0]), Vector::from([0.0, 1.0])).unwrap();
    p.contact(a.side("v0"), floor).unwrap().named("floor").moved(2, 0.1);
    assert_eq!(refused(&p).kind, E::Driven { component: 2 });
}

#[test]
fn what_would_be_answered_in_silence_is_refused() {
    use faying::coupling::multiplier::MultiplierKind;
    use faying::problem::{Components, Data, ErrorKind as E, Problem, Value};
    let blocks = || {
        let mut p = Problem::<1, 2>::new();
        let (a, b) = (square(&mut p, "a", 0.0), square(&mut p, "b", 1.0));
        p.fix(a.side("v0"), Components::All).unwrap();
        (p, a, b)
    };
    // a motion of a body, sides that meet both ways, a factor without sense
    let (mut p, a, b) = blocks();
    p.contact(b.side("v0"), a.side("v1")).unwrap().named("pad").moved(1, 0.1);
    assert_eq!(refused(&p).kind, E::NoObstacle);
    let (mut p, a, b) = blocks();
    p.tie(a.side("v1"), b.side("v0")).unwrap();
    p.tie(b.side("v0"), a.side("v1")).unwrap();
    assert_eq!(refused(&p).kind, E::BothWays);
    let (mut p, a, b) = blocks();
    p.fix(b.side("u0"), Components::X).unwrap();
    p.contact(b.side("v0"), a.side("v1")).unwrap().method(faying::coupling::Penalty { factor: -1.0 });
    assert!(matches!(refused(&p).kind, E::Interface { .. }));
    // one constant per component lets the upper block turn
    let (mut p, a, b) = blocks();
    let wide = faying::space::PatchSpec::new(faying::geometry::shapes::rectangle([0.0, 2.0], [1.0, 3.0]).unwrap()).with_elements([1, 1]);
    let material = faying::physics::Hooke::plane_strain(1.0, 0.3).unwrap();
    let top = p.body("top", faying::space::Patch::try_new(&wide.with_degree([1, 1])).unwrap(), material).unwrap();
    p.tie(b.side("v0"), a.side("v1")).unwrap();
    p.tie(top.side("v0"), b.side("v1")).unwrap().multiplier(MultiplierKind::Constant);
    assert!(matches!(refused(&p).kind, E::Motions(motions) if motions[0].contains("\"top\"")));
    // a body that was added later, a solution of another system, a side that does not exist
    let (mut p, a, b) = blocks();
    p.tie(b.side("v0"), a.side("v1")).unwrap();
    p.traction(b.side("v1"), 1, Data::of(|_, t| t)).unwrap();
    let first = p.assemble().unwrap().solve(1.0, None).unwrap();
    let later = square(&mut p, "c", 2.0);
    assert_eq!(first.at(later, &[0.5, 2.5]).unwrap_err().kind, E::OtherProblem);
    assert!(matches!(first.reaction(a.side("bottom of it")).unwrap_err().kind, E::Side(_)));
    assert!((first.reaction(a.side("v0")).unwrap()[1] + 1.0).abs() < 1e-12);
    // data of the time: twice the load, twice the solution
    p.tie(later.side("v0"), b.side("v1")).unwrap();
    let mut system = p.assemble().unwrap();
    let (half, whole) = (system.solve(0.5, Some(&first)).unwrap(), system.solve(1.0, None).unwrap());
    let (u, v) = (half.at(b, &[0.3, 1.6]).unwrap().u, whole.at(b, &[0.3, 1.6]).unwrap().u);
    assert!((2.0 * u[1] - v[1]).abs() < 1e-12 && v[1] > 0.1);
    // values of an exact solution that the problem does not have, and no master
    let (mut p, a, b) = blocks();
    assert_eq!(p.tie(b.side("v0"), [] as [faying::problem::RegionId; 0]).unwrap_err().kind, E::NoMaster);
    p.tie(b.side("v0"), a.side("v1")).unwrap();
    let pull = p.traction(b.side("v1"), 1, Value::Exact).unwrap();
    assert_eq!((refused(&p).kind, refused(&p).of), (E::NoExact, vec![pull]));
}

/// A block over two others side by side, pulled by 1: tied or pressed, each has the stress of one bar.
#[test]
fn a_slave_side_has_several_masters() {
    use faying::problem::{Components, Problem};
    let block = |p: &mut Problem<1, 2>, name: &str, lo: [f64; 2], hi: [f64; 2], n: usize| {
        let spec = faying::space::PatchSpec::new(faying::geometry::shapes::rectangle(lo, hi).unwrap()).with_elements([n, 2]);
        p.body(name, faying::space::Patch::try_new(&spec).unwrap(), faying::physics::Hooke::plane_strain(1.0, 0.0).unwrap()).unwrap()
    };
    for pressed in [false, true] {
        let mut p = Problem::<1, 2>::new();
        let left = block(&mut p, "left", [0.0, 0.0], [0.7, 1.0], 2);
        let right = block(&mut p, "right", [0.7, 0.0], [2.0, 1.0], 3);
        let top = block(&mut p, "top", [0.0, 1.0], [2.0, 2.0], 3);
        for body in [left, right] {
            p.fix(body.side("v0"), Components::All).unwrap();
        }
        p.fix(top.side("u0"), Components::X).unwrap();
        let (masters, load) = ([left.side("v1"), right.side("v1")], if pressed { -1.0 } else { 1.0 });
        p.traction(top.side("v1"), 1, load).unwrap();
        if pressed {
            p.contact(top.side("v0"), masters).unwrap().named("seam");
        } else {
            p.tie(top.side("v0"), masters).unwrap().named("seam");
        }
        let solution = p.assemble().unwrap().solve(1.0, None).unwrap();
        for (body, x) in [(left, [0.3, 0.5]), (right, [1.4, 0.5]), (top, [0.65, 1.5]), (top, [1.9, 1.1])] {
            let point = solution.at(body, &x).unwrap();
            assert!(point.u[0].hypot(point.u[1] - load * x[1]) < 1e-12, "{x:?}: {:?}", point.u);
        }
        for (body, width) in [(left, 0.7), (right, 1.3)] {
            assert!((solution.reaction(body.side("v0")).unwrap()[1] + load * width).abs() < 1e-12);
        }
    }
}

#[test]
fn a_tie_takes_an_integration_from_outside() {
    use faying::coupling::interface::SlaveRule;
    use faying::problem::{Components, Integration, Problem, Rule};
    let solved = |choose: &dyn Fn(&mut faying::problem::Tie)| {
        let mut p = Problem::<1, 2>::new();
        let (a, b) = (square(&mut p, "a", 0.0), square(&mut p, "b", 1.0));
        p.fix(a.side("v0"), Components::All).unwrap();
        p.traction(b.side("v1"), 1, 1.0).unwrap();
        choose(p.tie(b.side("v0"), a.side("v1")).unwrap());
        let solution = p.assemble().unwrap().solve(1.0, None).unwrap();
        solution.coefficients(b).unwrap().to_vec()
    };
    let twin = solved(&|tie| {
        tie.rule(Integration::Slave).extra_points(3);
    });
    let own = solved(&|tie| {
        tie.rule(Rule::of(|points, partners| Box::new(SlaveRule { points: points + 3, partners })));
    });
    let plain = solved(&|tie| {
        tie.rule(Integration::Slave);
    });
    assert_eq!(own, twin);
    assert!(own.iter().zip(&plain).all(|(a, b)| (a - b).abs() < 1e-12));
}
