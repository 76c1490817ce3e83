//! Cells of order 2 that files store without the nodes inside their faces and themselves: 8-node quadrilaterals, 20-node hexahedra.
//!
//! Their shape functions are biquadratic or triquadratic polynomials, so that the cell with all nodes has the same map if the nodes that
//! are missing stand where that map says:
//!
//!   face: 1/2 (sum of its 4 middle nodes) - 1/4 (sum of its 4 corners),   cell: 1/4 (sum of its 12 middle nodes - sum of its 8 corners)

use super::budget::Budget;
use super::{CellShape, FileError};
use std::collections::HashMap;

/// Marks a node that is missing.
pub(super) const MISSING: u32 = u32::MAX;

/// Memory of a face in the table.
const FACE: u64 = 128;

/// The nodes of faces that were added, so that cells on both sides of a face share one.
#[derive(Debug, Default)]
pub(super) struct Completion {
    faces: HashMap<[u32; 8], u32>,
}

/// Adds a node that combines others: the sums of corners and of middle nodes, each times its factor.
fn add(points: &mut Vec<[f64; 3]>, corners: &[u32], middles: &[u32], factors: [f64; 2], budget: &mut Budget) -> Result<u32, FileError> {
    let sum = |nodes: &[u32], k: usize| nodes.iter().map(|n| points[*n as usize][k]).sum::<f64>();
    let x = std::array::from_fn(|k| factors[0] * sum(corners, k) + factors[1] * sum(middles, k));
    let new = u32::try_from(points.len()).ok().filter(|n| *n != MISSING);
    let new = new.ok_or_else(|| FileError::Unsupported { what: "a mesh of more than 2^32 points".into(), spot: None })?;
    budget.room(points, 1)?;
    points.push(x);
    Ok(new)
}

impl Completion {
    /// Fills in the nodes of a cell of order 2, first axis fastest, that are [`MISSING`]: those in the middle of faces and of the cell.
    pub fn complete(
        &mut self,
        shape: CellShape,
        nodes: &mut [u32],
        points: &mut Vec<[f64; 3]>,
        budget: &mut Budget,
    ) -> Result<(), FileError> {
        if shape == CellShape::Quadrilateral {
            return self.face(nodes, std::array::from_fn(|k| k), points, budget);
        }
        for axis in 0..3 {
            let (stride, others) = (3usize.pow(axis), [[3, 9], [1, 9], [1, 3]][axis as usize]);
            for side in [0, 2] {
                let places = std::array::from_fn(|k| side * stride + k % 3 * others[0] + k / 3 * others[1]);
                self.face(nodes, places, points, budget)?;
            }
        }
        let on = |ones: usize| (0..27usize).filter(move |k| [k % 3, k / 3 % 3, k / 9].iter().filter(|i| **i == 1).count() == ones);
        let [corners, middles] = [0, 1].map(|ones| on(ones).map(|k| nodes[k]).collect::<Vec<_>>());
        nodes[13] = add(points, &corners, &middles, [-0.25, 0.25], budget)?;
        Ok(())
    }

    /// Fills in the middle node of a face, whose nine nodes stand at `places`.
    fn face(&mut self, nodes: &mut [u32], places: [usize; 9], points: &mut Vec<[f64; 3]>, budget: &mut Budget) -> Result<(), FileError> {
        let corners = [0, 2, 6, 8].map(|k| nodes[places[k]]);
        let middles = [1, 3, 5, 7].map(|k| nodes[places[k]]);
        let mut key: [u32; 8] = std::array::from_fn(|k| if k < 4 { corners[k] } else { middles[k - 4] });
        key.sort_unstable();
        nodes[places[4]] = match self.faces.get(&key) {
            Some(known) => *known,
            None => {
                let new = add(points, &corners, &middles, [-0.25, 0.5], budget)?;
                budget.take(FACE)?;
                self.faces.insert(key, new);
                new
            }
        };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CellMap, Limits, MeshBlock};
    use faying::basis::Order;
    use faying::geometry::{Geometry, MapTable};
    use faying::linalg::Vector;

    /// Shape functions of the 20-node hexahedron at a point of the unit cube: of the node at `a`, whose coordinates are 0, 1 or 2 halves.
    fn shape_function(a: [usize; 3], x: &Vector<3>) -> f64 {
        let (s, n): (Vec<f64>, Vec<f64>) = (0..3).map(|k| (2.0 * x[k] - 1.0, a[k] as f64 - 1.0)).unzip();
        let product: f64 = (0..3).map(|k| if a[k] == 1 { 1.0 - s[k] * s[k] } else { 1.0 + s[k] * n[k] }).product();
        if a.contains(&1) { product / 4.0 } else { product / 8.0 * ((0..3).map(|k| s[k] * n[k]).sum::<f64>() - 2.0) }
    }

    #[test]
    fn completed_hexahedra_have_the_map_of_their_twenty_nodes() {
        let lattice: Vec<[usize; 3]> = (0..27).map(|k| [k % 3, k / 3 % 3, k / 9]).collect();
        let bent = |a: &[usize; 3]| {
            let x = a.map(|i| i as f64 / 2.0);
            [x[0] + 0.1 * (x[1] * 7.0).sin(), x[1] * (1.0 + 0.2 * x[2] * x[0]), x[2] + 0.15 * (5.0 * x[0] + x[1]).cos()]
        };
        let given = |a: &[usize; 3]| a.iter().filter(|i| **i == 1).count() < 2;
        let mut points: Vec<[f64; 3]> = lattice.iter().filter(|a| given(a)).map(bent).collect();
        let (own, mut next) = (points.clone(), 0..20u32);
        let mut nodes: Vec<u32> = lattice.iter().map(|a| if given(a) { next.next().unwrap_or(0) } else { MISSING }).collect();
        let mut all = Completion::default();
        all.complete(CellShape::Hexahedron, &mut nodes, &mut points, &mut Budget::new(&Limits::default(), 0)).expect("a hexahedron");
        assert_eq!((points.len(), all.faces.len()), (27, 6));
        let block = MeshBlock { shape: CellShape::Hexahedron, order: 2, nodes, ids: vec![1], groups: vec![] };
        let map = CellMap::<3>::new(&block, &points).expect("a hexahedron");
        let mut table = MapTable::new();
        let at = [Vector::<3>::new(0.3, 0.8, 0.45), Vector::<3>::new(0.0, 0.37, 0.9), Vector::<3>::repeat(0.5)];
        map.map(0, &at, Order::Values, &mut table);
        for (x, xi) in table.x.iter().zip(&at) {
            let nodes = lattice.iter().filter(|a| given(a)).zip(&own);
            let expected: Vector<3> = nodes.map(|(a, p)| Vector::<3>::from(*p) * shape_function(*a, xi)).sum();
            assert!((x - expected).norm() < 1e-14, "{x} {expected}");
        }
    }
}
