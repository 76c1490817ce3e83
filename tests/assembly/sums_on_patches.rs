//! Loads and norms against the plain loops: contracted direction by direction on every kind of patch, in lanes on cells.

use crate::common::cells;
use crate::common::products;
use cells::{Shapes, bent, boxes, shaken};
use faying::assembly::{Errors, Form, Moments, difference, errors, gauss_rules, load, load_with_moments};
use faying::basis::{Basis, Rational, TensorProduct};
use faying::geometry::ControlPoints;
use faying::linalg::{Matrix, Vector};
use faying::physics::{Hooke, form};
use faying::quadrature::{Quadrature, TensorRule};
use faying::space::{Body, Deformed, FunctionSpace, Mapping, Mesh, Space};
use products::{Plain, coarse, forms, lagrange, largest, maps, net, noise, smooth, spline, weights};

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
    assert!(a != b, "the contraction is what is tested");
    let mut all = vec![largest(a.iter().zip(&b).map(|(a, b)| a - b)) / largest(b.iter().copied())];
    let moments = |space: &dyn Space<N, N>| load_with_moments::<C, N, N, _, _, _>(space, rules, &force);
    let ((same, fast), (_, slow)) = (moments(space), moments(&plain));
    assert!(same == a, "the load does not depend on who asks for its moments");
    all.extend((fast.total - slow.total).iter().map(|d| d / slow.total.amax()));
    all.extend((fast.first - slow.first).iter().map(|d| d / slow.first.amax()));
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
            all.extend(numbers(&a).iter().zip(numbers(&b)).map(|(a, b)| a / b - 1.0));
        }
    }
    let most = largest(all);
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
                let space = FunctionSpace { basis: TensorProduct::new(axes()), geometry };
                most = most.max(compare::<1, 2>(&space, &gauss_rules(&space, 0), &Form::laplace()));
            }
        }
    }
    for p in [[1, 2, 3], [2, 3, 1], [4, 5, 1], [1, 4, 5], [5, 1, 4], [3, 3, 3]] {
        let axes = || [spline(p[0], 2), spline(p[1], 4), spline(p[2], 4)];
        for geometry in maps(axes) {
            let space = FunctionSpace { basis: TensorProduct::new(axes()), geometry };
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
        most = most.max(all_forms(&FunctionSpace { basis: TensorProduct::new(axes()), geometry }));
    }
    for geometry in maps(axes) {
        let product = TensorProduct::new(axes());
        let w = weights(product.num_functions());
        most = most.max(all_forms(&FunctionSpace { basis: Rational::new::<2>(product, w), geometry }));
    }
    let axes = || [spline(2, 2), smooth(1, 2), smooth(3, 2)];
    for geometry in maps(axes) {
        most = most.max(all_forms(&FunctionSpace { basis: TensorProduct::new(axes()), geometry }));
    }
    for geometry in maps(axes) {
        let product = TensorProduct::new(axes());
        let w = weights(product.num_functions());
        most = most.max(all_forms(&FunctionSpace { basis: Rational::new::<3>(product, w), geometry }));
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
    compare(&space, &TensorRule::gauss([2, 7]), &form(&steel).unwrap());
    let u = (0..space.points.len()).map(|i| Vector::<2>::new(0.01 * noise(i), 0.02 * noise(3 * i))).collect();
    compare(&Deformed { space: &space, u }, &gauss_rules(&space, 1), &form(&steel).unwrap());
    // det J < 0
    let axes = || [smooth(2, 3), spline(2, 2), smooth(1, 2)];
    let points = net(&axes()).into_iter().map(|x| Vector::<3>::new(-x[0], x[1], x[2])).collect();
    let space = ControlPoints { basis: TensorProduct::new(axes()), points };
    compare(&space, &gauss_rules(&space, 0), &form(&Hooke::<3>::solid(1.0, 0.3).unwrap()).unwrap());
}

#[test]
fn sums_have_the_same_bits_for_any_number_of_threads() {
    fn bits<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>) {
        let rules = gauss_rules(space, 0);
        let run = |threads: usize| {
            rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
                let (mut all, moments) = load_with_moments::<C, N, N, _, _, _>(space, &rules, &|x: &Vector<N>| field::<C, N>(x).0);
                all.extend(moments.total.iter().chain(&moments.first));
                all.extend(numbers(&errors(space, &rules, form, &all[..C * space.num_functions()], &field)));
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
    bits(&space, &form(&Hooke::<3>::solid(1.0, 0.3).unwrap()).unwrap());
    // more tasks than wait at a time
    bits::<1, 2>(&**plane([70, 65], Shapes::Simplex, 2).space(), &Form::laplace());
    bits::<2, 2>(&**plane([9, 7], Shapes::Mixed, 3).space(), &form(&Hooke::<2>::plane_strain(1.0, 0.3).unwrap()).unwrap());
    bits::<3, 3>(&**solid([5, 4, 3], Shapes::Tensor, 2).space(), &form(&Hooke::<3>::solid(1.0, 0.3).unwrap()).unwrap());
}

fn plane(counts: [usize; 2], shapes: Shapes, degree: usize) -> Mesh<1, 2> {
    Mesh::from_cells(&boxes(counts, shapes, 1, Some(7), &shaken(counts, 0.2)), degree, Mapping::Exact).unwrap()
}

fn solid(counts: [usize; 3], shapes: Shapes, degree: usize) -> Mesh<2, 3> {
    Mesh::from_cells(&boxes(counts, shapes, 2, Some(11), &bent), degree, Mapping::Isoparametric).unwrap()
}

#[test]
fn sums_on_cells_are_those_of_the_plain_loops() {
    let mut most = 0.0f64;
    for shapes in [Shapes::Tensor, Shapes::Simplex, Shapes::Mixed] {
        for degree in 1..=4 {
            most = most.max(all_forms(&**plane([5, 3], shapes, degree).space()));
        }
        let curved = boxes([4, 3], shapes, 3, Some(5), &bent);
        most = most.max(all_forms(&**Mesh::<1, 2>::from_cells(&curved, 2, Mapping::Exact).unwrap().space()));
    }
    for shapes in [Shapes::Tensor, Shapes::Simplex] {
        for degree in 1..=3 {
            most = most.max(all_forms(&**solid([3, 2, 1], shapes, degree).space()));
        }
    }
    println!("cells: apart by {most:.1e} at most");
}

#[test]
fn moments_of_a_force_are_those_of_its_formula() {
    // f = (1, y, x) on the box 0 < x < 2, 0 < y < 3, 0 < z < 1 of shaken cells: exact by any rule that holds its degree
    let map = |u: &Vector<3>| Vector::<3>::new(2.0 * u[0], 3.0 * u[1], u[2]);
    for shapes in [Shapes::Tensor, Shapes::Simplex] {
        let body = Mesh::<2, 3>::from_cells(&boxes([3, 2, 2], shapes, 1, Some(3), &map), 2, Mapping::Exact).unwrap();
        let space = &**body.space();
        let force = |x: &Vector<3>| Vector::<3>::new(1.0, x[1], x[0]);
        let (load, found) = load_with_moments::<3, 3, 3, _, _, _>(space, &gauss_rules(space, 0), &force);
        let exact =
            Moments { total: Vector::<3>::new(6.0, 9.0, 6.0), first: Matrix::<3, 3>::new(6.0, 9.0, 3.0, 9.0, 18.0, 4.5, 8.0, 9.0, 3.0) };
        assert!((found.total - exact.total).amax() < 1e-13 && (found.first - exact.first).amax() < 1e-12, "{found:?}");
        for c in 0..3 {
            let sum: f64 = load.iter().skip(c).step_by(3).sum();
            assert!((sum - exact.total[c]).abs() < 1e-13, "functions sum to one: {sum}");
        }
    }
}
