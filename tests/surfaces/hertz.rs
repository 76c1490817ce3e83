//! The formulas of Hertz: zones on rigid obstacles and between two bodies, from quarters of bodies that are graded towards the zone.
//!
//! With `FAYING_HERTZ=all` in the environment sizes are two thirds of these, which makes about 60 000 unknowns of two bodies, and there are 20
//! random first guesses of the active set instead of two.

use crate::bodies::{Kind, Solid, steel};
use crate::zones::closed;
use faying::basis::BSpline;
use faying::contact::{HalfPlane, Sphere};
use faying::geometry::ControlNet;
use faying::linalg::Vector;
use faying::problem::{BodyId, Components, ContactId, Problem, Solution, Start};
use faying::space::PatchSpec;

/// The reduced modulus E / (1 - nu²) of one elastic side; of two alike it is half of it.
const E_STAR: f64 = 1.0 / (1.0 - 0.3 * 0.3);

fn is_fine() -> bool {
    std::env::var("FAYING_HERTZ").is_ok_and(|v| v == "all")
}

/// Breakpoints from 0 to 1: `n` equal elements up to `end`, then elements that grow from there on.
fn graded(end: f64, n: usize) -> Vec<f64> {
    let (n, rest) = if is_fine() { (n + n.div_ceil(2), 9) } else { (n, 6) };
    let mut at: Vec<f64> = (0..=n).map(|k| end * k as f64 / n as f64).collect();
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

/// A round zone: the radius R of the gap r² / (2R), and the reduced modulus E*.
struct Hertz {
    radius: f64,
    modulus: f64,
}

impl Hertz {
    /// A quarter of the force that makes a zone of radius `a`.
    fn quarter_force(&self, a: f64) -> f64 {
        a.powi(3) * self.modulus / (0.75 * self.radius) / 4.0
    }

    /// Compares a quarter of a zone with a³ = 3 F R / (4 E*), p0 = 3 F / (2 pi a²) for its force; `within` is the bound of the greatest
    /// pressure.
    fn check(&self, what: &str, zone: &Zone, a_wanted: f64, within: f64) {
        let force = 4.0 * zone.force;
        let a = (0.75 * force * self.radius / self.modulus).cbrt();
        let greatest = 1.5 * force / (std::f64::consts::PI * a * a);
        let errors = [zone.axes[0] / a - 1.0, zone.axes[1] / a - 1.0, zone.greatest / greatest - 1.0, a / a_wanted - 1.0];
        println!("{what}: a/R {:.4}, errors {errors:?}", a / self.radius);
        let bounds = [0.02, 0.02, within, 1e-9];
        assert!(errors.iter().zip(bounds).all(|(e, bound)| e.abs() < bound), "{what}: {errors:?}");
    }
}

/// A quarter of a block, x >= 0, y >= 0, z from -1 to 0, graded towards the origin: a ball is pressed on its top. Continuous linear
/// pressures on triangles of one diagonal overshoot in the corner by 5.3 % where four elements lie between it and the end of the zone.
#[test]
fn a_ball_pressed_on_a_block_is_that_of_hertz() {
    let (a, hertz) = (0.04, Hertz { radius: 1.0, modulus: E_STAR });
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
        let contact = p.contact(block.side("w1"), ball).unwrap().pressed(2, -hertz.quarter_force(a)).id();
        let solution = p.assemble().unwrap().solve(0.0, None).unwrap();
        hertz.check(&format!("ball on {kind:?}"), &zone(&solution, contact), a, within);
    }
}

/// A quarter of a body, x and y from 0 to 1, between z = x² / (2 R_x) + y² / (2 R_y), exact with degree 2, and z = 1.5; `curvatures` are
/// 1 / R. With `up` = false it lies below, between its mirror image and z = -1.5.
fn rounded(kind: Kind, curvatures: [f64; 2], up: bool, a: f64, n: usize) -> Solid {
    let bent = || BSpline::<f64>::uniform(2, 1, 1);
    let squares = [0.0, 0.0, 1.0];
    let mut points = Vec::new();
    for k in 0..2 {
        for (j, y) in [0.0, 0.5, 1.0].into_iter().enumerate() {
            for (i, x) in [0.0, 0.5, 1.0].into_iter().enumerate() {
                let near = 0.5 * (squares[i] * curvatures[0] + squares[j] * curvatures[1]);
                let z = if (k == 0) == up { near } else { 1.5 };
                points.push(Vector::<3>::new(x, y, if up { z } else { -z }));
            }
        }
    }
    let net = ControlNet::<3, 3>::try_new([bent(), bent(), BSpline::uniform(1, 1, 0)], points, None).unwrap();
    let (across, mut deep) = (graded(1.3 * a, n), graded(a, 4));
    if !up {
        deep = deep.iter().rev().map(|z| 1.0 - z).collect();
    }
    kind.body(&PatchSpec::new(net).with_degree([2; 3]).with_breakpoints([across.clone(), across, deep]))
}

#[test]
fn a_rounded_body_on_a_rigid_plane_is_that_of_hertz() {
    let (a, hertz) = (0.05, Hertz { radius: 2.0, modulus: E_STAR });
    for kind in [Kind::Spline, Kind::Hexahedra] {
        let mut p = Problem::<2, 3>::new();
        let body = rounded(kind, [1.0 / hertz.radius; 2], true, a, if kind == Kind::Spline { 7 } else { 6 });
        let body = kind.add(&mut p, "body", body, steel());
        p.fix(body.side("u0"), Components::One(0)).unwrap();
        p.fix(body.side("v0"), Components::One(1)).unwrap();
        p.fix(body.side("w1"), Components::All).unwrap();
        let plane = HalfPlane::try_new(Vector::<3>::zeros(), Vector::<3>::z()).unwrap();
        let contact = p.contact(body.side("w0"), plane).unwrap().pressed(2, hertz.quarter_force(a)).id();
        let solution = p.assemble().unwrap().solve(0.0, None).unwrap();
        hertz.check(&format!("rounded {kind:?} on a plane"), &zone(&solution, contact), a, 0.02);
    }
}

/// Two quarters of bodies, the upper one pressed on the lower one by a pressure on its top; grids of `elements` up to the end of the zone,
/// the upper body the slave.
struct TwoBodies {
    kinds: [Kind; 2],
    curvatures: [[f64; 2]; 2],
    elements: [usize; 2],
}

impl TwoBodies {
    /// The radius that the zone should have.
    const A: f64 = 0.04;

    /// The gap, which is the same in x and y.
    fn hertz(&self) -> Hertz {
        let [lower, upper] = self.curvatures;
        let hertz = Hertz { radius: 1.0 / (lower[0] + upper[0]), modulus: 0.5 * E_STAR };
        assert!((lower[1] + upper[1] - 1.0 / hertz.radius).abs() < 1e-15 && Self::A / hertz.radius <= 0.02);
        hertz
    }

    /// The solution from a first guess of the active set.
    fn solve(&self, start: Start) -> (Solution<2, 3>, ContactId) {
        let mut p = Problem::<2, 3>::new();
        let [lower, upper]: [BodyId; 2] = std::array::from_fn(|b| {
            let body = rounded(self.kinds[b], self.curvatures[b], b == 1, Self::A, self.elements[b]);
            let body = self.kinds[b].add(&mut p, ["lower", "upper"][b], body, steel());
            p.fix(body.side("u0"), Components::One(0)).unwrap();
            p.fix(body.side("v0"), Components::One(1)).unwrap();
            body
        });
        p.fix(lower.side("w0"), Components::One(2)).unwrap();
        p.pressure(upper.side("w1"), self.hertz().quarter_force(Self::A)).unwrap();
        let contact = p.contact(upper.side("w0"), lower.side("w1")).unwrap().start(start).id();
        (p.assemble().unwrap().solve(0.0, None).unwrap(), contact)
    }

    fn check(&self, what: &str) {
        let (solution, contact) = self.solve(Start::Auto);
        let (result, set) = (solution.contact(contact).unwrap(), closed(&solution, contact));
        assert!(result.balance < 1e-12, "{what}: {:e}", result.balance);
        self.hertz().check(&format!("{what}, {:?}", self.kinds), &zone(&solution, contact), Self::A, 0.02);
        for start in [Start::All, Start::None].into_iter().chain((1..=if is_fine() { 20 } else { 2 }).map(Start::Seed)) {
            let (other, contact) = self.solve(start);
            assert_eq!(closed(&other, contact), set, "{what} {start:?}");
            let found = other.contact(contact).unwrap();
            let apart = [(found.force - result.force).norm() / result.force.norm(), found.largest_pressure / result.largest_pressure - 1.0];
            assert!(apart.iter().all(|d| d.abs() < 1e-11), "{what} {start:?}: {apart:?}");
        }
    }
}

#[test]
fn two_spheres_are_those_of_hertz() {
    let radius = [1.0 / 5.0, 1.0 / 4.0];
    TwoBodies { kinds: [Kind::Spline, Kind::Spline], curvatures: radius.map(|k| [k; 2]), elements: [6, 7] }.check("two spheres");
}

#[test]
fn a_sphere_on_an_elastic_block_is_that_of_hertz() {
    TwoBodies { kinds: [Kind::Hexahedra, Kind::Spline], curvatures: [[0.0; 2], [0.5; 2]], elements: [5, 7] }.check("sphere on a block");
}

#[test]
fn crossed_cylinders_are_those_of_hertz() {
    TwoBodies { kinds: [Kind::Spline, Kind::Spline], curvatures: [[0.0, 0.5], [0.5, 0.0]], elements: [6, 7] }.check("crossed cylinders");
}
