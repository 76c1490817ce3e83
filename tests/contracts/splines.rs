//! Splines: knots, multiplier spaces and properties that hold for any knots.

use faying::basis::{BSpline, Basis, Elements, KnotError, LagrangeLine, Order, Polynomials, ShapeTable, TensorProduct};
use faying::check;
use faying::linalg::Vector;
use proptest::prelude::*;

#[test]
fn knots_that_are_none_are_refused_with_the_place() {
    let text = |degree, knots: &[f64]| BSpline::try_new(degree, knots.to_vec()).unwrap_err().to_string();
    assert_eq!(text(1, &[0., 0., 0.7, 0.5, 1., 1.]), "knots decrease at index 3: 0.5 after 0.7; knots must not decrease");
    assert_eq!(
        text(1, &[0., 0., 0.5, 0.5, 0.5, 1., 1.]),
        "the knot 0.5 at index 2 is repeated 3 times; at most 2 (degree + 1) are allowed"
    );
    assert_eq!(text(2, &[0., 0., 0., 1., 1.]), "5 knots are too few for degree 2; an open knot vector has at least 6");
    assert_eq!(text(2, &[]), "0 knots are too few for degree 2; an open knot vector has at least 6");
    assert_eq!(
        text(2, &[0., 0., 1., 2., 3., 4., 4., 4.]),
        "the knot vector is not open: the knot 0 at index 0 is repeated 2 times; both ends need 3 (degree + 1)"
    );
    assert_eq!(text(1, &[0., 0., f64::NAN, 1., 1.]), "the knot at index 2 is not finite");
    assert!(matches!(BSpline::try_new(1, vec![2.0; 4]), Err(KnotError::Repeated { times: 4, .. })));
}

#[test]
fn knots_elements_and_parameters_belong_together() {
    let spline = BSpline::try_new(2, vec![0., 0., 0., 1., 1., 3., 4., 4., 4.]).unwrap();
    assert_eq!((spline.num_elements(), spline.num_functions()), (3, 6));
    assert_eq!(spline.breakpoints(), [0., 1., 3., 4.]);
    assert_eq!([0, 1, 2, 3].map(|b| spline.regularity(b)), [-1, 0, 1, -1]);
    assert_eq!(spline.interval(1), (1., 3.));
    assert_eq!(spline.greville(), [0., 0.5, 1., 2., 3.5, 4.]);
    for (t, e, xi) in [(-1., 0, -1.), (0., 0, 0.), (1., 1, 0.), (2., 1, 0.5), (4., 2, 1.), (5., 2, 2.)] {
        assert_eq!(spline.find(t), (e, xi));
    }
    // a cubic is itself in the element's coordinate, second derivatives included: N = t^3 has Bernstein form (0, 0, 0, 1)
    let cubic = BSpline::<f64>::uniform(3, 1, 0);
    let mut table = ShapeTable::new();
    cubic.tabulate(0, &[Vector::<1>::new(2.0)], Order::Hessians, &mut table);
    assert_eq!((table.values(0)[3], table.grads(0)[3][0], table.hessians(0)[3][0]), (8.0, 12.0, 12.0));
}

#[test]
fn lowered_splines_keep_breakpoints_and_multiplicities() {
    let spline = BSpline::<f64>::try_new(4, [vec![0.; 5], vec![1.], vec![2.; 2], vec![4.; 4], vec![5.; 5], vec![7.; 5]].concat()).unwrap();
    assert_eq!([1, 2, 3, 4].map(|b| spline.regularity(b)), [3, 2, 0, -1]);
    for (k, expected) in [(0, [3, 2, 0, -1]), (1, [2, 1, -1, -1]), (2, [1, 0, -1, -1]), (4, [-1, -1, -1, -1])] {
        let lowered = spline.made_of(Polynomials::Lowered(k)).unwrap();
        assert_eq!(lowered.polynomial_degree(), 4 - k);
        assert_eq!(lowered.breakpoints(), spline.breakpoints());
        assert_eq!([1, 2, 3, 4].map(|b| lowered.regularity(b)), expected);
    }
    assert!(spline.made_of(Polynomials::Lowered(5)).is_none());
    let uniform = |degree, continuity| spline.made_of(Polynomials::Uniform { degree, continuity });
    assert_eq!(uniform(1, 0).unwrap().num_functions(), 6);
    assert_eq!(uniform(0, -1).unwrap().num_functions(), 5);
    assert!(uniform(1, 1).is_none() && uniform(0, 0).is_none() && uniform(2, -2).is_none());
    // contract 2.2: on n smooth elements p/p-2 has n + p - 2 functions
    let smooth = BSpline::<f64>::uniform(3, 8, 2);
    assert_eq!(smooth.made_of(Polynomials::Lowered(2)).unwrap().num_functions(), 9);
}

#[test]
fn lagrange_and_rough_splines_offer_the_same_multipliers() {
    for degree in 1..=4 {
        let line = LagrangeLine::<f64>::new(degree, 5);
        let spline = BSpline::<f64>::uniform(degree, 5, 0);
        let mut all: Vec<Polynomials> = (0..=degree).map(Polynomials::Lowered).collect();
        all.extend((0..=degree).map(|d| Polynomials::Uniform { degree: d, continuity: (d as isize - 1).min(0) }));
        for wanted in all {
            let (a, b) = (line.polynomials(wanted).unwrap(), spline.polynomials(wanted).unwrap());
            let (mut ta, mut tb, mut ia, mut ib) = (ShapeTable::new(), ShapeTable::new(), Vec::new(), Vec::new());
            assert_eq!(a.num_functions(), b.num_functions());
            for e in 0..5 {
                for x in [0.1, 0.6, 0.95] {
                    a.tabulate(e, &[Vector::<1>::new(x)], Order::Gradients, &mut ta);
                    b.tabulate(e, &[Vector::<1>::new(x)], Order::Gradients, &mut tb);
                    a.active(e, &mut ia);
                    b.active(e, &mut ib);
                    assert_eq!(ia, ib);
                    for k in 0..ia.len() {
                        assert!((ta.values(0)[k] - tb.values(0)[k]).abs() < 1e-14);
                        assert!((ta.grads(0)[k] - tb.grads(0)[k]).amax() < 1e-12);
                    }
                }
            }
        }
    }
}

/// Knots of random spacing, over so many decades, and random multiplicity.
fn any_spline(decades: f64, degrees: usize, spans: usize) -> impl Strategy<Value = BSpline> {
    (0..degrees, prop::collection::vec((-decades..0.0, 0usize..9), 1..spans)).prop_map(|(degree, spans)| {
        let mut breakpoints = vec![-1.0];
        for s in &spans {
            breakpoints.push(breakpoints[breakpoints.len() - 1] + 10f64.powf(s.0));
        }
        let continuity: Vec<isize> = spans[1..].iter().map(|s| degree as isize - 1 - (s.1 % (degree + 1)) as isize).collect();
        BSpline::from_breakpoints(degree, &breakpoints, &continuity)
    })
}

proptest! {
    #![proptest_config(crate::random::inputs(48))]

    #[test]
    fn any_spline_sums_to_one_and_is_not_negative(spline in any_spline(3.0, 8, 8)) {
        prop_assert_eq!(check::partition_of_unity(&spline), Ok(()));
        prop_assert_eq!(check::non_negative(&spline), Ok(()));
    }

    // on an element a thousand times smaller than its neighbours splines of degree 7 are dependent to working precision
    #[test]
    fn any_spline_keeps_the_contract(spline in any_spline(0.7, 8, 8)) {
        prop_assert_eq!(check::basis(&spline), Ok(()));
    }

    #[test]
    fn any_product_is_a_block(a in any_spline(0.7, 4, 4), b in any_spline(0.7, 3, 3)) {
        let plane = TensorProduct::<2, _>::new([a, b]);
        prop_assert!(plane.structure().block(0).is_some());
        prop_assert_eq!(check::basis(&plane), Ok(()));
    }

    #[test]
    fn any_spline_is_as_smooth_as_its_regularity_says(spline in any_spline(2.0, 8, 8)) {
        let (mut left, mut right, mut l, mut r) = (ShapeTable::new(), ShapeTable::new(), Vec::new(), Vec::new());
        for b in 1..spline.num_elements() {
            spline.tabulate(b - 1, &[Vector::<1>::new(1.0)], Order::Hessians, &mut left);
            spline.tabulate(b, &[Vector::<1>::new(0.0)], Order::Hessians, &mut right);
            spline.active(b - 1, &mut l);
            spline.active(b, &mut r);
            let h = [b - 1, b].map(|e| spline.interval(e).1 - spline.interval(e).0);
            let jet = |t: &ShapeTable<1>, ids: &[usize], i: usize, h: f64| ids.iter().position(|&j| j == i).map_or([0.0; 3], |a| {
                [t.values(0)[a], t.grads(0)[a][0] / h, t.hessians(0)[a][0] / (h * h)]
            });
            for i in 0..spline.num_functions() {
                let (x, y) = (jet(&left, &l, i, h[0]), jet(&right, &r, i, h[1]));
                for d in (0..=2).filter(|&d| d as isize <= spline.regularity(b)) {
                    let size = h[0].min(h[1]).powi(-(d as i32)) * 100.0;
                    prop_assert!((x[d] - y[d]).abs() <= 1e-13 * size, "derivative {} of {} jumps by {}", d, i, x[d] - y[d]);
                }
            }
        }
    }
}

#[test]
fn knots_inserted_together_are_those_inserted_one_after_the_other() {
    let knots = vec![-1., -1., -1., -1., 0., 0.3, 0.3, 1., 1., 1., 1.5, 1.5, 1.5, 1.5, 2., 2., 2., 2.];
    let rough = BSpline::<f64>::try_new(3, knots).unwrap();
    let rows: Vec<Vec<f64>> = (0..rough.num_functions()).map(|i| vec![(1.7 * i as f64).sin(), (2.3 * i as f64).cos()]).collect();
    let new = [-0.9, -0.9, -0.9, -0.9, 0.0, 0.0, 0.1, 0.3, 0.31, 1.0, 1.49, 1.6, 1.6, 1.9999];
    let (mut spline, mut each, mut together) = (rough.clone(), rows.clone(), rows.clone());
    for t in new {
        spline = spline.insert(t, &mut each).unwrap();
    }
    assert_eq!(rough.insert_all(&new, &mut together).unwrap(), spline);
    assert_eq!(together, each, "the same bits");
    for t in [-0.95, -0.9, 0.05, 0.3, 0.9, 1.5, 1.7, 2.0] {
        for (a, b) in rough.value_at(t, &rows).iter().zip(spline.value_at(t, &together)) {
            assert!((a - b).abs() < 1e-14, "{t}: {a} {b}");
        }
    }
    for wrong in [vec![0.5, 2.0], vec![-1.0], vec![0.5, 1.5], vec![f64::NAN]] {
        let mut kept = rows.clone();
        assert!(rough.insert_all(&wrong, &mut kept).is_err() && kept == rows, "{wrong:?} leaves the rows");
    }
    // every knot is looked at once: a quadratic loop would take minutes
    let line = BSpline::<f64>::uniform(2, 1, 0);
    let fine: Vec<f64> = (1..200_000).map(|k| k as f64 / 200_000.0).collect();
    let mut rows = vec![vec![0.0], vec![0.5], vec![1.0]];
    let spline = line.insert_all(&fine, &mut rows).unwrap();
    // each of them cuts the last row again: one rounding per knot at most
    for (x, row) in spline.greville().into_iter().zip(&rows) {
        assert!((row[0] - x).abs() < f64::EPSILON * fine.len() as f64, "the parameter itself: {x} {}", row[0]);
    }
}
