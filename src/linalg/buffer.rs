//! Memory of large arrays: mapped pages with a request for huge pages; the heap for smaller ones.
//!
//! Touching new memory for the first time costs a fault per page; pages of 2 MB instead of 4 kB leave few of them.

use std::fmt;
use std::ops::{Deref, DerefMut};

/// Arrays of fewer bytes stay on the heap, where freed memory is reused.
const LEAST_BYTES: usize = 4 << 20;

/// An array of fixed length.
pub(crate) enum Buffer<T> {
    Heap(Vec<T>),
    Pages(Box<dyn Pages<T>>),
}

/// An array in mapped pages.
pub(crate) trait Pages<T>: Send + Sync {
    fn values(&self) -> &[T];
    fn values_mut(&mut self) -> &mut [T];
}

impl<T: num_traits::Zero + Copy + 'static> Buffer<T> {
    /// `n` zeros, not touched yet.
    pub(crate) fn zeros(n: usize) -> Self {
        let pages = if n.saturating_mul(size_of::<T>()) < LEAST_BYTES { None } else { mapped(n) };
        pages.map_or_else(|| Self::Heap(vec![T::zero(); n]), Self::Pages)
    }

    /// `n` zeros; `None` if out of memory.
    pub(crate) fn try_zeros(n: usize) -> Option<Self> {
        let pages = if n.checked_mul(size_of::<T>())? < LEAST_BYTES { None } else { mapped(n) };
        if let Some(pages) = pages {
            return Some(Self::Pages(pages));
        }
        let mut values = Vec::new();
        values.try_reserve_exact(n).ok()?;
        values.resize(n, T::zero());
        Some(Self::Heap(values))
    }
}

impl<T> Default for Buffer<T> {
    fn default() -> Self {
        Self::Heap(Vec::new())
    }
}

impl<T> From<Vec<T>> for Buffer<T> {
    fn from(values: Vec<T>) -> Self {
        Self::Heap(values)
    }
}

impl<T> Deref for Buffer<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        match self {
            Self::Heap(values) => values,
            Self::Pages(pages) => pages.values(),
        }
    }
}

impl<T> DerefMut for Buffer<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        match self {
            Self::Heap(values) => values,
            Self::Pages(pages) => pages.values_mut(),
        }
    }
}

impl<T: num_traits::Zero + Copy + 'static> Clone for Buffer<T> {
    fn clone(&self) -> Self {
        let mut copy = Self::zeros(self.len());
        copy.copy_from_slice(self);
        copy
    }
}

impl<T: PartialEq> PartialEq for Buffer<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: Eq> Eq for Buffer<T> {}

impl<T: fmt::Debug> fmt::Debug for Buffer<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

/// Pages for `n` numbers of a type that bytes may be read as; `None` for other types and if the system has no such memory.
#[cfg(target_os = "linux")]
fn mapped<T: 'static>(n: usize) -> Option<Box<dyn Pages<T>>> {
    use std::any::{Any, TypeId};
    // the scalar is any real number: only its type tells that it is one of these
    let pages: Box<dyn Any> = if TypeId::of::<T>() == TypeId::of::<f64>() {
        Box::new(linux::pages::<f64>(n)?)
    } else if TypeId::of::<T>() == TypeId::of::<u32>() {
        Box::new(linux::pages::<u32>(n)?)
    } else if TypeId::of::<T>() == TypeId::of::<u16>() {
        Box::new(linux::pages::<u16>(n)?)
    } else {
        return None;
    };
    pages.downcast::<Box<dyn Pages<T>>>().ok().map(|pages| *pages)
}

#[cfg(not(target_os = "linux"))]
fn mapped<T: 'static>(_: usize) -> Option<Box<dyn Pages<T>>> {
    None
}

#[cfg(target_os = "linux")]
mod linux {
    use super::Pages;
    use memmap2::{Advice, MmapMut};

    struct Mapped(MmapMut);

    impl<T: bytemuck::Pod> Pages<T> for Mapped {
        #[inline]
        fn values(&self) -> &[T] {
            bytemuck::cast_slice(&self.0)
        }
        #[inline]
        fn values_mut(&mut self) -> &mut [T] {
            bytemuck::cast_slice_mut(&mut self.0)
        }
    }

    pub(super) fn pages<T: bytemuck::Pod>(n: usize) -> Option<Box<dyn Pages<T>>> {
        let map = MmapMut::map_anon(n.checked_mul(size_of::<T>())?).ok()?;
        // a system without huge pages ignores this and uses small ones
        let _ = map.advise(Advice::HugePage);
        Some(Box::new(Mapped(map)))
    }
}
