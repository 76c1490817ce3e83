//! Control nets keep their map under knot insertion, degree elevation and k-refinement.

use faying::basis::{BSpline, Basis, Elements, Order, Rational, ShapeTable, TensorProduct};
use faying::geometry::{ControlNet, NetError, turn, turn_about};
use faying::linalg::Vector;
use proptest::prelude::*;

/// The position of the parameters `t`, summed function by function.
fn position<const D: usize, const N: usize>(net: &ControlNet<D, N>, t: [f64; D]) -> Vector<N> {
    let product = TensorProduct::<D, _>::new(net.axes.clone());
    let weights = net.weights.clone().unwrap_or_else(|| vec![1.0; net.points.len()]);
    let basis = Rational::<_>::new(product, weights);
    let found: [(usize, f64); D] = std::array::from_fn(|k| net.axes[k].find(t[k]));
    let element = (0..D).rev().fold(0, |e, k| e * net.axes[k].num_elements() + found[k].0);
    let (mut table, mut ids) = (ShapeTable::new(), Vec::new());
    basis.tabulate(element, &[Vector::from_fn(|k, _| found[k].1)], Order::Values, &mut table);
    basis.active(element, &mut ids);
    ids.iter().zip(table.values(0)).fold(Vector::zeros(), |x, (&i, &n)| x + net.points[i] * n)
}

/// Parameters on a grid over all elements of the finer net, ends and knots included.
fn parameters<const D: usize>(axes: &[BSpline; D]) -> Vec<[f64; D]> {
    let lines: Vec<Vec<f64>> = axes
        .iter()
        .map(|a| (0..a.num_elements()).flat_map(|e| [0.0, 0.31, 0.77].map(|x| a.interval(e).0 * (1.0 - x) + a.interval(e).1 * x)).collect())
        .collect();
    let count: usize = lines.iter().map(Vec::len).product();
    (0..count)
        .map(|mut q| {
            std::array::from_fn(|k| {
                let i = q % lines[k].len();
                q /= lines[k].len();
                lines[k][i]
            })
        })
        .collect()
}

fn assert_same_map<const D: usize, const N: usize>(old: &ControlNet<D, N>, new: &ControlNet<D, N>) {
    let size = old.points.iter().map(|x| x.amax()).fold(0.0, f64::max);
    for t in parameters(&new.axes) {
        let error = (position(old, t) - position(new, t)).amax();
        assert!(error <= 1e-13 * size, "the map moved by {error:e} at {t:?}");
    }
}

/// Quarter annulus 1 < r < 2: one rational quadratic arc times a line.
fn annulus() -> ControlNet<2, 2> {
    let s = 0.5f64.sqrt();
    let points = [1.0, 2.0].iter().flat_map(|&r| [[r, 0.0], [r, r], [0.0, r]]).map(Vector::from).collect();
    ControlNet::try_new([BSpline::uniform(2, 1, 0), BSpline::uniform(1, 1, 0)], points, Some(vec![1.0, s, 1.0, 1.0, s, 1.0])).unwrap()
}

/// Full circle of four arcs: double knots.
fn circle() -> ControlNet<1, 2> {
    let s = 0.5f64.sqrt();
    let points =
        [[1., 0.], [1., 1.], [0., 1.], [-1., 1.], [-1., 0.], [-1., -1.], [0., -1.], [1., -1.], [1., 0.]].map(Vector::from).to_vec();
    let knots = vec![0., 0., 0., 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1., 1., 1.];
    ControlNet::try_new([BSpline::try_new(2, knots).unwrap()], points, Some((0..9).map(|i| if i % 2 == 1 { s } else { 1.0 }).collect()))
        .unwrap()
}

/// A cubic curve with a simple, a double, a triple and a discontinuous knot, weights far from one.
fn rough() -> ControlNet<1, 3> {
    let knots = vec![-1., -1., -1., -1., 0., 0.3, 0.3, 1., 1., 1., 1.5, 1.5, 1.5, 1.5, 2., 2., 2., 2.];
    let spline = BSpline::try_new(3, knots).unwrap();
    let n = spline.num_functions();
    let points = (0..n).map(|i| Vector::<3>::new((1.7 * i as f64).sin(), (0.9 * i as f64).cos(), 0.3 * i as f64)).collect();
    ControlNet::try_new([spline], points, Some((0..n).map(|i| 1.0 + 0.8 * (2.3 * i as f64).sin()).collect())).unwrap()
}

#[test]
fn knot_insertion_keeps_the_map() {
    let ring = annulus();
    let finer = ring.insert(0, &[0.5, 0.25, 0.5, 0.5]).unwrap().insert(1, &[0.1, 0.9]).unwrap();
    assert_eq!(finer.axes[0].multiplicity(2), 3);
    assert_same_map(&ring, &finer);
    assert_same_map(&circle(), &circle().insert(0, &[0.25, 0.1, 0.6, 0.61, 0.62]).unwrap());
    assert_same_map(&rough(), &rough().insert(0, &[0., 0., 0., 0.3, 1., -0.5, 1.9]).unwrap());
    assert_same_map(&rough(), &rough().insert(0, &(1..100).map(|k| -1.0 + 0.0299 * k as f64).collect::<Vec<_>>()).unwrap());
}

#[test]
fn degree_elevation_by_one_to_four_keeps_the_map() {
    for times in 0..=4 {
        for axis in 0..2 {
            let higher = annulus().elevate(axis, times);
            assert_eq!(higher.axes[axis].polynomial_degree(), annulus().axes[axis].polynomial_degree() + times);
            assert_same_map(&annulus(), &higher);
        }
        let higher = circle().elevate(0, times);
        assert_eq!(higher.axes[0].regularity(1), 0);
        assert_same_map(&circle(), &higher);
        let higher = rough().elevate(0, times);
        assert_eq!((1..5).map(|b| higher.axes[0].regularity(b)).collect::<Vec<_>>(), [2, 1, 0, -1]);
        assert_same_map(&rough(), &higher);
        // many smooth elements: knots far from the element whose polar form is taken
        let fine = rough().insert(0, &(1..60).map(|k| -1.0 + 0.0493 * k as f64).collect::<Vec<_>>()).unwrap();
        assert_same_map(&rough(), &fine.elevate(0, times));
    }
}

#[test]
fn refinement_in_h_p_and_k_keeps_the_map() {
    let ring = annulus();
    for degree in 2..=6 {
        for continuity in [-1, 0, degree as isize - 1] {
            let axes = [BSpline::uniform(degree, 7, continuity), BSpline::uniform(degree, 5, continuity)];
            assert_same_map(&ring, &ring.on_axes(&axes).unwrap());
            let weights = ring.weights_on(&axes).unwrap().unwrap();
            assert_eq!(Some(weights), ring.on_axes(&axes).unwrap().weights);
        }
        let [breakpoints] = circle().breakpoints_total([10]);
        assert_eq!(breakpoints.len(), 13); // ten elements become three per arc
        let continuity: Vec<isize> = (1..12).map(|b| if b % 3 == 0 { 0 } else { degree as isize - 1 }).collect();
        assert_same_map(&circle(), &circle().on_axes(&[BSpline::from_breakpoints(degree, &breakpoints, &continuity)]).unwrap());
    }
}

#[test]
fn splines_that_do_not_contain_the_net_are_refused() {
    let too_low = annulus().on_axes(&[BSpline::uniform(1, 4, 0), BSpline::uniform(1, 1, 0)]).unwrap_err();
    assert_eq!(too_low.to_string(), "direction 0: degree 1 cannot hold splines of degree 2; raise it to at least 2");
    let too_smooth = circle().on_axes(&[BSpline::uniform(3, 8, 2)]).unwrap_err();
    assert!(too_smooth.to_string().contains("2 continuous derivatives at the knot 0.25, the spline only 0"), "{too_smooth}");
    let no_knot = circle().on_axes(&[BSpline::uniform(3, 3, 0)]).unwrap_err();
    assert!(no_knot.to_string().contains("3 continuous derivatives at the knot 0.25"), "{no_knot}");
    let other = BSpline::from_breakpoints(2, &[0.0, 2.0], &[]);
    assert!(matches!(annulus().on_axes(&[other, BSpline::uniform(1, 1, 0)]), Err(NetError::Contain { axis: 0, .. })));
}

#[test]
fn nets_of_wrong_parts_are_refused_with_the_place() {
    let axes = || [BSpline::uniform(1, 1, 0), BSpline::uniform(1, 1, 0)];
    let four = || [[0., 0.], [1., 0.], [0., 1.], [1., 1.]].map(Vector::from).to_vec();
    assert_eq!(
        ControlNet::try_new(axes(), four()[..3].to_vec(), None).unwrap_err().to_string(),
        "there are 3 control points for 4 functions ([2, 2] per direction); give one per function"
    );
    assert_eq!(
        ControlNet::try_new(axes(), four(), Some(vec![1., 1., -0.5, 1.])).unwrap_err().to_string(),
        "the weight at index 2 is -0.5; weights must be positive"
    );
    assert!(ControlNet::try_new(axes(), four(), Some(vec![1., 1., f64::NAN, 1.])).is_err());
    assert!(matches!(
        ControlNet::try_new(axes(), [four(), vec![]].concat(), Some(vec![1.0; 3])),
        Err(NetError::Weights(faying::basis::WeightError::Counts { found: 3, expected: 4 }))
    ));
    let mut bad = four();
    bad[1][1] = f64::INFINITY;
    assert_eq!(ControlNet::try_new(axes(), bad, None).unwrap_err(), NetError::NotFinite { index: 1 });
    let knots = [vec![0., 0., 1., 1.], vec![0., 0., 1., 0.5]];
    assert_eq!(
        ControlNet::from_knots([1, 1], knots, four(), None).unwrap_err().to_string(),
        "direction 1: knots decrease at index 3: 0.5 after 1; knots must not decrease"
    );
}

#[test]
fn moves_do_what_they_say() {
    let ring = annulus();
    let p = [0.3, 0.6];
    let x = position(&ring, p);
    assert!((position(&ring.clone().scale(2.5), p) - x * 2.5).amax() < 1e-15);
    assert!((position(&ring.clone().translate(&Vector::<2>::new(1.0, -2.0)), p) - x - Vector::<2>::new(1.0, -2.0)).amax() < 1e-15);
    let turned = position(&ring.clone().rotate(&turn(90.0)), p);
    assert_eq!((turned[0], turned[1]), (-x[1], x[0])); // right angles are exact
    let back = ring.reverse(0);
    assert!((position(&back, [0.7, 0.6]) - x).amax() < 1e-15);
    assert_eq!(back.reverse(0), ring);
    assert!((position(&rough().reverse(0), [1.0 - 0.77]) - position(&rough(), [0.77])).amax() < 1e-14);
    let solid = ring.extrude(3.0);
    assert!((position(&solid, [0.3, 0.6, 0.5]) - Vector::<3>::new(x[0], x[1], 1.5)).amax() < 1e-15);
    let about_z = turn_about(&Vector::<3>::new(0.0, 0.0, 2.0), 90.0).unwrap();
    let turned = position(&solid.rotate(&about_z), [0.3, 0.6, 0.5]);
    assert!((turned - Vector::<3>::new(-x[1], x[0], 1.5)).amax() < 1e-15);
    assert!(turn_about(&Vector::<3>::zeros(), 90.0).is_none());
}

proptest! {
    #![proptest_config(crate::random::inputs(64))]
    #[test]
    fn any_knots_in_any_order_keep_any_curve(
        degree in 1usize..6,
        spans in prop::collection::vec((0.05f64..1.0, 0usize..7), 1..6),
        new in prop::collection::vec(0.001f64..0.999, 0..12),
        times in 0usize..3,
        seed in 0.0f64..6.0,
    ) {
        let mut breakpoints = vec![0.0];
        for s in &spans {
            breakpoints.push(breakpoints[breakpoints.len() - 1] + s.0);
        }
        let continuity: Vec<isize> = spans[1..].iter().map(|s| degree as isize - 1 - (s.1 % (degree + 1)) as isize).collect();
        let spline = BSpline::from_breakpoints(degree, &breakpoints, &continuity);
        let n = spline.num_functions();
        let points = (0..n).map(|i| Vector::<2>::new((seed + 1.3 * i as f64).sin(), i as f64 / n as f64)).collect();
        let weights = (0..n).map(|i| 1.0 + 0.9 * (seed * 1.7 + i as f64).cos()).collect();
        let net = ControlNet::try_new([spline], points, Some(weights)).unwrap();
        let last = breakpoints[breakpoints.len() - 1];
        let new: Vec<f64> = new.iter().map(|t| t * last).collect();
        let finer = net.insert(0, &new).unwrap().elevate(0, times);
        for t in parameters(&finer.axes) {
            let error = (position(&net, t) - position(&finer, t)).amax();
            prop_assert!(error <= 1e-13, "{} at {:?}", error, t);
        }
        prop_assert!(finer.weights.unwrap().iter().all(|&w| w > 0.0));
    }
}
