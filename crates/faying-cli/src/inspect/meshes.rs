//! Contents of a file of points and cells.

use super::group_place::places;
use super::look::{Soundness, is_flat, look};
use super::{CellMap, SidePlace};
use crate::lower::unshared_text;
use faying::space::{measure, unshared_points};
use faying_files::{CellShape, Format, MeshBlock, MeshFile};
use serde::Serialize;

/// Cells of one shape and order.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CellsReport {
    /// triangle, hexahedron, ...
    pub shape: String,
    /// Geometry order.
    pub order: usize,
    /// Number of cells.
    pub count: usize,
}

/// A physical group.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupReport {
    /// Dimension of its cells.
    pub dimension: usize,
    /// Its number.
    pub number: i64,
    /// Its name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Its cells.
    pub cells: usize,
    /// Its nodes.
    pub nodes: usize,
    /// Their length, area or volume; `None` if none of them has one: points, prisms and pyramids of order 2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measure: Option<f64>,
    /// Mean of the points and direction of the mean outward normal, of groups that are sides of the mesh.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub place: Option<SidePlace>,
}

/// Length, area or volume of the cells of a block; `None` for points, and prisms and pyramids of order 2.
pub fn size(block: &MeshBlock, points: &[[f64; 3]]) -> Option<f64> {
    // a prism is a hexahedron two edges of which are points, a pyramid one with a face that is a point
    let collapsed: &[usize] = match (block.shape, block.order) {
        (CellShape::Prism, 1) => &[0, 1, 2, 2, 3, 4, 5, 5],
        (CellShape::Pyramid, 1) => &[0, 1, 3, 2, 4, 4, 4, 4],
        _ => &[],
    };
    if !collapsed.is_empty() {
        let corners = if block.shape == CellShape::Prism { 6 } else { 5 };
        let nodes = block.nodes.chunks_exact(corners).flat_map(|cell| collapsed.iter().map(|k| cell[*k])).collect();
        let hexahedra = MeshBlock { shape: CellShape::Hexahedron, order: 1, nodes, ids: Vec::new(), groups: Vec::new() };
        return CellMap::<3>::new(&hexahedra, points).map(|m| measure::<3, 3, f64, _>(&m));
    }
    match block.shape.dimension() {
        1 => CellMap::<1>::new(block, points).map(|m| measure::<1, 3, f64, _>(&m)),
        2 => CellMap::<2>::new(block, points).map(|m| measure::<2, 3, f64, _>(&m)),
        3 => CellMap::<3>::new(block, points).map(|m| measure::<3, 3, f64, _>(&m)),
        _ => None,
    }
}

fn of<const D: usize>(block: &MeshBlock, points: &[[f64; 3]], flat: bool) -> Option<Soundness> {
    let map = CellMap::<D>::new(block, points)?;
    let number = |e: usize| block.ids.get(e).copied().unwrap_or(e as u64);
    Some(look::<D>(&format!("{:?}", block.shape).to_lowercase(), &map, block.order, flat, &number))
}

/// Quality of the cells of the highest dimension.
pub fn soundness(mesh: &MeshFile) -> Soundness {
    let (top, flat) = (mesh.dimension(), is_flat(&mesh.points, mesh.dimension()));
    let blocks = mesh.blocks.iter().filter(|b| b.shape.dimension() == top);
    let parts = blocks.filter_map(|b| match top {
        1 => of::<1>(b, &mesh.points, flat),
        2 => of::<2>(b, &mesh.points, flat),
        3 => of::<3>(b, &mesh.points, flat),
        _ => None,
    });
    parts.fold(Soundness::default(), Soundness::and)
}

/// A note on nodes of a mesh that coincide and are not shared; none for grids of fields, whose cells have nodes of their own.
pub fn unshared(mesh: &MeshFile) -> Option<String> {
    let text = match mesh.dimension() {
        _ if mesh.format == Format::Vtu => None,
        2 if is_flat(&mesh.points, 2) => {
            mesh.cells::<2>(None).ok().and_then(|c| unshared_points(&c)).map(|u| unshared_text("the mesh", &u, &u.at))
        }
        3 => mesh.cells::<3>(None).ok().and_then(|c| unshared_points(&c)).map(|u| unshared_text("the mesh", &u, &u.at)),
        _ => None,
    };
    text.map(|text| format!("{text}; `run` warns of them (E023)"))
}

/// Kinds of cells, those of the highest dimension last.
pub fn cells(mesh: &MeshFile) -> Vec<CellsReport> {
    let mut all: Vec<(CellShape, usize, usize)> = Vec::new();
    for block in &mesh.blocks {
        match all.iter_mut().find(|(shape, order, _)| (*shape, *order) == (block.shape, block.order)) {
            Some((_, _, count)) => *count += block.ids.len(),
            None => all.push((block.shape, block.order, block.ids.len())),
        }
    }
    all.sort_unstable();
    all.into_iter().map(|(shape, order, count)| CellsReport { shape: format!("{shape:?}").to_lowercase(), order, count }).collect()
}

/// Number of nodes of a group.
fn nodes_of(mesh: &MeshFile, group: usize) -> usize {
    let mut nodes: Vec<u32> = mesh.blocks.iter().filter(|b| b.groups.contains(&group)).flat_map(|b| b.nodes.iter().copied()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes.len()
}

/// All groups; `sizes` holds the measure of every block.
pub fn groups(mesh: &MeshFile, sizes: &[Option<f64>]) -> Vec<GroupReport> {
    let places = places(mesh);
    let mut all: Vec<GroupReport> = mesh
        .groups
        .iter()
        .enumerate()
        .map(|(k, g)| GroupReport {
            dimension: g.dimension,
            number: g.number,
            name: g.name.clone(),
            cells: 0,
            nodes: nodes_of(mesh, k),
            measure: None,
            place: Some(g).filter(|g| g.dimension + 1 == mesh.dimension()).and_then(|g| places.get(&g.label()).cloned()),
        })
        .collect();
    for (block, size) in mesh.blocks.iter().zip(sizes) {
        for &g in &block.groups {
            if let Some(group) = all.get_mut(g) {
                group.cells += block.ids.len();
                if let Some(size) = size {
                    *group.measure.get_or_insert(0.0) += size;
                }
            }
        }
    }
    all
}
