//! Loads and norms contracted direction by direction against the plain loops, on every kind of patch.

#![allow(clippy::unwrap_used)]

#[path = "common/products.rs"]
mod products;

use faying::assembly::{Errors, Form, difference, errors, gauss_rules, load};
use faying::basis::{Basis, Rational, TensorProduct};
use faying::geometry::ControlPoints;
use faying::linalg::{Matrix, Vector};
use faying::physics::{Hooke, form};
use faying::quadrature::{Quadrature, TensorRule};
use faying::space::{Deformed, Over, Space};
use products::{Plain, coarse, forms, lagrange, maps, net, noise, smooth, spline, weights};

const SAME: f64 = 1e-13;

fn field<const C: usize, const N: usize>(x: &Vector<N>) -> (Vector<C>, Matrix<C, N>) {
    let value = Vector::from_fn(|c, _| (1.3 * x[0] + 0.4 * x[c % N]).sin() + 0.2 * x[N - 1] * x[0]);
    (value, Matrix::from_fn(|c, j| (0.7 * x[j] + c as f64).cos() * x[0] - 0.3))
}

fn numbers(e: &Errors) -> [f64; 6] {
    [e.error.l2, e.error.h1, e.error.energy, e.exact.l2, e.exact.h1, e.exact.energy]
}

/// Both ways agree; the contraction sums in another order than the loop.
fn compare<const C: usize, const N: usize>(space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, form: &Form<'_, C, N>) -> f64 {
    let plain = Plain(space);
    let force = |x: &Vector<N>| field::<C, N>(x).0;
    let (a, b) = (load::<C, N, N, _, _, _>(space, rules, &force), load::<C, N, N, _, _, _>(&plain, rules, &force));
    let largest = b.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    assert!(a != b, "the contraction is what is tested");
    let mut most = a.iter().zip(&b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs() / largest));
    let u: Vec<f64> = (0..C * space.num_functions()).map(|i| noise(3 * i) - 0.3).collect();
    for u in [&u[..], &[]] {
        // a field that depends on element and local point too
        let other = |e: usize, xi: &Vector<N>, x: &Vector<N>| {
            let (value, gradient) = field::<C, N>(x);
            (value * (1.0 + 0.01 * e as f64) + Vector::repeat(xi[0] * xi[N - 1]), gradient * (1.0 - xi[N - 1]))
        };
        for (a, b) in [
            (errors(space, rules, form, u, &field), errors(&plain, rules, form, u, &field)),
            (difference(space, rules, form, u, &other), difference(&plain, rules, form, u, &other)),
        ] {
            assert!(numbers(&b).iter().all(|v| *v > 0.0), "{b:?}");
            for (a, b) in numbers(&a).iter().zip(numbers(&b)) {
                most = most.max((a / b - 1.0).abs());
            }
        }
    }
    assert!(most <= SAME, "apart by {most:e}, degrees {:?}", space.degree(0));
    most
}

fn all_forms<const N: usize>(space: &dyn Space<N, N>) -> f64 {
    let rules = gauss_rules(space, 1);
    let mut most = 0.0f64;
    // energies of forms that are not symmetric may be negative: their root is no measure
    for form in forms::<1, N>().into_iter().filter(|f| f.symmetric) {
        most = most.max(compare(space, &rules, &form));
    }
    for form in forms::<N, N>().into_iter().filter(|f| f.symmetric) {
        most = most.max(compare(space, &rules, &form));
    }
    most
}

#[test]
fn sums_on_patches_of_all_degrees_are_those_of_the_plain_loops() {
    let mut most = 0.0f64;
    for p in 1..=5 {
        for q in 1..=5 {
            let axes = || [spline(p, 4), spline(q, 6)];
            for geometry in maps(axes) {
                let space = Over { basis: TensorProduct::new(axes()), geometry };
                most = most.max(compare::<1, 2>(&space, &gauss_rules(&space, 0), &Form::laplace()));
            }
        }
    }
    for p in [[1, 2, 3], [2, 3, 1], [4, 5, 1], [1, 4, 5], [5, 1, 4], [3, 3, 3]] {
        let axes = || [spline(p[0], 2), spline(p[1], 4), spline(p[2], 4)];
        for geometry in maps(axes) {
            let space = Over { basis: TensorProduct::new(axes()), geometry };
            most = most.max(compare::<1, 3>(&space, &gauss_rules(&space, 0), &Form::laplace()));
        }
    }
    println!("all degrees: apart by {most:.1e} at most");
}

#[test]
fn sums_with_all_kinds_of_coefficients_and_functions_are_those_of_the_plain_loops() {
    let mut most = 0.0f64;
    let axes = || [smooth(2, 4), spline(3, 4)];
    for geometry in maps(axes) {
        most = most.max(all_forms(&Over { basis: TensorProduct::new(axes()), geometry }));
    }
    for geometry in maps(axes) {
        let product = TensorProduct::new(axes());
        let w = weights(product.num_functions());
        most = most.max(all_forms(&Over { basis: Rational::new::<2>(product, w), geometry }));
    }
    let axes = || [spline(2, 2), smooth(1, 2), smooth(3, 2)];
    for geometry in maps(axes) {
        most = most.max(all_forms(&Over { basis: TensorProduct::new(axes()), geometry }));
    }
    for geometry in maps(axes) {
        let product = TensorProduct::new(axes());
        let w = weights(product.num_functions());
        most = most.max(all_forms(&Over { basis: Rational::new::<3>(product, w), geometry }));
    }
    let axes = || [coarse(6), smooth(3, 4)];
    most = most.max(all_forms(&ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) }));
    let axes = || [lagrange(2, 2), smooth(3, 3), spline(2, 4)];
    most = most.max(all_forms(&ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) }));
    println!("coefficients: apart by {most:.1e} at most");
}

#[test]
fn sums_with_other_rules_deformed_maps_and_mirrored_bodies_are_those_of_the_plain_loops() {
    let axes = || [smooth(2, 5), spline(3, 3)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    let steel = Hooke::<2>::plane_stress(1.0, 0.3).unwrap();
    compare(&space, &TensorRule::gauss([2, 7]), &form(&steel));
    let u = (0..space.points.len()).map(|i| Vector::<2>::new(0.01 * noise(i), 0.02 * noise(3 * i))).collect();
    compare(&Deformed { space: &space, u }, &gauss_rules(&space, 1), &form(&steel));
    // det J < 0
    let axes = || [smooth(2, 3), spline(2, 2), smooth(1, 2)];
    let points = net(&axes()).into_iter().map(|x| Vector::<3>::new(-x[0], x[1], x[2])).collect();
    let space = ControlPoints { basis: TensorProduct::new(axes()), points };
    compare(&space, &gauss_rules(&space, 0), &form(&Hooke::<3>::solid(1.0, 0.3).unwrap()));
}

#[test]
fn sums_have_the_same_bits_for_any_number_of_threads() {
    fn bits<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>) {
        let rules = gauss_rules(space, 0);
        let run = |threads: usize| {
            rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
                let mut all = load::<C, N, N, _, _, _>(space, &rules, &|x: &Vector<N>| field::<C, N>(x).0);
                all.extend(numbers(&errors(space, &rules, form, &all, &field)));
                all
            })
        };
        let one = run(1);
        for threads in [2, 4, 7] {
            assert!(run(threads).iter().zip(&one).all(|(a, b)| a.to_bits() == b.to_bits()), "{threads} threads");
        }
    }
    let axes = || [spline(3, 9), spline(2, 70)];
    bits::<1, 2>(&ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) }, &Form::laplace());
    let axes = || [smooth(2, 6), spline(3, 5), spline(2, 8)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    bits(&space, &form(&Hooke::<3>::solid(1.0, 0.3).unwrap()));
}
