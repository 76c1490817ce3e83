//! Map from the file's numbers of points, which may have gaps, to indices.

use crate::FileError;
use crate::budget::Budget;

/// Largest length of a table over all numbers, as a multiple of the list of points; longer ones are not used.
const SPARSITY: u64 = 4;

/// Marks numbers without a point.
const NONE: u32 = u32::MAX;

/// Lookup of indices by numbers.
#[derive(Debug)]
pub(crate) enum Lookup {
    /// Numbers `first..first + count` in order.
    Run { first: u64, count: u64 },
    /// Index by number minus `first`.
    Table { first: u64, places: Vec<u32> },
    /// Numbers with their indices, ascending.
    Sorted(Vec<(u64, u32)>),
}

impl Lookup {
    /// Builds the lookup of points with the given numbers; the error is a repeated number.
    pub fn new(ids: &[u64], budget: &mut Budget) -> Result<Result<Self, u64>, FileError> {
        let first = ids.iter().copied().min().unwrap_or(1);
        let span = ids.iter().copied().max().unwrap_or(0).saturating_sub(first).saturating_add(1);
        if ids.iter().zip(first..).all(|(id, n)| *id == n) {
            return Ok(Ok(Self::Run { first, count: ids.len() as u64 }));
        }
        if span / SPARSITY <= ids.len() as u64 {
            let mut places = Vec::new();
            budget.room(&mut places, span as usize)?;
            places.resize(span as usize, NONE);
            for (k, id) in ids.iter().enumerate() {
                let place = &mut places[(id - first) as usize];
                if *place != NONE {
                    return Ok(Err(*id));
                }
                *place = k as u32;
            }
            return Ok(Ok(Self::Table { first, places }));
        }
        let mut sorted = Vec::new();
        budget.room(&mut sorted, ids.len())?;
        sorted.extend(ids.iter().copied().zip(0u32..));
        sorted.sort_unstable();
        Ok(match sorted.windows(2).find(|w| w[0].0 == w[1].0) {
            Some(w) => Err(w[0].0),
            None => Ok(Self::Sorted(sorted)),
        })
    }

    /// Index of the point with a number.
    #[inline]
    pub fn place(&self, id: u64) -> Option<u32> {
        match self {
            Self::Run { first, count } => id.checked_sub(*first).filter(|k| k < count).map(|k| k as u32),
            Self::Table { first, places } => {
                let k = usize::try_from(id.checked_sub(*first)?).ok()?;
                places.get(k).copied().filter(|p| *p != NONE)
            }
            Self::Sorted(list) => list.binary_search_by_key(&id, |e| e.0).ok().map(|k| list[k].1),
        }
    }
}
