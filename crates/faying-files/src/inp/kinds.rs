//! Types of elements and the corners of their faces.

use crate::CellShape;
use crate::CellShape::{Hexahedron, Line, Prism, Pyramid, Quadrilateral, Tetrahedron, Triangle};

/// Families of elements, longer names first, with the dimension of their cells.
const FAMILIES: [(&str, usize); 9] =
    [("DC3D", 3), ("DC2D", 2), ("DCAX", 2), ("C3D", 3), ("CPE", 2), ("CPS", 2), ("CAX", 2), ("T2D", 1), ("T3D", 1)];

/// Dimension, number of nodes, shape and order.
const KINDS: [(usize, usize, CellShape, usize); 12] = [
    (1, 2, Line, 1),
    (1, 3, Line, 2),
    (2, 3, Triangle, 1),
    (2, 4, Quadrilateral, 1),
    (2, 6, Triangle, 2),
    (2, 8, Quadrilateral, 2),
    (3, 4, Tetrahedron, 1),
    (3, 5, Pyramid, 1),
    (3, 6, Prism, 1),
    (3, 8, Hexahedron, 1),
    (3, 10, Tetrahedron, 2),
    (3, 20, Hexahedron, 2),
];

/// A type of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ElementKind {
    pub shape: CellShape,
    pub order: usize,
    /// Nodes in the file.
    pub nodes: usize,
}

impl ElementKind {
    /// The type of a name in upper case; else the reason why it is not read.
    pub fn of_name(name: &str) -> Result<Self, String> {
        let family = FAMILIES.iter().find_map(|(family, dimension)| Some((*dimension, name.strip_prefix(family)?)));
        let found = family.and_then(|(dimension, rest)| {
            let letters = rest.trim_start_matches(|c: char| c.is_ascii_digit());
            let nodes: usize = rest[..rest.len() - letters.len()].parse().ok()?;
            let kind = KINDS.iter().find(|k| (k.0, k.1) == (dimension, nodes))?;
            letters.chars().all(|c| c.is_ascii_alphabetic()).then_some(Self { shape: kind.2, order: kind.3, nodes })
        });
        found.ok_or_else(|| {
            let shown: String = name.chars().take(24).collect();
            format!(
                "element type {shown} (CPE, CPS, CAX, DC2D and DCAX of 3, 4, 6 or 8 nodes, C3D and DC3D of 4, 5, 6, 8, 10 or 20 nodes, T2D \
                 and T3D of 2 or 3 are read)"
            )
        })
    }

    /// Whether nodes inside faces are missing in the file.
    pub fn is_incomplete(self) -> bool {
        matches!((self.shape, self.order), (Quadrilateral | Hexahedron, 2))
    }

    /// The corners of face `S1`, `S2`, ..., numbered as in the file from 0 and walked around; empty if it has no such face.
    pub fn face(self, number: usize) -> &'static [usize] {
        let faces: &[&[usize]] = match self.shape {
            Triangle => &[&[0, 1], &[1, 2], &[2, 0]],
            Quadrilateral => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
            Tetrahedron => &[&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]],
            Hexahedron => &[&[0, 1, 2, 3], &[4, 7, 6, 5], &[0, 4, 5, 1], &[1, 5, 6, 2], &[2, 6, 7, 3], &[3, 7, 4, 0]],
            _ => &[],
        };
        number.checked_sub(1).and_then(|k| faces.get(k)).copied().unwrap_or_default()
    }

    /// Number of faces that have a name.
    pub fn faces(self) -> usize {
        (1..).take_while(|k| !self.face(*k).is_empty()).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_behind_the_number_of_nodes_do_not_matter() {
        for (name, shape, order) in [
            ("CPS4", Quadrilateral, 1),
            ("CPE8RH", Quadrilateral, 2),
            ("C3D20RI", Hexahedron, 2),
            ("C3D10M", Tetrahedron, 2),
            ("DCAX3", Triangle, 1),
        ] {
            let kind = ElementKind::of_name(name).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!((kind.shape, kind.order), (shape, order), "{name}");
        }
        for name in ["S4R", "C3D27", "C3D15", "CPEG4", "B31", "CPS", "T3D4", "C3D8-1", ""] {
            assert!(ElementKind::of_name(name).is_err(), "{name}");
        }
    }
}
