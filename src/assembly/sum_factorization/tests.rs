//! Same bits: strips and windows of every size, and SIMD widths.

/// Strips and windows of every size give the same bits, and what the plain loop gives.
mod cuts {
    use super::super::Patches;
    use super::super::coefficient::Coefficient;
    use super::super::sweep::SweepPlan;
    use crate::assembly::source::Integrand;
    use crate::assembly::{Coefficient as Given, Form, Pattern, Tangent, gauss_rules, kernels, plain};
    use crate::basis::{BSpline, Basis, Rational, TensorProduct};
    use crate::geometry::{ControlPoints, shapes};
    use crate::linalg::{Csr, Matrix, Vector};
    use crate::space::{BasisKind, Body, MultiPatch, Near, Patch, PatchSpec, Seam, Space};
    use std::sync::Arc;

    /// Entries may differ from the plain loop's by this share of the largest.
    const SAME: f64 = 1e-13;

    /// A number in [-0.5, 0.5] that looks random.
    fn noise(k: usize) -> f64 {
        (12.9898 * (k as f64 + 1.0)).sin() * 43_758.545 % 1.0 / 2.0
    }

    /// Control points of a bent box.
    fn bent<const N: usize>(axes: &[BSpline<f64>; N]) -> Vec<Vector<N>> {
        let counts = axes.each_ref().map(Basis::<1>::num_functions);
        let at = |i: usize, k: usize| (i / counts[..k].iter().product::<usize>() % counts[k]) as f64 / counts[k] as f64;
        let point = |i: usize| Vector::from_fn(|k, _| at(i, k) + 0.1 * (2.0 * at(i, (k + 1) % N) + k as f64).sin());
        (0..counts.iter().product()).map(point).collect()
    }

    /// A tangent of C components, that of an energy or of nothing.
    fn tangent<const C: usize, const N: usize>(symmetric: bool) -> Tangent<C, N> {
        let entry = |i: usize, j: usize, k: usize, l: usize| {
            let (a, b) = (N * i + j, N * k + l);
            let (a, b) = if symmetric { (a.min(b), a.max(b)) } else { (a, b) };
            f64::from(u8::from(a == b)) * 6.0 + noise(31 * a + b)
        };
        std::array::from_fn(|e| std::array::from_fn(|j| Matrix::from_fn(|c, l| entry(c, l, e, j))))
    }

    /// A form with that tangent, or with one that varies.
    fn form<const C: usize, const N: usize>(symmetric: bool, varies: bool) -> Form<'static, C, N> {
        let steady = tangent::<C, N>(symmetric);
        let at = move |x: &Vector<N>| steady.map(|row| row.map(|m| m * (1.0 + 0.3 * x[0])));
        let coefficient = if varies { Given::PerPoint(Box::new(at)) } else { Given::Constant(steady) };
        Form::new(coefficient, symmetric)
    }

    /// Unknowns of a state of C components.
    fn state<const C: usize, const N: usize>(space: &dyn Space<N, N>) -> Vec<f64> {
        (0..C * space.num_functions()).map(|k| 0.1 * noise(3 * k)).collect()
    }

    /// A form with a tangent that varies with the gradient of `state`.
    fn stated<const C: usize, const N: usize>(symmetric: bool, state: &[f64]) -> Form<'_, C, N> {
        let steady = tangent::<C, N>(symmetric);
        let at =
            move |x: &Vector<N>, h: &Matrix<C, N>| steady.map(|row| row.map(|m| m * (1.0 + 0.3 * x[0] + h[(C - 1, 0)] * h[(0, N - 1)])));
        Form::new(Given::PerState(Box::new(at)), symmetric).with_state(state)
    }

    /// Functions of the fast and of the middle direction in a strip, and of the latter in a window.
    type Sizes = [usize; 3];

    /// The matrix in strips and windows of these sizes, on top of `matrix`'s values where `add`.
    fn filled(
        patches: &Patches<'_>,
        coefficient: &Coefficient<'_>,
        [fast, middle, window]: Sizes,
        threads: usize,
        add: bool,
        matrix: &mut Csr,
    ) {
        let sized = |k| SweepPlan { strip: [fast, middle], window: [window; 2], ..patches.plan(k, coefficient) };
        let plans: Vec<SweepPlan<'_, '_>> = (0..patches.patches.len()).map(sized).collect();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| patches.fill_strips(&plans, add, matrix));
    }

    /// Largest difference of the values, relative to the largest of `b`.
    fn apart(a: &Csr, b: &Csr) -> f64 {
        let scale = b.vals().iter().fold(0.0f64, |m, v| m.max(v.abs()));
        assert!(a.vals().iter().all(|v| v.is_finite()));
        a.vals().iter().zip(b.vals()).fold(0.0f64, |m, (a, b)| m.max((a - b).abs())) / scale
    }

    /// Numbers whose bits differ.
    fn differ(a: &Csr, b: &Csr) -> usize {
        a.vals().iter().zip(b.vals()).filter(|(a, b)| a.to_bits() != b.to_bits()).count()
    }

    /// Strips of every size against the plain loop and against one strip; `asked`: the map is evaluated element by element.
    ///
    /// Merged functions are summed strip by strip: their bits may depend on the sizes, but not on the threads.
    fn check<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>, asked: bool, merged: bool) {
        let rules = gauss_rules(space, 0);
        let asks = || kernels::map_of::<N, N, f64, dyn Space<N, N>>(space);
        let patches = Patches::new(space, &rules, &|e| if asked { None } else { space.map_structure().map_block(e) }, &asks, None)
            .expect("products of splines");
        let coefficient = Coefficient { components: C, symmetric: form.symmetric, source: Integrand::new(form) };
        let to = patches.patches[0].directions();
        let (f, m) = (to.fast.functions, to.middle.functions);

        let empty: Csr = patches.csr(C);
        let mut whole = empty.clone();
        filled(&patches, &coefficient, [f, m, m], 1, false, &mut whole);
        let pattern = Pattern::new(space);
        let mut other = pattern.csr(C);
        plain::add_stiffness(&pattern, space, &rules, form, &mut other);
        let most = apart(&whole, &other);
        assert!(most > 0.0 && most <= SAME, "apart from the plain loop by {most:e}");

        // one function, last strips that are short, one strip, strips wider than the patch
        let sizes = [
            [1, 1, 1],
            [2, 3, 3],
            [3, 2, 1],
            [4, m, m],
            [f - 1, 4, 2],
            [f, (m - 1).max(1), 2],
            [f, 3, 4],
            [1, m, 2],
            [2 * f, 2 * m, 3 * m],
        ];
        for size in sizes {
            let mut first = None;
            for threads in [1, 4] {
                let mut matrix = empty.clone();
                matrix.vals_mut().fill(f64::NAN);
                filled(&patches, &coefficient, size, threads, false, &mut matrix);
                if form.symmetric {
                    assert_eq!(differ(&matrix.transposed(), &matrix), 0, "sizes {size:?}: symmetric to the last bit");
                }
                if merged {
                    let most = apart(&matrix, &whole);
                    assert!(most <= SAME, "sizes {size:?}, {threads} threads: apart by {most:e}");
                    let first = first.get_or_insert_with(|| matrix.clone());
                    assert_eq!(differ(&matrix, first), 0, "sizes {size:?}, {threads} threads and one");
                } else {
                    assert_eq!(differ(&matrix, &whole), 0, "sizes {size:?}, {threads} threads: of {} entries", whole.num_entries());
                }
            }
        }
        let mut twice = whole.clone();
        filled(&patches, &coefficient, [2, 3, 2], 2, true, &mut twice);
        whole.vals_mut().iter_mut().for_each(|v| *v *= 2.0);
        let most = apart(&twice, &whole);
        // what two patches add to an entry comes after what was there
        let exact = !merged && patches.patches.len() == 1;
        assert!(if exact { differ(&twice, &whole) == 0 } else { most <= SAME }, "added to itself: twice, apart by {most:e}");
    }

    /// [`check`] of one bent box, its map as a net and element by element.
    fn check_box<const C: usize, const N: usize>(axes: &dyn Fn() -> [BSpline<f64>; N], form: &Form<'_, C, N>) {
        let space = ControlPoints { basis: TensorProduct::new(axes()), points: bent(&axes()) };
        for asked in [false, true] {
            check::<C, N>(&space, form, asked, false);
        }
    }

    #[test]
    fn strips_of_every_size_give_the_same_bits_for_degrees_1_to_5() {
        for p in 1..=5 {
            let long = |p: usize, n| BSpline::uniform(p, n, p as isize - 1);
            check_box::<1, 3>(&|| [BSpline::uniform(2, 3, 1), long(p, 8), BSpline::uniform(1 + p % 2, 4, 0)], &form(p % 2 == 0, false));
            check_box::<1, 3>(&|| [long(p, 9), long(1 + p % 3, 5), BSpline::uniform(1 + p % 2, 4, 0)], &form(p % 2 == 1, p == 2));
        }
    }

    #[test]
    fn strips_cut_repeated_knots_where_they_like() {
        let breaks: Vec<f64> = [0.0, 1.0, 1.5, 3.0, 3.5, 5.0, 6.0].to_vec();
        for (p, continuity) in [(2, [1, 0, 1, -1, 0]), (3, [2, 0, 1, 0, -1]), (4, [0, 3, 1, 2, 0])] {
            let long = || BSpline::from_breakpoints(p, &breaks, &continuity);
            check_box::<1, 3>(&|| [BSpline::uniform(1, 3, 0), long(), BSpline::uniform(2, 5, 1)], &form(false, false));
            check_box::<1, 3>(&|| [long(), BSpline::uniform(2, 3, 0), BSpline::uniform(1, 3, 0)], &form(true, false));
        }
    }

    #[test]
    fn strips_of_vector_fields_and_rational_functions_give_the_same_bits() {
        let axes = || [BSpline::uniform(2, 6, 1), BSpline::uniform(2, 7, 1), BSpline::uniform(2, 4, 1)];
        for symmetric in [true, false] {
            check_box::<3, 3>(&axes, &form(symmetric, !symmetric));
        }
        let points = bent(&axes());
        let weights = (0..points.len()).map(|i| 1.0 + 0.3 * noise(i)).collect();
        let rational = ControlPoints { basis: Rational::new::<3>(TensorProduct::new(axes()), weights), points };
        for asked in [false, true] {
            check::<1, 3>(&rational, &form(true, asked), asked, false);
            check::<2, 3>(&rational, &stated(!asked, &state::<2, 3>(&rational)), asked, false);
        }
    }

    #[test]
    fn strips_of_glued_patches_and_of_merged_functions() {
        let brick = |x: f64| shapes::brick([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]).expect("a brick");
        let body = |x: f64, kind| {
            let spec = PatchSpec::new(brick(x)).with_degree([2, 3, 2]).with_elements([5, 4, 3]).with_basis(kind);
            Arc::new(Patch::<2, 3>::try_new(&spec).expect("a patch")) as Arc<dyn Body<2, 3>>
        };
        let bodies = vec![("a".to_owned(), body(0.0, BasisKind::BSpline)), ("b".to_owned(), body(1.0, BasisKind::BSpline))];
        let whole = MultiPatch::try_new(bodies, &[Seam::new((0, "u1"), (1, "u0"))], Near::Exact).expect("one body");
        check::<1, 3>(&**whole.space(), &form(true, false), false, false);
        check::<3, 3>(&**whole.space(), &form(false, false), true, false);
        check::<2, 3>(&**whole.space(), &stated(true, &state::<2, 3>(&**whole.space())), false, false);
        // collapsed edges: several functions of a patch are one of the whole
        let octant = shapes::sphere_octant([0.0; 3], [1.0, 2.0]).expect("an octant");
        let spec = PatchSpec::new(octant).with_degree([2, 3, 2]).with_elements([4, 3, 2]).with_basis(BasisKind::Nurbs);
        let octant = Patch::<2, 3>::try_new(&spec).expect("a patch");
        assert!(octant.space().structure().patches().is_some(), "sums of products are what is tested");
        check::<1, 3>(&**octant.space(), &form(true, false), false, true);
        check::<3, 3>(&**octant.space(), &form(true, false), false, true);
        check::<2, 3>(&**octant.space(), &stated(false, &state::<2, 3>(&**octant.space())), false, true);
    }

    #[test]
    fn lines_of_the_plane_are_cut_with_the_same_bits() {
        for p in 1..=4 {
            let axes = || [BSpline::uniform(p, 11, p as isize - 1), BSpline::uniform(1 + p % 3, 5, 0)];
            check_box::<1, 2>(&axes, &form(p % 2 == 0, p == 2));
            check_box::<2, 2>(&axes, &form(p % 2 == 1, p == 3));
            let points = bent(&axes());
            let weights = (0..points.len()).map(|i| 1.0 + 0.3 * noise(i)).collect();
            let rational = ControlPoints { basis: Rational::new::<2>(TensorProduct::new(axes()), weights), points };
            check::<1, 2>(&rational, &form(true, false), p % 2 == 0, false);
            check::<2, 2>(&rational, &stated(p % 2 == 0, &state::<2, 2>(&rational)), p % 2 == 0, false);
        }
        // a collapsed side: all its functions are one
        let disc = shapes::disc_sector([0.0; 2], 1.0, [0.0, 90.0]).expect("a disc");
        for kind in [BasisKind::Nurbs, BasisKind::BSpline] {
            let spec = PatchSpec::new(disc.clone()).with_degree([2, 3]).with_elements([9, 4]).with_basis(kind);
            let disc = Patch::<1, 2>::try_new(&spec).expect("a patch");
            check::<1, 2>(&**disc.space(), &form(true, false), false, true);
            check::<2, 2>(&**disc.space(), &form(true, false), false, true);
        }
    }

    #[test]
    fn long_lines_of_the_plane_are_cut() {
        for (long, strips) in [(500, 1), (510, 1), (600, 2), (2000, 4)] {
            let axes = [BSpline::uniform(2, long, 1), BSpline::uniform(2, 1, 1)];
            let points = bent(&axes);
            let space: &dyn Space<2, 2> = &ControlPoints { basis: TensorProduct::new(axes), points };
            let rules = gauss_rules(space, 0);
            let asks = || kernels::map_of::<2, 2, f64, dyn Space<2, 2>>(space);
            let patches = Patches::new(space, &rules, &|e| space.map_structure().map_block(e), &asks, None).expect("products of splines");
            let form = Form::<1, 2>::laplace();
            let coefficient = Coefficient { components: 1, symmetric: true, source: Integrand::new(&form) };
            assert_eq!(patches.plan(0, &coefficient).strips()[0].len(), strips, "{long} elements");
        }
    }

    #[test]
    fn strips_are_cut_where_sums_are_large_and_not_too_narrow() {
        for (p, long) in [(1, 9), (1, 200), (2, 30), (2, 120), (3, 40), (3, 90), (4, 60)] {
            let axes = || [BSpline::uniform(p, long, p as isize - 1), BSpline::uniform(p, long, p as isize - 1), BSpline::uniform(p, 1, 0)];
            let space: &dyn Space<3, 3> = &ControlPoints { basis: TensorProduct::new(axes()), points: bent(&axes()) };
            let rules = gauss_rules(space, 0);
            let asks = || kernels::map_of::<3, 3, f64, dyn Space<3, 3>>(space);
            let patches = Patches::new(space, &rules, &|e| space.map_structure().map_block(e), &asks, None).expect("products of splines");
            let form = Form::<1, 3>::laplace();
            let coefficient = Coefficient { components: 1, symmetric: true, source: Integrand::new(&form) };
            let (patch, functions, active) = (&patches.patches[0], long + p, p + 1);
            let [fast, middle] = patches.plan(0, &coefficient).strip;
            let bytes = 8 * functions * functions * active * patch.directions().sums(active);
            assert!(fast <= functions && middle <= functions);
            if bytes <= 3 << 20 {
                assert_eq!([fast, middle], [functions; 2], "p = {p}, {long}: {bytes} bytes in one strip");
            } else {
                assert!(fast < functions, "p = {p}, {long}: {bytes} bytes are cut");
                assert!(2 * fast >= 6 * active && 4 * middle >= 3 * 5 * active, "p = {p}, {long}: {fast} x {middle} are not narrow");
            }
        }
    }
}

/// Tests for the same bits at every SIMD width: AVX2 against AVX-512 if the processor has both.
#[cfg(target_arch = "x86_64")]
mod bits {
    use super::super::map::MapEvaluator;
    use super::super::{Free, Patches, QuadraturePoints};
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
                let at: [f64; N] =
                    std::array::from_fn(|k| (i / counts[..k].iter().product::<usize>() % counts[k]) as f64 / counts[k] as f64);
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
        let asks = || -> Box<MapEvaluator<'_>> { unreachable!("the map is a net") };
        let mut patches = Patches::new(space, &rules, &|e| space.map_structure().map_block(e), &asks, None).expect("products of splines");
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
        let asks = || -> Box<MapEvaluator<'_>> { unreachable!("the map is a net") };
        let patches = || {
            let mut patches =
                Patches::new(space, &rules, &|e| space.map_structure().map_block(e), &asks, None).expect("products of splines");
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
}
