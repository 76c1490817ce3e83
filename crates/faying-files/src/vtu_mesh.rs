//! Conversion of meshes from and to VTK grids: linear and quadratic cells, and Lagrange cells with equispaced nodes.

use super::budget::Budget;
use super::gmsh::lexicographic;
use super::handed::right_handed;
use super::serendipity::{Completion, MISSING};
use super::vtu_read::{VtuField, VtuFile};
use super::{CellShape, FileError, Format, Group, Limits, MeshBlock, MeshFile};
use crate::vtu;
use faying::basis::Cell;
use std::collections::{BTreeMap, HashMap};

/// Highest order of a mesh's cells.
const MAX_ORDER: usize = 4;

/// Distance, relative to the size of the grid, below which points of elements that do not share points are merged.
const SAME: f64 = 1e-10;

/// Limit of the entries of the arrays that assign cells to groups.
const MAX_MEMBERS: usize = 1 << 28;

/// Version from which Lagrange hexahedra have the present order of nodes: 2.1.
const HEXAHEDRA: u32 = 201;

/// Prefix of the names of cell arrays that mark a group: `group DIMENSION NUMBER NAME`.
const GROUP: &str = "group ";

/// Shape, VTK's linear type, its Lagrange type and the cell of the node order.
const SHAPES: [(CellShape, u8, Option<(u8, Cell)>); 8] = [
    (CellShape::Point, 1, None),
    (CellShape::Line, 3, Some((68, Cell::Tensor))),
    (CellShape::Triangle, 5, Some((69, Cell::Simplex))),
    (CellShape::Quadrilateral, 9, Some((70, Cell::Tensor))),
    (CellShape::Tetrahedron, 10, Some((71, Cell::Simplex))),
    (CellShape::Hexahedron, 12, Some((72, Cell::Tensor))),
    (CellShape::Prism, 13, None),
    (CellShape::Pyramid, 14, None),
];

/// Other types of VTK: cells of order 2, whose nodes stand in the order of Lagrange cells, complete ones and those without the nodes inside
/// faces; and pixels and voxels, whose nodes stand with the first axis fastest.
const OTHERS: [(u8, CellShape, Stored); 9] = [
    (8, CellShape::Quadrilateral, Stored::Lattice),
    (11, CellShape::Hexahedron, Stored::Lattice),
    (21, CellShape::Line, Stored::Order2),
    (22, CellShape::Triangle, Stored::Order2),
    (23, CellShape::Quadrilateral, Stored::Incomplete),
    (24, CellShape::Tetrahedron, Stored::Order2),
    (25, CellShape::Hexahedron, Stored::Incomplete),
    (28, CellShape::Quadrilateral, Stored::Order2),
    (29, CellShape::Hexahedron, Stored::Order2),
];

/// Storage of the nodes of a cell in a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stored {
    Linear,
    Lagrange,
    Lattice,
    Order2,
    Incomplete,
}

/// The shape of a type of VTK.
fn shape_of(kind: u8) -> Option<(CellShape, Stored)> {
    let usual = SHAPES.iter().find_map(|s| match s.2 {
        _ if s.1 == kind => Some((s.0, Stored::Linear)),
        Some((lagrange, _)) if lagrange == kind => Some((s.0, Stored::Lagrange)),
        _ => None,
    });
    usual.or_else(|| OTHERS.iter().find(|o| o.0 == kind).map(|o| (o.1, o.2)))
}

/// Position of VTK's a-th node in the list with the first axis fastest.
pub(super) fn places(shape: CellShape, order: usize) -> Vec<usize> {
    let pad = |list: Vec<Vec<usize>>| -> Vec<[usize; 3]> {
        list.iter().map(|a| std::array::from_fn(|k| a.get(k).copied().unwrap_or(0))).collect()
    };
    let cell = if matches!(shape, CellShape::Triangle | CellShape::Tetrahedron) { Cell::Simplex } else { Cell::Tensor };
    let vtk = match shape {
        CellShape::Point => return vec![0],
        CellShape::Prism => return (0..6).collect(),
        CellShape::Pyramid => return (0..5).collect(),
        CellShape::Line => pad(vtu::cells::nodes(cell, [order]).iter().map(|a| a.to_vec()).collect()),
        CellShape::Triangle | CellShape::Quadrilateral => pad(vtu::cells::nodes(cell, [order; 2]).iter().map(|a| a.to_vec()).collect()),
        CellShape::Tetrahedron | CellShape::Hexahedron => pad(vtu::cells::nodes(cell, [order; 3]).iter().map(|a| a.to_vec()).collect()),
    };
    let sorted = lexicographic(shape, order);
    vtk.iter().map(|a| sorted.iter().position(|b| b == a).expect("a node of the cell")).collect()
}

impl VtuFile {
    /// The mesh of linear and quadratic cells and Lagrange cells of order 1 to 4, one order in all directions of a cell. Quadratic
    /// quadrilaterals and hexahedra without nodes inside faces get them where their own map has them.
    ///
    /// Groups are the arrays of [`write_vtu`], else the field `patch`: a group for each of its values, its number that value plus one, with
    /// the name of the patch where the file has it. The elements that this program writes share points only if all data agree; coincident points of one patch are merged. Fields are not
    /// kept.
    ///
    /// # Errors
    /// [`FileError::Unsupported`] for Bezier and other cells, and for Lagrange hexahedra of files older than version 2.1, whose nodes are
    /// in another order.
    pub fn mesh(&self) -> Result<MeshFile, FileError> {
        let mut notes = Vec::new();
        let fields: Vec<&str> = self.point_fields.iter().map(|f| f.name.as_str()).collect();
        if !fields.is_empty() {
            notes.push(format!("fields at points are not kept: {}", fields.join(", ")));
        }
        let patch = self.cell_fields.iter().find(|f| f.name == "patch" && f.components == 1);
        let (mut points, place) = match patch.filter(|_| self.cell_fields.iter().any(|f| f.name == "element")) {
            Some(patch) => {
                notes.push("points of one patch at the same place are made one".into());
                self.welded(patch)
            }
            None => (self.points.clone(), (0..self.points.len() as u32).collect()),
        };
        let (groups, members) = self.groups(patch);
        let numbers = self.cell_fields.iter().find(|f| f.name == "id" && f.components == 1);
        let degrees = self.cell_fields.iter().find(|f| f.name == "HigherOrderDegrees" && f.components == 3);
        let mut orders: BTreeMap<(CellShape, usize, bool), Vec<usize>> = BTreeMap::new();
        let (mut completion, mut budget) = (Completion::default(), Budget::new(&Limits::default(), 0));
        let mut blocks: BTreeMap<(CellShape, usize, Vec<usize>), MeshBlock> = BTreeMap::new();
        for (k, kind) in self.types.iter().enumerate() {
            let unsupported = |why: &str| {
                let what = format!("cell {k}, a {} (VTK type {kind}), {why}", super::vtu_read::type_name(*kind));
                FileError::Unsupported { what, spot: None }
            };
            let Some((shape, stored)) = shape_of(*kind) else {
                return Err(unsupported("as a cell of a mesh (linear, quadratic and Lagrange cells are read)"));
            };
            let nodes = self.cell(k);
            let order = match stored {
                Stored::Linear | Stored::Lattice => 1,
                Stored::Order2 | Stored::Incomplete => 2,
                Stored::Lagrange => {
                    let of_count = (1..=MAX_ORDER).find(|p| lexicographic_count(shape, *p) == nodes.len());
                    let own = degrees.map(|d| &d.values[3 * k..3 * k + shape.dimension()]);
                    match own.map_or(of_count, |d| of_count.filter(|p| d.iter().all(|v| *v == *p as f64))) {
                        Some(p) => p,
                        None => return Err(unsupported("of an order above 4 or of several orders")),
                    }
                }
            };
            if stored == Stored::Lagrange && shape == CellShape::Hexahedron && order > 1 && self.version < HEXAHEDRA {
                return Err(unsupported("in a file older than version 2.1, whose nodes have another order"));
            }
            let places = orders.entry((shape, order, stored == Stored::Lattice)).or_insert_with(|| match stored {
                Stored::Lattice => (0..lexicographic_count(shape, 1)).collect(),
                _ => places(shape, order),
            });
            let expected = match stored {
                Stored::Incomplete if shape == CellShape::Quadrilateral => 8,
                Stored::Incomplete => 20,
                _ => places.len(),
            };
            if expected != nodes.len() {
                let what = format!("cell {k} has {} points, a {} has {expected}", nodes.len(), super::vtu_read::type_name(*kind));
                return Err(FileError::Broken { what, spot: None });
            }
            let own: Vec<usize> = members.iter().filter(|(_, field, value)| field.values[k] == *value).map(|m| m.0).collect();
            let own: Vec<usize> = own.into_iter().filter(|g| groups[*g].dimension == shape.dimension()).collect();
            let block = blocks.entry((shape, order, own)).or_insert_with_key(|key| MeshBlock {
                shape,
                order,
                nodes: Vec::new(),
                ids: Vec::new(),
                groups: key.2.clone(),
            });
            let first = block.nodes.len();
            block.nodes.resize(first + places.len(), MISSING);
            nodes.iter().zip(places.iter()).for_each(|(n, p)| block.nodes[first + *p] = place[*n as usize]);
            if stored == Stored::Incomplete {
                completion.complete(shape, &mut block.nodes[first..], &mut points, &mut budget)?;
            }
            block.ids.push(numbers.map_or(k as u64 + 1, |f| f.values[k].max(1.0) as u64));
        }
        let ids = (1..=points.len() as u64).collect();
        Ok(MeshFile { format: Format::Vtu, points, ids, blocks: blocks.into_values().collect(), groups, notes })
    }

    /// Groups, and for each group the field and the value that mark its cells.
    fn groups<'a>(&'a self, patch: Option<&'a VtuField>) -> (Vec<Group>, Vec<(usize, &'a VtuField, f64)>) {
        let mut found: Vec<(Group, &VtuField, f64)> = Vec::new();
        for field in self.cell_fields.iter().filter(|f| f.components == 1) {
            let Some(rest) = field.name.strip_prefix(GROUP) else { continue };
            let mut words = rest.splitn(3, ' ');
            let numbers = (words.next().and_then(|w| w.parse().ok()), words.next().and_then(|w| w.parse().ok()));
            if let (Some(dimension @ 0..=3), Some(number)) = numbers {
                found.push((Group { dimension, number, name: words.next().map(str::to_owned) }, field, 1.0));
            }
        }
        if let Some(patch) = patch.filter(|_| found.is_empty()) {
            let dimension_of = |kind: &u8| shape_of(*kind).map(|s| s.0.dimension());
            let name_of = |v: i64| self.patches.iter().find(|p| p.0 == v).map(|p| p.1.clone());
            let mut values: Vec<(usize, i64)> = Vec::new();
            for (kind, v) in self.types.iter().zip(&patch.values) {
                let entry = dimension_of(kind).map(|d| (d, *v as i64));
                if entry.is_some_and(|e| values.last() != Some(&e)) {
                    values.extend(entry);
                }
            }
            values.sort_unstable();
            values.dedup();
            // every group is compared with every cell; a field of so many values is no patch number
            if values.len() <= 64 {
                found = values
                    .iter()
                    .map(|(dimension, v)| {
                        (Group { dimension: *dimension, number: v.saturating_add(1), name: name_of(*v) }, patch, *v as f64)
                    })
                    .collect();
            }
        }
        found.sort_by_key(|a| (a.0.dimension, a.0.number));
        let members = found.iter().enumerate().map(|(k, f)| (k, f.1, f.2)).collect();
        (found.into_iter().map(|f| f.0).collect(), members)
    }

    /// Points with coincident ones of one patch merged, and the new index of each.
    fn welded(&self, patch: &VtuField) -> (Vec<[f64; 3]>, Vec<u32>) {
        let mut owner = vec![0i64; self.points.len()];
        for k in 0..self.types.len() {
            self.cell(k).iter().for_each(|n| owner[*n as usize] = patch.values[k] as i64);
        }
        let range = |i: usize| self.points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |r, x| [r[0].min(x[i]), r[1].max(x[i])]);
        let size = (0..3).map(range).map(|r| r[1] - r[0]).fold(0.0, f64::max);
        let close = SAME * size.max(f64::MIN_POSITIVE);
        // boxes four times as wide as the distance: a point near a face is also searched in the next box
        let wide = 4.0 * close;
        let mut boxes: HashMap<(i64, [i64; 3]), Vec<u32>> = HashMap::new();
        let (mut points, mut place): (Vec<[f64; 3]>, Vec<u32>) = (Vec::new(), Vec::new());
        for (x, owner) in self.points.iter().zip(&owner) {
            let home = x.map(|x| (x / wide).floor() as i64);
            let low = x.map(|x| ((x - close) / wide).floor() as i64);
            let high = x.map(|x| ((x + close) / wide).floor() as i64);
            let mut found = None;
            for c in 0..8 {
                let key: [i64; 3] = std::array::from_fn(|k| if c >> k & 1 == 0 { low[k] } else { high[k] });
                let near = boxes.get(&(*owner, key)).into_iter().flatten();
                let near = near.filter(|p| points[**p as usize].iter().zip(x).all(|(a, b): (&f64, &f64)| (a - b).abs() <= close));
                found = found.into_iter().chain(near.copied()).min();
            }
            place.push(found.unwrap_or_else(|| {
                points.push(*x);
                let new = points.len() as u32 - 1;
                boxes.entry((*owner, home)).or_default().push(new);
                new
            }));
        }
        (points, place)
    }
}

fn lexicographic_count(shape: CellShape, p: usize) -> usize {
    match shape {
        CellShape::Triangle => (p + 1) * (p + 2) / 2,
        CellShape::Tetrahedron => (p + 1) * (p + 2) * (p + 3) / 6,
        _ => (p + 1).pow(shape.dimension() as u32),
    }
}

/// Returns the bytes of a `.vtu` file of a mesh: linear cells, Lagrange cells of order 2 to 4.
///
/// Cells of the highest dimension are right-handed. Cell data: `id`, the file's number of the cell, and for every group an array
/// `group DIMENSION NUMBER NAME` that is one in its cells.
///
/// # Errors
/// [`FileError::Unsupported`] for prisms and pyramids of order 2, orders above 4, and more groups times cells than 2^28.
pub fn write_vtu(mesh: &MeshFile) -> Result<Vec<u8>, FileError> {
    let mesh = &*right_handed(mesh);
    let unsupported = |what: String| FileError::Unsupported { what, spot: None };
    let cells: usize = mesh.blocks.iter().map(|b| b.ids.len()).sum();
    if mesh.groups.len().saturating_mul(cells) > MAX_MEMBERS {
        return Err(unsupported(format!("a VTU file of {} groups and {cells} cells", mesh.groups.len())));
    }
    let (mut connectivity, mut ends, mut types, mut degrees): (Vec<i64>, Vec<i64>, Vec<u8>, Vec<f64>) = Default::default();
    for block in &mesh.blocks {
        let &(shape, linear, lagrange) = SHAPES.iter().find(|s| s.0 == block.shape).expect("every shape is listed");
        let kind = match (block.order, lagrange) {
            (1, _) => linear,
            (2..=MAX_ORDER, Some((kind, _))) => kind,
            (order, _) => return Err(unsupported(format!("a {shape:?} of order {order} in a VTU file").to_lowercase())),
        };
        let places = places(shape, block.order);
        for nodes in block.nodes.chunks_exact(places.len()) {
            connectivity.extend(places.iter().map(|p| i64::from(nodes[*p])));
            ends.push(connectivity.len() as i64);
            types.push(kind);
            degrees.extend((0..3).map(|k| if k < shape.dimension() { block.order as f64 } else { 0.0 }));
        }
    }
    let high_order = types.iter().any(|t| *t >= 68);
    let mut file = vtu::File::new(types.contains(&72));
    file.start("UnstructuredGrid", &[]);
    let (points, count) = (mesh.points.len().to_string(), types.len().to_string());
    file.start("Piece", &[("NumberOfPoints", &points), ("NumberOfCells", &count)]);
    file.start("CellData", if high_order { &[("HigherOrderDegrees", "HigherOrderDegrees")] } else { &[] });
    if high_order {
        file.array("Float64", "HigherOrderDegrees", 3, degrees.iter().map(|v| v.to_le_bytes()));
    }
    file.array("Int64", "id", 1, mesh.blocks.iter().flat_map(|b| &b.ids).map(|v| v.to_le_bytes()));
    for (g, group) in mesh.groups.iter().enumerate() {
        let name = group.name.as_ref().map_or(String::new(), |n| format!(" {n}"));
        let name = format!("{GROUP}{} {}{name}", group.dimension, group.number);
        file.array("UInt8", &name, 1, mesh.blocks.iter().flat_map(|b| std::iter::repeat_n([u8::from(b.groups.contains(&g))], b.ids.len())));
    }
    file.end("CellData");
    file.start("Points", &[]);
    file.array("Float64", "Points", 3, mesh.points.iter().flatten().map(|v| v.to_le_bytes()));
    file.end("Points");
    file.start("Cells", &[]);
    file.array("Int64", "connectivity", 1, connectivity.iter().map(|v| v.to_le_bytes()));
    file.array("Int64", "offsets", 1, ends.iter().map(|v| v.to_le_bytes()));
    file.array("UInt8", "types", 1, types.iter().map(|t| [*t]));
    file.end("Cells");
    file.end("Piece");
    file.end("UnstructuredGrid");
    Ok(file.finish())
}
