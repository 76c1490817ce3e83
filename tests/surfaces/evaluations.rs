//! Maps of polynomial elements are evaluated to find their coefficients, not at the points of every overlap.

use crate::common::{Patch, Shape};
use faying::basis::{Cell, Elements, Order};
use faying::coupling::InterfaceQuadrature;
use faying::coupling::interface::{MergedSurface, Tolerance};
use faying::geometry::{Bounds, Geometry, MapTable};
use faying::linalg::Vector;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A side that counts the points at which its map is evaluated.
#[derive(Debug)]
struct Counted {
    side: Patch,
    points: AtomicUsize,
}

impl Counted {
    fn new(side: Patch) -> Self {
        Self { side, points: AtomicUsize::new(0) }
    }

    fn per_element(&self) -> f64 {
        self.points.load(Ordering::Relaxed) as f64 / self.num_elements() as f64
    }
}

impl Elements for Counted {
    fn num_elements(&self) -> usize {
        self.side.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.side.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.side.corners(element, ids);
    }
}

impl Geometry<2, 3> for Counted {
    fn map(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut MapTable<2, 3>) {
        self.points.fetch_add(xi.len(), Ordering::Relaxed);
        self.side.map(element, xi, order, table);
    }
    fn bounds(&self, element: usize) -> Bounds<3> {
        self.side.bounds(element)
    }
}

#[test]
fn overlaps_of_polynomial_elements_evaluate_no_map() {
    for (triangles, degree) in [(true, 1), (false, 1), (true, 2), (false, 2)] {
        let side = |n: usize, w: f64| Patch::grid(Shape::Wave(0.1), [n, n], triangles, |a, b| [a, b]).warped(w).facets(degree);
        let (slave, master) = (Counted::new(side(12, 0.0)), Counted::new(side(17, 0.04)));
        let found = MergedSurface::tied(degree + 1, Tolerance::Local).segments(&slave, &master).unwrap();
        assert!(found.num_pieces() > 500, "{triangles} {degree}");
        // the grid on which an element is measured, with its centre; the master's also for closest points of the slave
        let grid = if triangles { 16.0 } else { 26.0 };
        assert_eq!(slave.per_element(), grid, "{triangles} {degree}");
        assert!(master.per_element() < 100.0, "{triangles} {degree}: {}", master.per_element());
    }
}
