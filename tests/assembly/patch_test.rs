//! One body and a linear field: exact on polynomial maps for every backend, degree and model.

use crate::common::bulk;
use bulk::{Problem, reaction, worst};
use faying::basis::{BSpline, Cell};
use faying::geometry::{ControlNet, shapes};
use faying::linalg::{Matrix, Vector};
use faying::physics::{Conductor, Hooke, Material};
use faying::space::{BasisKind, Body, Mapping, Mesh, Patch, PatchSpec};

/// Largest error of the field at any point.
const FIELD: f64 = 1e-11;
/// Largest error of the stress at any point, relative to the largest stress.
const STRESS: f64 = 1e-9;

/// A quadrilateral with no two sides parallel.
fn bilinear() -> ControlNet<2, 2> {
    let points = vec![Vector::<2>::new(0.0, 0.0), Vector::<2>::new(1.3, 0.2), Vector::<2>::new(-0.2, 1.0), Vector::<2>::new(1.0, 1.4)];
    ControlNet::try_new([BSpline::uniform(1, 1, 0), BSpline::uniform(1, 1, 0)], points, None).unwrap()
}

/// A biquadratic map with bent sides.
fn biquadratic() -> ControlNet<2, 2> {
    let bend = |i: usize, j: usize| Vector::<2>::new(0.06 * ((3 * i + 2 * j) as f64).sin(), 0.06 * ((2 * i + 5 * j) as f64).cos());
    let points = (0..9).map(|k| (k % 3, k / 3)).map(|(i, j)| Vector::<2>::new(i as f64 / 2.0, j as f64 / 2.0) + bend(i, j)).collect();
    ControlNet::try_new([BSpline::uniform(2, 1, 1), BSpline::uniform(2, 1, 1)], points, None).unwrap()
}

/// The unit square with the weights 1 + u/2 (1 + v): functions are rational, the map is the identity.
fn weighted_box() -> ControlNet<2, 2> {
    let w = |u: f64, v: f64| 1.0 + 0.5 * u * (1.0 + v);
    // biquadratic Bernstein coefficients by blossoms: c_ij = f(u_i u_i' , v_j v_j')
    let blossom = |f: &dyn Fn(f64, f64, f64, f64) -> f64| -> Vec<f64> {
        let pair = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
        (0..9).map(|k| (pair[k % 3], pair[k / 3])).map(|((a, b), (c, d))| f(a, b, c, d)).collect()
    };
    let weights = blossom(&|a, b, c, d| w(0.5 * (a + b), 0.5 * (c + d)));
    // u w = u + u²/2 (1 + v), v w = v + u/2 (v + v²)
    let xw = blossom(&|a, b, c, d| 0.5 * (a + b) + 0.5 * a * b * (1.0 + 0.5 * (c + d)));
    let yw = blossom(&|a, b, c, d| 0.5 * (c + d) + 0.25 * (a + b) * (0.5 * (c + d) + c * d));
    let points = (0..9).map(|k| Vector::<2>::new(xw[k] / weights[k], yw[k] / weights[k])).collect();
    ControlNet::try_new([BSpline::uniform(2, 1, 1), BSpline::uniform(2, 1, 1)], points, Some(weights)).unwrap()
}

/// A linear field of C components.
fn linear<const C: usize, const N: usize>(x: &Vector<N>) -> bulk::Jet2<C, N> {
    let a = Matrix::<C, N>::from_fn(|i, j| 0.3 + 0.7 * i as f64 - 0.4 * j as f64 + 0.25 * (i * j) as f64);
    (a * x + Vector::from_fn(|i, _| 0.1 - 0.2 * i as f64), a, [Matrix::zeros(); C])
}

/// The field held on one side and pulled on the others, and held on all sides.
fn passes<const C: usize, const S: usize, const N: usize>(name: &str, body: &dyn Body<S, N>, material: &dyn Material<C, N>, extra: usize) {
    let all = body.sides();
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    for sides in [&["u0"][..], &all] {
        let mut problem = Problem::new(material, &linear::<C, N>).held_on(body, sides);
        problem.extra = extra;
        let solved = problem.solve(body);
        let (field, stress) = worst(body, material, &solved.u, &linear::<C, N>);
        assert!(field < FIELD && stress < STRESS, "{name}, held on {sides:?}: field {field:e}, stress {stress:e}");
    }
}

/// All models of the plane.
fn passes_in_the_plane(name: &str, body: &dyn Body<1, 2>, extra: usize) {
    passes(name, body, &Conductor::<2>::try_new(3.0).unwrap(), extra);
    passes(name, body, &Hooke::<2>::plane_strain(2.0, 0.3).unwrap(), extra);
    passes(name, body, &Hooke::<2>::plane_stress(2.0, 0.3).unwrap(), extra);
}

#[test]
fn a_linear_field_is_exact_with_splines_of_any_degree_and_continuity() {
    for degree in [1, 2, 3, 4] {
        for (map, net) in [("bilinear", bilinear()), ("biquadratic", biquadratic())] {
            if map == "biquadratic" && degree == 1 {
                continue;
            }
            for continuity in [0, degree - 1] {
                let spec = PatchSpec::new(net.clone()).with_degree([degree, degree]).with_elements([3, 2]).with_continuity(continuity);
                let patch = Patch::<1, 2>::try_new(&spec).unwrap();
                passes_in_the_plane(&format!("splines p = {degree} C{continuity} {map}"), &patch, 0);
            }
        }
    }
    let mixed = PatchSpec::new(bilinear()).with_degree([3, 1]).with_elements([2, 4]);
    passes_in_the_plane("splines of degrees 3 and 1", &Patch::<1, 2>::try_new(&mixed).unwrap(), 0);
}

#[test]
fn a_linear_field_is_exact_with_nurbs_once_there_are_enough_points() {
    for degree in [2, 3, 4] {
        let spec = PatchSpec::new(weighted_box()).with_degree([degree, degree]).with_elements([3, 2]).with_basis(BasisKind::Nurbs);
        let patch = Patch::<1, 2>::try_new(&spec).unwrap();
        assert!(patch.weights().is_some(), "the functions are rational");
        passes_in_the_plane(&format!("NURBS p = {degree}"), &patch, 3);
    }
}

#[test]
fn a_linear_field_is_exact_with_quadrilaterals() {
    for degree in [1, 2, 3, 4, 8] {
        for (map, net) in [("bilinear", bilinear()), ("biquadratic", biquadratic())] {
            for mapping in [Mapping::Isoparametric, Mapping::Exact] {
                if mapping == Mapping::Exact && map == "biquadratic" && degree == 1 {
                    continue;
                }
                let spec = PatchSpec::new(net.clone()).with_degree([degree, degree]).with_elements([3, 2]).with_mapping(mapping);
                let mesh = Mesh::<1, 2>::from_patch(&spec).unwrap();
                passes_in_the_plane(&format!("quadrilaterals p = {degree} {map} {mapping:?}"), &mesh, 0);
            }
        }
    }
}

#[test]
fn a_linear_field_is_exact_with_triangles() {
    for degree in [1, 2, 3, 4] {
        for (map, order, net) in [("bilinear", 2, bilinear()), ("biquadratic", 4, biquadratic())] {
            for mapping in [Mapping::Isoparametric, Mapping::Exact] {
                // on a triangle the exact map has the total degree of its products
                if mapping == Mapping::Exact && degree < order {
                    continue;
                }
                let spec = PatchSpec::new(net.clone())
                    .with_degree([degree, degree])
                    .with_elements([3, 2])
                    .with_cells(Cell::Simplex)
                    .with_mapping(mapping);
                let mesh = Mesh::<1, 2>::from_patch(&spec).unwrap();
                passes_in_the_plane(&format!("triangles p = {degree} {map} {mapping:?}"), &mesh, 0);
            }
        }
    }
}

#[test]
fn a_linear_field_is_exact_in_three_dimensions() {
    let solid = Hooke::<3>::solid(2.0, 0.3).unwrap();
    let conductor = Conductor::<3>::try_new(2.0).unwrap();
    let corner = |k: usize| Vector::<3>::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64);
    let bend = |k: usize| Vector::<3>::new((k as f64).sin(), (2.0 * k as f64).cos(), (3.0 * k as f64).sin()) * 0.1;
    let net = ControlNet::try_new([0; 3].map(|_| BSpline::uniform(1, 1, 0)), (0..8).map(|k| corner(k) + bend(k)).collect(), None).unwrap();
    for degree in [1, 2, 3] {
        let spec = PatchSpec::new(net.clone()).with_degree([degree; 3]).with_elements([2, 1, 2]);
        for (name, body) in [
            ("splines", Box::new(Patch::<2, 3>::try_new(&spec).unwrap()) as Box<dyn Body<2, 3>>),
            ("hexahedra", Box::new(Mesh::<2, 3>::from_patch(&spec).unwrap())),
        ] {
            passes(&format!("{name} p = {degree}"), &*body, &solid, 0);
            passes(&format!("{name} p = {degree}"), &*body, &conductor, 0);
        }
    }
}

#[test]
fn reactions_balance_the_loads() {
    // a bar held on the left, pulled on the right with the traction (2, 0) per length: the support pulls with -2 h
    let steel = Hooke::<2>::plane_stress(1.0, 0.0).unwrap();
    let zero = |_: &Vector<2>| (Vector::<2>::zeros(), Matrix::<2, 2>::zeros(), [Matrix::<2, 2>::zeros(); 2]);
    let spec = PatchSpec::new(shapes::rectangle([0.0, 0.0], [3.0, 0.5]).unwrap()).with_elements([3, 2]);
    for body in
        [Box::new(Patch::<1, 2>::try_new(&spec).unwrap()) as Box<dyn Body<1, 2>>, Box::new(Mesh::<1, 2>::from_patch(&spec).unwrap())]
    {
        let mut problem = Problem::new(&steel, &zero);
        problem.fixed = vec![("u0".into(), 0), ("v0".into(), 1)];
        let pull = |_: &Vector<2>, _: &Vector<2>| Vector::<2>::new(2.0, 0.0);
        problem.loaded = vec![("u1".into(), &pull)];
        let solved = problem.solve(&*body);
        let left: Vector<2> = reaction(&body.trace("u0").unwrap(), &solved.reactions);
        assert!((left - Vector::<2>::new(-1.0, 0.0)).amax() < 1e-13, "{left}");
        // 1/2 a(u, u) = 1/2 sigma² / E V
        assert!((faying::physics::energy(&solved.stiffness, &solved.u) - 0.5 * 4.0 * 1.5).abs() < 1e-12);
    }
}
