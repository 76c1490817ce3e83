//! The contraction direction by direction against the plain loop, on every kind of patch.

#![allow(clippy::unwrap_used)]

use faying::assembly::{Coefficient, Form, Pattern, Tangent, add_stiffness, gauss_rules, mass, refill_stiffness, stiffness};
use faying::basis::{BSpline, Basis, Block, Elements, LagrangeLine, Order, Rational, Refined, ShapeTable, TensorProduct};
use faying::geometry::{Bounds, ControlPoints, Geometry, MapBlock, MapTable};
use faying::linalg::{Csr, Matrix, Vector};
use faying::physics::{Hooke, form};
use faying::quadrature::{Quadrature, TensorRule};
use faying::space::{Deformed, Over, Space};

/// Entries may differ by this share of the largest.
const SAME: f64 = 1e-13;
/// Places may differ by this share of the size.
const SAME_PLACE: f64 = 1e-12;

type Line = Box<dyn Basis<1>>;

/// Hides the product structure of functions and map: the plain loop.
#[derive(Debug)]
struct Plain<'a, const N: usize>(&'a dyn Space<N, N>);
impl<const N: usize> Elements for Plain<'_, N> {
    fn num_elements(&self) -> usize {
        self.0.num_elements()
    }
}
impl<const N: usize> Basis<N> for Plain<'_, N> {
    fn num_functions(&self) -> usize {
        self.0.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; N] {
        self.0.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.0.active(element, ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<N>], order: Order, table: &mut ShapeTable<N>) {
        self.0.tabulate(element, xi, order, table);
    }
}
impl<const N: usize> Geometry<N, N> for Plain<'_, N> {
    fn map(&self, element: usize, xi: &[Vector<N>], order: Order, table: &mut MapTable<N, N>) {
        self.0.map(element, xi, order, table);
    }
    fn bounds(&self, element: usize) -> Bounds<N> {
        self.0.bounds(element)
    }
}
impl<const N: usize> Space<N, N> for Plain<'_, N> {}

/// Hides the product structure of the map alone.
#[derive(Debug)]
struct Anyhow<G>(G);
impl<G: Elements> Elements for Anyhow<G> {
    fn num_elements(&self) -> usize {
        self.0.num_elements()
    }
}
impl<const N: usize, G: Geometry<N, N>> Geometry<N, N> for Anyhow<G> {
    fn map(&self, element: usize, xi: &[Vector<N>], order: Order, table: &mut MapTable<N, N>) {
        self.0.map(element, xi, order, table);
    }
    fn bounds(&self, element: usize) -> Bounds<N> {
        self.0.bounds(element)
    }
    fn map_block(&self, _: usize) -> Option<MapBlock<'_, N, N>> {
        None
    }
}

/// Numbers between 0 and 1 that look random.
fn noise(k: usize) -> f64 {
    (12.9898 * (k as f64 + 1.0)).sin().mul_add(43758.5453, 0.0).rem_euclid(1.0)
}

/// Graded elements.
fn breakpoints(elements: usize) -> Vec<f64> {
    (0..=elements).map(|k| (k as f64 / elements as f64).powf(1.4)).collect()
}

/// Graded splines whose knots are simple, double and p-fold (C^0) in turn.
fn spline(degree: usize, elements: usize) -> Line {
    let p = degree as isize;
    let continuity: Vec<isize> = (1..elements).map(|k| [p - 1, (p - 2).max(0), 0][k % 3]).collect();
    Box::new(BSpline::from_breakpoints(degree, &breakpoints(elements), &continuity))
}

/// Graded splines of maximal smoothness.
fn smooth(degree: usize, elements: usize) -> Line {
    Box::new(BSpline::from_breakpoints(degree, &breakpoints(elements), &vec![degree as isize - 1; elements - 1]))
}

fn lagrange(degree: usize, elements: usize) -> Line {
    Box::new(LagrangeLine::new(degree, elements))
}

/// A bent box: the net of `axes` at its own grid, moved a little; as many points as functions.
fn net<const N: usize>(axes: &[Line; N]) -> Vec<Vector<N>> {
    let counts = axes.each_ref().map(|a| a.num_functions());
    (0..counts.iter().product())
        .map(|i| {
            let at: [f64; N] =
                std::array::from_fn(|k| (i / counts[..k].iter().product::<usize>() % counts[k]) as f64 / (counts[k] - 1) as f64);
            let size = counts.iter().max().copied().unwrap_or(1) as f64;
            Vector::from_fn(|k, _| (1.0 + 0.5 * k as f64) * at[k] + 0.15 / size * noise(N * i + k) + 0.1 * at[(k + 1) % N] * at[k])
        })
        .collect()
}

fn weights(functions: usize) -> Vec<f64> {
    (0..functions).map(|i| 0.7 + 0.6 * noise(7 * i)).collect()
}

/// A coarse axis on the fine elements: two quadratic spans.
fn coarse(elements: usize) -> Line {
    let inner = BSpline::<f64>::uniform(2, 2, 1);
    let cells = (0..elements).map(|e| {
        let (t0, t1) = (e as f64 / elements as f64, (e + 1) as f64 / elements as f64);
        let element = usize::from(t0 + t1 > 1.0);
        (element, 2.0 * t0 - element as f64, 2.0 * (t1 - t0))
    });
    Box::new(Refined::new(inner, cells.collect()))
}

/// All maps of a space with `axes`: isoparametric, coarse, rational, and one without structure.
fn maps<const N: usize>(axes: impl Fn() -> [Line; N]) -> Vec<Box<dyn Geometry<N, N>>> {
    let counts = axes().each_ref().map(|a| a.num_elements());
    let rough = || counts.map(|n| coarse(n + n % 2));
    let mut all: Vec<Box<dyn Geometry<N, N>>> = Vec::new();
    all.push(Box::new(ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) }));
    if counts.iter().all(|n| n % 2 == 0) {
        all.push(Box::new(ControlPoints { basis: TensorProduct::new(rough()), points: net(&rough()) }));
        let product = TensorProduct::new(rough());
        let w = weights(product.num_functions());
        all.push(Box::new(ControlPoints { basis: Rational::new::<N>(product, w), points: net(&rough()) }));
    }
    all.push(Box::new(Anyhow(ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) })));
    all
}

/// Largest difference of two matrices of one pattern over the largest entry.
fn apart(a: &Csr, b: &Csr) -> f64 {
    assert_eq!(a.pattern(), b.pattern());
    let scale = b.vals().iter().fold(0.0f64, |m, v| m.max(v.abs()));
    a.vals().iter().zip(b.vals()).fold(0.0f64, |m, (a, b)| m.max((a - b).abs())) / scale
}

/// The two ways agree; returns how far they are apart, and asserts that they are two ways.
fn compare<const C: usize, const N: usize>(space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, form: &Form<'_, C, N>) -> f64 {
    let (fast, plain) = (stiffness(space, rules, form), stiffness(&Plain(space), rules, form));
    assert!(fast.vals() != plain.vals(), "the contraction is what is tested");
    let apart = apart(&fast, &plain);
    assert!(apart <= SAME, "apart by {apart:e}, degrees {:?}", space.degree(0));
    if form.symmetric {
        for i in 0..fast.num_rows() {
            let (cols, vals) = fast.row(i);
            assert!(cols.zip(vals).all(|(j, v)| v.to_bits() == fast.get(j, i).to_bits()), "symmetric to the last bit");
        }
    }
    let size = plain.places_size();
    for (a, b) in faying::linalg::Operator::places(&fast).iter().zip(faying::linalg::Operator::places(&plain)) {
        assert!((0..3).all(|k| (a[k] - b[k]).abs() <= SAME_PLACE * size), "{a:?} {b:?}");
    }
    apart
}

trait PlacesSize {
    fn places_size(&self) -> f64;
}
impl PlacesSize for Csr {
    fn places_size(&self) -> f64 {
        let places = faying::linalg::Operator::places(self);
        assert_eq!(places.len(), self.num_rows());
        places.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()))
    }
}

/// A tangent without any symmetry, or with that of an energy.
fn tangent<const C: usize, const N: usize>(x: &Vector<N>, symmetric: bool) -> Tangent<C, N> {
    let entry = |i: usize, j: usize, k: usize, l: usize| {
        let (a, b) = (i * N + j, k * N + l);
        let (a, b) = if symmetric { (a.min(b), a.max(b)) } else { (a, b) };
        f64::from(u8::from(a == b)) * 6.0 + noise(31 * a + b) + 0.3 * x[0] * noise(a + 17 * b)
    };
    std::array::from_fn(|i| std::array::from_fn(|j| Matrix::from_fn(|k, l| entry(i, j, k, l))))
}

/// Every kind of coefficient for C components.
fn forms<'a, const C: usize, const N: usize>() -> Vec<Form<'a, C, N>> {
    let origin = Vector::<N>::repeat(0.3);
    let mut all = vec![Form::laplace()];
    for symmetric in [true, false] {
        all.push(Form { coefficient: Coefficient::Constant(tangent(&origin, symmetric)), symmetric });
        all.push(Form { coefficient: Coefficient::PerPoint(Box::new(move |x: &Vector<N>| tangent(x, symmetric))), symmetric });
    }
    all
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
fn plane_patches_of_all_pairs_of_degrees_equal_the_plain_loop() {
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
    println!("plane, all degrees: apart by {most:.1e} at most");
}

#[test]
fn solid_patches_of_mixed_degrees_equal_the_plain_loop() {
    let mut most = 0.0f64;
    for p in [[1, 2, 3], [2, 3, 1], [3, 1, 2], [4, 5, 1], [1, 4, 5], [5, 1, 4], [3, 3, 3]] {
        let axes = || [spline(p[0], 2), spline(p[1], 4), spline(p[2], 2)];
        for geometry in maps(axes) {
            let space = Over { basis: TensorProduct::new(axes()), geometry };
            most = most.max(compare::<1, 3>(&space, &gauss_rules(&space, 0), &Form::laplace()));
        }
    }
    println!("solid, mixed degrees: apart by {most:.1e} at most");
}

#[test]
fn all_kinds_of_coefficients_equal_the_plain_loop_in_the_plane_and_in_space() {
    let mut most = 0.0f64;
    let axes = || [smooth(2, 4), spline(3, 4)];
    for geometry in maps(axes) {
        most = most.max(all_forms(&Over { basis: TensorProduct::new(axes()), geometry }));
    }
    let axes = || [spline(2, 2), smooth(1, 2), smooth(3, 2)];
    for geometry in maps(axes) {
        most = most.max(all_forms(&Over { basis: TensorProduct::new(axes()), geometry }));
    }
    println!("coefficients: apart by {most:.1e} at most");
}

#[test]
fn lagrange_coarse_and_mixed_axes_equal_the_plain_loop() {
    let mut most = 0.0f64;
    for p in 1..=5 {
        let axes = || [lagrange(p, 3), lagrange(6 - p, 4)];
        let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
        most = most.max(compare(&space, &gauss_rules(&space, 0), &form(&Hooke::<2>::plane_strain(1.0, 0.3).unwrap())));
    }
    // functions that live on more than degree + 1 elements
    let axes = || [coarse(6), smooth(3, 4)];
    most = most.max(all_forms(&ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) }));
    let axes = || [lagrange(2, 2), smooth(3, 3), spline(2, 4)];
    most = most.max(all_forms(&ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) }));
    println!("lagrange: apart by {most:.1e} at most");
}

#[test]
fn rational_functions_equal_the_plain_loop() {
    let mut most = 0.0f64;
    let axes = || [smooth(2, 4), spline(3, 4)];
    for geometry in maps(axes) {
        let product = TensorProduct::new(axes());
        let w = weights(product.num_functions());
        most = most.max(all_forms(&Over { basis: Rational::new::<2>(product, w), geometry }));
    }
    let axes = || [spline(1, 2), smooth(2, 2), spline(3, 2)];
    for geometry in maps(axes) {
        let product = TensorProduct::new(axes());
        let w = weights(product.num_functions());
        most = most.max(all_forms(&Over { basis: Rational::new::<3>(product, w), geometry }));
    }
    println!("rational: apart by {most:.1e} at most");
}

#[test]
fn mass_matrices_equal_the_plain_loop() {
    fn both<const N: usize>(space: &dyn Space<N, N>) {
        let rules = gauss_rules(space, 0);
        let (fast, plain) = (mass(space, &rules), mass(&Plain(space), &rules));
        assert!(fast.vals() != plain.vals(), "the contraction is what is tested");
        assert!(apart(&fast, &plain) <= SAME);
    }
    let axes = || [spline(2, 4), lagrange(3, 4)];
    for geometry in maps(axes) {
        both(&Over { basis: TensorProduct::new(axes()), geometry });
    }
    let axes = || [smooth(2, 2), spline(3, 4), lagrange(1, 2)];
    for geometry in maps(axes) {
        let product = TensorProduct::new(axes());
        let w = weights(product.num_functions());
        both(&Over { basis: Rational::new::<3>(product, w), geometry });
    }
}

#[test]
fn rules_with_other_numbers_of_points_per_direction_and_deformed_maps_equal_the_plain_loop() {
    let axes = || [smooth(2, 5), spline(3, 3)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    let steel = Hooke::<2>::plane_stress(1.0, 0.3).unwrap();
    compare(&space, &TensorRule::gauss([2, 7]), &form(&steel));
    let u = (0..space.points.len()).map(|i| Vector::<2>::new(0.01 * noise(i), 0.02 * noise(3 * i))).collect();
    compare(&Deformed { space: &space, u }, &gauss_rules(&space, 1), &form(&steel));
}

#[test]
fn refilled_and_added_matrices_are_the_fresh_one() {
    fn check<const C: usize, const N: usize>(space: &dyn Space<N, N>) {
        let rules = gauss_rules(space, 0);
        for form in forms::<C, N>() {
            let fresh = stiffness(space, &rules, &form);
            let mut matrix = fresh.clone();
            matrix.vals_mut().fill(f64::NAN);
            refill_stiffness(space, &rules, &form, &mut matrix);
            assert!(matrix == fresh, "refilled: the same bits");
            let pattern = Pattern::new(space);
            add_stiffness(&pattern, space, &rules, &form, &mut matrix);
            assert!(matrix.vals().iter().zip(fresh.vals()).all(|(a, b)| *a == 2.0 * b), "added to itself: twice");
        }
    }
    let axes = || [smooth(2, 3), spline(3, 3)];
    let product = || TensorProduct::new(axes());
    let points = net(&axes());
    check::<1, 2>(&ControlPoints { basis: product(), points: points.clone() });
    check::<2, 2>(&ControlPoints { basis: Rational::new::<2>(product(), weights(points.len())), points });
    let axes = || [smooth(1, 3), spline(2, 2), smooth(2, 3)];
    check::<3, 3>(&ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) });
}

#[test]
fn contracted_matrices_have_the_same_bits_for_any_number_of_threads() {
    fn bits<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>) {
        let rules = gauss_rules(space, 0);
        let run = |threads: usize| {
            rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| stiffness(space, &rules, form))
        };
        let one = run(1);
        for threads in [2, 3, 7] {
            let k = run(threads);
            assert!(k.vals().iter().zip(one.vals()).all(|(a, b)| a.to_bits() == b.to_bits()), "{threads} threads");
            assert!(k == one);
        }
    }
    // enough rows that a plane patch is cut into several marches
    let axes = || [spline(3, 9), spline(2, 70)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    bits::<1, 2>(&space, &Form::laplace());
    bits(&space, &form(&Hooke::<2>::plane_strain(1.0, 0.3).unwrap()));
    bits::<1, 2>(&space, &forms().pop().unwrap());
    let axes = || [smooth(2, 6), spline(3, 5), spline(2, 8)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    bits::<1, 3>(&space, &Form::laplace());
    bits(&space, &form(&Hooke::<3>::solid(1.0, 0.3).unwrap()));
}

#[test]
fn degrees_beyond_the_kernels_and_permuted_blocks_take_the_plain_loop() {
    let axes = || [smooth(6, 3), smooth(2, 3)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    let rules = gauss_rules(&space, 0);
    let laplace = Form::<1, 2>::laplace();
    assert_eq!(stiffness(&space, &rules, &laplace).vals(), stiffness(&Plain(&space), &rules, &laplace).vals());

    /// A basis whose block has other numbers.
    #[derive(Debug)]
    struct Turned<B>(B);
    impl<B: Elements> Elements for Turned<B> {
        fn num_elements(&self) -> usize {
            self.0.num_elements()
        }
    }
    impl<B: Basis<2>> Basis<2> for Turned<B> {
        fn num_functions(&self) -> usize {
            self.0.num_functions()
        }
        fn degree(&self, element: usize) -> [usize; 2] {
            self.0.degree(element)
        }
        fn active(&self, element: usize, ids: &mut Vec<usize>) {
            self.0.active(element, ids);
            ids.iter_mut().for_each(|i| *i = self.0.num_functions() - 1 - *i);
        }
        fn tabulate(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut ShapeTable<2>) {
            self.0.tabulate(element, xi, order, table);
        }
        fn block(&self, element: usize) -> Option<Block<'_, 2>> {
            self.0.block(element)
        }
    }
    let axes = || [smooth(2, 3), smooth(2, 4)];
    let geometry = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    let space = Over { basis: Turned(TensorProduct::new(axes())), geometry };
    let rules = gauss_rules(&space, 0);
    assert_eq!(stiffness(&space, &rules, &laplace).vals(), stiffness(&Plain(&space), &rules, &laplace).vals());
}
