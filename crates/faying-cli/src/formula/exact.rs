//! The exact solution of a case, by derivatives of its formulas.

use super::{Formula, Jet, Point};
use crate::place::Located;
use faying::problem::{Derivatives, Exact};

/// One formula per component.
#[derive(Clone, Debug)]
struct Formulas(Vec<Formula>);

/// The exact solution of a case.
pub(crate) fn exact(formulas: &[Located<Formula>]) -> impl Exact + use<> {
    Formulas(formulas.iter().map(|f| f.value.clone()).collect())
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
