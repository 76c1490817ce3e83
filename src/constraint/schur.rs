//! The Schur complement of the multipliers by preconditioned conjugate gradients, with a factor of the stiffness inside.
//!
//! ```text
//! S lambda = C K⁻¹ f + g,   S = C K⁻¹ Cᵀ + s,   u = K⁻¹ (f - Cᵀ lambda)
//! M⁻¹ = N⁻¹ (C Q⁻¹ K Q⁻¹ Cᵀ + s) N⁻¹,   N = C Q⁻¹ Cᵀ + s,   Q = diag K
//! ```
//!
//! M⁻¹ equals S⁻¹ with the right inverse K⁻¹ Cᵀ S⁻¹ of C replaced by Q⁻¹ Cᵀ N⁻¹: the lumped preconditioner of FETI, weighted for rows
//! that are not signed Boolean. K is factorised once, however many rows open and close.
//!
//! A stiffness that leaves bodies floating is singular; then K_W = K + Cᵀ W C is factorised in its place. With W = min(1/k, 1/2s) and
//! F = 1 - W s the same system reads
//!
//! ```text
//! S_W lambda = F C K_W⁻¹ (f - Cᵀ W g) + F g,   S_W = F C K_W⁻¹ Cᵀ F + F s,   S_W⁻¹ = S⁻¹ + W F⁻¹
//! ```
//!
//! so that M⁻¹ + W F⁻¹ preconditions it: the iteration count grows by about ten with every halving of the element size.
//!
//! If the rows are few relative to the size of the factor, S is computed explicitly, once for all contact sets ([`super::complement`]):
//! the iterations are the same without solves by the factor.
//!
//! Sources: Klawonn, Widlund, Comm. Pure Appl. Math. 54 (2001) 57-90 (weights); Stefanica, SIAM J. Sci. Comput. 23 (2001) 1135-1160
//! (mortars).

use super::complement::{Complement, border};
use super::penalised::penalised;
use super::scale::{Scaled, ScaledPattern, gaps};
use super::{Abilities, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, SolveError, kinds_of_set};
use crate::linalg::{
    Csr, DenseLdlt, Ldlt, Limits, LinearError, LinearSolver, Operator, Sparsity, Upper, conjugate_gradients, product, sum,
};
use std::sync::Arc;

/// Residual tolerance of the conjugate gradients of one correction; the next correction continues from there.
const INNER: f64 = 1e-8;
/// Regularisation of N relative to its diagonal, as rows may be redundant.
const REGULARISATION: f64 = 1e-8;

/// Schur complement solver; needs the reaction to be the transposed constraint.
///
/// Redundant rows that agree share their multiplier; rows that contradict each other are an error.
#[derive(Debug, Default)]
pub struct Schur {
    /// Error of unknowns and multipliers wanted, and most iterations of the conjugate gradients.
    pub limits: Limits,
    stiffness: Ldlt,
    penalised: Ldlt,
    rows: Ldlt,
    /// Pattern of the last stiffness found singular.
    floating: Option<Arc<Sparsity>>,
    shared: Option<Shared>,
    dense: DenseLdlt,
    /// Scaled system kept for its next set of contact rows.
    kept: Option<ScaledPattern>,
}

/// Schur complement shared by the sets of a system.
#[derive(Debug)]
struct Shared {
    /// Springs on all rows added to the factorised matrix; `None` if that is the stiffness itself.
    springs: Option<Vec<f64>>,
    complement: Complement,
}

impl Schur {
    /// Creates a solver without a factor.
    pub fn new(limits: Limits) -> Self {
        Self { limits, ..Self::default() }
    }

    /// Number of symbolic analyses of the stiffness so far.
    pub fn num_symbolic_factorizations(&self) -> usize {
        self.stiffness.num_symbolic_factorizations() + self.penalised.num_symbolic_factorizations()
    }

    /// Number of factorisations of the stiffness so far.
    pub fn factorisations(&self) -> usize {
        self.stiffness.factorisations() + self.penalised.factorisations()
    }

    /// Factorises K, or K_W if K is singular, and computes S if that is cheaper; returns whether K_W was factorised.
    fn prepare(&mut self, s: &Scaled<'_>, part: &Parts, places: &[[f64; 3]]) -> Result<bool, LinearError> {
        self.shared = None;
        if self.floating.as_ref() != Some(s.stiffness.pattern()) {
            match self.stiffness.prepare(s.stiffness) {
                Ok(()) => {
                    definite(&mut self.stiffness, s.stiffness)?;
                    if let Some(border) = border(s, &self.stiffness) {
                        self.shared = Some(Shared { springs: None, complement: Complement::of(s, &self.stiffness, border, &part.q)? });
                    }
                    return Ok(false);
                }
                Err(LinearError::Singular { .. }) => self.floating = Some(s.stiffness.pattern().clone()),
                Err(other) => return Err(other),
            }
        }
        let springs: Vec<f64> = (0..s.num_rows()).map(|a| spring(s, a)).collect();
        let matrix = penalised(s, &s.columns, &springs, places);
        self.penalised.analyse(&matrix)?;
        let Some(border) = border(s, &self.penalised) else { return self.prepare_springs(s, part, places) };
        self.penalised.prepare(&matrix)?;
        definite(&mut self.penalised, &matrix)?;
        let complement = Complement::of(s, &self.penalised, border, &part.q)?;
        self.shared = Some(Shared { springs: Some(springs), complement });
        Ok(true)
    }

    /// Factorises K_W with the rows of a set alone.
    fn prepare_springs(&mut self, s: &Scaled<'_>, part: &Parts, places: &[[f64; 3]]) -> Result<bool, LinearError> {
        self.shared = None;
        let matrix = penalised(s, &s.columns, &part.w, places);
        self.penalised.prepare(&matrix)?;
        definite(&mut self.penalised, &matrix).map(|()| true)
    }

    /// Returns (u, l, residual, iterations) with the factor of K or, if `floats`, of K_W; `None` if the factor is unsuitable for this set.
    fn solved(&mut self, s: &Scaled<'_>, part: &Parts, floats: bool) -> Result<Option<(Vec<f64>, Vec<f64>, f64, usize)>, LinearError> {
        let m = s.num_rows();
        let factor = if floats { &self.penalised } else { &self.stiffness };
        let (w, f) = if floats { (part.w.clone(), part.f.clone()) } else { (vec![0.0; m], part.enforced.clone()) };
        let set = match &self.shared {
            Some(shared) => {
                let Some(set) = shared.complement.of_set(s, factor, shared.springs.as_deref(), &mut self.dense)? else { return Ok(None) };
                Some(set)
            }
            None => None,
        };
        let inverse = |v: &mut [f64]| match &set {
            Some(set) => set.apply_inverse(v),
            None => factor.apply_inverse(v),
        };
        let spread = self.shared.as_ref().map(|shared| &shared.complement.spread);
        self.rows.prepare(&part.n)?;
        let preconditioner = &self.rows;
        let answer = s.iterated(&part.scale, &self.limits, INNER, |r1, r2, limits| {
            let pushed: Vec<f64> = (0..m).map(|a| w[a] * r2[a]).collect();
            let mut load = r1.to_vec();
            s.rows.add_transposed_mul(&pushed, &mut load);
            let mut u = load.clone();
            inverse(&mut u)?;
            let mut b = vec![0.0; m];
            s.rows.mul(&u, &mut b);
            for a in 0..m {
                b[a] = f[a] * (b[a] - r2[a]);
            }
            let mut dl = vec![0.0; m];
            let mut v = vec![0.0; s.num_unknowns()];
            let done = conjugate_gradients(
                &mut |p, q| {
                    let scaled: Vec<f64> = (0..m).map(|a| f[a] * p[a]).collect();
                    if let Some(set) = &set {
                        set.multiply(&scaled, q);
                    } else {
                        v.fill(0.0);
                        s.rows.add_transposed_mul(&scaled, &mut v);
                        factor.apply_inverse(&mut v)?;
                        s.rows.mul(&v, q);
                    }
                    for a in 0..m {
                        q[a] = f[a] * (q[a] + s.compliance[a] * p[a]);
                    }
                    Ok(())
                },
                &mut |r, z| {
                    part.precondition(s, preconditioner, spread, r, z)?;
                    for a in 0..m {
                        z[a] = if part.enforced[a] == 0.0 { 0.0 } else { z[a] + w[a] / f[a] * r[a] };
                    }
                    Ok(())
                },
                &b,
                &mut dl,
                limits,
            )?;
            for a in 0..m {
                b[a] = f[a] * dl[a];
            }
            let mut du = vec![0.0; load.len()];
            s.rows.add_transposed_mul(&b, &mut du);
            for i in 0..du.len() {
                du[i] = load[i] - du[i];
            }
            inverse(&mut du)?;
            Ok((du, dl, done))
        })?;
        Ok(Some(answer))
    }
}

/// W of row `a`, whether it is enforced or not.
fn spring(s: &Scaled<'_>, a: usize) -> f64 {
    (1.0 / s.k[a]).min(0.5 / s.compliance[a])
}

/// Returns an error if the stiffness is indefinite.
fn definite(factor: &mut Ldlt, matrix: &Csr<f64>) -> Result<(), LinearError> {
    factor.refuse_negative(&Upper::of(matrix), matrix.num_rows(), matrix.dof_coordinates())
}

/// Weights, scales and matrices that are the same for the factors of K and K_W.
struct Parts {
    w: Vec<f64>,
    f: Vec<f64>,
    /// 1 on enforced rows, 0 on others.
    enforced: Vec<f64>,
    scale: Vec<f64>,
    /// Q⁻¹.
    q: Vec<f64>,
    /// N over enforced rows, k on the diagonal of others.
    n: Csr<f64>,
}

impl Parts {
    fn of(s: &Scaled<'_>) -> Self {
        let m = s.num_rows();
        let enforced: Vec<f64> = s.enforced.iter().map(|&e| if e { 1.0 } else { 0.0 }).collect();
        let w: Vec<f64> = (0..m).map(|a| if s.enforced[a] { spring(s, a) } else { 0.0 }).collect();
        let f = (0..m).map(|a| if s.enforced[a] { 1.0 - w[a] * s.compliance[a] } else { 0.0 }).collect();
        let largest = s.diagonal.iter().fold(0.0, |top: f64, d| top.max(d.abs()));
        let q: Vec<f64> = s.diagonal.iter().map(|d| 1.0 / if *d != 0.0 { d.abs() } else { largest.max(f64::MIN_POSITIVE) }).collect();
        let scale = s.diagonal.iter().map(|d| if *d != 0.0 { 1.0 / d.abs() } else { 1.0 }).collect();
        // C Q⁻¹ Cᵀ over the enforced rows; the pattern holds all
        let mut left = s.rows.clone();
        for a in 0..m {
            let (cols, vals) = left.row_mut(a);
            cols.zip(vals).for_each(|(j, v)| *v *= enforced[a] * q[j]);
        }
        let mut right = s.columns.clone();
        for i in 0..right.num_rows() {
            let (cols, vals) = right.row_mut(i);
            cols.zip(vals).for_each(|(a, v)| *v *= enforced[a]);
        }
        let inner = product(&left, &right);
        let own = inner.diagonal();
        let diagonal: Vec<f64> = (0..m).map(|a| if s.enforced[a] { s.compliance[a] + REGULARISATION * own[a] } else { s.k[a] }).collect();
        let index = (0..m).map(|a| u32::try_from(a).expect("fewer than 2^32 rows")).collect();
        let n = sum(1.0, &inner, 1.0, &Csr::from_parts(m, (0..=m).collect(), index, diagonal)).with_dof_coordinates(s.places.clone());
        Self { w, f, enforced, scale, q, n }
    }

    /// z = N⁻¹ (C Q⁻¹ K Q⁻¹ Cᵀ + s) N⁻¹ r over the enforced rows.
    /// `spread`: C Q⁻¹ K Q⁻¹ Cᵀ over all rows, if computed.
    fn precondition(&self, s: &Scaled<'_>, n: &Ldlt, spread: Option<&Csr<f64>>, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        let m = r.len();
        let mut t: Vec<f64> = (0..m).map(|a| self.enforced[a] * r[a]).collect();
        n.apply_inverse(&mut t)?;
        for a in 0..m {
            t[a] *= self.enforced[a];
        }
        if let Some(spread) = spread {
            spread.mul(&t, z);
        } else {
            let mut v = vec![0.0; self.q.len()];
            s.rows.add_transposed_mul(&t, &mut v);
            v.iter_mut().zip(&self.q).for_each(|(v, q)| *v *= q);
            let mut kv = vec![0.0; v.len()];
            s.stiffness.mul(&v, &mut kv);
            kv.iter_mut().zip(&self.q).for_each(|(v, q)| *v *= q);
            s.rows.mul(&kv, z);
        }
        for a in 0..m {
            z[a] = self.enforced[a] * (z[a] + s.compliance[a] * t[a]);
        }
        n.apply_inverse(z)
    }
}

impl ConstraintSolver<f64> for Schur {
    fn abilities(&self) -> Abilities {
        Abilities { more_rows_than_unknowns: true, ..Abilities::default() }
    }

    fn tolerance(&self) -> f64 {
        self.limits.tolerance
    }

    fn factors(&self) -> usize {
        self.factorisations()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        self.solve_scaled(system, &Scaled::of(system)?, false)
    }

    fn solve_set(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        closed: &[bool],
        again: bool,
    ) -> Result<ConstrainedSolution<f64>, SolveError> {
        let kind = kinds_of_set(system.kind, closed);
        let of_set = ConstrainedSystem { kind: &kind, ..*system };
        let s = match self.kept.take() {
            Some(kept) if again => kept.with(&of_set)?,
            _ => Scaled::of(&of_set)?,
        };
        let solved = self.solve_scaled(&of_set, &s, again);
        self.kept = Some(s.into());
        solved
    }
}

impl Schur {
    /// Solves `system`, whose scaled form is `s`; `again`: the matrices are those of the last call.
    fn solve_scaled(
        &mut self,
        system: &ConstrainedSystem<'_, f64>,
        s: &Scaled<'_>,
        again: bool,
    ) -> Result<ConstrainedSolution<f64>, SolveError> {
        s.need_symmetry()?;
        let m = s.num_rows();
        let part = Parts::of(s);
        let places = system.stiffness.dof_coordinates();
        let mut floats = match &self.shared {
            Some(shared) if again => shared.springs.is_some(),
            _ => self.prepare(s, &part, places)?,
        };
        let mut answer = self.solved(s, &part, floats);
        if matches!(answer, Ok(None)) || !floats && matches!(answer, Err(LinearError::Singular { .. })) {
            // indefinite, or a nearly singular stiffness
            floats = self.prepare_springs(s, &part, places)?;
            answer = self.solved(s, &part, floats);
        }
        let (unknowns, l, residual, iterations) = answer?.ok_or(LinearError::Singular { residual: 1.0 })?;
        Ok(ConstrainedSolution {
            gap: gaps(system, &unknowns),
            unknowns,
            multipliers: (0..m).map(|a| s.factor[a] * l[a]).collect(),
            active: s.enforced.clone(),
            residual,
            condition: None,
            method: format!(
                "schur, conjugate gradients over a factor of {}",
                if floats { "the penalised stiffness" } else { "the stiffness" }
            ),
            iterations,
            active_set: None,
        })
    }
}
