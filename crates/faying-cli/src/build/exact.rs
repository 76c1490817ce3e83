//! The exact solution of a case, by derivatives of its formulas.

use super::builder::Builder;
use crate::errors::Diagnostic;
use crate::formula::{Formula, Jet, Point};
use crate::place::Located;
use crate::place::Place;
use faying::problem::Model;
use faying::problem::{Derivatives, Exact};
use std::sync::Arc;

/// One formula per component.
#[derive(Clone, Debug)]
struct Formulas(Vec<Formula>);

/// The exact solution of a case.
pub(super) fn of(formulas: &[Located<Formula>]) -> Arc<dyn Exact> {
    Arc::new(Formulas(formulas.iter().map(|f| f.value.clone()).collect()))
}

fn derivatives(jet: &Jet) -> Derivatives {
    Derivatives { value: jet.value, gradient: jet.gradient, hessian: jet.hessian }
}

impl Exact for Formulas {
    fn value(&self, component: usize, at: &Point) -> f64 {
        self.0[component].value(at)
    }
    fn slope(&self, component: usize, at: &Point) -> Derivatives {
        derivatives(&self.0[component].slope(at))
    }
    fn derivatives(&self, component: usize, at: &Point) -> Derivatives {
        derivatives(&self.0[component].jet(at))
    }
    fn continued(&self, component: usize, at: &Point, inside: &Point) -> Derivatives {
        derivatives(&self.0[component].continued(at, inside))
    }
    fn depends_on_time(&self) -> bool {
        self.0.iter().any(Formula::depends_on_time)
    }
    fn is_piecewise(&self) -> bool {
        self.0.iter().any(Formula::is_piecewise)
    }
}

/// Refuses "exact" (E062) in a case without an exact solution.
pub(super) fn needs_exact<const S: usize, const N: usize>(
    builder: &Builder<'_, S, N>,
    model: &Model<S, N>,
    at: Place,
) -> Result<(), Box<Diagnostic>> {
    match model.exact {
        Some(_) => Ok(()),
        None => Err(Box::new(
            builder.error("E062", "\"exact\" needs a manufactured solution; the case has none", at).with_help("give exact in [model]"),
        )),
    }
}
