//! Bodies of revolution by `Problem`, on both backends, against solutions in closed form: tubes, cylinders, shrink fits.

use crate::exact::{Expr, Solved, elastic};
use faying::basis::Order;
use faying::contact::{Augmented, HalfPlane, Lagrange, Sphere};
use faying::coupling::multiplier::{MultiplierError, MultiplierKind};
use faying::coupling::{Nitsche, Penalty};
use faying::geometry::MapTable;
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::{Assumption, Conductor, Hooke, Material};
use faying::problem::{
    BodyId, BodyMaterial, BodySpec, Components, Data, Derivatives, ErrorKind, Exact, InterfaceError, Point, Problem, RevolutionError, Value,
};
use faying::space::{Body, Mesh, Patch, PatchSpec};
use std::f64::consts::PI;
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// A rectangle of the half plane with n x m elements, splines or Lagrange elements.
fn half_section(is_fe: bool, degree: usize, min: [f64; 2], max: [f64; 2], n: usize, m: usize) -> Arc<dyn Body<1, 2>> {
    let lines = |k: usize| (0..=k).map(|i| i as f64 / k as f64).collect::<Vec<f64>>();
    let net = rectangle(min, max).unwrap();
    let spec = PatchSpec { degree: [degree; 2], breakpoints: [lines(n), lines(m)], ..PatchSpec::new(net) };
    if is_fe { Arc::new(Mesh::from_patch(&spec).unwrap()) } else { Arc::new(Patch::try_new(&spec).unwrap()) }
}

fn add<const C: usize>(p: &mut Problem<1, 2>, name: &str, body: Arc<dyn Body<1, 2>>, material: impl Material<C, 2> + 'static) -> BodyId {
    let material = BodyMaterial::of::<C>(material).unwrap();
    // points enough for the norms of errors
    p.add(BodySpec { extra_points: 3, ..BodySpec::new(name, body, material) }).unwrap()
}

/// An exact solution by value and gradient.
struct Known<F>(F);

impl<F> Debug for Known<F> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str("known")
    }
}

impl<F: Fn(usize, f64, f64) -> (f64, [f64; 2]) + Send + Sync> Exact for Known<F> {
    fn value(&self, component: usize, at: &Point) -> f64 {
        self.slope(component, at).value
    }
    fn slope(&self, component: usize, at: &Point) -> Derivatives {
        let (value, [r, z]) = (self.0)(component, at.x[0], at.x[1]);
        Derivatives { value, gradient: [r, z, 0.0], ..Derivatives::default() }
    }
    fn derivatives(&self, component: usize, at: &Point) -> Derivatives {
        self.slope(component, at)
    }
}

/// Lamé's tube of radii a, b in plane strain under the pressures p inside and q outside.
#[derive(Clone, Copy)]
struct Tube {
    young: f64,
    nu: f64,
    /// sigma_rr = c - d / r², sigma_tt = c + d / r².
    c: f64,
    d: f64,
}

impl Tube {
    fn new(young: f64, nu: f64, [a, b]: [f64; 2], [p, q]: [f64; 2]) -> Self {
        let area = b * b - a * a;
        Self { young, nu, c: (p * a * a - q * b * b) / area, d: (p - q) * a * a * b * b / area }
    }
    fn u(&self, r: f64) -> f64 {
        (1.0 + self.nu) / self.young * ((1.0 - 2.0 * self.nu) * self.c * r + self.d / r)
    }
    fn slope(&self, r: f64) -> f64 {
        (1.0 + self.nu) / self.young * ((1.0 - 2.0 * self.nu) * self.c - self.d / (r * r))
    }
    fn field(self) -> Known<impl Fn(usize, f64, f64) -> (f64, [f64; 2]) + Send + Sync> {
        Known(move |component, r, _| if component == 0 { (self.u(r), [self.slope(r), 0.0]) } else { (0.0, [0.0; 2]) })
    }
}

#[track_caller]
fn near(found: f64, wanted: f64, within: f64) {
    assert!((found - wanted).abs() <= within * wanted.abs(), "{found} for {wanted}");
}

#[test]
fn a_thick_tube_under_pressure_is_that_of_lame() {
    let (young, nu, p, h) = (1.0, 0.3, 1.0, 0.5);
    let tube = Tube::new(young, nu, [1.0, 2.0], [p, 0.0]);
    for is_fe in [false, true] {
        for degree in 1..=3 {
            let solve = |n: usize| {
                let mut problem = Problem::axisymmetric();
                let body = half_section(is_fe, degree, [1.0, 0.0], [2.0, h], n, 1);
                let a = add::<2>(&mut problem, "a", body, Hooke::axisymmetric(young, nu).unwrap());
                problem.fix(a.side("v0"), Components::Y).unwrap();
                problem.fix(a.side("v1"), Components::Y).unwrap();
                problem.pressure(a.side("u0"), p).unwrap();
                let s = problem.assemble().unwrap().solve(1.0, None).unwrap();
                // the load on the full circle, and the force of sigma_zz = 2 nu c that holds the ends
                near(s.loads()[0].resultant.force[0], p * 2.0 * PI * h, 1e-12);
                assert_eq!(s.loads()[0].resultant.moment, [0.0; 3]);
                let end = s.reaction(a.side("v1")).unwrap()[1];
                let wanted = 2.0 * nu * tube.c * 3.0 * PI;
                assert!((end - wanted).abs() <= 10.0 * wanted / (n as f64).powi(degree as i32 + 1), "{end} for {wanted}");
                let balance = s.balance();
                assert!(balance.force.iter().chain(&balance.moment).all(|f| f.abs() <= 1e-11), "{balance:?}");
                // the energy is the work of the pressure
                let e = s.errors(&tube.field())[0].error;
                let work = 0.5 * p * 2.0 * PI * h * tube.u(1.0);
                assert!((work - s.energy() - 0.5 * e.energy.powi(2)).abs() <= 1e-9 * work, "{} of {work}, {:e}", s.energy(), e.energy);
                let at = s.at(a, &[1.25, 0.2]).unwrap();
                let (rr, tt) = (tube.c - tube.d / 1.5625, tube.c + tube.d / 1.5625);
                let off = [at.stress[0] - rr, at.stress[2] - tt, at.stress[1] - 2.0 * nu * tube.c].map(f64::abs);
                assert!(off.iter().all(|o| *o <= 2.0 / (n as f64).powi(degree as i32)), "{off:?}");
                [e.l2, e.h1, e.energy]
            };
            let (coarse, fine) = (solve(16), solve(32));
            let orders: Vec<f64> = (0..3).map(|k| (coarse[k] / fine[k]).log2()).collect();
            let p = degree as f64;
            assert!(orders[0] > p + 0.85 && orders[1] > p - 0.1 && orders[2] > p - 0.1, "fe {is_fe}, degree {degree}: {orders:?}");
        }
    }
}

/// Strains are uniform: exact to rounding, on the axis, too. The bottom alone holds the cylinder.
#[test]
fn a_cylinder_that_is_pulled_has_a_uniform_stress() {
    let (young, nu, radius, height, pull) = (200.0, 0.3, 2.0, 3.0, 5.0);
    let area = PI * radius * radius;
    for is_fe in [false, true] {
        for degree in 1..=3 {
            for by_force in [false, true] {
                let mut p = Problem::axisymmetric();
                let body = half_section(is_fe, degree, [0.0, 0.0], [radius, height], 3, 4);
                let a = add::<2>(&mut p, "a", body, Hooke::axisymmetric(young, nu).unwrap());
                p.fix(a.side("v0"), Components::Y).unwrap();
                let top = a.side("v1");
                // pressure on a disc: p pi R²
                let of = if by_force { p.force(top, 1, pull * area) } else { p.pressure(top, -pull) }.unwrap();
                p.name(of, "pull");
                near(p.measure(top).unwrap(), area, 1e-13);
                let mut system = p.assemble().unwrap();
                let body = system.contents().body(0);
                near(body.measure(), area * height, 1e-13);
                near(body.side_measure(&body.body().trace("u1").unwrap()), 2.0 * PI * radius * height, 1e-13);
                assert_eq!(system.contents().supports().map(|s| s.label.to_owned()).collect::<Vec<_>>(), ["a.v0"]);
                let s = system.solve(1.0, None).unwrap();
                near(s.loads()[0].resultant.force[1], pull * area, 1e-12);
                near(s.reaction(a.side("v0")).unwrap()[1], -pull * area, 1e-10);
                near(s.energy(), 0.5 * pull * pull / young * area * height, 1e-10);
                for x in [[0.0, 1.1], [0.0, 3.0], [0.7, 1.9], [2.0, 0.0], [1e-13, 2.0]] {
                    let at = s.at(a, &x).unwrap();
                    assert!(
                        (at.u[0] + nu * pull / young * x[0]).abs() <= 1e-12 && (at.u[1] - pull / young * x[1]).abs() <= 1e-12,
                        "{x:?}: {at:?}"
                    );
                    let wanted = [0.0, pull, 0.0, 0.0, 0.0, 0.0];
                    assert!(at.stress.iter().zip(&wanted).all(|(s, w)| (s - w).abs() <= 1e-8 * pull), "{x:?}: {at:?}");
                }
                assert!(s.balance().force.iter().all(|f| f.abs() <= 1e-9 * pull * area), "{:?}", s.balance());
            }
        }
    }
}

#[test]
fn what_bodies_of_revolution_cannot_be_is_refused() {
    let hooke = || Hooke::axisymmetric(1.0, 0.3).unwrap();
    let section = |min: [f64; 2]| half_section(false, 2, min, [2.0, 1.0], 2, 2);
    let mut p = Problem::axisymmetric();
    let a = add::<2>(&mut p, "a", section([0.0, 0.0]), hooke());
    // nothing turns and nothing moves sideways
    assert_eq!(p.assemble().unwrap_err().to_string(), "body \"a\" can still move: translation y");
    let plane = BodyMaterial::of::<2>(Hooke::plane_strain(1.0, 0.3).unwrap()).unwrap();
    let refused = p.add(BodySpec::new("b", section([0.0, 0.0]), plane)).unwrap_err();
    assert_eq!(refused.kind, RevolutionError::NoHoopStrain.into());
    let mut flat = Problem::<1, 2>::new();
    let around = BodyMaterial::of::<2>(hooke()).unwrap();
    let refused = flat.add(BodySpec::new("b", section([0.0, 0.0]), around)).unwrap_err();
    assert_eq!(refused.kind, RevolutionError::HoopStrain.into());
    p.fix(a.side("v0"), Components::Y).unwrap();
    // said again, what holds anyway is no mistake
    let mut again = p.clone();
    again.fix(a.side("u0"), Components::X).unwrap();
    let s = again.assemble().unwrap().solve(1.0, None).unwrap();
    assert_eq!(s.reaction(a.side("u0")).unwrap(), [0.0, 0.0]);
    let mut moved = p.clone();
    let of = moved.prescribe(a.side("u0"), 0, 0.1).unwrap();
    let errors = moved.assemble().unwrap_err();
    assert!(errors.0.iter().any(|e| e.kind == RevolutionError::OnAxis.into() && e.of == [of]), "{errors}");
    let mut loaded = p.clone();
    let of = loaded.force(a.side("u0"), 1, 1.0).unwrap();
    let errors = loaded.assemble().unwrap_err();
    assert!(errors.0.iter().any(|e| e.kind == RevolutionError::OnAxis.into() && e.of == [of]), "{errors}");
    let plate = HalfPlane::try_new(Vector::from([0.0, 1.0]), Vector::from([0.0, -1.0])).unwrap();
    let mut radial = p.clone();
    radial.contact(a.side("v1"), plate).unwrap().pressed(0, 1.0);
    assert!(radial.assemble().unwrap_err().0.iter().any(|e| e.kind == RevolutionError::RadialForce.into()));
    let mut dual = p.clone();
    dual.contact(a.side("v1"), plate).unwrap().multiplier(MultiplierKind::Dual);
    let errors = dual.assemble().unwrap_err();
    let revolution = InterfaceError::Multiplier { component: None, error: MultiplierError::Revolution };
    assert_eq!(errors.0[0].kind, ErrorKind::Interface { slave: 0, error: revolution }, "{errors}");
    let mut beyond = Problem::axisymmetric();
    let c = add::<2>(&mut beyond, "c", section([-0.5, 0.0]), hooke());
    beyond.fix(c.side("v0"), Components::Y).unwrap();
    let errors = beyond.assemble().unwrap_err();
    assert_eq!(errors.0[0].kind, RevolutionError::BeyondAxis { x: [-0.5, 0.0, 0.0] }.into());
}

/// u = ln r between r = 1, 0 there, and r = e, 1 there: the flux through every cylinder is 2 pi h.
#[test]
fn heat_flows_out_of_a_pipe_as_the_logarithm() {
    let h = 0.5;
    let log = || Known(|_, r: f64, _| (r.ln(), [1.0 / r, 0.0]));
    for is_fe in [false, true] {
        for degree in 1..=3 {
            let solve = |n: usize| {
                let mut p = Problem::axisymmetric();
                let body = half_section(is_fe, degree, [1.0, 0.0], [std::f64::consts::E, h], n, 1);
                let a = add::<1>(&mut p, "a", body, Conductor::try_new(1.0).unwrap());
                p.fix(a.side("u0"), Components::All).unwrap();
                p.prescribe(a.side("u1"), 0, 1.0).unwrap();
                let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                let (inner, outer) = (s.reaction(a.side("u0")).unwrap()[0], s.reaction(a.side("u1")).unwrap()[0]);
                near(inner, -outer, 1e-10);
                near(outer, 2.0 * s.energy(), 1e-10);
                let e = s.errors(&log())[0].error;
                assert!((2.0 * s.energy() - 2.0 * PI * h - e.energy.powi(2)).abs() <= 1e-9, "{} and {:e}", s.energy(), e.energy);
                [e.l2, e.h1]
            };
            let (coarse, fine) = (solve(16), solve(32));
            let p = degree as f64;
            let orders = [0, 1].map(|k| (coarse[k] / fine[k]).log2());
            assert!(orders[0] > p + 0.85 && orders[1] > p - 0.1, "fe {is_fe}, degree {degree}: {orders:?}");
        }
    }
}

/// The source of a manufactured solution is the divergence around the axis, with moduli that vary.
#[test]
fn manufactured_solutions_have_the_orders_of_their_elements_on_the_axis_too() {
    let exact = || Solved(|[r, z, _]: [Expr; 3]| [r * (0.3 + (z + 0.5 * r).sin()), (r * r).cos() * z.exp()]);
    for is_fe in [false, true] {
        for degree in 1..=3 {
            let solve = |n: usize| {
                let mut p = Problem::axisymmetric();
                let body = half_section(is_fe, degree, [0.0, 0.0], [1.0, 1.0], n, n);
                let young = |[r, z, _]: [Expr; 3]| 2.0 + 0.5 * r * z + (0.3 * z).exp();
                let a = add::<2>(&mut p, "a", body, elastic::<2>(young, 0.3, Assumption::Axisymmetric));
                p.exact(exact());
                for side in ["v0", "u1"] {
                    for c in 0..2 {
                        p.prescribe(a.side(side), c, Value::Exact).unwrap();
                    }
                }
                for c in 0..2 {
                    p.traction(a.side("v1"), c, Value::Exact).unwrap();
                }
                let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                let e = s.errors(&exact())[0].error;
                [e.l2, e.h1, e.energy]
            };
            let (coarse, fine) = (solve(6), solve(12));
            let p = degree as f64;
            let orders = [0, 1, 2].map(|k| (coarse[k] / fine[k]).log2());
            assert!(orders[0] > p + 0.8 && orders[1] > p - 0.15 && orders[2] > p - 0.15, "fe {is_fe}, degree {degree}: {orders:?}");
        }
    }
}

/// Two rings of radii 1, 1.5, 2 with two moduli under a pressure inside: the pressure between them makes their displacements there equal.
fn rings(p: f64, interference: f64) -> ([Tube; 2], f64) {
    let (soft, hard) = (1.0, 3.0);
    let make = |q: f64| [Tube::new(soft, 0.3, [1.0, 1.5], [p, q]), Tube::new(hard, 0.25, [1.5, 2.0], [q, 0.0])];
    // linear in q
    let apart = |q: f64| make(q)[1].u(1.5) - make(q)[0].u(1.5) - interference;
    let q = -apart(0.0) / (apart(1.0) - apart(0.0));
    (make(q), q)
}

/// The rings as a problem: ends held along the axis, n elements across each, numbers of elements along that do not match.
fn ring_problem(is_fe: bool, degree: usize, n: usize, p: f64) -> (Problem<1, 2>, [BodyId; 2]) {
    let mut problem = Problem::axisymmetric();
    let h = 0.6;
    let inner = half_section(is_fe, degree, [1.0, 0.0], [1.5, h], n, 3 * n / 2);
    let outer = half_section(is_fe, degree, [1.5, 0.0], [2.0, h], n, n);
    let a = add::<2>(&mut problem, "inner", inner, Hooke::axisymmetric(1.0, 0.3).unwrap());
    let b = add::<2>(&mut problem, "outer", outer, Hooke::axisymmetric(3.0, 0.25).unwrap());
    for body in [a, b] {
        problem.fix(body.side("v0"), Components::Y).unwrap();
        problem.fix(body.side("v1"), Components::Y).unwrap();
    }
    if p > 0.0 {
        problem.pressure(a.side("u0"), p).unwrap();
    }
    (problem, [a, b])
}

#[test]
fn tied_rings_of_two_moduli_carry_the_pressure_of_lame() {
    let (tubes, q) = rings(1.0, 0.0);
    let area = 2.0 * PI * 1.5 * 0.6;
    for is_fe in [false, true] {
        for degree in 2..=3 {
            for coupling in ["mortar", "penalty", "nitsche"] {
                let solve = |n: usize| {
                    let (mut p, bodies) = ring_problem(is_fe, degree, n, 1.0);
                    let tie = p.tie(bodies[0].side("u1"), bodies[1].side("u0")).unwrap();
                    match coupling {
                        "penalty" => drop(tie.coupling(Penalty::default())),
                        "nitsche" => drop(tie.coupling(Nitsche::default())),
                        _ => {}
                    }
                    let tie = tie.exact(vec![q.into(), 0.0.into()]).id();
                    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                    let result = s.tie(tie).unwrap();
                    near(result.area, area, 1e-12);
                    near(result.force[0].abs(), q * area, 0.3 / (n as f64).powi(2));
                    assert!(result.force[1].abs() <= 1e-3 * q * area && result.moment == [0.0; 3], "{result:?}");
                    let found = s.errors(&tubes[0].field())[0].error.l2.hypot(s.errors(&tubes[1].field())[1].error.l2);
                    let lambda = s.lambda_error(tie).unwrap();
                    [found, (lambda.error / lambda.exact).sqrt()]
                };
                let (coarse, fine) = (solve(4), solve(8));
                let orders = [0, 1].map(|k| (coarse[k] / fine[k]).log2());
                let least = if coupling == "penalty" { 0.0 } else { 0.1 };
                assert!(orders[0] > degree as f64 + 0.8 - least, "fe {is_fe}, degree {degree}, {coupling}: {orders:?} {coarse:?} {fine:?}");
                assert!(orders[1] > degree as f64 - 0.8 && fine[1] < 1e-2, "fe {is_fe}, degree {degree}, {coupling}: {orders:?} {fine:?}");
            }
        }
    }
}

#[test]
fn a_shrink_fit_has_the_pressure_of_lame() {
    let interference = 0.01;
    let (tubes, q) = rings(0.0, interference);
    let area = 2.0 * PI * 1.5 * 0.6;
    for is_fe in [false, true] {
        for method in ["lagrange", "penalty", "augmented", "nitsche"] {
            let (mut p, bodies) = ring_problem(is_fe, 2, 8, 0.0);
            let contact = p.contact(bodies[0].side("u1"), bodies[1].side("u0")).unwrap().gap(Data::of_gap(move |_, _, g| g - interference));
            match method {
                "penalty" => drop(contact.method(Penalty { factor: 1e6 })),
                "augmented" => drop(contact.method(Augmented::default())),
                "nitsche" => drop(contact.method(Nitsche::default())),
                _ => drop(contact.method(Lagrange)),
            }
            let contact = contact.id();
            let s = p.assemble().unwrap().solve(1.0, None).unwrap();
            let result = s.contact(contact).unwrap();
            near(result.area, area, 1e-12);
            near(result.force[0].abs(), q * area, 2e-4);
            near(result.largest_pressure, q, 2e-3);
            near(result.least_pressure, q, 2e-3);
            assert!(result.moment == [0.0; 3] && result.balance <= 1e-9, "{result:?}");
            for (k, r) in [(0, 1.0), (0, 1.5), (1, 1.5), (1, 2.0)] {
                let found = s.at(bodies[k], &[r, 0.2]).unwrap().u[0];
                near(found, tubes[k].u(r), 1e-3);
            }
        }
    }
}

/// A body in a medium that carries its weight: the springs of the volume are those of the full circle.
#[test]
fn foundations_act_on_the_whole_volume() {
    let mut p = Problem::axisymmetric();
    let a = add::<2>(&mut p, "a", half_section(true, 2, [0.0, 0.0], [2.0, 1.0], 3, 2), Hooke::axisymmetric(1e4, 0.3).unwrap());
    p.foundation(a, 1, 1e2).unwrap();
    p.gravity(a, 2.0, [0.0, -10.0]).unwrap();
    let s = p.assemble().unwrap().solve(1.0, None).unwrap();
    near(s.loads()[0].resultant.force[1], -20.0 * 4.0 * PI, 1e-12);
    near(s.at(a, &[0.0, 0.4]).unwrap().u[1], -0.2, 1e-10);
    near(s.energy(), 0.5 * 1e2 * 0.04 * 4.0 * PI, 1e-10);
    assert!(s.balance().force[1].abs() <= 1e-9);
}

/// A half space of radius and depth 40 a, graded towards the circle r = a on its surface, pressed there.
fn half_space(is_fe: bool, degree: usize, radius: f64) -> Arc<dyn Body<1, 2>> {
    let size = 40.0 * radius;
    // even elements up to 1.5 a, then growing ones
    let mut lines: Vec<f64> = (0..=12).map(|k| f64::from(k) * 0.125).collect();
    while let Some(&last) = lines.last().filter(|l| **l < 40.0) {
        let next = last + 0.35 * (last - 1.1);
        lines.push(if next > 34.0 { 40.0 } else { next });
    }
    let across: Vec<f64> = lines.iter().map(|l| l / 40.0).collect();
    let down: Vec<f64> = lines.iter().rev().map(|l| 1.0 - l / 40.0).collect();
    let net = rectangle([0.0, -size], [size, 0.0]).unwrap();
    let spec = PatchSpec { degree: [degree; 2], breakpoints: [across, down], ..PatchSpec::new(net) };
    if is_fe { Arc::new(Mesh::from_patch(&spec).unwrap()) } else { Arc::new(Patch::try_new(&spec).unwrap()) }
}

/// A pressure q on a circle of radius a of a half space. Timoshenko, Goodier, Theory of Elasticity, 3rd ed. (1970), art. 139: on the axis at the
/// depth z, with s = z / sqrt(a² + z²),
///
///   sigma_zz = -q (1 - s³),   sigma_rr = sigma_tt = -q/2 (1 + 2 nu - 2 (1 + nu) s + s³),
///
/// and the centre sinks by 2 (1 - nu²) q a / E.
#[test]
fn a_pressure_on_a_circle_has_the_stresses_of_boussinesq() {
    let (young, nu, q, a): (f64, f64, f64, f64) = (1000.0, 0.3, 2.0, 0.5);
    for is_fe in [false, true] {
        let mut p = Problem::axisymmetric();
        let body = add::<2>(&mut p, "ground", half_space(is_fe, 3, a), Hooke::axisymmetric(young, nu).unwrap());
        let circle = p.part(body.side("v1"), "x < a", &|x| x[0] < a).unwrap().unwrap();
        p.fix(body.side("v0"), Components::Y).unwrap();
        let of = p.pressure(circle, q).unwrap();
        let s = p.assemble().unwrap().solve(1.0, None).unwrap();
        let load = s.loads().iter().find(|l| l.of == of).unwrap();
        near(load.resultant.force[1], -q * PI * a * a, 1e-12);
        for z in [0.5 * a, a, 2.0 * a] {
            let at = s.at(body, &[0.0, -z]).unwrap().stress;
            let s = z / a.hypot(z);
            let wanted = [-0.5 * q * (1.0 + 2.0 * nu - 2.0 * (1.0 + nu) * s + s.powi(3)), -q * (1.0 - s.powi(3))];
            // the half space ends at 40 a
            let off = [at[0] - wanted[0], at[2] - wanted[0], at[1] - wanted[1], at[3]].map(f64::abs);
            assert!(off.iter().all(|o| *o <= 3e-3 * q), "fe {is_fe}, z = {z}: {at:?}, wanted {wanted:?}");
        }
        let [centre, rim] = [0.0, a].map(|r| -s.at(body, &[r, 0.0]).unwrap().u[1]);
        // the rim sinks by 2/pi of that: the difference does not see where the half space ends
        let sunk = 2.0 * (1.0 - nu * nu) * q * a / young;
        assert!(((centre - rim) / sunk - (1.0 - 2.0 / PI)).abs() <= 3e-3, "{centre} and {rim} of {sunk}");
    }
}

/// A sphere that is pressed into a half space: Hertz, a³ = 3 F R / (4 E*), p0 = 3 F / (2 pi a²). Johnson, Contact Mechanics (1985), ch. 4.
#[test]
fn a_sphere_on_a_half_space_has_the_pressure_of_hertz() {
    let (young, nu): (f64, f64) = (1000.0, 0.3);
    let (radius, a) = (50.0, 0.5);
    let modulus = young / (1.0 - nu * nu);
    let force = 4.0 * modulus * f64::powi(a, 3) / (3.0 * radius);
    let p0 = 3.0 * force / (2.0 * PI * a * a);
    for (is_fe, degree) in [(false, 2), (true, 2)] {
        let mut p = Problem::axisymmetric();
        let body = add::<2>(&mut p, "ground", half_space(is_fe, degree, a), Hooke::axisymmetric(young, nu).unwrap());
        p.fix(body.side("v0"), Components::Y).unwrap();
        let ball = Sphere { center: Vector::from([0.0, radius]), radius, inside: false };
        let contact = p.contact(body.side("v1"), ball).unwrap().pressed(1, -force).id();
        let s = p.assemble().unwrap().solve(1.0, None).unwrap();
        let result = s.contact(contact).unwrap();
        near(result.force[1].abs(), force, 1e-8);
        near(result.largest_pressure, p0, 0.02);
        // pi a², to the element at its rim, of which there are eight in a
        near(result.area, PI * a * a, 0.3);
        let lambda = s.lambda(contact, 0).unwrap().unwrap();
        let at = |r: f64| {
            let side = s.contents().body(0).body().trace("v1").unwrap();
            let mut map = MapTable::new();
            let end = |e: usize, xi: f64, map: &mut MapTable<1, 2>| {
                side.space.map(e, &[Vector::<1>::new(xi)], Order::Values, map);
                map.x[0][0]
            };
            let e = (0..side.space.num_elements()).find(|&e| end(e, 0.0, &mut map) <= r && r <= end(e, 1.0, &mut map)).unwrap();
            let [r0, r1] = [0.0, 1.0].map(|xi| end(e, xi, &mut map));
            -lambda.at(e, &[Vector::<1>::new((r - r0) / (r1 - r0))])[0][0]
        };
        // in the middles of elements, where constants are as good as they get
        for k in 0..7 {
            let r = (f64::from(k) + 0.5) * 0.125 * a;
            let wanted = p0 * (1.0 - (r / a).powi(2)).sqrt();
            assert!((at(r) - wanted).abs() <= 0.03 * p0, "fe {is_fe}, r = {r}: {} for {wanted}", at(r));
        }
    }
}
