//! Cells, sides and named points of a part of a mesh file.

use std::collections::BTreeMap;

use super::part::MeshPart;
use faying::linalg::Vector;
use faying::space::{CellBlock, FacetTag, corner_places, facet_key, facets, nodes_per_cell};
use faying_files::{FileError, MeshFile};

/// The cells of the file of dimension N, or those of a group of it, with every side and point that has a name.
///
/// # Errors
/// As of [`MeshFile::cells`]; [`FileError::Broken`] without cells.
pub(super) fn mesh_part<const N: usize>(file: &MeshFile, group: Option<&str>) -> Result<MeshPart<N>, FileError> {
    let cells = file.cells::<N>(group)?;
    let ids = file.cell_ids(N, group);
    if ids.is_empty() {
        return Err(FileError::Broken { what: "the mesh has no cells".to_owned(), spot: None });
    }
    let place = |label: String| {
        let x = file.point(&label)?;
        Some((label, Vector::<N>::from_fn(|k, _| x[k])))
    };
    let points = file.group_labels(0).into_iter().filter_map(place).collect();
    Ok(MeshPart { named: cells.tags.len(), cells, ids, points, point_ids: file.ids.clone() })
}

/// Corners of every facet of every cell, as sorted keys.
fn each_facet<const N: usize>(blocks: &[CellBlock], mut see: impl FnMut([usize; 4])) {
    for block in blocks {
        let facets = facets(block.cell, N);
        let corners = corner_places(block.cell, N, block.order);
        for cell in block.nodes.chunks_exact(nodes_per_cell(block.cell, N, block.order)) {
            for facet in &facets {
                see(facet_key(facet.iter().map(|c| cell[corners[*c]])));
            }
        }
    }
}

impl<const N: usize> MeshPart<N> {
    /// Facets of one cell only: the boundary, in the order of the cells.
    fn boundary(&self) -> Vec<[usize; 4]> {
        let mut all: Vec<([usize; 4], usize)> = Vec::new();
        each_facet::<N>(&self.cells.blocks, |key| all.push((key, all.len())));
        all.sort_unstable();
        let mut out: Vec<(usize, [usize; 4])> =
            all.chunk_by(|a, b| a.0 == b.0).filter(|c| c.len() == 1).map(|c| (c[0].1, c[0].0)).collect();
        out.sort_unstable();
        out.into_iter().map(|(_, key)| key).collect()
    }

    /// Names of the file's tags that are sides: tags without inner facets.
    pub(super) fn outer_tags(&self) -> Vec<&str> {
        let mut sorted = self.boundary();
        sorted.sort_unstable();
        let outside = |f: &[usize; 4]| sorted.binary_search(&facet_key(f.iter().copied())).is_ok();
        self.cells.tags[..self.named].iter().filter(|t| t.corners.iter().all(outside)).map(|t| t.name.as_str()).collect()
    }

    /// The sides that cover the boundary except `used` ones: tags of the file that share no facet with those or with each other and
    /// have no inner facets, and last, under a new name, the remaining facets.
    pub(super) fn outer(&mut self, used: &[&str]) -> Vec<String> {
        let boundary = self.boundary();
        let mut sorted = boundary.clone();
        sorted.sort_unstable();
        let mut taken = vec![false; sorted.len()];
        let find = |f: &[usize; 4]| sorted.binary_search(&facet_key(f.iter().copied())).ok();
        for tag in self.cells.tags.iter().filter(|t| used.contains(&t.name.as_str())) {
            tag.corners.iter().filter_map(find).for_each(|p| taken[p] = true);
        }
        let mut out = Vec::new();
        for tag in self.cells.tags[..self.named].iter().filter(|t| !used.contains(&t.name.as_str())) {
            let places: Option<Vec<usize>> = tag.corners.iter().map(find).collect();
            if let Some(places) = places.filter(|p| p.iter().all(|p| !taken[*p])) {
                places.iter().for_each(|p| taken[*p] = true);
                out.push(tag.name.clone());
            }
        }
        let rest: Vec<[usize; 4]> = boundary.iter().filter(|f| find(f).is_some_and(|p| !taken[p])).copied().collect();
        if !rest.is_empty() {
            out.push(self.add_side("all-outer", rest));
        }
        out
    }

    /// Adds a side for the program's own use; returns its name.
    pub(super) fn add_side(&mut self, wanted: &str, corners: Vec<[usize; 4]>) -> String {
        let name = self.free_name(wanted);
        self.cells.tags.push(FacetTag { name: name.clone(), corners });
        name
    }
}

/// Facets that are common to two parts of one file, with the indices of the parts.
pub(super) fn shared<const N: usize>(parts: &[&MeshPart<N>]) -> Vec<([usize; 2], Vec<[usize; 4]>)> {
    let mut all: Vec<([usize; 4], usize)> = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        all.extend(part.boundary().into_iter().map(|f| (f, k)));
    }
    all.sort_unstable();
    let mut pairs: BTreeMap<[usize; 2], Vec<[usize; 4]>> = BTreeMap::new();
    for pair in all.chunk_by(|a, b| a.0 == b.0).filter(|c| c.len() == 2) {
        pairs.entry([pair[0].1, pair[1].1]).or_default().push(pair[0].0);
    }
    pairs.into_iter().collect()
}

/// Points of two or more parts that are not all connected there by common facets, with the indices of the parts.
pub(super) fn met<const N: usize>(parts: &[&MeshPart<N>], common: &[([usize; 2], Vec<[usize; 4]>)]) -> Vec<(usize, Vec<usize>)> {
    let mut owners: Vec<(usize, usize)> = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        owners.extend(part.boundary().iter().flatten().filter(|p| **p != usize::MAX).map(|p| (*p, k)));
    }
    owners.sort_unstable();
    owners.dedup();
    let mut joined: Vec<(usize, [usize; 2])> = Vec::new();
    for (pair, facets) in common {
        joined.extend(facets.iter().flatten().filter(|p| **p != usize::MAX).map(|p| (*p, *pair)));
    }
    joined.sort_unstable();
    joined.dedup();
    let mut out = Vec::new();
    for run in owners.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        let point = run[0].0;
        let first = joined.partition_point(|j| j.0 < point);
        let pairs = joined[first..].iter().take_while(|j| j.0 == point).map(|j| j.1);
        // parts around the point that a chain of facets connects get the same label
        let mut name: BTreeMap<usize, usize> = run.iter().map(|(_, k)| (*k, *k)).collect();
        for [a, b] in pairs {
            let [low, high] = [name[&a].min(name[&b]), name[&a].max(name[&b])];
            name.values_mut().filter(|n| **n == high).for_each(|n| *n = low);
        }
        if name.values().any(|n| *n != run[0].1) {
            out.push((point, run.iter().map(|(_, k)| *k).collect()));
        }
    }
    out
}
