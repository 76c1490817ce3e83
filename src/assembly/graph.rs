//! Maps from elements to functions and back, and the matrix rows that follow from them, built in parallel.
//!
//! Every task owns a range of functions, visits the elements that reach them and writes only its own rows, in an order that does not
//! depend on the number of owners. Everything is linear in the number of entries, and nothing is sorted.

use super::simd_cells::{BATCH, Slot};
use crate::basis::{Basis, Listed};
use crate::linalg::{Buffer, Real};
use crate::parallel;
use std::ops::Range;

/// Functions of every element, and elements of every function.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    element_start: Vec<usize>,
    element_ids: Vec<u32>,
    cell_start: Vec<usize>,
    cells: Vec<(u32, u32)>,
}

/// Storage for the positions of element-matrix entries in their rows.
pub(super) struct Sites<'a, P> {
    pub places: &'a mut [P],
    /// Index in `places` of the first entry of every element; the others follow at steps of BATCH in the order of `entries`.
    pub first: &'a [usize],
    /// Order of the entries: `entries[n][b n + a]` is the number of entry (a, b) of an element with n functions.
    pub entries: &'a [Vec<usize>],
    /// Index in `places` from which on the greatest function of every element is at least the given one.
    pub begin: &'a (dyn Fn(usize) -> usize + Sync),
}

/// Ranges of items of about equal weight, one per owner; `sums`: weight before each item, with the total at the end.
pub(super) fn shares(sums: &[usize], owners: usize) -> Vec<Range<usize>> {
    let (items, all) = (sums.len() - 1, sums[sums.len() - 1]);
    let cut = |k: usize| if k == owners { items } else { sums.partition_point(|&s| s * owners < k * all).min(items) };
    (0..owners).map(|k| cut(k)..cut(k + 1)).collect()
}

/// Splits `data` into one slice per range; `ranges` follow one another from zero, and item i begins at `begin(i)`.
pub(super) fn parts<'a, X>(mut data: &'a mut [X], ranges: &[Range<usize>], begin: impl Fn(usize) -> usize) -> Vec<&'a mut [X]> {
    ranges
        .iter()
        .map(|range| {
            let (own, others) = std::mem::take(&mut data).split_at_mut(begin(range.end) - begin(range.start));
            data = others;
            own
        })
        .collect()
}

impl Graph {
    /// The functions of the elements of `basis`, and the elements of its functions.
    pub fn new<const D: usize, T: Real, B: Basis<D, T> + ?Sized>(basis: &B) -> Self {
        let (element_start, element_ids) = match basis.structure().listed() {
            Some(Listed { first, ids }) => (first.to_vec(), parallel::map(ids.len(), |k| ids[k] as u32)),
            None => asked(basis),
        };
        let mut graph = Self { element_start, element_ids, cell_start: Vec::new(), cells: Vec::new() };
        (graph.cell_start, graph.cells) = graph.transposed(basis.num_functions());
        graph
    }

    /// The elements of every function, ascending, with its number there.
    fn transposed(&self, functions: usize) -> (Vec<usize>, Vec<(u32, u32)>) {
        let owners = rayon::current_num_threads();
        let ranges: Vec<_> = (0..owners).map(|k| functions * k / owners..functions * (k + 1) / owners).collect();
        // counts shifted by two, so that the starts, shifted by one, can serve as insertion positions
        let mut start = vec![0usize; functions + 2];
        let counts = parts(&mut start[2..], &ranges, |i| i);
        parallel::for_each(counts.into_iter().zip(&ranges), |(counts, range)| {
            for &i in &self.element_ids {
                if let Some(count) = counts.get_mut((i as usize).wrapping_sub(range.start)) {
                    *count += 1;
                }
            }
        });
        for i in 0..functions {
            start[i + 2] += start[i + 1];
        }
        let mut cells = vec![(0u32, 0u32); self.element_ids.len()];
        let own_cells = parts(&mut cells, &ranges, |i| start[i + 1]);
        let begins: Vec<usize> = ranges.iter().map(|r| start[r.start + 1]).collect();
        let next = parts(&mut start[1..=functions], &ranges, |i| i);
        parallel::for_each(next.into_iter().zip(own_cells).zip(ranges.iter().zip(begins)), |((next, cells), (range, begin))| {
            for e in 0..self.num_elements() {
                for (a, &i) in self.ids(e).iter().enumerate() {
                    if let Some(next) = next.get_mut((i as usize).wrapping_sub(range.start)) {
                        cells[*next - begin] = (e as u32, a as u32);
                        *next += 1;
                    }
                }
            }
        });
        start.pop();
        (start, cells)
    }

    pub fn num_functions(&self) -> usize {
        self.cell_start.len() - 1
    }

    pub fn num_elements(&self) -> usize {
        self.element_start.len() - 1
    }

    /// Functions of `element`.
    #[inline]
    pub fn ids(&self, element: usize) -> &[u32] {
        &self.element_ids[self.element_start[element]..self.element_start[element + 1]]
    }

    /// (element, local number) of function `i`, elements ascending.
    #[inline]
    pub fn cells(&self, i: usize) -> &[(u32, u32)] {
        &self.cells[self.cell_start[i]..self.cell_start[i + 1]]
    }

    /// Row pointers: counts of neighbours.
    pub fn lengths(&self) -> Vec<usize> {
        let functions = self.num_functions();
        let ranges = shares(&self.cell_start, rayon::current_num_threads());
        let mut ptr = vec![0usize; functions + 1];
        parallel::for_each(parts(&mut ptr[1..], &ranges, |i| i).into_iter().zip(ranges), |(lengths, range)| {
            // the last row that counted this function, from one; zeroed pages that are never written take no memory
            let mut mark = vec![0u32; functions];
            for (length, i) in lengths.iter_mut().zip(range) {
                let stamp = i as u32 + 1;
                for &(e, _) in self.cells(i) {
                    for &j in self.ids(e as usize) {
                        let mark = &mut mark[j as usize];
                        *length += usize::from(*mark != stamp);
                        *mark = stamp;
                    }
                }
            }
        });
        for i in 0..functions {
            ptr[i + 1] += ptr[i];
        }
        ptr
    }

    /// Columns of all rows.
    pub fn columns(&self, ptr: &[usize]) -> Buffer<u32> {
        let none = Sites::<u16> { places: &mut [], first: &[], entries: &[], begin: &|_| 0 };
        self.rows::<false, _>(ptr, none, rayon::current_num_threads())
    }

    /// Columns of all rows, and the place of every entry of every element matrix in its row; quick where few elements reach the functions
    /// of several of `owners`.
    pub fn columns_and_places<P: Slot>(&self, ptr: &[usize], sites: Sites<'_, P>, owners: usize) -> Buffer<u32> {
        self.rows::<true, _>(ptr, sites, owners)
    }

    fn rows<const SITES: bool, P: Slot>(&self, ptr: &[usize], sites: Sites<'_, P>, owners: usize) -> Buffer<u32> {
        let mut cols = Buffer::<u32>::zeros(ptr[self.num_functions()]);
        let ranges = shares(ptr, owners);
        let own_cols = parts(&mut cols, &ranges, |i| ptr[i]);
        let Sites { places, first, entries, begin } = sites;
        let own_places = parts(&mut *places, &ranges, begin);
        let foreign: Vec<Vec<(usize, P)>> =
            parallel::map_each(own_cols.into_iter().zip(own_places).zip(&ranges), |((cols, places), range)| {
                let begin = |i| if SITES { begin(i) } else { 0 };
                let own = Sites { places, first, entries, begin: &begin };
                self.own_rows::<SITES, P>(ptr, range.clone(), cols, own)
            });
        for (at, place) in foreign.into_iter().flatten() {
            places[at] = place;
        }
        cols
    }

    /// Writes columns and positions of the rows of `range`; returns (index, position) of entries stored in slices of other owners.
    fn own_rows<const SITES: bool, P: Slot>(
        &self,
        ptr: &[usize],
        range: Range<usize>,
        cols: &mut [u32],
        sites: Sites<'_, P>,
    ) -> Vec<(usize, P)> {
        let (functions, base, from) = (self.num_functions(), ptr[range.start], (sites.begin)(range.start));
        let ptr = &ptr[range.clone()];
        let reached = (range.len() < functions).then(|| self.reached(&range));
        let mut foreign = Vec::new();
        // last column of every row, counted from one, and number of its columns
        let mut rows = vec![(0u32, 0u32); range.len()];
        for i in 0..functions {
            if reached.as_ref().is_some_and(|reached| !reached[i]) {
                continue;
            }
            let stamp = i as u32 + 1;
            for &(e, b) in self.cells(i) {
                let ids = self.ids(e as usize);
                let (n, b) = (ids.len(), b as usize);
                let (first, entries) = if SITES { (sites.first[e as usize], &sites.entries[n][b * n..][..n]) } else { (0, &[][..]) };
                for (a, &j) in ids.iter().enumerate() {
                    let own = (j as usize).wrapping_sub(range.start);
                    let Some((last, count)) = rows.get_mut(own) else { continue };
                    // the graph is symmetric: appending i to its neighbours for ascending i leaves every row sorted
                    *count += u32::from(*last != stamp);
                    *last = stamp;
                    let place = *count as usize - 1;
                    cols[ptr[own] - base + place] = i as u32;
                    if SITES {
                        let at = first + BATCH * entries[a];
                        match sites.places.get_mut(at.wrapping_sub(from)) {
                            Some(kept) => *kept = P::new(place as u32),
                            None => foreign.push((at, P::new(place as u32))),
                        }
                    }
                }
            }
        }
        foreign
    }

    /// Flags of the functions that share an element with one of `range`.
    fn reached(&self, range: &Range<usize>) -> Vec<bool> {
        let mut reached = vec![false; self.num_functions()];
        for e in 0..self.num_elements() {
            if self.ids(e).iter().any(|&i| range.contains(&(i as usize))) {
                self.ids(e).iter().for_each(|&i| reached[i as usize] = true);
            }
        }
        reached
    }
}

/// Starts and functions of all elements, by [`Basis::active`] element by element.
fn asked<const D: usize, T: Real, B: Basis<D, T> + ?Sized>(basis: &B) -> (Vec<usize>, Vec<u32>) {
    let elements = basis.num_elements();
    let (mut start, mut list, mut ids) = (Vec::with_capacity(elements + 1), Vec::new(), Vec::new());
    start.push(0);
    for e in 0..elements {
        basis.active(e, &mut ids);
        list.extend(ids.iter().map(|&i| i as u32));
        start.push(list.len());
    }
    (start, list)
}
