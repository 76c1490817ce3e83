//! Tests for the same bits at every SIMD width: AVX2 against AVX-512 if the processor has both.

use super::map::Ask;
use super::{Free, Patches, QuadraturePoints};
use crate::assembly::{Coefficient, Form, gauss_rules};
use crate::basis::{BSpline, Basis, Rational, TensorProduct};
use crate::geometry::ControlPoints;
use crate::linalg::{Csr, Matrix, Vector};
use crate::space::{FieldAt, Space};
use pulp::x86::{V3, V4};

/// A bent box over splines of mixed degrees, 9 elements along the slowest direction.
fn bent<const N: usize>(degrees: [usize; N]) -> (TensorProduct<N, BSpline<f64>>, Vec<Vector<N>>) {
    let axes = std::array::from_fn(|k| BSpline::uniform(degrees[k], [5, 7, 9][k], degrees[k] as isize - 1));
    let basis = TensorProduct::new(axes);
    let counts = basis.axes().each_ref().map(Basis::<1>::num_functions);
    let points = (0..basis.num_functions())
        .map(|i| {
            let at: [f64; N] = std::array::from_fn(|k| (i / counts[..k].iter().product::<usize>() % counts[k]) as f64 / counts[k] as f64);
            Vector::from_fn(|k, _| at[k] + 0.2 * (at[(k + 1) % N] * 2.0 + k as f64).sin())
        })
        .collect();
    (basis, points)
}

/// Isotropic elasticity with Lame's numbers 0.6 and 0.4.
fn elastic<const N: usize>() -> Form<'static, N, N> {
    let same = |a: usize, b: usize| f64::from(u8::from(a == b));
    let entry = |i, j, k, l| 0.6 * same(i, j) * same(k, l) + 0.4 * (same(i, k) * same(j, l) + same(i, l) * same(j, k));
    let tangent = std::array::from_fn(|i| std::array::from_fn(|j| Matrix::from_fn(|k, l| entry(i, j, k, l))));
    Form::new(Coefficient::Constant(tangent), true)
}

/// The matrix with the lanes of `arch`.
fn matrix<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>, arch: pulp::Arch) -> Csr {
    let rules = gauss_rules(space, 0);
    let asks = || -> Box<Ask<'_>> { unreachable!("the map is a net") };
    let mut patches = Patches::new(space, &rules, &|e| space.map_structure().map_block(e), &asks).expect("products of splines");
    patches.patches.iter_mut().for_each(|patch| patch.arch = arch);
    let mut matrix = patches.csr(C);
    patches.stiffness(form, false, &mut matrix);
    matrix
}

fn same_bits<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>, widths: [pulp::Arch; 2]) {
    let [narrow, wide] = widths.map(|arch| matrix(space, form, arch));
    assert!(narrow.vals().iter().any(|v| *v != 0.0));
    let apart = narrow.vals().iter().zip(wide.vals()).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
    assert_eq!(apart, 0, "entries of {}", wide.num_entries());
    let [narrow, wide] = widths.map(|arch| sums(space, form, arch));
    assert!(narrow.iter().zip(&wide).all(|(a, b)| a.to_bits() == b.to_bits()), "without the matrix");
}

/// A tangent that varies with the gradient of a state.
fn stated<const N: usize>(state: &[f64]) -> Form<'_, N, N> {
    let Form { coefficient, .. } = elastic::<N>();
    let at = move |x: &Vector<N>, h: &Matrix<N, N>| coefficient.at(x, h).map(|row| row.map(|m| m * (1.0 + x[0] * h.norm_squared())));
    Form::new(Coefficient::PerState(Box::new(at)), true).with_state(state)
}

/// Product, diagonal, load, internal forces, squares and states with the lanes of `arch`.
fn sums<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>, arch: pulp::Arch) -> Vec<f64> {
    let rules = gauss_rules(space, 0);
    let asks = || -> Box<Ask<'_>> { unreachable!("the map is a net") };
    let patches = || {
        let mut patches = Patches::new(space, &rules, &|e| space.map_structure().map_block(e), &asks).expect("products of splines");
        patches.patches.iter_mut().for_each(|patch| patch.arch = arch);
        patches
    };
    let sine = |sites: &QuadraturePoints, out: &mut [f64]| {
        let size = out.len() * N / sites.x.len();
        out.iter_mut().enumerate().for_each(|(k, out)| *out = (sites.x[k / size * N] + k as f64 % size as f64).sin());
    };
    let (mut all, moments): (Vec<f64>, _) = patches().load(C, space.num_functions(), &sine);
    let x = all.clone();
    all.extend(moments);
    let cubes = |sites: &QuadraturePoints, out: &mut [f64]| {
        for (h, out) in sites.gradients.chunks_exact(C * N).zip(out.chunks_exact_mut(C * N + 1)) {
            out.iter_mut().zip(h).for_each(|(out, h)| *out = h + h * h * h);
            out[C * N] = h.iter().sum();
        }
    };
    let (forces, energy) = patches().internal_force(C, space.num_functions(), &x, &cubes);
    all.extend(forces);
    all.push(energy);
    for keeps in [true, false] {
        let free = Free::new(patches(), form, keeps).expect("no merged functions");
        let mut y = vec![0.0; x.len()];
        free.apply(form, &asks, &x, &mut y);
        all.extend(&y);
        free.diagonal(form, &asks, &mut y);
        all.extend(&y);
    }
    all.extend(patches().deviation(form, &x, &sine));
    let numbers = |states: &[FieldAt<C, N>]| -> Vec<f64> {
        states.iter().flat_map(|s| s.x.iter().chain(&s.value).chain(&s.gradient).copied().collect::<Vec<_>>()).collect()
    };
    all.extend(patches().states(&x, &|(), _, states| numbers(states)).into_iter().flatten());
    all
}

#[test]
fn avx2_and_avx512_give_the_same_bits() {
    let (Some(v3), Some(v4)) = (V3::try_new(), V4::try_new()) else {
        println!("skipped: the processor lacks AVX2 or AVX-512");
        return;
    };
    let widths = [pulp::Arch::V3(v3), pulp::Arch::V4(v4)];
    for degrees in [[2, 3], [3, 3], [4, 2], [5, 1]] {
        let (basis, points) = bent(degrees);
        let weights = (0..points.len()).map(|i| 1.0 + 0.3 * (i as f64).sin()).collect();
        let splines = ControlPoints { basis: basis.clone(), points: points.clone() };
        same_bits(&splines, &Form::<1, 2>::laplace(), widths);
        same_bits(&splines, &elastic::<2>(), widths);
        let state: Vec<f64> = (0..2 * splines.points.len()).map(|i| 0.1 * (i as f64).sin()).collect();
        same_bits(&splines, &stated::<2>(&state), widths);
        same_bits(&ControlPoints { basis: Rational::new::<2>(basis, weights), points }, &Form::<1, 2>::laplace(), widths);
    }
    for degrees in [[2, 2, 2], [3, 2, 1], [3, 3, 3]] {
        let (basis, points) = bent(degrees);
        let splines = ControlPoints { basis, points };
        same_bits(&splines, &Form::<1, 3>::laplace(), widths);
        same_bits(&splines, &elastic::<3>(), widths);
        let state: Vec<f64> = (0..3 * splines.points.len()).map(|i| 0.1 * (i as f64).sin()).collect();
        same_bits(&splines, &stated::<3>(&state), widths);
    }
}
