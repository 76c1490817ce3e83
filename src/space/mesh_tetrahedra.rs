//! Tetrahedral meshes of a solid patch.

use super::grid::{ElementGrid, Merged, SideOf, join, on_side, split};
use super::mesh::{FacetTables, MeshPoints};
use super::mesh_facets::{Facets, NamedFacets, vertices_of};
use super::mesh_trace::{FacetMap, FacetSides};
use super::{FunctionSpace, MAX_DEGREE_SIMPLEX, Mapping, Mesh, PatchSpec, Space, SpecError, quality};
use crate::basis::{Basis, Cell, Order, Topology, Unstructured, simplex_nodes};
use crate::geometry::{ControlPoints, Embedded, Embedding, Geometry, MapTable};
use crate::linalg::{Matrix, Vector};
use std::sync::Arc;

/// Corners of a hexahedron, as bits per axis, on the six paths along its edges from (0, 0, 0) to (1, 1, 1): right-handed tetrahedra.
const CORNERS: [[usize; 4]; 6] = [[0, 1, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 3, 2, 7], [0, 6, 4, 7], [0, 5, 1, 7]];

/// Rounding errors of a coordinate that was computed, in units of its last place.
const ROUNDINGS: f64 = 16.0;

/// A tetrahedron cut from a cell of the grid.
struct Tetrahedron {
    cell: usize,
    /// Its corners in the cell.
    corners: [usize; 4],
    ids: [usize; 4],
}

/// Builds the mesh of six tetrahedra per cell around its diagonal; those that a collapsed edge leaves without volume are dropped,
/// and the others are spread over the cell.
pub(super) fn tetrahedra<const S: usize, const N: usize>(spec: &PatchSpec<N>) -> Result<Mesh<S, N>, SpecError> {
    spec.check_degree(MAX_DEGREE_SIMPLEX, "simplices")?;
    let degree = spec.degree[0];
    if spec.degree.iter().any(|&d| d != degree) {
        return Err(SpecError::MixedDegree { degree: spec.degree.to_vec() });
    }
    let grid = ElementGrid::new(&spec.net, &spec.breakpoints)?;
    let exact = spec.mapping == Mapping::Exact;
    if let Some(c) = grid.collapsed.first().filter(|_| exact) {
        return Err(SpecError::ExactCollapsed { side: c.side.name() });
    }
    let counts = grid.counts().map(|n| n + 1);
    let vertex = Merged::new(&counts, &grid.collapsed);
    let cut = cut(&grid, &counts, &vertex.id)?;
    let topology = Arc::new(Topology::<N>::new(vec![Cell::Simplex; cut.len()], cut.iter().flat_map(|t| t.ids).collect()));
    let basis = Unstructured::<N>::lagrange_along(degree, topology.clone(), &(0..cut.len() as u32).collect::<Vec<_>>());
    let isoparametric = Arc::new(ControlPoints { points: nodes_of(&grid, &cut, &basis, degree), basis });
    let basis = isoparametric.basis.clone();
    let named = sides(&grid, &counts, &vertex.id, &topology);
    let (space, map): (Arc<dyn Space<N, N>>, _) = if exact {
        let corner = |bits: usize| Vector::<N>::from_fn(|k, _| (bits >> k & 1) as f64);
        let embedding = |t: &Tetrahedron| Embedding {
            element: t.cell,
            origin: corner(t.corners[0]),
            axes: Matrix::from_fn(|k, s| (corner(t.corners[s + 1]) - corner(t.corners[0]))[k]),
        };
        let cells = cut.iter().map(embedding).collect();
        let geometry: Arc<dyn Geometry<N, N>> = Arc::new(Embedded::new(grid.exact.clone(), cells, Cell::Simplex));
        (Arc::new(FunctionSpace { basis: basis.clone(), geometry: geometry.clone() }), FacetMap::Through(geometry))
    } else {
        (isoparametric.clone(), FacetMap::Nodes(isoparametric))
    };
    let quality = quality(&*space)?;
    let sides = FacetTables::Facets(FacetSides { basis, map, named });
    let exact = exact || spec.is_exact() && (N < 3 || sides_have_degree(&grid, degree));
    Ok(Mesh { grid: Some(grid), space, sides, quality, named: MeshPoints::default(), exact })
}

/// Whether the sides of a solid patch are polynomials of a total degree of at most `degree`, which triangles hold: products of two such
/// have twice the degree.
///
/// On two slanted lines of every cell the differences of the order `degree` + 1 vanish up to rounding.
fn sides_have_degree<const N: usize>(grid: &ElementGrid<N>, degree: usize) -> bool {
    let lines = [[1.0, 1.0], [1.0, 0.5]]
        .map(|slope| -> Vec<Vector<2>> { (0..=degree + 1).map(|k| Vector::from(slope) * (k as f64 / (degree + 1) as f64)).collect() });
    let mut table = MapTable::new();
    let mut is_polynomial = |map: &dyn Geometry<2, N>, element: usize, line: &[Vector<2>]| {
        map.map(element, line, Order::Values, &mut table);
        let size = table.x.iter().fold(0.0f64, |m, x| m.max(x.amax()));
        let mut differences = table.x.clone();
        while differences.len() > 1 {
            differences = differences.windows(2).map(|pair| pair[1] - pair[0]).collect();
        }
        differences[0].amax() <= ROUNDINGS * 2f64.powi(degree as i32 + 1) * f64::EPSILON * size
    };
    SideOf::all(N).into_iter().filter(|side| !grid.is_collapsed(*side)).all(|side| {
        let map = grid.side_map::<2>(side);
        (0..map.num_elements()).all(|element| lines.iter().all(|line| is_polynomial(&*map, element, line)))
    })
}

/// Cuts all cells into tetrahedra with merged vertices.
fn cut<const N: usize>(grid: &ElementGrid<N>, counts: &[usize; N], id: &[usize]) -> Result<Vec<Tetrahedron>, SpecError> {
    let cells = grid.counts();
    let mut all = Vec::new();
    for cell in 0..cells.iter().product() {
        let at = split(&cells, cell);
        let before = all.len();
        for corners in CORNERS {
            let ids = corners.map(|c| id[join(counts, &std::array::from_fn(|k| at[k] + (c >> k & 1)))]);
            if (0..4).all(|a| (0..a).all(|b| ids[a] != ids[b])) {
                all.push(Tetrahedron { cell, corners, ids });
            }
        }
        if all.len() == before {
            return Err(SpecError::FlatCell { cell });
        }
    }
    Ok(all)
}

/// The nodes of all functions on the exact map.
fn nodes_of<const N: usize>(grid: &ElementGrid<N>, cut: &[Tetrahedron], basis: &Unstructured<N>, degree: usize) -> Vec<Vector<N>> {
    let nodes = simplex_nodes::<N, f64>(degree);
    let mut points = vec![Vector::zeros(); basis.num_functions()];
    let (mut map, mut places) = (MapTable::new(), Vec::new());
    for (e, t) in cut.iter().enumerate() {
        let fans = fans(grid, t.cell);
        places.clear();
        places.extend(nodes.iter().map(|xi| {
            let weight = |v: usize| if v == 0 { 1.0 - xi.sum() } else { xi[v - 1] };
            let place = Vector::<N>::from_fn(|k, _| (0..4).filter(|&v| t.corners[v] >> k & 1 == 1).map(weight).sum());
            fans.iter().fold(place, spread)
        }));
        grid.exact.map(t.cell, &places, Order::Values, &mut map);
        basis.functions(e).iter().zip(&map.x).for_each(|(&i, x)| points[i] = *x);
    }
    points
}

/// A collapsed face of a cell: its lines along axis `along` are points.
struct Fan {
    side: SideOf,
    along: usize,
}

/// The collapsed faces of a cell, those that are points before those that are edges.
fn fans<const N: usize>(grid: &ElementGrid<N>, cell: usize) -> Vec<Fan> {
    let (counts, at) = (grid.counts(), split(&grid.counts(), cell));
    let touches = |side: SideOf| at[side.axis] == side.end * (counts[side.axis] - 1);
    let here = grid.collapsed.iter().filter(|c| touches(c.side));
    let mut fans: Vec<Fan> = here.map(|c| Fan { side: c.side, along: c.along }).collect();
    fans.sort_by_key(|f| std::cmp::Reverse(grid.collapsed.iter().filter(|c| c.side == f.side).count()));
    fans
}

/// Maps the half of a cell that is filled by the tetrahedra at a collapsed face to the whole cell, along rays from the face.
fn spread<const N: usize>(mut place: Vector<N>, fan: &Fan) -> Vector<N> {
    let away = place[fan.side.axis];
    let (part, whole) = if fan.side.end == 0 { (place[fan.along], away) } else { (place[fan.along] - away, 1.0 - away) };
    // on the face itself all points coincide
    place[fan.along] = if whole > 0.0 { (part / whole).clamp(0.0, 1.0) } else { 0.0 };
    place
}

/// The boundary facets of every face of the patch, by their vertices.
fn sides<const N: usize>(grid: &ElementGrid<N>, counts: &[usize; N], id: &[usize], topology: &Topology<N>) -> NamedFacets {
    let all: Vec<SideOf> = SideOf::all(N).into_iter().filter(|s| !grid.is_collapsed(*s)).collect();
    // per merged vertex: its faces, as bits; the topology has its own numbers of vertices
    let mut faces = vec![0u8; id.len()];
    for (k, &side) in all.iter().enumerate() {
        on_side(counts, side).into_iter().for_each(|v| faces[id[v]] |= 1 << k);
    }
    let mut on = vec![0u8; topology.num_vertices()];
    for e in 0..topology.num_cells() {
        topology.vertices(e).iter().zip(topology.corners(e)).for_each(|(&v, &i)| on[v] = faces[i]);
    }
    let mut named = NamedFacets { sides: all.iter().map(|s| (s.name(), Vec::new())).collect(), ..NamedFacets::default() };
    for of in Facets::of(topology).boundary() {
        let common = vertices_of(topology, of).fold(u8::MAX, |bits, v| bits & on[v]);
        if let Some(k) = (0..all.len()).find(|k| common >> k & 1 == 1) {
            named.sides[k].1.push(of);
        }
    }
    named
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_right_handed_tetrahedra_fill_the_cube() {
        let corner = |bits: usize| Vector::<3>::from_fn(|k, _| (bits >> k & 1) as f64);
        for c in CORNERS {
            let axes = Matrix::<3, 3>::from_fn(|k, s| (corner(c[s + 1]) - corner(c[0]))[k]);
            assert_eq!(axes.determinant(), 1.0, "{c:?}");
        }
    }
}
