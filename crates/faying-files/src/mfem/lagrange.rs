//! MFEM meshes of Lagrange elements, straight or curved.

use super::super::budget::Budget;
use super::super::text::{Words, broken, unsupported};
use super::super::{CellShape, FileError, Format, Group, MeshBlock, MeshFile};
use super::cells::{self, Cell, Skeleton, Starts, simplex_unknown, tensor_unknown};
use super::{Field, dimension, end};
use nalgebra::DMatrix;
use std::collections::{BTreeMap, HashMap};

/// Highest order of curved cells.
const ORDER: usize = 4;

/// Reads the file after its first line.
///
/// # Errors
/// [`FileError`] with the line.
pub(super) fn parse(mut words: Words<'_>, budget: &mut Budget) -> Result<MeshFile, FileError> {
    let words = &mut words;
    let dimension = dimension(words)?;
    words.expect("elements")?;
    let elements = cells::read(words, "elements", budget)?;
    words.expect("boundary")?;
    let boundary = cells::read(words, "boundary elements", budget)?;
    words.expect("vertices")?;
    let line = words.line();
    let num_vertices = words.index("the number of vertices")?;
    for (list, expected) in [(&elements, dimension), (&boundary, dimension - 1)] {
        if let Some(cell) = list.iter().find(|c| c.shape.dimension() != expected) {
            return Err(broken(cell.line, format!("a {:?} among the elements of dimension {expected}", cell.shape)));
        }
    }
    if elements.is_empty() {
        return Err(broken(line, "the mesh has no element"));
    }
    cells::check_vertices(&elements, num_vertices)?;
    cells::check_vertices(&boundary, num_vertices)?;
    let lists = [&elements[..], &boundary[..]];
    let (order, points, nodes) = if words.accept("nodes") {
        curved(words, num_vertices, lists, budget)?
    } else {
        let at = words.line();
        let world = words.index("the number of coordinates")?;
        if !(1..=3).contains(&world) {
            return Err(broken(at, format!("points have 1 to 3 coordinates, found {world}")));
        }
        let field = Field { collection: String::new(), line: at, world, by_point: true };
        let points = field.points(words, num_vertices, budget)?;
        let nodes = lists.map(|list| list.iter().map(straight).collect());
        budget.items(elements.len() + boundary.len(), 9 * size_of::<u32>() + size_of::<Vec<u32>>())?;
        (1, points, nodes)
    };
    end(words)?;
    let mut groups = Vec::new();
    let mut blocks = Vec::new();
    for (list, nodes) in lists.into_iter().zip(nodes) {
        gather(list, nodes, order, &mut groups, &mut blocks, budget)?;
    }
    budget.items(points.len(), size_of::<u64>())?;
    let ids = (0..points.len() as u64).collect();
    Ok(MeshFile { format: Format::Mfem, points, ids, blocks, groups, notes: Vec::new() })
}

/// Nodes of a straight cell: its corners, the first axis fastest.
fn straight(cell: &Cell) -> Vec<u32> {
    match cell.shape {
        CellShape::Quadrilateral | CellShape::Hexahedron => (0..cell.corners().len()).map(|bits| cell.corner(bits)).collect(),
        _ => cell.corners().to_vec(),
    }
}

/// Sorts cells into blocks of one shape and attribute, in the order in which these appear.
fn gather(
    list: &[Cell],
    nodes: Vec<Vec<u32>>,
    order: usize,
    groups: &mut Vec<Group>,
    blocks: &mut Vec<MeshBlock>,
    budget: &mut Budget,
) -> Result<(), FileError> {
    let numbers: BTreeMap<i64, usize> = list.iter().map(|c| (c.attribute, c.shape.dimension())).collect();
    budget.items(numbers.len(), 4 * size_of::<Group>())?;
    let first = groups.len();
    groups.extend(numbers.iter().map(|(number, dimension)| Group { dimension: *dimension, number: *number, name: None }));
    let place: BTreeMap<i64, usize> = numbers.keys().enumerate().map(|(k, number)| (*number, first + k)).collect();
    let mut of: BTreeMap<(CellShape, i64), usize> = BTreeMap::new();
    for (k, (cell, nodes)) in list.iter().zip(nodes).enumerate() {
        let at = *of.entry((cell.shape, cell.attribute)).or_insert(blocks.len());
        if at == blocks.len() {
            budget.items(3, size_of::<MeshBlock>())?;
            let order = if cell.shape == CellShape::Point { 1 } else { order };
            blocks.push(MeshBlock { shape: cell.shape, order, nodes: Vec::new(), ids: Vec::new(), groups: vec![place[&cell.attribute]] });
        }
        budget.items(3, nodes.len() * size_of::<u32>() + size_of::<u64>())?;
        blocks[at].nodes.extend(nodes);
        blocks[at].ids.push(k as u64);
    }
    Ok(())
}

/// Number of interior nodes of a cell, or a face, of a shape.
fn inside(shape: CellShape, order: usize) -> usize {
    let m = order - 1;
    match shape {
        CellShape::Line => m,
        CellShape::Triangle => m * m.saturating_sub(1) / 2,
        CellShape::Quadrilateral => m * m,
        CellShape::Tetrahedron => m * m.saturating_sub(1) * m.saturating_sub(2) / 6,
        CellShape::Hexahedron => m * m * m,
        CellShape::Point | CellShape::Prism | CellShape::Pyramid => 0,
    }
}

/// Lattice of the nodes of a line, square, cube or simplex: multi-indices, the first axis fastest.
pub(super) fn lattice(shape: CellShape, order: usize) -> Vec<[usize; 3]> {
    let dimension = shape.dimension();
    let simplex = matches!(shape, CellShape::Triangle | CellShape::Tetrahedron);
    let side = |d: usize| if d < dimension { order } else { 0 };
    let mut all = Vec::new();
    for k in 0..=side(2) {
        for j in 0..=side(1) {
            all.extend((0..=side(0)).map(|i| [i, j, k]).filter(|x| !simplex || x.iter().sum::<usize>() <= order));
        }
    }
    all
}

/// Distribution of the nodes of a field within the cells.
#[derive(Clone, Copy, PartialEq)]
enum Spread {
    /// At i / order.
    Equal,
    /// At the Gauss-Lobatto points.
    Lobatto,
}

/// The order and the spread of a collection.
fn collection(field: &Field) -> Result<(usize, Spread), FileError> {
    let name = field.collection.as_str();
    match name {
        "Linear" => return Ok((1, Spread::Equal)),
        "Quadratic" => return Ok((2, Spread::Equal)),
        "Cubic" => return Ok((3, Spread::Equal)),
        _ => {}
    }
    let order = name.strip_prefix("H1_").and_then(|n| n.split_once("D_P")).and_then(|(_, p)| p.parse::<usize>().ok());
    match order {
        Some(order @ 1..=2) => Ok((order, Spread::Equal)),
        Some(order @ 3..=ORDER) => Ok((order, Spread::Lobatto)),
        Some(order) => Err(unsupported(field.line, format!("geometry of order {order}; orders are 1 to {ORDER}: {name}"))),
        None if name.starts_with("L2_") => Err(unsupported(field.line, format!("a geometry that is not continuous: {name}"))),
        None => Err(unsupported(field.line, format!("a geometry of {name}"))),
    }
}

/// Unknown of a cell at a multi-index of its lattice; `start` is that of its interior unless it is a boundary element.
pub(super) fn unknown(
    cell: &Cell,
    order: usize,
    index: &[usize; 3],
    skeleton: &Skeleton,
    starts: &Starts,
    start: Option<usize>,
) -> Option<usize> {
    let index = &index[..cell.shape.dimension()];
    match cell.shape {
        CellShape::Point => Some(cell.vertices[0] as usize),
        CellShape::Triangle | CellShape::Tetrahedron => simplex_unknown(cell, order, index, skeleton, starts, start),
        _ => tensor_unknown(cell, &[order + 1; 3][..index.len()], index, skeleton, starts, start),
    }
}

type Curved = (usize, Vec<[f64; 3]>, [Vec<Vec<u32>>; 2]);

/// Points and nodes of curved cells.
fn curved(words: &mut Words<'_>, num_vertices: usize, lists: [&[Cell]; 2], budget: &mut Budget) -> Result<Curved, FileError> {
    let field = Field::read(words)?;
    let (order, spread) = collection(&field)?;
    for cell in lists.into_iter().flatten() {
        let other = match cell.shape {
            CellShape::Prism | CellShape::Pyramid => order > 1,
            CellShape::Hexahedron => field.collection == "Cubic",
            _ => false,
        };
        if other {
            return Err(unsupported(cell.line, format!("a {:?} of {}", cell.shape, field.collection)));
        }
    }
    let skeleton = Skeleton::new(lists[0], HashMap::new(), budget)?;
    let starts = starts(num_vertices, lists[0], &skeleton, order, budget)?;
    let mut points = field.points(words, starts.total, budget)?;
    let dimension = lists[0][0].shape.dimension();
    let mut lattices: BTreeMap<CellShape, Vec<[usize; 3]>> = BTreeMap::new();
    let mut nodes = [Vec::new(), Vec::new()];
    for (list, nodes) in lists.into_iter().zip(&mut nodes) {
        for (k, cell) in list.iter().enumerate() {
            let lattice = lattices.entry(cell.shape).or_insert_with(|| lattice(cell.shape, order));
            let start = (cell.shape.dimension() == dimension).then(|| starts.cells[k]);
            let one = |index: &[usize; 3]| unknown(cell, order, index, &skeleton, &starts, start);
            budget.items(1, lattice.len() * size_of::<u32>() + 2 * size_of::<Vec<u32>>())?;
            let all: Option<Vec<u32>> = match cell.shape {
                CellShape::Prism | CellShape::Pyramid => Some(cell.corners().to_vec()),
                _ => lattice.iter().map(|i| one(i).and_then(|n| u32::try_from(n).ok())).collect(),
            };
            nodes.push(all.ok_or_else(|| broken(cell.line, "a boundary element is no side of an element"))?);
        }
    }
    if spread == Spread::Lobatto {
        points = equispaced(&points, lists[0], &nodes[0], order, budget)?;
    }
    Ok((order, points, nodes))
}

pub(super) fn starts(
    num_vertices: usize,
    list: &[Cell],
    skeleton: &Skeleton,
    order: usize,
    budget: &mut Budget,
) -> Result<Starts, FileError> {
    let cells = list.len();
    let plane = list[0].shape.dimension() > 1;
    let num_edges = if plane { skeleton.num_edges() } else { 0 };
    budget.items(num_edges + skeleton.face_corners.len() + cells, size_of::<usize>())?;
    let mut total = num_vertices;
    let mut next = |count: usize| {
        let start = total;
        total = total.saturating_add(count);
        start
    };
    let edges = (0..num_edges).map(|_| next(order - 1)).collect();
    let face = |corners: &u8| if *corners == 3 { CellShape::Triangle } else { CellShape::Quadrilateral };
    let faces = skeleton.face_corners.iter().map(|c| next(inside(face(c), order))).collect();
    let cells = list.iter().map(|c| next(inside(c.shape, order))).collect();
    Ok(Starts { edges, faces, cells, total })
}

/// Gauss-Lobatto points of an order on \[0, 1\].
fn lobatto(order: usize) -> Vec<f64> {
    let inner = if order == 3 { vec![0.2f64.sqrt()] } else { vec![(3.0f64 / 7.0).sqrt(), 0.0] };
    let mut all = vec![0.0];
    all.extend(inner.iter().map(|x| 0.5 - 0.5 * x));
    all.extend(inner.iter().rev().filter(|x| **x != 0.0).map(|x| 0.5 + 0.5 * x));
    all.push(1.0);
    all
}

/// Converts the nodes of the cells from Gauss-Lobatto points to points at i / order.
///
/// A point of a side is computed in the first cell that has it; the others would give the same, as the nodes are symmetric.
fn equispaced(
    points: &[[f64; 3]],
    list: &[Cell],
    nodes: &[Vec<u32>],
    order: usize,
    budget: &mut Budget,
) -> Result<Vec<[f64; 3]>, FileError> {
    budget.items(points.len(), size_of::<[f64; 3]>() + 1)?;
    let mut moved = points.to_vec();
    let mut done = vec![false; points.len()];
    let mut maps: BTreeMap<CellShape, DMatrix<f64>> = BTreeMap::new();
    for (cell, nodes) in list.iter().zip(nodes) {
        let map = maps.entry(cell.shape).or_insert_with(|| transfer(cell.shape, order));
        for (row, node) in nodes.iter().enumerate() {
            let node = *node as usize;
            if done[node] {
                continue;
            }
            done[node] = true;
            moved[node] = std::array::from_fn(|d| nodes.iter().enumerate().map(|(k, n)| map[(row, k)] * points[*n as usize][d]).sum());
        }
    }
    Ok(moved)
}

/// Values at i / order of the Lagrange functions of the Gauss-Lobatto points, which on simplices are l_i / sum(l).
fn transfer(shape: CellShape, order: usize) -> DMatrix<f64> {
    let line = lobatto(order);
    let lattice = lattice(shape, order);
    let simplex = matches!(shape, CellShape::Triangle | CellShape::Tetrahedron);
    let n = lattice.len();
    if !simplex {
        let value = |k: usize, x: f64| (0..=order).filter(|j| *j != k).map(|j| (x - line[j]) / (line[k] - line[j])).product::<f64>();
        let dimension = shape.dimension();
        let entry = |r: usize, c: usize| (0..dimension).map(|d| value(lattice[c][d], lattice[r][d] as f64 / order as f64)).product();
        return DMatrix::from_fn(n, n, entry);
    }
    let lobatto = |i: &[usize; 3]| {
        let rest = order - i.iter().sum::<usize>();
        // On a side the index that is zero does not contribute: its point of the line is zero.
        let sum: f64 = i.iter().chain([&rest]).map(|k| line[*k]).sum();
        i.map(|k| line[k] / sum)
    };
    let monomial = |x: &[f64; 3], e: &[usize; 3]| (0..3).map(|d| x[d].powi(e[d] as i32)).product::<f64>();
    let from = DMatrix::from_fn(n, n, |r, c| monomial(&lobatto(&lattice[r]), &lattice[c]));
    let to = DMatrix::from_fn(n, n, |r, c| monomial(&lattice[r].map(|i| i as f64 / order as f64), &lattice[c]));
    // to * from^-1, by the transposes
    let solved = from.transpose().lu().solve(&to.transpose()).expect("Lobatto nodes are unisolvent");
    solved.transpose()
}
