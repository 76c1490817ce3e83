//! Inf-sup constants of multiplier spaces against independent tables, and the verdicts that follow.

use faying::basis::{Basis, Extracted, Order, ShapeTable};
use faying::coupling::inf_sup::{
    Grams, InfSupError, Measure, Method, Norm, Question, Verdict, degree_exponent, grams, inf_sup, slope, verdict,
};
use faying::coupling::multiplier::{Ends, MultiplierKind, build, side_ends};
use faying::geometry::shapes;
use faying::linalg::{Csr, Triplets, Vector};
use faying::quadrature::gauss_legendre;
use faying::space::{BasisKind, Body, Mapping, Mesh, Patch, PatchSpec, Trace};

/// The tables print six digits.
const DIGITS: f64 = 1e-6;

#[derive(Clone, Copy, PartialEq, Debug)]
enum Backend {
    Iga,
    /// C^0 splines.
    Kinked,
    Fe,
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum At {
    Zero,
    Free,
}

fn spec(degree: usize, n: usize) -> PatchSpec<2> {
    PatchSpec::new(shapes::rectangle([0.0, 0.0], [1.0, 1.0]).unwrap()).with_degree([degree, 1]).with_elements([n, 1])
}

fn side_of(backend: Backend, spec: PatchSpec<2>, name: &str) -> Trace<1, 2> {
    match backend {
        Backend::Iga => Patch::<1, 2>::try_new(&spec).unwrap().trace(name).unwrap(),
        Backend::Kinked => Patch::<1, 2>::try_new(&spec.with_continuity(0)).unwrap().trace(name).unwrap(),
        // meshes have one degree
        Backend::Fe => Mesh::<1, 2>::from_patch(&{
            let p = spec.degree[0].max(spec.degree[1]);
            spec.with_degree([p, p])
        })
        .unwrap()
        .trace(name)
        .unwrap(),
    }
}

fn side(backend: Backend, degree: usize, n: usize) -> Trace<1, 2> {
    side_of(backend, spec(degree, n), "v0")
}

/// Numbers of the functions of W: those that do not vanish at an end are left out where both ends are zero.
fn functions(side: &Trace<1, 2>, at: At) -> Vec<Option<usize>> {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    let mut held = vec![false; side.dofs.len()];
    for end in side_ends(&*side.space).into_iter().filter(|_| at == At::Zero) {
        side.space.active(end.element, &mut ids);
        side.space.tabulate(end.element, &[Vector::<1>::new(end.at as f64)], Order::Values, &mut table);
        ids.iter().zip(table.values(0)).filter(|(_, v)| v.abs() > 1e-10).for_each(|(&i, _)| held[i] = true);
    }
    let mut next = 0..;
    held.iter().map(|&h| if h { None } else { next.next() }).collect()
}

fn multiplier(side: &Trace<1, 2>, kind: MultiplierKind, at: At) -> Box<dyn Basis<1>> {
    build(&side.space, kind, &[at == At::Zero; 2]).unwrap()
}

fn beta_with(side: &Trace<1, 2>, kind: MultiplierKind, at: At, question: &Question<'_>) -> f64 {
    inf_sup(&*side.space, &functions(side, at), &*multiplier(side, kind, at), question).unwrap().beta
}

fn beta(backend: Backend, degree: usize, n: usize, kind: MultiplierKind, at: At) -> f64 {
    beta_with(&side(backend, degree, n), kind, at, &Question::default())
}

/// p/p without lowered ends.
fn full(degree: usize) -> MultiplierKind {
    MultiplierKind::Uniform { degree, continuity: None, ends: Ends::Full }
}

fn assert_table(name: &str, found: f64, printed: f64) {
    assert!((found - printed).abs() < DIGITS, "{name}: {found:.8}, printed {printed}");
}

fn verdict_of(backend: Backend, degree: usize, kind: MultiplierKind, at: At) -> Verdict {
    let points: Vec<(f64, f64)> = [4, 8, 16, 32, 64].map(|n| (1.0 / n as f64, beta(backend, degree, n, kind, at))).to_vec();
    verdict(&points)
}

#[test]
fn p_over_p_minus_2_on_smooth_splines_has_the_printed_constants() {
    let table = [
        (2, [0.873201, 0.873060, 0.872876]),
        (3, [0.807025, 0.808955, 0.808955]),
        (4, [0.710807, 0.716356, 0.716356]),
        (5, [0.636363, 0.643118, 0.643118]),
        (6, [0.579974, 0.585156, 0.585158]),
    ];
    for (p, printed) in table {
        for (n, printed) in [8, 32, 128].into_iter().zip(printed) {
            assert_table(&format!("p = {p}, n = {n}"), beta(Backend::Iga, p, n, MultiplierKind::Lowered(2), At::Zero), printed);
        }
    }
}

#[test]
fn p_over_p_with_lowered_ends_on_smooth_splines_has_the_printed_constants() {
    let table = [
        (1, [0.880889, 0.880903, 0.880903]),
        (2, [0.784391, 0.784777, 0.784777]),
        (3, [0.723276, 0.724711, 0.724711]),
        (4, [0.682512, 0.685308, 0.685308]),
        (5, [0.654105, 0.658280, 0.658280]),
    ];
    for (p, printed) in table {
        for (n, printed) in [8, 32, 128].into_iter().zip(printed) {
            assert_table(&format!("p = {p}, n = {n}"), beta(Backend::Iga, p, n, MultiplierKind::Lowered(0), At::Zero), printed);
        }
    }
}

#[test]
fn lagrange_traces_with_lowered_ends_have_the_printed_constants() {
    for (p, printed) in [(1, 0.880903), (2, 0.752564), (3, 0.665411), (4, 0.602439)] {
        assert_table(&format!("p = {p}"), beta(Backend::Fe, p, 128, MultiplierKind::Lowered(0), At::Zero), printed);
    }
}

#[test]
fn full_p_over_p_is_zero_with_zero_ends_and_one_with_free_ends() {
    for backend in [Backend::Iga, Backend::Fe] {
        for p in 1..=4 {
            assert_eq!(beta(backend, p, 8, full(p), At::Zero), 0.0);
            // the same space twice
            assert!((beta(backend, p, 8, full(p), At::Free) - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn p_over_p_minus_1_is_zero_with_zero_ends_and_falls_with_h_with_free_ends() {
    for p in 2..=4 {
        assert!(beta(Backend::Iga, p, 8, MultiplierKind::Lowered(1), At::Zero) < 1e-12, "p = {p}");
    }
    for (n, printed) in [(8, 0.546663), (32, 0.153938), (128, 0.038787)] {
        assert_table(&format!("n = {n}"), beta(Backend::Iga, 2, n, MultiplierKind::Lowered(1), At::Free), printed);
    }
    // the table itself falls by 3.9688 from 32 to 128: slope 0.9944
    let points = [32, 64, 128].map(|n| (1.0 / n as f64, beta(Backend::Iga, 2, n, MultiplierKind::Lowered(1), At::Free)));
    assert!((slope(&points).unwrap() - 0.9944).abs() < 1e-3, "{points:?}");
}

#[test]
fn kinked_splines_and_lagrange_traces_have_the_closed_constant_of_discontinuous_multipliers() {
    for p in 2..=6usize {
        let q = p as f64;
        let exact = (2.0 * (2.0 * q + 1.0) / ((q + 1.0) * (q + 2.0))).sqrt();
        for backend in [Backend::Kinked, Backend::Fe] {
            for n in [1, 3, 8] {
                let found = beta(backend, p, n, MultiplierKind::Lowered(2), At::Zero);
                assert!((found - exact).abs() < 1e-10, "{backend:?}, p = {p}, n = {n}: {found}, exact {exact}");
                // one function too many on every side
                assert_eq!(beta(backend, p, n, MultiplierKind::Lowered(1), At::Zero), 0.0, "{backend:?}, p = {p}, n = {n}");
            }
        }
    }
}

#[test]
fn continuous_multipliers_of_one_degree_less_are_stable_on_kinked_splines_and_lagrange_traces() {
    for (p, printed) in [(2, 0.769), (3, 0.673), (4, 0.606), (5, 0.557), (6, 0.518)] {
        let kind = MultiplierKind::Uniform { degree: p - 1, continuity: Some(0), ends: Ends::Auto };
        for backend in [Backend::Kinked, Backend::Fe] {
            let found = beta(backend, p, 64, kind, At::Zero);
            assert!((found - printed).abs() < 5e-4, "{backend:?}, p = {p}: {found}, printed {printed}");
            assert_eq!(verdict_of(backend, p, kind, At::Zero), Verdict::Stable, "{backend:?}, p = {p}");
        }
    }
}

#[test]
fn verdicts_are_those_of_the_theory() {
    for backend in [Backend::Iga, Backend::Fe] {
        for p in 2..=6 {
            assert_eq!(verdict_of(backend, p, MultiplierKind::Lowered(2), At::Zero), Verdict::Stable, "{backend:?}, {p}/{}", p - 2);
            assert_eq!(verdict_of(backend, p, MultiplierKind::Lowered(0), At::Zero), Verdict::Stable, "{backend:?}, {p}/{p}");
            assert_eq!(verdict_of(backend, p, full(p), At::Zero), Verdict::Unstable, "{backend:?}, {p}/{p} with full ends");
            assert_eq!(verdict_of(backend, p, MultiplierKind::Lowered(1), At::Zero), Verdict::Unstable, "{backend:?}, {p}/{}", p - 1);
            assert_eq!(verdict_of(backend, p, full(p), At::Free), Verdict::Stable, "{backend:?}, {p}/{p}, free ends");
        }
        for p in 4..=6 {
            assert_eq!(verdict_of(backend, p, MultiplierKind::Lowered(4), At::Zero), Verdict::Stable, "{backend:?}, {p}/{}", p - 4);
        }
    }
    assert_eq!(verdict_of(Backend::Iga, 2, MultiplierKind::Lowered(1), At::Free), Verdict::Unstable);
    assert!(build(&side(Backend::Iga, 3, 4).space, MultiplierKind::Lowered(4), &[]).is_err());
}

#[test]
fn the_constant_falls_with_the_degree_like_a_power() {
    let points: Vec<(f64, f64)> = (2..=6).map(|p| (p as f64, beta(Backend::Iga, p, 32, MultiplierKind::Lowered(2), At::Zero))).collect();
    let a = degree_exponent(&points).unwrap();
    // the table itself, n = 32, p = 2..6, fitted by hand: ln(0.585156 / 0.873060) / ln 3 = -0.364 between its ends
    assert!((-0.7..-0.2).contains(&a), "{a}");
}

#[test]
fn one_element_has_more_multipliers_than_trace_functions() {
    for p in 1..=3 {
        let side = side(Backend::Iga, p, 1);
        let psi = build(&side.space, full(p), &[]).unwrap();
        let found = inf_sup(&*side.space, &functions(&side, At::Zero), &*psi, &Question::default()).unwrap();
        assert_eq!((found.beta, found.functions, found.multipliers), (0.0, p - 1, p + 1));
    }
}

#[test]
fn multipliers_on_other_elements_and_dependent_functions_are_errors() {
    let (one, two) = (side(Backend::Iga, 2, 4), side(Backend::Iga, 2, 8));
    let psi = multiplier(&two, MultiplierKind::Lowered(2), At::Free);
    let wrong = inf_sup(&*one.space, &functions(&one, At::Free), &*psi, &Question::default()).unwrap_err();
    assert_eq!(wrong, InfSupError::Elements { expected: 4, found: 8 });
    // two trace functions made one, and numbers with a hole: the function of that number vanishes
    let mut numbers = functions(&one, At::Free);
    numbers[1] = None;
    let psi = multiplier(&one, MultiplierKind::Lowered(2), At::Free);
    for method in [Method::Dense, Method::Iterative] {
        let question = Question { method, ..Question::default() };
        let wrong = inf_sup(&*one.space, &numbers, &*psi, &question).unwrap_err();
        assert_eq!(wrong, InfSupError::Dependent { space: "trace" }, "{method:?}");
    }
}

fn both(side: &Trace<1, 2>, kind: MultiplierKind, at: At) -> (f64, f64) {
    let question = |method| Question { method, ..Question::default() };
    (beta_with(side, kind, at, &question(Method::Dense)), beta_with(side, kind, at, &question(Method::Iterative)))
}

#[test]
fn the_iterative_method_is_the_dense_one() {
    for backend in [Backend::Iga, Backend::Kinked, Backend::Fe] {
        for p in [1, 2, 3, 5] {
            for n in [5, 60, 200] {
                let side = side(backend, p, n);
                for (kind, at) in [
                    (MultiplierKind::Lowered(0), At::Zero),
                    (MultiplierKind::Lowered(0), At::Free),
                    (MultiplierKind::Lowered(1), At::Zero),
                    (MultiplierKind::Lowered(1), At::Free),
                    (MultiplierKind::Lowered(2), At::Zero),
                    (MultiplierKind::Constant, At::Zero),
                ] {
                    if kind == MultiplierKind::Lowered(2) && p < 2 || p * n > 400 {
                        continue;
                    }
                    let (dense, iterative) = both(&side, kind, at);
                    assert!((dense - iterative).abs() < 1e-8, "{backend:?}, p = {p}, n = {n}, {kind:?}, {at:?}: {dense} {iterative}");
                }
            }
        }
    }
}

#[test]
fn zeros_come_out_at_round_off_in_both_methods() {
    for n in [8, 100] {
        let (dense, iterative) = both(&side(Backend::Iga, 2, n), MultiplierKind::Lowered(1), At::Zero);
        assert!(dense < 1e-13 && iterative < 1e-13, "n = {n}: {dense:e}, {iterative:e}");
    }
}

/// Matrices with given singular values: diagonal ones in a basis of neighbours.
fn made(values: &[f64]) -> Grams {
    let n = values.len();
    let identity = |n: usize| {
        let mut a = Triplets::new(n, n);
        (0..n).for_each(|i| a.push(i, i, 1.0));
        a.to_csr()
    };
    let mut mixed = Triplets::new(n, n);
    // rotations of neighbours keep singular values
    for k in (0..n).step_by(2) {
        if k + 1 == n {
            mixed.push(k, k, values[k]);
            continue;
        }
        let (s, c) = (k as f64 + 0.3).sin_cos();
        for (i, row) in [[c * values[k], -s * values[k + 1]], [s * values[k], c * values[k + 1]]].into_iter().enumerate() {
            row.into_iter().enumerate().for_each(|(j, v)| mixed.push(k + i, k + j, v));
        }
    }
    let mixed: Csr = mixed.to_csr();
    Grams { trace: identity(n), multiplier: identity(n), mixed, h: 1.0 }
}

#[test]
fn the_iterative_method_finds_lone_clustered_and_multiple_smallest_values() {
    let n = 1000;
    let band = |k: usize| 0.5 + 0.5 * (k as f64 / n as f64).powi(2);
    let cases: [(&str, Vec<f64>, f64); 6] = [
        ("the edge of a band", (0..n).map(band).collect(), 0.5),
        ("all the same", vec![0.7; n], 0.7),
        ("one far below a band", (0..n).map(|k| if k == 777 { 0.1 } else { band(k) }).collect(), 0.1),
        ("one just below a band", (0..n).map(|k| if k == 777 { 0.499999 } else { band(k) }).collect(), 0.499999),
        ("several zeros", (0..n).map(|k| if k % 300 == 7 { 0.0 } else { band(k) }).collect(), 0.0),
        ("a pair that nearly agrees", (0..n).map(|k| [0.3, 0.3 + 1e-9, 0.9][k.min(2)]).collect(), 0.3),
    ];
    for (name, values, wanted) in cases {
        let (found, _) = made(&values).smallest(Method::Iterative).unwrap();
        assert!((found - wanted).abs() < 1e-8, "{name}: {found}, wanted {wanted}");
    }
}

#[test]
fn thousands_of_elements_keep_the_constant() {
    for (backend, p, kind, wanted) in [
        (Backend::Iga, 3, MultiplierKind::Lowered(2), 0.808955),
        (Backend::Iga, 2, MultiplierKind::Lowered(0), 0.784777),
        (Backend::Kinked, 2, MultiplierKind::Lowered(2), 0.912871),
    ] {
        let side = side(backend, p, 3000);
        let found = inf_sup(&*side.space, &functions(&side, At::Zero), &*multiplier(&side, kind, At::Zero), &Question::default()).unwrap();
        assert!(found.iterations > 0);
        assert_table(&format!("{backend:?}, p = {p}"), found.beta, wanted);
    }
    // O(h): eight times the elements of the table's 128 have an eighth of its constant, up to what is left at 128 (0.3 %)
    let found = beta(Backend::Iga, 2, 1024, MultiplierKind::Lowered(1), At::Free);
    assert!((found / (0.038787 / 8.0) - 1.0).abs() < 5e-3, "{found}");
}

#[test]
fn a_ring_has_the_table_in_its_parameter_and_nearly_so_in_its_length() {
    let ring = |p: usize, n: usize, basis: BasisKind| {
        let net = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap();
        PatchSpec::new(net).with_degree([p, p]).with_elements([n, 2]).with_basis(basis)
    };
    for (p, kind, printed) in
        [(2, MultiplierKind::Lowered(2), 0.873060), (3, MultiplierKind::Lowered(2), 0.808955), (2, MultiplierKind::Lowered(0), 0.784777)]
    {
        let side = side_of(Backend::Iga, ring(p, 32, BasisKind::BSpline), "v0");
        let sizes = vec![1.0 / 32.0; 32];
        let parametric = Question { measure: Measure::Parametric(&sizes), ..Question::default() };
        assert_table("parameter", beta_with(&side, kind, At::Zero, &parametric), printed);
        // the speed of the arc varies by sqrt(2): so does no ratio of norms by more
        for basis in [BasisKind::BSpline, BasisKind::Nurbs] {
            let points: Vec<(f64, f64)> = [8, 16, 32, 64]
                .map(|n| {
                    let side = side_of(Backend::Iga, ring(p, n, basis), "v0");
                    (1.0 / n as f64, beta_with(&side, kind, At::Zero, &Question::default()))
                })
                .to_vec();
            assert_eq!(verdict(&points), Verdict::Stable, "{points:?}");
            // locally the side is straight and its speed constant
            assert!((points[3].1 - printed).abs() < 2e-3, "{points:?}");
        }
    }
    let side = side_of(Backend::Fe, ring(3, 64, BasisKind::Auto).with_mapping(Mapping::Exact), "v1");
    let found = beta_with(&side, MultiplierKind::Lowered(2), At::Zero, &Question::default());
    assert!((found - 0.836660).abs() < 2e-3, "{found}");
}

#[test]
fn the_norm_with_h_is_l2_on_uniform_grids_and_another_one_on_graded_grids() {
    let half = Question { norm: Norm::HHalf, ..Question::default() };
    for backend in [Backend::Iga, Backend::Fe] {
        for p in [2, 3] {
            let side = side(backend, p, 16);
            for kind in [MultiplierKind::Lowered(0), MultiplierKind::Lowered(2)] {
                let (l2, h) = (beta_with(&side, kind, At::Zero, &Question::default()), beta_with(&side, kind, At::Zero, &half));
                assert!((l2 - h).abs() < 1e-12, "{backend:?}, p = {p}, {kind:?}: {l2} {h}");
            }
        }
    }
    let breakpoints: Vec<f64> = (0..=12).map(|k| (k as f64 / 12.0).powi(3)).collect();
    let graded = side_of(Backend::Iga, spec(2, 1).with_breakpoints([breakpoints, vec![0.0, 1.0]]), "v0");
    let by = |question: &Question<'_>| beta_with(&graded, MultiplierKind::Lowered(0), At::Zero, question);
    assert!((by(&Question::default()) - by(&half)).abs() > 1e-3);
    // discontinuous multipliers on Lagrange traces: one constant per element, whatever the norm; h falls out of every element
    let graded =
        side_of(Backend::Fe, spec(2, 1).with_breakpoints([(0..=12).map(|k| (k as f64 / 12.0).powi(3)).collect(), vec![0.0, 1.0]]), "v0");
    for question in [Question::default(), half] {
        let found = beta_with(&graded, MultiplierKind::Lowered(2), At::Zero, &question);
        assert!((0.5..1.0).contains(&found), "{found}");
    }
}

#[test]
fn grams_hold_the_length_of_the_side() {
    let side = side(Backend::Fe, 3, 5);
    let psi = multiplier(&side, MultiplierKind::Lowered(2), At::Free);
    let g = grams(&*side.space, &functions(&side, At::Free), &*psi, Measure::Physical, Norm::L2).unwrap();
    // functions of both spaces sum to one
    for matrix in [&g.trace, &g.multiplier, &g.mixed] {
        assert!((matrix.vals().iter().sum::<f64>() - 1.0).abs() < 1e-13);
    }
    assert!((g.h - 0.2).abs() < 1e-14);
}

/// With |w'| for traces with zero ends and its dual norm for multipliers the constant of p/p-2 is exactly one: the w with
/// -w'' = phi is a spline of degree p. The dual norm is that of the primitive: |phi|_-1 = |Phi - mean Phi|.
#[test]
fn the_constant_in_h1_and_its_dual_is_one() {
    for p in 2..=5 {
        for n in [1, 4, 9] {
            let side = side(Backend::Iga, p, n);
            let psi = multiplier(&side, MultiplierKind::Lowered(2), At::Zero);
            let numbers = functions(&side, At::Zero);
            let mut g = grams(&*side.space, &numbers, &*psi, Measure::Physical, Norm::L2).unwrap();
            let (h, m, rule) = (1.0 / n as f64, psi.num_functions(), gauss_legendre::<f64>(p + 1));
            let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
            let mut stiffness = Triplets::new(g.trace.num_rows(), g.trace.num_rows());
            // values of every primitive at every point, and their weights
            let (mut primitives, mut weights, mut so_far) = (vec![Vec::new(); m], Vec::new(), vec![0.0; m]);
            for e in 0..n {
                side.space.active(e, &mut ids);
                side.space.tabulate(e, &rule.points, Order::Gradients, &mut table);
                for (q, weight) in rule.weights.iter().enumerate() {
                    for (a, &i) in ids.iter().enumerate() {
                        for (b, &j) in ids.iter().enumerate() {
                            if let (Some(i), Some(j)) = (numbers[i], numbers[j]) {
                                stiffness.push(i, j, weight / h * table.grads(q)[a][0] * table.grads(q)[b][0]);
                            }
                        }
                    }
                }
                psi.active(e, &mut ids);
                let mut whole = so_far.clone();
                for (x, weight) in rule.points.iter().zip(&rule.weights) {
                    let inside: Vec<Vector<1>> = rule.points.iter().map(|y| y * x[0]).collect();
                    psi.tabulate(e, &inside, Order::Values, &mut table);
                    let mut here = so_far.clone();
                    for (q, w) in rule.weights.iter().enumerate() {
                        ids.iter().zip(table.values(q)).for_each(|(&j, v)| here[j] += h * x[0] * w * v);
                    }
                    primitives.iter_mut().zip(&here).for_each(|(list, v)| list.push(*v));
                    weights.push(h * weight);
                }
                psi.tabulate(e, &rule.points, Order::Values, &mut table);
                for (q, w) in rule.weights.iter().enumerate() {
                    ids.iter().zip(table.values(q)).for_each(|(&j, v)| whole[j] += h * w * v);
                }
                so_far = whole;
            }
            let dot = |a: &[f64], b: &[f64]| weights.iter().zip(a.iter().zip(b)).map(|(w, (a, b))| w * a * b).sum::<f64>();
            for list in &mut primitives {
                let mean: f64 = weights.iter().zip(list.iter()).map(|(w, v)| w * v).sum();
                list.iter_mut().for_each(|v| *v -= mean);
            }
            let mut dual = Triplets::new(m, m);
            for i in 0..m {
                for j in 0..m {
                    dual.push(i, j, dot(&primitives[i], &primitives[j]));
                }
            }
            (g.trace, g.multiplier) = (stiffness.to_csr(), dual.to_csr());
            for method in [Method::Dense, Method::Iterative] {
                let (beta, _) = g.smallest(method).unwrap();
                assert!((beta - 1.0).abs() < 1e-9, "p = {p}, n = {n}, {method:?}: {beta}");
            }
        }
    }
}

/// psi_0 = 2 N_0 - N_1, psi_1 = 2 N_1 - N_0 on every element. On even numbers of elements a cosine of four elements' length is
/// among the functions, where beta^2 = 3 / (4 - cos^2) is smallest.
#[test]
fn linear_biorthogonal_multipliers_have_half_the_root_of_three() {
    for backend in [Backend::Iga, Backend::Fe] {
        let n = 12;
        let side = side(backend, 1, n);
        let broken = build(&side.space, MultiplierKind::Uniform { degree: 1, continuity: Some(-1), ends: Ends::Full }, &[]).unwrap();
        let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); broken.num_functions()];
        let (mut ids, mut own) = (Vec::new(), Vec::new());
        for e in 0..n {
            broken.active(e, &mut ids);
            side.space.active(e, &mut own);
            (rows[ids[0]], rows[ids[1]]) = (vec![(own[0], 2.0), (own[1], -1.0)], vec![(own[0], -1.0), (own[1], 2.0)]);
        }
        let dual = Extracted::new::<1>(broken, n + 1, rows);
        for method in [Method::Dense, Method::Iterative] {
            let question = Question { method, ..Question::default() };
            let found = inf_sup(&*side.space, &functions(&side, At::Free), &dual, &question).unwrap();
            assert!((found.beta - 0.75f64.sqrt()).abs() < 1e-9, "{backend:?}, {method:?}: {}", found.beta);
        }
    }
}
