//! Part of a file that makes a patch: a spline patch, or cells of a mesh with their named sides and points.

use faying::basis::Cell;
use faying::linalg::Vector;
use faying::space::{MeshCells, nodes_per_cell};
use faying_files::SplinePatch;

/// One patch of a file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FilePart {
    /// A spline patch.
    Spline(SplinePatch),
    /// Cells in the plane.
    Plane(MeshPart<2>),
    /// Cells in space.
    Space(MeshPart<3>),
}

/// Cells of a mesh file with their names and numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshPart<const N: usize> {
    /// The cells and their sides.
    pub cells: MeshCells<N>,
    /// Number of tags from the file, which come first; the others are made by the program and cannot be named by users.
    pub named: usize,
    /// The file's numbers of the cells, element after element.
    pub ids: Vec<u64>,
    /// Named points with their places \[length\].
    pub points: Vec<(String, Vector<N>)>,
    /// The file's numbers of all its points, so that equal points of parts of one file have equal numbers.
    pub point_ids: Vec<u64>,
}

impl FilePart {
    /// The spline patch, if it is one.
    pub fn spline(&self) -> Option<&SplinePatch> {
        match self {
            Self::Spline(patch) => Some(patch),
            _ => None,
        }
    }

    /// Whether it is a mesh.
    pub fn is_mesh(&self) -> bool {
        !matches!(self, Self::Spline(_))
    }

    /// The place of a point of a mesh, counted as in the file \[length\].
    pub fn place_of<const N: usize>(&self, point: usize) -> Option<Vector<N>> {
        match self {
            Self::Plane(part) if N == 2 => part.cells.points.get(point).map(|x| Vector::from_fn(|k, _| x[k])),
            Self::Space(part) if N == 3 => part.cells.points.get(point).map(|x| Vector::from_fn(|k, _| x[k])),
            _ => None,
        }
    }

    /// The cells of a mesh of dimension N; `None` for splines and other dimensions.
    pub fn cells<const N: usize>(&self) -> Option<MeshCells<N>> {
        fn of<const M: usize, const N: usize>(cells: &MeshCells<M>) -> Option<MeshCells<N>> {
            (M == N).then(|| MeshCells {
                points: cells.points.iter().map(|x| Vector::<N>::from_fn(|k, _| x[k])).collect(),
                blocks: cells.blocks.clone(),
                tags: cells.tags.clone(),
            })
        }
        match self {
            Self::Spline(_) => None,
            Self::Plane(part) => of(&part.cells),
            Self::Space(part) => of(&part.cells),
        }
    }

    /// The file's numbers of the cells of a mesh.
    pub fn cell_ids(&self) -> &[u64] {
        match self {
            Self::Spline(_) => &[],
            Self::Plane(part) => &part.ids,
            Self::Space(part) => &part.ids,
        }
    }

    /// The file's numbers of the points of a mesh.
    pub fn point_ids(&self) -> &[u64] {
        match self {
            Self::Spline(_) => &[],
            Self::Plane(part) => &part.point_ids,
            Self::Space(part) => &part.point_ids,
        }
    }

    /// The place of a named point of a mesh \[length\], before the patch is moved.
    pub fn point(&self, name: &str) -> Option<[f64; 3]> {
        fn of<const N: usize>(part: &MeshPart<N>, name: &str) -> Option<[f64; 3]> {
            let (_, x) = part.points.iter().find(|(n, _)| n == name)?;
            Some(std::array::from_fn(|k| if k < N { x[k] } else { 0.0 }))
        }
        match self {
            Self::Spline(_) => None,
            Self::Plane(part) => of(part, name),
            Self::Space(part) => of(part, name),
        }
    }

    /// Names of the named points of a mesh.
    pub fn points(&self) -> Vec<&str> {
        match self {
            Self::Spline(_) => Vec::new(),
            Self::Plane(part) => part.points.iter().map(|(n, _)| n.as_str()).collect(),
            Self::Space(part) => part.points.iter().map(|(n, _)| n.as_str()).collect(),
        }
    }

    /// Numbers of tensor cells and of simplices of a mesh.
    pub fn counts(&self) -> [usize; 2] {
        fn of<const N: usize>(part: &MeshPart<N>) -> [usize; 2] {
            let count = |cell: Cell| {
                let blocks = part.cells.blocks.iter().filter(|b| b.cell == cell);
                blocks.map(|b| b.nodes.len() / nodes_per_cell(cell, N, b.order)).sum()
            };
            [count(Cell::Tensor), count(Cell::Simplex)]
        }
        match self {
            Self::Spline(_) => [0, 0],
            Self::Plane(part) => of(part),
            Self::Space(part) => of(part),
        }
    }

    /// Names of the tags of a mesh that lie on its boundary and can be named as sides.
    pub fn outer_tags(&self) -> Vec<&str> {
        match self {
            Self::Spline(_) => Vec::new(),
            Self::Plane(part) => part.outer_tags(),
            Self::Space(part) => part.outer_tags(),
        }
    }

    /// Names of points, edges and of tags with facets inside of a mesh: places of supports and forces, but no sides.
    pub fn inner_tags(&self) -> Vec<&str> {
        let outer = self.outer_tags();
        self.tags().into_iter().filter(|tag| !outer.contains(tag)).collect()
    }

    /// Names of its sides, and of its points, edges and facets inside, as the file has them; empty for spline patches, whose sides are u0, u1, ...
    pub fn tags(&self) -> Vec<&str> {
        match self {
            Self::Spline(_) => Vec::new(),
            Self::Plane(part) => part.tags(),
            Self::Space(part) => part.tags(),
        }
    }
}

impl<const N: usize> MeshPart<N> {
    /// Names of its sides as the file has them.
    pub fn tags(&self) -> Vec<&str> {
        self.cells.tags[..self.named].iter().map(|t| t.name.as_str()).collect()
    }

    /// A name that no tag has yet, made from `wanted`.
    pub(super) fn free_name(&self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        while self.cells.tags.iter().any(|t| t.name == name) {
            name.push('\'');
        }
        name
    }
}
