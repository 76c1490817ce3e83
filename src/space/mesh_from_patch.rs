//! The Lagrange mesh of a patch.

use super::grid::{ElementGrid, Merged, SideOf, join, merge, on_side, side_axes, split};
use super::mesh::{FacetTables, MeshPoints, MeshSide};
use super::mesh_tetrahedra::tetrahedra;
use super::{FunctionSpace, MAX_DEGREE_SIMPLEX, MAX_DEGREE_TENSOR, Mapping, Mesh, PatchSpec, Space, SpecError, quality};
use crate::basis::{
    Basis, Cell, LagrangeLine, LagrangeSimplex, Order, TensorProduct, lagrange_nodes, simplex_lattice, simplex_nodes, simplex_numbering,
};
use crate::geometry::{ControlPoints, Embedded, Embedding, Geometry, MapTable};
use crate::linalg::{Matrix, Vector};
use std::collections::HashMap;
use std::sync::Arc;

/// A node is on a collapsed edge if it is this near to it, in the cell's coordinates.
const ON_EDGE: f64 = 1e-12;

impl<const S: usize, const N: usize> Mesh<S, N> {
    /// [`from_patch`](Self::from_patch), compiled where it is called.
    pub(super) fn made_from_patch(spec: &PatchSpec<N>) -> Result<Self, SpecError> {
        const { assert!(S + 1 == N, "a mesh has sides of one dimension less") };
        match spec.cells {
            Cell::Tensor => tensor(spec),
            Cell::Simplex if N == 2 => simplex(spec),
            Cell::Simplex => tetrahedra(spec),
        }
    }
}

fn lines<const N: usize>(spec: &PatchSpec<N>, grid: &ElementGrid<N>) -> [LagrangeLine<f64>; N] {
    std::array::from_fn(|k| LagrangeLine::with_breakpoints(spec.degree[k], grid.breakpoints[k].clone()))
}

fn tensor<const S: usize, const N: usize>(spec: &PatchSpec<N>) -> Result<Mesh<S, N>, SpecError> {
    spec.check_degree(MAX_DEGREE_TENSOR, "tensor cells")?;
    let grid = ElementGrid::new(&spec.net, &spec.breakpoints)?;
    let lines = lines(spec, &grid);
    let counts = lines.each_ref().map(|l| l.num_functions());
    let product = TensorProduct::new(lines.clone());
    let merged = Merged::new(&counts, &grid.collapsed);
    let nodes = (spec.mapping == Mapping::Isoparametric).then(|| nodes_of(spec, &grid, &product));
    let isoparametric = nodes.clone().map(|points| ControlPoints { basis: product.clone(), points });
    let space: Arc<dyn Space<N, N>> = match isoparametric {
        // one table serves the functions and the map
        Some(space) if merged.is_trivial() => Arc::new(space),
        Some(geometry) => Arc::new(FunctionSpace { basis: merge::<N>(product, &merged.id).0, geometry }),
        None => Arc::new(FunctionSpace { basis: merge::<N>(product, &merged.id).0, geometry: grid.exact.clone() }),
    };
    let quality = quality(&*space)?;
    let sides = SideOf::all(N)
        .into_iter()
        .filter(|s| !grid.is_collapsed(*s))
        .map(|side| {
            let (on, lines) = (on_side(&counts, side), side_axes::<S, N, _>(&lines, side));
            let geometry = side_map(&grid, side, &lines, nodes.as_ref().map(|nodes| on.iter().map(|&i| nodes[i]).collect()));
            let ids = on.into_iter().map(|i| merged.id[i]).collect();
            (side.name(), MeshSide { lines, ids, geometry, facets: grid.facets(side) })
        })
        .collect();
    Ok(Mesh { grid: Some(grid), space, sides: FacetTables::Lines(sides), quality, named: MeshPoints::default(), exact: spec.is_exact() })
}

/// The map of a side: through its `nodes` if it is isoparametric, else the exact one.
fn side_map<const S: usize, const N: usize>(
    grid: &ElementGrid<N>,
    side: SideOf,
    lines: &[LagrangeLine<f64>; S],
    nodes: Option<Vec<Vector<N>>>,
) -> Arc<dyn Geometry<S, N>> {
    match nodes {
        Some(points) => Arc::new(ControlPoints { basis: TensorProduct::new(lines.clone()), points }),
        None => grid.side_map(side),
    }
}

/// The nodes of a tensor mesh on the exact map, one per function.
fn nodes_of<const N: usize>(spec: &PatchSpec<N>, grid: &ElementGrid<N>, basis: &TensorProduct<N, LagrangeLine<f64>>) -> Vec<Vector<N>> {
    let axes: [Vec<f64>; N] = spec.degree.map(lagrange_nodes);
    let counts = axes.each_ref().map(Vec::len);
    let local: Vec<Vector<N>> = (0..counts.iter().product())
        .map(|a| {
            let at = split(&counts, a);
            Vector::from_fn(|k, _| axes[k][at[k]])
        })
        .collect();
    let mut points = vec![Vector::zeros(); basis.num_functions()];
    let (mut ids, mut map) = (Vec::new(), MapTable::new());
    for e in 0..grid.counts().iter().product() {
        basis.active(e, &mut ids);
        grid.exact.map(e, &local, Order::Values, &mut map);
        for (&i, x) in ids.iter().zip(&map.x) {
            points[i] = *x;
        }
    }
    points
}

/// A triangle cut from a cell of the grid.
struct Triangle<const N: usize> {
    cell: usize,
    /// Its vertices in the cell's coordinates.
    vertices: [Vector<N>; 3],
    /// Ids of its vertices; those of a collapsed edge are one in an isoparametric mesh.
    ids: [usize; 3],
    /// Set if the other triangle of the cell was dropped at a collapsed edge: the nodes fan out over the whole cell.
    apex: Option<Fan>,
}

/// Map of a triangle onto a whole cell with a collapsed edge: vertex `apex` lies on that edge, the two others opposite.
struct Fan {
    apex: usize,
    collapsed: SideOf,
    /// Position along the collapsed edge (0 or 1) of the two other vertices.
    ends: [(usize, f64); 2],
}

fn simplex<const S: usize, const N: usize>(spec: &PatchSpec<N>) -> Result<Mesh<S, N>, SpecError> {
    spec.check_degree(MAX_DEGREE_SIMPLEX, "simplices")?;
    let degree = spec.degree[0];
    if spec.degree.iter().any(|&d| d != degree) {
        return Err(SpecError::MixedDegree { degree: spec.degree.to_vec() });
    }
    let grid = ElementGrid::new(&spec.net, &spec.breakpoints)?;
    let exact = spec.mapping == Mapping::Exact;
    let triangles = cut(&grid, exact);
    let corners: Vec<usize> = triangles.iter().flat_map(|t| t.ids).collect();
    let (functions, connectivity) = simplex_numbering::<2>(degree, &corners);
    let basis = LagrangeSimplex::<N, f64>::new(degree, functions, connectivity.clone());
    let nodes = simplex_nodes::<N, f64>(degree);
    let local = nodes.len();

    // positions of the nodes: in the cell, and on the exact map
    let mut points = vec![Vector::<N>::zeros(); functions];
    let mut on_edge: Vec<Option<usize>> = vec![None; functions];
    let mut map = MapTable::new();
    for (t, triangle) in triangles.iter().enumerate() {
        let places: Vec<Vector<N>> = nodes.iter().map(|xi| triangle.place(xi)).collect();
        grid.exact.map(triangle.cell, &places, Order::Values, &mut map);
        let at = split(&grid.counts(), triangle.cell);
        for (a, &i) in connectivity[t * local..(t + 1) * local].iter().enumerate() {
            points[i] = map.x[a];
            for (edge, c) in grid.collapsed.iter().enumerate() {
                let on_cell_row = at[c.side.axis] == c.side.end * (grid.counts()[c.side.axis] - 1);
                if on_cell_row && (places[a][c.side.axis] - c.side.end as f64).abs() <= ON_EDGE {
                    on_edge[i] = Some(edge);
                }
            }
        }
    }

    let nodes = (!exact).then(|| points.clone());
    let (space, id): (Arc<dyn Space<N, N>>, Vec<usize>) = if exact {
        let cells = triangles
            .iter()
            .map(|t| Embedding {
                element: t.cell,
                origin: t.vertices[0],
                axes: Matrix::from_fn(|k, s| (t.vertices[s + 1] - t.vertices[0])[k]),
            })
            .collect();
        let geometry = Embedded::new(grid.exact.clone(), cells, Cell::Simplex);
        let mut first: Vec<Option<usize>> = vec![None; grid.collapsed.len()];
        let same: Vec<usize> = (0..functions).map(|i| on_edge[i].map_or(i, |edge| *first[edge].get_or_insert(i))).collect();
        let (basis, dofs) = merge::<N>(basis, &same);
        let place: HashMap<usize, usize> = dofs.iter().enumerate().map(|(k, &i)| (i, k)).collect();
        let id = same.iter().map(|i| place[i]).collect();
        (Arc::new(FunctionSpace { basis, geometry }), id)
    } else {
        (Arc::new(ControlPoints { basis, points }), (0..functions).collect())
    };
    let quality = quality(&*space)?;
    let sides = sides(spec, &grid, &triangles, nodes.as_deref(), &connectivity, &id);
    Ok(Mesh { grid: Some(grid), space, sides: FacetTables::Lines(sides), quality, named: MeshPoints::default(), exact: spec.is_exact() })
}

impl<const N: usize> Triangle<N> {
    /// Maps a point of the reference triangle to the cell.
    fn place(&self, xi: &Vector<N>) -> Vector<N> {
        let weight = [1.0 - xi.sum(), xi[0], xi[1]];
        let Some(fan) = &self.apex else {
            return (0..3).fold(Vector::zeros(), |s, v| s + self.vertices[v] * weight[v]);
        };
        // distance from the collapsed edge, and the share of the two rays from it
        let away = 1.0 - weight[fan.apex];
        let [(a, at_a), (b, at_b)] = fan.ends;
        let along = if away > 0.0 { (weight[a] * at_a + weight[b] * at_b) / away } else { at_a };
        Vector::from_fn(|k, _| match (k == fan.collapsed.axis, fan.collapsed.end) {
            (true, 0) => away,
            (true, _) => 1.0 - away,
            (false, _) => along,
        })
    }
}

/// The vertex ids of the grid; those of collapsed faces are one where `merge` is set.
fn vertices<const N: usize>(grid: &ElementGrid<N>, merge: bool) -> ([usize; N], Vec<usize>) {
    let counts = grid.counts().map(|n| n + 1);
    let id = Merged::new(&counts, if merge { &grid.collapsed } else { &[] }).id;
    (counts, id)
}

/// Cuts every cell into two triangles along the diagonal (u0, v0)-(u1, v1); in an isoparametric mesh those whose edge is a
/// point are dropped.
fn cut<const N: usize>(grid: &ElementGrid<N>, exact: bool) -> Vec<Triangle<N>> {
    const CORNERS: [[[usize; 2]; 3]; 2] = [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]];
    let (counts, id) = vertices(grid, !exact);
    let cells = grid.counts();
    let mut triangles = Vec::new();
    for cell in 0..cells.iter().product() {
        let at = split(&cells, cell);
        let made = CORNERS.map(|corners| {
            let ids = corners.map(|c| id[join(&counts, &std::array::from_fn(|k| at[k] + c[k]))]);
            (corners, ids)
        });
        let flat = made.each_ref().map(|(_, ids)| ids[0] == ids[1] || ids[1] == ids[2] || ids[2] == ids[0]);
        for (which, (corners, ids)) in made.into_iter().enumerate() {
            if flat[which] {
                continue;
            }
            let vertices = corners.map(|c| Vector::<N>::from_fn(|k, _| c[k] as f64));
            let apex = if flat[1 - which] { fan(grid, &at, &vertices) } else { None };
            triangles.push(Triangle { cell, vertices, ids, apex });
        }
    }
    triangles
}

/// Returns the fan of the triangle that remains in a cell; `None` if no collapsed edge of the cell holds exactly one of its vertices.
fn fan<const N: usize>(grid: &ElementGrid<N>, at: &[usize; N], vertices: &[Vector<N>; 3]) -> Option<Fan> {
    grid.collapsed.iter().find_map(|c| {
        let side = c.side;
        let touches = at[side.axis] == side.end * (grid.counts()[side.axis] - 1);
        let on: Vec<usize> = (0..3).filter(|&v| vertices[v][side.axis] == side.end as f64).collect();
        let [apex] = on[..] else { return None };
        let [a, b] = [(apex + 1) % 3, (apex + 2) % 3];
        touches.then(|| Fan { apex, collapsed: side, ends: [(a, vertices[a][c.along]), (b, vertices[b][c.along])] })
    })
}

/// The sides of a triangle mesh: edges in the direction of increasing parameter, found by their vertices; `nodes`: those of an
/// isoparametric map.
fn sides<const S: usize, const N: usize>(
    spec: &PatchSpec<N>,
    grid: &ElementGrid<N>,
    triangles: &[Triangle<N>],
    nodes: Option<&[Vector<N>]>,
    connectivity: &[usize],
    id: &[usize],
) -> HashMap<String, MeshSide<S, N>> {
    let degree = spec.degree[0];
    let lattice = simplex_lattice::<N>(degree);
    let local_at: HashMap<[usize; N], usize> = lattice.iter().enumerate().map(|(a, &i)| (i, a)).collect();
    let (counts, vertex) = vertices(grid, nodes.is_some());
    let mut edges: HashMap<(usize, usize), (usize, usize, usize)> = HashMap::new();
    for (t, triangle) in triangles.iter().enumerate() {
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            edges.insert((triangle.ids[a], triangle.ids[b]), (t, a, b));
            edges.insert((triangle.ids[b], triangle.ids[a]), (t, b, a));
        }
    }
    let corner = |v: usize| Vector::<N>::from_fn(|k, _| if v == k + 1 { 1.0 } else { 0.0 });
    let mut sides = HashMap::new();
    for side in SideOf::all(N).into_iter().filter(|s| !grid.is_collapsed(*s)) {
        let along = side.along(N)[0];
        let on = on_side(&counts, side);
        let mut facets = Vec::new();
        let mut ids = Vec::new();
        for w in on.windows(2) {
            let (t, a, b) = edges[&(vertex[w[0]], vertex[w[1]])];
            facets.push(Embedding { element: t, origin: corner(a), axes: Matrix::from_fn(|k, _| (corner(b) - corner(a))[k]) });
            for step in usize::from(!ids.is_empty())..=degree {
                // `degree - step` shares of vertex a, `step` of vertex b
                let index = std::array::from_fn(|k| {
                    if k + 1 == a {
                        degree - step
                    } else if k + 1 == b {
                        step
                    } else {
                        0
                    }
                });
                ids.push(id[connectivity[t * lattice.len() + local_at[&index]]]);
            }
        }
        let lines: [_; S] = std::array::from_fn(|_| LagrangeLine::with_breakpoints(degree, grid.breakpoints[along].clone()));
        let geometry = side_map(grid, side, &lines, nodes.map(|nodes| ids.iter().map(|&i| nodes[i]).collect()));
        sides.insert(side.name(), MeshSide { lines, ids, geometry, facets });
    }
    sides
}
