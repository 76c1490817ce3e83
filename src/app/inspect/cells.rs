//! The map of cells of one kind as files list them: equispaced nodes, first axis fastest.

use crate::basis::{Cell, Elements, Order, simplex_lattice};
use crate::geometry::{Bounds, Geometry, MapTable};
use crate::io::files::{CellShape, MeshBlock};
use crate::linalg::Vector;

/// Polynomials of order up to 4 leave the box of their nodes by less than this share of its diagonal: the Lebesgue constant of five
/// equispaced points is 2.2, its cube 10.8.
const OVERSHOOT: f64 = 11.0;

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
    /// The cells of `block`; none for points, prisms and pyramids, and for cells of another dimension.
    pub fn new(block: &'a MeshBlock, points: &'a [[f64; 3]]) -> Option<Self> {
        let cell = match block.shape {
            CellShape::Line | CellShape::Quadrilateral | CellShape::Hexahedron => Cell::Tensor,
            CellShape::Triangle | CellShape::Tetrahedron => Cell::Simplex,
            _ => return None,
        };
        let n = block.order + 1;
        let lattice = match cell {
            _ if block.shape.dimension() != D => return None,
            Cell::Simplex => simplex_lattice::<D>(block.order),
            _ => (0..n.pow(D as u32)).map(|a| std::array::from_fn(|k| a / n.pow(k as u32) % n)).collect(),
        };
        Some(Self { cell, order: block.order, nodes: &block.nodes, points, lattice })
    }

    /// Place of a node among those of its cell, by its steps along the axes.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn place(&self, steps: &[usize; D]) -> usize {
        self.lattice.iter().position(|l| l == steps).expect("a node of the cell")
    }

    /// Points of an element.
    pub fn nodes(&self, element: usize) -> &'a [u32] {
        &self.nodes[element * self.lattice.len()..(element + 1) * self.lattice.len()]
    }
}

/// Lagrange polynomials with nodes i / p, and their derivatives.
fn line(p: usize, x: f64) -> Vec<[f64; 2]> {
    let z = p as f64 * x;
    let factor = |i: usize, m: usize| (z - m as f64) / (i as f64 - m as f64);
    (0..=p)
        .map(|i| {
            let others = |skip: usize| (0..=p).filter(|&m| m != i && m != skip).map(|m| factor(i, m)).product::<f64>();
            let slope: f64 = (0..=p).filter(|&m| m != i).map(|m| p as f64 / (i as f64 - m as f64) * others(m)).sum();
            [others(i), slope]
        })
        .collect()
}

/// prod_{m < a} (p x - m) / (m + 1) for a = 0..=p, and the derivatives: factors of Lagrange polynomials on simplices.
fn falling(p: usize, x: f64) -> Vec<[f64; 2]> {
    let z = p as f64 * x;
    let mut all = vec![[1.0, 0.0]];
    for m in 0..p {
        let [v, d] = all[m];
        let (f, df) = ((z - m as f64) / (m + 1) as f64, p as f64 / (m + 1) as f64);
        all.push([v * f, d * f + v * df]);
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
        for (q, xi) in xi.iter().enumerate() {
            let one = if simplex { falling } else { line };
            let axes: [Vec<[f64; 2]>; D] = std::array::from_fn(|k| one(p, xi[k]));
            let rest = if simplex { falling(p, 1.0 - xi.sum()) } else { vec![[1.0, 0.0]] };
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

    fn bounds(&self, element: usize) -> Bounds<3> {
        let points: Vec<Vector<3>> = self.nodes(element).iter().map(|&n| Vector::from(self.points[n as usize])).collect();
        let around = Bounds::around(&points).expect("a cell has nodes");
        around.inflated(OVERSHOOT * around.diagonal())
    }
}
