//! How much memory a run will take, known before anything is allocated.

use crate::app::build::Model;
use crate::basis::Basis;
use serde::Serialize;

/// What a run will need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Prediction {
    /// Entries of the stiffness.
    pub entries: u64,
    /// Numbers in its factor, to a factor of about 1.5.
    pub factor: u64,
    /// Bytes at the highest point.
    pub memory: u64,
}

// Peaks of runs against predictions, elasticity of degree 2 in a cube of n^3 elements: iga n = 12, 16, 24: 183, 454, 1826 MB for
// 199, 485, 2000; fe n = 12, 16: 677, 1815 MB for 964, 2600.

/// Fill per unknown, degree and doubling of a plane system under nested dissection, from measured factors of
/// maximally smooth splines: 129 per unknown for p = 1 at 3e5 unknowns, 558 for p = 3 at 1e5.
const FILL_PLANE: f64 = 7.1;
/// Growth of that fill with the degree.
const FILL_DEGREE: f64 = 1.4;
/// Bytes per stored entry: value and column, twice for the reduced copy.
const BYTES_PER_ENTRY: f64 = 24.0;
/// Bytes per number of the factor, working space included.
const BYTES_PER_FACTOR: f64 = 10.0;
/// Bytes per unknown for vectors and graphs.
const BYTES_PER_UNKNOWN: f64 = 400.0;
/// Bytes of the program itself.
const PROGRAM: f64 = 2e7;

/// Bytes per unknown of a step that is kept: the solution and what supports do.
const BYTES_PER_STATE: f64 = 16.0;
/// Bytes per element for quadrature, connectivity and bounds.
const BYTES_PER_ELEMENT: f64 = 100.0;

/// Sizes that a prediction is made of.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Need {
    pub unknowns: f64,
    pub elements: f64,
    pub entries: f64,
    pub factor: f64,
}

impl Need {
    /// A patch of `sizes`: elements, degree and continuity of each direction.
    pub fn of_patch(sizes: &[(f64, usize, usize)], components: usize) -> Self {
        let c = components as f64;
        let (mut functions, mut elements, mut pairs, mut degree, mut width, mut narrow) = (1.0, 1.0, 1.0, 1usize, 1.0f64, f64::INFINITY);
        for &(n, p, smooth) in sizes {
            // a knot of continuity k carries p - k functions; neighbours share k + 1
            let (own, shared) = ((p + 1) as f64, (smooth + 1) as f64);
            let line = own + (n - 1.0).max(0.0) * (own - shared);
            functions *= line;
            elements *= n;
            pairs *= n * own * own - (n - 1.0).max(0.0) * shared * shared;
            degree = degree.max(p);
            width = width.max(shared);
            narrow = narrow.min(line);
        }
        let unknowns = c * functions;
        // no more than the band of the narrowest numbering
        let band = if sizes.len() == 2 { c * (degree as f64 + 1.0) * (narrow + 1.0) } else { f64::INFINITY };
        let factor = unknowns * fill(unknowns, degree, width, components, sizes.len()).min(band);
        Self { unknowns, elements, entries: c * c * pairs, factor }
    }

    /// A mesh of as many product and simplex cells of `dimension`, Lagrange functions of degree `p`.
    pub fn of_mesh(cells: [f64; 2], dimension: usize, p: usize, components: usize) -> Self {
        let (c, n, degree) = (components as f64, dimension as i32, p as f64);
        // in a large mesh a product cell adds p^n functions; simplices are as many as fill a product cell: two, or about six
        let fill_product = if dimension == 3 { 6.0 } else { 2.0 };
        let functions = (cells[0] + cells[1] / fill_product) * degree.powi(n) + 1.0;
        let own: f64 = (1..=dimension).map(|k| (p + k) as f64 / k as f64).product();
        let per_cell = [(degree + 1.0).powi(2 * n), own * own];
        let unknowns = c * functions;
        let factor = unknowns * fill(unknowns, p, 1.0, components, dimension);
        let entries = c * c * (cells[0] * per_cell[0] + cells[1] * per_cell[1]);
        Self { unknowns, elements: cells[0] + cells[1], entries, factor }
    }

    /// Both together.
    pub fn and(&self, other: &Self) -> Self {
        Self {
            unknowns: self.unknowns + other.unknowns,
            elements: self.elements + other.elements,
            entries: self.entries + other.entries,
            factor: self.factor + other.factor,
        }
    }

    /// Bytes and counts; what does not fit into 64 bits is their largest number.
    pub fn prediction(&self) -> Prediction {
        let memory = PROGRAM
            + BYTES_PER_ENTRY * self.entries
            + BYTES_PER_FACTOR * self.factor
            + BYTES_PER_UNKNOWN * self.unknowns
            + BYTES_PER_ELEMENT * self.elements;
        Prediction { entries: self.entries as u64, factor: self.factor as u64, memory: memory as u64 }
    }
}

/// Numbers of the factor per unknown: separators are as wide as functions of neighbouring elements overlap (`width`, the degree
/// for the smoothest splines, 1 for Lagrange); what is inside elements is dense there. Measured for Lagrange, elasticity: 220
/// for p = 4 at 3e5 unknowns.
fn fill(unknowns: f64, degree: usize, width: f64, components: usize, dimension: usize) -> f64 {
    let separators = FILL_PLANE * width.powf(FILL_DEGREE) * unknowns.max(2.0).log2();
    let inside = if width < degree as f64 { components as f64 * (degree as f64 + 1.0).powi(dimension as i32) } else { 0.0 };
    // separators of a volume grow with n^(2/3)
    inside + if dimension == 3 { separators * unknowns.powf(1.0 / 3.0) / 4.0 } else { separators }
}

/// Predicts the need of `model` in a number of steps, whose states are kept for the files.
pub fn predict<const S: usize, const N: usize>(model: &Model<S, N>, steps: usize) -> Prediction {
    let mut all = Need { unknowns: model.rows as f64, ..Need::default() };
    for patch in &model.patches {
        let space = patch.body.space();
        let degree = if space.num_elements() > 0 { space.degree(0) } else { [1; N] };
        let unknowns = patch.num_unknowns() as f64;
        let row: f64 = degree.iter().map(|&p| 2.0 * p as f64 + 1.0).product::<f64>() * patch.field.components as f64;
        let (components, elements) = (patch.field.components, space.num_elements() as f64);
        let p = degree.iter().copied().max().unwrap_or(1);
        // functions that an element adds per direction: 1 for the smoothest splines, p for Lagrange
        let added = (unknowns / components as f64 / elements.max(1.0)).powf(1.0 / N as f64).round();
        let width = (p as f64 + 1.0 - added).clamp(1.0, p.max(1) as f64);
        let factor = unknowns * fill(unknowns, p, width, components, N);
        all = all.and(&Need { unknowns, elements, entries: unknowns * row, factor });
    }
    // ties without rows: entries between the bodies, twice for the reduced copy, and twice the factor where the matrix is not symmetric
    for part in model.ties.iter().flat_map(|tie| &tie.parts).filter(|part| !part.stiffness.entries.is_empty()) {
        all.entries += part.stiffness.entries.len() as f64;
    }
    for part in model.contacts.iter().flat_map(|c| &c.parts) {
        let points = part.first.points.as_ref().map_or(0, |p| p.stiffness.entries.len());
        all.entries += (points + part.first.rows.slave.entries.len() + part.first.rows.master.entries.len()) as f64;
    }
    let mut prediction = all.prediction();
    let kept = BYTES_PER_STATE * (model.unknowns + model.rows) as f64 * steps.saturating_sub(1) as f64;
    prediction.memory = (prediction.memory as f64 + kept) as u64;
    prediction
}

/// Bytes in words.
pub fn bytes(n: u64) -> String {
    let x = n as f64;
    if x >= 1e9 {
        format!("{:.1} GB", x / 1e9)
    } else if x >= 1e6 {
        format!("{:.0} MB", x / 1e6)
    } else {
        format!("{:.0} kB", x / 1e3)
    }
}
