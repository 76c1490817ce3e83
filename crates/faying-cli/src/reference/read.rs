//! Reading of a stored run: memory grows with the bytes read, never with declared sizes.

use super::numbers::{broken, exact, rounded};
use super::{MAGIC, StoredPatch, StoredRun, StoredSide};
use faying_files::{FileError, Limits, Spot};
use flate2::bufread::ZlibDecoder;
use std::cell::Cell;
use std::io::{self, Read};

/// Longest head that is read, in bytes: thousands of times a long one.
const LONGEST_HEAD: u64 = 16 << 20;
/// Bytes of all numbers that are read where no other limit is given.
const MOST_BYTES: u64 = 4 << 30;

/// The run that a file holds.
///
/// # Errors
/// [`FileError::Unsupported`] for another kind of file, [`FileError::Broken`] with the position of the error,
/// [`FileError::Memory`] where its numbers take more than allowed.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<StoredRun, FileError> {
    let Some(rest) = bytes.strip_prefix(MAGIC) else {
        let kind = MAGIC.iter().position(|b| *b == b'/').expect("the first line names a kind and a version");
        let what = if bytes.starts_with(&MAGIC[..kind]) { "this version of stored runs" } else { "a file that is no stored run" };
        return Err(FileError::Unsupported { what: what.into(), spot: Some(Spot::Byte(0)) });
    };
    let mut decoder = ZlibDecoder::new(rest);
    let allowed = limits.memory.unwrap_or(MOST_BYTES);
    let budget = Budget { used: Cell::new(bytes.len() as u64), allowed, over: Cell::new(false) };
    let done = whole_run(&mut decoder, &budget);
    let at = MAGIC.len() + usize::try_from(decoder.total_in()).unwrap_or(usize::MAX).min(rest.len());
    done.map_err(|e| match e.kind() {
        _ if budget.over.get() => FileError::Memory { needed: budget.used.get(), allowed },
        io::ErrorKind::UnexpectedEof => FileError::Broken { what: "the stored run ends too early".into(), spot: Some(Spot::Byte(at)) },
        _ => FileError::Broken { what: format!("the stored run is broken: {e}"), spot: Some(Spot::Byte(at)) },
    })
}

/// Memory of the numbers read so far, and its limit.
struct Budget {
    used: Cell<u64>,
    allowed: u64,
    over: Cell<bool>,
}

impl Budget {
    /// Counts the growth of a list by doubling before it happens.
    fn room<T>(&self, list: &mut Vec<T>) -> io::Result<()> {
        if list.len() < list.capacity() {
            return Ok(());
        }
        let more = list.capacity().max(64);
        self.used.set(self.used.get().saturating_add((more * size_of::<T>()) as u64));
        if self.used.get() > self.allowed {
            self.over.set(true);
            return Err(broken("it takes too much memory"));
        }
        list.reserve_exact(more);
        Ok(())
    }
}

fn whole_run(from: &mut ZlibDecoder<&[u8]>, budget: &Budget) -> io::Result<StoredRun> {
    let mut length = [0; 4];
    from.read_exact(&mut length)?;
    let length = u64::from(u32::from_le_bytes(length));
    if length > LONGEST_HEAD {
        return Err(broken(format!("its head of {length} bytes is too long")));
    }
    let mut head = Vec::new();
    if from.by_ref().take(length).read_to_end(&mut head)? as u64 != length {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    let mut run: StoredRun = serde_json::from_slice(&head).map_err(|e| broken(format!("its head is not understood: {e}")))?;
    if !(2..=3).contains(&run.dimension) || !(1..=run.dimension).contains(&run.components) || !run.t.is_finite() {
        return Err(broken("its head contradicts itself"));
    }
    for patch in &mut run.patches {
        lists(from, budget, patch, run.dimension)?;
    }
    for side in &mut run.sides {
        facets(from, budget, side, run.dimension)?;
    }
    // the end of the stream carries its checksum
    if from.read(&mut [0])? != 0 || !from.get_ref().is_empty() {
        return Err(broken("something follows its end"));
    }
    Ok(run)
}

fn lists(from: &mut ZlibDecoder<&[u8]>, budget: &Budget, patch: &mut StoredPatch, dimension: usize) -> io::Result<()> {
    let count = exact(from, &mut |l| budget.room(l))?;
    let directions = if count == [0.0] { 0 } else { dimension };
    if patch.degree.len() != dimension || patch.degree.contains(&0) || count != [directions as f64] {
        return Err(broken(format!("patch \"{}\" has degrees and elements of another dimension", patch.name)));
    }
    for _ in 0..directions {
        let list = exact(from, &mut |l| budget.room(l))?;
        if list.len() < 2 || list.windows(2).any(|w| w[0] >= w[1]) {
            return Err(broken(format!("the ends of the elements of patch \"{}\" do not increase", patch.name)));
        }
        patch.breakpoints.push(list);
    }
    patch.coefficients = rounded(from, &mut |l| budget.room(l))?;
    Ok(())
}

fn facets(from: &mut ZlibDecoder<&[u8]>, budget: &Budget, side: &mut StoredSide, dimension: usize) -> io::Result<()> {
    side.facets = exact(from, &mut |l| budget.room(l))?;
    let count = side.elements(dimension);
    let fits = count > 0 && count * (1 + dimension * dimension) == side.facets.len();
    if !fits || !(1..=dimension).contains(&side.components) {
        return Err(broken(format!("the facets of \"{}\" are not understood", side.name)));
    }
    side.values = rounded(from, &mut |l| budget.room(l))?;
    let expected = side
        .degree
        .checked_add(1)
        .and_then(|n| n.checked_pow(dimension as u32 - 1))
        .and_then(|n| n.checked_mul(count))
        .and_then(|n| n.checked_mul(side.components));
    if expected != Some(side.values.len()) {
        return Err(broken(format!("lambda of \"{}\" has {} numbers for {count} elements", side.name, side.values.len())));
    }
    Ok(())
}
