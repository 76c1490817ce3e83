//! Halving of every cell of a mesh, curved ones without any change of their shape.
//!
//! A line becomes 2, a triangle or quadrilateral 4, a tetrahedron or hexahedron 8 cells of the same order; their nodes lie where the
//! parent's map takes the points (i, j, k) / (2 order). A tetrahedron gives its four corners and an octahedron, which is cut along the
//! shortest of its three diagonals (the first of equal ones), so that shapes do not degenerate when this is repeated: Zhang, Houston
//! J. Math. 21 (1995) 541-556.

use std::collections::HashMap;

use super::cells::{CellBlock, FacetTag, MeshCells};
use crate::basis::Cell;
use crate::linalg::Vector;

/// Key of a node on the boundary of a cell, equal in all cells that share it: corners of the smallest facet, edge or corner that holds
/// it, and its integer share of each, sorted. Unused entries are `usize::MAX`.
type Key = [(usize, usize); 4];

/// A point of a reference cell in steps of its lattice.
type Steps = [usize; 3];

/// Lattice points of a cell of dimension `n` with `m` steps, the first axis fastest.
pub(crate) fn lattice(cell: Cell, n: usize, m: usize) -> Vec<Steps> {
    let most = |k: usize| if k < n { m } else { 0 };
    let mut out = Vec::new();
    for k in 0..=most(2) {
        for j in 0..=most(1) {
            for i in 0..=most(0) {
                if cell != Cell::Simplex || i + j + k <= m {
                    out.push([i, j, k]);
                }
            }
        }
    }
    out
}

/// Number of points of a cell of dimension `n`.
pub fn nodes_per_cell(cell: Cell, n: usize, order: usize) -> usize {
    match cell {
        Cell::Tensor => (order + 1).pow(n as u32),
        Cell::Simplex => (1..=n).fold(1, |m, k| m * (order + k) / k),
    }
}

/// Corners of the reference cell in steps of one.
pub(crate) fn corners(cell: Cell, n: usize) -> Vec<Steps> {
    lattice(cell, n, 1)
}

/// Corners of every facet of the reference cell as numbers of its corners, which follow the lattice, first axis fastest.
pub fn facets(cell: Cell, n: usize) -> Vec<Vec<usize>> {
    let all = corners(cell, n);
    let on = |keep: &dyn Fn(&Steps) -> bool| -> Vec<usize> { (0..all.len()).filter(|c| keep(&all[*c])).collect() };
    let mut out = Vec::new();
    for axis in 0..n {
        out.push(on(&|x| x[axis] == 0));
        if cell != Cell::Simplex {
            out.push(on(&|x| x[axis] == 1));
        }
    }
    if cell == Cell::Simplex {
        out.push(on(&|x| x.iter().sum::<usize>() == 1));
    }
    out
}

/// Corners of the edges of a cell in space, and its single corners, as numbers of its corners.
fn edges_and_corners(cell: Cell, n: usize) -> Vec<Vec<usize>> {
    let all = corners(cell, n);
    let is_edge = |a: usize, b: usize| cell == Cell::Simplex || (0..n).filter(|&k| all[a][k] != all[b][k]).count() == 1;
    let edges = (0..all.len()).flat_map(|b| (0..b).map(move |a| [a, b])).filter(|&[a, b]| n == 3 && is_edge(a, b));
    edges.map(|edge| edge.to_vec()).chain((0..all.len()).map(|c| vec![c])).collect()
}

/// Key of a facet, independent of the order of its corners: sorted, padded with `usize::MAX`.
pub fn facet_key(corners: impl Iterator<Item = usize>) -> [usize; 4] {
    let mut key = [usize::MAX; 4];
    for (place, corner) in key.iter_mut().zip(corners) {
        *place = corner;
    }
    key.sort_unstable();
    key
}

/// Share of every corner in the point `x` of a lattice of `m` steps: barycentric or multilinear, times m^(dimension of the cell).
fn shares(cell: Cell, n: usize, m: usize, x: &Steps) -> Vec<usize> {
    corners(cell, n)
        .iter()
        .map(|c| match cell {
            Cell::Simplex => match (0..n).find(|k| c[*k] == 1) {
                Some(k) => x[k],
                None => m - x.iter().sum::<usize>(),
            },
            Cell::Tensor => (0..n).map(|k| if c[k] == 1 { x[k] } else { m - x[k] }).product(),
        })
        .collect()
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Key of a lattice point; `None` inside the cell, where more corners than those of a facet have a share.
fn key(shares: &[usize], corners: &[usize]) -> Option<Key> {
    let mut key = [(usize::MAX, 0); 4];
    let mut count = 0;
    let common = shares.iter().fold(0, |g, s| gcd(g, *s));
    for (share, corner) in shares.iter().zip(corners) {
        if *share > 0 {
            *key.get_mut(count)? = (*corner, share / common);
            count += 1;
        }
    }
    key.sort_unstable();
    (count < corners.len()).then_some(key)
}

/// Values at the lattice points of m = 2 `order` steps of the Lagrange functions on the points of `order` steps.
fn interpolation(cell: Cell, n: usize, order: usize) -> Vec<Vec<(usize, f64)>> {
    let nodes = lattice(cell, n, order);
    // prod_{q < i} (s - q) / (i - q): one at s = i steps, zero at those before
    let below = |i: usize, s: f64| (0..i).map(|q| (s - q as f64) / (i as f64 - q as f64)).product::<f64>();
    let line = |i: usize, s: f64| below(i, s) * (i + 1..=order).map(|q| (s - q as f64) / (i as f64 - q as f64)).product::<f64>();
    lattice(cell, n, 2 * order)
        .iter()
        .map(|x| {
            let s: Vec<f64> = x.iter().map(|v| *v as f64 / 2.0).collect();
            let value = |a: &Steps| match cell {
                Cell::Simplex => {
                    let rest = (order - a.iter().sum::<usize>(), order as f64 - s.iter().sum::<f64>());
                    (0..n).map(|k| below(a[k], s[k])).product::<f64>() * below(rest.0, rest.1)
                }
                Cell::Tensor => (0..n).map(|k| line(a[k], s[k])).product(),
            };
            nodes.iter().enumerate().map(|(i, a)| (i, value(a))).filter(|(_, v)| *v != 0.0).collect()
        })
        .collect()
}

/// Corners of the children in steps of two per edge of the parent; `diagonal` is the one the octahedron is cut along.
fn children(cell: Cell, n: usize, diagonal: usize) -> Vec<Vec<Steps>> {
    let add = |a: &Steps, b: &Steps| -> Steps { std::array::from_fn(|k| a[k] + b[k]) };
    let all = corners(cell, n);
    let mut out: Vec<Vec<Steps>> = all.iter().map(|c| all.iter().map(|d| add(c, d)).collect()).collect();
    match (cell, n) {
        (Cell::Simplex, 2) => out.push([[1, 1, 0], [0, 1, 0], [1, 0, 0]].to_vec()),
        (Cell::Simplex, 3) => {
            let [a, b] = DIAGONALS[diagonal];
            let ring: Vec<Steps> = around(diagonal);
            for k in 0..4 {
                let mut child = vec![a, b, ring[k], ring[(k + 1) % 4]];
                if determinant(&child) < 0 {
                    child.swap(2, 3);
                }
                out.push(child);
            }
        }
        _ => {}
    }
    out
}

/// Diagonals of the octahedron between the midpoints of opposite edges.
const DIAGONALS: [[Steps; 2]; 3] = [[[1, 0, 0], [0, 1, 1]], [[0, 1, 0], [1, 0, 1]], [[0, 0, 1], [1, 1, 0]]];

// the four other corners of the octahedron in cyclic order: opposite ones are the ends of the other diagonals
fn around(diagonal: usize) -> Vec<Steps> {
    let [p, q] = [DIAGONALS[(diagonal + 1) % 3], DIAGONALS[(diagonal + 2) % 3]];
    vec![p[0], q[0], p[1], q[1]]
}

fn determinant(child: &[Steps]) -> i64 {
    let e = |k: usize| -> [i64; 3] { std::array::from_fn(|c| child[k][c] as i64 - child[0][c] as i64) };
    let (a, b, c) = (e(1), e(2), e(3));
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// Halves every cell of the mesh in every direction; the 2^N children of a cell follow each other in its place.
///
/// Points of the mesh keep their numbers, new ones follow. Facets and edges of a tag are halved with the cells; those of no cell are left out.
/// Linear in the number of cells.
pub fn refine_cells<const N: usize>(cells: &MeshCells<N>) -> MeshCells<N> {
    let mut points = cells.points.clone();
    let mut known: HashMap<Key, usize> = HashMap::new();
    for block in &cells.blocks {
        register(block, N, &mut known);
    }
    let mut wanted: HashMap<[usize; 4], Vec<[usize; 4]>> = HashMap::new();
    for facet in cells.tags.iter().flat_map(|t| &t.corners) {
        wanted.entry(facet_key(facet.iter().copied())).or_default();
    }
    let blocks = cells.blocks.iter().map(|b| refined(b, &mut points, &mut known, &mut wanted)).collect();
    let halves = |f: &[usize; 4]| wanted.get(&facet_key(f.iter().copied())).map_or(&[][..], Vec::as_slice);
    let tag = |t: &FacetTag| FacetTag { name: t.name.clone(), corners: t.corners.iter().flat_map(|f| halves(f).iter().copied()).collect() };
    MeshCells { points, blocks, tags: cells.tags.iter().map(tag).collect() }
}

// registers the nodes given on facets and edges; a neighbour of another order has further nodes in between
fn register(block: &CellBlock, n: usize, known: &mut HashMap<Key, usize>) {
    if block.order == 1 {
        return;
    }
    let nodes = lattice(block.cell, n, block.order);
    let at = corner_places(block.cell, n, block.order);
    let all: Vec<Vec<usize>> = nodes.iter().map(|x| shares(block.cell, n, block.order, x)).collect();
    for cell in block.nodes.chunks_exact(nodes_per_cell(block.cell, n, block.order)) {
        let corners: Vec<usize> = at.iter().map(|c| cell[*c]).collect();
        for (share, node) in all.iter().zip(cell) {
            if share.iter().filter(|s| **s > 0).count() > 1
                && let Some(key) = key(share, &corners)
            {
                known.insert(key, *node);
            }
        }
    }
}

/// Positions of the corners among the nodes of a cell.
pub fn corner_places(cell: Cell, n: usize, order: usize) -> Vec<usize> {
    let nodes = lattice(cell, n, order);
    let place = |c: &Steps| nodes.iter().position(|x| (0..3).all(|k| x[k] == c[k] * order)).expect("a corner is a node");
    corners(cell, n).iter().map(place).collect()
}

fn refined<const N: usize>(
    block: &CellBlock,
    points: &mut Vec<Vector<N>>,
    known: &mut HashMap<Key, usize>,
    wanted: &mut HashMap<[usize; 4], Vec<[usize; 4]>>,
) -> CellBlock {
    let (cell, order) = (block.cell, block.order);
    let (coarse, fine) = (lattice(cell, N, order), lattice(cell, N, 2 * order));
    let place: HashMap<Steps, usize> = fine.iter().enumerate().map(|(i, x)| (*x, i)).collect();
    let at = corner_places(cell, N, order);
    let interpolation = interpolation(cell, N, order);
    let all: Vec<Vec<usize>> = fine.iter().map(|x| shares(cell, N, 2 * order, x)).collect();
    let even: Vec<Option<usize>> = fine
        .iter()
        .map(|x| if x.iter().all(|v| v % 2 == 0) { coarse.iter().position(|c| (0..3).all(|k| 2 * c[k] == x[k])) } else { None })
        .collect();
    // per choice of the diagonal: nodes of every child, and the children of every facet
    let kinds = if cell == Cell::Simplex && N == 3 { 3 } else { 1 };
    let nodes: Vec<Vec<usize>> = (0..kinds).map(|d| child_nodes(cell, N, order, d, &coarse, &place)).collect();
    let mut facets = facets(cell, N);
    if wanted.keys().any(|key| key[N - 1] == usize::MAX) {
        facets.extend(edges_and_corners(cell, N));
    }
    let halves = facet_halves(cell, N, order, &facets, &place);
    let mut out = Vec::with_capacity(block.nodes.len() << N);
    let mut ids = vec![0; fine.len()];
    for parent in block.nodes.chunks_exact(coarse.len()) {
        let corners: Vec<usize> = at.iter().map(|c| parent[*c]).collect();
        for (i, id) in ids.iter_mut().enumerate() {
            if let Some(c) = even[i] {
                *id = parent[c];
                continue;
            }
            let mut new = || {
                points.push(interpolation[i].iter().map(|(k, v)| points[parent[*k]] * *v).sum());
                points.len() - 1
            };
            *id = match key(&all[i], &corners) {
                Some(key) => *known.entry(key).or_insert_with(new),
                None => new(),
            };
        }
        let diagonal = if kinds == 3 { shortest(points, &ids, &place, order) } else { 0 };
        out.extend(nodes[diagonal].iter().map(|k| ids[*k]));
        for (facet, halves) in facets.iter().zip(&halves) {
            // the first of two cells that share a facet determines the cuts of the facet; the other cuts it in the same way
            if let Some(list) = wanted.get_mut(&facet_key(facet.iter().map(|c| corners[*c])))
                && list.is_empty()
            {
                list.extend(halves.iter().map(|h| h.map(|k| if k == usize::MAX { k } else { ids[k] })));
            }
        }
    }
    CellBlock { cell, order, nodes: out }
}

// nodes of all children as indices in the fine lattice
fn child_nodes(cell: Cell, n: usize, order: usize, diagonal: usize, coarse: &[Steps], place: &HashMap<Steps, usize>) -> Vec<usize> {
    let mut out = Vec::new();
    for child in children(cell, n, diagonal) {
        // corners(): the first is the origin, those with a single one are the ends of the axes
        let axis =
            |k: usize| &child[corners(cell, n).iter().position(|c| c[k] == 1 && c.iter().sum::<usize>() == 1).expect("an axis has an end")];
        for x in coarse {
            let steps: Steps = std::array::from_fn(|c| {
                let origin = child[0][c] as i64;
                let along = (0..n).map(|k| x[k] as i64 * (axis(k)[c] as i64 - origin)).sum::<i64>();
                (order as i64 * origin + along) as usize
            });
            out.push(place[&steps]);
        }
    }
    out
}

// corners of the children of facets, edges and corners as indices in the fine lattice
fn facet_halves(cell: Cell, n: usize, order: usize, facets: &[Vec<usize>], place: &HashMap<Steps, usize>) -> Vec<Vec<[usize; 4]>> {
    let all = corners(cell, n);
    let node = |x: Steps| place[&x.map(|v| v * order)];
    facets
        .iter()
        .map(|facet| {
            let c: Vec<Steps> = facet.iter().map(|k| all[*k]).collect();
            let mid = |a: usize, b: usize| node(std::array::from_fn(|k| c[a][k] + c[b][k]));
            let end = |a: usize| mid(a, a);
            let none = usize::MAX;
            match c.len() {
                1 => vec![[end(0), none, none, none]],
                2 => (0..2).map(|a| [end(a), mid(0, 1), none, none]).collect(),
                3 => {
                    let mut out: Vec<[usize; 4]> = (0..3).map(|a| [end(a), mid(a, (a + 1) % 3), mid(a, (a + 2) % 3), none]).collect();
                    out.push([mid(0, 1), mid(1, 2), mid(2, 0), none]);
                    out
                }
                // corners of a square, the first axis fastest: 0 and 3 are opposite, as are 1 and 2
                _ => (0..4).map(|a| [end(a), mid(a, a ^ 1), mid(a, a ^ 2), mid(0, 3)]).collect(),
            }
        })
        .collect()
}

fn shortest<const N: usize>(points: &[Vector<N>], ids: &[usize], place: &HashMap<Steps, usize>, order: usize) -> usize {
    let point = |x: &Steps| points[ids[place[&x.map(|v| v * order)]]];
    let length = |d: usize| (point(&DIAGONALS[d][0]) - point(&DIAGONALS[d][1])).norm();
    let mut best = 0;
    for d in 1..3 {
        // equal lengths up to round-off choose the first
        if length(d) < length(best) * (1.0 - SAME_LENGTH) {
            best = d;
        }
    }
    best
}

/// Diagonals whose lengths differ by less than this share are equal.
const SAME_LENGTH: f64 = 1e-9;

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// The lattice cell of `order` under a smooth map.
    fn mesh<const N: usize>(cell: Cell, order: usize, map: impl Fn([f64; 3]) -> Vector<N>) -> MeshCells<N> {
        let nodes = lattice(cell, N, order);
        let points = nodes.iter().map(|x| map(x.map(|v| v as f64 / order as f64))).collect();
        let at = corner_places(cell, N, order);
        let corners = facets(cell, N).iter().map(|f| facet_key(f.iter().map(|c| at[*c]))).collect();
        MeshCells {
            points,
            blocks: vec![CellBlock { cell, order, nodes: (0..nodes.len()).collect() }],
            tags: vec![FacetTag { name: "all".into(), corners }],
        }
    }

    // facets of one cell only, as keys
    fn boundary<const N: usize>(cells: &MeshCells<N>) -> Vec<[usize; 4]> {
        let mut all = Vec::new();
        for b in &cells.blocks {
            let at = corner_places(b.cell, N, b.order);
            for cell in b.nodes.chunks_exact(lattice(b.cell, N, b.order).len()) {
                all.extend(facets(b.cell, N).iter().map(|f| facet_key(f.iter().map(|c| cell[at[*c]]))));
            }
        }
        all.sort_unstable();
        all.chunk_by(|a, b| a == b).filter(|c| c.len() == 1).map(|c| c[0]).collect()
    }

    #[test]
    fn children_fill_the_parent_and_share_their_facets_for_every_shape_and_order() {
        for cell in [Cell::Tensor, Cell::Simplex] {
            for order in 1..=4 {
                let plane = refine_cells(&refine_cells(&mesh::<2>(cell, order, |x| Vector::<2>::new(x[0], x[1]))));
                let (sides, per) = if cell == Cell::Tensor { (4, 1.0) } else { (3, 0.5) };
                assert_eq!(boundary(&plane).len(), sides * 4);
                assert_eq!(plane.tags[0].corners.len(), sides * 4);
                assert!((volume::<2>(&plane) - per).abs() < 1e-13);
                let solid = refine_cells(&refine_cells(&mesh::<3>(cell, order, |x| Vector::<3>::new(x[0], x[1], x[2]))));
                let (sides, per) = if cell == Cell::Tensor { (6, 1.0) } else { (4, 1.0 / 6.0) };
                assert_eq!(boundary(&solid).len(), sides * 16);
                let mut tagged: Vec<_> = solid.tags[0].corners.iter().map(|f| facet_key(f.iter().copied())).collect();
                tagged.sort_unstable();
                assert_eq!(tagged, boundary(&solid), "{cell:?} of order {order}");
                assert!((volume::<3>(&solid) - per).abs() < 1e-13);
            }
        }
    }

    // sum of the children's determinants, each of which must be positive
    fn volume<const N: usize>(cells: &MeshCells<N>) -> f64 {
        let mut sum = 0.0;
        for b in &cells.blocks {
            let at = corner_places(b.cell, N, b.order);
            for cell in b.nodes.chunks_exact(lattice(b.cell, N, b.order).len()) {
                let ends: Vec<usize> =
                    (0..N).map(|k| corners(b.cell, N).iter().position(|c| c[k] == 1 && c.iter().sum::<usize>() == 1).unwrap()).collect();
                let jacobian = nalgebra::DMatrix::from_fn(N, N, |i, k| cells.points[cell[at[ends[k]]]][i] - cells.points[cell[at[0]]][i]);
                let det = jacobian.determinant();
                assert!(det > 0.0);
                sum += if b.cell == Cell::Simplex { det / (1..=N).product::<usize>() as f64 } else { det };
            }
        }
        sum
    }

    #[test]
    fn curved_children_lie_on_the_map_of_their_parent() {
        // polynomials of total degree `order`: every new node is on the graph of the same polynomial
        for order in 1..=4i32 {
            for cell in [Cell::Tensor, Cell::Simplex] {
                let curve = |x: f64, y: f64| 0.3 * (x + 0.5 * y).powi(order) - 0.1 * x;
                let fine = refine_cells(&mesh::<3>(cell, order as usize, |x| Vector::<3>::new(x[0], x[1], x[2] + curve(x[0], x[1]))));
                let block = &fine.blocks[0];
                let nodes = lattice(cell, 3, order as usize);
                // the first child is the corner at the origin, halved
                for (x, node) in nodes.iter().zip(&block.nodes) {
                    let [a, b, c] = x.map(|v| v as f64 / (2 * order) as f64);
                    let expected = Vector::<3>::new(a, b, c + curve(a, b));
                    assert!((fine.points[*node] - expected).norm() < 1e-14, "{cell:?} {order}");
                }
            }
        }
    }

    #[test]
    fn a_quadratic_and_a_linear_neighbour_share_the_middle_of_their_edge() {
        // a triangle of six nodes beside a square of four: the edge from 1 to 2 with middle 5
        let points = [[0., 0.], [1., 0.], [1., 1.], [0., 1.], [2., 0.], [1., 0.5], [1.5, 0.], [1.5, 0.5]];
        let cells = MeshCells::<2> {
            points: points.iter().map(|p| Vector::from(*p)).collect(),
            blocks: vec![
                CellBlock { cell: Cell::Tensor, order: 1, nodes: vec![0, 1, 3, 2] },
                CellBlock { cell: Cell::Simplex, order: 2, nodes: vec![1, 6, 4, 5, 7, 2] },
            ],
            tags: vec![FacetTag { name: "joint".into(), corners: vec![[2, 1, usize::MAX, usize::MAX]] }],
        };
        let fine = refine_cells(&cells);
        // 2 + 2 + 1 edges of the square's boundary without the joint, 2 edges of the triangle: each halved
        assert_eq!(boundary(&fine).len(), 2 * 3 + 2 * 2);
        assert!(fine.tags[0].corners.iter().all(|f| f.contains(&5)) && fine.tags[0].corners.len() == 2);
    }
}
