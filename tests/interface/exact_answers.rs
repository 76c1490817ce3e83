//! Answers of systems and solutions of which every number is known, by both backends.

use faying::contact::HalfPlane;
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::Hooke;
use faying::problem::{BodyId, Components, Data, Forecast, InterfaceId, OtherField, Problem, Statement, TieId};
use faying::space::{Body, Mesh, Patch, PatchSpec};
use std::sync::Arc;

/// Strains of plane strain under sigma_yy = 1, with E = 1 and nu = 0.3.
const STRAIN: [f64; 2] = [-0.39, 0.91];

/// A block of width 2 and height 1 over y = `low`, as splines or as a mesh.
fn block(p: &mut Problem<1, 2>, name: &str, low: f64, elements: usize, is_mesh: bool) -> BodyId {
    let spec = PatchSpec::new(rectangle([0.0, low], [2.0, low + 1.0]).unwrap()).with_elements([elements, 2]);
    let body: Arc<dyn Body<1, 2>> = match is_mesh {
        true => Arc::new(Mesh::from_patch(&spec).unwrap()),
        false => Arc::new(Patch::try_new(&spec).unwrap()),
    };
    p.body(name, body, Hooke::plane_strain(1.0, 0.3).unwrap()).unwrap()
}

/// Two blocks that are tied, held at the bottom and on the left, and pulled at the top by sigma_yy = 1.
fn pulled(is_mesh: bool) -> (Problem<1, 2>, TieId, [BodyId; 2], Statement) {
    let mut p = Problem::<1, 2>::new();
    let (lower, upper) = (block(&mut p, "lower", 0.0, 3, is_mesh), block(&mut p, "upper", 1.0, 4, is_mesh));
    p.fix(lower.side("v0"), Components::Y).unwrap();
    [lower, upper].into_iter().for_each(|body| {
        p.fix(body.side("u0"), Components::X).unwrap();
    });
    let load = p.traction(upper.side("v1"), 1, 1.0).unwrap();
    let tie = p.tie(upper.side("v0"), lower.side("v1")).unwrap().named("seam").exact(vec![Data::from(0.0), Data::from(1.0)]).id();
    (p, tie, [lower, upper], load)
}

/// Components that are lowered at opposite ends have as many functions, and others.
#[test]
fn points_along_a_tie_have_the_lambda_of_their_place() {
    for (is_mesh, load) in [false, true].into_iter().flat_map(|is_mesh| [0, 1].map(|load| (is_mesh, load))) {
        let mut p = Problem::<1, 2>::new();
        let (lower, upper) = (block(&mut p, "lower", 0.0, 3, is_mesh), block(&mut p, "upper", 1.0, 4, is_mesh));
        p.fix(lower.side("v0"), Components::All).unwrap();
        p.fix(upper.side("u0"), Components::X).unwrap();
        p.fix(upper.side("u1"), Components::Y).unwrap();
        p.traction(upper.side("v1"), load, 1.0).unwrap();
        let tie = p.tie(upper.side("v0"), lower.side("v1")).unwrap().multiplier(MultiplierKind::Lowered(0)).id();
        let solution = p.assemble().unwrap().solve(0.0, None).unwrap();
        let (side, lambda) = (solution.along(tie, 0).unwrap().unwrap(), solution.multiplier(tie).unwrap());
        assert!(lambda.len() == 2 * side.points().len(), "{} points", side.points().len());
        let mut most = 0.0_f64;
        for point in side.points() {
            let (e, xi) = ((2.0 * point.x[0]).floor().min(3.0), Vector::<1>::new(2.0 * point.x[0] - (2.0 * point.x[0]).floor().min(3.0)));
            let wanted = side.lambda(e as usize, &[xi]);
            point.lambda.iter().zip(&wanted).for_each(|(found, wanted)| near(*found, *wanted));
            most = most.max(wanted[load].abs());
        }
        assert!(most > 0.1, "{most}");
    }
}

/// The displacement under sigma_yy = 1.
#[derive(Debug)]
struct Stretched;

impl OtherField<2> for Stretched {
    fn at(&self, _: usize, _: &Vector<2>, x: &Vector<2>, _: usize) -> ([f64; 3], [[f64; 3]; 3]) {
        let mut slope = [[0.0; 3]; 3];
        (slope[0][0], slope[1][1]) = (STRAIN[0], STRAIN[1]);
        ([STRAIN[0] * x[0], STRAIN[1] * x[1], 0.0], slope)
    }
}

fn near(found: f64, wanted: f64) {
    assert!((found - wanted).abs() < 1e-9, "{found} in place of {wanted}");
}

#[test]
fn a_tie_under_tension_answers_with_its_exact_numbers() {
    for is_mesh in [false, true] {
        let (p, tie, [lower, upper], load) = pulled(is_mesh);
        let mut system = p.assemble().unwrap();
        system.assemble_at(1.0);
        assert!(system.loads(1.0)[0].of == load && system.no_loads()[0].resultant.force == [0.0; 3]);
        let solution = system.solve(1.0, None).unwrap();
        assert_eq!((solution.t(), solution.unknowns().len()), (1.0, system.contents().size().unknowns));
        // sigma : epsilon = 0.91 on an area of 4
        near(solution.energy(), 0.5 * STRAIN[1] * 4.0);
        near(solution.loads()[0].resultant.force[1], 2.0);
        near(solution.loads()[0].resultant.moment[2], 2.0);
        let balance = solution.balance();
        balance.force.iter().chain(&balance.moment).for_each(|part| near(*part, 0.0));
        near(solution.reactions().iter().map(|r| r.force[1]).sum(), -2.0);
        assert!(solution.linear().residual < 1e-10 && solution.active_set().is_none() && solution.linear().free > 0);
        let result = solution.tie(tie).unwrap();
        assert!(result.balance < 1e-10 && result.consistency < 1e-10 && result.pieces == 6, "{result:?}");
        // lambda = -sigma n on the upper body, whose outward normal is (0, -1)
        let lambda = solution.lambda(tie, 0).unwrap().unwrap().at(1, &[Vector::<1>::new(0.3), Vector::<1>::new(1.0)]);
        lambda[0].iter().for_each(|l| near(*l, 0.0));
        lambda[1].iter().for_each(|l| near(*l, 1.0));
        assert!(solution.lambda(tie, 1).unwrap().is_none() && solution.along(tie, 1).unwrap().is_none());
        let error = solution.lambda_error(tie).unwrap();
        near(error.error, 0.0);
        near(error.exact, 2.0);
        let side = solution.along(tie, 0).unwrap().unwrap();
        let at = [Vector::<1>::new(0.25)];
        for (found, wanted) in [(side.traction(2, &at), [0.0, -1.0]), (side.lambda(2, &at), [0.0, 1.0]), (side.normal(2, &at), [0.0, 1.0])]
        {
            found.iter().zip(wanted).for_each(|(found, wanted)| near(*found, wanted));
        }
        near(side.gap(2, &at)[0], 0.0);
        assert!(side.active(2, &at) == [1.0] && side.degree() > 0);
        assert!(
            side.points()
                .iter()
                .all(|point| point.s.is_some_and(|s| (0.0..=2.0).contains(&s)) && (point.x[1] - 1.0).abs() < 1e-12 && point.active)
        );
        let [low, high] = solution.extremes(upper, false, &|s| s.u[1]).unwrap().unwrap();
        near(low.value, STRAIN[1]);
        near(high.value, 2.0 * STRAIN[1]);
        near(high.at[1], 2.0);
        let [least, most] = solution.extremes_at_points(lower, &|s| s.stress[1]).unwrap().unwrap();
        near(least.value, 1.0);
        near(most.value, 1.0);
        for body in solution.contents().bodies() {
            near(solution.difference(body.id(), body.rules(), &Stretched).unwrap().error.h1, 0.0);
        }
    }
}

#[test]
fn a_pressed_block_answers_with_its_exact_numbers() {
    for is_mesh in [false, true] {
        let mut p = Problem::<1, 2>::new();
        let body = block(&mut p, "block", 0.0, 6, is_mesh);
        p.fix(body.side("u0"), Components::X).unwrap();
        p.traction(body.side("v1"), 1, -0.1).unwrap();
        let floor = HalfPlane::try_new(Vector::from([0.0, 0.0]), Vector::from([0.0, 1.0])).unwrap();
        let contact = p.contact(body.side("v0"), floor).unwrap().named("floor").id();
        let mut system = p.assemble().unwrap();
        let solution = system.solve(1.0, None).unwrap();
        let result = solution.contact(contact).unwrap();
        for (found, wanted) in [
            (result.force[1], 0.2),
            (result.moment[2], 0.2),
            (result.area, 2.0),
            (result.measure, 2.0),
            (result.least_pressure, 0.1),
            (result.largest_pressure, 0.1),
            (result.least_gap, 0.0),
            (result.least_point_gap, 0.0),
            (result.violation.lambda, 0.0),
            (result.violation.gap, 0.0),
            (result.violation.product, 0.0),
            (result.half_width.unwrap().unwrap(), 1.0),
        ] {
            near(found, wanted);
        }
        let rows: Vec<usize> = (0..system.contents().size().rows).collect();
        assert_eq!((result.active, result.sign_cases.iter().sum::<usize>()), (rows.len(), rows.len()));
        assert_eq!((result.displacement, result.balance, result.consistency), (Some(Vector::zeros()), 0.0, 0.0));
        near(solution.lambda(contact, 0).unwrap().unwrap().at(0, &[Vector::<1>::new(0.5)])[0][0], -0.1);
        let side = solution.along(contact, 0).unwrap().unwrap();
        let found = [side.traction(0, &[Vector::<1>::new(0.5)]), side.normal(0, &[Vector::<1>::new(0.5)])].concat();
        found.iter().zip([0.0, 0.1, 0.0, 1.0]).for_each(|(found, wanted)| near(*found, wanted));
        // rows by the contact that they belong to, and motions where all are open
        let of = system.contact_rows(&rows);
        assert!(of.len() == 1 && of[0].contact == "floor" && of[0].numbers == rows && !of[0].at_points && of[0].place.is_some(), "{of:?}");
        assert_eq!(system.row_owner(1), Some((InterfaceId::Contact(contact), "floor", 1)));
        assert!(system.row_owner(rows.len()).is_none() && system.motions_with_open(1.0, &[]).is_empty());
        let motions = system.motions_with_open(1.0, &rows);
        assert!(
            motions.len() == 1 && motions[0].of == body.into() && motions[0].sentence.contains("\"block\" can still move"),
            "{motions:?}"
        );
    }
}

#[test]
fn a_system_shows_its_contents_its_forecast_and_what_can_move() {
    let (p, tie, _, _) = pulled(false);
    let system = p.assemble().unwrap();
    let contents = system.contents();
    assert_eq!(contents.bodies().map(|b| b.name()).collect::<Vec<_>>(), ["lower", "upper"]);
    let seam = contents.interfaces().next().unwrap();
    let slave = seam.sides()[0];
    assert_eq!((seam.id(), seam.name(), contents.contacts().len()), (InterfaceId::Tie(tie), "seam", 0));
    assert_eq!((slave.side().label(), slave.side().body(), slave.number()), ("upper.v0", 1, 0));
    assert_eq!((slave.pairs()[0].master().label(), slave.rows()), ("lower.v1", 0..contents.size().rows));
    near(slave.pairs()[0].covered(), 2.0);
    assert!(seam.is_symmetric() && !seam.is_mixed() && !seam.has_rows_at_points() && slave.multipliers().len() == 2);
    let supports: Vec<_> = contents.supports().map(|s| (s.body, s.name, s.is_side)).collect();
    assert_eq!(supports, [(0, "v0", true), (0, "u0", true), (1, "u0", true)]);
    let (with, without) = (system.forecast(true, 1), system.forecast(false, 1));
    assert!(with.memory > Forecast::PROGRAM && with.factor > with.entries / 4 && without.factor == 0, "{with:?}, {without:?}");
    assert!(system.forecast(true, 100).memory > with.memory && system.rigid_motions().is_empty());
    let mut loose = Problem::<1, 2>::new();
    let body = block(&mut loose, "free", 0.0, 2, true);
    assert!(loose.assemble().is_err());
    let motions = loose.assemble_movable().unwrap().rigid_motions();
    assert!(motions.len() == 1 && motions[0].of == body.into() && motions[0].motions.len() == 3, "{motions:?}");
}
