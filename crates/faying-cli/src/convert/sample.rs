//! Spline patches as Lagrange cells on their knot spans.

use crate::inspect::{CellMap, faces, map_of, name_of};
use faying::basis::{BSpline, Cell, Order};
use faying::geometry::{Geometry, MapTable, cell};
use faying::linalg::Vector;
use faying_files::{CellShape, FileError, Format, Group, MeshBlock, MeshFile, SplineFile, SplinePatch};

/// Points closer than this share of the model size are merged.
const SAME: f64 = 1e-10;
/// Highest order of sampled cells.
pub const MAX_ORDER: usize = 4;

/// A mesh and how far its cells are from the splines \[length\].
#[derive(Clone, Debug)]
pub struct Sampled {
    /// The mesh.
    pub mesh: MeshFile,
    /// Order of its cells.
    pub order: usize,
    /// Largest distance found.
    pub distance: f64,
    /// Model size: the longest side of the bounding box.
    pub size: f64,
}

/// Knot spans per direction.
fn spans(patch: &SplinePatch) -> Result<Vec<usize>, FileError> {
    let broken = |e: faying::basis::KnotError| FileError::Broken { what: e.to_string(), spot: None };
    let one = |(p, k): (&usize, &Vec<f64>)| BSpline::try_new(*p, k.clone()).map(|b| b.breakpoints().len() - 1).map_err(broken);
    patch.degree.iter().zip(&patch.knots).map(one).collect()
}

/// Nodes of all cells of order `p` of a grid of `spans`, first axis fastest, as indices into its lattice of points.
fn lattice_nodes(spans: &[usize], p: usize) -> Vec<Vec<usize>> {
    let cells: usize = spans.iter().product();
    let inside: usize = (p + 1).pow(spans.len() as u32);
    (0..cells)
        .map(|e| {
            (0..inside)
                .map(|a| {
                    let (mut rest, mut local, mut place, mut stride) = (e, a, 0, 1);
                    for n in spans {
                        place += stride * (rest % n * p + local % (p + 1));
                        rest /= n;
                        local /= p + 1;
                        stride *= n * p + 1;
                    }
                    place
                })
                .collect()
        })
        .collect()
}

/// Points of the lattice of a patch.
fn points<const D: usize>(patch: &SplinePatch, nodes: &[Vec<usize>], spans: &[usize], p: usize) -> Result<Vec<[f64; 3]>, FileError> {
    let map = map_of::<D>(patch)?;
    let grid = cell::grid::<D, f64>(Cell::Tensor, p + 1);
    let mut all = vec![[0.0; 3]; spans.iter().map(|n| n * p + 1).product()];
    let mut table = MapTable::new();
    for (e, own) in nodes.iter().enumerate() {
        map.map(e, &grid, Order::Values, &mut table);
        for (&i, x) in own.iter().zip(&table.x) {
            all[i] = [x[0], x[1], x[2]];
        }
    }
    Ok(all)
}

/// Largest distance of the cells of `block` from a patch.
fn distance<const D: usize>(patch: &SplinePatch, block: &MeshBlock, points: &[[f64; 3]]) -> Result<f64, FileError> {
    let (map, Some(cells)) = (map_of::<D>(patch)?, CellMap::<D>::new(block, points)) else { return Ok(0.0) };
    let grid: Vec<Vector<D>> = cell::grid::<D, f64>(Cell::Tensor, 2 * block.order + 1);
    let (mut a, mut b, mut most) = (MapTable::new(), MapTable::new(), 0.0f64);
    for e in 0..map.num_elements() {
        map.map(e, &grid, Order::Values, &mut a);
        cells.map(e, &grid, Order::Values, &mut b);
        most = a.x.iter().zip(&b.x).fold(most, |m, (x, y)| m.max((x - y).norm()));
    }
    Ok(most)
}

/// Indices of the lattice points on a side.
fn on_side(spans: &[usize], p: usize, axis: usize, end: usize) -> Vec<usize> {
    let counts: Vec<usize> = spans.iter().map(|n| n * p + 1).collect();
    let before: usize = counts[..axis].iter().product();
    let wanted = if end == 0 { 0 } else { counts[axis] - 1 };
    (0..counts.iter().product()).filter(|i| i / before % counts[axis] == wanted).collect()
}

fn shape(dimension: usize) -> CellShape {
    [CellShape::Point, CellShape::Line, CellShape::Quadrilateral, CellShape::Hexahedron][dimension.min(3)]
}

/// The cells of order `order` on all knot spans: a group per patch, per side (`PATCH.SIDE`) and per label of the file.
///
/// Common points of patches are merged, unless a cell would contain one twice.
///
/// # Errors
/// [`FileError`] for patches whose knots, points and weights do not fit, or of more than three parameters.
pub fn sample(file: &SplineFile, order: usize) -> Result<Sampled, FileError> {
    let mut mesh =
        MeshFile { format: Format::Gmsh, points: Vec::new(), ids: Vec::new(), blocks: Vec::new(), groups: Vec::new(), notes: Vec::new() };
    let (mut outer, mut off) = (Vec::new(), 0.0f64);
    let too_many = |_| FileError::Unsupported { what: "a mesh of more than 2^32 points".into(), spot: None };
    let mut label_groups: Vec<Option<usize>> = vec![None; file.labels.len()];
    for (k, patch) in file.patches.iter().enumerate() {
        let (d, name) = (patch.dimension(), name_of(file, k));
        if !(1..=3).contains(&d) {
            return Err(FileError::Dimension { what: format!("patch \"{name}\" has {d} parameters; 1 to 3 are known"), spot: None });
        }
        let spans = spans(patch)?;
        let nodes = lattice_nodes(&spans, order);
        let own = match d {
            1 => points::<1>(patch, &nodes, &spans, order)?,
            2 => points::<2>(patch, &nodes, &spans, order)?,
            _ => points::<3>(patch, &nodes, &spans, order)?,
        };
        let first = u32::try_from(mesh.points.len() + own.len()).map_err(too_many)? - own.len() as u32;
        mesh.points.extend(own);
        let group = |mesh: &mut MeshFile, dimension: usize, name: String| {
            let number = 1 + mesh.groups.iter().filter(|g| g.dimension == dimension).count() as i64;
            mesh.groups.push(Group { dimension, number, name: Some(name) });
            mesh.groups.len() - 1
        };
        let body = group(&mut mesh, d, name.clone());
        let block = MeshBlock {
            shape: shape(d),
            order,
            ids: vec![0; nodes.len()],
            nodes: nodes.iter().flatten().map(|&i| first + i as u32).collect(),
            groups: vec![body],
        };
        off = off.max(match d {
            1 => distance::<1>(patch, &block, &mesh.points)?,
            2 => distance::<2>(patch, &block, &mesh.points)?,
            _ => distance::<3>(patch, &block, &mesh.points)?,
        });
        mesh.blocks.push(block);
        for (s, (side, _)) in faces(patch).into_iter().enumerate() {
            let (axis, end) = (s / 2, s % 2);
            let lattice = on_side(&spans, order, axis, end);
            outer.extend(lattice.iter().map(|&i| first + i as u32));
            let along: Vec<usize> = (0..d).filter(|&a| a != axis).map(|a| spans[a]).collect();
            let cells = lattice_nodes(&along, order);
            let mut groups = vec![group(&mut mesh, d - 1, format!("{name}.{side}"))];
            for (l, label) in file.labels.iter().enumerate() {
                if label.sides.iter().any(|s| s.patch == k && s.side == side) {
                    groups.push(*label_groups[l].get_or_insert_with(|| group(&mut mesh, d - 1, label.name.clone())));
                }
            }
            let order = if d == 1 { 1 } else { order };
            mesh.blocks.push(MeshBlock {
                shape: shape(d - 1),
                order,
                ids: vec![0; cells.len()],
                nodes: cells.iter().flatten().map(|&i| first + lattice[i] as u32).collect(),
                groups,
            });
        }
    }
    let size = extent(&mesh.points);
    outer.sort_unstable();
    outer.dedup();
    join(&mut mesh, &outer, SAME * size);
    mesh.ids = (1..=mesh.points.len() as u64).collect();
    for (id, number) in mesh.blocks.iter_mut().flat_map(|b| &mut b.ids).zip(1..) {
        *id = number;
    }
    Ok(Sampled { mesh, order, distance: off, size })
}

/// Longest side of the box around points.
fn extent(points: &[[f64; 3]]) -> f64 {
    let range = |k: usize| points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], p| [a.min(p[k]), b.max(p[k])]);
    (0..3).map(range).map(|[a, b]| b - a).fold(0.0, f64::max)
}

/// Merges the points of `outer` that are closer than `near`, unless a cell would contain one twice; drops the merged copies.
fn join(mesh: &mut MeshFile, outer: &[u32], near: f64) {
    let x = |i: u32| mesh.points[i as usize];
    let cell_of = |v: f64| (v / near.max(f64::MIN_POSITIVE) / 4.0).round() as i64;
    // equal points fall into the same or neighbouring cells of a grid; the first represents all
    let mut places: std::collections::BTreeMap<[i64; 3], Vec<u32>> = std::collections::BTreeMap::new();
    let mut stands: Vec<u32> = (0..mesh.points.len() as u32).collect();
    for &i in outer {
        let p = x(i);
        let c = p.map(cell_of);
        let mut found = None;
        for n in 0..27 {
            let key = [c[0] + n % 3 - 1, c[1] + n / 3 % 3 - 1, c[2] + n / 9 - 1];
            let close = |j: &&u32| (0..3).all(|k| (x(**j)[k] - p[k]).abs() <= near);
            found = found.or_else(|| places.get(&key).and_then(|list| list.iter().find(close).copied()));
        }
        match found {
            Some(j) => stands[i as usize] = j,
            None => places.entry(c).or_default().push(i),
        }
    }
    // points of collapsed edges are not merged
    let mut apart = vec![false; mesh.points.len()];
    for block in mesh.blocks.iter().filter(|b| !b.ids.is_empty()) {
        for nodes in block.nodes.chunks_exact(block.nodes.len() / block.ids.len()) {
            let mut own: Vec<u32> = nodes.iter().map(|&n| stands[n as usize]).collect();
            own.sort_unstable();
            own.windows(2).filter(|w| w[0] == w[1]).for_each(|w| apart[w[0] as usize] = true);
        }
    }
    for i in 0..stands.len() {
        if apart[stands[i] as usize] {
            stands[i] = i as u32;
        }
    }
    let mut place = vec![0u32; stands.len()];
    let mut kept = Vec::with_capacity(stands.len());
    for i in 0..stands.len() {
        if stands[i] as usize == i {
            place[i] = kept.len() as u32;
            kept.push(mesh.points[i]);
        }
    }
    for node in mesh.blocks.iter_mut().flat_map(|b| &mut b.nodes) {
        *node = place[stands[*node as usize] as usize];
    }
    mesh.points = kept;
}
