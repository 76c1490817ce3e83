//! Greville points of a multiplier: one point per function, computed from the basis alone.
//!
//! The Greville abscissa of a B-spline is its coefficient in the identity, xi = sum_i c_i B_i(xi): the mean of its inner knots. The
//! active functions of an element reproduce the identity there, so c_i follows from a small system per element, in the local
//! coordinate of that element, without knots. Every element of a support gives the same point in its own coordinate; the point belongs
//! to the one with 0 <= c_i <= 1. For a single function on an element (constants) it is the element's midpoint.
//!
//! On surfaces of tensor cells both coordinates are found in this way, so that products have the products of the points of their
//! directions; a coordinate along which no function of an element changes is that of its midpoint. Triangles have no such points.

use crate::basis::{Basis, Cell, Order, ShapeTable};
use crate::geometry::cell;
use crate::linalg::{Real, Vector, lit, num};
use nalgebra::{DMatrix, DVector};

/// Tolerance for errors of the identity, and for points outside the ends of an element.
const ROUND_OFF: f64 = 1e-7;

/// Returns the point (element, xi) of every function; `None` if the functions have no such points: if they do not sum to one, do not
/// reproduce the identity, or have several points (dual functions).
pub fn greville_points<const S: usize, T: Real>(basis: &dyn Basis<S, T>) -> Option<Vec<(usize, Vector<S, T>)>> {
    if S != 1 {
        return points_on_surface(basis);
    }
    let n = basis.num_functions();
    // (element, xi, whether the function has a slope there)
    let mut found: Vec<Option<(usize, T, bool)>> = vec![None; n];
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    for element in 0..basis.num_elements() {
        basis.active(element, &mut ids);
        let own = ids.len();
        // one point more than functions: the additional equation is the test
        let points: Vec<Vector<S, T>> = (0..=own).map(|q| Vector::from_element(num::<T>(q) / num::<T>(own))).collect();
        basis.tabulate(element, &points, Order::Values, &mut table);
        let off = |sum: T, wanted: T| (sum - wanted).abs() > lit(ROUND_OFF);
        if (0..=own).any(|q| off(table.values(q).iter().fold(T::zero(), |s, &v| s + v), T::one())) {
            return None;
        }
        if own == 1 {
            found[ids[0]].get_or_insert((element, lit(0.5), false));
            continue;
        }
        let matrix = DMatrix::from_fn(own + 1, own, |q, a| table.values(q)[a]);
        let right = DVector::from_fn(own + 1, |q, _| points[q][0]);
        // as many equations as functions, the last of them at the far end
        let rows: Vec<usize> = (1..=own).collect();
        let c = matrix.select_rows(&rows).lu().solve(&right.select_rows(&rows))?;
        if (0..=own).any(|q| off(matrix.row(q).iter().zip(c.iter()).fold(T::zero(), |s, (&m, &c)| s + m * c), right[q])) {
            return None;
        }
        for (&i, &xi) in ids.iter().zip(c.iter()) {
            let inside = |x: T, margin: T| x >= margin && x <= T::one() - margin;
            if !inside(xi, lit(-ROUND_OFF)) {
                continue;
            }
            match found[i] {
                // points inside two elements: the function has no unique point
                Some((_, other, true)) if inside(xi, lit(ROUND_OFF)) || inside(other, lit(ROUND_OFF)) => return None,
                Some((_, _, true)) => {}
                _ => found[i] = Some((element, xi.max(T::zero()).min(T::one()), true)),
            }
        }
    }
    found.into_iter().map(|f| f.map(|(element, xi, _)| (element, Vector::from_element(xi)))).collect()
}

/// The points on cells of more than one direction.
fn points_on_surface<const S: usize, T: Real>(basis: &dyn Basis<S, T>) -> Option<Vec<(usize, Vector<S, T>)>> {
    // (element, xi, number of directions in which the functions change there)
    let mut found: Vec<Option<(usize, Vector<S, T>, usize)>> = vec![None; basis.num_functions()];
    let mut ids = Vec::new();
    let inside = |xi: &Vector<S, T>, margin: T| xi.iter().all(|&x| x >= margin && x <= T::one() - margin);
    for element in 0..basis.num_elements() {
        let (points, directions) = own_points(basis, element)?;
        basis.active(element, &mut ids);
        for (&i, xi) in ids.iter().zip(&points).filter(|(_, xi)| inside(xi, lit(-ROUND_OFF))) {
            match found[i] {
                Some((.., known)) if known > directions => {}
                // points inside two elements: the function has no unique point
                Some((_, other, known)) if known == directions => {
                    if inside(xi, lit(ROUND_OFF)) || inside(&other, lit(ROUND_OFF)) {
                        return None;
                    }
                }
                _ => found[i] = Some((element, xi.map(|x| x.max(T::zero()).min(T::one())), directions)),
            }
        }
    }
    found.into_iter().map(|f| f.map(|(element, xi, _)| (element, xi))).collect()
}

/// The points of the functions of an element in its own coordinates, and the number of directions in which the functions change.
fn own_points<const S: usize, T: Real>(basis: &dyn Basis<S, T>, element: usize) -> Option<(Vec<Vector<S, T>>, usize)> {
    if basis.cell(element) != Cell::Tensor {
        return None;
    }
    let mut table = ShapeTable::new();
    // more points than functions: the additional equations are the test
    let points = cell::grid::<S, T>(Cell::Tensor, basis.degree(element).into_iter().max()? + 2);
    basis.tabulate(element, &points, Order::Gradients, &mut table);
    let own = table.num_functions();
    let off = |sum: T, wanted: T| (sum - wanted).abs() > lit(ROUND_OFF);
    if own > points.len() || (0..points.len()).any(|q| off(table.values(q).iter().fold(T::zero(), |s, &v| s + v), T::one())) {
        return None;
    }
    let matrix = DMatrix::from_fn(points.len(), own, |q, a| table.values(q)[a]);
    let qr = matrix.clone().qr();
    let (mut found, mut directions) = (vec![Vector::<S, T>::repeat(lit(0.5)); own], 0);
    for k in 0..S {
        let changes = (0..points.len()).any(|q| table.grads(q).iter().any(|g| g[k].abs() > lit(ROUND_OFF)));
        if !changes {
            continue;
        }
        let right = DVector::from_fn(points.len(), |q, _| points[q][k]);
        let c = qr.r().solve_upper_triangular(&(qr.q().transpose() * &right))?;
        if (&matrix * &c).iter().zip(right.iter()).any(|(&found, &wanted)| off(found, wanted)) {
            return None;
        }
        directions += 1;
        found.iter_mut().zip(c.iter()).for_each(|(xi, &c)| xi[k] = c);
    }
    Some((found, directions))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{BSpline, Polynomials, TensorProduct};

    /// Means of inner knots by hand: degree 2 on the breakpoints 0, 1, 3, 4.
    #[test]
    fn points_are_the_means_of_the_inner_knots() {
        let spline = BSpline::<f64>::from_breakpoints(2, &[0.0, 1.0, 3.0, 4.0], &[1, 1]);
        let points = greville_points::<1, f64>(&spline).unwrap();
        let breaks = [0.0, 1.0, 3.0, 4.0];
        let global: Vec<f64> = points.iter().map(|(e, xi)| breaks[*e] + xi[0] * (breaks[*e + 1] - breaks[*e])).collect();
        for (g, want) in global.iter().zip([0.0, 0.5, 2.0, 3.5, 4.0]) {
            assert!((g - want).abs() < 1e-12, "{global:?}");
        }
        // discontinuous pieces have their own points at shared vertices
        let pieces = spline.polynomials(Polynomials::Uniform { degree: 1, continuity: -1 }).unwrap();
        let points = greville_points(&*pieces).unwrap();
        let want = [(0, 0.0), (0, 1.0), (1, 0.0), (1, 1.0), (2, 0.0), (2, 1.0)];
        assert!(points.iter().zip(want).all(|(p, w)| p.0 == w.0 && (p.1[0] - w.1).abs() < 1e-12), "{points:?}");
        let constants = spline.polynomials(Polynomials::Uniform { degree: 0, continuity: -1 }).unwrap();
        assert!(greville_points(&*constants).unwrap().iter().enumerate().all(|(k, p)| p.0 == k && p.1[0] == 0.5));
    }

    /// Products have the products of the points of their directions, constant ones the midpoints of their elements.
    #[test]
    fn points_of_products_are_those_of_their_directions() {
        let axes =
            [BSpline::<f64>::from_breakpoints(2, &[0.0, 1.0, 3.0, 4.0], &[1, 1]), BSpline::from_breakpoints(1, &[0.0, 1.0, 2.0], &[0])];
        let lines = axes.each_ref().map(|axis| greville_points::<1, f64>(axis).unwrap());
        let product = TensorProduct::new(axes);
        let starts: [&[f64]; 2] = [&[0.0, 1.0, 3.0, 4.0], &[0.0, 1.0, 2.0]];
        let place = |k: usize, e: usize, xi: f64| starts[k][e] + xi * (starts[k][e + 1] - starts[k][e]);
        let points = greville_points::<2, f64>(&product).unwrap();
        assert_eq!(points.len(), 15);
        for (i, (e, xi)) in points.iter().enumerate() {
            for (k, (own, j)) in [(e % 3, i % 5), (e / 3, i / 5)].into_iter().enumerate() {
                let (wanted, found) = (place(k, lines[k][j].0, lines[k][j].1[0]), place(k, own, xi[k]));
                assert!((found - wanted).abs() < 1e-12, "function {i} along {k}: {found} for {wanted}");
            }
        }
        let constants = product.polynomials(Polynomials::Uniform { degree: 0, continuity: -1 }).unwrap();
        let middle = Vector::<2>::new(0.5, 0.5);
        assert!(greville_points(&*constants).unwrap().iter().enumerate().all(|(k, p)| *p == (k, middle)));
        // (p, q) = (2, 1) lowered by one: constant along the second direction
        let lowered = product.polynomials(Polynomials::Lowered(1)).unwrap();
        assert!(greville_points(&*lowered).unwrap().iter().all(|(_, xi)| xi[1] == 0.5));
        assert!(greville_points(&crate::basis::BernsteinSimplex::<2>::new(1, vec![0, 1, 2], true)).is_none());
    }
}
