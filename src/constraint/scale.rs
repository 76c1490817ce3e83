//! Row scales of constraints, and the constrained system in scaled rows.
//!
//! ```text
//! k_i = sum_j |C_ij| K_jj / sum_j |C_ij|   over the slave: the stiffness a row acts on
//! r_i = k_i / max_j |C_ij|                 factor of row i; lambda_i = r_i l_i
//! ```
//!
//! The largest entry of a scaled row equals the stiffness k_i, whatever the units and the stiffness contrast. A soft row whose entries are rounding, as
//! where all of its unknowns but for the rounding of others are prescribed, has a lesser factor: its compliance s r² is at most 1e4 k.

use super::{ConstrainedSystem, RowKind, SolveError};
use crate::coupling::Rows;
use crate::linalg::NO_SYMMETRY;
use crate::linalg::{Csr, LinearError, Operator, Real, Triplets};

/// Largest compliance of a scaled row over its stiffness.
const SOFTEST: f64 = 1e4;

/// Scales of the constraint rows: stiffness k_i and weight s_i.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RowScales<T: Real = f64> {
    /// k_i: mean diagonal stiffness of the row's slave unknowns [force / length].
    pub stiffness: Vec<T>,
    /// s_i = sum_j |C_ij| over the slave [length^D]: lambda_i s_i is a force, gap_i / s_i a length.
    pub weight: Vec<T>,
}

/// Computes the scales of all rows; sums run over all entries of a row without slave entries, and an empty row has weight zero.
///
/// `diagonal` is that of the stiffness; if its mean in a row is zero, its largest entry is used, so that k_i > 0.
pub fn row_scales<T: Real>(diagonal: &[T], constraint: &Rows<T>, num_rows: usize) -> RowScales<T> {
    let largest = diagonal.iter().fold(T::zero(), |m, d| m.max(d.abs()));
    let fallback = if largest > T::zero() { largest } else { T::one() };
    let mut sums = vec![[T::zero(); 4]; num_rows]; // slave: sum of |C|, of |C| K; all: the same
    for (triplets, first) in [(&constraint.slave, true), (&constraint.master, false)] {
        // duplicate entries are summed first: they may cancel
        let csr = triplets.to_csr();
        for i in 0..csr.num_rows().min(num_rows) {
            let (cols, vals) = csr.row(i);
            for (j, &v) in cols.zip(vals) {
                let (a, k) = (v.abs(), diagonal[j].abs());
                sums[i][2] += a;
                sums[i][3] += a * k;
                if first {
                    sums[i][0] += a;
                    sums[i][1] += a * k;
                }
            }
        }
    }
    let mut scales = RowScales { stiffness: Vec::with_capacity(num_rows), weight: Vec::with_capacity(num_rows) };
    for [slave, slave_k, all, all_k] in sums {
        let (weight, sum) = if slave > T::zero() { (slave, slave_k) } else { (all, all_k) };
        let mean = if weight > T::zero() { sum / weight } else { T::zero() };
        scales.stiffness.push(if mean > T::zero() { mean } else { fallback });
        scales.weight.push(weight);
    }
    scales
}

/// Compliance of every row in a penalty method: s_i² / (factor k_i) [gap / lambda].
///
/// `factor` is a pure number: penalty stiffness over the stiffness of the row's own slave unknowns.
pub fn penalty<T: Real>(diagonal: &[T], constraint: &Rows<T>, num_rows: usize, factor: T) -> Vec<T> {
    let scales = row_scales(diagonal, constraint, num_rows);
    (0..num_rows).map(|i| scales.weight[i] * scales.weight[i] / (factor * scales.stiffness[i])).collect()
}

/// The constrained system in scaled rows, with its sizes checked: common input of the equality solvers.
#[derive(Debug)]
pub(crate) struct Scaled<'a> {
    pub stiffness: &'a Csr<f64>,
    pub diagonal: Vec<f64>,
    pub load: &'a [f64],
    /// Scaled C of all rows, also of the open ones.
    pub rows: Csr<f64>,
    /// Whether the stiffness is symmetric.
    pub symmetric: bool,
    /// Scaled B where it differs from C.
    pub reaction: Option<Csr<f64>>,
    /// Scaled Bᵀ, open rows included.
    pub columns: Csr<f64>,
    /// Scaled g.
    pub offset: Vec<f64>,
    /// Scaled compliance.
    pub compliance: Vec<f64>,
    /// k_i.
    pub k: Vec<f64>,
    /// r_i.
    pub factor: Vec<f64>,
    /// Rows that are enforced; the multiplier of the others is zero.
    pub enforced: Vec<bool>,
    /// Coordinates of every row: those of its slave unknown with the largest entry; empty if the unknowns have none.
    pub places: Vec<[f64; 3]>,
}

impl<'a> Scaled<'a> {
    pub(crate) fn of(system: &ConstrainedSystem<'a, f64>) -> Result<Self, SolveError> {
        let (n, m) = (system.stiffness.size(), system.offset.len());
        check_shape(system)?;
        if let Some(row) = system.kind.iter().position(|k| *k == RowKind::Contact) {
            return Err(SolveError::ContactRow { row });
        }
        let stiffness = system.stiffness.csr().ok_or(LinearError::NoMatrix)?;
        let diagonal = stiffness.diagonal();
        let finite = |x: &[f64]| x.iter().all(|v| v.is_finite());
        let mut rows = combined(system.constraint, m, n);
        let differs = system.reaction.filter(|b| *b != system.constraint);
        let mut reaction = differs.map(|b| combined(b, m, n));
        if !(finite(system.load)
            && finite(system.offset)
            && finite(system.compliance)
            && finite(rows.vals())
            && finite(stiffness.vals())
            && reaction.as_ref().is_none_or(|b| finite(b.vals())))
        {
            return Err(LinearError::NotFinite.into());
        }
        let k = row_scales(&diagonal, system.constraint, m).stiffness;
        let largest: Vec<f64> = (0..m).map(|i| rows.row(i).1.iter().fold(0.0, |a: f64, v| a.max(v.abs()))).collect();
        let compliance = |i: usize| system.compliance.get(i).copied().unwrap_or(0.0);
        let softest = |i: usize| if compliance(i) > 0.0 { (SOFTEST * k[i] / compliance(i)).sqrt() } else { f64::INFINITY };
        let factor: Vec<f64> = (0..m).map(|i| if largest[i] > 0.0 { (k[i] / largest[i]).min(softest(i)) } else { 1.0 }).collect();
        scale_rows(&mut rows, &factor);
        if let Some(b) = &mut reaction {
            scale_rows(b, &factor);
        }
        let compliance: Vec<f64> = (0..m).map(|i| compliance(i) * factor[i] * factor[i]).collect();
        let enforced = enforced(system, &rows)?;
        let offset = (0..m).map(|i| system.offset[i] * factor[i]).collect();
        let places = row_places(system, m, n);
        let symmetric = stiffness.is_symmetric(NO_SYMMETRY);
        let columns = reaction.as_ref().unwrap_or(&rows).transposed();
        let load = system.load;
        Ok(Self { stiffness, diagonal, load, rows, symmetric, reaction, columns, offset, compliance, k, factor, enforced, places })
    }

    /// Returns an error if the system is not symmetric.
    pub(crate) fn need_symmetry(&self) -> Result<(), SolveError> {
        if self.reaction.is_some() {
            return Err(SolveError::NotSymmetric);
        }
        if self.symmetric { Ok(()) } else { Err(LinearError::NotSymmetric.into()) }
    }

    /// Coordinates of the unknowns, then of the rows; empty if the unknowns have none.
    pub(crate) fn all_places(&self, unknowns: &[[f64; 3]]) -> Vec<[f64; 3]> {
        if unknowns.len() == self.num_unknowns() && self.places.len() == self.num_rows() {
            unknowns.iter().chain(&self.places).copied().collect()
        } else {
            Vec::new()
        }
    }

    /// |diagonal| of K + Cᵀ W C.
    pub(crate) fn diagonal_with(&self, w: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut diagonal = self.diagonal.clone();
        for a in 0..self.num_rows() {
            let (cols, vals) = self.rows.row(a);
            cols.zip(vals).for_each(|(j, &c)| diagonal[j] += c * w(a) * c);
        }
        diagonal.iter_mut().for_each(|d| *d = d.abs());
        diagonal
    }

    /// Nonzero contact rows of `kind` if they can share the factor of a symmetric system. `None` if there are none, if the system is not
    /// symmetric, or if a contact row without entries is soft.
    pub(crate) fn interface(&self, kind: &[RowKind]) -> Option<Vec<usize>> {
        let empty = |a: usize| self.rows.row(a).1.iter().all(|&v| v == 0.0);
        let mut contact: Vec<usize> = (0..self.num_rows()).filter(|&a| kind[a] == RowKind::Contact).collect();
        let lost = self.reaction.is_some() || !self.symmetric || contact.iter().any(|&a| empty(a) && self.compliance[a] > 0.0);
        contact.retain(|&a| !empty(a));
        (!lost && !contact.is_empty()).then_some(contact)
    }

    pub(crate) fn num_unknowns(&self) -> usize {
        self.load.len()
    }

    pub(crate) fn num_rows(&self) -> usize {
        self.offset.len()
    }
}

/// Returns the enforced rows: rows without entries are enforced only if they are soft.
fn enforced(system: &ConstrainedSystem<'_, f64>, rows: &Csr<f64>) -> Result<Vec<bool>, SolveError> {
    let m = system.offset.len();
    let far = system.offset.iter().fold(0.0, |a: f64, g| a.max(g.abs()));
    let mut enforced: Vec<bool> = system.kind.iter().map(|&k| k == RowKind::Equal).collect();
    for i in 0..m {
        let soft = system.compliance.get(i).is_some_and(|&s| s != 0.0);
        if enforced[i] && !soft && rows.row(i).1.iter().all(|&v| v == 0.0) {
            // 0 u + g = 0 is trivial or has no solution
            if system.offset[i].abs() > 1e-12 * far || (m == 1 && system.offset[i] != 0.0) {
                return Err(SolveError::OverConstrained { row: i, rows: m });
            }
            enforced[i] = false;
        }
    }
    Ok(enforced)
}

/// Parts of [`Scaled`] reused for another active set: all but stiffness, load and `enforced`.
#[derive(Debug)]
pub(crate) struct ScaledPattern {
    diagonal: Vec<f64>,
    rows: Csr<f64>,
    symmetric: bool,
    reaction: Option<Csr<f64>>,
    columns: Csr<f64>,
    offset: Vec<f64>,
    compliance: Vec<f64>,
    k: Vec<f64>,
    factor: Vec<f64>,
    places: Vec<[f64; 3]>,
}

impl ScaledPattern {
    /// Restores the scaled system for another set of rows; `system` is otherwise the one that was kept.
    pub(crate) fn with<'a>(self, system: &ConstrainedSystem<'a, f64>) -> Result<Scaled<'a>, SolveError> {
        check_shape(system)?;
        let Self { diagonal, rows, symmetric, reaction, columns, offset, compliance, k, factor, places } = self;
        let (stiffness, load) = (system.stiffness.csr().ok_or(LinearError::NoMatrix)?, system.load);
        let enforced = enforced(system, &rows)?;
        Ok(Scaled { stiffness, diagonal, load, rows, symmetric, reaction, columns, offset, compliance, k, factor, enforced, places })
    }
}

impl From<Scaled<'_>> for ScaledPattern {
    fn from(s: Scaled<'_>) -> Self {
        let Scaled { diagonal, rows, symmetric, reaction, columns, offset, compliance, k, factor, places, .. } = s;
        Self { diagonal, rows, symmetric, reaction, columns, offset, compliance, k, factor, places }
    }
}

/// (C u + g)_i of all rows, in the caller's units.
pub(crate) fn gaps<T: Real>(system: &ConstrainedSystem<'_, T>, u: &[T]) -> Vec<T> {
    let mut gap = system.offset.to_vec();
    for triplets in [&system.constraint.slave, &system.constraint.master] {
        for &(i, j, v) in &triplets.entries {
            gap[i] += v * u[j];
        }
    }
    gap
}

/// Checks that sizes and indices of the parts of `system` agree.
pub(crate) fn check_shape<T: Real>(system: &ConstrainedSystem<'_, T>) -> Result<(), SolveError> {
    let (n, m) = (system.stiffness.size(), system.offset.len());
    let shape = |what, found, expected| if found == expected { Ok(()) } else { Err(SolveError::Shape { what, found, expected }) };
    shape("entries of the load", system.load.len(), n)?;
    shape("kinds of rows", system.kind.len(), m)?;
    if !system.compliance.is_empty() {
        shape("compliances", system.compliance.len(), m)?;
    }
    for rows in [Some(system.constraint), system.reaction].into_iter().flatten() {
        for part in [&rows.slave, &rows.master] {
            if let Some(e) = part.entries.iter().find(|e| e.0 >= m || e.1 >= n) {
                let (what, found, expected) =
                    if e.0 >= m { ("rows of the constraint", e.0 + 1, m) } else { ("columns of the constraint", e.1 + 1, n) };
                return Err(SolveError::Shape { what, found, expected });
            }
        }
    }
    Ok(())
}

/// C = slave + master as an m x n matrix.
pub(crate) fn combined<T: Real>(rows: &Rows<T>, m: usize, n: usize) -> Csr<T> {
    let mut all = Triplets::new(m, n);
    all.entries = rows.slave.entries.iter().chain(&rows.master.entries).copied().collect();
    all.to_csr()
}

fn scale_rows(rows: &mut Csr<f64>, factor: &[f64]) {
    for (i, &factor) in factor.iter().enumerate() {
        rows.row_mut(i).1.iter_mut().for_each(|v| *v *= factor);
    }
}

/// Coordinates of every row: those of its slave unknown with the largest entry; empty if the unknowns have none.
pub(super) fn row_places(system: &ConstrainedSystem<'_, f64>, m: usize, n: usize) -> Vec<[f64; 3]> {
    let places = system.stiffness.dof_coordinates();
    if places.len() != n || n == 0 {
        return Vec::new();
    }
    let mut best = vec![(0.0, usize::MAX); m];
    for part in [&system.constraint.slave, &system.constraint.master] {
        for &(i, j, v) in &part.entries {
            // master entries are used only for rows without slave entries
            if best[i].1 == usize::MAX || (std::ptr::eq(part, &system.constraint.slave) && v.abs() > best[i].0) {
                best[i] = (v.abs(), j);
            }
        }
    }
    best.iter().map(|&(_, j)| if j == usize::MAX { places[0] } else { places[j] }).collect()
}
