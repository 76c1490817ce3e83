//! Memory of a reader, counted before it is allocated.

use super::{FileError, Limits};

/// Bytes in use against the bytes allowed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    used: u64,
    most: u64,
}

impl Budget {
    /// Counts from the bytes of the file on, which are in memory already.
    pub fn new(limits: &Limits, file: usize) -> Self {
        Self { used: file as u64, most: limits.memory.unwrap_or(u64::MAX) }
    }

    /// Counts an allocation.
    pub fn take(&mut self, bytes: u64) -> Result<(), FileError> {
        let needed = self.used.saturating_add(bytes);
        if needed > self.most {
            return Err(FileError::Memory { needed, allowed: self.most });
        }
        self.used = needed;
        Ok(())
    }

    /// Counts `count` items of `size` bytes.
    pub fn items(&mut self, count: usize, size: usize) -> Result<(), FileError> {
        self.take((count as u64).saturating_mul(size as u64))
    }

    /// Counts memory given back.
    pub fn give(&mut self, bytes: u64) {
        self.used = self.used.saturating_sub(bytes);
    }

    /// Room for `extra` more items; grows by doubling, old and new memory counted while both are held.
    #[inline]
    pub fn room<T>(&mut self, list: &mut Vec<T>, extra: usize) -> Result<(), FileError> {
        if list.capacity() - list.len() >= extra {
            return Ok(());
        }
        self.grow(list, extra)
    }

    #[cold]
    fn grow<T>(&mut self, list: &mut Vec<T>, extra: usize) -> Result<(), FileError> {
        let least = list.len().saturating_add(extra);
        let doubled = least.max(list.capacity().saturating_mul(2)).max(8);
        let size = std::mem::size_of::<T>() as u64;
        let old = list.capacity() as u64 * size;
        let mut capacity = doubled;
        if self.take(doubled as u64 * size).is_err() {
            capacity = least;
            self.take(least as u64 * size)?;
        }
        list.reserve_exact(capacity - list.len());
        self.give(old);
        Ok(())
    }
}
