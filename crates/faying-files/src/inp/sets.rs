//! Named sets of numbers of nodes or elements.

use crate::FileError;
use crate::budget::Budget;
use std::collections::HashMap;

/// A place in one of the files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct At {
    /// The file: 0 is the first, others are included.
    pub file: u32,
    /// The line, from 1.
    pub line: u32,
}

/// The numbers `first`, `first + step`, ... up to `last`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    pub first: u64,
    pub last: u64,
    pub step: u64,
    /// Its place.
    pub at: At,
}

/// A set.
#[derive(Clone, Debug)]
pub(super) struct Set {
    /// Its name, as it was first written.
    pub name: String,
    pub ranges: Vec<Range>,
    /// Sets of elements whose nodes belong to it.
    pub of_elements: Vec<usize>,
}

/// Sets by name, whose case does not matter.
#[derive(Debug, Default)]
pub(super) struct Sets {
    pub list: Vec<Set>,
    places: HashMap<String, usize>,
}

/// Memory of a set beside its ranges and its name.
const SET: u64 = 256;

impl Sets {
    /// The index of a set, which begins here if it is new.
    pub fn place(&mut self, name: &str, budget: &mut Budget) -> Result<usize, FileError> {
        if let Some(known) = self.find(name) {
            return Ok(known);
        }
        budget.take(SET + 4 * name.len() as u64)?;
        self.places.insert(name.to_ascii_uppercase(), self.list.len());
        self.list.push(Set { name: name.to_owned(), ranges: Vec::new(), of_elements: Vec::new() });
        Ok(self.list.len() - 1)
    }

    /// The index of a set that is known.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.places.get(&name.to_ascii_uppercase()).copied()
    }

    /// Adds numbers to a set.
    pub fn add(&mut self, set: usize, range: Range, budget: &mut Budget) -> Result<(), FileError> {
        budget.room(&mut self.list[set].ranges, 1)?;
        self.list[set].ranges.push(range);
        Ok(())
    }

    /// Adds what another set has so far.
    pub fn add_set(&mut self, set: usize, other: usize, budget: &mut Budget) -> Result<(), FileError> {
        let count = self.list[other].ranges.len();
        budget.room(&mut self.list[set].ranges, count)?;
        for k in 0..count {
            let range = self.list[other].ranges[k];
            self.list[set].ranges.push(range);
        }
        let elements = self.list[other].of_elements.clone();
        budget.take(8 * elements.len() as u64)?;
        self.list[set].of_elements.extend(elements);
        Ok(())
    }
}

impl Set {
    /// Indices of its members, rising, by `place`, among things with the numbers `ids`.
    ///
    /// # Errors
    /// The number that nothing has, where it stands alone, and the place.
    pub fn members(&self, ids: &[u64], place: &dyn Fn(u64) -> Option<u32>) -> Result<Vec<u32>, (u64, At)> {
        let mut all = Vec::new();
        for range in &self.ranges {
            let within = |id: u64| (range.first..=range.last).contains(&id) && (id - range.first).is_multiple_of(range.step);
            if range.first == range.last {
                all.push(place(range.first).ok_or((range.first, range.at))?);
            } else if (range.last - range.first) / range.step > ids.len() as u64 {
                all.extend(ids.iter().zip(0u32..).filter(|(id, _)| within(**id)).map(|(_, k)| k));
            } else {
                all.extend((range.first..=range.last).step_by(range.step as usize).filter_map(place));
            }
        }
        all.sort_unstable();
        all.dedup();
        Ok(all)
    }
}
