//! Sides of bodies as parts of a problem.

use super::compiled::Compiled;
use super::model::{BodyModel, BodySide, Model};
use crate::assembly::{gauss_rules, revolved};
use crate::quadrature::PerElement;
use crate::space::{Field, JoinedSide, SideError, Trace};
use std::sync::{Arc, OnceLock};

/// The rules of a side with `extra` points, of a surface of revolution if `is_revolved`.
fn rules<const S: usize, const N: usize>(trace: &Trace<S, N>, extra: usize, is_revolved: bool) -> PerElement<S> {
    let plain = gauss_rules(&*trace.space, extra);
    if is_revolved { revolved(&*trace.space, &plain) } else { plain }
}

impl<const S: usize, const N: usize> BodySide<S, N> {
    /// The side `side` of `patch`, the patch number `number` of its model; `label` is its name in results.
    ///
    /// # Errors
    /// [`SideError`] of the body.
    pub(crate) fn new(patch: &BodyModel<S, N>, number: usize, side: &str, label: String) -> Result<Self, SideError> {
        Ok(Self::of_trace(patch, number, side, label, patch.body.trace(side)?))
    }

    /// The elements `elements` of this side, cells of one shape, as a side with the name `label`; bodies and traces as in its model.
    pub(super) fn part(&self, patches: &[BodyModel<S, N>], compiled: &dyn Compiled<S, N>, elements: &[usize], label: String) -> Self {
        let trace = compiled.part(&self.trace, elements, self.trace.space.cell(elements[0]));
        Self::of_trace(&patches[self.patch], self.patch, &self.side, label, trace)
    }

    /// The side with the trace `trace`, arguments before it as in [`BodySide::new`].
    pub(crate) fn of_trace(patch: &BodyModel<S, N>, number: usize, side: &str, label: String, trace: Trace<S, N>) -> Self {
        let rules = rules(&trace, patch.extra_points, patch.is_revolved());
        Self {
            patch: number,
            side: side.to_owned(),
            label,
            field: patch.field,
            runs: vec![(0, number)],
            trace,
            rules,
            whole: None,
            sag_of_pieces: OnceLock::new(),
        }
    }

    /// Several sides as one surface, in functions of the model: glued functions are one; `None` without sides.
    pub(crate) fn joined(model: &Model<S, N>, sides: &[Arc<Self>]) -> Option<Arc<Self>> {
        let (first, others) = sides.split_first()?;
        if others.is_empty() {
            return Some(first.clone());
        }
        let parts: Vec<JoinedSide<'_, S, N>> = sides
            .iter()
            .map(|s| JoinedSide {
                trace: &s.trace,
                dofs: s.trace.dofs.iter().map(|&dof| model.function(s.patch, dof)).collect(),
                first_element: 0,
            })
            .collect();
        let trace = Trace::joined(&parts);
        let mut next = 0;
        let run = |s: &Arc<Self>| {
            let start = next;
            next += s.trace.facets.len();
            (start, s.patch)
        };
        let runs = sides.iter().map(run).collect();
        let extra = sides.iter().map(|s| model.patches[s.patch].extra_points).max().unwrap_or(0);
        let rules = rules(&trace, extra, model.is_revolved());
        let label = sides.iter().map(|s| s.label.as_str()).collect::<Vec<_>>().join(", ");
        let field = Field { first: 0, components: model.components };
        Some(Arc::new(Self {
            patch: first.patch,
            side: first.side.clone(),
            label,
            field,
            runs,
            trace,
            rules,
            whole: None,
            sag_of_pieces: OnceLock::new(),
        }))
    }

    /// Number of its body, of several sides that of the first.
    pub fn body(&self) -> usize {
        self.patch
    }

    /// Its name in the body: u0, v1, a tag.
    pub fn name(&self) -> &str {
        &self.side
    }

    /// Its name in results: "lower.v0".
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Functions, map and facets.
    pub fn trace(&self) -> &Trace<S, N> {
        &self.trace
    }

    /// (first element, number of the body) of every run of elements; one run, unless several sides are one.
    pub fn runs(&self) -> &[(usize, usize)] {
        &self.runs
    }

    /// Highest degree of its functions.
    pub fn degree(&self) -> usize {
        let space = &self.trace.space;
        (0..space.num_elements()).flat_map(|e| space.degree(e)).max().unwrap_or(1)
    }
}
