//! The elements of MFEM files and the numbering of their vertices, edges, faces and interiors.
//!
//! MFEM numbers unknowns vertex by vertex, then edge by edge, face by face and cell by cell. Edges and faces are numbered in order of
//! first appearance, unless the file numbers the edges. Along an edge the unknowns run from the lower vertex to the higher one; within a
//! face they run as in the cell where it first appeared.
//! Source: MFEM, `fem/geom.cpp` (edges and faces of the cells), `mesh/nurbs.hpp` (order within a patch).

use super::super::budget::Budget;
use super::super::text::{Words, broken, unsupported};
use super::super::{CellShape, FileError};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Marks an unused vertex: cells have up to eight.
pub(super) const NONE: u32 = u32::MAX;

/// An element of a file.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// Its attribute.
    pub attribute: i64,
    /// Its shape.
    pub shape: CellShape,
    /// Its vertices in the order of the file; [`NONE`] beyond.
    pub vertices: [u32; 8],
    /// Its line in the file.
    pub line: usize,
}

/// Edges of the cells.
fn edges(shape: CellShape) -> &'static [[usize; 2]] {
    match shape {
        CellShape::Line => &[[0, 1]],
        CellShape::Triangle => &[[0, 1], [1, 2], [2, 0]],
        CellShape::Quadrilateral => &[[0, 1], [1, 2], [2, 3], [3, 0]],
        CellShape::Tetrahedron => &[[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]],
        CellShape::Hexahedron => &[[0, 1], [1, 2], [3, 2], [0, 3], [4, 5], [5, 6], [7, 6], [4, 7], [0, 4], [1, 5], [2, 6], [3, 7]],
        CellShape::Prism => &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
        CellShape::Pyramid => &[[0, 1], [1, 2], [3, 2], [0, 3], [0, 4], [1, 4], [2, 4], [3, 4]],
        CellShape::Point => &[],
    }
}

/// Faces of the cells of three dimensions, as cycles.
fn faces(shape: CellShape) -> &'static [&'static [usize]] {
    match shape {
        CellShape::Tetrahedron => &[&[1, 2, 3], &[0, 3, 2], &[0, 1, 3], &[0, 2, 1]],
        CellShape::Hexahedron => &[&[3, 2, 1, 0], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7], &[4, 5, 6, 7]],
        CellShape::Prism => &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
        CellShape::Pyramid => &[&[3, 2, 1, 0], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
        _ => &[],
    }
}

/// Corner b of the unit cube (bit k of b: coordinate k) among the vertices of a line, square or cube.
pub(super) const CORNERS: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

impl Cell {
    /// Vertices in use.
    pub(super) fn corners(&self) -> &[u32] {
        let count = self.vertices.iter().position(|v| *v == NONE).unwrap_or(8);
        &self.vertices[..count]
    }

    /// The vertex at a corner of the unit line, square or cube.
    pub(super) fn corner(&self, bits: usize) -> u32 {
        self.vertices[CORNERS[bits]]
    }
}

/// Reads a list of elements with the attributes before them.
///
/// # Errors
/// [`FileError`] for what is no element.
pub(super) fn read(words: &mut Words<'_>, what: &str, budget: &mut Budget) -> Result<Vec<Cell>, FileError> {
    let count = words.count(what, 3)?;
    budget.items(count, size_of::<Cell>())?;
    let mut cells = Vec::with_capacity(count);
    for _ in 0..count {
        let line = words.line();
        let attribute = words.int("an attribute")?;
        let (shape, corners) = match words.int("the type of an element")? {
            0 => (CellShape::Point, 1),
            1 => (CellShape::Line, 2),
            2 => (CellShape::Triangle, 3),
            3 => (CellShape::Quadrilateral, 4),
            4 => (CellShape::Tetrahedron, 4),
            5 => (CellShape::Hexahedron, 8),
            6 => (CellShape::Prism, 6),
            7 => (CellShape::Pyramid, 5),
            other => return Err(unsupported(line, format!("an element of type {other}"))),
        };
        let mut vertices = [NONE; 8];
        for k in 0..corners {
            let vertex = words.index("a vertex")?;
            vertices[k] = u32::try_from(vertex)
                .ok()
                .filter(|v| *v != NONE)
                .ok_or_else(|| broken(line, format!("vertex {vertex} is too large a number")))?;
            if vertices[..k].contains(&vertices[k]) {
                return Err(broken(line, format!("an element has the vertex {vertex} twice")));
            }
        }
        cells.push(Cell { attribute, shape, vertices, line });
    }
    Ok(cells)
}

/// Checks that the vertices of the cells are below `count`.
///
/// # Errors
/// [`FileError::Broken`] with the line of the element.
pub(super) fn check_vertices(cells: &[Cell], count: usize) -> Result<(), FileError> {
    for cell in cells {
        if let Some(v) = cell.corners().iter().find(|v| **v as usize >= count) {
            return Err(broken(cell.line, format!("an element has the vertex {v}; there are {count} vertices, counted from 0")));
        }
    }
    Ok(())
}

/// A face: its number and the cycle of vertices of the cell where it first appeared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub number: usize,
    pub cycle: [u32; 4],
}

/// Numbers of the edges and faces.
#[derive(Debug, Default)]
pub(super) struct Skeleton {
    /// Number of an edge by its vertices, the lower first.
    edges: HashMap<[u32; 2], usize>,
    /// Faces by their vertices in rising order.
    faces: HashMap<[u32; 4], Face>,
    /// Corners of every face in the order of their numbers: 3 or 4.
    pub face_corners: Vec<u8>,
}

/// Most bytes an entry of a hash map takes while it grows.
const ENTRY: usize = 4;

fn key<const K: usize>(mut vertices: [u32; K]) -> [u32; K] {
    vertices.sort_unstable();
    vertices
}

impl Skeleton {
    /// Numbers the faces, and the edges unless the file lists them.
    ///
    /// # Errors
    /// [`FileError::Broken`] for a cell with an edge that the file does not list, [`FileError::Memory`].
    pub(super) fn new(cells: &[Cell], listed: HashMap<[u32; 2], usize>, budget: &mut Budget) -> Result<Self, FileError> {
        let complete = !listed.is_empty();
        let mut all = Self { edges: listed, ..Self::default() };
        for cell in cells {
            for [a, b] in edges(cell.shape) {
                let pair = key([cell.vertices[*a], cell.vertices[*b]]);
                let number = all.edges.len();
                if let Entry::Vacant(edge) = all.edges.entry(pair) {
                    if complete {
                        return Err(broken(cell.line, format!("the edge from {} to {} of an element is not listed", pair[0], pair[1])));
                    }
                    budget.items(ENTRY, size_of::<([u32; 2], usize)>())?;
                    edge.insert(number);
                }
            }
            for face in faces(cell.shape) {
                let mut cycle = [NONE; 4];
                for (slot, k) in cycle.iter_mut().zip(*face) {
                    *slot = cell.vertices[*k];
                }
                let number = all.faces.len();
                if let Entry::Vacant(side) = all.faces.entry(key(cycle)) {
                    budget.items(ENTRY, size_of::<([u32; 4], Face)>())?;
                    side.insert(Face { number, cycle });
                    all.face_corners.push(face.len() as u8);
                }
            }
        }
        Ok(all)
    }

    /// Number of edges.
    pub(super) fn num_edges(&self) -> usize {
        self.edges.len()
    }

    /// The number of an edge; `None` for one of no cell.
    pub(super) fn edge(&self, a: u32, b: u32) -> Option<usize> {
        self.edges.get(&key([a, b])).copied()
    }

    /// A face; `None` for one of no cell.
    pub(super) fn face(&self, vertices: [u32; 4]) -> Option<Face> {
        self.faces.get(&key(vertices)).copied()
    }
}

/// First unknown of every edge, face and cell.
#[derive(Debug)]
pub(super) struct Starts {
    /// First unknown of every edge.
    pub edges: Vec<usize>,
    /// First unknown of every face.
    pub faces: Vec<usize>,
    /// First interior unknown of every cell.
    pub cells: Vec<usize>,
    /// Number of unknowns.
    pub total: usize,
}

/// The unknown (i_0, i_1, i_2) of a line, square or cube with `counts` unknowns per direction; `None` for a cell of other edges.
///
/// On a boundary cell `start` is unused: its interior belongs to an edge or a face.
pub(super) fn tensor_unknown(
    cell: &Cell,
    counts: &[usize],
    index: &[usize],
    skeleton: &Skeleton,
    starts: &Starts,
    start: Option<usize>,
) -> Option<usize> {
    let dimension = counts.len();
    let mut bits = 0;
    let mut free = [0; 3];
    let mut num_free = 0;
    for k in 0..dimension {
        if index[k] + 1 == counts[k] {
            bits |= 1 << k;
        } else if index[k] > 0 {
            free[num_free] = k;
            num_free += 1;
        }
    }
    if num_free == 0 {
        return Some(cell.corner(bits) as usize);
    }
    if let (Some(start), true) = (start, num_free == dimension) {
        let interior = |k: usize| counts[k] - 2;
        return Some(match dimension {
            1 => start + index[0] - 1,
            2 => start + (index[0] - 1) + interior(0) * (index[1] - 1),
            _ => start + (index[0] - 1) + interior(0) * ((index[1] - 1) + interior(1) * (index[2] - 1)),
        });
    }
    if num_free == 1 {
        let d = free[0];
        let (a, b) = (cell.corner(bits), cell.corner(bits | 1 << d));
        let place = if a < b { index[d] - 1 } else { counts[d] - 2 - index[d] };
        return Some(starts.edges[skeleton.edge(a, b)?] + place);
    }
    let [d, e, _] = free;
    let corner = |x: usize, y: usize| cell.corner(bits | x << d | y << e);
    let face = skeleton.face([corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)])?;
    let [a, b, ..] = face.cycle;
    let origin = (0..4).find(|c| corner(c & 1, c >> 1) == a)?;
    let from = |k: usize, end: usize| if end == 0 { index[k] - 1 } else { counts[k] - 2 - index[k] };
    let (along_d, along_e) = (from(d, origin & 1), from(e, origin >> 1));
    let place =
        if corner((origin & 1) ^ 1, origin >> 1) == b { along_d + (counts[d] - 2) * along_e } else { along_e + (counts[e] - 2) * along_d };
    Some(starts.faces[face.number] + place)
}

/// The unknown of a triangle or tetrahedron with equispaced nodes of `order` at `index` / `order`; `None` for a cell of other edges.
///
/// On a boundary cell `start` is `None`: its interior belongs to a face.
pub(super) fn simplex_unknown(
    cell: &Cell,
    order: usize,
    index: &[usize],
    skeleton: &Skeleton,
    starts: &Starts,
    start: Option<usize>,
) -> Option<usize> {
    let mut parts = [(NONE, 0); 4];
    let mut count = 0;
    let first = order - index.iter().sum::<usize>();
    for (k, part) in std::iter::once(first).chain(index.iter().copied()).enumerate() {
        if part > 0 {
            parts[count] = (cell.vertices[k], part);
            count += 1;
        }
    }
    let part = |v: u32| parts.iter().find(|(w, _)| *w == v).map_or(0, |(_, p)| *p);
    // Rows of a triangle of inner nodes, the first coordinate fastest.
    let row = |i: usize, j: usize| (1..j).map(|k| order - 1 - k).sum::<usize>() + i - 1;
    match (count, start) {
        (1, _) => Some(parts[0].0 as usize),
        (2, _) => {
            let (a, b) = (parts[0].0, parts[1].0);
            Some(starts.edges[skeleton.edge(a, b)?] + part(a.max(b)) - 1)
        }
        (3, Some(start)) if index.len() == 2 => Some(start + row(index[0], index[1])),
        (3, _) => {
            let face = skeleton.face([parts[0].0, parts[1].0, parts[2].0, NONE])?;
            Some(starts.faces[face.number] + row(part(face.cycle[1]), part(face.cycle[2])))
        }
        // Up to order 4 a tetrahedron has one node inside.
        _ => start,
    }
}
