//! Tangents that depend on the gradient of a state, and internal forces: every kind of space against the plain loop, and against
//! difference quotients of forces and of the energy.

use crate::common::{cells, plain, products};
use cells::{Shapes, bent, boxes, shaken};
use faying::assembly::{
    Assembler, Coefficient, Collapsed, Form, MatrixFree, Tangent, contract, errors, fields, gauss_rules, internal_force, stiffness,
};
use faying::basis::{Rational, TensorProduct};
use faying::geometry::{ControlPoints, shapes};
use faying::linalg::{Matrix, Operator, Vector};
use faying::space::{BasisKind, Body, FieldAt, FunctionSpace, Mapping, Mesh, MultiPatch, Near, Patch, PatchSpec, Seam, Space};
use plain::{Plain, apart, largest};
use products::{maps, net, noise, smooth, spline, weights};
use std::sync::Arc;

/// Two ways may differ by this share of the largest number.
const SAME: f64 = 1e-13;
/// Error of a central difference, relative to the largest number.
const DIFFERENCE: f64 = 1e-8;
/// Step of a central difference of a field whose largest derivative is 1.
const STEP: f64 = 1e-5;

type Stress<const C: usize, const N: usize> = Option<(Matrix<C, N>, f64)>;

/// Lame's numbers at a point.
fn lame<const N: usize>(x: &Vector<N>) -> (f64, f64) {
    (0.8 + 0.2 * x[0], 1.1 - 0.1 * x[N - 1])
}

/// F^-T and ln J; `None` where J <= 0.
fn kinematics<const N: usize>(grad_u: &Matrix<N, N>) -> Option<(Matrix<N, N>, Matrix<N, N>, f64)> {
    let f = Matrix::<N, N>::from_fn(|i, j| f64::from(u8::from(i == j)) + grad_u[(i, j)]);
    let det = faying::linalg::determinant(&f);
    if det <= 0.0 {
        return None;
    }
    Some((f, faying::linalg::inverse(&f)?.transpose(), det.ln()))
}

/// W = mu/2 (F:F - N) - mu ln J + lambda/2 (ln J)², P = mu (F - F^-T) + lambda ln J F^-T.
fn neo_hooke<const N: usize>(x: &Vector<N>, grad_u: &Matrix<N, N>) -> Stress<N, N> {
    let (f, a, ln) = kinematics(grad_u)?;
    let (mu, lambda) = lame(x);
    Some(((f - a) * mu + a * (lambda * ln), mu / 2.0 * (f.norm_squared() - N as f64) - mu * ln + lambda / 2.0 * ln * ln))
}

/// dP/dF.
fn neo_hooke_tangent<const N: usize>(x: &Vector<N>, grad_u: &Matrix<N, N>) -> Tangent<N, N> {
    let (_, a, ln) = kinematics(grad_u).expect("J > 0");
    let (mu, lambda) = lame(x);
    let entry = |i: usize, j: usize, k: usize, l: usize| {
        let same = f64::from(u8::from(i == k && j == l));
        mu * same + (mu - lambda * ln) * a[(k, j)] * a[(i, l)] + lambda * a[(k, l)] * a[(i, j)]
    };
    std::array::from_fn(|i| std::array::from_fn(|j| Matrix::from_fn(|k, l| entry(i, j, k, l))))
}

/// A stress without energy: P = (1 + h:h) h + (sum h) B; its tangent has no symmetry.
fn flow<const C: usize, const N: usize>(x: &Vector<N>, h: &Matrix<C, N>) -> Stress<C, N> {
    Some((*h * (1.0 + h.norm_squared()) + skew::<C, N>(x) * h.sum(), 0.0))
}

fn flow_tangent<const C: usize, const N: usize>(x: &Vector<N>, h: &Matrix<C, N>) -> Tangent<C, N> {
    let own = |i: usize, j: usize| {
        let mut unit = Matrix::<C, N>::zeros();
        unit[(i, j)] = 1.0 + h.norm_squared();
        unit + *h * (2.0 * h[(i, j)]) + skew::<C, N>(x)
    };
    std::array::from_fn(|i| std::array::from_fn(|j| own(i, j)))
}

fn skew<const C: usize, const N: usize>(x: &Vector<N>) -> Matrix<C, N> {
    Matrix::from_fn(|c, k| (noise(3 * c + 7 * k) - 0.3) * (1.0 + 0.1 * x[0]))
}

/// Hooke's law with Lame's numbers 0.6 and 0.4.
fn hooke<const N: usize>() -> Tangent<N, N> {
    let same = |a: usize, b: usize| f64::from(u8::from(a == b));
    let entry = |i, j, k, l| 0.6 * same(i, j) * same(k, l) + 0.4 * (same(i, k) * same(j, l) + same(i, l) * same(j, k));
    std::array::from_fn(|i| std::array::from_fn(|j| Matrix::from_fn(|k, l| entry(i, j, k, l))))
}

/// Unknowns without an order, whose largest derivative at the points is `size`.
fn unknowns<const C: usize, const N: usize>(space: &dyn Space<N, N>, seed: usize, size: f64) -> Vec<f64> {
    let u: Vec<f64> = (0..C * space.num_functions()).map(|k| noise(5 * k + seed) - 0.5).collect();
    let most = |_: usize, states: &[FieldAt<C, N>]| states.iter().map(|s| s.gradient.amax()).fold(0.0, f64::max);
    let most = fields(space, &gauss_rules(space, 0), &u, &most).into_iter().fold(0.0, f64::max);
    u.iter().map(|u| u * size / most).collect()
}

/// u + t v.
fn moved(u: &[f64], t: f64, v: &[f64]) -> Vec<f64> {
    u.iter().zip(v).map(|(u, v)| u + t * v).collect()
}

/// Largest difference of two vectors over the largest number of the second.
fn off(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    largest(a.iter().zip(b).map(|(a, b)| a - b)) / largest(b.iter().copied())
}

fn product(a: &dyn Operator, x: &[f64]) -> Vec<f64> {
    let mut y = vec![f64::NAN; x.len()];
    a.apply(x, &mut y);
    y
}

/// Every kind of space in the plane: patches of polynomial and rational functions over all maps, joined patches, merged functions,
/// quadrilaterals, triangles, both at once.
fn plane(visit: &mut dyn FnMut(&dyn Space<2, 2>, &str)) {
    let axes = || [smooth(2, 4), spline(3, 6)];
    for (k, geometry) in maps(axes).into_iter().enumerate() {
        visit(&FunctionSpace { basis: TensorProduct::new(axes()), geometry }, &format!("splines on map {k}"));
    }
    for (k, geometry) in maps(axes).into_iter().enumerate() {
        let product = TensorProduct::new(axes());
        let w = weights(faying::basis::Basis::num_functions(&product));
        visit(&FunctionSpace { basis: Rational::new::<2>(product, w), geometry }, &format!("rational functions on map {k}"));
    }
    let ring = shapes::annulus_sector([0.0; 2], [1.0, 2.0], [0.0, 90.0]).unwrap();
    let disc = shapes::disc_sector([0.0; 2], 1.0, [0.0, 90.0]).unwrap();
    for (name, shape) in [("NURBS ring", ring), ("disc with merged functions", disc)] {
        let spec = PatchSpec::new(shape).with_degree([2, 3]).with_elements([5, 4]).with_basis(BasisKind::Nurbs);
        visit(&**Patch::<1, 2>::try_new(&spec).unwrap().space(), name);
    }
    let meshes = [(Shapes::Tensor, 1, 2), (Shapes::Tensor, 2, 1), (Shapes::Simplex, 1, 1), (Shapes::Simplex, 2, 3), (Shapes::Mixed, 1, 2)];
    for (shapes, order, degree) in meshes {
        let map: &dyn Fn(&Vector<2>) -> Vector<2> = if order == 1 { &shaken([5, 3], 0.2) } else { &bent };
        let body = Mesh::<1, 2>::from_cells(&boxes([5, 3], shapes, order, Some(7), map), degree, Mapping::Exact).unwrap();
        visit(&**body.space(), &format!("{shapes:?}, order {order}, degree {degree}"));
    }
}

/// Some kinds of spaces in space.
fn solid(visit: &mut dyn FnMut(&dyn Space<3, 3>, &str)) {
    let axes = || [smooth(2, 4), spline(1, 4), smooth(2, 2)];
    for (k, geometry) in maps(axes).into_iter().enumerate() {
        let product = TensorProduct::new(axes());
        let w = weights(faying::basis::Basis::num_functions(&product));
        visit(&FunctionSpace { basis: Rational::new::<3>(product, w), geometry }, &format!("rational functions on map {k}"));
    }
    let body = |x: f64| {
        let brick = shapes::brick([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]).unwrap();
        let spec = PatchSpec::new(brick).with_degree([2, 3, 2]).with_elements([3, 2, 2]).with_basis(BasisKind::BSpline);
        Arc::new(Patch::<2, 3>::try_new(&spec).unwrap()) as Arc<dyn Body<2, 3>>
    };
    let whole =
        MultiPatch::try_new(vec![("a".into(), body(0.0)), ("b".into(), body(1.0))], &[Seam::new((0, "u1"), (1, "u0"))], Near::Exact);
    visit(&**whole.unwrap().space(), "two patches");
    for (shapes, order, degree) in [(Shapes::Tensor, 1, 1), (Shapes::Tensor, 2, 2), (Shapes::Simplex, 1, 1), (Shapes::Simplex, 2, 2)] {
        let map: &dyn Fn(&Vector<3>) -> Vector<3> = if order == 1 { &shaken([3, 2, 2], 0.15) } else { &bent };
        let body = Mesh::<2, 3>::from_cells(&boxes([3, 2, 2], shapes, order, Some(11), map), degree, Mapping::Exact).unwrap();
        visit(&**body.space(), &format!("{shapes:?}, order {order}, degree {degree}"));
    }
}

/// A law with its tangent.
struct Law<const C: usize, const N: usize> {
    stress: fn(&Vector<N>, &Matrix<C, N>) -> Stress<C, N>,
    tangent: fn(&Vector<N>, &Matrix<C, N>) -> Tangent<C, N>,
    symmetric: bool,
}

impl<const C: usize, const N: usize> Law<C, N> {
    fn at<'a>(&self, state: &'a [f64]) -> Form<'a, C, N> {
        Form::new(Coefficient::PerState(Box::new(self.tangent)), self.symmetric).with_state(state)
    }
}

const fn finite<const N: usize>() -> Law<N, N> {
    Law { stress: neo_hooke, tangent: neo_hooke_tangent, symmetric: true }
}

/// Errors of the difference quotients of forces and energy.
fn differences<const C: usize, const N: usize>(space: &dyn Space<N, N>, law: &Law<C, N>, what: &str) -> [f64; 2] {
    let rules = gauss_rules(space, 0);
    let u = unknowns::<C, N>(space, 1, 0.3 / N as f64);
    let forces = |u: &[f64]| internal_force::<C, N, f64, _, _>(space, &rules, u, &law.stress).unwrap();
    let (matrix, force) = (stiffness(space, &rules, &law.at(&u)), forces(&u).0);
    let mut most = [0.0f64; 2];
    for seed in [2, 3] {
        let v = unknowns::<C, N>(space, seed, 1.0);
        let [(r1, w1), (r0, w0)] = [STEP, -STEP].map(|t| forces(&moved(&u, t, &v)));
        let quotient: Vec<f64> = r1.iter().zip(&r0).map(|(a, b)| (a - b) / (2.0 * STEP)).collect();
        most[0] = most[0].max(off(&product(&matrix, &v), &quotient));
        if law.symmetric {
            let work: f64 = force.iter().zip(&v).map(|(r, v)| r * v).sum();
            let size: f64 = force.iter().zip(&v).map(|(r, v)| (r * v).abs()).sum();
            most[1] = most[1].max((work - (w1 - w0) / (2.0 * STEP)).abs() / size);
        }
    }
    assert!(most.iter().all(|&m| m <= DIFFERENCE), "{what}: off by {most:?}");
    most
}

/// Matrix, operator, forces, energy and norms against those of the plain loop.
fn compare<const C: usize, const N: usize>(space: &dyn Space<N, N>, law: &Law<C, N>, what: &str) -> f64 {
    let (rules, plain) = (gauss_rules(space, 0), Plain(space));
    let u = unknowns::<C, N>(space, 1, 0.3 / N as f64);
    let form = law.at(&u);
    let (fast, slow) = (stiffness(space, &rules, &form), stiffness(&plain, &rules, &form));
    assert!(fast.vals() != slow.vals(), "{what}: two ways are what is tested");
    let mut most = vec![apart(&fast, &slow)];
    if law.symmetric {
        let at = |i: usize, j: usize, v: &f64| v.to_bits() == fast.get(j, i).to_bits();
        assert!((0..fast.num_rows()).all(|i| fast.row(i).0.zip(fast.row(i).1).all(|(j, v)| at(i, j, v))), "{what}: symmetric");
    }
    // refilled from another state
    let mut again = stiffness(space, &rules, &law.at(&[]));
    assert!(again.vals() != fast.vals(), "{what}: the state matters");
    Assembler::new(space, &rules).refill_stiffness(space, &rules, &form, &mut again);
    assert!(again.vals() == fast.vals(), "{what}: the same bits where a matrix is refilled");

    let x: Vec<f64> = (0..fast.num_rows()).map(|k| noise(9 * k) - 0.5).collect();
    let (y, diagonal) = (product(&slow, &x), slow.diagonal());
    for operator in [MatrixFree::new(space, &rules, &form), MatrixFree::lean(space, &rules, &form)] {
        most.extend([off(&product(&operator, &x), &y), off(&operator.diagonal(), &diagonal)]);
    }
    let operator = MatrixFree::new(&plain, &rules, &form);
    most.extend([off(&product(&operator, &x), &y), off(&operator.diagonal(), &diagonal)]);

    let (r, w) = internal_force(space, &rules, &u, &law.stress).unwrap();
    let (r0, w0) = internal_force(&plain, &rules, &u, &law.stress).unwrap();
    assert!(r != r0, "{what}: two ways are what is tested");
    most.extend([off(&r, &r0), (w - w0).abs() / w0.abs().max(1e-300)]);
    let exact = |x: &Vector<N>| (Vector::<C>::repeat(x[0].sin()), Matrix::<C, N>::repeat(x[1]));
    let [a, b] = [&errors(space, &rules, &form, &x, &exact), &errors(&plain, &rules, &form, &x, &exact)].map(|e| *e);
    most.extend([off(&[a.error.energy], &[b.error.energy]), off(&[a.exact.energy], &[b.exact.energy])]);
    assert!(most.iter().all(|&m| m <= SAME), "{what}: apart by {most:?}");
    largest(most)
}

/// A linear law has the matrix of its constant tangent, and forces and energy of that matrix.
fn linear<const N: usize>(space: &dyn Space<N, N>, what: &str) -> f64 {
    let (rules, tangent) = (gauss_rules(space, 0), hooke::<N>());
    let u = unknowns::<N, N>(space, 1, 0.3);
    let constant = stiffness(space, &rules, &Form::<N, N>::new(Coefficient::Constant(tangent), true));
    let form = Form::<N, N>::new(Coefficient::PerState(Box::new(move |_, _| tangent)), true).with_state(&u);
    let answer = |_: &Vector<N>, h: &Matrix<N, N>| {
        let stress = contract(&tangent, h);
        Some((stress, 0.5 * stress.dot(h)))
    };
    let (force, energy) = internal_force(space, &rules, &u, &answer).unwrap();
    let expected = product(&constant, &u);
    let half = 0.5 * u.iter().zip(&expected).map(|(u, r)| u * r).sum::<f64>();
    let most = [apart(&stiffness(space, &rules, &form), &constant), off(&force, &expected), off(&[energy], &[half])];
    assert!(most.iter().all(|&m| m <= SAME), "{what}: apart by {most:?}");
    largest(most)
}

/// No state is a state of zeros, and the tangent at rest.
fn nothing<const N: usize>(space: &dyn Space<N, N>, what: &str) {
    let rules = gauss_rules(space, 0);
    let zeros = vec![0.0; N * space.num_functions()];
    let rest = Form::<N, N>::new(Coefficient::PerPoint(Box::new(|x| neo_hooke_tangent(x, &Matrix::zeros()))), true);
    let [empty, zero] = [&[][..], &zeros].map(|state| stiffness(space, &rules, &finite::<N>().at(state)));
    let rest = stiffness(space, &rules, &rest);
    assert!(empty.vals() == rest.vals() && zero.vals() == rest.vals(), "{what}: the tangent at rest");
    for space in [space, &Plain(space)] {
        let [none, zero] = [&[][..], &zeros].map(|u| internal_force(space, &rules, u, &neo_hooke::<N>).unwrap());
        assert!(none == zero && none.1 == 0.0 && none.0.iter().all(|&r| r == 0.0), "{what}: nothing at rest");
    }
}

/// The error names the first point where det F <= 0; returns whether there was one that is not the very first of all.
fn collapses<const N: usize>(space: &dyn Space<N, N>, what: &str) -> bool {
    let (rules, mut later) = (gauss_rules(space, 0), false);
    for size in [0.5, 0.8, 1.0, 1.3, 3.0] {
        let u = unknowns::<N, N>(space, 1, size);
        for space in [space, &Plain(space)] {
            let bad = |_: usize, states: &[FieldAt<N, N>]| states.iter().position(|s| kinematics(&s.gradient).is_none());
            let all = fields(space, &rules, &u, &bad);
            let first = all.iter().enumerate().find_map(|(element, point)| point.map(|point| Collapsed { element, point }));
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let found = pool.install(|| internal_force(space, &rules, &u, &neo_hooke::<N>).err());
                assert_eq!(found, first, "{what}, gradients up to {size}");
            }
            later |= first.is_some_and(|first| first.element > 0 && first.point > 0 || first.element > 3);
        }
    }
    later
}

/// Matrix, forces and energy have the same bits for any number of threads.
fn threads<const N: usize>(space: &dyn Space<N, N>, what: &str) {
    let rules = gauss_rules(space, 0);
    let u = unknowns::<N, N>(space, 1, 0.1);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let form = finite::<N>().at(&u);
            let (mut all, energy) = internal_force(space, &rules, &u, &neo_hooke::<N>).unwrap();
            all.push(energy);
            all.extend(product(&MatrixFree::new(space, &rules, &form), &u));
            all.extend(stiffness(space, &rules, &form).vals());
            all
        })
    };
    let one = run(1);
    for threads in [2, 4, 7] {
        assert!(run(threads).iter().zip(&one).all(|(a, b)| a.to_bits() == b.to_bits()), "{what}: {threads} threads");
    }
}

#[test]
fn the_matrix_is_the_derivative_of_the_forces_and_these_are_that_of_the_energy() {
    let mut most = [0.0f64; 2];
    let mut add = |own: [f64; 2]| most = std::array::from_fn(|k| most[k].max(own[k]));
    plane(&mut |space, what| {
        add(differences(space, &finite(), what));
        add(differences(&Plain(space), &finite(), what));
        let flow = Law { stress: flow::<1, 2>, tangent: flow_tangent, symmetric: false };
        add(differences(space, &flow, what));
    });
    solid(&mut |space, what| {
        add(differences(space, &finite(), what));
        add(differences(&Plain(space), &finite(), what));
    });
    println!("differences: off by {most:?} at most");
}

#[test]
fn every_path_gives_what_the_plain_loop_gives() {
    let mut most = 0.0f64;
    plane(&mut |space, what| {
        most = most.max(compare(space, &finite(), what));
        most = most.max(compare(space, &Law { stress: flow::<1, 2>, tangent: flow_tangent, symmetric: false }, what));
        most = most.max(compare(space, &Law { stress: flow::<4, 2>, tangent: flow_tangent, symmetric: false }, what));
    });
    solid(&mut |space, what| {
        most = most.max(compare(space, &finite(), what));
        most = most.max(compare(space, &Law { stress: flow::<2, 3>, tangent: flow_tangent, symmetric: false }, what));
    });
    println!("paths: apart by {most:.1e} at most");
}

#[test]
fn operators_contract_states_on_patches() {
    let axes = || [smooth(2, 4), spline(3, 4)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    let (rules, u) = (gauss_rules(&space, 0), unknowns::<2, 2>(&space, 1, 0.1));
    let form = finite::<2>().at(&u);
    let [kept, lean] = [MatrixFree::new(&space, &rules, &form), MatrixFree::lean(&space, &rules, &form)];
    assert!(kept.is_contracted() && lean.is_contracted());
    let points: usize = fields(&space, &rules, &[], &|_, states: &[FieldAt<1, 2>]| states.len()).into_iter().sum();
    // 4 x 4 numbers of a symmetric tangent per point
    assert!(kept.bytes() >= 8 * 10 * points && lean.bytes() < 8 * 10 * points, "{} and {} bytes", kept.bytes(), lean.bytes());
}

#[test]
fn a_linear_law_has_the_constant_matrix_and_its_forces() {
    let mut most = 0.0f64;
    plane(&mut |space, what| most = most.max(linear(space, what).max(linear(&Plain(space), what))));
    solid(&mut |space, what| most = most.max(linear(space, what)));
    println!("linear law: apart by {most:.1e} at most");
}

#[test]
fn no_state_is_a_gradient_of_zero() {
    plane(&mut |space, what| nothing(space, what));
    solid(&mut |space, what| nothing(space, what));
}

#[test]
fn a_collapsed_state_is_located() {
    let mut later = [0; 2];
    plane(&mut |space, what| later[0] += usize::from(collapses(space, what)));
    solid(&mut |space, what| later[1] += usize::from(collapses(space, what)));
    assert!(later[0] > 4 && later[1] > 3, "points beyond the first ones: {later:?}");
    assert_eq!(Collapsed { element: 7, point: 3 }.to_string(), "the state has no stress at point 3 of element 7");
}

#[test]
fn states_give_the_same_bits_for_any_number_of_threads() {
    plane(&mut |space, what| threads(space, what));
    solid(&mut |space, what| threads(space, what));
}

#[test]
#[should_panic(expected = "has 120 unknowns, not 3")]
fn a_state_of_another_length_is_refused() {
    let axes = || [smooth(2, 4), spline(3, 4)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    let _ = stiffness(&space, &gauss_rules(&space, 0), &finite::<2>().at(&[0.0; 3]));
}

#[test]
#[should_panic(expected = "unknowns, not 5")]
fn forces_of_another_length_are_refused() {
    let axes = || [smooth(2, 4), spline(3, 4)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    let _ = internal_force(&space, &gauss_rules(&space, 0), &[0.0; 5], &neo_hooke::<2>);
}
