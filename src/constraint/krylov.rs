//! The saddle-point system by Krylov methods.
//!
//! Symmetric: MINRES without any factor, on the augmented form of [`super::schur`]'s head,
//!
//! ```text
//! [ K_W   Cᵀ F ]              [ (D + L) D⁻¹ (D + Lᵀ) of K_W            ]
//! [ F C   -F s ]  against     [                             W⁻¹ F      ],   K_W = K + Cᵀ W C,  F = 1 - W s
//! ```
//!
//! whose blocks are positive definite even if bodies float. Without exact rows: conjugate gradients on K_W alone.
//!
//! Where the reaction differs from the constraint or the stiffness is not symmetric: GMRES on [ K Bᵀ ; C -s ], preconditioned from
//! the right by the factor of the system with (K + Kᵀ) / 2 and B = C. B - C is an error of integration, so the eigenvalues gather at one.

use super::direct::Direct;
use super::penalised::{inverse_diagonal, penalised, refuse_motions};
use super::scale::{Scaled, gaps};
use super::{Abilities, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, SolveError};
use crate::linalg::{Limits, LinearError, Operator, conjugate_gradients, gauss_seidel, gmres, minres, sum};

/// Residual tolerance of the iteration of one correction; the next correction continues from there.
const INNER: f64 = 1e-7;
/// W times k of an exact row: larger ones improve the conditioning of the rows and harm that of the stiffness.
const WEIGHT: f64 = 4.0;
/// Vectors kept by GMRES; with the symmetric factor few are used.
const RESTART: usize = 60;

/// Saddle-point solver by MINRES, or by GMRES with the factor of the symmetric system.
#[derive(Debug, Default)]
pub struct Krylov {
    /// Error of unknowns and multipliers wanted, and most iterations.
    pub limits: Limits,
    symmetric: Direct,
}

/// (u, l, residual, iterations).
type Answer = (Vec<f64>, Vec<f64>, f64, usize);

impl Krylov {
    /// Creates a solver without a factor.
    pub fn new(limits: Limits) -> Self {
        Self { limits, symmetric: Direct::new() }
    }

    fn without_factor(&self, s: &Scaled<'_>) -> Result<Answer, LinearError> {
        let (n, m) = (s.num_unknowns(), s.num_rows());
        let w: Vec<f64> = (0..m).map(|a| if s.enforced[a] { (WEIGHT / s.k[a]).min(0.5 / s.compliance[a]) } else { 0.0 }).collect();
        let f: Vec<f64> = (0..m).map(|a| if s.enforced[a] { 1.0 - w[a] * s.compliance[a] } else { 0.0 }).collect();
        let matrix = penalised(s, &s.columns, &w, &[]);
        let inverse = inverse_diagonal(&matrix)?;
        refuse_motions(&matrix, &inverse, &self.limits)?;
        let scale: Vec<f64> = s.diagonal.iter().map(|d| if *d != 0.0 { 1.0 / d.abs() } else { 1.0 }).collect();
        let has_rows = s.enforced.contains(&true);
        s.iterated(&scale, &self.limits, INNER, |r1, r2, limits| {
            let mut b = r1.to_vec();
            let pushed: Vec<f64> = (0..m).map(|a| w[a] * r2[a]).collect();
            s.rows.add_transposed_mul(&pushed, &mut b);
            if !has_rows {
                let mut du = vec![0.0; n];
                let done = conjugate_gradients(
                    &mut |p, q| {
                        matrix.apply(p, q);
                        Ok(())
                    },
                    &mut |r, z| {
                        gauss_seidel(&matrix, &inverse, r, z);
                        Ok(())
                    },
                    &b,
                    &mut du,
                    limits,
                )?;
                return Ok((du, vec![0.0; m], done));
            }
            b.extend((0..m).map(|a| f[a] * r2[a]));
            let mut x = vec![0.0; n + m];
            let done = minres(
                &mut |p, q| {
                    let (q1, q2) = q.split_at_mut(n);
                    matrix.apply(&p[..n], q1);
                    let l: Vec<f64> = (0..m).map(|a| f[a] * p[n + a]).collect();
                    s.rows.add_transposed_mul(&l, q1);
                    s.rows.mul(&p[..n], q2);
                    for a in 0..m {
                        q2[a] = f[a] * (q2[a] - s.compliance[a] * p[n + a]);
                    }
                    Ok(())
                },
                &mut |r, z| {
                    let (z1, z2) = z.split_at_mut(n);
                    gauss_seidel(&matrix, &inverse, &r[..n], z1);
                    for a in 0..m {
                        z2[a] = if s.enforced[a] { w[a] / f[a] * r[n + a] } else { 0.0 };
                    }
                    Ok(())
                },
                &b,
                &mut x,
                limits,
            )?;
            let dl = x.split_off(n);
            Ok((x, dl, done))
        })
    }

    fn with_symmetric_factor(&mut self, system: &ConstrainedSystem<'_, f64>, s: &Scaled<'_>) -> Result<Answer, SolveError> {
        let (n, m) = (s.num_unknowns(), s.num_rows());
        let part = (!s.symmetric).then(|| {
            sum(0.5, s.stiffness, 0.5, &s.stiffness.transposed()).with_dof_coordinates(system.stiffness.dof_coordinates().to_vec())
        });
        let stiffness: &dyn Operator = part.as_ref().map_or(system.stiffness, |k| k);
        let half = Scaled::of(&ConstrainedSystem { stiffness, reaction: None, ..*system })?;
        let factor = self.symmetric.factorise(&half, system.stiffness.dof_coordinates())?;
        let symmetric = &self.symmetric;
        let reaction = s.reaction.as_ref().unwrap_or(&s.rows);
        let scale = factor.scale.clone();
        // in units of length, as both parts of the residual are measured
        let length = |i: usize| if i < n { scale[i] } else { 1.0 / s.k[i - n] };
        Ok(s.iterated(&factor.scale, &self.limits, INNER, |r1, r2, limits| {
            let b: Vec<f64> = (0..n + m).map(|i| length(i) * if i < n { r1[i] } else { r2[i - n] }).collect();
            let mut x = vec![0.0; n + m];
            let done = gmres(
                &mut |p, q| {
                    let (q1, q2) = q.split_at_mut(n);
                    s.stiffness.mul(&p[..n], q1);
                    let l: Vec<f64> = (0..m).map(|a| if s.enforced[a] { p[n + a] } else { 0.0 }).collect();
                    reaction.add_transposed_mul(&l, q1);
                    s.rows.mul(&p[..n], q2);
                    for a in 0..m {
                        // open row: l = 0
                        q2[a] = if s.enforced[a] { q2[a] - s.compliance[a] * l[a] } else { -s.k[a] * p[n + a] };
                    }
                    for i in 0..n + m {
                        q[i] *= length(i);
                    }
                    Ok(())
                },
                &mut |r, z| {
                    let force: Vec<f64> = (0..n + m).map(|i| r[i] / length(i)).collect();
                    let (du, dl) = symmetric.correct(&half, &factor, &force[..n], &force[n..])?;
                    z[..n].copy_from_slice(&du);
                    z[n..].copy_from_slice(&dl);
                    for a in 0..m {
                        if !s.enforced[a] {
                            z[n + a] = -force[n + a] / s.k[a];
                        }
                    }
                    Ok(())
                },
                RESTART,
                &b,
                &mut x,
                limits,
            )?;
            let mut dl = x.split_off(n);
            for a in 0..m {
                if !s.enforced[a] {
                    dl[a] = 0.0;
                }
            }
            Ok((x, dl, done))
        })?)
    }
}

impl ConstraintSolver<f64> for Krylov {
    fn abilities(&self) -> Abilities {
        Abilities { contact: false, unsymmetric: true, more_rows_than_unknowns: true }
    }

    fn tolerance(&self) -> f64 {
        self.limits.tolerance
    }

    fn factors(&self) -> usize {
        self.symmetric.factorisations()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        let s = Scaled::of(system)?;
        let (method, answer) = if s.need_symmetry().is_err() {
            ("saddle-point, GMRES with the symmetric factor", self.with_symmetric_factor(system, &s)?)
        } else if s.enforced.contains(&true) {
            ("saddle-point, MINRES", self.without_factor(&s)?)
        } else {
            ("conjugate gradients", self.without_factor(&s)?)
        };
        let (unknowns, l, residual, iterations) = answer;
        Ok(ConstrainedSolution {
            gap: gaps(system, &unknowns),
            unknowns,
            multipliers: (0..l.len()).map(|a| s.factor[a] * l[a]).collect(),
            active: s.enforced,
            residual,
            condition: None,
            method: method.into(),
            iterations,
            active_set: None,
        })
    }
}
