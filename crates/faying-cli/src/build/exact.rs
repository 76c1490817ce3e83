//! Manufactured solutions: an `exact` field with its derivatives, by jets of its formulas.

use crate::formula::{Formula, Jet, Point};
use crate::place::Located;
use faying::linalg::{Matrix, Vector};

/// An exact solution, one formula per component.
#[derive(Clone, Debug)]
pub struct Exact {
    components: Vec<Formula>,
}

/// Value and derivatives of a field of C components at a point.
#[derive(Clone, Copy, Debug)]
pub struct FieldJet<const C: usize, const N: usize> {
    /// u, one entry per component.
    pub value: Vector<C>,
    /// `gradient[(i, j)]` = du_i/dx_j.
    pub gradient: Matrix<C, N>,
    /// `hessian[i][(j, k)]` = d2u_i/dx_j dx_k.
    pub hessian: [Matrix<N, N>; C],
}

impl Exact {
    /// Creates the solution from the formulas of the case.
    pub fn of(formulas: &[Located<Formula>]) -> Self {
        Self { components: formulas.iter().map(|f| f.value.clone()).collect() }
    }

    /// Whether a component is defined piecewise, so that its derivatives may jump.
    pub fn is_piecewise(&self) -> bool {
        self.components.iter().any(Formula::is_piecewise)
    }

    /// Value of the component, u_c.
    pub fn value(&self, component: usize, at: &Point) -> f64 {
        self.components[component].value(at)
    }

    /// The field and its first derivatives.
    pub fn slope<const C: usize, const N: usize>(&self, at: &Point) -> (Vector<C>, Matrix<C, N>) {
        let jets: [Jet; C] = std::array::from_fn(|c| self.components[c].slope(at));
        (Vector::from_fn(|i, _| jets[i].value), Matrix::from_fn(|i, j| jets[i].gradient[j]))
    }

    /// The field and its derivatives.
    pub fn jet<const C: usize, const N: usize>(&self, at: &Point) -> FieldJet<C, N> {
        let jets: [Jet; C] = std::array::from_fn(|c| self.components[c].jet(at));
        FieldJet {
            value: Vector::from_fn(|i, _| jets[i].value),
            gradient: Matrix::from_fn(|i, j| jets[i].gradient[j]),
            hessian: std::array::from_fn(|i| Matrix::from_fn(|j, k| jets[i].hessian[j][k])),
        }
    }
}
