//! Facets, edges and corners of cells, and the facets of the boundary.

use super::kinds::ElementKind;
use crate::CellShape;
use crate::budget::Budget;
use crate::gmsh::lexicographic;
use crate::{FileError, MeshBlock};
use std::collections::{BTreeMap, HashMap};

/// Marks a corner that a part does not have.
const NONE: u32 = u32::MAX;

/// Memory of an entry of a map and its lists, beside their items.
const ENTRY: u64 = 192;

/// The corners of a part, rising, filled up with [`NONE`].
type Key = [u32; 4];

/// A facet or an edge of the cells of a kind.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub shape: CellShape,
    /// Its nodes, first axis fastest, as places among those of the cell.
    places: Vec<usize>,
    /// Its corners, in the same way.
    corners: Vec<usize>,
}

impl Part {
    /// The part between corners of the cell, which are numbered as in the file and walked around.
    pub fn new(kind: ElementKind, ring: &[usize]) -> Self {
        let (p, lattice) = (kind.order, lexicographic(kind.shape, kind.order));
        let simplex = matches!(kind.shape, CellShape::Triangle | CellShape::Tetrahedron);
        let corner = |c: usize| -> [usize; 3] {
            let on = |k: usize| match (simplex, k) {
                (true, _) => c == k + 1,
                (false, 0) => [1, 2].contains(&(c % 4)),
                (false, 1) => c % 4 > 1,
                (false, _) => c > 3,
            };
            std::array::from_fn(|k| if on(k) { p } else { 0 })
        };
        let place = |x: [usize; 3]| lattice.iter().position(|l| *l == x).expect("a node of the cell");
        let shape = [CellShape::Point, CellShape::Line, CellShape::Triangle, CellShape::Quadrilateral][ring.len() - 1];
        let (a, b, c) = (corner(ring[0]), corner(ring[1 % ring.len()]), corner(ring[ring.len() - 1]));
        let node =
            |[i, j, _]: &[usize; 3]| -> [usize; 3] { std::array::from_fn(|k| (p * a[k] + i * b[k] + j * c[k] - (i + j) * a[k]) / p) };
        let places = lexicographic(shape, p).iter().map(|x| place(node(x))).collect();
        Self { shape, places, corners: ring.iter().map(|c| place(corner(*c))).collect() }
    }

    /// Its nodes in a cell.
    pub fn nodes(&self, cell: &[u32]) -> Vec<u32> {
        self.places.iter().map(|k| cell[*k]).collect()
    }

    fn key(&self, cell: &[u32]) -> Key {
        let mut key = [NONE; 4];
        key.iter_mut().zip(&self.corners).for_each(|(to, k)| *to = cell[*k]);
        key.sort_unstable();
        key
    }
}

/// The facets and the edges of every kind, made when they are asked for.
#[derive(Debug, Default)]
pub(super) struct Parts {
    known: Vec<(ElementKind, Vec<Part>, Vec<Vec<Part>>)>,
}

impl Parts {
    /// The facets of a kind in the order of their names, and the edges of each.
    pub fn of(&mut self, kind: ElementKind) -> (&[Part], &[Vec<Part>]) {
        let k = self.known.iter().position(|known| known.0 == kind).unwrap_or_else(|| {
            let rings: Vec<&[usize]> = (1..=kind.faces()).map(|k| kind.face(k)).collect();
            let edges = |ring: &&[usize]| (0..ring.len()).map(|k| Part::new(kind, &[ring[k], ring[(k + 1) % ring.len()]])).collect();
            let solid = kind.shape.dimension() == 3;
            self.known.push((
                kind,
                rings.iter().map(|ring| Part::new(kind, ring)).collect(),
                rings.iter().map(|ring| if solid { edges(ring) } else { Vec::new() }).collect(),
            ));
            self.known.len() - 1
        });
        (&self.known[k].1, &self.known[k].2)
    }
}

/// Cells of lower dimension with the groups that they are in.
#[derive(Debug, Default)]
pub(super) struct Tagged {
    cells: BTreeMap<(usize, Key), (CellShape, usize, Vec<u32>, Vec<usize>)>,
}

impl Tagged {
    /// Adds a part of a cell to a group.
    pub fn add(&mut self, kind: ElementKind, part: &Part, cell: &[u32], group: usize, budget: &mut Budget) -> Result<(), FileError> {
        self.put(part.shape, kind.order, part.key(cell), || part.nodes(cell), group, budget)
    }

    /// Takes out the cell that has the corners of the given one, and returns its groups.
    pub fn claim(&mut self, kind: ElementKind, cell: &[u32]) -> Vec<usize> {
        let ring: &[usize] = match kind.shape {
            CellShape::Line => &[0, 1],
            CellShape::Triangle => &[0, 1, 2],
            _ => &[0, 1, 2, 3],
        };
        let key = Part::new(kind, ring).key(cell);
        self.cells.remove(&(kind.shape.dimension(), key)).map_or(Vec::new(), |own| own.3)
    }

    /// Adds a point to a group.
    pub fn add_point(&mut self, node: u32, group: usize, budget: &mut Budget) -> Result<(), FileError> {
        self.put(CellShape::Point, 1, [node, NONE, NONE, NONE], || vec![node], group, budget)
    }

    fn put(
        &mut self,
        shape: CellShape,
        order: usize,
        key: Key,
        nodes: impl Fn() -> Vec<u32>,
        group: usize,
        budget: &mut Budget,
    ) -> Result<(), FileError> {
        budget.take(ENTRY)?;
        let own = self.cells.entry((shape.dimension(), key)).or_insert_with(|| (shape, order, nodes(), Vec::new()));
        if !own.3.contains(&group) {
            own.3.push(group);
        }
        Ok(())
    }

    /// Adds the cells to blocks, with numbers from `id` on; `place` has the final index of every group.
    pub fn into_blocks(self, place: &[usize], blocks: &mut BTreeMap<(CellShape, usize, Vec<usize>), MeshBlock>, mut id: u64) {
        for (shape, order, nodes, mut groups) in self.cells.into_values() {
            groups.iter_mut().for_each(|g| *g = place[*g]);
            groups.sort_unstable();
            let block = super::build::block(blocks, shape, order, groups);
            block.nodes.extend(nodes);
            block.ids.push(id);
            id = id.saturating_add(1);
        }
    }
}

/// A facet of the boundary: the cell and the number of its facet, from 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outer {
    pub cell: u32,
    pub facet: usize,
}

/// The facets of one cell only, and where they touch a node.
#[derive(Debug, Default)]
pub(super) struct Boundary {
    pub facets: Vec<Outer>,
    /// Pairs of a node and a facet, sorted.
    touching: Vec<(u32, u32)>,
}

impl Boundary {
    /// The boundary of the cells of a dimension: `cell` gives the kind and the nodes of a cell.
    pub fn new<'a>(
        cells: usize,
        dimension: usize,
        parts: &mut Parts,
        cell: impl Fn(usize) -> (ElementKind, &'a [u32]),
        budget: &mut Budget,
    ) -> Result<Self, FileError> {
        let mut seen: HashMap<Key, Option<Outer>> = HashMap::new();
        for e in 0..cells {
            let (kind, nodes) = cell(e);
            if kind.shape.dimension() != dimension {
                continue;
            }
            for (facet, part) in parts.of(kind).0.iter().enumerate() {
                budget.items(2, size_of::<(Key, Option<Outer>)>())?;
                let own = Some(Outer { cell: e as u32, facet });
                seen.entry(part.key(nodes)).and_modify(|first| *first = None).or_insert(own);
            }
        }
        let mut facets: Vec<Outer> = seen.into_values().flatten().collect();
        facets.sort_unstable_by_key(|f| (f.cell, f.facet));
        let mut touching = Vec::new();
        for (k, outer) in facets.iter().enumerate() {
            let (kind, nodes) = cell(outer.cell as usize);
            let own = &parts.of(kind).0[outer.facet];
            budget.room(&mut touching, own.corners.len())?;
            touching.extend(own.corners.iter().map(|c| (nodes[*c], k as u32)));
        }
        touching.sort_unstable();
        Ok(Self { facets, touching })
    }

    /// The facets that have one of `nodes` as a corner, rising.
    pub fn near(&self, nodes: &[u32]) -> Vec<usize> {
        let of = |node: u32| {
            let first = self.touching.partition_point(|t| t.0 < node);
            self.touching[first..].iter().take_while(move |t| t.0 == node).map(|t| t.1 as usize)
        };
        let mut all: Vec<usize> = nodes.iter().copied().flat_map(of).collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}
