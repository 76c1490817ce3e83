//! The map of cells of one kind in the node order of files: equispaced nodes, first axis fastest.

use super::{CellShape, MeshBlock};
use faying::basis::{Cell, Elements, Order, simplex_lattice};
use faying::geometry::{Bounds, Geometry, MapStructure, MapTable};
use faying::linalg::Vector;

/// Bound of the distance by which polynomials of order up to 4 leave the box of their nodes, relative to its diagonal: the Lebesgue
/// constant of five equispaced points is 2.2, its cube 10.8.
const OVERSHOOT: f64 = 11.0;

/// Largest order of cells, see [`MeshBlock`].
const MOST: usize = 4;

/// Values and derivatives of the factors along one axis; those beyond the order are zero.
type Factors = [[f64; 2]; MOST + 1];

/// The factor of a missing axis.
const ONE: Factors = [[1.0, 0.0], [0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]];

/// The cells of a block. Coordinates beyond those of the file are zero.
#[derive(Clone, Debug)]
pub struct CellMap<'a, const D: usize> {
    cell: Cell,
    order: usize,
    nodes: &'a [u32],
    points: &'a [[f64; 3]],
    lattice: Vec<[usize; D]>,
}

impl<'a, const D: usize> CellMap<'a, D> {
    /// The cells of `block`; `None` for points, prisms and pyramids, for cells of another dimension, and of an order above 4.
    pub fn new(block: &'a MeshBlock, points: &'a [[f64; 3]]) -> Option<Self> {
        let cell = match block.shape {
            CellShape::Line | CellShape::Quadrilateral | CellShape::Hexahedron => Cell::Tensor,
            CellShape::Triangle | CellShape::Tetrahedron => Cell::Simplex,
            _ => return None,
        };
        let n = block.order + 1;
        let lattice = match cell {
            _ if block.shape.dimension() != D || block.order > MOST => return None,
            Cell::Simplex => simplex_lattice::<D>(block.order),
            _ => (0..n.pow(D as u32)).map(|a| std::array::from_fn(|k| a / n.pow(k as u32) % n)).collect(),
        };
        Some(Self { cell, order: block.order, nodes: &block.nodes, points, lattice })
    }

    /// Index of a node among those of its cell, by its steps along the axes.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn place(&self, steps: &[usize; D]) -> usize {
        self.lattice.iter().position(|l| l == steps).expect("a node of the cell")
    }

    // x = sum_a l_a x_a with the barycentric coordinates l; no allocation, files hold millions of straight simplices
    fn affine(&self, element: usize, xi: &[Vector<D>], order: Order, table: &mut MapTable<D, 3>) {
        for (index, &node) in self.lattice.iter().zip(self.nodes(element)) {
            let x = Vector::<3>::from(self.points[node as usize]);
            let axis = index.iter().position(|i| *i == 1);
            for (q, xi) in xi.iter().enumerate() {
                table.x[q] += x * axis.map_or(1.0 - xi.sum(), |k| xi[k]);
                if order >= Order::Gradients {
                    let j = &mut table.jacobian[q];
                    match axis {
                        Some(k) => (0..3).for_each(|c| j[(c, k)] += x[c]),
                        None => (0..3).for_each(|c| (0..D).for_each(|k| j[(c, k)] -= x[c])),
                    }
                }
            }
        }
    }

    /// Points of an element.
    pub fn nodes(&self, element: usize) -> &'a [u32] {
        &self.nodes[element * self.lattice.len()..(element + 1) * self.lattice.len()]
    }
}

/// Lagrange polynomials with nodes i / p, and their derivatives.
fn line(p: usize, x: f64) -> Factors {
    let z = p as f64 * x;
    let factor = |i: usize, m: usize| (z - m as f64) / (i as f64 - m as f64);
    let mut all = Factors::default();
    for (i, f) in all.iter_mut().enumerate().take(p + 1) {
        let others = |skip: usize| (0..=p).filter(|&m| m != i && m != skip).map(|m| factor(i, m)).product::<f64>();
        let slope: f64 = (0..=p).filter(|&m| m != i).map(|m| p as f64 / (i as f64 - m as f64) * others(m)).sum();
        *f = [others(i), slope];
    }
    all
}

/// prod_{m < a} (p x - m) / (m + 1) for a = 0..=p, and the derivatives: factors of Lagrange polynomials on simplices.
fn falling(p: usize, x: f64) -> Factors {
    let z = p as f64 * x;
    let mut all = ONE;
    for m in 0..p {
        let [v, d] = all[m];
        let (f, df) = ((z - m as f64) / (m + 1) as f64, p as f64 / (m + 1) as f64);
        all[m + 1] = [v * f, d * f + v * df];
    }
    all
}

impl<const D: usize> Elements for CellMap<'_, D> {
    fn num_elements(&self) -> usize {
        self.nodes.len() / self.lattice.len()
    }

    fn cell(&self, _element: usize) -> Cell {
        self.cell
    }
}

impl<const D: usize> Geometry<D, 3> for CellMap<'_, D> {
    fn map(&self, element: usize, xi: &[Vector<D>], order: Order, table: &mut MapTable<D, 3>) {
        assert!(order < Order::Hessians, "cells of files answer first derivatives");
        table.reset(xi.len(), order);
        let (p, simplex) = (self.order, self.cell == Cell::Simplex);
        if self.is_affine(element) {
            return self.affine(element, xi, order, table);
        }
        for (q, xi) in xi.iter().enumerate() {
            let one = if simplex { falling } else { line };
            let axes: [Factors; D] = std::array::from_fn(|k| one(p, xi[k]));
            let rest = if simplex { falling(p, 1.0 - xi.sum()) } else { ONE };
            for (index, &node) in self.lattice.iter().zip(self.nodes(element)) {
                let last = if simplex { rest[p - index.iter().sum::<usize>()] } else { rest[0] };
                let others = |skip: usize| (0..D).filter(|&k| k != skip).map(|k| axes[k][index[k]][0]).product::<f64>();
                let x = Vector::<3>::from(self.points[node as usize]);
                let product = others(D);
                table.x[q] += x * (product * last[0]);
                if order >= Order::Gradients {
                    for k in 0..D {
                        // the last barycentric coordinate falls along every axis
                        let slope = axes[k][index[k]][1] * others(k) * last[0] - product * last[1];
                        for c in 0..3 {
                            table.jacobian[q][(c, k)] += slope * x[c];
                        }
                    }
                }
            }
        }
    }

    fn map_structure(&self) -> &dyn MapStructure<D, 3> {
        self
    }

    fn bounds(&self, element: usize) -> Bounds<3> {
        let points: Vec<Vector<3>> = self.nodes(element).iter().map(|&n| Vector::from(self.points[n as usize])).collect();
        let around = Bounds::around(&points).expect("a cell has nodes");
        // what is straight stays among its corners
        if self.is_affine(element) {
            return around;
        }
        around.inflated(OVERSHOOT * around.diagonal())
    }
}

impl<const D: usize> MapStructure<D, 3> for CellMap<'_, D> {
    fn is_affine(&self, _element: usize) -> bool {
        self.order == 1 && (D == 1 || self.cell == Cell::Simplex)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron of volume 1 / 6 * 2 * 3 * 0.5, skewed, with its nodes in the order of the lattice.
    const CORNERS: [[f64; 3]; 4] = [[1.0, 2.0, -1.0], [3.0, 2.0, -1.0], [1.5, 5.0, -1.0], [0.5, 1.0, -0.5]];

    fn block(shape: CellShape, order: usize, nodes: usize) -> MeshBlock {
        MeshBlock { shape, order, nodes: (0..nodes as u32).collect(), ids: vec![1], groups: Vec::new() }
    }

    // the same straight cell with nodes at the middles of its edges takes the formula of curved cells
    fn halfway<const D: usize>(cell: Cell) -> Vec<[f64; 3]> {
        let lattice: Vec<[usize; D]> = match cell {
            Cell::Simplex => simplex_lattice::<D>(2),
            Cell::Tensor => (0..3).map(|i| [i; D]).collect(),
        };
        let at = |i: &[usize; D], c: usize| {
            let rest = 2.0 - i.iter().sum::<usize>() as f64;
            (rest * CORNERS[0][c] + (0..D).map(|k| i[k] as f64 * CORNERS[k + 1][c]).sum::<f64>()) / 2.0
        };
        lattice.iter().map(|i| std::array::from_fn(|c| at(i, c))).collect()
    }

    fn agrees<const D: usize>(shape: CellShape, size: Option<f64>) {
        let straight = block(shape, 1, D + 1);
        let map = CellMap::<D>::new(&straight, &CORNERS).expect("a shape of this dimension");
        let points = halfway::<D>(map.cell(0));
        let curved = block(shape, 2, points.len());
        let general = CellMap::<D>::new(&curved, &points).expect("a shape of this dimension");
        assert!(map.is_affine(0) && !general.is_affine(0));
        let xi = [Vector::<D>::zeros(), Vector::repeat(0.2), Vector::from_fn(|k, _| 0.1 + 0.15 * k as f64)];
        let (mut a, mut b) = (MapTable::new(), MapTable::new());
        map.map(0, &xi, Order::Gradients, &mut a);
        general.map(0, &xi, Order::Gradients, &mut b);
        for q in 0..xi.len() {
            assert!((a.x[q] - b.x[q]).norm() < 1e-14, "{shape:?}: {} against {}", a.x[q], b.x[q]);
            assert!((a.jacobian[q] - b.jacobian[q]).norm() < 1e-13, "{shape:?}: {} against {}", a.jacobian[q], b.jacobian[q]);
        }
        let [found, other] = [faying::space::measure::<D, 3, f64, _>(&map), faying::space::measure::<D, 3, f64, _>(&general)];
        assert!((found - other).abs() < 1e-13 && size.is_none_or(|v| (found - v).abs() < 1e-14), "{shape:?}: {found}, {other}");
        assert!(map.nodes(0).iter().all(|&n| map.bounds(0).distance(&Vector::from(CORNERS[n as usize])) == 0.0));
    }

    #[test]
    fn straight_cells_have_the_map_and_the_size_of_curved_ones_that_are_straight() {
        agrees::<1>(CellShape::Line, Some(2.0));
        agrees::<2>(CellShape::Triangle, Some(3.0));
        agrees::<3>(CellShape::Tetrahedron, Some(0.5));
    }
}
