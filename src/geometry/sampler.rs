//! Maps evaluated at the same points of many elements: functions of a reference cell are tabulated once.

use super::{Control, Geometry, MapTable, combine};
use crate::basis::{Order, ShapeTable};
use crate::linalg::{Real, Vector};

/// Largest number of cached tables; further reference cells are evaluated directly.
const KEPT: usize = 64;

/// A geometry with cached tables of its functions at sets of points, one per reference cell and set.
#[derive(Debug)]
pub struct Sampler<'a, const D: usize, const N: usize, T: Real, G: ?Sized> {
    geometry: &'a G,
    control: Option<Control<'a, D, N, T>>,
    order: Order,
    kept: Vec<(Key, ShapeTable<D, T>)>,
    ids: Vec<usize>,
}

/// Reference cell and set of points.
type Key = (usize, usize);

impl<'a, const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized> Sampler<'a, D, N, T, G> {
    /// Creates a sampler of `geometry` that evaluates up to `order`.
    pub fn new(geometry: &'a G, order: Order) -> Self {
        Self { geometry, control: geometry.map_structure().control(), order, kept: Vec::new(), ids: Vec::new() }
    }

    /// Evaluates [`Geometry::map`] at `xi`; `set` is the caller's number of these points, which must be the same in all calls with it.
    pub fn map(&mut self, element: usize, set: usize, xi: &[Vector<D, T>], table: &mut MapTable<D, N, T>) {
        match self.known(element, set, xi) {
            Some((control, k)) => {
                control.basis.active(element, &mut self.ids);
                combine(control.points, &self.ids, &self.kept[k].1, xi.len(), self.order, table);
            }
            None => self.geometry.map(element, xi, self.order, table),
        }
    }

    /// Functions and points of the map, and the index of the table of `element`; `None` if the element has no cached table.
    fn known(&mut self, element: usize, set: usize, xi: &[Vector<D, T>]) -> Option<(Control<'a, D, N, T>, usize)> {
        let control = self.control?;
        let key = (control.basis.structure().reference(element)?, set);
        if let Some(k) = self.kept.iter().position(|(known, _)| *known == key) {
            return Some((control, k));
        }
        if self.kept.len() == KEPT {
            return None;
        }
        let mut shapes = ShapeTable::new();
        control.basis.tabulate(element, xi, self.order, &mut shapes);
        self.kept.push((key, shapes));
        Some((control, self.kept.len() - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{BSpline, Basis, LagrangeLine, TensorProduct};
    use crate::geometry::ControlPoints;

    /// Points of set `k`.
    fn points(k: usize) -> Vec<Vector<2>> {
        (0..3).map(|q| Vector::from([0.3 * q as f64, 0.01 * k as f64])).collect()
    }

    /// Evaluates every element at `sets` sets of points, twice, and compares with the map itself; returns the number of cached tables.
    fn compared(geometry: &dyn Geometry<2, 2, f64>, elements: usize, sets: usize, order: Order) -> usize {
        let (mut sampler, mut found, mut known) = (Sampler::new(geometry, order), MapTable::new(), MapTable::new());
        for _ in 0..2 {
            for element in 0..elements {
                for set in 0..sets {
                    sampler.map(element, set, &points(set), &mut found);
                    geometry.map(element, &points(set), order, &mut known);
                    assert_eq!((&found.x, &found.jacobian, &found.hessian), (&known.x, &known.jacobian, &known.hessian));
                }
            }
        }
        sampler.kept.len()
    }

    fn bent<B: Basis<2>>(basis: B) -> ControlPoints<B, 2> {
        let points = (0..basis.num_functions()).map(|i| Vector::from([i as f64 + (i as f64).sin(), (0.7 * i as f64).cos()])).collect();
        ControlPoints { basis, points }
    }

    #[test]
    fn maps_are_those_of_the_geometry_with_and_without_tables() {
        let cells = bent(TensorProduct::new([LagrangeLine::new(2, 3), LagrangeLine::new(1, 4)]));
        for order in [Order::Values, Order::Gradients, Order::Hessians] {
            assert_eq!(compared(&cells, 12, 5, order), 5, "one reference cell");
        }
        // functions of a spline differ from element to element
        let splines = bent(TensorProduct::new([BSpline::uniform(2, 3, 1), BSpline::uniform(2, 4, 1)]));
        assert_eq!(compared(&splines, 12, 5, Order::Gradients), 0);
    }

    #[test]
    fn beyond_the_tables_kept_the_map_is_asked() {
        let cells = bent(TensorProduct::new([LagrangeLine::new(1, 2), LagrangeLine::new(1, 2)]));
        assert_eq!(compared(&cells, 4, KEPT + 3, Order::Gradients), KEPT);
    }
}
