//! A few rules shared by many elements.

use super::{Quadrature, Rule};
use crate::linalg::Real;
use std::sync::Arc;

/// Element `e` uses `rules[which[e]]`.
#[derive(Clone, Debug)]
pub struct PerElement<const D: usize, T: Real = f64> {
    rules: Vec<Arc<dyn Quadrature<D, T>>>,
    which: Vec<usize>,
}

impl<const D: usize, T: Real> PerElement<D, T> {
    /// Rules, and which of them each element uses.
    ///
    /// # Panics
    /// If `which` names a rule that is not there.
    pub fn new(rules: Vec<Arc<dyn Quadrature<D, T>>>, which: Vec<usize>) -> Self {
        assert!(which.iter().all(|&w| w < rules.len()), "every element names one of the rules");
        Self { rules, which }
    }

    /// The different rules.
    pub fn rules(&self) -> &[Arc<dyn Quadrature<D, T>>] {
        &self.rules
    }

    /// Number of the rule of each element.
    pub fn which(&self) -> &[usize] {
        &self.which
    }
}

impl<const D: usize, T: Real> Quadrature<D, T> for PerElement<D, T> {
    fn rule(&self, element: usize) -> &Rule<D, T> {
        self.rules[self.which[element]].rule(element)
    }
    fn axes(&self, element: usize) -> Option<[&dyn Quadrature<1, T>; D]> {
        self.rules[self.which[element]].axes(element)
    }
}
