//! Lagrange meshes of cells as stored in mesh files.

use super::curve;
use super::mesh::{FacetTables, MeshPoints};
use super::mesh_error::place;
use super::mesh_facets::Facets;
use super::mesh_trace::{FacetMap, FacetSides};
use super::{FunctionSpace, InvertedElement, MAX_DEGREE_SIMPLEX, MAX_DEGREE_TENSOR, Mapping, Mesh, MeshCells, MeshError, Space, quality};
use crate::basis::{Basis, Cell, Order, ShapeTable, Topology, Unstructured, corner_places, lagrange_nodes, lattice, simplex_nodes};
use crate::geometry::{ControlPoints, cell};
use crate::linalg::{Matrix, Vector, determinant};
use crate::parallel;
use std::sync::Arc;

/// Largest geometry order of cells.
pub const MAX_ORDER: usize = 4;
/// Nodes of neighbours on a common facet are one point if they are this near, as a share of the cell.
const SAME_NODE: f64 = 1e-8;
/// Nodes this near in the reference cell coincide.
const SAME_PLACE: f64 = 1e-12;

impl<const S: usize, const N: usize> Mesh<S, N> {
    /// [`from_cells`](Self::from_cells), compiled where it is called.
    pub(super) fn made_from_cells(cells: &MeshCells<N>, degree: usize, mapping: Mapping) -> Result<Self, MeshError> {
        const { assert!(S + 1 == N && (N == 2 || N == 3), "a mesh in the plane or in space has sides of one dimension less") };
        let raw = RawCells::new(cells, degree)?;
        let order = match mapping {
            Mapping::Isoparametric => degree,
            Mapping::Exact => raw.kinds.iter().map(|k| k.1).max().unwrap_or(1),
        };
        let nodes = NodesOfKinds::new(&raw.kinds, order);
        let flipped = nodes.flipped(&raw);
        let topology = Arc::new(raw.topology(&flipped));
        let along = curve::along(&raw.middles());
        let map = Unstructured::<N>::lagrange_along(order, topology.clone(), &along);
        let points = nodes.gathered(&raw, &flipped, &map)?;
        let vertices: Vec<_> = map.at_vertices().into_iter().map(|i| points[i]).collect();
        let facets = Facets::new(&topology, &vertices).map_err(|e| nodes.blamed(e, &raw, &flipped))?;
        let named_facets = facets.named(&cells.tags, &raw.vertex_of_point(&flipped, &topology))?;

        let isoparametric = Arc::new(ControlPoints { basis: map.clone(), points });
        let (space, basis): (Arc<dyn Space<N, N>>, _) = if order == degree {
            (isoparametric.clone(), map)
        } else {
            let basis = Unstructured::lagrange_along(degree, topology.clone(), &along);
            (Arc::new(FunctionSpace { basis: basis.clone(), geometry: isoparametric.clone() }), basis)
        };
        let named = MeshPoints { function: raw.functions_at_points(&flipped, &basis, degree), points: cells.points.clone() };
        let quality = quality(&*space)?;
        let sides = FacetTables::Facets(FacetSides { basis, map: FacetMap::Nodes(isoparametric), named: named_facets });
        Ok(Mesh { grid: None, space, sides, quality, named, exact: false })
    }
}

/// The cells of all blocks, checked.
struct RawCells<'a, const N: usize> {
    cells: &'a MeshCells<N>,
    /// (shape, order) without repetition.
    kinds: Vec<(Cell, usize)>,
    /// Per cell: its kind, and its block and first node there.
    list: Vec<(usize, usize, usize)>,
    /// Per kind: nodes per cell, positions of the corners, positions of the nodes of the mirrored cell.
    local: Vec<(usize, Vec<usize>, Vec<usize>)>,
}

impl<'a, const N: usize> RawCells<'a, N> {
    fn new(cells: &'a MeshCells<N>, degree: usize) -> Result<Self, MeshError> {
        let mut raw = RawCells { cells, kinds: Vec::new(), list: Vec::new(), local: Vec::new() };
        for (b, block) in cells.blocks.iter().enumerate() {
            if !(1..=MAX_ORDER).contains(&block.order) {
                return Err(MeshError::Order { order: block.order, max: MAX_ORDER });
            }
            let kind = (block.cell, block.order);
            let k = raw.kinds.iter().position(|k| *k == kind).unwrap_or_else(|| {
                raw.kinds.push(kind);
                let list = lattice::<N>(kind.0, kind.1);
                raw.local.push((list.len(), corner_places::<N>(kind.0, kind.1), mirrored(&list)));
                raw.kinds.len() - 1
            });
            let each = raw.local[k].0;
            if block.nodes.len() % each != 0 {
                return Err(MeshError::Nodes { block: b, nodes: block.nodes.len(), each });
            }
            raw.list.extend((0..block.nodes.len() / each).map(|c| (k, b, c * each)));
        }
        if raw.list.is_empty() {
            return Err(MeshError::Empty { dimension: N });
        }
        for (cell, kind, max) in [(Cell::Tensor, "tensor cells", MAX_DEGREE_TENSOR), (Cell::Simplex, "simplices", MAX_DEGREE_SIMPLEX)] {
            if raw.list.iter().any(|l| raw.kinds[l.0].0 == cell) && !(1..=max).contains(&degree) {
                return Err(MeshError::Degree { degree, max, kind });
            }
        }
        let points = cells.points.len();
        for e in 0..raw.list.len() {
            for &point in raw.nodes(e) {
                let Some(x) = cells.points.get(point) else { return Err(MeshError::NoPoint { cell: e, point, points }) };
                if !x.iter().all(|v| v.is_finite()) {
                    return Err(MeshError::NotFinite { point });
                }
            }
            let mut corners: Vec<usize> = raw.corners(e, false).collect();
            corners.sort_unstable();
            if let Some(w) = corners.windows(2).find(|w| w[0] == w[1]) {
                return Err(MeshError::Collapsed { cell: e, point: w[0] });
            }
        }
        Ok(raw)
    }

    fn nodes(&self, e: usize) -> &'a [usize] {
        let (kind, block, first) = self.list[e];
        &self.cells.blocks[block].nodes[first..first + self.local[kind].0]
    }

    /// The point at position `a` of the lattice of cell `e`, mirrored if `flip` is set.
    fn node(&self, e: usize, flip: bool, a: usize) -> usize {
        self.nodes(e)[if flip { self.local[self.list[e].0].2[a] } else { a }]
    }

    fn corners(&self, e: usize, flip: bool) -> impl Iterator<Item = usize> + '_ {
        self.local[self.list[e].0].1.iter().map(move |&a| self.node(e, flip, a))
    }

    /// The mean of the corners of every cell.
    fn middles(&self) -> Vec<Vector<N>> {
        let sum = |e: usize| self.corners(e, false).fold((Vector::zeros(), 0.0), |(s, n), p| (s + self.cells.points[p], n + 1.0));
        (0..self.list.len()).map(sum).map(|(s, n)| s / n).collect()
    }

    /// Builds the topology; vertices are numbered from zero, in the order of their first cells.
    fn topology(&self, flipped: &[bool]) -> Topology<N> {
        let kinds: Vec<Cell> = self.list.iter().map(|l| self.kinds[l.0].0).collect();
        let points: Vec<usize> = (0..self.list.len()).flat_map(|e| self.corners(e, flipped[e])).collect();
        let (mut vertex, mut next) = (vec![usize::MAX; self.cells.points.len()], 0);
        let corners = points.iter().map(|&p| {
            if vertex[p] == usize::MAX {
                vertex[p] = next;
                next += 1;
            }
            vertex[p]
        });
        Topology::new(kinds, corners.collect())
    }

    /// The vertex at every point, [`usize::MAX`] where there is none.
    fn vertex_of_point(&self, flipped: &[bool], topology: &Topology<N>) -> Vec<usize> {
        let mut vertex = vec![usize::MAX; self.cells.points.len()];
        for e in 0..self.list.len() {
            self.corners(e, flipped[e]).zip(topology.vertices(e)).for_each(|(p, &v)| vertex[p] = v);
        }
        vertex
    }

    /// The function whose node is at a point, [`usize::MAX`] where there is none.
    fn functions_at_points(&self, flipped: &[bool], basis: &Unstructured<N>, degree: usize) -> Vec<usize> {
        let pairs: Vec<Vec<(usize, usize)>> = self
            .kinds
            .iter()
            .map(|&(cell, order)| {
                let nodes = nodes::<N>(cell, degree);
                let near = |at: &Vector<N>| nodes.iter().position(|x| (x - at).amax() < SAME_PLACE);
                let places = lattice::<N>(cell, order).into_iter().map(|i| Vector::<N>::from_fn(|k, _| i[k] as f64 / order as f64));
                places.enumerate().filter_map(|(a, at)| near(&at).map(|b| (a, b))).collect()
            })
            .collect();
        let mut function = vec![usize::MAX; self.cells.points.len()];
        for e in 0..self.list.len() {
            let functions = basis.functions(e);
            pairs[self.list[e].0].iter().for_each(|&(a, b)| function[self.node(e, flipped[e], a)] = functions[b]);
        }
        function
    }
}

/// The Lagrange nodes of a cell in the order of its lattice.
pub(super) fn nodes<const N: usize>(cell: Cell, degree: usize) -> Vec<Vector<N>> {
    match cell {
        Cell::Simplex => simplex_nodes(degree),
        Cell::Tensor => {
            let line = lagrange_nodes::<f64>(degree);
            lattice::<N>(cell, degree).into_iter().map(|i| Vector::from_fn(|k, _| line[i[k]])).collect()
        }
    }
}

/// Position in `list` of every index with its first two entries exchanged.
fn mirrored<const N: usize>(list: &[[usize; N]]) -> Vec<usize> {
    let swapped = |mut i: [usize; N]| {
        i.swap(0, 1);
        i
    };
    list.iter().map(|&i| list.iter().position(|j| *j == swapped(i)).expect("a lattice is symmetric")).collect()
}

/// The Lagrange polynomials of the equispaced nodes of a cell at `xi`.
fn equispaced<const N: usize>(cell: Cell, order: usize, xi: &Vector<N>) -> Vec<f64> {
    let n = order as f64;
    let line = |i: usize, x: f64| (0..=order).filter(|&m| m != i).map(|m| (n * x - m as f64) / (i as f64 - m as f64)).product::<f64>();
    // prod_(m < i) (n l - m) / (m + 1) of a barycentric coordinate l
    let share = |i: usize, l: f64| (0..i).map(|m| (n * l - m as f64) / (m as f64 + 1.0)).product::<f64>();
    let value = |i: [usize; N]| match cell {
        Cell::Tensor => (0..N).map(|k| line(i[k], xi[k])).product(),
        Cell::Simplex => share(order - i.iter().sum::<usize>(), 1.0 - xi.sum()) * (0..N).map(|k| share(i[k], xi[k])).product::<f64>(),
    };
    lattice::<N>(cell, order).into_iter().map(value).collect()
}

/// Interpolation of the nodes of a space from those of the cells, per kind of cell.
struct NodesOfKinds<const N: usize> {
    /// Per kind: weights of the cell's points in every node of the space.
    shares: Vec<Vec<Vec<f64>>>,
    /// Per kind: gradients at the cell's centre of the functions of the space's nodes.
    slopes: Vec<Vec<Vector<N>>>,
}

impl<const N: usize> NodesOfKinds<N> {
    fn new(kinds: &[(Cell, usize)], degree: usize) -> Self {
        let shares = |&(cell, order): &(Cell, usize)| nodes::<N>(cell, degree).iter().map(|xi| equispaced(cell, order, xi)).collect();
        let slopes = |&(kind, _): &(Cell, usize)| {
            let corners = (0..cell::corners::<N, f64>(kind).len()).collect();
            let one = Unstructured::<N>::lagrange(degree, Arc::new(Topology::new(vec![kind], corners)));
            let mut table = ShapeTable::new();
            one.tabulate(0, &[cell::center(kind)], Order::Gradients, &mut table);
            // the functions of one cell are not numbered along its lattice, but their table is
            table.grads(0).to_vec()
        };
        Self { shares: kinds.iter().map(shares).collect(), slopes: kinds.iter().map(slopes).collect() }
    }

    /// Computes the nodes of a cell in the order of its lattice.
    fn of(&self, raw: &RawCells<'_, N>, e: usize, flip: bool, x: &mut Vec<Vector<N>>) {
        x.clear();
        x.extend(self.shares[raw.list[e].0].iter().map(|shares| {
            let terms = shares.iter().enumerate().filter(|(_, s)| **s != 0.0);
            terms.fold(Vector::zeros(), |sum, (a, s)| sum + raw.cells.points[raw.node(e, flip, a)] * *s)
        }));
    }

    /// Jacobian determinant at the centre of a cell as it is listed.
    fn jacobian(&self, raw: &RawCells<'_, N>, e: usize, x: &mut Vec<Vector<N>>) -> f64 {
        self.of(raw, e, false, x);
        let slopes = &self.slopes[raw.list[e].0];
        determinant(&x.iter().zip(slopes).fold(Matrix::<N, N>::zeros(), |j, (x, g)| j + x * g.transpose()))
    }

    /// Flags the cells that are left-handed at their centre.
    fn flipped(&self, raw: &RawCells<'_, N>) -> Vec<bool> {
        parallel::map_init(raw.list.len(), Vec::new, |x, e| self.jacobian(raw, e, x) < 0.0)
    }

    /// Turns [`MeshError::Folded`] of cells of different handedness into an inverted element: the one unlike most cells.
    fn blamed(&self, error: MeshError, raw: &RawCells<'_, N>, flipped: &[bool]) -> MeshError {
        let MeshError::Folded { cells, at } = error else { return error };
        if flipped[cells[0]] == flipped[cells[1]] {
            return error;
        }
        let most = 2 * flipped.iter().filter(|f| **f).count() > flipped.len();
        let element = if flipped[cells[0]] == most { cells[1] } else { cells[0] };
        let least_jacobian = -self.jacobian(raw, element, &mut Vec::new()).abs();
        InvertedElement { element, least_jacobian, at }.into()
    }

    /// Gathers the nodes of all functions; an error if neighbours do not agree.
    fn gathered(&self, raw: &RawCells<'_, N>, flipped: &[bool], map: &Unstructured<N>) -> Result<Vec<Vector<N>>, MeshError> {
        let mut points: Vec<Option<Vector<N>>> = vec![None; map.num_functions()];
        let mut x = Vec::new();
        for (cell, &flip) in flipped.iter().enumerate() {
            self.of(raw, cell, flip, &mut x);
            let size = crate::geometry::Bounds::around(&x).map_or(0.0, |b| b.diagonal());
            for (&i, x) in map.functions(cell).iter().zip(&x) {
                let first = *points[i].get_or_insert(*x);
                let distance = (first - x).norm();
                if distance > SAME_NODE * size {
                    return Err(MeshError::Torn { cell, distance, at: place(x) });
                }
            }
        }
        Ok(points.into_iter().map(|x| x.expect("every function has a cell")).collect())
    }
}
