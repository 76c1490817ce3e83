//! Equations between unknowns that prescribed values contradict: sliding along inclined sides, sides that move as one.

use super::error::{ErrorKind, ProblemError};
use super::handles::Statement;
use super::model::{Model, SaidEquation};
use crate::assembly::{Equation, ReductionError, consistent};
use std::collections::HashSet;

impl<const S: usize, const N: usize> Model<S, N> {
    /// The first equation that contradicts the values `prescribed` at time `t`, with the statements that it contradicts; `changes`: whether
    /// values change with the time.
    pub(super) fn contradiction(&self, prescribed: &[(usize, f64)], t: f64, changes: bool) -> Option<ProblemError> {
        if self.equations.is_empty() {
            return None;
        }
        let all = self.all_equations();
        let Err(ReductionError::Contradiction { equation, defect }) = consistent(self.unknowns, prescribed, &all) else { return None };
        let own = equation.checked_sub(all.len() - self.equations.len())?;
        let said = &self.equations[own];
        let (before, unknowns) = self.reached(own, &prescribed.iter().map(|p| p.0).collect());
        let mut others: Vec<(Statement, &str)> = Vec::new();
        for c in &self.conditions {
            let meets = |&dof: &usize| unknowns.contains(&self.glued.unknown(c.side.field.unknown(dof, c.component)));
            if c.side.trace.dofs.iter().any(meets) {
                others.push((c.of, &c.side.label));
            }
        }
        for p in &self.pins {
            let field = self.patches[p.rim.patch].field;
            if p.rim.rim.functions().iter().any(|&f| unknowns.contains(&self.glued.unknown(field.unknown(f, p.component)))) {
                others.push((p.of, &p.rim.label));
            }
        }
        others.extend(before.into_iter().filter(|e| e.of != said.of).map(|e| (e.of, self.label(e))));
        let mut told = HashSet::new();
        others.retain(|other| told.insert(other.0));
        let names = std::iter::once(self.label(said)).chain(others.iter().map(|o| o.1)).map(str::to_owned).collect();
        let of = others.iter().map(|o| o.0).chain([said.of]).collect();
        Some(ProblemError::new(ErrorKind::Contradiction { defect: defect.abs(), t, changes }, of, names))
    }

    /// Equations before the one with the number `own` that are chained to it by unknowns that are not `known`, and the unknowns of all of
    /// them; of glued unknowns the one that stands for all.
    fn reached(&self, own: usize, known: &HashSet<usize>) -> (Vec<&SaidEquation>, HashSet<usize>) {
        let terms = |e: &Equation| e.terms.iter().map(|t| self.glued.unknown(t.0)).collect::<Vec<_>>();
        let mut unknowns: HashSet<usize> = terms(&self.equations[own].equation).into_iter().collect();
        let mut left: Vec<(&SaidEquation, Vec<usize>)> = self.equations[..own].iter().map(|e| (e, terms(&e.equation))).collect();
        let mut chained = Vec::new();
        loop {
            let joins = |(_, terms): &(&SaidEquation, Vec<usize>)| terms.iter().any(|i| unknowns.contains(i) && !known.contains(i));
            let (next, rest): (Vec<_>, Vec<_>) = left.into_iter().partition(joins);
            if next.is_empty() {
                return (chained, unknowns);
            }
            left = rest;
            for (equation, terms) in next {
                unknowns.extend(terms);
                chained.push(equation);
            }
        }
    }

    /// Name of the side of an equation.
    fn label(&self, said: &SaidEquation) -> &str {
        let touches = |patch: usize, dofs: &[usize]| {
            let field = self.patches[patch].field;
            let mut functions = said.equation.terms.iter().filter_map(|t| t.0.checked_sub(field.first)).map(|k| k / field.components);
            functions.any(|f| dofs.contains(&f))
        };
        let held = self.held.iter().find(|h| h.of == said.of && touches(h.side.patch, &h.side.trace.dofs));
        held.map_or("an equation", |h| &h.side.label)
    }
}
