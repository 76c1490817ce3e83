//! The contraction direction by direction against the plain loop, on every kind of patch.

use crate::common::products;
use crate::common::states;
use faying::assembly::{Form, Pattern, add_stiffness, fields, gauss_rules, mass, refill_stiffness, stiffness};
use faying::basis::{BSpline, Basis, BasisStructure, Block, Elements, Order, Rational, ShapeTable, TensorProduct};
use faying::geometry::ControlPoints;
use faying::linalg::{Csr, Vector};
use faying::physics::{Hooke, form};
use faying::quadrature::{PerElement, Quadrature, TensorRule};
use faying::space::{Deformed, Field, FieldAt, FunctionSpace, Space, field_at};
use products::{Plain, apart, coarse, forms, lagrange, maps, net, noise, smooth, spline, weights};
use states::states_are_those_of_each_element;
use std::sync::Arc;

/// Entries may differ by this share of the largest.
const SAME: f64 = 1e-13;
/// Places may differ by this share of the size.
const SAME_PLACE: f64 = 1e-12;

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
    for (a, b) in faying::linalg::Operator::dof_coordinates(&fast).iter().zip(faying::linalg::Operator::dof_coordinates(&plain)) {
        assert!((0..3).all(|k| (a[k] - b[k]).abs() <= SAME_PLACE * size), "{a:?} {b:?}");
    }
    apart
}

trait PlacesSize {
    fn places_size(&self) -> f64;
}
impl PlacesSize for Csr {
    fn places_size(&self) -> f64 {
        let places = faying::linalg::Operator::dof_coordinates(self);
        assert_eq!(places.len(), self.num_rows());
        places.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()))
    }
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
    states_are_those_of_each_element::<1, N>(space, &rules);
    states_are_those_of_each_element::<N, N>(space, &rules);
    most
}

#[test]
fn plane_patches_of_all_pairs_of_degrees_equal_the_plain_loop() {
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
fn solid_patches_of_mixed_degrees_equal_the_plain_loop() {
    let mut most = 0.0f64;
    for p in [[1, 2, 3], [2, 3, 1], [3, 1, 2], [4, 5, 1], [1, 4, 5], [5, 1, 4], [3, 3, 3]] {
        let axes = || [spline(p[0], 2), spline(p[1], 4), spline(p[2], 2)];
        for geometry in maps(axes) {
            let space = FunctionSpace { basis: TensorProduct::new(axes()), geometry };
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
        most = most.max(all_forms(&FunctionSpace { basis: TensorProduct::new(axes()), geometry }));
    }
    let axes = || [spline(2, 2), smooth(1, 2), smooth(3, 2)];
    for geometry in maps(axes) {
        most = most.max(all_forms(&FunctionSpace { basis: TensorProduct::new(axes()), geometry }));
    }
    println!("coefficients: apart by {most:.1e} at most");
}

#[test]
fn lagrange_coarse_and_mixed_axes_equal_the_plain_loop() {
    let mut most = 0.0f64;
    for p in 1..=5 {
        let axes = || [lagrange(p, 3), lagrange(6 - p, 4)];
        let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
        most = most.max(compare(&space, &gauss_rules(&space, 0), &form(&Hooke::<2>::plane_strain(1.0, 0.3).unwrap()).unwrap()));
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
fn mass_matrices_equal_the_plain_loop() {
    fn both<const N: usize>(space: &dyn Space<N, N>) {
        let rules = gauss_rules(space, 0);
        let (fast, plain) = (mass(space, &rules), mass(&Plain(space), &rules));
        assert!(fast.vals() != plain.vals(), "the contraction is what is tested");
        assert!(apart(&fast, &plain) <= SAME);
    }
    let axes = || [spline(2, 4), lagrange(3, 4)];
    for geometry in maps(axes) {
        both(&FunctionSpace { basis: TensorProduct::new(axes()), geometry });
    }
    let axes = || [smooth(2, 2), spline(3, 4), lagrange(1, 2)];
    for geometry in maps(axes) {
        let product = TensorProduct::new(axes());
        let w = weights(product.num_functions());
        both(&FunctionSpace { basis: Rational::new::<3>(product, w), geometry });
    }
}

#[test]
fn rules_with_other_numbers_of_points_per_direction_and_deformed_maps_equal_the_plain_loop() {
    let axes = || [smooth(2, 5), spline(3, 3)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    let steel = Hooke::<2>::plane_stress(1.0, 0.3).unwrap();
    compare(&space, &TensorRule::gauss([2, 7]), &form(&steel).unwrap());
    let u = (0..space.points.len()).map(|i| Vector::<2>::new(0.01 * noise(i), 0.02 * noise(3 * i))).collect();
    compare(&Deformed { space: &space, u }, &gauss_rules(&space, 1), &form(&steel).unwrap());
}

#[test]
fn a_patch_whose_elements_have_different_rules_is_integrated_with_each_of_them() {
    let axes = || [spline(2, 4), spline(3, 3)];
    for geometry in maps(axes) {
        let space = FunctionSpace { basis: TensorProduct::new(axes()), geometry };
        let kinds: Vec<Arc<dyn Quadrature<2>>> = vec![Arc::new(TensorRule::gauss([3, 4])), Arc::new(TensorRule::gauss([2, 5]))];
        let last = PerElement::new(kinds.clone(), (0..12).map(|e| usize::from(e == 11)).collect());
        let one = PerElement::new(kinds, vec![1; 12]);
        let form = Form::<1, 2>::laplace();
        let (mixed, plain) = (stiffness(&space, &last, &form), stiffness(&Plain(&space), &last, &form));
        assert_eq!(mixed.vals(), plain.vals());
        assert_eq!(mass(&space, &last).vals(), mass(&Plain(&space), &last).vals());
        compare(&space, &one, &form);
    }
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
        for threads in [2, 3, 4, 7] {
            let k = run(threads);
            assert!(k.vals().iter().zip(one.vals()).all(|(a, b)| a.to_bits() == b.to_bits()), "{threads} threads");
            assert!(k == one);
        }
    }
    // enough rows that a plane patch is cut into several marches
    let axes = || [spline(3, 9), spline(2, 70)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    bits::<1, 2>(&space, &Form::laplace());
    bits(&space, &form(&Hooke::<2>::plane_strain(1.0, 0.3).unwrap()).unwrap());
    bits::<1, 2>(&space, &forms().pop().unwrap());
    let axes = || [smooth(2, 6), spline(3, 5), spline(2, 8)];
    let space = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    bits::<1, 3>(&space, &Form::laplace());
    bits(&space, &form(&Hooke::<3>::solid(1.0, 0.3).unwrap()).unwrap());
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
        fn structure(&self) -> &dyn BasisStructure<2> {
            self
        }
    }
    impl<B: Basis<2>> BasisStructure<2> for Turned<B> {
        fn block(&self, element: usize) -> Option<Block<'_, 2>> {
            self.0.structure().block(element)
        }
    }
    let axes = || [smooth(2, 3), smooth(2, 4)];
    let geometry = ControlPoints { basis: TensorProduct::new(axes()), points: net(&axes()) };
    let space = FunctionSpace { basis: Turned(TensorProduct::new(axes())), geometry };
    let rules = gauss_rules(&space, 0);
    assert_eq!(stiffness(&space, &rules, &laplace).vals(), stiffness(&Plain(&space), &rules, &laplace).vals());
}

#[test]
fn fields_in_single_precision_are_those_of_each_element() {
    let axes = || [BSpline::<f32>::uniform(2, 3, 1), BSpline::<f32>::uniform(1, 2, 0)];
    let basis = TensorProduct::new(axes());
    let points =
        (0..Basis::<2, f32>::num_functions(&basis)).map(|i| Vector::<2, f32>::new((i % 5) as f32, (i / 5) as f32 + 0.1 * noise(i) as f32));
    let space = ControlPoints { points: points.collect(), basis };
    let u: Vec<f32> = (0..2 * Basis::<2, f32>::num_functions(&space)).map(|i| noise(7 * i) as f32).collect();
    let rules = gauss_rules::<2, f32, _>(&space, 0);
    let all = fields::<2, 2, f32, _, _, _>(&space, &rules, &u, &|_, states: &[FieldAt<2, 2, f32>]| states.to_vec());
    assert_eq!(all.len(), 6);
    for (e, states) in all.iter().enumerate() {
        let own = field_at::<2, 2, f32, _>(&space, &Field { first: 0, components: 2 }, &u, e, &rules.rule(e).points);
        assert_eq!(own.len(), 6);
        for (a, b) in states.iter().zip(&own) {
            let apart = (a.x - b.x).amax().max((a.value - b.value).amax()).max((a.gradient - b.gradient).amax());
            assert!(apart <= 1e-5 * b.gradient.amax().max(5.0), "{a:?} {b:?}");
        }
    }
}
