//! The mesh of what an input file holds.

use super::facets::{Boundary, Part, Parts, Tagged};
use super::kinds::ElementKind;
use super::lines::{Element, Found, in_file};
use super::sets::At;
use crate::budget::Budget;
use crate::gmsh::Lookup;
use crate::serendipity::{Completion, MISSING};
use crate::text::broken;
use crate::vtu_mesh::places;
use crate::{CellShape, FileError, Format, Group, MeshBlock, MeshFile};
use std::collections::{BTreeMap, HashMap};

/// The block of a shape, an order and a set of groups.
pub(super) fn block(
    blocks: &mut BTreeMap<(CellShape, usize, Vec<usize>), MeshBlock>,
    shape: CellShape,
    order: usize,
    groups: Vec<usize>,
) -> &mut MeshBlock {
    blocks.entry((shape, order, groups)).or_insert_with_key(|key| MeshBlock {
        shape,
        order,
        nodes: Vec::new(),
        ids: Vec::new(),
        groups: key.2.clone(),
    })
}

/// Groups by dimension and name, in the order in which they are met.
#[derive(Debug, Default)]
struct Groups {
    list: Vec<(usize, String)>,
    places: HashMap<(usize, String), usize>,
}

impl Groups {
    fn place(&mut self, dimension: usize, name: &str) -> usize {
        *self.places.entry((dimension, name.to_owned())).or_insert_with(|| {
            self.list.push((dimension, name.to_owned()));
            self.list.len() - 1
        })
    }

    /// The groups by dimension, numbered within each from 1, and the new index of every group.
    fn sorted(self) -> (Vec<Group>, Vec<usize>) {
        let mut order: Vec<usize> = (0..self.list.len()).collect();
        order.sort_by_key(|k| self.list[*k].0);
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, old)| place[*old] = new);
        let mut numbers = [0; 4];
        let group = |k: usize| {
            let (dimension, name) = &self.list[k];
            numbers[*dimension] += 1;
            Group { dimension: *dimension, number: numbers[*dimension], name: Some(name.clone()) }
        };
        (order.into_iter().map(group).collect(), place)
    }
}

/// The mesh while it is made.
struct MeshBuilder {
    found: Found,
    budget: Budget,
    points: Lookup,
    elements: Lookup,
    element_ids: Vec<u64>,
    /// Nodes of all cells, first axis fastest, and where those of each begin.
    nodes: Vec<u32>,
    starts: Vec<usize>,
    /// Points that the file has; others were added.
    given: usize,
    parts: Parts,
    groups: Groups,
    tagged: Tagged,
}

/// Makes the mesh.
pub(super) fn mesh((found, budget): (Found, Budget)) -> Result<MeshFile, FileError> {
    let mut made = MeshBuilder::new(found, budget)?;
    made.cells()?;
    let members = made.element_sets()?;
    made.surfaces()?;
    made.node_sets()?;
    made.finish(members)
}

/// The lookup of numbers; an error with the place of the second of two that are equal.
fn lookup(ids: &[u64], at: impl Fn(usize) -> At, what: &str, included: &[String], budget: &mut Budget) -> Result<Lookup, FileError> {
    Lookup::new(ids, budget)?.map_err(|id| {
        let second = ids.iter().enumerate().filter(|(_, other)| **other == id).nth(1).map_or(At::default(), |(k, _)| at(k));
        in_file(broken(second.line as usize, format!("{what} {id} stands twice")), second, included)
    })
}

/// Puts the node of a line between the two that are farthest apart into the middle.
fn middle_second(nodes: &mut [u32], points: &[[f64; 3]]) {
    let apart = |a: usize, b: usize| (0..3).map(|k| (points[nodes[a] as usize][k] - points[nodes[b] as usize][k]).powi(2)).sum::<f64>();
    let (own, first, last) = (apart(0, 2), apart(1, 2), apart(0, 1));
    if first > own && first >= last {
        nodes.swap(0, 1);
    } else if last > own {
        nodes.swap(1, 2);
    }
}

impl MeshBuilder {
    fn new(found: Found, mut budget: Budget) -> Result<Self, FileError> {
        let points = lookup(&found.ids, |k| found.point_at[k], "node", &found.included, &mut budget)?;
        budget.items(found.elements.len(), 8)?;
        let element_ids: Vec<u64> = found.elements.iter().map(|e| e.id).collect();
        let elements = lookup(&element_ids, |k| found.elements[k].at, "element", &found.included, &mut budget)?;
        Ok(Self {
            given: found.points.len(),
            found,
            budget,
            points,
            elements,
            element_ids,
            nodes: Vec::new(),
            starts: vec![0],
            parts: Parts::default(),
            groups: Groups::default(),
            tagged: Tagged::default(),
        })
    }

    fn broken(&self, at: At, what: String) -> FileError {
        in_file(broken(at.line as usize, what), at, &self.found.included)
    }

    fn cell(&self, e: usize) -> (ElementKind, &[u32]) {
        (self.found.elements[e].kind, &self.nodes[self.starts[e]..self.starts[e + 1]])
    }

    fn dimension(&self) -> usize {
        self.found.elements.iter().map(|e| e.kind.shape.dimension()).max().unwrap_or(0)
    }

    /// Finds the nodes of the cells, and adds those that the file leaves out.
    fn cells(&mut self) -> Result<(), FileError> {
        let mut orders: Vec<(ElementKind, Vec<usize>)> = Vec::new();
        let mut completion = Completion::default();
        for e in 0..self.found.elements.len() {
            let Element { id, kind, first, at } = self.found.elements[e];
            let k = orders.iter().position(|o| o.0 == kind).unwrap_or_else(|| {
                orders.push((kind, places(kind.shape, kind.order)));
                orders.len() - 1
            });
            let (order, start) = (&orders[k].1, self.nodes.len());
            self.budget.room(&mut self.nodes, order.len())?;
            self.budget.room(&mut self.starts, 1)?;
            self.nodes.resize(start + order.len(), MISSING);
            for (place, number) in order.iter().zip(&self.found.nodes[first..first + kind.nodes]) {
                let Some(node) = self.points.place(*number) else {
                    return Err(self.broken(at, format!("element {id} refers to node {number}, which is in no *NODE")));
                };
                self.nodes[start + place] = node;
            }
            if (kind.shape, kind.order) == (CellShape::Line, 2) {
                middle_second(&mut self.nodes[start..], &self.found.points);
            }
            if kind.is_incomplete() {
                completion.complete(kind.shape, &mut self.nodes[start..], &mut self.found.points, &mut self.budget)?;
            }
            self.starts.push(self.nodes.len());
        }
        let added = self.found.points.len() - self.given;
        if added > 0 {
            self.found.notes.push(format!("{added} nodes were added in the middle of faces and cells of order 2, which keep their shape"));
        }
        Ok(())
    }

    /// Pairs of an element and a group, sorted.
    fn element_sets(&mut self) -> Result<Vec<(u32, usize)>, FileError> {
        let mut pairs = Vec::new();
        for set in 0..self.found.element_sets.list.len() {
            let members = self.members(false, set)?;
            self.budget.room(&mut pairs, members.len())?;
            for e in members {
                let dimension = self.found.elements[e as usize].kind.shape.dimension();
                let group = self.groups.place(dimension, &self.found.element_sets.list[set].name);
                pairs.push((e, group));
            }
        }
        pairs.sort_unstable();
        Ok(pairs)
    }

    /// Indices of the members of a set, rising.
    fn members(&self, of_nodes: bool, set: usize) -> Result<Vec<u32>, FileError> {
        let (sets, ids, lookup, what) = match of_nodes {
            true => (&self.found.node_sets, &self.found.ids, &self.points, "node"),
            false => (&self.found.element_sets, &self.element_ids, &self.elements, "element"),
        };
        let set = &sets.list[set];
        let unknown = |(id, at): (u64, At)| self.broken(at, format!("set \"{}\" has {what} {id}, which the file does not have", set.name));
        set.members(ids, &|id| lookup.place(id)).map_err(unknown)
    }

    fn surfaces(&mut self) -> Result<(), FileError> {
        for (name, list) in std::mem::take(&mut self.found.surfaces) {
            for faces in list {
                let elements = match faces.set {
                    Some(set) => self.members(false, set)?,
                    None => {
                        let unknown = || {
                            self.broken(faces.at, format!("surface \"{name}\" has element {}, which the file does not have", faces.element))
                        };
                        vec![self.elements.place(faces.element).ok_or_else(unknown)?]
                    }
                };
                for e in elements {
                    let Element { id, kind, .. } = self.found.elements[e as usize];
                    if kind.face(faces.face).is_empty() {
                        return Err(self.broken(faces.at, format!("element {id} has no face S{} that is read", faces.face)));
                    }
                    let group = self.groups.place(kind.shape.dimension() - 1, &name);
                    let part = &self.parts.of(kind).0[faces.face - 1];
                    let nodes = &self.nodes[self.starts[e as usize]..self.starts[e as usize + 1]];
                    self.tagged.add(kind, part, nodes, group, &mut self.budget)?;
                }
            }
        }
        Ok(())
    }

    /// Sides, edges and points of sets of nodes.
    fn node_sets(&mut self) -> Result<(), FileError> {
        if self.found.node_sets.list.is_empty() {
            return Ok(());
        }
        let dimension = self.dimension();
        let (elements, nodes, starts) = (&self.found.elements, &self.nodes, &self.starts);
        let cell = |e: usize| (elements[e].kind, &nodes[starts[e]..starts[e + 1]]);
        let boundary = Boundary::new(elements.len(), dimension, &mut self.parts, cell, &mut self.budget)?;
        let corner = self.corners(dimension)?;
        self.budget.items(2, self.found.points.len())?;
        let mut marks = [vec![false; self.found.points.len()], vec![false; self.found.points.len()]];
        for set in 0..self.found.node_sets.list.len() {
            let mut own = self.members(true, set)?;
            for elements in self.found.node_sets.list[set].of_elements.clone() {
                for e in self.members(false, elements)? {
                    own.extend(self.cell(e as usize).1.iter().filter(|n| (**n as usize) < self.given));
                }
            }
            own.sort_unstable();
            own.dedup();
            // all nodes of a file are no side
            if own.len() < self.given {
                self.node_set(set, &own, (dimension, &boundary), &corner, &mut marks)?;
            }
        }
        Ok(())
    }

    /// Whether a point is a corner of a cell of the highest dimension.
    fn corners(&mut self, dimension: usize) -> Result<Vec<bool>, FileError> {
        self.budget.items(1, self.found.points.len())?;
        let mut corner = vec![false; self.found.points.len()];
        for e in 0..self.found.elements.len() {
            let kind = self.found.elements[e].kind;
            if kind.shape.dimension() == dimension {
                let corners: &[usize] = match kind.shape {
                    CellShape::Prism | CellShape::Pyramid | CellShape::Line => &[],
                    CellShape::Triangle => &[0, 1, 2],
                    CellShape::Hexahedron => &[0, 1, 2, 3, 4, 5, 6, 7],
                    _ => &[0, 1, 2, 3],
                };
                for c in corners {
                    let number = self.found.nodes[self.found.elements[e].first + c];
                    self.points.place(number).iter().for_each(|n| corner[*n as usize] = true);
                }
            }
        }
        Ok(corner)
    }

    fn node_set(
        &mut self,
        set: usize,
        own: &[u32],
        (dimension, boundary): (usize, &Boundary),
        corner: &[bool],
        [marked, used]: &mut [Vec<bool>; 2],
    ) -> Result<(), FileError> {
        own.iter().for_each(|n| marked[*n as usize] = true);
        let name = self.found.node_sets.list[set].name.clone();
        let near = boundary.near(own);
        for of_edges in [false, true] {
            for outer in near.iter().map(|k| boundary.facets[*k]) {
                let (kind, start) = (self.found.elements[outer.cell as usize].kind, outer.cell as usize);
                let cell = &self.nodes[self.starts[start]..self.starts[start + 1]];
                let (facets, edges) = self.parts.of(kind);
                let parts: &[Part] = if of_edges { &edges[outer.facet] } else { &facets[outer.facet..=outer.facet] };
                for part in parts {
                    let nodes = part.nodes(cell);
                    if nodes.iter().all(|n| *n as usize >= self.given || marked[*n as usize]) {
                        let group = self.groups.place(part.shape.dimension(), &name);
                        self.tagged.add(kind, part, cell, group, &mut self.budget)?;
                        nodes.iter().for_each(|n| used[*n as usize] = true);
                    }
                }
            }
            if dimension < 3 || own.iter().any(|n| used[*n as usize]) {
                break;
            }
        }
        if own.iter().all(|n| !used[*n as usize]) {
            for n in own.iter().filter(|n| corner[**n as usize]) {
                let group = self.groups.place(0, &name);
                self.tagged.add_point(*n, group, &mut self.budget)?;
                used[*n as usize] = true;
            }
        }
        let left = own.iter().filter(|n| !used[**n as usize]).count();
        if left > 0 {
            self.found
                .notes
                .push(format!("{left} of {} nodes of the set \"{name}\" are on no facet that all lie in it, and are left out", own.len()));
        }
        for n in own {
            (marked[*n as usize], used[*n as usize]) = (false, false);
        }
        Ok(())
    }

    fn finish(mut self, members: Vec<(u32, usize)>) -> Result<MeshFile, FileError> {
        let dimension = self.dimension();
        let (groups, place) = std::mem::take(&mut self.groups).sorted();
        let mut blocks = BTreeMap::new();
        let mut rest = &members[..];
        for (e, element) in self.found.elements.iter().enumerate() {
            let own = rest.partition_point(|m| m.0 as usize <= e);
            let nodes = &self.nodes[self.starts[e]..self.starts[e + 1]];
            // a facet that the file has as an element is that element
            let facet = element.kind.shape.dimension() < dimension;
            let more = if facet { self.tagged.claim(element.kind, nodes) } else { Vec::new() };
            let mut list: Vec<usize> = rest[..own].iter().map(|m| m.1).chain(more).map(|g| place[g]).collect();
            list.sort_unstable();
            list.dedup();
            rest = &rest[own..];
            let block = block(&mut blocks, element.kind.shape, element.kind.order, list);
            self.budget.room(&mut block.nodes, nodes.len())?;
            self.budget.room(&mut block.ids, 1)?;
            block.nodes.extend_from_slice(nodes);
            block.ids.push(element.id);
        }
        let next = |ids: &[u64]| ids.iter().copied().max().unwrap_or(0).saturating_add(1);
        self.tagged.into_blocks(&place, &mut blocks, next(&self.element_ids));
        let mut ids = self.found.ids;
        let added = self.found.points.len() - ids.len();
        self.budget.room(&mut ids, added)?;
        ids.extend((next(&ids)..).take(added));
        let Found { points, notes, .. } = self.found;
        Ok(MeshFile { format: Format::Abaqus, points, ids, blocks: blocks.into_values().collect(), groups, notes })
    }
}
