//! The operator without a matrix against the matrix, on every kind of patch and on cells.

use crate::common::products;
use faying::assembly::{Form, MatrixFree, gauss_rules, stiffness};
use faying::basis::{Basis, Rational, TensorProduct};
use faying::check;
use faying::geometry::ControlPoints;
use faying::linalg::{Cg, LinearSolver, Operator, Vector};
use faying::physics::{Hooke, form};
use faying::quadrature::{Quadrature, TensorRule};
use faying::space::{Deformed, FunctionSpace, Space};
use products::{Anyhow, Plain, coarse, forms, lagrange, largest, maps, net, noise, smooth, spline, weights};

/// Entries may differ by this share of |A| |x|.
const SAME: f64 = 1e-13;

fn vector(n: usize) -> Vec<f64> {
    (0..n).map(|i| noise(5 * i + 1) - 0.4).collect()
}

/// max_i |a_i - b_i| / s_i.
fn apart(a: &[f64], b: &[f64], scale: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    largest(a.iter().zip(b).zip(scale).map(|((a, b), s)| (a - b) / s))
}

/// Product and diagonal equal those of the matrix, with and without what is kept at the points.
fn compare<const C: usize, const N: usize>(space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, form: &Form<'_, C, N>) -> f64 {
    let matrix = stiffness(space, rules, form);
    let n = matrix.num_rows();
    let x = vector(n);
    let (mut expected, mut found) = (vec![0.0; n], vec![f64::NAN; n]);
    matrix.apply(&x, &mut expected);
    // round-off goes with the sum of absolute values, largest over the patch: rows of small entries share points with large ones
    let size = (0..n).map(|i| matrix.row(i).1.iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
    let largest = matrix.diagonal().iter().fold(0.0, |m: f64, d| m.max(d.abs()));
    let mut most = 0.0f64;
    for operator in [MatrixFree::new(space, rules, form), MatrixFree::lean(space, rules, form)] {
        assert!(operator.is_contracted() && operator.csr().is_none() && operator.size() == n);
        operator.apply(&x, &mut found);
        most = most.max(apart(&found, &expected, &vec![size; n]));
        most = most.max(apart(&operator.diagonal(), &matrix.diagonal(), &vec![largest; n]));
        assert_eq!(operator.dof_coordinates(), matrix.dof_coordinates());
    }
    assert!(most <= SAME, "apart by {most:e}, degrees {:?}", space.degree(0));
    most
}

fn all_forms<const N: usize>(space: &dyn Space<N, N>) -> f64 {
    let rules = gauss_rules(space, 0);
    let mut most = 0.0f64;
    for form in forms::<1, N>() {
        most = most.max(compare(space, &rules, &form));
    }
    for form in forms::<N, N>() {
        most = most.max(compare(space, &rules, &form));
    }
    most
}

#[test]
fn products_on_plane_patches_of_all_pairs_of_degrees_are_those_of_the_matrix() {
    let mut most = 0.0f64;
    for p in 1..=5 {
        for q in 1..=5 {
            let axes = || [spline(p, 4), spline(q, 6)];
            for geometry in maps(axes) {
                let space = FunctionSpace { basis: TensorProduct::new(axes()), geometry };
                most = most.max(compare::<1, 2>(&space, &gauss_rules(&space, 0), &Form::laplace()));
            }
        }
    }
    println!("plane, all degrees: apart by {most:.1e} at most");
}

#[test]
fn products_on_solid_patches_of_mixed_degrees_are_those_of_the_matrix() {
    let mut most = 0.0f64;
    for p in [[1, 2, 3], [2, 3, 1], [3, 1, 2], [4, 5, 1], [1, 4, 5], [5, 1, 4], [3, 3, 3]] {
        let axes = || [spline(p[0], 2), spline(p[1], 4), spline(p[2], 4)];
        for geometry in maps(axes) {
            let space = FunctionSpace { basis: TensorProduct::new(axes()), geometry };
            most = most.max(compare::<1, 3>(&space, &gauss_rules(&space, 0), &Form::laplace()));
        }
    }
    println!("solid, mixed degrees: apart by {most:.1e} at most");
}

#[test]
fn all_kinds_of_coefficients_act_as_in_the_matrix() {
    let mut most = 0.0f64;
    let axes = || [smooth(2, 4), spline(3, 4)];
    for geometry in maps(axes) {
        most = most.max(all_forms(&FunctionSpace { basis: TensorProduct::new(axes()), geometry }));
    }
    let axes = || [spline(2, 2), smooth(1, 2), smooth(3, 2)];
    for geometry in maps(axes) {
        most = most.max(all_forms(&FunctionSpace { basis: TensorProduct::new(axes()), geometry }));
    }
    println!("coefficients: apart by {most:.1e} at most");
}

#[test]
fn elastic_bodies_lagrange_axes_and_coarse_functions_act_as_in_the_matrix() {
    let mut most = 0.0f64;
    for p in 1..=5 {
        let axes = || [lagrange(p, 3), lagrange(6 - p, 4)];
        let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
        let rules = gauss_rules(&space, 0);
        most = most.max(compare(&space, &rules, &form(&Hooke::<2>::plane_strain(1.0, 0.3).unwrap()).unwrap()));
        most = most.max(compare(&space, &rules, &form(&Hooke::<2>::plane_stress(2.0, 0.2).unwrap()).unwrap()));
    }
    let axes = || [coarse(6), smooth(3, 4)];
    most = most.max(all_forms(&ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) }));
    let axes = || [lagrange(2, 2), smooth(3, 3), spline(2, 4)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    most = most.max(compare(&space, &gauss_rules(&space, 0), &form(&Hooke::<3>::solid(1.0, 0.3).unwrap()).unwrap()));
    most = most.max(all_forms(&space));
    println!("lagrange: apart by {most:.1e} at most");
}

#[test]
fn rational_functions_act_as_in_the_matrix() {
    let mut most = 0.0f64;
    let axes = || [smooth(2, 4), spline(3, 4)];
    for geometry in maps(axes) {
        let product = TensorProduct::new(axes());
        let w = weights(product.num_functions());
        most = most.max(all_forms(&FunctionSpace { basis: Rational::new::<2>(product, w), geometry }));
    }
    let axes = || [spline(1, 2), smooth(2, 2), spline(3, 2)];
    for geometry in maps(axes) {
        let product = TensorProduct::new(axes());
        let w = weights(product.num_functions());
        most = most.max(all_forms(&FunctionSpace { basis: Rational::new::<3>(product, w), geometry }));
    }
    println!("rational: apart by {most:.1e} at most");
}

#[test]
fn other_rules_and_deformed_maps_act_as_in_the_matrix() {
    let axes = || [smooth(2, 5), spline(3, 3)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    let steel = Hooke::<2>::plane_stress(1.0, 0.3).unwrap();
    compare(&space, &TensorRule::gauss([2, 7]), &form(&steel).unwrap());
    let u = (0..space.points.len()).map(|i| Vector::<2>::new(0.01 * noise(i), 0.02 * noise(3 * i))).collect();
    compare(&Deformed { space: &space, u }, &gauss_rules(&space, 1), &form(&steel).unwrap());
}

#[test]
fn operators_keep_the_contract_on_patches_and_on_cells() {
    fn all<const C: usize, const N: usize>(space: &dyn Space<N, N>) {
        let (rules, plain) = (gauss_rules(space, 0), Plain(space));
        for form in forms::<C, N>() {
            check::operator(&MatrixFree::new(space, &rules, &form)).unwrap();
            check::operator(&MatrixFree::lean(space, &rules, &form)).unwrap();
            // without product structure: a loop over elements
            let cells = MatrixFree::new(&plain, &rules, &form);
            assert!(!cells.is_contracted() && cells.bytes() == 0);
            check::operator(&cells).unwrap();
            let (matrix, x) = (stiffness(&plain, &rules, &form), vector(cells.size()));
            let (mut a, mut b) = (vec![0.0; x.len()], vec![0.0; x.len()]);
            cells.apply(&x, &mut a);
            matrix.apply(&x, &mut b);
            let size = b.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            assert!(apart(&a, &b, &vec![size; x.len()]) <= SAME);
            assert_eq!(cells.dof_coordinates(), matrix.dof_coordinates());
        }
    }
    let axes = || [spline(2, 3), smooth(3, 3)];
    let product = || TensorProduct::new(axes());
    let points = net(&axes());
    all::<1, 2>(&FunctionSpace { basis: product(), geometry: Anyhow(ControlPoints { basis: product(), points: points.clone() }) });
    all::<2, 2>(&ControlPoints { basis: Rational::new::<2>(product(), weights(points.len())), points });
    let axes = || [smooth(1, 2), spline(2, 2), smooth(2, 2)];
    all::<3, 3>(&ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) });
}

#[test]
fn products_have_the_same_bits_for_any_number_of_threads() {
    fn bits<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>) {
        let rules = gauss_rules(space, 0);
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let operator = MatrixFree::new(space, &rules, form);
                let x = vector(operator.size());
                let mut y = vec![0.0; x.len()];
                operator.apply(&x, &mut y);
                y.extend(operator.diagonal());
                y
            })
        };
        let one = run(1);
        for threads in [2, 4, 7] {
            assert!(run(threads).iter().zip(&one).all(|(a, b)| a.to_bits() == b.to_bits()), "{threads} threads");
        }
    }
    let axes = || [spline(3, 9), spline(2, 70)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    bits::<1, 2>(&space, &Form::laplace());
    bits::<2, 2>(&space, &forms().pop().unwrap());
    bits::<1, 2>(&Plain(&space), &Form::laplace());
    let axes = || [smooth(2, 6), spline(3, 5), spline(2, 8)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    bits::<1, 3>(&space, &Form::laplace());
    bits(&space, &form(&Hooke::<3>::solid(1.0, 0.3).unwrap()).unwrap());
}

#[test]
fn conjugate_gradients_find_the_same_solution_with_and_without_a_matrix() {
    /// A plus the mass of its own diagonal: definite without boundary conditions.
    #[derive(Debug)]
    struct Shifted<'a>(&'a dyn Operator, Vec<f64>);
    impl Operator for Shifted<'_> {
        fn size(&self) -> usize {
            self.0.size()
        }
        fn apply(&self, x: &[f64], y: &mut [f64]) {
            self.0.apply(x, y);
            y.iter_mut().zip(x).zip(&self.1).for_each(|((y, x), d)| *y += 0.1 * d * x);
        }
        fn diagonal(&self) -> Vec<f64> {
            self.1.iter().map(|d| 1.1 * d).collect()
        }
    }
    let axes = || [smooth(3, 6), smooth(3, 6), smooth(2, 5)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    let steel = Hooke::<3>::solid(1.0, 0.3).unwrap();
    let (rules, steel) = (gauss_rules(&space, 0), form(&steel).unwrap());
    let (matrix, free) = (stiffness(&space, &rules, &steel), MatrixFree::new(&space, &rules, &steel));
    let load = vector(free.size());
    let solve = |a: &dyn Operator| {
        let shifted = Shifted(a, a.diagonal());
        let (mut solver, mut x) = (Cg::new(1e-13), vec![0.0; load.len()]);
        solver.prepare(&shifted).unwrap();
        let iterations = solver.solve(&shifted, &load, &mut x).unwrap();
        (x, iterations)
    };
    let ((with, k), (without, l)) = (solve(&matrix), solve(&free));
    let size = with.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    assert!(apart(&with, &without, &vec![size; with.len()]) <= 1e-10);
    assert!(k.abs_diff(l) <= 2, "{k} and {l} iterations");
}
