//! Foundations and reaction terms by `Problem`, against solutions in closed form.

use faying::geometry::shapes::rectangle;
use faying::physics::{Conductor, Hooke};
use faying::problem::{BodyMaterial, BodySpec, Components, Data, Derivatives, ErrorKind, Exact, Point, Problem, Value};
use faying::space::{Body, Mesh, Patch, PatchSpec};
use std::sync::Arc;

/// A rectangle [0, 1] x [0, `height`] of n x m elements, splines or Lagrange elements.
fn body(is_fe: bool, degree: usize, height: f64, n: usize, m: usize) -> Arc<dyn Body<1, 2>> {
    let lines = |k: usize| (0..=k).map(|i| i as f64 / k as f64).collect::<Vec<f64>>();
    let net = rectangle([0.0; 2], [1.0, height]).unwrap();
    let spec = PatchSpec { degree: [degree; 2], breakpoints: [lines(n), lines(m)], ..PatchSpec::new(net) };
    if is_fe { Arc::new(Mesh::from_patch(&spec).unwrap()) } else { Arc::new(Patch::try_new(&spec).unwrap()) }
}

/// cosh(m x) / cosh(m) in one coordinate and component, zero in others.
#[derive(Clone, Copy, Debug)]
struct Cosh {
    m: f64,
    axis: usize,
    component: usize,
    factor: f64,
}

impl Exact for Cosh {
    fn value(&self, component: usize, at: &Point) -> f64 {
        self.slope(component, at).value
    }
    fn slope(&self, component: usize, at: &Point) -> Derivatives {
        let mut out = Derivatives::default();
        if component == self.component {
            let a = self.m * at.x[self.axis];
            out.value = self.factor * a.cosh();
            out.gradient[self.axis] = self.factor * self.m * a.sinh();
        }
        out
    }
    fn derivatives(&self, component: usize, at: &Point) -> Derivatives {
        self.slope(component, at)
    }
}

/// Errors in L2, in the H1 semi-norm and in the energy of a problem per refinement.
fn orders(solve: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
    let (coarse, fine) = (solve(8), solve(16));
    std::array::from_fn(|k| (coarse[k] / fine[k]).log2())
}

/// -u'' + c u = 0 with u(1) = 1 and no flux at x = 0: u = cosh(m x) / cosh(m), m² = c.
#[test]
fn a_reaction_term_has_the_orders_of_its_elements() {
    let m: f64 = 3.0;
    for is_fe in [false, true] {
        for degree in 1..=3 {
            let solve = |n: usize| {
                let mut p = Problem::<1, 2>::new();
                let material = BodyMaterial::of::<1>(Conductor::try_new(1.0).unwrap()).unwrap();
                // points enough for the norm of the error
                let spec = BodySpec { extra_points: 4, ..BodySpec::new("a", body(is_fe, degree, 0.25, n, 2), material) };
                let a = p.add(spec).unwrap();
                // 9 in two parts, one of them a function
                p.foundation(a, 0, 5.0).unwrap();
                p.foundation(a, 0, Data::of(|_, _| 4.0)).unwrap();
                p.prescribe(a.side("u1"), 0, 1.0).unwrap();
                let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                let exact = Cosh { m, axis: 0, component: 0, factor: 1.0 / m.cosh() };
                let e = s.errors(&exact)[0];
                // 2 x energy: the flux through x = 1 times u = 1; the energy of the error is the error of the energy
                let work = 0.25 * m * m.tanh();
                let missed = 2.0 * s.energy() - work;
                assert!((missed - e.error.energy.powi(2)).abs() <= 1e-10 * work, "{missed:e} for {:e}", e.error.energy.powi(2));
                // the flux out of the body, what u consumes, comes in through the support
                assert!((s.reaction(a.side("u1")).unwrap()[0] - 2.0 * s.energy()).abs() <= 1e-12);
                assert!(s.balance().force[0].abs() <= 1e-12, "{:?}", s.balance());
                [e.error.l2, e.error.h1, e.error.energy]
            };
            let [l2, h1, energy] = orders(solve);
            let p = degree as f64;
            assert!(l2 > p + 0.85 && h1 > p - 0.15 && energy > p - 0.15, "fe {is_fe}, degree {degree}: {l2} {h1} {energy}");
        }
    }
}

/// Without a transverse strain, E u'' = k u under a pressure at the top: u_y = -p cosh(m y) / (E m sinh(m H)), m² = k / E.
#[test]
fn a_column_in_an_elastic_medium_has_the_orders_of_its_elements() {
    let (young, stiffness, pressure, height) = (100.0, 900.0, 7.0, 0.5);
    let m = f64::sqrt(stiffness / young);
    let exact = Cosh { m, axis: 1, component: 1, factor: -pressure / (young * m * (m * height).sinh()) };
    for is_fe in [false, true] {
        for degree in 1..=3 {
            let solve = |n: usize| {
                let mut p = Problem::<1, 2>::new();
                let material = BodyMaterial::of::<2>(Hooke::plane_strain(young, 0.0).unwrap()).unwrap();
                let a = p.add(BodySpec::new("a", body(is_fe, degree, height, 2, n), material)).unwrap();
                p.foundation(a, 1, stiffness).unwrap();
                p.fix(a.side("u0"), Components::X).unwrap();
                p.pressure(a.side("v1"), pressure).unwrap();
                let s = p.assemble().unwrap().solve(1.0, None).unwrap();
                // the medium carries the whole load
                assert!(s.balance().force.iter().all(|f| f.abs() <= 1e-10 * pressure), "{:?}", s.balance());
                let e = s.errors(&exact)[0].error;
                [e.l2, e.h1, e.energy]
            };
            let [l2, h1, energy] = orders(solve);
            let p = degree as f64;
            assert!(l2 > p + 0.85 && h1 > p - 0.15 && energy > p - 0.15, "fe {is_fe}, degree {degree}: {l2} {h1} {energy}");
        }
    }
}

/// A uniform force moves a block on a uniform foundation as a rigid body, u = f / k; it is held by nothing else.
#[test]
fn a_block_on_a_foundation_is_held_by_it() {
    for is_fe in [false, true] {
        let problem = |components: &[usize]| {
            let mut p = Problem::<1, 2>::new();
            let material = BodyMaterial::of::<2>(Hooke::plane_strain(2e5, 0.3).unwrap()).unwrap();
            let a = p.add(BodySpec::new("a", body(is_fe, 2, 0.5, 3, 2), material)).unwrap();
            for &c in components {
                p.foundation(a, c, if c == 0 { 1e3 } else { 4e3 }).unwrap();
            }
            p.source(a, vec![2.0.into(), (-3.0).into()]).unwrap();
            (p, a)
        };
        let (p, a) = problem(&[0, 1]);
        let s = p.assemble().unwrap().solve(1.0, None).unwrap();
        let at = s.at(a, &[0.37, 0.21]).unwrap();
        assert!((at.u[0] - 2e-3).abs() <= 1e-13 && (at.u[1] + 0.75e-3).abs() <= 1e-13, "{:?}", at.u);
        assert!(at.stress.iter().all(|v| v.abs() <= 1e-8), "{:?}", at.stress);
        // rounding of a stiffness of 2e5 times 1e-3
        assert!(s.balance().force.iter().chain(&s.balance().moment).all(|f| f.abs() <= 1e-11), "{:?}", s.balance());
        // 1/2 (k_x u_x² + k_y u_y²) times the volume
        assert!((s.energy() / (0.25 * (1e3 * 4e-6 + 4e3 * 0.5625e-6)) - 1.0).abs() <= 1e-11, "{}", s.energy());
        // along one component alone it leaves the translation along the other
        let (p, _) = problem(&[1]);
        let errors = p.assemble().unwrap_err();
        assert_eq!(errors.to_string(), "body \"a\" can still move: translation x");
    }
}

#[test]
fn foundations_follow_the_time_and_are_refused_where_they_make_no_sense() {
    let mut p = Problem::<1, 2>::new();
    let material = BodyMaterial::of::<2>(Hooke::plane_strain(2e5, 0.3).unwrap()).unwrap();
    let a = p.add(BodySpec::new("a", body(false, 2, 0.5, 3, 2), material)).unwrap();
    p.times(&[1.0, 2.0]);
    p.foundation(a, 0, 10.0).unwrap();
    let of = p.foundation(a, 1, Data::of(|_, t| 1e3 * t)).unwrap();
    p.source(a, vec![0.0.into(), (-3.0).into()]).unwrap();
    let mut system = p.assemble().unwrap();
    for t in [1.0, 2.0] {
        let s = system.solve(t, None).unwrap();
        assert!((s.at(a, &[0.5, 0.25]).unwrap().u[1] + 3e-3 / t).abs() <= 1e-13);
        assert!(s.balance().force[1].abs() <= 1e-12);
    }
    // no support where the stiffness vanishes
    let mut none = p.clone();
    none.times(&[0.0, 1.0]);
    assert_eq!(none.assemble().unwrap_err().to_string(), "body \"a\" can still move: translation y");
    let mut negative = p.clone();
    let wrong = negative.foundation(a, 1, Data::of(|x, _| x[0] - 0.5)).unwrap();
    let errors = negative.assemble().unwrap_err();
    assert!(matches!(errors.0[0].kind, ErrorKind::Negative { .. }) && errors.0[0].of[0] == wrong, "{errors}");
    assert!(matches!(p.foundation(a, 2, 1.0).unwrap_err().kind, ErrorKind::NoComponent { component: 2, components: 2 }));
    p.exact(Cosh { m: 1.0, axis: 0, component: 0, factor: 1.0 });
    p.prescribe(a.side("u0"), 0, Value::Exact).unwrap();
    let errors = p.assemble().unwrap_err();
    assert!(errors.0.iter().any(|e| e.kind == ErrorKind::FoundationBesideExact && e.of == [of]), "{errors}");
}
