//! Functions that glued sides share: every patch keeps its unknowns, equal ones have one root.
//!
//! A glued function is bound by u_i - u_root = 0, one equation per component and function: a union-find over all seams,
//! so that a cross point of any number of patches is no special case.

use crate::assembly::Equation;
use crate::linalg::Vector;

/// Two patches that move together in a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharedPoint<const N: usize> {
    /// The patches.
    pub patches: [usize; 2],
    /// A function of each that is not zero there.
    pub functions: [usize; 2],
    /// The point \[length\].
    pub x: Vector<N>,
}

/// Functions of the model that are one function, in numbers unknown / components.
#[derive(Clone, Debug, Default)]
pub struct Glued {
    pub(super) components: usize,
    /// The least function that is the same; empty where nothing is glued.
    root: Vec<usize>,
    /// Functions that are combinations of others: a = sum of terms.
    pub(super) combined: Vec<(usize, Vec<(usize, f64)>)>,
    /// First patch of the body that a patch is part of.
    body: Vec<usize>,
}

impl Glued {
    /// Nothing glued yet: `functions` of `patches` bodies in total.
    pub fn new(components: usize, functions: usize, patches: usize) -> Self {
        Self { components, root: (0..functions).collect(), combined: Vec::new(), body: (0..patches).collect() }
    }

    /// Makes two functions one. Numbers are unknown / components; call before [`Glued::finish`].
    pub fn same(&mut self, a: usize, b: usize) {
        unite(&mut self.root, a, b);
    }

    /// Makes two patches one rigid body: they share functions in more than a point.
    pub(super) fn join(&mut self, a: usize, b: usize) {
        unite(&mut self.body, a, b);
    }

    /// Flattens the trees; the roots are final after it.
    pub fn finish(&mut self) {
        for list in [&mut self.root, &mut self.body] {
            for i in 0..list.len() {
                // a root is never above its members
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

    /// The function that stands for `function`; numbers are unknown / components.
    pub(super) fn root(&self, function: usize) -> usize {
        self.root.get(function).copied().unwrap_or(function)
    }

    /// The unknown that stands for `unknown`.
    pub fn unknown(&self, unknown: usize) -> usize {
        if self.is_empty() { unknown } else { self.components * self.root(unknown / self.components) + unknown % self.components }
    }

    /// The first patch of the body that `patch` is part of.
    pub fn body(&self, patch: usize) -> usize {
        self.body.get(patch).copied().unwrap_or(patch)
    }

    /// Number of unknowns that follow from others.
    pub(super) fn num_bound(&self) -> usize {
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

    /// The conditions between unknowns.
    pub(super) fn equations(&self) -> Vec<Equation> {
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

    /// Moves what acts on a glued function to the one that stands for it, so that forces across seams cancel.
    pub(super) fn gather(&self, forces: &mut [f64]) {
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
