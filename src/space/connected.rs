//! Connected parts: elements that share functions, and points of a mesh that coincide without being shared.

use super::{MeshCells, corner_places, nodes_per_cell};
use crate::basis::Basis;
use crate::geometry::Bounds;
use crate::linalg::{Union, Vector};
use std::collections::HashMap;

/// Points nearer than this share of their smallest cell coincide.
const SAME_PLACE: f64 = 1e-6;

/// Parts of a body that share no functions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Connected {
    count: usize,
    /// Part of every element and of every function; empty where there is one part.
    of_element: Vec<usize>,
    of_function: Vec<usize>,
}

impl Connected {
    /// The parts of `basis`, numbered by their first elements.
    pub fn of<const D: usize, B: Basis<D> + ?Sized>(basis: &B) -> Self {
        let one = Self { count: 1, of_element: Vec::new(), of_function: Vec::new() };
        if basis.structure().patches().is_some_and(|p| p.len() == 1) {
            return one;
        }
        let (mut trees, mut ids) = (Union::new(basis.num_functions()), Vec::new());
        let mut first = Vec::with_capacity(basis.num_elements());
        for e in 0..basis.num_elements() {
            basis.active(e, &mut ids);
            ids.windows(2).for_each(|pair| trees.unite(pair[0], pair[1]));
            first.push(ids.first().copied().unwrap_or(0));
        }
        let (mut number, mut count) = (vec![usize::MAX; basis.num_functions()], 0);
        let of_element: Vec<usize> = first
            .iter()
            .map(|&i| {
                let root = trees.root(i);
                if number[root] == usize::MAX {
                    number[root] = count;
                    count += 1;
                }
                number[root]
            })
            .collect();
        if count < 2 {
            return one;
        }
        let of_function = (0..basis.num_functions()).map(|i| number[trees.root(i)]).collect();
        Self { count, of_element, of_function }
    }

    /// Number of parts.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The part of an element.
    pub fn of_element(&self, element: usize) -> usize {
        self.of_element.get(element).copied().unwrap_or(0)
    }

    /// The part of a function.
    pub fn of_function(&self, function: usize) -> usize {
        self.of_function.get(function).copied().unwrap_or(0)
    }
}

/// Points of a mesh that coincide and are not one.
#[derive(Clone, Debug, PartialEq)]
pub struct Unshared<const N: usize> {
    /// Number of pairs of corners of cells that coincide.
    pub pairs: usize,
    /// The pair of least x, of these least y and so on.
    pub at: Vector<N>,
    /// Number of parts of the mesh that share no point.
    pub parts: usize,
}

/// The corners of cells that coincide without being one point; `None` if there are none.
///
/// Points coincide if they are nearer than 1e-6 of the smallest cell at both. By boxes of equal size: n in the number of points.
pub fn unshared_points<const N: usize>(cells: &MeshCells<N>) -> Option<Unshared<N>> {
    let mut trees = Union::new(cells.points.len());
    // size of the smallest cell at every point, zero at those of none
    let mut size = vec![0.0f64; cells.points.len()];
    for block in &cells.blocks {
        let corners = corner_places(block.cell, N, block.order);
        for cell in block.nodes.chunks_exact(nodes_per_cell(block.cell, N, block.order)) {
            let corner = || corners.iter().map(|&c| cell[c]).filter(|&p| p < cells.points.len());
            let places: Vec<Vector<N>> = corner().map(|p| cells.points[p]).collect();
            let diagonal = Bounds::around(&places).map_or(0.0, |b| b.diagonal());
            let mut before = None;
            for p in corner() {
                size[p] = if size[p] == 0.0 { diagonal } else { size[p].min(diagonal) };
                before.into_iter().for_each(|b| trees.unite(b, p));
                before = Some(p);
            }
        }
    }
    let used: Vec<usize> = (0..size.len()).filter(|&p| size[p] > 0.0).collect();
    let largest = used.iter().map(|&p| size[p]).fold(0.0, f64::max);
    // boxes at least as large as the largest distance of points that coincide
    let edge = 4.0 * SAME_PLACE * largest;
    let boxed = |x: &Vector<N>| -> [i64; N] { std::array::from_fn(|k| (x[k] / edge).floor() as i64) };
    let mut boxes: HashMap<[i64; N], Vec<usize>> = HashMap::with_capacity(used.len());
    let mut pairs: Vec<[usize; 2]> = Vec::new();
    for &p in &used {
        let x = &cells.points[p];
        let (lo, hi) = (boxed(&x.add_scalar(-SAME_PLACE * size[p])), boxed(&x.add_scalar(SAME_PLACE * size[p])));
        for corner in 0..1usize << N {
            let key: [i64; N] = std::array::from_fn(|k| if corner >> k & 1 == 1 { hi[k] } else { lo[k] });
            // each box once
            if (0..N).any(|k| corner >> k & 1 == 1 && hi[k] == lo[k]) {
                continue;
            }
            let near = |q: &usize| (cells.points[*q] - x).norm() <= SAME_PLACE * size[p].min(size[*q]);
            pairs.extend(boxes.get(&key).into_iter().flatten().filter(|q| near(q)).map(|&q| [q, p]));
        }
        boxes.entry(boxed(x)).or_default().push(p);
    }
    let before = |a: &Vector<N>, b: &Vector<N>| (0..N).map(|k| a[k].total_cmp(&b[k])).find(|o| o.is_ne()).is_some_and(|o| o.is_lt());
    let at = pairs.iter().map(|p| cells.points[p[0]]).reduce(|a, b| if before(&b, &a) { b } else { a })?;
    let mut roots: Vec<usize> = used.iter().map(|&p| trees.root(p)).collect();
    roots.sort_unstable();
    roots.dedup();
    Some(Unshared { pairs: pairs.len(), at, parts: roots.len() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Cell;
    use crate::space::{Body, CellBlock, Mapping, Mesh};

    /// Two rows of `n` squares side by side that share the nodes of the middle line below `shared` only.
    fn halves(n: usize, shared: usize, size: f64) -> MeshCells<2> {
        let mut cells = MeshCells { points: Vec::new(), blocks: Vec::new(), tags: Vec::new() };
        for side in 0..2 {
            for j in 0..=n {
                for i in 0..=n {
                    cells.points.push(Vector::<2>::new((i + side * n) as f64 * size, j as f64 * size));
                }
            }
        }
        let node = |side: usize, i: usize, j: usize| {
            if side == 1 && i == 0 && j < shared { j * (n + 1) + n } else { side * (n + 1) * (n + 1) + j * (n + 1) + i }
        };
        let mut nodes = Vec::new();
        for side in 0..2 {
            for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
                nodes.extend([node(side, i, j), node(side, i + 1, j), node(side, i, j + 1), node(side, i + 1, j + 1)]);
            }
        }
        cells.blocks.push(CellBlock { cell: Cell::Tensor, order: 1, nodes });
        cells
    }

    #[test]
    fn points_that_coincide_and_parts_are_counted() {
        for size in [1.0, 1e-6, 1e7] {
            for n in [2, 5] {
                let apart = unshared_points(&halves(n, 0, size)).unwrap();
                assert_eq!((apart.pairs, apart.parts), (n + 1, 2));
                assert!((apart.at - Vector::<2>::new(n as f64 * size, 0.0)).norm() < 1e-9 * size);
                let slit = unshared_points(&halves(n, 2, size)).unwrap();
                assert_eq!((slit.pairs, slit.parts), (n - 1, 1));
                assert!(unshared_points(&halves(n, n + 1, size)).is_none());
                for (shared, parts) in [(0, 2), (2, 1), (n + 1, 1)] {
                    let mesh = Mesh::<1, 2>::from_cells(&halves(n, shared, size), 2, Mapping::Isoparametric).unwrap();
                    let found = Connected::of(&**mesh.space());
                    assert_eq!(found.count(), parts, "{n} {shared}");
                    assert_eq!(found.of_element(0), 0);
                    assert_eq!(found.of_element(2 * n * n - 1), parts - 1);
                }
            }
        }
    }
}
