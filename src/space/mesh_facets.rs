//! Facets of a mesh of cells: boundary, check for folds, named sides.

use super::mesh_error::place;
use super::{FacetTag, MeshError};
use crate::basis::{Cell, Topology, key_of, local_edges};
use crate::linalg::Vector;
use std::collections::{HashMap, HashSet};

/// Local corners of a face of a right-handed cell, counter-clockwise seen from outside (in the plane: with the cell on the left).
pub(super) fn outward_corners(cell: Cell, dimension: usize, face: usize) -> &'static [usize] {
    const SQUARE: [&[usize]; 4] = [&[2, 0], &[1, 3], &[0, 1], &[3, 2]];
    const TRIANGLE: [&[usize]; 3] = [&[2, 0], &[0, 1], &[1, 2]];
    const CUBE: [&[usize]; 6] = [&[0, 4, 6, 2], &[1, 3, 7, 5], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 2, 3, 1], &[4, 5, 7, 6]];
    const TETRAHEDRON: [&[usize]; 4] = [&[0, 3, 2], &[0, 1, 3], &[0, 2, 1], &[1, 2, 3]];
    match (cell, dimension) {
        (Cell::Tensor, 2) => SQUARE[face],
        (Cell::Simplex, 2) => TRIANGLE[face],
        (Cell::Tensor, _) => CUBE[face],
        (Cell::Simplex, _) => TETRAHEDRON[face],
    }
}

/// The local corners of a facet in the order of its own cell; its axes cross outwards.
pub(super) fn tensor_order<const N: usize>(topology: &Topology<N>, (cell, face): FaceOf) -> impl Iterator<Item = usize> + use<N> {
    let around = outward_corners(topology.cell(cell), N, face);
    let n = around.len();
    (0..n).map(move |k| if n == 4 { around[[0, 1, 3, 2][k]] } else { around[k] })
}

/// A facet by its cell and the number of its face there.
pub(super) type FaceOf = (usize, usize);

/// Vertices of a face in the order of [`outward_corners`].
pub(super) fn vertices_of<const N: usize>(topology: &Topology<N>, (cell, face): FaceOf) -> impl Iterator<Item = usize> + Clone + '_ {
    outward_corners(topology.cell(cell), N, face).iter().map(move |&c| topology.vertices(cell)[c])
}

/// All facets of a mesh with the cells at them.
pub(super) struct Facets<'a, const N: usize> {
    topology: &'a Topology<N>,
    /// Per facet: its first cell, and whether there is another.
    at: Vec<(FaceOf, bool)>,
}

/// Sides by name, as facets.
#[derive(Clone, Debug, Default)]
pub(super) struct NamedFacets {
    /// Sides on the boundary.
    pub sides: Vec<(String, Vec<FaceOf>)>,
    /// Tags that are no sides.
    pub inner: Vec<InnerTag>,
    /// Name of the side that holds all boundary facets without a tag.
    pub untagged: Option<String>,
}

/// Points, edges or faces of cells under a name that is no side.
#[derive(Clone, Debug)]
pub(super) struct InnerTag {
    pub name: String,
    pub dimension: usize,
    /// The index in the tag of the first facet inside the mesh; `None` for points, and for edges in space.
    pub facet: Option<usize>,
    /// One cell of each, and its corners there as local numbers.
    pub cells: Vec<(usize, Vec<usize>)>,
}

impl<'a, const N: usize> Facets<'a, N> {
    /// Collects the facets of cells that are known to fit, without checks.
    pub fn of(topology: &'a Topology<N>) -> Self {
        let mut at: Vec<Option<(FaceOf, bool)>> = vec![None; topology.num_facets()];
        for cell in 0..topology.num_cells() {
            for (face, &f) in topology.facets(cell).iter().enumerate() {
                at[f] = Some(at[f].map_or(((cell, face), false), |(first, _)| (first, true)));
            }
        }
        Self { topology, at: at.into_iter().map(|a| a.expect("every facet has a cell")).collect() }
    }

    /// Facets that belong to one cell only.
    pub fn boundary(&self) -> impl Iterator<Item = FaceOf> + '_ {
        self.at.iter().filter(|a| !a.1).map(|a| a.0)
    }

    /// Collects the facets and checks that cells fit; `places` of the vertices are for errors.
    pub fn new(topology: &'a Topology<N>, places: &[Vector<N>]) -> Result<Self, MeshError> {
        let mut at: Vec<Option<(FaceOf, bool)>> = vec![None; topology.num_facets()];
        let middle = |of: FaceOf| {
            let corners: Vec<usize> = vertices_of(topology, of).collect();
            place(&(corners.iter().fold(Vector::<N>::zeros(), |s, &v| s + places[v]) / corners.len() as f64))
        };
        for cell in 0..topology.num_cells() {
            for (face, &f) in topology.facets(cell).iter().enumerate() {
                let here = (cell, face);
                match &mut at[f] {
                    None => at[f] = Some((here, false)),
                    Some((first, true)) => return Err(MeshError::Branched { cells: [first.0, cell], at: middle(here) }),
                    Some((first, second)) => {
                        // neighbours on both sides of a facet have opposite orientations of it
                        if turns_up(vertices_of(topology, *first)) == turns_up(vertices_of(topology, here)) {
                            return Err(MeshError::Folded { cells: [first.0, cell], at: middle(here) });
                        }
                        *second = true;
                    }
                }
            }
        }
        let facets = Self { topology, at: at.into_iter().map(|a| a.expect("every facet has a cell")).collect() };
        if N == 3 {
            facets.check_shapes(&middle)?;
        }
        Ok(facets)
    }

    /// Checks that no triangle on the boundary has its corners on one quadrilateral of the boundary.
    fn check_shapes(&self, middle: &dyn Fn(FaceOf) -> [f64; 3]) -> Result<(), MeshError> {
        let of_shape = |wanted: Cell| self.at.iter().filter(move |(of, inside)| !inside && self.topology.cell(of.0) == wanted).map(|a| a.0);
        if of_shape(Cell::Simplex).next().is_none() {
            return Ok(());
        }
        let mut corners: Vec<([usize; 4], FaceOf)> = Vec::new();
        for of in of_shape(Cell::Tensor) {
            let all: Vec<usize> = vertices_of(self.topology, of).collect();
            corners.extend((0..all.len()).map(|skip| (key_of((0..all.len()).filter(|&k| k != skip).map(|k| all[k])), of)));
        }
        corners.sort_unstable();
        for of in of_shape(Cell::Simplex) {
            let key = key_of(vertices_of(self.topology, of));
            if let Ok(k) = corners.binary_search_by_key(&key, |c| c.0) {
                return Err(MeshError::Mismatch { cells: [of.0, corners[k].1.0], at: middle(corners[k].1) });
            }
        }
        Ok(())
    }

    /// Builds the sides of `tags`, what else they name, and the side of the remaining boundary facets; `vertex` gives the vertex at a
    /// point.
    pub fn named(&self, tags: &[FacetTag], vertex: &[usize]) -> Result<NamedFacets, MeshError> {
        let mut found = NamedFacets::default();
        let mut keys: Vec<([usize; 4], usize)> =
            if tags.is_empty() { Vec::new() } else { self.at.iter().zip(0..).map(|(a, f)| (self.key(a.0), f)).collect() };
        keys.sort_unstable();
        let mut lists: Vec<(&str, Vec<usize>)> = Vec::new();
        let mut place: HashMap<&str, usize> = HashMap::new();
        let mut tagged = vec![false; self.at.len()];
        for tag in tags {
            if let Some(dimension) = tag.dimension().filter(|d| d + 1 < N) {
                let new = self.lower(tag, dimension, vertex)?;
                match found.inner.iter_mut().find(|t| t.name == tag.name && t.dimension == dimension) {
                    Some(known) => known.cells.extend(new.cells),
                    None => found.inner.push(new),
                }
                continue;
            }
            let k = *place.entry(&tag.name).or_insert_with(|| {
                lists.push((&tag.name, Vec::new()));
                lists.len() - 1
            });
            for (facet, key) in tag.keys(vertex).enumerate() {
                let none = || MeshError::NoFacet { tag: tag.name.clone(), facet };
                let key = key.ok_or_else(none)?;
                let at = keys.binary_search_by_key(&key, |k| k.0).map_err(|_| none())?;
                lists[k].1.push(keys[at].1);
                tagged[keys[at].1] = true;
            }
        }
        for (name, list) in lists {
            if list.is_empty() {
                return Err(MeshError::EmptyTag { tag: name.to_string() });
            }
            let inside = list.iter().position(|&f| self.at[f].1);
            let ordered = self.ordered(list);
            match inside {
                None => found.sides.push((name.to_string(), ordered)),
                Some(_) => {
                    let cells = ordered.into_iter().map(|of| (of.0, tensor_order(self.topology, of).collect())).collect();
                    found.inner.push(InnerTag { name: name.to_string(), dimension: N - 1, facet: inside, cells });
                }
            }
        }
        let rest: Vec<usize> = (0..self.at.len()).filter(|&f| !self.at[f].1 && !tagged[f]).collect();
        if !rest.is_empty() {
            let mut name = "untagged".to_string();
            while place.contains_key(name.as_str()) {
                name.push('_');
            }
            found.sides.push((name.clone(), self.ordered(rest)));
            found.untagged = Some(name);
        }
        Ok(found)
    }

    /// The points, or the edges in space, of a tag, each in one of its cells.
    fn lower(&self, tag: &FacetTag, dimension: usize, vertex: &[usize]) -> Result<InnerTag, MeshError> {
        let mut at: HashMap<[usize; 4], Option<(usize, Vec<usize>)>> = tag.keys(vertex).flatten().map(|key| (key, None)).collect();
        for cell in 0..self.topology.num_cells() {
            let vertices = self.topology.vertices(cell);
            let parts: Vec<Vec<usize>> = match dimension {
                0 => (0..vertices.len()).map(|c| vec![c]).collect(),
                _ => local_edges(self.topology.cell(cell), N).iter().map(|edge| edge.to_vec()).collect(),
            };
            for part in parts {
                if let Some(place) = at.get_mut(&key_of(part.iter().map(|&c| vertices[c]))) {
                    place.get_or_insert((cell, part));
                }
            }
        }
        let (mut seen, mut cells) = (HashSet::new(), Vec::with_capacity(at.len()));
        for (facet, key) in tag.keys(vertex).enumerate() {
            let place = key.and_then(|key| at.get(&key)?.clone());
            let place = place.ok_or_else(|| MeshError::NoFacet { tag: tag.name.clone(), facet })?;
            if seen.insert(key) {
                cells.push(place);
            }
        }
        Ok(InnerTag { name: tag.name.clone(), dimension, facet: None, cells })
    }

    fn key(&self, of: FaceOf) -> [usize; 4] {
        key_of(vertices_of(self.topology, of))
    }

    /// Lists facets once each: in the plane in order along the curve, in space as given.
    fn ordered(&self, mut list: Vec<usize>) -> Vec<FaceOf> {
        let mut seen = HashSet::new();
        list.retain(|f| seen.insert(*f));
        let list: Vec<FaceOf> = list.into_iter().map(|f| self.at[f].0).collect();
        if N != 2 {
            return list;
        }
        let ends = |of: &FaceOf| {
            let [a, b] = outward_corners(self.topology.cell(of.0), N, of.1) else { unreachable!("an edge has two ends") };
            [*a, *b].map(|c| self.topology.vertices(of.0)[c])
        };
        let ends: Vec<[usize; 2]> = list.iter().map(ends).collect();
        chained(&ends).into_iter().map(|k| list[k]).collect()
    }
}

/// Order of directed edges along their curves: open curves first, each from its start, then closed ones; curves end at forks.
fn chained(ends: &[[usize; 2]]) -> Vec<usize> {
    // per vertex: number of edges that start and that stop there, and one that starts
    let mut at: HashMap<usize, (usize, usize, usize)> = HashMap::new();
    for (k, &[a, b]) in ends.iter().enumerate() {
        let start = at.entry(a).or_default();
        *start = (start.0 + 1, start.1, k);
        at.entry(b).or_default().1 += 1;
    }
    let passes = |v: usize| at.get(&v).filter(|a| (a.0, a.1) == (1, 1)).map(|a| a.2);
    let mut seen = vec![false; ends.len()];
    let mut order = Vec::with_capacity(ends.len());
    let heads = (0..ends.len()).filter(|&k| passes(ends[k][0]).is_none());
    for first in heads.chain(0..ends.len()) {
        let mut next = Some(first);
        while let Some(k) = next.filter(|&k| !seen[k]) {
            seen[k] = true;
            order.push(k);
            next = passes(ends[k][1]);
        }
    }
    order
}

/// Orientation of a facet: whether its cycle leads from the least vertex to the lesser of the two adjacent ones.
fn turns_up(around: impl Iterator<Item = usize> + Clone) -> bool {
    let all: Vec<usize> = around.collect();
    let n = all.len();
    let least = (0..n).min_by_key(|&k| all[k]).expect("a facet has corners");
    if n == 2 { least == 0 } else { all[(least + 1) % n] < all[(least + n - 1) % n] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_follow_one_another_and_forks_end_a_piece() {
        // 3 -> 1 -> 2 open, 7 -> 8 -> 7 closed
        assert_eq!(chained(&[[1, 2], [7, 8], [3, 1], [8, 7]]), [2, 0, 1, 3]);
        // two loops through vertex 0
        assert_eq!(chained(&[[0, 1], [2, 0], [1, 0], [0, 2]]), [0, 2, 3, 1]);
    }
}
