//! Traces of meshes of cells: curves and surfaces of facets with functions of their own.

use super::mesh_facets::{FaceOf, NamedFacets, tensor_order};
use super::{FunctionSpace, SideError, Space, Submesh, Trace};
use crate::basis::{Basis, Cell, Elements, LagrangeLine, TensorProduct, Topology, Unstructured, lattice};
use crate::geometry::{ControlPoints, Embedded, Embedding, Geometry, cell};
use crate::linalg::{Matrix, Vector};
use std::sync::Arc;

/// The sides of a mesh of cells.
#[derive(Clone, Debug)]
pub(super) struct FacetSides<const N: usize> {
    /// The functions of the mesh.
    pub basis: Unstructured<N>,
    pub map: FacetMap<N>,
    pub named: NamedFacets,
}

/// Source of the facets' map.
#[derive(Clone, Debug)]
pub(super) enum FacetMap<const N: usize> {
    /// Nodes of Lagrange cells.
    Nodes(Arc<ControlPoints<Unstructured<N>, N>>),
    /// The map of the body's elements, all tetrahedra.
    Through(Arc<dyn Geometry<N, N>>),
}

impl<const N: usize> FacetSides<N> {
    /// Names of the sides.
    pub fn names(&self) -> Vec<String> {
        self.named.sides.iter().map(|s| s.0.clone()).collect()
    }

    /// The points, edges or faces of a tag that is no side.
    pub fn submesh(&self, name: &str) -> Option<Submesh<N>> {
        let tag = self.named.inner.iter().find(|tag| tag.name == name)?;
        let place = |(cell, corners): &(usize, Vec<usize>)| {
            let all = cell::corners::<N, f64>(self.basis.topology().cell(*cell));
            (*cell, corners.iter().map(|&c| all[c]).collect())
        };
        Some(Submesh { dimension: tag.dimension, cells: tag.cells.iter().map(place).collect() })
    }

    /// The space on a side.
    pub fn trace<const S: usize>(&self, body: &Arc<dyn Space<N, N>>, name: &str) -> Result<Trace<S, N>, SideError> {
        let Some((_, list)) = self.named.sides.iter().find(|s| s.0 == name) else {
            let Some(tag) = self.named.inner.iter().find(|tag| tag.name == name) else {
                return Err(SideError::Unknown { side: name.to_string(), known: self.names().join(", ") });
            };
            return Err(match tag.facet {
                Some(facet) => SideError::Interior { facet },
                None => SideError::Lower { name: name.to_string(), dimension: tag.dimension },
            });
        };
        let topology = &**self.basis.topology();
        let facets: Vec<Embedding<S, N>> = list.iter().map(|&of| facet(topology, of)).collect();
        let kinds: Vec<Cell> = list.iter().map(|of| if S == 1 { Cell::Tensor } else { topology.cell(of.0) }).collect();
        let corners: Vec<usize> = list.iter().flat_map(|&of| tensor_order(topology, of).map(move |c| topology.corners(of.0)[c])).collect();
        let degree = degree_of(&self.basis);
        let (space, dofs): (Arc<dyn Space<S, N>>, _) = match &self.map {
            FacetMap::Nodes(map) => {
                let breakpoints = run(&corners, S).then(|| breakpoints(topology, map, list));
                let side = Arc::new(Topology::new(kinds, corners));
                let (basis, dofs) = functions(&self.basis, &facets, &side, breakpoints.as_deref());
                let order = degree_of(&map.basis);
                if order == degree {
                    let points = dofs.iter().map(|&i| map.points[i]).collect();
                    (Arc::new(ControlPoints { basis, points }), dofs)
                } else {
                    let (nodes, places) = functions(&map.basis, &facets, &side, breakpoints.as_deref());
                    let points = places.iter().map(|&i| map.points[i]).collect();
                    (Arc::new(FunctionSpace { basis, geometry: ControlPoints { basis: nodes, points } }), dofs)
                }
            }
            FacetMap::Through(map) => {
                let (basis, dofs) = functions(&self.basis, &facets, &Arc::new(Topology::new(kinds, corners)), None);
                (Arc::new(FunctionSpace { basis, geometry: Embedded::new(map.clone(), facets.clone(), Cell::Simplex) }), dofs)
            }
        };
        Ok(Trace::on_boundary(body, space, dofs, facets))
    }
}

fn degree_of<const D: usize>(basis: &Unstructured<D>) -> usize {
    if basis.num_elements() == 0 { 1 } else { basis.degree(0)[0] }
}

fn facet<const S: usize, const N: usize>(topology: &Topology<N>, of: FaceOf) -> Embedding<S, N> {
    let all = cell::corners::<N, f64>(topology.cell(of.0));
    let corners: Vec<Vector<N>> = tensor_order(topology, of).map(|c| all[c]).collect();
    Embedding { element: of.0, origin: corners[0], axes: Matrix::from_fn(|k, s| (corners[s + 1] - corners[0])[k]) }
}

/// Whether the edges of a curve are one open run: each starts where the last one ends, and none comes back.
fn run(corners: &[usize], dimension: usize) -> bool {
    if dimension != 1 || !(2..corners.len() - 1).step_by(2).all(|k| corners[k] == corners[k - 1]) {
        return false;
    }
    let mut starts: Vec<usize> = corners.iter().copied().step_by(2).chain(corners.last().copied()).collect();
    let n = starts.len();
    starts.sort_unstable();
    starts.dedup();
    starts.len() == n
}

/// Parameters of the ends of the edges: cumulated chord lengths; integers if a chord has no length.
fn breakpoints<const N: usize>(topology: &Topology<N>, map: &ControlPoints<Unstructured<N>, N>, list: &[FaceOf]) -> Vec<f64> {
    let mut sums = vec![0.0];
    for &of in list {
        let ends: Vec<usize> = tensor_order(topology, of).collect();
        let [a, b] = [ends[0], ends[1]].map(|c| map.points[map.basis.at_corner(of.0, c)]);
        sums.push(sums[sums.len() - 1] + (b - a).norm());
    }
    if sums.windows(2).all(|w| w[0] < w[1]) { sums } else { (0..sums.len()).map(|k| k as f64).collect() }
}

/// Builds the functions of a side and lists the body's function of each; a [`LagrangeLine`] if `breakpoints` are given.
fn functions<const S: usize, const N: usize>(
    body: &Unstructured<N>,
    facets: &[Embedding<S, N>],
    side: &Arc<Topology<S>>,
    breakpoints: Option<&[f64]>,
) -> (Box<dyn Basis<S>>, Vec<usize>) {
    let degree = degree_of(body);
    let basis: Box<dyn Basis<S>> = match breakpoints {
        Some(b) => Box::new(TensorProduct::new(std::array::from_fn(|_| LagrangeLine::with_breakpoints(degree, b.to_vec())))),
        None => Box::new(Unstructured::<S>::lagrange(degree, side.clone())),
    };
    let mut dofs = vec![usize::MAX; basis.num_functions()];
    // position of an index in the lattice of a cell, by its entries as digits
    let base = degree + 1;
    let digits = |i: &[usize; N]| i.iter().rev().fold(0, |n, k| n * base + k);
    let places = [Cell::Tensor, Cell::Simplex].map(|c| {
        let mut place = vec![usize::MAX; base.pow(N as u32)];
        lattice::<N>(c, degree).iter().enumerate().for_each(|(a, i)| place[digits(i)] = a);
        place
    });
    let lattices = [Cell::Tensor, Cell::Simplex].map(|c| lattice::<S>(c, degree));
    let mut ids = Vec::new();
    for (e, facet) in facets.iter().enumerate() {
        basis.active(e, &mut ids);
        let place = &places[usize::from(body.cell(facet.element) == Cell::Simplex)];
        let own = &lattices[usize::from(side.cell(e) == Cell::Simplex)];
        for (&id, index) in ids.iter().zip(own) {
            // corners have whole coordinates, so do indices of nodes
            let at: [usize; N] = std::array::from_fn(|k| {
                let steps = (0..S).map(|s| facet.axes[(k, s)] * index[s] as f64).sum::<f64>();
                (facet.origin[k] * degree as f64 + steps) as usize
            });
            dofs[id] = body.functions(facet.element)[place[digits(&at)]];
        }
    }
    (basis, dofs)
}
