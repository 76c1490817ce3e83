//! The inverse of the system of one set of contact, by the factor that all sets share: formulas in [`super::interface`].

use super::direct::Inverse;
use super::quasidefinite::{LdltPattern, REGULARISATION};
use super::scale::Scaled;
use crate::linalg::{Border, DenseLdlt, Ldlt, LinearError};

/// The inverse of the system of a set.
pub(super) struct Set<'a, 'b> {
    pub s: &'a Scaled<'b>,
    pub layout: &'a LdltPattern,
    pub border: &'a Border,
    pub contact: &'a [usize],
    pub ldlt: &'a Ldlt,
    pub dense: &'a DenseLdlt,
    pub w: &'a [f64],
    pub f: Vec<f64>,
}

impl Set<'_, '_> {
    /// 1 - t W of closed contact row `a`.
    fn share(&self, a: usize) -> f64 {
        1.0 - (self.s.compliance[a] + REGULARISATION * self.s.k[a]) * self.w[a]
    }

    /// Right-hand side of A for the residuals r1 and r2.
    fn right_side(&self, r1: &[f64], r2: &[f64]) -> Vec<f64> {
        let mut x = r1.to_vec();
        x.resize(x.len() + self.layout.multipliers(), 0.0);
        for (a, number) in self.layout.numbers() {
            x[r1.len() + number] = self.f[a] * r2[a];
            let (cols, vals) = self.s.rows.row(a);
            cols.zip(vals).for_each(|(j, v)| x[j] += v * self.w[a] * r2[a]);
        }
        x
    }

    /// Replaces h by nu; `r2` is read on closed rows.
    fn nu(&self, r2: &[f64], h: &mut [f64]) {
        for (h, &a) in h.iter_mut().zip(self.contact).filter(|(_, a)| self.s.enforced[**a]) {
            *h -= r2[a] / self.share(a);
        }
        self.dense.solve(h);
    }

    /// Unknowns and multipliers.
    fn parts(&self, mut x: Vec<f64>, nu: &[f64], r2: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (n, enforced) = (self.s.num_unknowns(), &self.s.enforced);
        let mut l = vec![0.0; self.s.num_rows()];
        for (a, number) in self.layout.numbers().filter(|(a, _)| enforced[*a]) {
            l[a] = x[n + number];
        }
        for (&nu, &a) in nu.iter().zip(self.contact).filter(|(_, a)| enforced[**a]) {
            l[a] = (nu + self.w[a] * r2[a]) / self.share(a);
        }
        x.truncate(n);
        (x, l)
    }
}

impl Inverse for Set<'_, '_> {
    fn step(&self, vector: &mut [f64]) -> Result<(), LinearError> {
        let none = vec![0.0; self.s.num_rows()];
        let mut x = self.right_side(vector, &none);
        self.ldlt.solve_bordered(self.border, &self.s.rows, [&mut x], |_, h| self.nu(&none, h))?;
        vector.copy_from_slice(&x[..vector.len()]);
        Ok(())
    }

    fn correct(&self, r1: &[f64], r2: &[f64]) -> Result<(Vec<f64>, Vec<f64>), LinearError> {
        let (mut x, mut nu) = (self.right_side(r1, r2), Vec::new());
        self.ldlt.solve_bordered(self.border, &self.s.rows, [&mut x], |_, h| {
            self.nu(r2, h);
            nu = h.to_vec();
        })?;
        Ok(self.parts(x, &nu, r2))
    }

    fn both(&self, vector: &mut [f64], r1: &[f64], r2: &[f64]) -> Result<(Vec<f64>, Vec<f64>), LinearError> {
        let none = vec![0.0; self.s.num_rows()];
        let (mut x, mut y, mut nu) = (self.right_side(vector, &none), self.right_side(r1, r2), Vec::new());
        self.ldlt.solve_bordered(self.border, &self.s.rows, [&mut x, &mut y], |which, h| {
            self.nu(if which == 0 { &none } else { r2 }, h);
            nu = h.to_vec();
        })?;
        vector.copy_from_slice(&x[..vector.len()]);
        Ok(self.parts(y, &nu, r2))
    }
}
