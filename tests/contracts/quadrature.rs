//! Quadrature rules pass their checker.

use faying::basis::{BSpline, LagrangeSimplex, TensorProduct};
use faying::check;
use faying::quadrature::{PerElement, Quadrature, Rule, TensorRule, gauss_legendre, gauss_lobatto_nodes, simplex_rule};
use std::sync::Arc;

#[test]
fn gauss_rules_are_exact_for_degree_2n_minus_1() {
    let line = BSpline::<f64>::uniform(1, 1, 0);
    for n in 1..=40 {
        check::quadrature(&gauss_legendre(n), &line, 2 * n - 1).unwrap();
        // the leading term of the error is positive: degree 2 n is not exact (visible while it is above rounding)
        assert!(n > 10 || check::quadrature(&gauss_legendre(n), &line, 2 * n).is_err());
    }
    // Abramowitz and Stegun, table 25.4, n = 5
    let five = gauss_legendre::<f64>(5);
    assert!((five.points[3][0] - 0.5 * (1.0 + 0.538469310105683)).abs() < 1e-15);
    assert!((five.weights[3] - 0.5 * 0.478628670499366).abs() < 1e-15);
    let single = BSpline::<f32>::uniform(1, 1, 0);
    check::quadrature(&gauss_legendre::<f32>(6), &single, 11).unwrap();
}

#[test]
fn simplex_rules_are_exact_for_their_degree() {
    let triangle = LagrangeSimplex::<2>::on_corners(1, vec![0, 1, 2]);
    let tetrahedron = LagrangeSimplex::<3>::on_corners(1, vec![0, 1, 2, 3]);
    for degree in 0..=14 {
        check::quadrature(&simplex_rule(degree), &triangle, degree).unwrap();
        check::quadrature(&simplex_rule(degree), &tetrahedron, degree).unwrap();
    }
    assert!(check::quadrature(&simplex_rule(4), &triangle, 6).is_err());
}

#[test]
fn tensor_rules_are_products_of_their_axes() {
    let grid = TensorProduct::<2, _>::new([BSpline::<f64>::uniform(2, 3, 1), BSpline::uniform(3, 2, 0)]);
    check::quadrature(&TensorRule::gauss([3, 4]), &grid, 5).unwrap();
    let mixed = PerElement::new(vec![Arc::new(TensorRule::gauss([3, 3])), Arc::new(simplex_rule::<2, f64>(3))], vec![0, 1]);
    assert!(mixed.axes(0).is_some() && mixed.axes(1).is_none());
    assert_eq!(mixed.rule(1).points.len(), 4);
}

#[test]
fn a_rule_with_a_wrong_weight_or_order_is_found() {
    let grid = TensorProduct::<2, _>::new([BSpline::<f64>::uniform(2, 3, 1), BSpline::uniform(3, 2, 0)]);
    let mut rule: Rule<2> = TensorRule::gauss([2, 2]).rule(0).clone();
    rule.weights[1] *= 1.001;
    assert!(check::quadrature(&rule, &grid, 1).unwrap_err().contains("monomial [0, 0]"));

    #[derive(Debug)]
    struct Swapped(TensorRule<2>);
    impl Quadrature<2> for Swapped {
        fn rule(&self, element: usize) -> &Rule<2> {
            self.0.rule(element)
        }
        fn axes(&self, element: usize) -> Option<[&dyn Quadrature<1>; 2]> {
            self.0.axes(element).map(|[a, b]| [b, a])
        }
    }
    assert!(check::quadrature(&Swapped(TensorRule::gauss([2, 3])), &grid, 3).unwrap_err().contains("product of the axes"));
}

#[test]
fn gauss_lobatto_nodes_have_the_known_places() {
    // Abramowitz and Stegun, table 25.6: n = 4: 1/sqrt(5); n = 5: sqrt(3/7); n = 6: sqrt((7 ± 2 sqrt 7)/21)
    let close = |degree: usize, i: usize, x: f64| {
        let nodes = gauss_lobatto_nodes::<f64>(degree);
        assert_eq!(nodes.len(), degree + 1);
        assert!((nodes[i] - 0.5 * (1.0 + x)).abs() < 1e-15, "degree {degree}");
    };
    close(3, 2, 0.2f64.sqrt());
    close(4, 3, (3.0f64 / 7.0).sqrt());
    close(5, 4, ((7.0 + 2.0 * 7.0f64.sqrt()) / 21.0).sqrt());
    close(5, 3, ((7.0 - 2.0 * 7.0f64.sqrt()) / 21.0).sqrt());
    assert_eq!(gauss_lobatto_nodes::<f64>(2), [0.0, 0.5, 1.0]);
    assert_eq!(gauss_lobatto_nodes::<f64>(1), [0.0, 1.0]);
}
