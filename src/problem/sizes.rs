//! Sizes of a system estimated from its numbers of elements: unknowns, entries, bytes of its matrices, entries of its factor.
//!
//! Counts are `f64`, so that products of large counts do not overflow.

use crate::space::Space;

/// Entries of the factor per unknown and component in the plane: 5.8 w^1.6 (log2 n - 4.5) for n functions with overlap w, fitted at or
/// above the factors of 14 matrices of splines, quadrilaterals and triangles of degree 1 to 4, by at most 35 %.
const FILL_PLANE: f64 = 5.8;
const GROWTH_PLANE: f64 = 1.6;
const SMALL_PLANE: f64 = 4.5;
/// Entries of the factor per unknown and component in space: 13.3 (w^1.7 (n^1/3 - 3 w^1/2) + 0.1 p^3), the last term for cells with
/// interior functions; fitted to 20 matrices, above them by at most 24 %.
const FILL_SOLID: f64 = 13.3;
const GROWTH_SOLID: f64 = 1.7;
const SMALL_SOLID: f64 = 3.0;
const INSIDE_SOLID: f64 = 0.1;

/// Factors of thin bodies in space, relative to that of the plane for each layer of functions of a plate, and to the band of a beam.
const THIN_PLATE: f64 = 0.8;
const THIN_BEAM: f64 = 1.6;

/// Bytes per pair of functions for the graphs of orderings.
const BYTES_PER_PAIR: f64 = 16.0;
/// Bytes per unknown for vectors.
const BYTES_PER_UNKNOWN: f64 = 50.0;
/// Bytes per unknown for the vectors of an iterative method.
const BYTES_OF_ITERATION: f64 = 100.0;
/// Bytes per element of a spline patch, per product cell and per simplex: connectivity, faces, bounds, results on them.
const BYTES_PER_ELEMENT: f64 = 50.0;
const BYTES_PER_CELL: f64 = 800.0;
const BYTES_PER_SIMPLEX: f64 = 1200.0;

/// Bytes of an index, of a number.
const INDEX: f64 = 4.0;
const NUMBER: f64 = 8.0;

/// Numbers that the Schur complement of contact rows may have, and its share of the factor's numbers: as the solver decides.
const FEW_SQUARE: f64 = (1 << 21) as f64;
const SHARE_OF_FACTOR: f64 = 0.1;

/// Estimated sizes of a system, from numbers of elements alone: bodies need not be built.
///
/// Sizes of several bodies add up by [`and`](Self::and); [`forecast`](Self::forecast) is the memory that they take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sizes {
    pub(super) unknowns: f64,
    pub(super) entries: f64,
    /// Bytes of the matrices of the bodies, of the reduced one and of the triangle that is factorised.
    pub(super) matrices: f64,
    /// Entries of the factor.
    pub(super) factor: f64,
    /// Bytes that the factorisation takes beside the factor: graphs of orderings, the stack of update matrices.
    pub(super) beside: f64,
    /// Bytes of everything else.
    pub(super) other: f64,
}

/// Properties of a space that determine its entries per function and their fill-in.
#[derive(Clone, Copy, Debug)]
struct Kind {
    components: f64,
    dimension: usize,
    degree: f64,
    /// Number of functions of an element that its neighbour shares, per direction: the degree for the smoothest splines, 1 for Lagrange.
    overlap: f64,
    /// Bytes of all elements.
    elements: f64,
    /// Share of the unknowns that are free.
    free: f64,
}

/// Bytes per entry of the factor on the stack of the multifrontal factorisation, which plane bodies take: a fifth of the factor for
/// separators three functions wide, a sixteenth for one, beyond what the bytes of the factor itself include.
const BYTES_WAITING: f64 = 1.0;

impl Sizes {
    /// Number of unknowns.
    pub fn unknowns(&self) -> f64 {
        self.unknowns
    }

    /// Sizes of a spline patch or of a mesh of product cells; `sizes`: number of elements, degree and continuity (0 for Lagrange functions)
    /// of each direction. `components` of the unknown.
    pub fn of_patch(sizes: &[(f64, usize, usize)], components: usize) -> Self {
        // a knot of continuity k carries p - k functions
        let lines: Vec<(f64, f64, f64)> = sizes
            .iter()
            .map(|&(n, p, smooth)| (n, p as f64 + 1.0, (p + 1) as f64 + (n - 1.0).max(0.0) * (p - smooth.min(p)) as f64))
            .collect();
        Self::of_lines(&lines, components, 1.0)
    }

    /// Sizes of a tensor product with `lines`: elements, functions of an element, functions of each direction.
    fn of_lines(lines: &[(f64, f64, f64)], components: usize, free: f64) -> Self {
        let (mut functions, mut elements, mut pairs, mut own, mut overlap) = (1.0, 1.0, 1.0, 1.0f64, 1.0f64);
        for &(n, active, line) in lines {
            // functions shared by neighbours: those that an element does not add
            let shared = active - (line - active) / (n - 1.0).max(1.0);
            functions *= line;
            elements *= n;
            pairs *= n * active * active - (n - 1.0).max(0.0) * shared * shared;
            own = own.max(active);
            overlap = overlap.max(shared);
        }
        // at degree 1 splines and Lagrange cells have the same functions
        let bytes = elements * if overlap < own - 1.0 || own <= 2.0 { BYTES_PER_CELL } else { BYTES_PER_ELEMENT };
        let kind = Kind { components: components as f64, dimension: lines.len(), degree: own - 1.0, overlap, elements: bytes, free };
        let mut need = Self::of(functions, pairs, kind);
        let mut sides: Vec<f64> = lines.iter().map(|l| l.2).collect();
        sides.sort_by(f64::total_cmp);
        let across: f64 = sides[..sides.len() - 1].iter().product();
        // no more than the band of the narrowest numbering, in space than that of a plate
        let each = need.unknowns * free * components as f64;
        let most = if let [thin, a, b] = sides[..] {
            let plate = THIN_PLATE * thin * fill(a * b, Kind { components: 1.0, dimension: 2, ..kind });
            each * plate.min(THIN_BEAM * own * (across + 1.0))
        } else {
            need.unknowns * components as f64 * own * (across + 1.0)
        };
        need.factor = need.factor.min(most);
        need
    }

    /// Sizes of a mesh of `cells`, numbers of product cells and of simplices, of `dimension` 2 or 3, with Lagrange functions of degree `p`.
    pub fn of_mesh(cells: [f64; 2], dimension: usize, p: usize, components: usize) -> Self {
        // number of product cells that the simplices fill: two simplices each, or about six
        let filled = cells[0] + cells[1] / if dimension == 3 { 6.0 } else { 2.0 };
        let degree = p as f64;
        let functions = (filled.powf(1.0 / dimension as f64) * degree + 1.0).powi(dimension as i32);
        let elements = BYTES_PER_CELL * cells[0] + BYTES_PER_SIMPLEX * cells[1];
        let kind = Kind { components: components as f64, dimension, degree, overlap: 1.0, elements, free: 1.0 };
        Self::of(functions, mesh_pairs(cells, dimension, degree), kind)
    }

    /// Sizes of a space that is built, with the share `free` of its unknowns free.
    pub(super) fn of_space<const N: usize>(space: &dyn Space<N, N>, components: usize, free: f64) -> Self {
        let (elements, functions) = (space.num_elements() as f64, space.num_functions() as f64);
        if elements == 0.0 {
            return Self { unknowns: components as f64 * functions, ..Self::default() };
        }
        let block = space
            .structure()
            .block(0)
            .filter(|b| b.first == 0)
            .map(|b| b.axes.map(|a| (a.num_elements() as f64, a.degree(0)[0] as f64 + 1.0, a.num_functions() as f64)));
        if let Some(lines) = block.filter(|l| l.iter().map(|l| l.2).product::<f64>() == functions) {
            return Self::of_lines(&lines, components, free);
        }
        let p = space.degree(0).into_iter().max().unwrap_or(1);
        let (mut ids, degree, root) = (Vec::new(), p as f64, 1.0 / N as f64);
        space.active(0, &mut ids);
        // functions that an element adds per direction: 1 for the smoothest splines, p for Lagrange
        let added = (functions / elements).powf(root).round().clamp(1.0, degree.max(1.0));
        let product = (p + 1).pow(N as u32) == ids.len();
        let overlap = if product { degree + 1.0 - added } else { 1.0 };
        let pairs = if product && added < degree {
            let n = elements.powf(root);
            (n * (degree + 1.0).powi(2) - (n - 1.0) * overlap * overlap).powi(N as i32)
        } else {
            mesh_pairs(if product { [elements, 0.0] } else { [0.0, elements] }, N, degree)
        };
        let bytes = elements * if product { BYTES_PER_CELL } else { BYTES_PER_SIMPLEX };
        Self::of(functions, pairs, Kind { components: components as f64, dimension: N, degree, overlap, elements: bytes, free })
    }

    fn of(functions: f64, pairs: f64, kind: Kind) -> Self {
        let (c, free) = (kind.components, kind.free);
        let (unknowns, entries) = (c * functions, c * c * pairs);
        // in blocks; of the free unknowns entry by entry where supports hold components, a triangle, and the solver's copy in its order
        let matrices = entries * ((NUMBER + INDEX / (c * c)) + free * ((NUMBER + INDEX) + 2.0 * NUMBER));
        let factor = free * unknowns * fill(free * functions, kind);
        let waiting = if kind.dimension == 2 { BYTES_WAITING * factor } else { 0.0 };
        let other = kind.elements + BYTES_PER_UNKNOWN * unknowns;
        Self { unknowns, entries, matrices, factor, beside: BYTES_PER_PAIR * pairs + waiting, other }
    }

    /// Adds `count` entries between bodies, stored one by one.
    pub(super) fn add_entries(&mut self, count: f64) {
        self.entries += count;
        self.matrices += count * (2.0 * (NUMBER + INDEX) + 2.0 * NUMBER);
    }

    /// Adds the Schur complement of `rows` contact rows for one factor of all bodies: itself and its dense factor, and the rows of
    /// separators kept while it is computed, no more than the square root of the factor's entries at a time. With many rows, every active
    /// set has a factor instead.
    pub(super) fn add_interface(&mut self, rows: f64) {
        let square = rows * rows;
        if square <= FEW_SQUARE.max(SHARE_OF_FACTOR * self.factor) {
            self.beside += NUMBER * (3.0 * square + rows * self.factor.sqrt());
        }
    }

    /// Sizes of the same system solved by iterations: vectors of the method in place of the factor.
    #[must_use]
    pub fn without_factor(self) -> Self {
        Self { factor: 0.0, beside: 0.0, other: self.other + BYTES_OF_ITERATION * self.unknowns, ..self }
    }

    /// Sum of both.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self {
            unknowns: self.unknowns + other.unknowns,
            entries: self.entries + other.entries,
            matrices: self.matrices + other.matrices,
            factor: self.factor + other.factor,
            beside: self.beside + other.beside,
            other: self.other + other.other,
        }
    }
}

/// Number of pairs of functions that share a cell: those of the cells, less what neighbours count twice (inclusion and exclusion over
/// faces, edges and corners).
fn mesh_pairs(cells: [f64; 2], dimension: usize, p: f64) -> f64 {
    let [product, simplex] = cells;
    let n = product.powf(1.0 / dimension as f64);
    let line = if n > 0.0 { (n * (p + 1.0).powi(2) - (n - 1.0)).powi(dimension as i32) } else { 0.0 };
    let (side, face) = (p + 1.0, 0.5 * (p + 1.0) * (p + 2.0));
    let own = if dimension == 3 { face * (p + 3.0) / 3.0 } else { face };
    // in a large mesh a triangle has 3/2 edges and 1/2 corner, a tetrahedron 2 faces, 7/6 edges and 1/6 corner; sides of the body add some
    let (each, n) = if dimension == 3 {
        (own * own - 2.0 * face * face + 7.0 / 6.0 * side * side - 1.0 / 6.0, (simplex / 6.0).cbrt())
    } else {
        (own * own - 1.5 * side * side + 0.5, (0.5 * simplex).sqrt())
    };
    line + if simplex > 0.0 { simplex * each * (1.0 + 1.0 / n).powi(dimension as i32 - 1) } else { 0.0 }
}

/// Entries of the factor per unknown under nested dissection: separators are as wide as functions of neighbouring elements overlap.
fn fill(functions: f64, kind: Kind) -> f64 {
    let Kind { components, dimension, degree, overlap, .. } = kind;
    let each = if dimension == 3 {
        // separators of a volume grow with n^(2/3)
        let separators = overlap.powf(GROWTH_SOLID) * (functions.cbrt() - SMALL_SOLID * overlap.sqrt()).max(0.5);
        FILL_SOLID * (separators + if overlap < degree { INSIDE_SOLID * degree.powi(3) } else { 0.0 })
    } else {
        FILL_PLANE * overlap.powf(GROWTH_PLANE) * (functions.max(2.0).log2() - SMALL_PLANE).max(1.0)
    };
    components * each
}
