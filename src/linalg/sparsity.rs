//! Sparsity pattern of a matrix, with one 4-byte column index per square block of entries.

use super::Buffer;
use std::ops::Range;

/// Positions of the entries of a sparse matrix, with rows and columns in groups of `block`.
///
/// Rows of a group have the same columns, and a group of columns is stored whole or not at all: a field of c components
/// needs one column number per c x c entries. Block 1 is any matrix. Entries are numbered row by row, columns ascending,
/// whatever the block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sparsity {
    num_cols: usize,
    block: usize,
    ptr: Vec<usize>,
    cols: Buffer<u32>,
}

impl Default for Sparsity {
    /// Pattern without rows and columns.
    fn default() -> Self {
        Self { num_cols: 0, block: 1, ptr: vec![0], cols: Buffer::default() }
    }
}

impl Sparsity {
    /// The pattern of `block * num_cols` columns in which group i of rows owns the groups `cols[ptr[i]..ptr[i + 1]]` of columns, ascending.
    ///
    /// `ptr` has one entry more than there are groups of rows.
    ///
    /// # Panics
    /// If the lengths do not fit, if `block` is zero or if there are 2^32 columns or more.
    pub fn new(block: usize, num_cols: usize, ptr: Vec<usize>, cols: Vec<u32>) -> Self {
        Self::of(block, num_cols, ptr, cols.into())
    }

    pub(crate) fn of(block: usize, num_cols: usize, ptr: Vec<usize>, cols: Buffer<u32>) -> Self {
        assert!(block > 0, "a block has rows");
        assert_eq!(ptr.last().copied(), Some(cols.len()), "the last row pointer is the number of blocks");
        let num_cols = block * num_cols;
        assert!(u32::try_from(num_cols).is_ok(), "fewer than 2^32 columns");
        Self { num_cols, block, ptr, cols }
    }

    /// Rows and columns of a block.
    pub fn block(&self) -> usize {
        self.block
    }

    /// Number of rows.
    pub fn num_rows(&self) -> usize {
        self.block * (self.ptr.len() - 1)
    }

    /// Number of columns.
    pub fn num_cols(&self) -> usize {
        self.num_cols
    }

    /// Number of entries.
    pub fn num_entries(&self) -> usize {
        self.block * self.block * self.cols.len()
    }

    /// Numbers of the entries of row `i`.
    #[inline]
    pub fn entries(&self, i: usize) -> Range<usize> {
        if self.block == 1 {
            return self.ptr[i]..self.ptr[i + 1];
        }
        let (group, k) = (i / self.block, i % self.block);
        let width = self.block * (self.ptr[group + 1] - self.ptr[group]);
        let first = self.block * self.block * self.ptr[group] + k * width;
        first..first + width
    }

    /// Columns of row `i`.
    #[inline]
    pub fn row(&self, i: usize) -> Columns<'_> {
        let group = if self.block == 1 { i } else { i / self.block };
        let blocks = self.group(group);
        Columns { blocks, block: self.block, front: 0, back: 0, len: self.block * blocks.len() }
    }

    /// First block of every group of rows, and the number of blocks.
    pub(crate) fn ptr(&self) -> &[usize] {
        &self.ptr
    }

    /// Groups of columns of group `i` of rows.
    #[inline]
    pub(crate) fn group(&self, i: usize) -> &[u32] {
        &self.cols[self.ptr[i]..self.ptr[i + 1]]
    }

    /// Groups of columns of some groups of rows, one after the other.
    #[inline]
    pub(crate) fn groups(&self, rows: Range<usize>) -> &[u32] {
        &self.cols[self.ptr[rows.start]..self.ptr[rows.end]]
    }

    /// Number of the entry (k, l) of block `at` of group `i` of rows.
    #[inline]
    pub(crate) fn place(&self, i: usize, at: usize, k: usize, l: usize) -> usize {
        self.block * (self.block * self.ptr[i] + k * (self.ptr[i + 1] - self.ptr[i]) + at) + l
    }

    /// Pattern of the transposed matrix, and the new position of every block.
    pub(crate) fn transposed(&self) -> (Self, Vec<usize>) {
        let (groups, columns) = (self.ptr.len() - 1, self.num_cols / self.block);
        let mut ptr = vec![0usize; columns + 1];
        for &j in self.cols.iter() {
            ptr[j as usize + 1] += 1;
        }
        for j in 0..columns {
            ptr[j + 1] += ptr[j];
        }
        let (mut next, mut cols, mut target) = (ptr.clone(), Buffer::zeros(self.cols.len()), Vec::with_capacity(self.cols.len()));
        for i in 0..groups {
            for &j in self.group(i) {
                let k = next[j as usize];
                cols[k] = u32::try_from(i).expect("fewer than 2^32 rows");
                target.push(k);
                next[j as usize] += 1;
            }
        }
        (Self::of(self.block, groups, ptr, cols), target)
    }

    /// Bytes of the arrays.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.ptr) + size_of_val(&*self.cols)
    }
}

/// Columns of a row, ascending.
#[derive(Clone, Copy, Debug)]
pub struct Columns<'a> {
    blocks: &'a [u32],
    block: usize,
    /// Columns of the first block already consumed.
    front: usize,
    /// Columns of the last block already consumed.
    back: usize,
    len: usize,
}

impl Columns<'_> {
    /// Column number `k` of the remaining ones; `None` beyond the last.
    #[inline]
    pub fn get(&self, k: usize) -> Option<usize> {
        let at = self.front + k;
        (k < self.len).then(|| self.block * self.blocks[at / self.block] as usize + at % self.block)
    }

    /// Number of remaining columns below `j`, by binary search.
    #[inline]
    pub fn below(&self, j: usize) -> usize {
        let (group, k) = (j / self.block, j % self.block);
        let before = self.blocks.partition_point(|&b| (b as usize) < group);
        let part = if self.blocks.get(before).is_some_and(|&b| b as usize == group) { k } else { 0 };
        (self.block * before + part).saturating_sub(self.front).min(self.len)
    }

    /// Position of column `j` among the remaining ones; `None` if it is not among them.
    #[inline]
    pub fn position_of(&self, j: usize) -> Option<usize> {
        let k = self.below(j);
        (self.get(k) == Some(j)).then_some(k)
    }
}

impl Iterator for Columns<'_> {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        let j = self.block * self.blocks[0] as usize + self.front;
        self.front += 1;
        if self.front == self.block {
            self.front = 0;
            self.blocks = &self.blocks[1..];
        }
        Some(j)
    }

    #[inline]
    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.len, Some(self.len))
    }
}

impl DoubleEndedIterator for Columns<'_> {
    #[inline]
    fn next_back(&mut self) -> Option<usize> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        let last = self.blocks.len() - 1;
        let j = self.block * self.blocks[last] as usize + self.block - 1 - self.back;
        self.back += 1;
        if self.back == self.block {
            self.back = 0;
            self.blocks = &self.blocks[..last];
        }
        Some(j)
    }
}

impl ExactSizeIterator for Columns<'_> {}
