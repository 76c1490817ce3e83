//! Functions that glued sides share: every patch keeps its unknowns, identical ones have a common representative (root).
//!
//! A glued function is bound by u_i - u_root = 0, one equation per component and function: a union-find over all seams,
//! so that a cross point of any number of patches is no special case.

use super::Builder;
use super::couples::{Couple, Couples};
use super::meetings::{self, Hinge};
use super::model::PatchModel;
use super::ties::{labels, short};
use crate::errors::Diagnostic;
use faying::assembly::Equation;
use faying::space::{GlueError, Near, glue};

/// Sets of functions of the model identified by gluing, numbered unknown / components.
#[derive(Clone, Debug, Default)]
pub struct Glued {
    components: usize,
    /// Representative of each function, the least number of its set; empty if nothing is glued.
    root: Vec<usize>,
    /// Functions that are combinations of others: a = sum of terms.
    combined: Vec<(usize, Vec<(usize, f64)>)>,
    /// First patch of the body that a patch is part of.
    body: Vec<usize>,
}

impl Glued {
    /// Creates the state before gluing: `functions` in total, `patches` bodies.
    pub(super) fn new(components: usize, functions: usize, patches: usize) -> Self {
        Self { components, root: (0..functions).collect(), combined: Vec::new(), body: (0..patches).collect() }
    }

    /// Glues the side pairs of the case, and the points in which patches of one mesh meet; also returns the latter.
    pub(super) fn of<const S: usize, const N: usize>(
        builder: &mut Builder<'_, S, N>,
        patches: &[PatchModel<S, N>],
        couples: &Couples<S, N>,
    ) -> (Self, Vec<Hinge<N>>) {
        let unknowns = patches.last().map_or(0, |p| p.range().end);
        let components = builder.case.model.components();
        let mut glued = Self::new(components, unknowns / components.max(1), patches.len());
        let mut faults = Vec::new();
        for couple in couples.glued(builder) {
            if let Err(error) = glued.add(patches, couple) {
                faults.push(fault(builder, couple, &error));
            }
        }
        for found in faults {
            builder.faults.push(found);
        }
        let hinges = meetings::join(builder.case, patches, components, &mut glued);
        glued.finish();
        (glued, hinges)
    }

    fn add<const S: usize, const N: usize>(&mut self, patches: &[PatchModel<S, N>], couple: &Couple<S, N>) -> Result<(), GlueError> {
        let slave = &couple.slave;
        let exact = patches[slave.patch].exact_map && couple.masters.iter().all(|m| patches[m.patch].exact_map);
        let near = match couple.tolerance {
            Some(distance) => Near::Given(distance),
            None if exact => Near::Exact,
            None if couple.is_named => Near::Corners,
            None => Near::Facets,
        };
        let traces: Vec<_> = couple.masters.iter().map(|m| &m.trace).collect();
        let first = |patch: usize| patches[patch].field.first / self.components;
        let rows = glue(&slave.trace, &traces, near)?;
        let mut touched = vec![false; couple.masters.len()];
        let mut equal = Vec::new();
        for row in rows {
            touched[row.master] = true;
            let a = first(slave.patch) + row.function;
            let terms: Vec<(usize, f64)> = row.terms.iter().map(|&(j, c)| (first(couple.masters[row.master].patch) + j, c)).collect();
            match terms[..] {
                [(b, 1.0)] => equal.push((a, b)),
                _ => self.combined.push((a, terms)),
            }
        }
        for (a, b) in equal {
            self.same(a, b);
        }
        for (master, _) in couple.masters.iter().zip(&touched).filter(|(_, t)| **t) {
            self.join(slave.patch, master.patch);
        }
        Ok(())
    }

    /// Identifies two functions, numbered unknown / components; call before [`Glued::finish`].
    pub(super) fn same(&mut self, a: usize, b: usize) {
        unite(&mut self.root, a, b);
    }

    /// Merges two patches into one rigid body: they share functions in more than a point.
    pub(super) fn join(&mut self, a: usize, b: usize) {
        unite(&mut self.body, a, b);
    }

    /// Flattens the trees; the roots are final after it.
    pub(super) fn finish(&mut self) {
        for list in [&mut self.root, &mut self.body] {
            for i in 0..list.len() {
                // a root is the least number of its tree
                list[i] = list[list[i]];
            }
        }
        if self.combined.is_empty() && self.root.iter().enumerate().all(|(i, &r)| i == r) {
            self.root.clear();
        }
    }

    /// Whether nothing is glued.
    pub fn is_empty(&self) -> bool {
        self.root.is_empty()
    }

    /// Representative of `function` after merging glued functions; numbers are unknown / components.
    pub fn root(&self, function: usize) -> usize {
        self.root.get(function).copied().unwrap_or(function)
    }

    /// Representative of `unknown` after merging glued unknowns.
    pub fn unknown(&self, unknown: usize) -> usize {
        if self.is_empty() { unknown } else { self.components * self.root(unknown / self.components) + unknown % self.components }
    }

    /// The first patch of the body that `patch` is part of.
    pub fn body(&self, patch: usize) -> usize {
        self.body.get(patch).copied().unwrap_or(patch)
    }

    /// Number of dependent unknowns: those with another representative, and combinations of others.
    pub fn num_bound(&self) -> usize {
        let equal = self.root.iter().enumerate().filter(|(i, r)| i != *r).count();
        let mut bound: Vec<usize> = self.combined.iter().map(|(a, _)| self.root(*a)).collect();
        bound.sort_unstable();
        bound.dedup();
        self.components * (equal + bound.len())
    }

    /// Functions that are combinations of others, with their terms.
    pub fn combined(&self) -> &[(usize, Vec<(usize, f64)>)] {
        &self.combined
    }

    /// Equations of the dependent unknowns.
    pub fn equations(&self) -> Vec<Equation> {
        let equal = self.root.iter().enumerate().filter(|(i, r)| i != *r).map(|(i, &r)| vec![(i, 1.0), (r, -1.0)]);
        let combined = self
            .combined
            .iter()
            .map(|(a, terms)| std::iter::once((*a, 1.0)).chain(terms.iter().map(|&(b, c)| (b, -c))).collect::<Vec<_>>());
        let functions: Vec<Vec<(usize, f64)>> = equal.chain(combined).collect();
        let of = |terms: &Vec<(usize, f64)>, c: usize| Equation {
            terms: terms.iter().map(|&(i, value)| (self.components * i + c, value)).collect(),
            value: 0.0,
        };
        functions.iter().flat_map(|terms| (0..self.components).map(move |c| of(terms, c))).collect()
    }

    /// Moves forces on dependent functions to their representatives, so that forces across seams cancel.
    pub fn gather(&self, forces: &mut [f64]) {
        if self.is_empty() {
            return;
        }
        let n = self.components;
        let mut pass = |from: usize, to: usize, factor: f64| {
            for c in 0..n {
                forces[n * to + c] += factor * forces[n * from + c];
            }
        };
        for (i, &r) in self.root.iter().enumerate().filter(|(i, r)| i != *r) {
            pass(i, r, 1.0);
        }
        for (a, terms) in &self.combined {
            for &(b, factor) in terms {
                pass(self.root(*a), self.root(b), factor);
            }
        }
        let gone = self.root.iter().enumerate().filter(|(i, r)| i != *r).map(|(i, _)| i);
        for i in gone.chain(self.combined.iter().map(|(a, _)| self.root(*a))) {
            forces[n * i..n * (i + 1)].fill(0.0);
        }
    }
}

/// Unites the trees of `a` and `b`; the least number stays the root.
fn unite(root: &mut [usize], a: usize, b: usize) {
    let find = |root: &mut [usize], mut i: usize| {
        while root[i] != i {
            root[i] = root[root[i]];
            i = root[i];
        }
        i
    };
    let (a, b) = (find(root, a), find(root, b));
    root[a.max(b)] = a.min(b);
}

fn fault<const S: usize, const N: usize>(builder: &Builder<'_, S, N>, couple: &Couple<S, N>, error: &GlueError) -> Diagnostic {
    let (slave, masters) = (&couple.slave.label, labels(&couple.masters));
    let spot = |at: &[f64; 3]| {
        let list: Vec<String> = ["x", "y", "z"][..N].iter().zip(at).map(|(l, v)| format!("{l} = {}", short(*v))).collect();
        list.join(", ")
    };
    let mortar = "use coupling = \"mortar\", which ties any two sides";
    match error {
        GlueError::Apart { distance, at, allowed } => {
            let text =
                format!("`{slave}` and {masters} are up to {} apart (at {}); allowed {}", short(*distance), spot(at), short(*allowed));
            builder
                .error("E023", text, couple.at)
                .with_help("move the bodies together or raise `tolerance`; use [[contact]] if a gap is meant")
        }
        GlueError::Grids { element, at } => {
            let text = format!(
                "`{slave}` and {masters} cannot be glued: their grids do not match at element {element} of `{slave}` (around {})",
                spot(at)
            );
            builder.error("E015", text, couple.at).with_help(format!("give both the same breakpoints along the seam, or {mortar}"))
        }
        GlueError::Functions { element, at, difference } => {
            let text = format!(
                "`{slave}` and {masters} cannot be glued: their functions differ on element {element} of `{slave}` (around {}): {difference}",
                spot(at)
            );
            builder.error("E015", text, couple.at).with_help(format!("give both the same degree, continuity and weights, or {mortar}"))
        }
        _ => builder.error("E015", format!("`{slave}` and {masters} cannot be glued: {error}"), couple.at).with_help(mortar),
    }
}
