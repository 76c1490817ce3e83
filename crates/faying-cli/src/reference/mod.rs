//! Stored runs: reference solutions for errors where no exact solution is known.
//!
//! A file holds, per patch, its name, a fingerprint of its geometry, how it was cut into elements, and the coefficients of u; per slave
//! side its facets and lambda as polynomials of its elements. Geometry itself is not stored: a case that names the file has the same.
//!
//! ```text
//! "faying.reference/2\n"   then one zlib stream of:
//!   u32 little endian      length of the head
//!   head                   JSON: everything but long lists of numbers
//!   lists                  per patch: ends of elements per direction, coefficients; per side: facets, lambda
//! ```
//!
//! Coefficients and lambda are rounded to 2^-44 (6e-14) of the largest of their list; all other numbers are exact.

mod numbers;
pub(crate) mod on_case;
mod parameters;
mod read;
mod stored;
mod write;

use faying::basis::Cell;
use faying::linalg::Vector;
use serde::{Deserialize, Serialize};

pub use on_case::{OnSide, Reference, ReferenceLambda, ReferencePatch};
pub use read::read;
pub(crate) use stored::stored_run;
pub use write::write;

/// First bytes of every file of a stored run.
pub const MAGIC: &[u8] = b"faying.reference/2\n";

/// A stored run: its last state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StoredRun {
    /// Version of the program that wrote it.
    pub version: String,
    /// "poisson" or "elasticity".
    pub physics: String,
    /// Assumption out of the plane, "plane-strain", "axisymmetric", "solid"; empty of runs that do not say it.
    #[serde(default)]
    pub assumption: String,
    /// 2 or 3.
    pub dimension: usize,
    /// Components of u.
    pub components: usize,
    /// The time of the state.
    pub t: f64,
    /// All bodies, in the order of the case.
    pub patches: Vec<StoredPatch>,
    /// The slave sides of all interfaces and contacts that have multipliers.
    pub sides: Vec<StoredSide>,
}

/// Fingerprint of a geometry, to compare it with another one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fingerprint {
    /// SHA-256 of the integer data: degrees, numbers of points, cells.
    pub counts: String,
    /// Sums of all coordinates, knots and weights with fixed factors: equal up to rounding for equal geometries.
    pub sums: [f64; 4],
    /// Sum of all magnitudes: the scale of rounding.
    pub size: f64,
}

/// A body of a stored run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StoredPatch {
    /// Its name.
    pub name: String,
    /// Its geometry.
    pub geometry: Fingerprint,
    /// Its backend.
    pub backend: String,
    /// Degree per direction.
    pub degree: Vec<usize>,
    /// Continuity of splines; `None`: the highest.
    pub continuity: Option<usize>,
    /// Functions of splines, a word of the case file.
    pub basis: String,
    /// Shape of cells, a word of the case file.
    pub cells: String,
    /// Map of cells, a word of the case file.
    pub mapping: String,
    /// Halvings of the cells of a mesh that was read from a file.
    pub refine: usize,
    /// Number of functions.
    pub functions: usize,
    /// Functions per row of a grid, 0 where there are no rows: a hint for compression.
    pub row: usize,
    /// Ends of the elements per direction; empty for meshes that were read from a file.
    #[serde(skip)]
    pub breakpoints: Vec<Vec<f64>>,
    /// u: coefficient = components * function + component.
    #[serde(skip)]
    pub coefficients: Vec<f64>,
}

/// A slave side of a stored run, or the part of one that lies on one patch.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StoredSide {
    /// The interface or contact.
    pub name: String,
    /// The name of the patch.
    pub patch: String,
    /// Components of lambda.
    pub components: usize,
    /// Degree of lambda on every element.
    pub degree: usize,
    /// Shape of the facets, a word of the case file; empty: intervals, or squares.
    #[serde(default)]
    pub cells: String,
    /// The patch's element behind every facet, then every coordinate of their origins, then of their axes, axis after axis.
    #[serde(skip)]
    pub facets: Vec<f64>,
    /// lambda at the products of Chebyshev points, on triangles of collapsed coordinates: number =
    /// components * ((degree + 1)^S * element + node) + component.
    #[serde(skip)]
    pub values: Vec<f64>,
}

impl StoredSide {
    /// Number of elements of a side of a body in `dimension` coordinates.
    pub fn elements(&self, dimension: usize) -> usize {
        self.facets.len() / (1 + dimension * dimension)
    }
}

/// The points of a facet at which lambda is stored: the tensor product of [`nodes`], the first coordinate fastest.
///
/// On a triangle these are collapsed coordinates (s, t), xi = (s (1 - t), t): a polynomial of degree p in xi is one of degree p in s and in t.
pub(super) fn node_points<const S: usize>(degree: usize, cell: Cell) -> Vec<Vector<S>> {
    let nodes = nodes(degree);
    let count = nodes.len();
    let point = |k: usize| Vector::<S>::from_fn(|axis, _| nodes[k / count.pow(axis as u32) % count]);
    (0..count.pow(S as u32)).map(|k| from_collapsed(point(k), cell)).collect()
}

/// The weights of the polynomial through [`node_points`] at the local point `xi`.
pub(super) fn node_weights<const S: usize>(degree: usize, cell: Cell, xi: &Vector<S>) -> Vec<f64> {
    let at = to_collapsed(*xi, cell);
    (0..S).fold(vec![1.0], |all, axis| weights(degree, at[axis]).iter().flat_map(|w| all.iter().map(move |a| a * w)).collect())
}

fn from_collapsed<const S: usize>(mut at: Vector<S>, cell: Cell) -> Vector<S> {
    if S == 2 && cell == Cell::Simplex {
        at[0] *= 1.0 - at[1];
    }
    at
}

/// Inverse of [`from_collapsed`]; the vertex that a side of the square collapses to has s = 0.
fn to_collapsed<const S: usize>(mut xi: Vector<S>, cell: Cell) -> Vector<S> {
    if S == 2 && cell == Cell::Simplex {
        xi[0] = if xi[1] < 1.0 { xi[0] / (1.0 - xi[1]) } else { 0.0 };
    }
    xi
}

/// The points on [0, 1] at which lambda is stored: Chebyshev points with both ends, or the middle for degree 0.
fn nodes(degree: usize) -> Vec<f64> {
    match degree {
        0 => vec![0.5],
        p => (0..=p).map(|k| 0.5 - 0.5 * (std::f64::consts::PI * k as f64 / p as f64).cos()).collect(),
    }
}

/// The weights of the polynomial through [`nodes`] at `xi`, by the barycentric formula.
///
/// Source: Berrut, Trefethen, SIAM Review 46 (2004) 501-517, section 5.
fn weights(degree: usize, xi: f64) -> Vec<f64> {
    let nodes = nodes(degree);
    if let Some(k) = nodes.iter().position(|x| *x == xi) {
        return (0..=degree).map(|j| f64::from(j == k)).collect();
    }
    let half = |k: usize| if k == 0 || k == degree { 0.5 } else { 1.0 };
    let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    let terms: Vec<f64> = nodes.iter().enumerate().map(|(k, x)| if degree == 0 { 1.0 } else { sign(k) * half(k) / (xi - x) }).collect();
    let sum: f64 = terms.iter().sum();
    terms.iter().map(|t| t / sum).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn lambda_on_facets_is_the_polynomial_through_its_nodes() {
        for (cell, p) in [Cell::Tensor, Cell::Simplex].into_iter().flat_map(|cell| (0..=5).map(move |p| (cell, p))) {
            let f = |x: &Vector<2>| {
                let terms = (0..=p).flat_map(|i| (0..=p - i).map(move |j| (i, j)));
                terms.map(|(i, j)| (i as f64 - 0.5 * j as f64 + 0.3) * x[0].powi(i as i32) * x[1].powi(j as i32)).sum::<f64>()
            };
            let at: Vec<f64> = node_points::<2>(p, cell).iter().map(f).collect();
            for xi in [[0.0, 0.0], [0.3, 0.6], [1.0, 0.0], [0.0, 1.0], [0.2, 0.8], [1e-13, 1.0 - 1e-12]] {
                let xi = Vector::<2>::from(xi);
                let found: f64 = node_weights(p, cell, &xi).iter().zip(&at).map(|(w, v)| w * v).sum();
                assert!((found - f(&xi)).abs() < 1e-12, "{cell:?} of degree {p} at {xi}: {found} instead of {}", f(&xi));
            }
        }
    }

    #[test]
    fn lambda_between_its_nodes_is_the_polynomial_through_them() {
        for p in 0..=8 {
            let f = |x: f64| (0..=p).map(|k| (k as f64 - 1.5) * x.powi(k as i32)).sum::<f64>();
            let at: Vec<f64> = nodes(p).into_iter().map(f).collect();
            for xi in [0.0, 0.1, 0.5, 0.77, 1.0, 1.0 + 1e-9] {
                let found: f64 = weights(p, xi).iter().zip(&at).map(|(w, v)| w * v).sum();
                assert!((found - f(xi)).abs() < 1e-12, "degree {p} at {xi}: {found} instead of {}", f(xi));
            }
        }
    }
}
