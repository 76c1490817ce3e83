//! High-order VTK unstructured grids (`.vtu`): one cell per element, exact where the element is rational or polynomial.
//!
//! Bezier cells carry homogeneous coefficients. With D the common denominator of map and basis on an element,
//!
//!   D(xi) = sum_a B_a(xi) w_a,   D x = sum_a B_a w_a x_a,   D u = sum_a B_a w_a u_a
//!
//! where B_a are Bernstein polynomials of a degree that holds all three. They are found by interpolation at points
//! inside the element, so the writer needs only the values, degrees and weights of a [`Space`]:
//! D is the map's weight function, times that of the basis if it is a different one. A B-spline basis over a rational
//! map thus raises the degree. If map or basis are neither polynomial nor rational (checked at points between),
//! or the degree exceeds [`MAX_DEGREE`] of VTK, that element becomes a Lagrange cell.
//!
//! Fields that are no polynomials over D (stresses, the equivalent stress) are interpolated in the same way; constant
//! and, if the degree suffices, polynomial stresses are exact. Lagrange cells carry values at equispaced nodes.
//!
//! Every cell is right-handed: if the map is left-handed, the first two axes of the cell are exchanged. Points of a part are shared by
//! adjacent elements if positions, weights and all fields agree up to rounding (1e-10 of the largest value): a displacement is
//! continuous, a stress mostly is not.
//!
//! Linear cells stand between the nodes of the Lagrange cell. Tetrahedra leave octahedra between them, which are cut along the diagonal
//! whose least piece is the greatest. Where a strongly bent element still has a piece that is negative, all elements of its part get a
//! lattice of twice or four times as many steps, so that neighbours keep their points in common. Where that does not help because
//! the map itself folds over, the lattice stays and the pieces that are negative are turned: there they overlap.
//!
//! Quadratic cells are of VTK's types of before Lagrange cells, of degree 1 or 2 in all directions: fields of higher degree are coarser there
//! than they are. Where a part is [`averaged`](Part::averaged), points are shared although fields jump there: at points stand their means
//! over the elements around, and in cell data of the same names their values in the middle of the element.
//!
//! Files: version 1.0 (2.2 with Lagrange or Bezier hexahedra), UInt64 headers, appended data compressed by zlib; equal input gives equal
//! bytes. Vectors and symmetric tensors have names of components. Field data has an array `patch.NAME` per part with its number.
//! In ParaView raise "Nonlinear Subdivision Level" to 3 or 4 to see curved cells.

pub(super) mod cells;
mod file;
mod piece;
mod plan;
mod points;
#[cfg(test)]
mod tests;

use faying::linalg::Vector;
use faying::space::Space;
use file::{Grid, Kept};
use piece::each_piece;
use std::borrow::Borrow;
use std::sync::Arc;

pub use cells::MAX_DEGREE;
pub(crate) use file::File;

/// Values of a field at local points of an element: `components` numbers per point, point after point.
pub type Sampler<'a, const D: usize> = Box<dyn Fn(usize, &[Vector<D>]) -> Vec<f64> + Send + Sync + 'a>;

/// A field given per element.
pub struct PointField<'a, const D: usize> {
    /// Name of the array in the file.
    pub name: String,
    /// Numbers per point; two are written as three.
    pub components: usize,
    /// Whether the field is a combination of the space's functions, so that a Bezier cell must hold it exactly.
    pub exact: bool,
    /// The values.
    pub sample: Sampler<'a, D>,
}

impl<const D: usize> std::fmt::Debug for PointField<'_, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PointField").field("name", &self.name).field("components", &self.components).finish_non_exhaustive()
    }
}

/// Shape of the cells of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CellStyle {
    /// Bezier cells, rational if the element is.
    Bezier,
    /// Lagrange cells with equispaced nodes.
    Lagrange,
    /// Linear cells between the nodes of the Lagrange cell.
    Linear,
    /// Linear cells, and quadratic ones for elements of degree 2 and more, of types that all readers of VTK files know.
    Quadratic,
}

/// Prefix of the names of the arrays of field data that hold the number of a part.
pub(crate) const PATCH: &str = "patch.";

/// A space with fields: one body of `fields.vtu`, or a side.
pub struct Part<'a, const D: usize, const N: usize> {
    /// Name, for figures and messages.
    pub name: String,
    /// The elements and their map.
    pub space: Arc<dyn Space<D, N>>,
    /// Shape of the cells.
    pub style: CellStyle,
    /// Least degree of Lagrange cells, for fields finer than the space (multipliers on a side).
    pub least_degree: usize,
    /// Whether fields that are no combinations of the space's functions are averaged at the points of adjacent elements. True for one part
    /// of a file, it is for all. Bezier cells are never averaged.
    pub averaged: bool,
    /// The fields; every part of a file has the same names.
    pub fields: Vec<PointField<'a, D>>,
    /// Sampler of all fields at once, if cheaper than each alone: per point the values of one field after the other.
    pub together: Option<Sampler<'a, D>>,
}

impl<const D: usize, const N: usize> std::fmt::Debug for Part<'_, D, N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Part").field("name", &self.name).field("style", &self.style).field("fields", &self.fields).finish_non_exhaustive()
    }
}

impl<'a, const D: usize, const N: usize> Part<'a, D, N> {
    /// Creates a part without fields.
    pub fn new(name: impl Into<String>, space: Arc<dyn Space<D, N>>, style: CellStyle) -> Self {
        Self { name: name.into(), space, style, least_degree: 1, averaged: false, fields: Vec::new(), together: None }
    }

    /// Adds a field of the space's own functions.
    #[must_use]
    pub fn with_exact(self, name: &str, components: usize, sample: impl Fn(usize, &[Vector<D>]) -> Vec<f64> + Send + Sync + 'a) -> Self {
        self.with_field(name, components, true, Box::new(sample))
    }

    /// Adds a field that is interpolated.
    #[must_use]
    pub fn with(self, name: &str, components: usize, sample: impl Fn(usize, &[Vector<D>]) -> Vec<f64> + Send + Sync + 'a) -> Self {
        self.with_field(name, components, false, Box::new(sample))
    }

    /// Sets a sampler of all fields added so far, with the same values as their own samplers.
    #[must_use]
    pub fn with_together(mut self, sample: impl Fn(usize, &[Vector<D>]) -> Vec<f64> + Send + Sync + 'a) -> Self {
        self.together = Some(Box::new(sample));
        self
    }

    fn with_field(mut self, name: &str, components: usize, exact: bool, sample: Sampler<'a, D>) -> Self {
        self.fields.push(PointField { name: name.to_owned(), components, exact, sample });
        self
    }
}

/// Error of writing a grid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum VtuError {
    /// Parts with different fields.
    #[error("part \"{part}\" has the fields {found}, the first part {expected}; all parts of a file have the same")]
    Fields {
        /// The part.
        part: String,
        /// Its fields.
        found: String,
        /// Fields of the first part.
        expected: String,
    },
    /// A sampler returned the wrong number of values.
    #[error("field \"{field}\" of part \"{part}\" gave {found} numbers on element {element}, expected {expected}")]
    Values {
        /// The field.
        field: String,
        /// The part.
        part: String,
        /// The element.
        element: usize,
        /// Numbers given.
        found: usize,
        /// Points times components.
        expected: usize,
    },
}

/// Returns the bytes of a `.vtu` file with all `parts`: point data of their fields, cell data `patch` (number of the part) and `element`, field
/// data with the names of the parts.
///
/// # Errors
/// [`VtuError`] if the parts do not fit together.
pub fn write<'a, const D: usize, const N: usize, P: Borrow<Part<'a, D, N>>>(parts: &[P]) -> Result<Vec<u8>, VtuError> {
    let parts: Vec<&Part<'a, D, N>> = parts.iter().map(Borrow::borrow).collect();
    let names = |part: &Part<'_, D, N>| part.fields.iter().map(|f| format!("{}:{}", f.name, f.components)).collect::<Vec<_>>().join(", ");
    let averaged = parts.iter().any(|part| part.averaged && part.style != CellStyle::Bezier);
    let mut fields = Vec::new();
    if let Some(first) = parts.first() {
        let field = |f: &PointField<'_, D>| Kept { name: f.name.clone(), components: padded(f.components), averaged: averaged && !f.exact };
        fields = first.fields.iter().map(field).collect();
        if let Some(odd) = parts.iter().copied().find(|part| names(part) != names(first)) {
            return Err(VtuError::Fields { part: odd.name.clone(), found: names(odd), expected: names(first) });
        }
    }
    let mut grid = Grid::new(fields);
    for (number, part) in parts.into_iter().enumerate() {
        grid.begin(&part.name, part.space.num_elements());
        each_piece(part, averaged, |element, piece| grid.append(number, element, piece))?;
    }
    Ok(grid.into_bytes())
}

fn padded(components: usize) -> usize {
    if components == 2 { 3 } else { components }
}
