//! Strips and windows of every size give the same bits, and what the plain loop gives.

use super::Patches;
use super::coefficient::Coefficient;
use super::map::Ask;
use super::march::Plan;
use crate::assembly::source::Source;
use crate::assembly::{Coefficient as Given, Form, Pattern, Tangent, gauss_rules, plain};
use crate::basis::{BSpline, Basis, Rational, TensorProduct};
use crate::geometry::ControlPoints;
use crate::linalg::{Csr, Matrix, Vector};
use crate::space::Space;

/// Entries may differ from the plain loop's by this share of the largest.
const SAME: f64 = 1e-13;

/// A number in [-0.5, 0.5] that looks random.
fn noise(k: usize) -> f64 {
    (12.9898 * (k as f64 + 1.0)).sin() * 43_758.545 % 1.0 / 2.0
}

/// Control points of a bent box.
fn bent(axes: &[BSpline<f64>; 3]) -> Vec<Vector<3>> {
    let counts = axes.each_ref().map(Basis::<1>::num_functions);
    let at = |i: usize, k: usize| (i / counts[..k].iter().product::<usize>() % counts[k]) as f64 / counts[k] as f64;
    let point = |i: usize| Vector::from_fn(|k, _| at(i, k) + 0.1 * (2.0 * at(i, (k + 1) % 3) + k as f64).sin());
    (0..counts.iter().product()).map(point).collect()
}

/// A tangent of C components, that of an energy or of nothing.
fn tangent<const C: usize>(symmetric: bool) -> Tangent<C, 3> {
    let entry = |i: usize, j: usize, k: usize, l: usize| {
        let (a, b) = (3 * i + j, 3 * k + l);
        let (a, b) = if symmetric { (a.min(b), a.max(b)) } else { (a, b) };
        f64::from(u8::from(a == b)) * 6.0 + noise(31 * a + b)
    };
    std::array::from_fn(|e| std::array::from_fn(|j| Matrix::from_fn(|c, l| entry(c, l, e, j))))
}

/// The matrix in strips and windows of these sizes, on top of `matrix`'s values where `add`.
fn filled(patches: &Patches<'_>, coefficient: &Coefficient<'_>, [strip, window]: [usize; 2], threads: usize, add: bool, matrix: &mut Csr) {
    let patch = &patches.patches[0];
    let plan = Plan { strip, window: [window; 2], ..Plan::new(patch, coefficient) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| patch.fill_strips(&plan, add, matrix.vals_mut()));
}

fn check<const C: usize>(space: &dyn Space<3, 3>, symmetric: bool) {
    let rules = gauss_rules(space, 0);
    let asks = || -> Box<Ask<'_>> { unreachable!("the map is a net") };
    let patches = Patches::new(space, &rules, &|e| space.map_block(e), &asks).expect("products of splines");
    let form = Form { coefficient: Given::Constant(tangent::<C>(symmetric)), symmetric };
    let coefficient = Coefficient { components: C, symmetric, source: Source::new(&form) };
    let middle = patches.patches[0].directions().middle.functions;

    let empty: Csr = patches.csr(C);
    let mut whole = empty.clone();
    filled(&patches, &coefficient, [middle, middle], 1, false, &mut whole);
    let pattern = Pattern::new(space);
    let mut other = pattern.csr(C);
    plain::add_stiffness(&pattern, space, &rules, &form, &mut other);
    let scale = other.vals().iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let apart = whole.vals().iter().zip(other.vals()).fold(0.0f64, |m, (a, b)| m.max((a - b).abs())) / scale;
    assert!(whole.vals().iter().all(|v| v.is_finite()) && apart > 0.0 && apart <= SAME, "apart from the plain loop by {apart:e}");

    // one function, a last strip that is short, one strip, one wider than the patch
    for (strip, window) in [(1, 1), (2, 3), (3, 1), (4, middle), (middle - 1, 2), (middle, 4), (2 * middle, 3 * middle)] {
        for threads in [1, 4] {
            let mut matrix = empty.clone();
            matrix.vals_mut().fill(f64::NAN);
            filled(&patches, &coefficient, [strip, window], threads, false, &mut matrix);
            let apart = matrix.vals().iter().zip(whole.vals()).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            assert_eq!(apart, 0, "strips of {strip}, windows of {window}, {threads} threads: of {} entries", whole.num_entries());
        }
    }
    let mut twice = whole.clone();
    filled(&patches, &coefficient, [3, 2], 2, true, &mut twice);
    assert!(twice.vals().iter().zip(whole.vals()).all(|(a, b)| *a == 2.0 * b), "added to itself: twice");
}

#[test]
fn strips_of_every_size_give_the_same_bits_for_degrees_1_to_5() {
    for p in 1..=5 {
        let axes = || [BSpline::uniform(2, 3, 1), BSpline::uniform(p, 8, p as isize - 1), BSpline::uniform(1 + p % 2, 4, 0)];
        check::<1>(&ControlPoints { basis: TensorProduct::new(axes()), points: bent(&axes()) }, p % 2 == 0);
    }
}

#[test]
fn strips_cut_repeated_knots_where_they_like() {
    let breaks: Vec<f64> = [0.0, 1.0, 1.5, 3.0, 3.5, 5.0, 6.0].to_vec();
    for (p, continuity) in [(2, [1, 0, 1, -1, 0]), (3, [2, 0, 1, 0, -1]), (4, [0, 3, 1, 2, 0])] {
        let axes = || [BSpline::uniform(1, 3, 0), BSpline::from_breakpoints(p, &breaks, &continuity), BSpline::uniform(2, 5, 1)];
        check::<1>(&ControlPoints { basis: TensorProduct::new(axes()), points: bent(&axes()) }, false);
    }
}

#[test]
fn strips_of_vector_fields_and_rational_functions_give_the_same_bits() {
    let axes = || [BSpline::uniform(2, 3, 1), BSpline::uniform(2, 7, 1), BSpline::uniform(2, 4, 1)];
    let points = bent(&axes());
    let weights = (0..points.len()).map(|i| 1.0 + 0.3 * noise(i)).collect();
    for symmetric in [true, false] {
        check::<3>(&ControlPoints { basis: TensorProduct::new(axes()), points: points.clone() }, symmetric);
    }
    check::<1>(&ControlPoints { basis: Rational::new::<3>(TensorProduct::new(axes()), weights), points }, true);
}
