//! Lists of knots to insert into the knot vectors of a file (`.ref`).

use super::super::text::{Words, broken, shown};
use super::super::{FileError, SplineFile, SplinePatch};
use faying::geometry::ControlNet;

/// Reads a list: the number of knot vectors, then for each the number of knots and the knots.
///
/// # Errors
/// [`FileError::Broken`] with the line.
///
/// ```
/// let list = faying_files::mfem::refinement_list(b"2\n2 0.2 0.5\n1 0.5")?;
/// assert_eq!(list, [vec![0.2, 0.5], vec![0.5]]);
/// # Ok::<(), faying_files::FileError>(())
/// ```
pub fn refinement_list(text: &[u8]) -> Result<Vec<Vec<f64>>, FileError> {
    let mut words = Words::new(text, 1).with_comments();
    let count = words.count("knot vectors", 1)?;
    let mut list = Vec::with_capacity(count);
    for _ in 0..count {
        let knots = words.count("knots", 1)?;
        let mut all = Vec::with_capacity(knots);
        for _ in 0..knots {
            all.push(words.number("a knot")?);
        }
        list.push(all);
    }
    let line = words.line();
    match words.next() {
        None => Ok(list),
        Some(word) => Err(broken(line, format!("the list is complete, but \"{}\" follows", shown(word)))),
    }
}

impl SplineFile {
    /// Inserts the knots of `list`, one entry per knot vector of the file, into every patch that uses the vector.
    ///
    /// # Errors
    /// [`FileError::Broken`] if the file does not number its knot vectors or has another number of them, or if a knot cannot be
    /// inserted.
    pub fn refined(&self, list: &[Vec<f64>]) -> Result<Self, FileError> {
        let fail = |what: String| Err(FileError::Broken { what, spot: None });
        if self.patches.iter().any(|p| p.uses.len() != p.dimension()) {
            return fail("a list of knots needs a file that numbers its knot vectors: MFEM meshes do".to_string());
        }
        let count = self.patches.iter().flat_map(|p| &p.uses).map(|u| u.vector + 1).max().unwrap_or(0);
        if list.len() != count {
            return fail(format!("the list of knots is for {} knot vectors, the mesh has {count}", list.len()));
        }
        let mut finer = self.clone();
        for patch in &mut finer.patches {
            match patch.dimension() {
                1 => insert::<1>(patch, list)?,
                2 => insert::<2>(patch, list)?,
                _ => insert::<3>(patch, list)?,
            }
        }
        Ok(finer)
    }
}

fn insert<const D: usize>(patch: &mut SplinePatch, list: &[Vec<f64>]) -> Result<(), FileError> {
    let mut net: ControlNet<D, 3> = patch.net()?;
    for d in 0..D {
        let knots = &patch.knots[d];
        let sum = knots[0] + knots[knots.len() - 1];
        let used = patch.uses[d];
        let turned: Vec<f64> = list[used.vector].iter().map(|t| if used.reversed { sum - t } else { *t }).collect();
        let refused = |e| FileError::Broken { what: format!("knots for the knot vector {}: {e}", used.vector), spot: None };
        net = net.insert(d, &turned).map_err(refused)?;
    }
    patch.knots = net.axes.iter().map(|a| a.knots().to_vec()).collect();
    patch.points = net.points.iter().map(|p| std::array::from_fn(|k| p[k])).collect();
    patch.weights = net.weights;
    Ok(())
}
