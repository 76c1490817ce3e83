//! MFEM meshes: NURBS patches in both layouts, Lagrange meshes straight and curved, lists of knots to insert.
//!
//! Source: MFEM, `mesh/mesh_readers.cpp`, `mesh/nurbs.cpp` and the page "Mesh formats" of its documentation.

mod cells;
mod lagrange;
mod nurbs;
mod patch_sides;
mod refine;
mod write;
mod write_mesh;

use super::budget::Budget;
use super::handed::exchange;
use super::text::{Words, broken, shown, unsupported};
use super::{Contents, FileError, Limits};

pub use refine::refinement_list;
pub use write::write;
pub use write_mesh::write_mesh;

/// Reads a file.
///
/// # Errors
/// [`FileError::Unsupported`] for other kinds and versions, [`FileError::Broken`], [`FileError::Memory`].
pub fn parse(bytes: &[u8], limits: &Limits) -> Result<Contents, FileError> {
    let mut budget = Budget::new(limits, bytes.len());
    let mut words = Words::new(bytes, 1).with_comments();
    let line = words.line();
    words.expect("MFEM")?;
    let kind = words.rest_of_line();
    let spacing = kind == b"NURBS mesh v1.1";
    match kind {
        b"NURBS mesh v1.0" | b"NURBS mesh v1.1" => {
            let mut file = nurbs::parse(words, spacing, &mut budget)?;
            exchange(&mut file, &write::exchanged(bytes));
            Ok(Contents::Patches(file))
        }
        b"mesh v1.0" | b"mesh v1.2" => Ok(Contents::Mesh(lagrange::parse(words, &mut budget)?)),
        _ if kind.starts_with(b"NURBS NC-patch mesh") => {
            Err(unsupported(line, "a MFEM NURBS NC-patch mesh (patches that meet along a part of a side, a hierarchy of refined sides)"))
        }
        _ if kind.starts_with(b"NC mesh") => Err(unsupported(line, "a MFEM NC mesh (a hierarchy of refined elements with hanging nodes)")),
        _ if kind.starts_with(b"INLINE") => Err(unsupported(line, "a MFEM INLINE mesh")),
        _ => Err(unsupported(line, format!("\"MFEM {}\"", shown(kind)))),
    }
}

/// The dimension of the elements.
fn dimension(words: &mut Words<'_>) -> Result<usize, FileError> {
    words.expect("dimension")?;
    let line = words.line();
    match words.index("the dimension")? {
        d @ 1..=3 => Ok(d),
        other => Err(broken(line, format!("the dimension is {other}; it is 1, 2 or 3"))),
    }
}

/// Head of a field of points.
struct Field {
    /// Name of its functions.
    collection: String,
    /// Line of that name.
    line: usize,
    /// Coordinates per point.
    world: usize,
    /// Whether the coordinates of a point are stored together.
    by_point: bool,
}

impl Field {
    fn read(words: &mut Words<'_>) -> Result<Self, FileError> {
        words.expect("FiniteElementSpace")?;
        words.expect("FiniteElementCollection:")?;
        let line = words.line();
        let collection = shown(words.word("the name of a collection")?);
        words.expect("VDim:")?;
        let at = words.line();
        let world = words.index("VDim")?;
        if !(1..=3).contains(&world) {
            return Err(broken(at, format!("VDim is {world}; points have 1 to 3 coordinates")));
        }
        words.expect("Ordering:")?;
        let at = words.line();
        let by_point = match words.index("Ordering")? {
            0 => false,
            1 => true,
            other => return Err(broken(at, format!("Ordering is {other}; it is 0 or 1"))),
        };
        Ok(Self { collection, line, world, by_point })
    }

    /// The points, missing coordinates zero.
    fn points(&self, words: &mut Words<'_>, count: usize, budget: &mut Budget) -> Result<Vec<[f64; 3]>, FileError> {
        let numbers = words.numbers(count.saturating_mul(self.world), &format!("coordinates of {count} points"), budget)?;
        budget.items(count, size_of::<[f64; 3]>())?;
        let coordinate = |i: usize, k: usize| if self.by_point { numbers[i * self.world + k] } else { numbers[k * count + i] };
        Ok((0..count).map(|i| std::array::from_fn(|k| if k < self.world { coordinate(i, k) } else { 0.0 })).collect())
    }
}

/// Expects the end of the file.
fn end(words: &mut Words<'_>) -> Result<(), FileError> {
    words.accept("mfem_mesh_end");
    let line = words.line();
    match words.next() {
        None => Ok(()),
        Some(word) => Err(broken(line, format!("the mesh is complete, but \"{}\" follows", shown(word)))),
    }
}
