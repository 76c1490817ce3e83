//! Element types of Gmsh and the order of their nodes.
//!
//! Gmsh lists corners, then the nodes inside the edges, inside the faces, inside the cell; what lies inside a face or cell is listed by
//! the same rule at a lower order. Nodes are multi-indices (i, j, k) at (i, j, k) / order in the unit cell.
//! Source: Gmsh 4.15 reference manual, "Node ordering"; tests hold every list against nodes of curved meshes.

use crate::CellShape;

/// Highest order that is read.
pub(super) const MAX_ORDER: usize = 4;

/// Gmsh's numbers of the complete elements.
const TYPES: [(i64, CellShape, usize); 25] = [
    (15, CellShape::Point, 1),
    (1, CellShape::Line, 1),
    (8, CellShape::Line, 2),
    (26, CellShape::Line, 3),
    (27, CellShape::Line, 4),
    (2, CellShape::Triangle, 1),
    (9, CellShape::Triangle, 2),
    (21, CellShape::Triangle, 3),
    (23, CellShape::Triangle, 4),
    (3, CellShape::Quadrilateral, 1),
    (10, CellShape::Quadrilateral, 2),
    (36, CellShape::Quadrilateral, 3),
    (37, CellShape::Quadrilateral, 4),
    (4, CellShape::Tetrahedron, 1),
    (11, CellShape::Tetrahedron, 2),
    (29, CellShape::Tetrahedron, 3),
    (30, CellShape::Tetrahedron, 4),
    (5, CellShape::Hexahedron, 1),
    (12, CellShape::Hexahedron, 2),
    (92, CellShape::Hexahedron, 3),
    (93, CellShape::Hexahedron, 4),
    (6, CellShape::Prism, 1),
    (13, CellShape::Prism, 2),
    (7, CellShape::Pyramid, 1),
    (14, CellShape::Pyramid, 2),
];

/// Elements without the nodes inside their faces or themselves.
const SERENDIPITY: [(i64, &str); 12] = [
    (16, "8-node quadrilaterals"),
    (17, "20-node hexahedra"),
    (18, "15-node prisms"),
    (19, "13-node pyramids"),
    (20, "9-node triangles"),
    (22, "12-node triangles"),
    (32, "22-node tetrahedra"),
    (39, "12-node quadrilaterals"),
    (40, "16-node quadrilaterals of order 4"),
    (99, "32-node hexahedra"),
    (100, "44-node hexahedra"),
    (137, "16-node tetrahedra"),
];

/// A type of elements with its nodes.
#[derive(Clone, Debug)]
pub(super) struct ElementType {
    pub shape: CellShape,
    pub order: usize,
    /// Position of the file's a-th node in the list with the first axis fastest.
    pub place: Vec<usize>,
}

impl ElementType {
    /// Returns the type of the given number; else the reason why it is not read.
    pub fn of_number(number: i64) -> Result<Self, String> {
        if let Some(&(_, shape, order)) = TYPES.iter().find(|t| t.0 == number) {
            return Ok(Self { shape, order, place: places(shape, order) });
        }
        if let Some((_, name)) = SERENDIPITY.iter().find(|t| t.0 == number) {
            return Err(format!("element type {number} ({name}, incomplete; save complete ones with Mesh.SecondOrderIncomplete = 0)"));
        }
        Err(format!(
            "element type {number} (orders 1 to {MAX_ORDER} of lines, triangles, quadrilaterals, tetrahedra and hexahedra are read)"
        ))
    }
}

/// Gmsh's number of a type.
pub(super) fn number_of(shape: CellShape, order: usize) -> Option<i64> {
    TYPES.iter().find(|t| t.1 == shape && t.2 == order).map(|t| t.0)
}

/// Position of Gmsh's a-th node in the list with the first axis fastest.
pub(super) fn places(shape: CellShape, order: usize) -> Vec<usize> {
    match (shape, order) {
        (CellShape::Prism, 1) => (0..6).collect(),
        (CellShape::Prism, _) => (0..18).collect(),
        (CellShape::Pyramid, 1) => (0..5).collect(),
        (CellShape::Pyramid, _) => (0..14).collect(),
        (CellShape::Point, _) => vec![0],
        _ => {
            let sorted = lexicographic(shape, order);
            nodes(shape, order).iter().map(|a| sorted.iter().position(|b| b == a).expect("a node of the cell")).collect()
        }
    }
}

/// Multi-indices with the first axis fastest.
pub(crate) fn lexicographic(shape: CellShape, p: usize) -> Vec<[usize; 3]> {
    let simplex = matches!(shape, CellShape::Triangle | CellShape::Tetrahedron);
    let most = |axis: usize| if axis < shape.dimension() { p } else { 0 };
    let mut list = Vec::new();
    for k in 0..=most(2) {
        for j in 0..=most(1) {
            list.extend((0..=most(0)).map(|i| [i, j, k]).filter(|a| !simplex || a.iter().sum::<usize>() <= p));
        }
    }
    list
}

/// Corners, edges and faces of a shape as Gmsh numbers and walks them.
struct Skeleton {
    corners: &'static [[usize; 3]],
    edges: &'static [[usize; 2]],
    faces: &'static [&'static [usize]],
}

fn skeleton(shape: CellShape) -> Skeleton {
    match shape {
        CellShape::Line => Skeleton { corners: &[[0, 0, 0], [1, 0, 0]], edges: &[[0, 1]], faces: &[] },
        CellShape::Triangle => {
            Skeleton { corners: &[[0, 0, 0], [1, 0, 0], [0, 1, 0]], edges: &[[0, 1], [1, 2], [2, 0]], faces: &[&[0, 1, 2]] }
        }
        CellShape::Quadrilateral => Skeleton {
            corners: &[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
            edges: &[[0, 1], [1, 2], [2, 3], [3, 0]],
            faces: &[&[0, 1, 2, 3]],
        },
        CellShape::Tetrahedron => Skeleton {
            corners: &[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
            edges: &[[0, 1], [1, 2], [2, 0], [3, 0], [3, 2], [3, 1]],
            faces: &[&[0, 2, 1], &[0, 1, 3], &[0, 3, 2], &[3, 1, 2]],
        },
        CellShape::Hexahedron => Skeleton {
            corners: &[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
            edges: &[[0, 1], [0, 3], [0, 4], [1, 2], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 7], [5, 6], [6, 7]],
            faces: &[&[0, 3, 2, 1], &[0, 1, 5, 4], &[0, 4, 7, 3], &[1, 2, 6, 5], &[2, 3, 7, 6], &[4, 5, 6, 7]],
        },
        CellShape::Point | CellShape::Prism | CellShape::Pyramid => Skeleton { corners: &[[0, 0, 0]], edges: &[], faces: &[] },
    }
}

/// Multi-indices of the nodes in Gmsh's order.
fn nodes(shape: CellShape, p: usize) -> Vec<[usize; 3]> {
    if p == 0 {
        return vec![[0, 0, 0]];
    }
    let Skeleton { corners, edges, faces } = skeleton(shape);
    // weights of corners add up to p; on parallelograms the third corner stands for none
    let mix = |on: &[(usize, usize)]| -> [usize; 3] { std::array::from_fn(|k| on.iter().map(|&(c, n)| corners[c][k] * n).sum()) };
    let mut list: Vec<[usize; 3]> = (0..corners.len()).map(|c| mix(&[(c, p)])).collect();
    for &[a, b] in edges {
        list.extend((1..p).map(|i| mix(&[(a, p - i), (b, i)])));
    }
    for face in faces {
        match **face {
            [a, b, c] if p >= 3 => {
                list.extend(nodes(CellShape::Triangle, p - 3).iter().map(|&[i, j, _]| mix(&[(a, p - 2 - i - j), (b, i + 1), (c, j + 1)])));
            }
            [a, b, _, d] if p >= 2 => {
                list.extend(nodes(CellShape::Quadrilateral, p - 2).iter().map(|&[i, j, _]| {
                    // a + i (b - a) + j (d - a), coordinate by coordinate
                    let along = |k: usize, n: usize, to: usize| n as isize * (corners[to][k] as isize - corners[a][k] as isize);
                    std::array::from_fn(|k| {
                        let place = (p * corners[a][k]).checked_add_signed(along(k, i + 1, b) + along(k, j + 1, d));
                        place.expect("inside the cell")
                    })
                }));
            }
            _ => {}
        }
    }
    let (depth, solid) = match shape {
        CellShape::Tetrahedron => (4, true),
        CellShape::Hexahedron => (2, true),
        _ => (0, false),
    };
    if solid && p >= depth {
        list.extend(nodes(shape, p - depth).iter().map(|a| a.map(|i| i + 1)));
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_list_of_nodes_is_a_permutation() {
        for (_, shape, order) in TYPES {
            let mut places = places(shape, order);
            places.sort_unstable();
            assert_eq!(places, (0..places.len()).collect::<Vec<_>>(), "{shape:?} of order {order}");
        }
    }

    #[test]
    fn refused_types_say_what_they_are() {
        assert!(ElementType::of_number(16).unwrap_err().contains("8-node"));
        assert!(ElementType::of_number(31).unwrap_err().contains("type 31"));
    }
}
