//! Selection of the cells of one dimension of a mesh file, with named sides, edges and points.

use super::{CellShape, FileError, Group, MeshBlock, MeshFile};
use faying::basis::Cell;
use faying::linalg::Vector;
use faying::space::{CellBlock, FacetTag, MeshCells};

/// Largest distance of the points of a plane mesh from z = 0, relative to the size of the mesh.
const FLAT: f64 = 1e-12;

/// Corners of a facet, ascending, filled up with [`NONE`].
type Key = [u32; 4];

/// No corner.
const NONE: u32 = u32::MAX;

impl MeshFile {
    /// The cells of dimension N (2 or 3), all of them or those of one group, by name or number.
    ///
    /// Points keep their indices in [`MeshFile::points`], so that shared points of two groups of a file remain identifiable. Sides are the
    /// groups of dimension N - 1 by label, groups of one label together; each has its facets of the selected cells, other facets are left
    /// out. Facets between two of the cells are included; such a group is no side of a body, but a place of supports and forces, as are
    /// groups of lower dimensions: corners of the selected cells and, in space, their edges. Of equal labels the higher dimension counts;
    /// if all cells are requested, a group of lower dimension with anything else in it is left out.
    ///
    /// # Errors
    /// [`FileError::Dimension`] without cells of dimension N, with cells of a higher one unless a group is requested, and in the plane for
    /// points off z = 0; [`FileError::Missing`] for an unknown group; [`FileError::Unsupported`] for prisms and pyramids;
    /// [`FileError::Broken`] if all cells are requested and only part of a group are facets of them; [`FileError::Twisted`] for facets that
    /// join corners of one cell and are none of its own.
    pub fn cells<const N: usize>(&self, group: Option<&str>) -> Result<MeshCells<N>, FileError> {
        let chosen = self.chosen(N, group)?;
        let mut blocks = Vec::new();
        for block in &chosen {
            blocks.push(CellBlock { cell: cell(block)?, order: block.order, nodes: block.nodes.iter().map(|n| *n as usize).collect() });
        }
        if N == 2 {
            self.check_flat(&chosen)?;
        }
        let points = self.points.iter().map(|x| Vector::<N>::from_fn(|k, _| x[k])).collect();
        let mut tags: Vec<FacetTag> = Vec::new();
        for dimension in (0..N).rev() {
            let more = self.tags(N, dimension, &chosen, group.is_none())?;
            let new = more.into_iter().filter(|tag| tags.iter().all(|t| t.name != tag.name)).collect::<Vec<_>>();
            tags.extend(new);
        }
        Ok(MeshCells { points, blocks, tags })
    }

    /// The file's numbers of the cells that [`MeshFile::cells`] returns, in their order; empty if it returns an error.
    pub fn cell_ids(&self, dimension: usize, group: Option<&str>) -> Vec<u64> {
        self.chosen(dimension, group).map_or(Vec::new(), |all| all.iter().flat_map(|b| b.ids.iter().copied()).collect())
    }

    /// The point of a group of dimension zero, by name or number; `None` without the group or if it has several points.
    pub fn point(&self, tag: &str) -> Option<[f64; 3]> {
        let group = find(&self.groups, 0, tag)?;
        let mut nodes: Vec<u32> = self
            .blocks
            .iter()
            .filter(|b| b.shape == CellShape::Point && b.groups.contains(&group))
            .flat_map(|b| b.nodes.iter().copied())
            .collect();
        nodes.dedup();
        match nodes[..] {
            [node] => self.points.get(node as usize).copied(),
            _ => None,
        }
    }

    /// Labels of the groups of a dimension, each once, in the order of the file.
    pub fn group_labels(&self, dimension: usize) -> Vec<String> {
        let mut labels: Vec<String> = Vec::new();
        for group in self.groups.iter().filter(|g| g.dimension == dimension) {
            let label = group.label();
            if !labels.contains(&label) {
                labels.push(label);
            }
        }
        labels
    }

    fn chosen(&self, dimension: usize, group: Option<&str>) -> Result<Vec<&MeshBlock>, FileError> {
        let all = || self.blocks.iter().filter(|b| b.shape.dimension() == dimension && !b.ids.is_empty());
        let wrong = |what: String| Err(FileError::Dimension { what, spot: None });
        if !(2..=3).contains(&dimension) {
            return wrong(format!("bodies have 2 or 3 dimensions, not {dimension}"));
        }
        let found = self.dimension();
        if found < dimension || (group.is_none() && found > dimension) {
            return wrong(format!("the cells of the mesh have the dimension {found}, {dimension} is needed"));
        }
        let Some(name) = group else { return Ok(all().collect()) };
        let Some(place) = find(&self.groups, dimension, name) else {
            let known: Vec<String> = self.group_labels(dimension).iter().map(|l| format!("\"{l}\"")).collect();
            let known = if known.is_empty() { format!("no groups of dimension {dimension}") } else { known.join(", ") };
            return Err(FileError::Missing { wanted: format!("group \"{name}\""), known });
        };
        let chosen: Vec<&MeshBlock> = all().filter(|b| b.groups.contains(&place)).collect();
        if chosen.is_empty() {
            return wrong(format!("the group \"{name}\" has no cells"));
        }
        Ok(chosen)
    }

    fn check_flat(&self, chosen: &[&MeshBlock]) -> Result<(), FileError> {
        let used = || chosen.iter().flat_map(|b| b.nodes.iter().map(|n| (*n, self.points[*n as usize])));
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (_, x) in used() {
            for k in 0..2 {
                low[k] = low[k].min(x[k]);
                high[k] = high[k].max(x[k]);
            }
        }
        let size = (high[0] - low[0]).max(high[1] - low[1]);
        match used().find(|(_, x)| x[2].abs() > FLAT * size) {
            Some((n, x)) => {
                let id = self.ids.get(n as usize).copied().unwrap_or(u64::from(n));
                let what = format!("node {id} at {x:?} is off the plane z = 0 of a plane case");
                Err(FileError::Dimension { what, spot: None })
            }
            None => Ok(()),
        }
    }

    /// The groups of dimension `part` of facets, edges or corners of the chosen cells.
    fn tags(&self, dimension: usize, part: usize, chosen: &[&MeshBlock], whole: bool) -> Result<Vec<FacetTag>, FileError> {
        let facets: Vec<&MeshBlock> = self.blocks.iter().filter(|b| b.shape.dimension() == part && !b.groups.is_empty()).collect();
        // only facets of groups are searched, so the cost is one pass over the cells
        let mut wanted: Vec<(Key, bool)> = facets.iter().flat_map(|b| corners(b).map(|c| (key(&c), false))).collect();
        wanted.sort_unstable();
        wanted.dedup();
        let mut marked = vec![false; self.points.len()];
        for (key, _) in &wanted {
            key.iter().filter(|n| **n != NONE).for_each(|n| marked[*n as usize] = true);
        }
        for block in chosen {
            let parts = parts_of(block.shape, dimension - part);
            for corners in corners(block) {
                for facet in &parts {
                    if facet.iter().all(|c| marked[corners[*c] as usize]) {
                        let mut own = [NONE; 8];
                        own.iter_mut().zip(facet).for_each(|(o, c)| *o = corners[*c]);
                        if let Ok(k) = wanted.binary_search_by_key(&key(&own), |w| w.0) {
                            wanted[k].1 = true;
                        }
                    }
                }
            }
        }
        let mut tags = Vec::new();
        let across = |corners: &[u32; 8]| if part + 1 == dimension { crossed(chosen, corners) } else { None };
        for label in self.group_labels(part) {
            let (mut list, mut odd) = (Vec::new(), None);
            let own = facets.iter().filter(|b| b.groups.iter().any(|g| self.groups[*g].label() == label));
            for block in own {
                for (e, c) in corners(block).enumerate() {
                    let k = wanted.binary_search_by_key(&key(&c), |w| w.0).expect("every facet of a group is in the list");
                    match wanted[k].1 {
                        false => match across(&c) {
                            Some(cell) => return Err(FileError::Twisted { cell, facet: block.ids[e], group: label }),
                            None => odd = odd.or(Some(block.ids[e])),
                        },
                        true => list.push(std::array::from_fn(|k| if c[k] == NONE { usize::MAX } else { c[k] as usize })),
                    }
                }
            }
            if let Some(id) = odd.filter(|_| whole && !list.is_empty()) {
                if part + 1 < dimension {
                    continue;
                }
                let what = format!("element {id} of group \"{label}\" is no facet of a cell, others of the group are");
                return Err(FileError::Broken { what, spot: None });
            }
            if !list.is_empty() {
                tags.push(FacetTag { name: label, corners: list });
            }
        }
        Ok(tags)
    }
}

/// The number of a cell that has all `corners` of a facet; asked for facets that no cell has, it is a cell whose corners are out of order.
fn crossed(chosen: &[&MeshBlock], facet: &[u32; 8]) -> Option<u64> {
    let all = |own: &[u32; 8]| facet.iter().filter(|n| **n != NONE).all(|n| own.contains(n));
    chosen.iter().find_map(|block| corners(block).zip(&block.ids).find(|(own, _)| all(own)).map(|(_, id)| *id))
}

/// Index of a group by name, else by number.
fn find(groups: &[Group], dimension: usize, name: &str) -> Option<usize> {
    let of = |f: &dyn Fn(&Group) -> bool| groups.iter().position(|g| g.dimension == dimension && f(g));
    of(&|g| g.name.as_deref() == Some(name)).or_else(|| of(&|g| g.number.to_string() == name))
}

fn cell(block: &MeshBlock) -> Result<Cell, FileError> {
    match block.shape {
        CellShape::Triangle | CellShape::Tetrahedron => Ok(Cell::Simplex),
        CellShape::Prism | CellShape::Pyramid => {
            let what = format!("a body of {:?}s (element {})", block.shape, block.ids[0]).to_lowercase();
            Err(FileError::Unsupported { what, spot: None })
        }
        _ => Ok(Cell::Tensor),
    }
}

/// Corner points of every cell of a block, filled up with [`NONE`].
fn corners(block: &MeshBlock) -> impl Iterator<Item = [u32; 8]> {
    let p = block.order;
    let layer = (p + 1) * (p + 2) / 2;
    let places: Vec<usize> = match block.shape {
        CellShape::Point => vec![0],
        CellShape::Line => vec![0, p],
        CellShape::Triangle => vec![0, p, layer - 1],
        CellShape::Quadrilateral => vec![0, p, p * (p + 1), (p + 1) * (p + 1) - 1],
        CellShape::Tetrahedron => vec![0, p, layer - 1, (p + 1) * (p + 2) * (p + 3) / 6 - 1],
        CellShape::Hexahedron => {
            let n = p + 1;
            (0..8).map(|c| p * ((c & 1) + n * (c >> 1 & 1) + n * n * (c >> 2))).collect()
        }
        CellShape::Prism | CellShape::Pyramid => Vec::new(),
    };
    let per_cell = block.nodes.len() / block.ids.len().max(1);
    block.nodes.chunks_exact(per_cell.max(1)).map(move |nodes| {
        let mut list = [NONE; 8];
        list.iter_mut().zip(&places).for_each(|(c, place)| *c = nodes[*place]);
        list
    })
}

/// Facets of a cell, edges of a solid (two dimensions below it) and corners, by corners in the order of [`corners`].
fn parts_of(shape: CellShape, below: usize) -> Vec<Vec<usize>> {
    let count = match shape {
        CellShape::Triangle => 3,
        CellShape::Quadrilateral | CellShape::Tetrahedron => 4,
        CellShape::Hexahedron => 8,
        _ => 0,
    };
    match (below, shape.dimension()) {
        (1, _) => facets_of(shape).iter().map(|facet| facet.to_vec()).collect(),
        (2, 3) => {
            let is_edge = |a: usize, b: usize| shape == CellShape::Tetrahedron || (a ^ b).is_power_of_two();
            (0..count).flat_map(|b| (0..b).filter(move |&a| is_edge(a, b)).map(move |a| vec![a, b])).collect()
        }
        _ => (0..count).map(|c| vec![c]).collect(),
    }
}

/// Facets of a cell by corners in the order of [`corners`].
fn facets_of(shape: CellShape) -> &'static [&'static [usize]] {
    match shape {
        CellShape::Triangle => &[&[0, 1], &[1, 2], &[0, 2]],
        CellShape::Quadrilateral => &[&[0, 1], &[1, 3], &[2, 3], &[0, 2]],
        CellShape::Tetrahedron => &[&[0, 1, 2], &[0, 1, 3], &[0, 2, 3], &[1, 2, 3]],
        CellShape::Hexahedron => &[&[0, 1, 2, 3], &[4, 5, 6, 7], &[0, 1, 4, 5], &[2, 3, 6, 7], &[0, 2, 4, 6], &[1, 3, 5, 7]],
        _ => &[],
    }
}

fn key(corners: &[u32; 8]) -> Key {
    let mut key: Key = std::array::from_fn(|k| corners[k]);
    key.sort_unstable();
    key
}
