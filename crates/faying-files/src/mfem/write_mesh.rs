//! Writes MFEM meshes of Lagrange elements.

use super::super::budget::Budget;
use super::super::handed::right_handed;
use super::super::{CellShape, FileError, Group, Limits, MeshBlock, MeshFile, Written};
use super::cells::{CORNERS, Cell, NONE, Skeleton};
use super::lagrange::{lattice, starts, unknown};
use super::write::{TEXT, element};
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;

/// Writes an "MFEM mesh v1.0" of the cells of the highest dimension and of the facets that are in a group.
///
/// Elements are right-handed. Order 1 is written with vertices, orders 2 and 3 with nodes (Quadratic, Cubic). A cell has the number of
/// its first group; names, further groups and cells of lower dimension are lost.
///
/// # Errors
/// [`FileError::Unsupported`] for mixed orders, order 4, order 3 in three dimensions, curved prisms and pyramids, and cells with one node
/// at two corners.
pub fn write_mesh(mesh: &MeshFile) -> Result<Written, FileError> {
    let mesh = &*right_handed(mesh);
    let d = mesh.dimension();
    if d == 0 {
        return Err(unsupported("an MFEM mesh without elements"));
    }
    let order = writable_order(mesh, d)?;
    let mut lost = Vec::new();
    let numbers = vertex_numbers(mesh, d);
    let attributes = attributes(mesh, d, &mut lost);
    let mut out = format!("MFEM mesh v1.0\n\ndimension\n{d}\n");
    let mut all = cells_and_facets(mesh, d, &numbers, &attributes)?;
    let cells: Vec<Cell> = all[0].iter().map(|(cell, _)| cell.clone()).collect();
    let mut budget = Budget::new(&Limits::default(), 0);
    let wanted = if order > 1 || !all[1].is_empty() { &cells[..] } else { &[] };
    let skeleton = Skeleton::new(wanted, HashMap::new(), &mut budget)?;
    let facets = all[1].len();
    all[1].retain(|(facet, _)| is_side(facet, &skeleton));
    if all[1].len() < facets {
        lost.push("facets that are no sides of the elements".to_string());
    }
    for (name, list) in ["elements", "boundary"].iter().zip(&all) {
        write!(out, "\n{name}\n{}\n", list.len()).expect(TEXT);
        for (cell, _) in list {
            element(&mut out, cell.attribute, cell.shape, cell.corners());
        }
    }
    let world = coordinates(mesh, d);
    write!(out, "\nvertices\n{}\n", numbers.len()).expect(TEXT);
    let points: Vec<usize> = if order == 1 {
        writeln!(out, "{world}").expect(TEXT);
        numbers.keys().copied().collect()
    } else {
        let name = if order == 2 { "Quadratic" } else { "Cubic" };
        write!(out, "\nnodes\nFiniteElementSpace\nFiniteElementCollection: {name}\nVDim: {world}\nOrdering: 1\n\n").expect(TEXT);
        nodes_in_order(&all[0], order, numbers.len(), &skeleton)?
    };
    for p in points {
        let p = &mesh.points[p][..world];
        writeln!(out, "{}", p.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ")).expect(TEXT);
    }
    if mesh.blocks.iter().any(|b| b.shape.dimension() + 1 < d) {
        lost.push("cells of lower dimension than the facets".to_string());
    }
    if mesh.blocks.iter().any(|b| b.groups.len() > 1) {
        lost.push("all groups of a cell but the first".to_string());
    }
    if mesh.blocks.iter().any(|b| b.shape.dimension() + 1 == d && b.groups.is_empty()) {
        lost.push("facets in no group".to_string());
    }
    Ok(Written { text: out, lost })
}

/// [`FileError::Unsupported`] of a mesh as a whole.
fn unsupported(what: impl Into<String>) -> FileError {
    FileError::Unsupported { what: what.into(), spot: None }
}

/// The order of all elements and facets.
///
/// # Errors
/// [`FileError::Unsupported`] for mixed orders and those that are not written.
fn writable_order(mesh: &MeshFile, d: usize) -> Result<usize, FileError> {
    let order = mesh.blocks.iter().filter(|b| b.shape.dimension() == d).map(|b| b.order).max().unwrap_or(1);
    for block in mesh.blocks.iter().filter(|b| b.shape.dimension() + 1 >= d && b.shape != CellShape::Point) {
        if block.order != order {
            return Err(unsupported(format!("an MFEM mesh of the orders {} and {order}", block.order)));
        }
        let wedge = matches!(block.shape, CellShape::Prism | CellShape::Pyramid);
        if order > 3 || (order == 3 && d == 3) || (order > 1 && wedge) {
            return Err(unsupported(format!("a {:?} of order {order} in an MFEM mesh that is written", block.shape)));
        }
    }
    Ok(order)
}

/// Number of the vertex at every node that is a corner of an element.
fn vertex_numbers(mesh: &MeshFile, d: usize) -> BTreeMap<usize, u32> {
    let mut numbers: BTreeMap<usize, u32> = BTreeMap::new();
    for block in mesh.blocks.iter().filter(|b| b.shape.dimension() == d) {
        for nodes in block.nodes.chunks_exact(per_cell(block)) {
            numbers.extend(corners(block, nodes).map(|n| (n as usize, 0)));
        }
    }
    for (k, number) in numbers.values_mut().enumerate() {
        *number = k as u32;
    }
    numbers
}

/// Cells with their nodes.
type Listed<'a> = Vec<(Cell, &'a [u32])>;

/// The elements, and the facets in a group.
///
/// # Errors
/// [`FileError::Unsupported`] for facets off the elements and cells with one node at two corners.
fn cells_and_facets<'a>(
    mesh: &'a MeshFile,
    d: usize,
    numbers: &BTreeMap<usize, u32>,
    attributes: &[i64],
) -> Result<[Listed<'a>; 2], FileError> {
    let mut all: [Listed<'a>; 2] = [Vec::new(), Vec::new()];
    for block in &mesh.blocks {
        let at = d - block.shape.dimension();
        if at > 1 || (at == 1 && block.groups.is_empty()) {
            continue;
        }
        let attribute = block.groups.first().map_or(1, |g| attributes[*g]);
        for nodes in block.nodes.chunks_exact(per_cell(block)) {
            let mut vertices = [NONE; 8];
            for (slot, node) in vertices.iter_mut().zip(corners(block, nodes)) {
                match numbers.get(&(node as usize)) {
                    Some(v) => *slot = *v,
                    None => return Err(unsupported("an MFEM mesh with facets off its elements")),
                }
            }
            let cell = Cell { attribute, shape: block.shape, vertices, line: 0 };
            let corners = cell.corners();
            if corners.iter().enumerate().any(|(k, v)| corners[..k].contains(v)) {
                return Err(unsupported(format!("an MFEM mesh of cells with one node at two corners: {nodes:?}")));
            }
            all[at].push((cell, nodes));
        }
    }
    Ok(all)
}

/// Number of coordinates that the points need, at least `d`.
fn coordinates(mesh: &MeshFile, d: usize) -> usize {
    let flat = mesh.points.iter().all(|p| p[2] == 0.0);
    let line = flat && mesh.points.iter().all(|p| p[1] == 0.0);
    if d == 1 && line {
        1
    } else if d <= 2 && flat {
        2
    } else {
        3
    }
}

/// Nodes of a cell of a block.
fn per_cell(block: &MeshBlock) -> usize {
    match block.shape {
        CellShape::Prism => 6,
        CellShape::Pyramid => 5,
        shape => lattice(shape, block.order).len(),
    }
}

/// Nodes at the corners of a cell, in MFEM's order.
fn corners<'a>(block: &MeshBlock, nodes: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
    let n = block.order;
    let tensor = matches!(block.shape, CellShape::Line | CellShape::Quadrilateral | CellShape::Hexahedron);
    let count = match block.shape {
        CellShape::Point => 1,
        CellShape::Line => 2,
        CellShape::Triangle => 3,
        CellShape::Quadrilateral | CellShape::Tetrahedron => 4,
        CellShape::Hexahedron => 8,
        CellShape::Prism => 6,
        CellShape::Pyramid => 5,
    };
    let place = move |k: usize| match count {
        // A tetrahedron's last node is its last corner; the first triangle of nodes has the others.
        3 | 4 if !tensor => [0, n, (n + 1) * (n + 2) / 2 - 1, (n + 1) * (n + 2) * (n + 3) / 6 - 1][k],
        _ if tensor => {
            let bits = CORNERS[k];
            n * (bits & 1) + n * (n + 1) * (bits >> 1 & 1) + n * (n + 1) * (n + 1) * (bits >> 2)
        }
        _ => k,
    };
    (0..count).map(move |k| nodes[place(k)])
}

/// Whether a facet is a side of a cell, so that all its unknowns are known.
fn is_side(facet: &Cell, skeleton: &Skeleton) -> bool {
    match facet.corners() {
        [a, b] => skeleton.edge(*a, *b).is_some(),
        [a, b, c] => skeleton.face([*a, *b, *c, NONE]).is_some(),
        [a, b, c, d] => skeleton.face([*a, *b, *c, *d]).is_some(),
        _ => true,
    }
}

/// Number of every group in the written file: its own if that is positive.
fn attributes(mesh: &MeshFile, d: usize, lost: &mut Vec<String>) -> Vec<i64> {
    let used = |g: &Group| g.dimension + 1 >= d;
    let mut next: BTreeMap<usize, i64> = BTreeMap::new();
    for group in &mesh.groups {
        let most = next.entry(group.dimension).or_insert(0);
        *most = group.number.max(*most);
    }
    let mut all = Vec::new();
    for group in &mesh.groups {
        let mut number = group.number;
        if number <= 0 {
            let most = next.entry(group.dimension).or_insert(0);
            *most = most.saturating_add(1);
            number = *most;
        }
        if used(group) && (group.name.is_some() || number != group.number) {
            lost.push(format!("the label \"{}\" of a group of dimension {}: it has the number {number}", group.label(), group.dimension));
        }
        all.push(number);
    }
    all
}

/// The points in the order of MFEM's unknowns.
fn nodes_in_order(list: &[(Cell, &[u32])], order: usize, num_vertices: usize, skeleton: &Skeleton) -> Result<Vec<usize>, FileError> {
    let cells: Vec<Cell> = list.iter().map(|(cell, _)| cell.clone()).collect();
    let mut budget = Budget::new(&Limits::default(), 0);
    let starts = starts(num_vertices, &cells, skeleton, order, &mut budget)?;
    let mut points = vec![usize::MAX; starts.total];
    for (k, (cell, nodes)) in list.iter().enumerate() {
        for (index, node) in lattice(cell.shape, order).iter().zip(*nodes) {
            let place = unknown(cell, order, index, skeleton, &starts, Some(starts.cells[k])).expect("the skeleton is that of the cells");
            let known = &mut points[place];
            if *known != usize::MAX && *known != *node as usize {
                return Err(unsupported("an MFEM mesh whose neighbours have different nodes on a common edge or face"));
            }
            *known = *node as usize;
        }
    }
    Ok(points)
}
