//! A patch's share of a vector of unknowns: its functions' numbers in the whole, and their weights.

use super::Patches;
use crate::linalg::{Real, lit, to_f64};

/// Unknowns of a patch within the whole.
#[derive(Clone, Copy, Debug)]
pub(super) struct PatchNumbering<'a> {
    /// Number in the whole of every function of the patch; `None` if they are the same.
    pub ids: Option<&'a [u32]>,
    /// One weight per function of a rational basis.
    pub weights: Option<&'a [f64]>,
    /// Numbers per function.
    pub width: usize,
}

impl PatchNumbering<'_> {
    /// Reads the coefficients of the patch's functions times their weights, from number `from` of the patch on; an empty `u` is zero.
    pub fn read<T: Real>(&self, u: &[T], from: usize, to: &mut [f64]) {
        if u.is_empty() {
            to.fill(0.0);
            return;
        }
        match self.ids {
            None => {
                let u = &u[from..from + to.len()];
                to.iter_mut().zip(u).for_each(|(to, &u)| *to = to_f64(u));
            }
            Some(ids) => {
                for (k, to) in (from..).zip(to.iter_mut()) {
                    *to = to_f64(u[self.width * ids[k / self.width] as usize + k % self.width]);
                }
            }
        }
        if let Some(weights) = self.weights {
            to.iter_mut().enumerate().for_each(|(k, to)| *to *= weights[(from + k) / self.width]);
        }
    }

    /// Calls `sum` with zeroed numbers of the patch and adds the result times the weights to `out`, which is zero before
    /// the first patch.
    pub fn add<T: Real>(&self, functions: usize, out: &mut [T], sum: impl FnOnce(&mut [T])) {
        let Some(ids) = self.ids else {
            sum(out);
            self.scale(out);
            return;
        };
        let mut own = vec![T::zero(); self.width * functions];
        sum(&mut own);
        self.scale(&mut own);
        for (own, &id) in own.chunks_exact(self.width).zip(ids) {
            out[self.width * id as usize..].iter_mut().zip(own).for_each(|(out, &own)| *out += own);
        }
    }

    fn scale<T: Real>(&self, out: &mut [T]) {
        if let Some(weights) = self.weights {
            out.chunks_exact_mut(self.width).zip(weights).for_each(|(out, &w)| out.iter_mut().for_each(|v| *v *= lit(w)));
        }
    }
}

impl Patches<'_> {
    /// The unknowns of patch `k` for fields of `width` components.
    pub(super) fn part(&self, k: usize, width: usize) -> PatchNumbering<'_> {
        let ids = self.glue.as_ref().map(|glue| &glue.ids[glue.first[k]..glue.first[k + 1]]);
        PatchNumbering { ids, weights: self.patches[k].weight.as_ref().map(|(_, weights)| &weights[..]), width }
    }
}
