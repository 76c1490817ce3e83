//! Gluing of sides.

use super::glued::Glued;
use super::model::{BodyModel, BodySide};
use crate::space::{GlueError, Near, glue};
use std::sync::Arc;

impl Glued {
    /// Glues a side to others.
    ///
    /// # Errors
    /// [`GlueError`] if the sides are apart, or their grids or functions differ.
    pub fn add<const S: usize, const N: usize>(
        &mut self,
        patches: &[BodyModel<S, N>],
        slave: &BodySide<S, N>,
        masters: &[Arc<BodySide<S, N>>],
        near: Near,
    ) -> Result<(), GlueError> {
        let traces: Vec<_> = masters.iter().map(|m| &m.trace).collect();
        let first = |patch: usize| patches[patch].field.first / self.components;
        let rows = glue(&slave.trace, &traces, near)?;
        let mut touched = vec![false; masters.len()];
        let mut equal = Vec::new();
        for row in rows {
            touched[row.master] = true;
            let a = first(slave.patch) + row.function;
            let terms: Vec<(usize, f64)> = row.terms.iter().map(|&(j, c)| (first(masters[row.master].patch) + j, c)).collect();
            match terms[..] {
                [(b, 1.0)] => equal.push((a, b)),
                _ => self.combined.push((a, terms)),
            }
        }
        for (a, b) in equal {
            self.same(a, b);
        }
        for (master, _) in masters.iter().zip(&touched).filter(|(_, t)| **t) {
            self.join(slave.patch, master.patch);
        }
        Ok(())
    }
}
