//! Observed orders of one body on both backends, and published numbers of rings and plates.

use crate::common::bulk;
use bulk::{Jet2, Problem};
use faying::assembly::{Errors, gauss_rules, load};
use faying::basis::{BSpline, Cell};
use faying::geometry::{ControlNet, shapes};
use faying::linalg::{Matrix, Vector};
use faying::physics::{Assumption, Conductor, Elastic, Hooke, Jet, Material, pressure, stress_at};
use faying::space::{BasisKind, Body, Mapping, Mesh, Patch, PatchSpec, SpecError, locate};

/// Observed orders may be this much below theory.
const BELOW: f64 = 0.1;

/// Value, first and second derivative of a function of one variable.
type Line = [f64; 3];

/// X(x) Y(y) with its derivatives.
fn product(a: Line, b: Line) -> (f64, [f64; 2], Matrix<2, 2>) {
    (a[0] * b[0], [a[1] * b[0], a[0] * b[1]], Matrix::<2, 2>::new(a[2] * b[0], a[1] * b[1], a[1] * b[1], a[0] * b[2]))
}

fn sine(k: f64, shift: f64, x: f64) -> Line {
    let (s, c) = (k * x + shift).sin_cos();
    [s, k * c, -k * k * s]
}

fn exponential(k: f64, x: f64) -> Line {
    let e = (k * x).exp();
    [e, k * e, k * k * e]
}

/// u = (sin(2.3 x + 0.4) e^(y/2), sin(1.7 x) sin(2.1 y + 0.3)).
fn smooth<const C: usize>(x: &Vector<2>) -> Jet2<C, 2> {
    let parts = [product(sine(2.3, 0.4, x[0]), exponential(0.5, x[1])), product(sine(1.7, 0.0, x[0]), sine(2.1, 0.3, x[1]))];
    (Vector::from_fn(|c, _| parts[c].0), Matrix::from_fn(|c, j| parts[c].1[j]), std::array::from_fn(|c| parts[c].2))
}

/// A biquadratic map with bent sides.
fn bent() -> ControlNet<2, 2> {
    let bend = |i: usize, j: usize| Vector::<2>::new(0.06 * ((3 * i + 2 * j) as f64).sin(), 0.06 * ((2 * i + 5 * j) as f64).cos());
    let points = (0..9).map(|k| (k % 3, k / 3)).map(|(i, j)| Vector::<2>::new(i as f64 / 2.0, j as f64 / 2.0) + bend(i, j)).collect();
    ControlNet::try_new([BSpline::uniform(2, 1, 1), BSpline::uniform(2, 1, 1)], points, None).unwrap()
}

fn ring() -> ControlNet<2, 2> {
    shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap()
}

/// A way to make a body of a spec.
type Make = fn(&PatchSpec<2>) -> Box<dyn Body<1, 2>>;

fn iga(spec: &PatchSpec<2>) -> Box<dyn Body<1, 2>> {
    Box::new(Patch::<1, 2>::try_new(spec).unwrap())
}

fn fe(spec: &PatchSpec<2>) -> Box<dyn Body<1, 2>> {
    Box::new(Mesh::<1, 2>::from_patch(spec).unwrap())
}

/// Orders between the two finest of three grids: L2 at least p + 1, H1 at least p.
fn orders<const C: usize>(name: &str, degree: usize, spec: &PatchSpec<2>, make: Make, material: &dyn Material<C, 2>) {
    let coarsest = if degree <= 2 { 8 } else { 4 };
    let errors: Vec<Errors> = [coarsest, 2 * coarsest, 4 * coarsest]
        .map(|n| {
            let body = make(&spec.clone().with_degree([degree; 2]).with_elements([n, n]));
            Problem::new(material, &smooth::<C>).held_on(&*body, &["u0", "v1"]).solve(&*body).errors
        })
        .to_vec();
    let order = |a: f64, b: f64| (a / b).log2();
    let l2 = order(errors[1].error.l2, errors[2].error.l2);
    let h1 = order(errors[1].error.h1, errors[2].error.h1);
    let energy = order(errors[1].error.energy, errors[2].error.energy);
    println!("{name} p = {degree}: L2 {:.2e} order {l2:.2}, H1 order {h1:.2}, energy order {energy:.2}", errors[2].error.l2);
    let p = degree as f64;
    assert!(l2 > p + 1.0 - BELOW, "{name}, p = {degree}: order {l2} in L2");
    assert!(h1 > p - BELOW && energy > p - BELOW, "{name}, p = {degree}: orders {h1} in H1, {energy} in the energy");
}

#[test]
fn orders_are_p_plus_1_in_l2_and_p_in_h1_on_a_bent_square() {
    let steel = Hooke::<2>::plane_strain(1.0, 0.3).unwrap();
    // a conductivity that varies: its gradient enters the source
    let conductor = Conductor::varying(|x: &Vector<2>| Jet::new(2.0 + x[0] * x[1], Vector::<2>::new(x[1], x[0])));
    let spec = PatchSpec::new(bent());
    for degree in [1, 2, 3, 4] {
        // splines of degree 1 do not hold the map but converge on it
        orders("splines", degree, &spec, iga, &steel);
        orders("splines, k(x)", degree, &spec, iga, &conductor);
        orders("C0 splines", degree, &spec.clone().with_continuity(0), iga, &conductor);
        for mapping in [Mapping::Isoparametric, Mapping::Exact] {
            let spec = spec.clone().with_mapping(mapping);
            orders(&format!("quadrilaterals {mapping:?}"), degree, &spec, fe, &steel);
            orders(&format!("triangles {mapping:?}"), degree, &spec.clone().with_cells(Cell::Simplex), fe, &conductor);
        }
    }
}

#[test]
fn orders_hold_on_the_ring_for_all_functions_and_maps() {
    let steel = Hooke::varying(
        |x: &Vector<2>| Elastic::Young {
            young: Jet::new(1.0 + 0.3 * x[0], Vector::<2>::new(0.3, 0.0)),
            poisson: Jet::new(0.2 + 0.1 * x[1], Vector::<2>::new(0.0, 0.1)),
        },
        Assumption::PlaneStress,
    );
    let conductor = Conductor::<2>::try_new(1.0).unwrap();
    let spec = PatchSpec::new(ring());
    for degree in [1, 2, 3, 4] {
        orders("ring, B-splines", degree, &spec.clone().with_basis(BasisKind::BSpline), iga, &steel);
        let nurbs = spec.clone().with_basis(BasisKind::Nurbs).with_degree([degree; 2]);
        if degree == 1 {
            assert!(matches!(Patch::<1, 2>::try_new(&nurbs), Err(SpecError::DegreeTooLow { .. })));
        } else {
            orders("ring, NURBS", degree, &nurbs, iga, &conductor);
        }
        for mapping in [Mapping::Isoparametric, Mapping::Exact] {
            let spec = spec.clone().with_mapping(mapping);
            orders(&format!("ring, quadrilaterals {mapping:?}"), degree, &spec, fe, &conductor);
            orders(&format!("ring, triangles {mapping:?}"), degree, &spec.clone().with_cells(Cell::Simplex), fe, &steel);
        }
    }
}

/// u = f(r) x, f = a + b / r²: the field of a ring under pressure, without body force.
fn radial(a: f64, b: f64) -> impl Fn(&Vector<2>) -> Jet2<2, 2> + Sync {
    move |x| {
        let r2 = x.norm_squared();
        let f = a + b / r2;
        (x * f, Matrix::<2, 2>::identity() * f - x * x.transpose() * (2.0 * b / (r2 * r2)), [Matrix::zeros(); 2])
    }
}

/// The quarter ring with symmetric straight sides and pressure 1 inside.
fn pressed<'a>(material: &'a Hooke<2>, exact: bulk::Exact<'a, 2, 2>, push: bulk::SideLoad<'a, 2, 2>) -> Problem<'a, 2, 2> {
    let mut problem = Problem::new(material as &dyn Material<2, 2>, exact);
    problem.fixed = vec![("u0".into(), 1), ("u1".into(), 0)];
    problem.loaded = vec![("v0".into(), push)];
    problem
}

#[test]
fn the_quarter_ring_has_the_l2_error_published_by_geopdes() {
    // GeoPDEs: E = 1, nu = 0, cubic C2 NURBS, 9 x 9 elements, 4 x 4 points also in the norm; u_r = (r + 4 / r) / 3
    let material = Hooke::<2>::plane_strain(1.0, 0.0).unwrap();
    let (exact, push) = (radial(1.0 / 3.0, 4.0 / 3.0), pressure(|_: &Vector<2>| 1.0));
    let body = iga(&PatchSpec::new(ring()).with_degree([3, 3]).with_elements([9, 9]).with_basis(BasisKind::Nurbs));
    let mut problem = pressed(&material, &exact, &push);
    problem.extra_norm = 0;
    let error = problem.solve(&*body).errors.error.l2;
    println!("GeoPDEs ring: L2 error {error:.15e}, published 1.53640513551293e-06, difference {:.1e}", error - 1.53640513551293e-06);
    assert!((error - 1.53640513551293e-06).abs() < 1e-12, "{error:e}");
    // 10 x 10 points in the norm: 1.5931e-06
    problem.extra_norm = 6;
    let error = problem.solve(&*body).errors.error.l2;
    assert!((error - 1.5931e-06).abs() < 5e-11, "{error:e}");
}

/// All four ways to put functions on a geometry.
fn four_bodies(net: &ControlNet<2, 2>, degree: usize, elements: [usize; 2]) -> Vec<(&'static str, Box<dyn Body<1, 2>>)> {
    let spec = PatchSpec::new(net.clone()).with_degree([degree; 2]).with_elements(elements);
    vec![
        ("NURBS", iga(&spec.clone().with_basis(BasisKind::Nurbs))),
        ("B-splines", iga(&spec.clone().with_basis(BasisKind::BSpline))),
        ("quadrilaterals", fe(&spec)),
        ("triangles", fe(&spec.with_cells(Cell::Simplex))),
    ]
}

#[test]
fn the_ring_of_lame_has_its_displacements_and_pressure() {
    // a = 1, b = 2, p = 1 inside, E = 1, nu = 0.3, plane strain: u_r = 1.3 / 3 (0.4 r + 4 / r)
    let material = Hooke::<2>::plane_strain(1.0, 0.3).unwrap();
    let (exact, push) = (radial(1.3 / 3.0 * 0.4, 1.3 / 3.0 * 4.0), pressure(|_: &Vector<2>| 1.0));
    for (name, body) in four_bodies(&ring(), 3, [24, 12]) {
        let solved = pressed(&material, &exact, &push).solve(&*body);
        let at = |radius: f64| {
            // on the ray of 45 degrees, where sigma_r = (xx + yy) / 2 + xy
            let x = Vector::<2>::repeat(radius / 2f64.sqrt());
            let (element, xi) = locate(&**body.space(), &x).unwrap();
            let s = stress_at::<2, 2, _, _, _>(&**body.space(), &material, &solved.u, element, &[xi])[0];
            (s.value.norm(), 0.5 * (s.stress[(0, 0)] + s.stress[(1, 1)]) + s.stress[(0, 1)])
        };
        let (inner, outer, middle) = (at(1.0).0, at(2.0).0, at(1.5).1);
        println!("Lame ring, {name}: u_r(1) = {inner:.7}, u_r(2) = {outer:.7}, pressure at 1.5 = {:.7}", -middle);
        assert!((inner - 1.906_667).abs() < 2e-6 && (outer - 1.213_333).abs() < 2e-6, "{name}: {inner} {outer}");
        assert!((middle + 7.0 / 27.0).abs() < 2e-4, "{name}: {middle}");
        assert!(solved.errors.error.energy < 1e-3 * solved.errors.exact.energy, "{name}");
    }
}

/// The stress of the plate of Kirsch, hole of radius `a`, tension `t` along x.
fn kirsch(a: f64, t: f64, x: &Vector<2>) -> Matrix<2, 2> {
    let (r2, theta) = (x.norm_squared(), x[1].atan2(x[0]));
    let (q, h) = (a * a / r2, t / 2.0);
    let (s2, c2) = (2.0 * theta).sin_cos();
    let rr = h * (1.0 - q) + h * (1.0 - 4.0 * q + 3.0 * q * q) * c2;
    let tt = h * (1.0 + q) - h * (1.0 + 3.0 * q * q) * c2;
    let rt = -h * (1.0 + 2.0 * q - 3.0 * q * q) * s2;
    let (s, c) = theta.sin_cos();
    let turn = Matrix::<2, 2>::new(c, -s, s, c);
    turn * Matrix::<2, 2>::new(rr, rt, rt, tt) * turn.transpose()
}

#[test]
fn the_plate_of_kirsch_has_its_stresses_at_the_hole_within_one_percent() {
    // R = 1, L = 4, T = 10, E = 1e5, nu = 0.3: sigma_xx = 30 on top of the hole, sigma_yy = -10 beside it
    let net = shapes::plate_with_hole(1.0, 4.0).unwrap();
    let material = Hooke::<2>::plane_stress(1e5, 0.3).unwrap();
    let rest = |_: &Vector<2>| (Vector::<2>::zeros(), Matrix::<2, 2>::zeros(), [Matrix::<2, 2>::zeros(); 2]);
    let pull = |x: &Vector<2>, n: &Vector<2>| kirsch(1.0, 10.0, x) * n;
    for (name, body) in four_bodies(&net, 3, [16, 16]) {
        let mut problem = Problem::new(&material, &rest);
        problem.fixed = vec![("u0".into(), 1), ("u1".into(), 0)];
        problem.loaded = vec![("v1".into(), &pull)];
        let solved = problem.solve(&*body);
        let at = |x: Vector<2>| {
            let (element, xi) = locate(&**body.space(), &x).unwrap();
            stress_at::<2, 2, _, _, _>(&**body.space(), &material, &solved.u, element, &[xi])[0].stress
        };
        let (top, beside) = (at(Vector::<2>::new(0.0, 1.0))[(0, 0)], at(Vector::<2>::new(1.0, 0.0))[(1, 1)]);
        println!("Kirsch, {name}: sigma_xx(0, 1) = {top:.4}, sigma_yy(1, 0) = {beside:.4}");
        assert!((top - 30.0).abs() < 0.3 && (beside + 10.0).abs() < 0.1, "{name}: {top} {beside}");
    }
}

/// The displacement of the plate of Kirsch in plane stress, and its gradient.
fn kirsch_field(a: f64, t: f64, young: f64, nu: f64, x: &Vector<2>) -> Jet2<2, 2> {
    // the gradient follows from the stress and the rotation; differences of the closed form give both to 1e-10
    let (mu, k) = (young / (2.0 * (1.0 + nu)), (3.0 - nu) / (1.0 + nu));
    let value = |x: &Vector<2>| {
        let (r, theta) = (x.norm(), x[1].atan2(x[0]));
        let (c1, s1, c3, s3) = (theta.cos(), theta.sin(), (3.0 * theta).cos(), (3.0 * theta).sin());
        let f = t * a / (8.0 * mu);
        Vector::<2>::new(
            f * (r / a * (k + 1.0) * c1 + 2.0 * a / r * ((1.0 + k) * c1 + c3) - 2.0 * (a / r).powi(3) * c3),
            f * (r / a * (k - 3.0) * s1 + 2.0 * a / r * ((1.0 - k) * s1 + s3) - 2.0 * (a / r).powi(3) * s3),
        )
    };
    let h = 1e-3;
    let gradient = Matrix::<2, 2>::from_fn(|i, j| {
        let at = |s: f64| {
            let mut y = *x;
            y[j] += s * h;
            value(&y)[i]
        };
        // differences of order six
        (45.0 * (at(1.0) - at(-1.0)) - 9.0 * (at(2.0) - at(-2.0)) + (at(3.0) - at(-3.0))) / (60.0 * h)
    });
    (value(x), gradient, [Matrix::zeros(); 2])
}

#[test]
fn the_plate_with_a_hole_has_the_errors_published_by_nutils() {
    // unit square, a = 0.5, plane stress, E = 1, nu = 0.3, T = 0.1, quadratic NURBS on 1 x 2 elements, 6 x 6 points
    let (a, one) = (0.5, 1.0);
    let (c, t) = ((2f64.sqrt() - 1.0) * a, (a + 1.0) / 2.0);
    let m = 0.3 * t;
    let rows =
        [[(0.0, a), (c, a), (a, c), (a, 0.0)], [(0.0, t), (m, t), (t, m), (t, 0.0)], [(0.0, one), (one, one), (one, one), (one, 0.0)]];
    let points = rows.iter().flatten().map(|&(x, y)| Vector::<2>::new(x, y)).collect();
    let w = 0.5 + 2f64.sqrt() / 4.0;
    let weights = vec![1.0, w, w, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
    let axes = [BSpline::uniform(2, 2, 1), BSpline::uniform(2, 1, 1)];
    let net = ControlNet::try_new(axes, points, Some(weights)).unwrap();
    let material = Hooke::<2>::plane_stress(1.0, 0.3).unwrap();
    let exact = |x: &Vector<2>| kirsch_field(a, 0.1, 1.0, 0.3, x);
    for x in [Vector::<2>::new(0.6, 0.2), Vector::<2>::new(0.1, 0.9)] {
        let stress = material.respond(&x, &exact(&x).1).stress;
        assert!((stress - kirsch(a, 0.1, &x)).amax() < 1e-9, "the displacement belongs to the stress");
    }
    for (refine, l2, h1) in [(0u32, 0.00200, 0.02271), (2, 0.00009, 0.00286)] {
        let n = 2usize.pow(refine);
        let body = iga(&PatchSpec::new(net.clone()).with_degree([2, 2]).with_elements([2 * n, n]).with_basis(BasisKind::Nurbs));
        let mut problem = Problem::new(&material, &exact);
        // v1 is x = 1 and y = 1, u0 is x = 0, u1 is y = 0
        problem.held = vec![("v1".into(), 0), ("v1".into(), 1)];
        problem.fixed = vec![("u0".into(), 0), ("u1".into(), 1)];
        (problem.extra, problem.extra_norm) = (3, 3);
        let e = problem.solve(&*body).errors.error;
        println!("plate with hole, refined {refine} times: L2 {:.6}, H1 {:.6}", e.l2, e.h1);
        assert!((e.l2 - l2).abs() <= 0.5e-5 && (e.h1 - h1).abs() <= 0.5e-5, "refined {refine} times: {} {}", e.l2, e.h1);
    }
}

#[test]
fn loads_of_a_manufactured_solution_are_its_negative_divergence() {
    // ∫ -div sigma = -∫ sigma n over the boundary
    let steel = Hooke::varying(
        |x: &Vector<2>| Elastic::Lame {
            lambda: Jet::new(1.0 + x[0] * x[0], Vector::<2>::new(2.0 * x[0], 0.0)),
            mu: Jet::new(2.0 + x[1], Vector::<2>::new(0.0, 1.0)),
        },
        Assumption::PlaneStrain,
    );
    let body = fe(&PatchSpec::new(bent()).with_degree([6, 6]).with_elements([3, 3]).with_mapping(Mapping::Exact));
    let inside = load::<2, 2, 2, _, _, _>(&**body.space(), &gauss_rules(&**body.space(), 2), &|x: &Vector<2>| {
        let (_, gradient, hessian) = smooth::<2>(x);
        -steel.divergence(x, &gradient, &hessian)
    });
    let mut all = inside;
    for side in body.sides() {
        let trace = body.trace(&side).unwrap();
        let pull = |x: &Vector<2>, n: &Vector<2>| steel.respond(x, &smooth::<2>(x).1).stress * n;
        faying::assembly::trace_load(&trace, &gauss_rules(&*trace.space, 2), &pull, &mut all);
    }
    for c in 0..2 {
        assert!(all.iter().skip(c).step_by(2).sum::<f64>().abs() < 1e-12);
    }
}
