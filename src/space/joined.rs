//! Concatenation of several bases or spaces: elements one part after the other, functions under common numbers.

use super::Space;
use crate::basis::{Basis, BasisStructure, Block, Cell, Elements, Extracted, Order, Polynomials, ShapeTable, TensorPatch};
use crate::geometry::{Bounds, Geometry, MapBlock, MapStructure, MapTable};
use crate::linalg::{Real, Vector};
use std::collections::HashMap;
use std::sync::Arc;

/// The elements of all parts, one part after the other; functions and corners of each part in the numbering of the whole.
///
/// A part keeps its blocks, shifted: one block per patch for sum factorisation. Multipliers of the whole are those of
/// the parts, discontinuous between them.
#[derive(Clone, Debug)]
pub struct DirectSum<X> {
    parts: Vec<Part<X>>,
    functions: usize,
}

#[derive(Clone, Debug)]
struct Part<X> {
    inner: X,
    /// First element of the whole.
    first: usize,
    /// Function of the whole for each function of the part.
    ids: Vec<usize>,
    /// Corner of the whole for each corner id of the part.
    corners: HashMap<usize, usize>,
}

impl<X: Elements> DirectSum<X> {
    /// Joins parts, given with the numbers of their functions and corners in the whole.
    ///
    /// No two functions of one element may have the same number; see [`one_each`].
    pub(super) fn new(parts: Vec<(X, Vec<usize>, HashMap<usize, usize>)>, functions: usize) -> Self {
        let mut first = 0;
        let parts = parts
            .into_iter()
            .map(|(inner, ids, corners)| {
                let part = Part { first, ids, corners, inner };
                first += part.inner.num_elements();
                part
            })
            .collect();
        Self { parts, functions }
    }

    /// Part of an element, and the element's number there.
    #[inline]
    fn at(&self, element: usize) -> (&Part<X>, usize) {
        let part = &self.parts[self.parts.partition_point(|p| p.first <= element) - 1];
        (part, element - part.first)
    }

    /// Number of the part that holds `element`.
    pub fn part(&self, element: usize) -> usize {
        self.parts.partition_point(|p| p.first <= element) - 1
    }

    /// First element of every part.
    pub fn first_elements(&self) -> Vec<usize> {
        self.parts.iter().map(|p| p.first).collect()
    }
}

impl<X: Elements> Elements for DirectSum<X> {
    fn num_elements(&self) -> usize {
        self.parts.last().map_or(0, |p| p.first + p.inner.num_elements())
    }
    fn cell(&self, element: usize) -> Cell {
        let (part, e) = self.at(element);
        part.inner.cell(e)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        let (part, e) = self.at(element);
        part.inner.corners(e, ids);
        for id in ids {
            *id = part.corners[id];
        }
    }
}

impl<const D: usize, T: Real, X: Basis<D, T>> Basis<D, T> for DirectSum<X> {
    fn num_functions(&self) -> usize {
        self.functions
    }
    fn degree(&self, element: usize) -> [usize; D] {
        let (part, e) = self.at(element);
        part.inner.degree(e)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        let (part, e) = self.at(element);
        part.inner.active(e, ids);
        for id in ids {
            *id = part.ids[*id];
        }
    }
    fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
        let (part, e) = self.at(element);
        part.inner.tabulate(e, xi, order, table);
    }
    fn structure(&self) -> &dyn BasisStructure<D, T> {
        self
    }
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> {
        let mut functions = 0;
        let mut parts = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            let own = part.inner.polynomials(wanted)?;
            let ids = (functions..functions + own.num_functions()).collect();
            functions += own.num_functions();
            let corners = corner_ids(&own, &part.corners);
            parts.push((own, ids, corners));
        }
        Some(Box::new(DirectSum::new(parts, functions)))
    }
}

impl<const D: usize, T: Real, X: Basis<D, T>> BasisStructure<D, T> for DirectSum<X> {
    fn block(&self, element: usize) -> Option<Block<'_, D, T>> {
        let (part, e) = self.at(element);
        part.inner.structure().block(e).map(|block| Block { first: block.first + part.first, ..block })
    }
    fn patches(&self) -> Option<Vec<TensorPatch<'_, D, T>>> {
        let mut all = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            for mut patch in part.inner.structure().patches()? {
                patch.block.first += part.first;
                patch.ids = patch.ids.iter().map(|&i| part.ids[i]).collect();
                all.push(patch);
            }
        }
        Some(all)
    }
}

/// The corner numbers that polynomials on the elements of a part need: those of the part.
fn corner_ids<X: Elements>(part: &X, known: &HashMap<usize, usize>) -> HashMap<usize, usize> {
    let mut ids = Vec::new();
    let mut out = HashMap::new();
    for e in 0..part.num_elements() {
        part.corners(e, &mut ids);
        for &id in &ids {
            out.insert(id, known.get(&id).copied().unwrap_or(id));
        }
    }
    out
}

impl<const D: usize, const N: usize, T: Real, X: Geometry<D, N, T>> Geometry<D, N, T> for DirectSum<X> {
    fn map(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut MapTable<D, N, T>) {
        let (part, e) = self.at(element);
        part.inner.map(e, xi, order, table);
    }
    fn bounds(&self, element: usize) -> Bounds<N, T> {
        let (part, e) = self.at(element);
        part.inner.bounds(e)
    }
    fn all_bounds(&self) -> Vec<Bounds<N, T>> {
        self.parts.iter().flat_map(|part| part.inner.all_bounds()).collect()
    }
    fn extent(&self) -> Option<Bounds<N, T>> {
        self.parts.iter().filter_map(|part| part.inner.extent()).reduce(|a, b| a.union(&b))
    }
    fn map_structure(&self) -> &dyn MapStructure<D, N, T> {
        self
    }
}

impl<const D: usize, const N: usize, T: Real, X: Geometry<D, N, T>> MapStructure<D, N, T> for DirectSum<X> {
    fn is_affine(&self, element: usize) -> bool {
        let (part, e) = self.at(element);
        part.inner.map_structure().is_affine(e)
    }
    fn map_block(&self, element: usize) -> Option<MapBlock<'_, D, N, T>> {
        let (part, e) = self.at(element);
        part.inner.map_structure().map_block(e).map(|m| MapBlock { basis: Block { first: m.basis.first + part.first, ..m.basis }, ..m })
    }
}

impl<const D: usize, const N: usize, T: Real, X: Space<D, N, T>> Space<D, N, T> for DirectSum<X> {
    fn evaluate(&self, element: usize, xi: &[Vector<D, T>], order: Order, shapes: &mut ShapeTable<D, T>, map: &mut MapTable<D, N, T>) {
        let (part, e) = self.at(element);
        part.inner.evaluate(e, xi, order, shapes, map);
    }
}

/// Numbers the functions of `space` by `ids` so that no element has a number twice: where it would, functions of one number
/// become their sum. Returns the space and the numbers of its functions.
pub(super) fn one_each<const D: usize, const N: usize, T: Real>(
    space: &Arc<dyn Space<D, N, T>>,
    ids: Vec<usize>,
) -> (Arc<dyn Space<D, N, T>>, Vec<usize>) {
    let (mut active, mut numbers) = (Vec::new(), Vec::new());
    let twice = (0..space.num_elements()).any(|e| {
        space.active(e, &mut active);
        numbers.clear();
        numbers.extend(active.iter().map(|&i| ids[i]));
        numbers.sort_unstable();
        numbers.windows(2).any(|w| w[0] == w[1])
    });
    if !twice {
        return (space.clone(), ids);
    }
    let (mut place, mut own) = (HashMap::new(), Vec::new());
    let rows = ids
        .iter()
        .map(|&id| {
            let k = *place.entry(id).or_insert_with(|| {
                own.push(id);
                own.len() - 1
            });
            vec![(k, T::one())]
        })
        .collect();
    let basis = Extracted::new::<D>(space.clone(), own.len(), rows);
    (Arc::new(super::FunctionSpace { basis, geometry: space.clone() }), own)
}
