//! A warm table is filled without allocating.

use faying::basis::{BSpline, Basis, Extracted, LagrangeLine, LagrangeSimplex, Order, Rational, Refined, ShapeTable, TensorProduct};
use faying::linalg::Vector;
use faying::quadrature::{Quadrature, TensorRule, simplex_rule};

#[track_caller]
fn is_free<const D: usize>(basis: &dyn Basis<D>, xi: &[Vector<D>]) {
    let (mut table, mut ids) = (ShapeTable::new(), Vec::new());
    let mut round = || {
        for e in 0..basis.num_elements() {
            for order in [Order::Values, Order::Gradients, Order::Hessians] {
                basis.tabulate(e, xi, order, &mut table);
            }
            basis.active(e, &mut ids);
            basis.corners(e, &mut ids);
            basis.degree(e);
        }
    };
    round();
    let info = allocation_counter::measure(round);
    assert_eq!(info.count_total, 0, "{basis:?}");
}

#[test]
fn warm_tables_are_filled_without_allocating() {
    let line = TensorRule::<1>::gauss([4]);
    let plane = TensorRule::<2>::gauss([3, 4]);
    let spline = BSpline::<f64>::uniform(3, 4, 1);
    let (n, xi) = (spline.num_functions(), &line.rule(0).points);
    is_free(&spline, xi);
    is_free(&LagrangeLine::<f64>::new(5, 3), xi);
    is_free(&Rational::<_>::new(spline.clone(), vec![1.5; n]), xi);
    let fine = Refined::new(spline.clone(), vec![(0, 0.0, 0.5), (0, 0.5, 0.5), (3, 0.0, 1.0)]);
    is_free(&Refined::new(fine.clone(), vec![(0, 0.0, 1.0), (2, 0.5, 0.5)]), xi);
    let halves: Vec<Vec<(usize, f64)>> = (0..n).map(|i| vec![(i, 0.5), ((i + 1) % n, 0.5)]).collect();
    is_free(&Extracted::<_>::new(Rational::<_>::new(spline.clone(), vec![2.0; n]), n, halves), xi);
    let product = TensorProduct::<2, _>::new([spline.clone(), spline]);
    is_free(&product, &plane.rule(0).points);
    is_free(&Rational::<_>::new(product, vec![1.0; n * n]), &plane.rule(0).points);
    is_free(&TensorProduct::<2, _>::new([fine.clone(), fine]), &plane.rule(0).points);
    let boxed: [Box<dyn Basis<1>>; 2] = [Box::new(BSpline::uniform(2, 3, 1)), Box::new(LagrangeLine::new(8, 2))];
    is_free(&TensorProduct::<2, _>::new(boxed), &plane.rule(0).points);
    is_free(&LagrangeSimplex::<2>::on_corners(4, vec![0, 1, 2, 2, 1, 3]), &simplex_rule(8).points);
}
