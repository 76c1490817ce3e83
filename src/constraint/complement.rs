//! Explicit Schur complement of all constraint rows over one factor, reused for every set of open rows.
//!
//! ```text
//! A = K + Cᵀ V C,   S = C A⁻¹ Cᵀ;   V = 0, or penalty springs on all rows if bodies float
//! ```
//!
//! The springs of the open rows O are removed: A' = A - Oᵀ V O, and
//!
//! ```text
//! A'⁻¹ r = A⁻¹ (r - Oᵀ nu),   (S_oo - V⁻¹) nu = O A⁻¹ r,   S' = S_cc - S_co (S_oo - V⁻¹)⁻¹ S_oc
//! ```
//!
//! Source: Hager, SIAM Review 31 (1989) 221-239.

use super::direct::{Factor, refuse_kernel};
use super::interface::{CORRECTIONS, affordable, pays};
use super::scale::Scaled;
use crate::linalg::residual::{InverseIteration, SAFE_GROWTH};
use crate::linalg::{Border, Buffer, Csr, DenseLdlt, Ldlt, LinearError, product};

/// Steps of inverse iteration used to find a zero-energy mode.
const STEPS: usize = 2;

/// S and other data shared by all sets of rows of one matrix.
#[derive(Debug)]
pub(super) struct Complement {
    border: Border,
    /// S, lower triangle, column after column.
    s: Buffer<f64>,
    /// C Q⁻¹ K Q⁻¹ Cᵀ.
    pub spread: Csr<f64>,
}

/// Returns the border formed by the nonzero rows of `s` over a factor; `None` if iterations with the factor are cheaper than S, if S is
/// too large, or if there are no such rows.
pub(super) fn border(s: &Scaled<'_>, ldlt: &Ldlt) -> Option<Border> {
    let rows: Vec<usize> = (0..s.num_rows()).filter(|&a| s.rows.row(a).1.iter().any(|&v| v != 0.0)).collect();
    let (entries, factor) = ldlt.size();
    if rows.is_empty() || !affordable(rows.len(), entries) {
        return None;
    }
    Some(ldlt.border(&s.rows, &rows)).filter(|border| pays(border, factor))
}

impl Complement {
    /// S by the factor of A; `q` is the diagonal of Q⁻¹.
    pub fn of(s: &Scaled<'_>, ldlt: &Ldlt, border: Border, q: &[f64]) -> Result<Self, LinearError> {
        let complement = ldlt.complement(&border, &s.rows)?;
        let (mut left, mut right) = (s.rows.clone(), s.columns.clone());
        for a in 0..left.num_rows() {
            let (cols, vals) = left.row_mut(a);
            cols.zip(vals).for_each(|(j, v)| *v *= q[j]);
        }
        for (i, q) in q.iter().enumerate() {
            right.row_mut(i).1.iter_mut().for_each(|v| *v *= q);
        }
        Ok(Self { border, s: complement, spread: product(&left, &product(s.stiffness, &right)) })
    }

    /// S' and A' for the rows that are open in `s`, with `springs` = V; `None` if A' is indefinite.
    ///
    /// # Errors
    /// [`LinearError::Singular`] if A' has a zero-energy mode.
    pub fn of_set<'a>(
        &'a self,
        s: &'a Scaled<'_>,
        ldlt: &'a Ldlt,
        springs: Option<&[f64]>,
        dense: &'a mut DenseLdlt,
    ) -> Result<Option<OfSet<'a>>, LinearError> {
        let (rows, m) = (&self.border.rows, self.border.rows.len());
        let mut order: Vec<usize> = (0..m).collect();
        let open = |k: &usize| !s.enforced[rows[*k]];
        order.sort_by_key(|k| !open(k));
        let count = if springs.is_some() { order.iter().filter(|k| open(k)).count() } else { 0 };
        let lower = |i: usize, j: usize| self.s[order[i].min(order[j]) * m + order[i].max(order[j])];
        let give = |i: usize| springs.map_or(0.0, |v| 1.0 / v[rows[order[i]]]);
        dense.eliminate(m, count, |i, j| lower(i, j) - if i == j && i < count { give(i) } else { 0.0 })?;
        let set = OfSet { s, all: self, ldlt, dense, order, count };
        if count > 0 {
            set.refuse_motions()?;
        }
        let negative = set.dense.pivots().any(|pivot| pivot > 0.0);
        Ok((!negative).then_some(set))
    }
}

/// S' and A' of a set.
#[derive(Debug)]
pub(super) struct OfSet<'a> {
    s: &'a Scaled<'a>,
    all: &'a Complement,
    ldlt: &'a Ldlt,
    dense: &'a DenseLdlt,
    /// Positions of the rows in the border; open rows with springs come first.
    order: Vec<usize>,
    count: usize,
}

impl OfSet<'_> {
    /// r = A'⁻¹ r.
    pub fn apply_inverse(&self, r: &mut [f64]) -> Result<(), LinearError> {
        if self.count == 0 {
            return self.ldlt.apply_inverse(r);
        }
        let mut open = vec![0.0; self.count];
        self.ldlt.solve_bordered(&self.all.border, &self.s.rows, [r], |_, h| {
            open.iter_mut().zip(&self.order).for_each(|(v, &k)| *v = h[k]);
            self.dense.solve(&mut open);
            h.fill(0.0);
            open.iter().zip(&self.order).for_each(|(v, &k)| h[k] = *v);
        })
    }

    /// q = S' p over all rows; p is zero on open ones.
    pub fn multiply(&self, p: &[f64], q: &mut [f64]) {
        let rows: Vec<usize> = self.order[self.count..].iter().map(|&k| self.all.border.rows[k]).collect();
        let x: Vec<f64> = rows.iter().map(|&a| p[a]).collect();
        let mut y = vec![0.0; x.len()];
        self.dense.multiply_rest(&x, &mut y);
        q.fill(0.0);
        rows.iter().zip(y).for_each(|(&a, y)| q[a] = y);
    }

    /// Returns [`LinearError::Singular`] if A' has a zero-energy mode.
    fn refuse_motions(&self) -> Result<(), LinearError> {
        let (s, factor) = (self.s, Factor::of(self.s));
        let mut motion = InverseIteration::begin(&factor.diagonal);
        for _ in 0..STEPS {
            self.apply_inverse(motion.right_side())?;
            motion.solved().ok_or(LinearError::Singular { residual: 1.0 })?;
        }
        let mut soft = motion.end();
        if soft.growth > SAFE_GROWTH {
            for _ in 0..CORRECTIONS {
                let (mut product, mut pushed) = (vec![0.0; s.num_unknowns()], vec![0.0; s.num_rows()]);
                s.stiffness.mul(&soft.vector, &mut product);
                s.rows.mul(&soft.vector, &mut pushed);
                pushed.iter_mut().zip(&factor.w).for_each(|(p, w)| *p *= w);
                s.rows.add_transposed_mul(&pushed, &mut product);
                factor.correct_motion(&mut soft.vector, &mut product, |r| {
                    let mut r = r.to_vec();
                    self.apply_inverse(&mut r)?;
                    Ok(r)
                })?;
            }
        }
        refuse_kernel(s, &factor, &soft.vector).map(|_| ())
    }
}
