//! Where the entries of element matrices go: places within the rows, found while the rows are made.

/// The place of every entry of every element matrix within its row of the scalar matrix.
#[derive(Clone, Debug)]
pub(in crate::assembly) struct Slots {
    /// Elements in the order in which their matrices are added: by least function, so that neighbours follow each other whatever
    /// their numbers are.
    pub order: Vec<u32>,
    /// Where the entries of an element begin, at place `a n + b` for the row of local function a.
    pub first: Vec<usize>,
    /// The places.
    pub places: Places,
}

/// Places in rows, in two bytes where all rows are short.
#[derive(Clone, Debug)]
pub(in crate::assembly) enum Places {
    Short(Vec<u16>),
    Long(Vec<u32>),
}

/// A place in a row.
pub(in crate::assembly) trait Place: Copy + Default + Send + Sync {
    /// The place `k`, which fits.
    fn new(k: u32) -> Self;
    fn get(self) -> usize;
}

impl Place for u16 {
    #[inline(always)]
    fn new(k: u32) -> Self {
        k as Self
    }
    #[inline(always)]
    fn get(self) -> usize {
        usize::from(self)
    }
}

impl Place for u32 {
    #[inline(always)]
    fn new(k: u32) -> Self {
        k
    }
    #[inline(always)]
    fn get(self) -> usize {
        self as usize
    }
}

/// Elements by least function, and where the entries of each begin when they are stored in that order: one entry per element, and the
/// number of all entries behind them. Linear in the number of ids.
pub(in crate::assembly) fn ordered<'a>(elements: usize, functions: usize, ids: impl Fn(usize) -> &'a [u32]) -> (Vec<u32>, Vec<usize>) {
    let least = |e: usize| ids(e).iter().min().map_or(functions, |&i| i as usize);
    let mut start = vec![0u32; functions + 2];
    for e in 0..elements {
        start[least(e) + 1] += 1;
    }
    for i in 0..=functions {
        start[i + 1] += start[i];
    }
    let mut order = vec![0u32; elements];
    for e in 0..elements {
        let place = &mut start[least(e)];
        order[*place as usize] = e as u32;
        *place += 1;
    }
    let (mut first, mut next) = (vec![0usize; elements + 1], 0);
    for &e in &order {
        first[e as usize] = next;
        next += ids(e as usize).len().pow(2);
    }
    first[elements] = next;
    (order, first)
}
