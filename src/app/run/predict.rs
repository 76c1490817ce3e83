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

/// Predicts the need of `model`.
pub fn predict<const S: usize, const N: usize>(model: &Model<S, N>) -> Prediction {
    let (mut entries, mut factor) = (0.0, 0.0);
    for patch in &model.patches {
        let space = patch.body.space();
        let degree = if space.num_elements() > 0 { space.degree(0) } else { [1; N] };
        let unknowns = patch.num_unknowns() as f64;
        let row: f64 = degree.iter().map(|&p| 2.0 * p as f64 + 1.0).product::<f64>() * patch.field.components as f64;
        entries += unknowns * row;
        let p = degree.iter().copied().max().unwrap_or(1) as f64;
        let doublings = unknowns.max(2.0).log2();
        let per_unknown = FILL_PLANE * p.powf(FILL_DEGREE) * doublings;
        // separators of a volume grow with n^(2/3)
        factor += unknowns * if N == 3 { per_unknown * unknowns.powf(1.0 / 3.0) / 4.0 } else { per_unknown };
    }
    let rows = model.rows as f64;
    let memory = PROGRAM + BYTES_PER_ENTRY * entries + BYTES_PER_FACTOR * factor + BYTES_PER_UNKNOWN * (model.unknowns as f64 + rows);
    Prediction { entries: entries as u64, factor: factor as u64, memory: memory as u64 }
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
