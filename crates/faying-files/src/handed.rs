//! Conversion of left-handed cells and patches (negative Jacobian determinant) to right-handed ones before writing.
//!
//! The first two axes are exchanged, which keeps all values; a line is reversed. Only cells of full dimension have a sign: solids, faces
//! in one plane z = const, lines along x.

use super::gmsh::lexicographic;
use super::{CellMap, CellShape, FileError, MeshBlock, MeshFile, SplineFile, SplinePatch};
use faying::basis::{Cell, Elements, Order};
use faying::geometry::{Geometry, MapTable};
use faying::linalg::{Matrix, Vector, determinant};
use std::borrow::Cow;

/// Whether cells of a dimension fill the space of the points.
fn fills(dimension: usize, points: &[[f64; 3]]) -> bool {
    let same = |k: usize| points.iter().all(|p| p[k] == points[0][k]);
    (1..=3).contains(&dimension) && (dimension..3).all(same)
}

/// Jacobian determinant in the middle of an element, by the first D coordinates.
fn middle<const D: usize>(map: &dyn Geometry<D, 3>, element: usize, table: &mut MapTable<D, 3>) -> f64 {
    let simplex = D > 1 && map.cell(element) == Cell::Simplex;
    let xi = Vector::<D>::repeat(if simplex { 1.0 / (D as f64 + 1.0) } else { 0.5 });
    map.map(element, &[xi], Order::Gradients, table);
    determinant(&Matrix::<D, D>::from_fn(|i, k| table.jacobian[0][(i, k)]))
}

/// Node permutation that changes the handedness of a cell.
fn mirrored(shape: CellShape, order: usize) -> Vec<usize> {
    match shape {
        CellShape::Point => vec![0],
        CellShape::Line => (0..=order).rev().collect(),
        CellShape::Prism => vec![0, 2, 1, 3, 5, 4],
        CellShape::Pyramid => vec![0, 3, 2, 1, 4],
        _ => {
            let list = lexicographic(shape, order);
            let place = |a: [usize; 3]| list.iter().position(|b| *b == a).expect("a node of the cell");
            list.iter().map(|&[i, j, k]| place([j, i, k])).collect()
        }
    }
}

/// Returns for every cell of a block whether it is left-handed.
fn left_handed(block: &MeshBlock, points: &[[f64; 3]]) -> Vec<bool> {
    fn of<const D: usize>(block: &MeshBlock, points: &[[f64; 3]]) -> Vec<bool> {
        let Some(map) = CellMap::<D>::new(block, points) else { return Vec::new() };
        let mut table = MapTable::new();
        (0..map.num_elements()).map(|e| middle(&map, e, &mut table) < 0.0).collect()
    }
    let corner = |nodes: &[u32], edges: [usize; 3]| {
        let x = |k: usize| Vector::<3>::from(points[nodes[k] as usize]);
        (x(edges[0]) - x(0)).cross(&(x(edges[1]) - x(0))).dot(&(x(edges[2]) - x(0))) < 0.0
    };
    match block.shape {
        CellShape::Point => Vec::new(),
        CellShape::Prism => block.nodes.chunks_exact(6).map(|nodes| corner(nodes, [1, 2, 3])).collect(),
        CellShape::Pyramid => block.nodes.chunks_exact(5).map(|nodes| corner(nodes, [1, 3, 4])).collect(),
        CellShape::Line => of::<1>(block, points),
        CellShape::Triangle | CellShape::Quadrilateral => of::<2>(block, points),
        CellShape::Tetrahedron | CellShape::Hexahedron => of::<3>(block, points),
    }
}

/// Returns the mesh with right-handed cells of the highest dimension.
pub(super) fn right_handed(mesh: &MeshFile) -> Cow<'_, MeshFile> {
    let d = mesh.dimension();
    let mut all = Cow::Borrowed(mesh);
    if !fills(d, &mesh.points) {
        return all;
    }
    for (b, block) in mesh.blocks.iter().enumerate().filter(|(_, block)| block.shape.dimension() == d) {
        let left = left_handed(block, &mesh.points);
        if !left.contains(&true) {
            continue;
        }
        let order = mirrored(block.shape, block.order);
        let own = &mut all.to_mut().blocks[b].nodes;
        for (to, from) in
            own.chunks_exact_mut(order.len()).zip(block.nodes.chunks_exact(order.len())).zip(left).filter(|c| c.1).map(|c| c.0)
        {
            to.iter_mut().zip(&order).for_each(|(to, k)| *to = from[*k]);
        }
    }
    all
}

/// Returns the indices of the left-handed patches of two and three parameters.
///
/// # Errors
/// [`FileError`] if knots, points and weights of a patch do not fit.
pub(super) fn left_handed_patches(file: &SplineFile) -> Result<Vec<usize>, FileError> {
    fn is_left<const D: usize>(patch: &SplinePatch) -> Result<bool, FileError> {
        let (map, mut table) = (patch.map::<D>()?, MapTable::new());
        Ok((0..map.num_elements()).map(|e| middle(&*map, e, &mut table)).sum::<f64>() < 0.0)
    }
    let mut all = Vec::new();
    for (k, patch) in file.patches.iter().enumerate() {
        let d = patch.dimension();
        let left = match d {
            2 if fills(d, &patch.points) => is_left::<2>(patch)?,
            3 => is_left::<3>(patch)?,
            _ => false,
        };
        if left {
            all.push(k);
        }
    }
    Ok(all)
}

/// Exchanges the first two parameters of `patches` (ascending indices); joints and labels get the new names of the same sides. Applied
/// twice, it restores the file.
pub(super) fn exchange(file: &mut SplineFile, patches: &[usize]) {
    for &k in patches {
        let Some(patch) = file.patches.get_mut(k).filter(|p| p.dimension() > 1) else { continue };
        let count = |k: usize| patch.knots[k].len().saturating_sub(patch.degree[k] + 1);
        let (n, m) = (count(0), count(1));
        let from: Vec<usize> = (0..patch.points.len()).map(|to| to / (n * m) * (n * m) + to / m % n + to % m * n).collect();
        patch.points = from.iter().map(|k| patch.points[*k]).collect();
        patch.weights = patch.weights.as_ref().map(|w| from.iter().map(|k| w[*k]).collect());
        patch.degree.swap(0, 1);
        patch.knots.swap(0, 1);
        if patch.uses.len() > 1 {
            patch.uses.swap(0, 1);
        }
    }
    let turned = |patch: &usize| patches.binary_search(patch).is_ok() && file.patches.get(*patch).is_some_and(|p| p.dimension() > 1);
    let sides = file.joints.iter_mut().flatten().chain(file.labels.iter_mut().flat_map(|l| &mut l.sides));
    for side in sides.filter(|s| turned(&s.patch)) {
        side.side = match side.side.split_at_checked(1) {
            Some(("u", end)) => format!("v{end}"),
            Some(("v", end)) => format!("u{end}"),
            _ => continue,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Format, Label, PatchSide};

    #[test]
    fn patches_exchanged_twice_are_as_they_were() {
        let axis = |n: usize| (0..2).map(|_| 0.0).chain((1..n - 1).map(|k| k as f64)).chain([n as f64 - 1.0; 2]).collect::<Vec<f64>>();
        // x = w, y = u, z = v is right-handed; x = u, y = w, z = v is not
        let points = |order: [usize; 3]| -> Vec<[f64; 3]> {
            (0..24).map(|i| [i % 2, i / 2 % 3, i / 6]).map(|u| std::array::from_fn(|k| u[order[k]] as f64)).collect()
        };
        let patch = |order| SplinePatch {
            degree: vec![1; 3],
            knots: vec![axis(2), axis(3), axis(4)],
            weights: Some((0..24).map(|k| 1.0 + k as f64).collect()),
            points: points(order),
            world: 3,
            ..SplinePatch::default()
        };
        let sides = |patch: usize| ["u0", "v1", "w1"].map(|s| PatchSide { patch, side: s.into() });
        let labels = vec![Label { name: "l".into(), sides: [sides(0), sides(1)].concat() }];
        let file =
            SplineFile { format: Format::Gismo, patches: vec![patch([2, 0, 1]), patch([0, 2, 1])], joints: vec![], labels, notes: vec![] };
        assert_eq!(left_handed_patches(&file).unwrap(), [1]);
        let mut other = file.clone();
        exchange(&mut other, &[1]);
        assert!(left_handed_patches(&other).unwrap().is_empty());
        let names: Vec<&str> = other.labels[0].sides.iter().map(|s| s.side.as_str()).collect();
        assert_eq!(names, ["u0", "v1", "w1", "v0", "u1", "w1"]);
        exchange(&mut other, &[1]);
        assert_eq!(file, other);
    }

    #[test]
    fn mirrored_cells_have_the_same_nodes_and_the_other_sign() {
        let cube: Vec<[f64; 3]> = (0..8).map(|c| [0, 1, 2].map(|k| f64::from(u8::from(c >> k & 1 == 1)))).collect();
        let shapes: [(CellShape, &[u32]); 6] = [
            (CellShape::Triangle, &[0, 1, 2]),
            (CellShape::Quadrilateral, &[0, 1, 2, 3]),
            (CellShape::Tetrahedron, &[0, 1, 2, 4]),
            (CellShape::Hexahedron, &[0, 1, 2, 3, 4, 5, 6, 7]),
            (CellShape::Prism, &[0, 1, 2, 4, 5, 6]),
            (CellShape::Pyramid, &[0, 1, 3, 2, 4]),
        ];
        for (shape, nodes) in shapes {
            let flat: Vec<[f64; 3]> = cube.iter().map(|x| [x[0], x[1], if shape.dimension() == 2 { 5.0 } else { x[2] }]).collect();
            let block = MeshBlock { shape, order: 1, nodes: nodes.to_vec(), ids: vec![1], groups: vec![] };
            let mesh = |block: MeshBlock| MeshFile {
                format: Format::Gmsh,
                points: flat.clone(),
                ids: (1..=8).collect(),
                blocks: vec![block],
                groups: vec![],
                notes: vec![],
            };
            let right = mesh(block.clone());
            assert!(matches!(right_handed(&right), Cow::Borrowed(_)), "{shape:?}");
            let turned = mirrored(shape, 1).iter().map(|k| nodes[*k]).collect();
            let left = mesh(MeshBlock { nodes: turned, ..block });
            assert_eq!(*right_handed(&left), right, "{shape:?}");
        }
    }
}
