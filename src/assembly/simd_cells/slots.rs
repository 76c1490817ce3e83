//! Positions of element-matrix entries within the rows, found while the rows are built, batch by batch of cells.

use super::points::Kinds;
use crate::assembly::graph::{Graph, Sites, shares};
use crate::linalg::Buffer;
use crate::parallel;

/// Cells of a batch, whatever the number of lanes is.
pub(in crate::assembly) const BATCH: usize = 8;
/// Marker for no cell.
const NONE: u32 = u32::MAX;
/// One owner is faster if more than one in this many batches has functions of several owners.
const SCATTERED: usize = 4;

/// Up to BATCH cells of one reference cell.
#[derive(Clone, Debug)]
pub(in crate::assembly) struct Batch {
    cells: [u32; BATCH],
    /// Number of cells.
    pub count: usize,
    /// The reference cell of the functions.
    pub reference: usize,
    /// Functions per cell.
    pub functions: usize,
    /// The least function of all cells.
    pub least: u32,
    /// One more than the greatest function.
    pub end: u32,
    /// Index of its first place.
    pub first: usize,
    /// Index in the ids of [`Slots`] of the first function of its cells.
    ids: usize,
}

impl Batch {
    /// Elements of the batch.
    pub fn cells(&self) -> &[u32] {
        &self.cells[..self.count]
    }
}

/// The place of every entry of every element matrix within its row of the scalar matrix.
///
/// Entries (0, 0), (0, 1), (1, 0), (0, 2), (2, 0), .. (1, 1), (1, 2), (2, 1), .. of a batch follow one another, BATCH places each.
#[derive(Clone, Debug)]
pub(in crate::assembly) struct Slots {
    /// In the order in which their matrices are added: cells by greatest function. Rows are reached from the first to the last, so each is
    /// made ready shortly before it is added to, and cells that share their last function follow each other.
    pub batches: Vec<Batch>,
    /// The functions of the cells in the order of the batches: read from front to back, whatever order the elements have.
    ids: Vec<u32>,
    /// The places.
    pub places: RowPlaces,
}

/// Places in rows, in two bytes if all rows are short enough.
#[derive(Clone, Debug)]
pub(in crate::assembly) enum RowPlaces {
    Short(Buffer<u16>),
    Long(Buffer<u32>),
}

/// A place in a row.
pub(in crate::assembly) trait Slot: Copy + Send + Sync {
    /// The place `k`, which fits.
    fn new(k: u32) -> Self;
    fn get(self) -> usize;
}

impl Slot for u16 {
    #[inline(always)]
    fn new(k: u32) -> Self {
        k as Self
    }
    #[inline(always)]
    fn get(self) -> usize {
        usize::from(self)
    }
}

impl Slot for u32 {
    #[inline(always)]
    fn new(k: u32) -> Self {
        k
    }
    #[inline(always)]
    fn get(self) -> usize {
        self as usize
    }
}

impl Slots {
    /// Columns of the rows that begin at `ptr`, and the places in them; `references` names the reference cell of every element.
    pub fn new(graph: &Graph, references: &[usize], ptr: &[usize]) -> (Buffer<u32>, Self) {
        let (batches, ids, first) = batched(graph, references);
        let longest = ptr.windows(2).map(|w| w[1] - w[0]).max().unwrap_or(0);
        let most = batches.iter().map(|b| b.functions).max().unwrap_or(0);
        let mut entries = vec![Vec::new(); most + 1];
        for batch in &batches {
            if entries[batch.functions].is_empty() {
                entries[batch.functions] = ordered_entries(batch.functions);
            }
        }
        let all = first[graph.num_elements()];
        // one more than the greatest function of the first cell: it never falls from batch to batch
        let reach = |b: &Batch| ids[b.ids..][..b.functions].iter().max().map_or(0, |&i| i as usize + 1);
        let begin = |i: usize| match batches.partition_point(|b| reach(b) <= i) {
            k if k < batches.len() => batches[k].first,
            _ => all,
        };
        let owners = owners(&batches, ptr);
        if longest <= usize::from(u16::MAX) {
            let mut places = Buffer::<u16>::zeros(all);
            let sites = Sites { places: &mut places, first: &first, entries: &entries, begin: &begin };
            let cols = graph.columns_and_places(ptr, sites, owners);
            (cols, Self { batches, ids, places: RowPlaces::Short(places) })
        } else {
            let mut places = Buffer::<u32>::zeros(all);
            let sites = Sites { places: &mut places, first: &first, entries: &entries, begin: &begin };
            let cols = graph.columns_and_places(ptr, sites, owners);
            (cols, Self { batches, ids, places: RowPlaces::Long(places) })
        }
    }

    /// The functions of the cells of `batch`, one list after the other.
    pub fn ids(&self, batch: &Batch) -> impl Iterator<Item = &[u32]> {
        self.ids[batch.ids..][..batch.count * batch.functions].chunks_exact(batch.functions.max(1))
    }
}

/// Number of owners that build the rows: one if too many batches have functions of several owners.
fn owners(batches: &[Batch], ptr: &[usize]) -> usize {
    let owners = rayon::current_num_threads();
    let ranges = shares(ptr, owners);
    let owner = |i: u32| ranges.partition_point(|r| r.end <= i as usize);
    let cut = batches.iter().filter(|b| owner(b.least) != owner(b.end.saturating_sub(1))).count();
    if cut * SCATTERED > batches.len() { 1 } else { owners }
}

/// The entry of row a and column b of n x n at `b n + a`, in the order of [`Slots`].
fn ordered_entries(n: usize) -> Vec<usize> {
    let (mut entries, mut next) = (vec![0; n * n], 0);
    for a in 0..n {
        entries[a * n + a] = next;
        for (k, b) in (a + 1..n).enumerate() {
            entries[b * n + a] = next + 1 + 2 * k;
            entries[a * n + b] = next + 2 + 2 * k;
        }
        next += 1 + 2 * (n - 1 - a);
    }
    entries
}

/// Batches of cells by greatest function, their functions, and the index of the first entry of every element, followed by the number of all
/// places. Linear in the number of ids.
fn batched(graph: &Graph, references: &[usize]) -> (Vec<Batch>, Vec<u32>, Vec<usize>) {
    let (elements, functions) = (graph.num_elements(), graph.num_functions());
    let span = |e: usize| graph.ids(e).iter().fold((functions as u32, 0), |(lo, hi), &i| (lo.min(i), hi.max(i + 1)));
    let spans: Vec<(u32, u32)> = parallel::map(elements, span);
    let mut start = vec![0u32; functions + 2];
    for span in &spans {
        start[span.1 as usize + 1] += 1;
    }
    for i in 0..=functions {
        start[i + 1] += start[i];
    }
    let mut order = vec![0u32; elements];
    for (e, span) in spans.iter().enumerate() {
        let place = &mut start[span.1 as usize];
        order[*place as usize] = e as u32;
        *place += 1;
    }
    let mut batches: Vec<Batch> = Vec::with_capacity(elements / BATCH + 1);
    let (mut first, mut next, mut ids) = (vec![0usize; elements + 1], 0, Vec::<u32>::new());
    let all: usize = (0..elements).map(|e| graph.ids(e).len()).sum();
    ids.reserve_exact(all + BATCH * BATCH);
    // the last batch of every kind: there are few
    let mut open = Kinds::default();
    for &e in &order {
        let (least, end) = spans[e as usize];
        let own = graph.ids(e as usize);
        let (reference, n) = (references[e as usize], own.len());
        let kind = open.place((reference, n), |_| Some(usize::MAX)).expect("every kind is kept");
        if batches.get(open.of[kind]).is_none_or(|b| b.count == BATCH) {
            open.of[kind] = batches.len();
            batches.push(Batch { cells: [NONE; BATCH], count: 0, reference, functions: n, least, end, first: next, ids: ids.len() });
            next += BATCH * n * n;
            ids.resize(ids.len() + BATCH * n, NONE);
        }
        let batch = &mut batches[open.of[kind]];
        batch.cells[batch.count] = e;
        first[e as usize] = batch.first + batch.count;
        ids[batch.ids + batch.count * n..][..n].copy_from_slice(own);
        batch.count += 1;
        batch.least = batch.least.min(least);
        batch.end = batch.end.max(end);
    }
    first[elements] = next;
    (batches, ids, first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_numbered_in_pairs() {
        for n in 0..6 {
            let entries = ordered_entries(n);
            let mut expected = Vec::new();
            for a in 0..n {
                expected.push((a, a));
                (a + 1..n).for_each(|b| expected.extend([(a, b), (b, a)]));
            }
            assert_eq!(expected.len(), n * n);
            assert!(expected.iter().enumerate().all(|(k, (a, b))| entries[b * n + a] == k), "{n}");
        }
    }
}
