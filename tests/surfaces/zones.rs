//! Zones of contact that are a part of the side: conditions of contact, first guesses, and the formulas of Hertz.

use crate::bodies::{KINDS, Kind, Solid, steel};
use faying::basis::BSpline;
use faying::contact::{Cone, HalfPlane, Lagrange, Sphere};
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::ControlNet;
use faying::linalg::{Matrix, Vector};
use faying::problem::{Components, ContactId, Problem, Solution, Start};
use faying::space::PatchSpec;

/// A block pressed on a ball from above by its top, which is held: the middle of its bottom touches.
fn on_a_ball(kind: Kind, degree: usize, cone: Cone, multiplier: MultiplierKind, start: Start) -> (Solution<2, 3>, ContactId) {
    let block = kind.turned_box(([0.0; 3], [1.0, 1.0, 0.5]), &Matrix::identity(), degree, [6, 5, 2]);
    let mut p = Problem::<2, 3>::new();
    let block = kind.add(&mut p, "block", block, steel());
    p.fix(block.side("w1"), Components::One(0)).unwrap();
    p.fix(block.side("w1"), Components::One(1)).unwrap();
    p.prescribe(block.side("w1"), 2, -0.02).unwrap();
    let ball = Sphere::<3> { center: Vector::<3>::new(0.42, 0.55, -2.0), radius: 2.0, inside: false };
    let contact = p.contact(block.side("w0"), ball).unwrap().method(Lagrange).cone(cone).multiplier(multiplier).start(start).id();
    let mut system = p.assemble().unwrap();
    (system.solve(0.0, None).unwrap(), contact)
}

fn closed(solution: &Solution<2, 3>, contact: ContactId) -> Vec<bool> {
    solution.along(contact, 0).unwrap().unwrap().points().iter().map(|p| p.active).collect()
}

#[test]
fn the_conditions_of_contact_hold_and_no_first_guess_matters() {
    for kind in KINDS {
        for (degree, lowered) in [(1, 0), (2, 0), (2, if kind == Kind::Tetrahedra { 1 } else { 2 })] {
            for cone in [Cone::Coefficients, Cone::Weights] {
                let solve = |start| on_a_ball(kind, degree, cone, MultiplierKind::Lowered(lowered), start);
                let what = format!("{kind:?} {degree} p/p-{lowered} {cone:?}");
                let (solution, contact) = solve(Start::Auto);
                let (result, set) = (solution.contact(contact).unwrap(), closed(&solution, contact));
                let number = set.iter().filter(|c| **c).count();
                assert!(number > 0 && number < set.len() && number == result.active, "{what}: {number} of {}", set.len());
                let (worst, largest) = (result.violation, result.largest_pressure);
                assert!(worst.lambda <= 1e-12 * largest && worst.gap <= 1e-12 && worst.product <= 1e-12 * largest, "{what}: {worst:?}");
                assert!(Vector::<3>::from(solution.balance().force).norm() < 1e-12 * result.force.norm(), "{what}");
                for start in [Start::All, Start::None, Start::Seed(3), Start::Seed(17)] {
                    let (other, contact) = solve(start);
                    assert_eq!(closed(&other, contact), set, "{what} {start:?}");
                    let force = other.contact(contact).unwrap().force;
                    assert!((force - result.force).norm() < 1e-11 * result.force.norm(), "{what} {start:?}");
                }
            }
        }
    }
}

/// Breakpoints from 0 to 1: `n` equal elements up to `end`, then elements that grow from there on.
fn graded(end: f64, n: usize) -> Vec<f64> {
    let mut at: Vec<f64> = (0..=n).map(|k| end * k as f64 / n as f64).collect();
    let rest = 6;
    // sizes h q, h q², .. that add up to what is left
    let h = end / n as f64;
    let sum = |q: f64| (1..=rest).map(|k| h * q.powi(k)).sum::<f64>();
    let (mut low, mut high) = (1.0, 10.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if sum(middle) < 1.0 - end { low = middle } else { high = middle }
    }
    for k in 1..=rest {
        at.push(if k == rest { 1.0 } else { at[at.len() - 1] + h * low.powi(k) });
    }
    at
}

/// Force and greatest pressure over those of Hertz for a radius of the zone, from the second moments of the pressure about the corner.
struct Zone {
    /// The half axes along x and y, a² = 5 <x²>.
    axes: [f64; 2],
    force: f64,
    greatest: f64,
}

fn zone(solution: &Solution<2, 3>, contact: ContactId) -> Zone {
    let result = solution.contact(contact).unwrap();
    let side = &solution.contents().contacts().next().unwrap().sides()[0];
    let (space, lambda) = (side.side().trace().space.clone(), solution.lambda(contact, 0).unwrap().unwrap());
    let rules = faying::assembly::gauss_rules(&*space, 3);
    let (mut map, mut sums) = (faying::geometry::MapTable::new(), [0.0; 3]);
    for e in 0..space.num_elements() {
        let rule = faying::quadrature::Quadrature::rule(&rules, e);
        space.map(e, &rule.points, faying::basis::Order::Gradients, &mut map);
        for (q, pressure) in lambda.at(e, &rule.points)[0].iter().enumerate() {
            let ds = rule.weights[q] * faying::linalg::measure(&map.jacobian[q]);
            sums[0] -= pressure * ds;
            (0..2).for_each(|k| sums[k + 1] -= pressure * ds * map.x[q][k].powi(2));
        }
    }
    let axes = [1, 2].map(|k| (5.0 * sums[k] / sums[0]).sqrt());
    Zone { axes, force: result.force[2].abs(), greatest: result.largest_pressure }
}

/// Compares a quarter of a zone with the formulas of Hertz for its force: a³ = 3 F R / (4 E*), p0 = 3 F / (2 pi a²); `within` is the bound of
/// the greatest pressure.
fn assert_hertz(what: &str, zone: &Zone, radius: f64, a_wanted: f64, within: f64) {
    let modulus = 1.0 / (1.0 - 0.3 * 0.3);
    let force = 4.0 * zone.force;
    let a = (0.75 * force * radius / modulus).cbrt();
    let greatest = 1.5 * force / (std::f64::consts::PI * a * a);
    let errors = [zone.axes[0] / a - 1.0, zone.axes[1] / a - 1.0, zone.greatest / greatest - 1.0, a / a_wanted - 1.0];
    println!("{what}: a/R {:.4}, errors {errors:?}", a / radius);
    let bounds = [0.02, 0.02, within, 1e-9];
    assert!(errors.iter().zip(bounds).all(|(e, bound)| e.abs() < bound), "{what}: {errors:?}");
}

/// The force of a quarter of a sphere of radius `radius` that makes a zone of radius `a`.
fn quarter_force(radius: f64, a: f64) -> f64 {
    let modulus = 1.0 / (1.0 - 0.3 * 0.3);
    a.powi(3) * modulus / (0.75 * radius) / 4.0
}

/// A quarter of a block, x >= 0, y >= 0, z from -1 to 0, graded towards the origin: a ball is pressed on its top. Continuous linear
/// pressures on triangles of one diagonal overshoot in the corner by 5.3 % where four elements lie between it and the end of the zone.
#[test]
fn a_ball_pressed_on_a_block_is_that_of_hertz() {
    let a = 0.04;
    for (kind, degree, n, within) in [(Kind::Spline, 2, 7, 0.02), (Kind::Hexahedra, 2, 6, 0.02), (Kind::Tetrahedra, 2, 5, 0.06)] {
        let net = faying::geometry::shapes::brick([0.0, 0.0, -1.0], [1.0, 1.0, 0.0]).unwrap();
        let across = graded(1.3 * a, n);
        let down: Vec<f64> = graded(1.3 * a, 4).iter().rev().map(|x| 1.0 - x).collect();
        let block = kind.body(&PatchSpec::new(net).with_degree([degree; 3]).with_breakpoints([across.clone(), across, down]));
        let mut p = Problem::<2, 3>::new();
        let block = kind.add(&mut p, "block", block, steel());
        p.fix(block.side("u0"), Components::One(0)).unwrap();
        p.fix(block.side("v0"), Components::One(1)).unwrap();
        p.fix(block.side("w0"), Components::All).unwrap();
        let ball = Sphere::<3> { center: Vector::<3>::new(0.0, 0.0, 1.0), radius: 1.0, inside: false };
        let contact = p.contact(block.side("w1"), ball).unwrap().pressed(2, -quarter_force(1.0, a)).id();
        let solution = p.assemble().unwrap().solve(0.0, None).unwrap();
        assert_hertz(&format!("ball on {kind:?}"), &zone(&solution, contact), 1.0, a, within);
    }
}

/// A quarter of a body with the bottom z = (x² + y²) / 2R, exact with degree 2, and a flat top.
fn bowl(kind: Kind, radius: f64, a: f64, n: usize) -> Solid {
    let bent = || BSpline::<f64>::uniform(2, 1, 1);
    let squares = [0.0, 0.0, 1.0];
    let mut points = Vec::new();
    for k in 0..2 {
        for (j, y) in [0.0, 0.5, 1.0].into_iter().enumerate() {
            for (i, x) in [0.0, 0.5, 1.0].into_iter().enumerate() {
                let low = (squares[i] + squares[j]) / (2.0 * radius);
                points.push(Vector::<3>::new(x, y, if k == 0 { low } else { 1.5 }));
            }
        }
    }
    let net = ControlNet::<3, 3>::try_new([bent(), bent(), BSpline::uniform(1, 1, 0)], points, None).unwrap();
    let (across, up) = (graded(1.3 * a, n), graded(a, 4));
    kind.body(&PatchSpec::new(net).with_degree([2; 3]).with_breakpoints([across.clone(), across, up]))
}

#[test]
fn a_rounded_body_on_a_rigid_plane_is_that_of_hertz() {
    let (radius, a) = (2.0, 0.05);
    for kind in [Kind::Spline, Kind::Hexahedra] {
        let mut p = Problem::<2, 3>::new();
        let body = kind.add(&mut p, "body", bowl(kind, radius, a, if kind == Kind::Spline { 7 } else { 6 }), steel());
        p.fix(body.side("u0"), Components::One(0)).unwrap();
        p.fix(body.side("v0"), Components::One(1)).unwrap();
        p.fix(body.side("w1"), Components::All).unwrap();
        let plane = HalfPlane::try_new(Vector::<3>::zeros(), Vector::<3>::z()).unwrap();
        let contact = p.contact(body.side("w0"), plane).unwrap().pressed(2, quarter_force(radius, a)).id();
        let solution = p.assemble().unwrap().solve(0.0, None).unwrap();
        assert_hertz(&format!("rounded {kind:?} on a plane"), &zone(&solution, contact), radius, a, 0.02);
    }
}
