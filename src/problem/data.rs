//! Data of a problem: numbers or functions of position, time and gap.

use crate::linalg::{Matrix, Vector};
use std::fmt::Debug;
use std::sync::Arc;

/// Arguments of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// x, y, z; z = 0 in the plane.
    pub x: [f64; 3],
    /// Time.
    pub t: f64,
    /// Gap along the normal, in gap functions.
    pub g: f64,
}

impl Default for Point {
    fn default() -> Self {
        Self { x: [0.0; 3], t: 1.0, g: 0.0 }
    }
}

impl Point {
    /// A point of the plane or of space at t = 1; missing coordinates are 0.
    pub fn new(x: &[f64]) -> Self {
        let mut p = Self::default();
        for (to, from) in p.x.iter_mut().zip(x) {
            *to = *from;
        }
        p
    }

    /// Moves the point to another time.
    #[must_use]
    pub fn at_time(self, t: f64) -> Self {
        Self { t, ..self }
    }

    /// Gives the point a gap.
    #[must_use]
    pub fn with_gap(self, g: f64) -> Self {
        Self { g, ..self }
    }
}

/// A real function of position, time and gap.
pub trait Function: Debug + Send + Sync {
    /// Its value.
    fn value(&self, at: &Point) -> f64;
    /// Whether it changes with the time.
    fn depends_on_time(&self) -> bool {
        true
    }
    /// Its value where it is the same everywhere and at any time.
    fn as_constant(&self) -> Option<f64> {
        None
    }
}

/// A number or a [`Function`].
#[derive(Clone, Debug)]
pub struct Data(Arc<dyn Function>);

impl Data {
    /// A function.
    pub fn new(function: impl Function + 'static) -> Self {
        Self(Arc::new(function))
    }

    /// A function of position and time.
    pub fn of(function: impl Fn(&[f64; 3], f64) -> f64 + Send + Sync + 'static) -> Self {
        Self::new(Closure(function))
    }

    /// A function of position, time and gap: a press fit of depth d is `Data::of_gap(|_, _, g| g - d)`.
    pub fn of_gap(function: impl Fn(&[f64; 3], f64, f64) -> f64 + Send + Sync + 'static) -> Self {
        Self::new(GapClosure(function))
    }

    /// The gap itself, of gap functions.
    pub fn gap() -> Self {
        Self::new(Gap)
    }

    /// The value at a point.
    pub fn value(&self, at: &Point) -> f64 {
        self.0.value(at)
    }

    /// Whether it changes with the time.
    pub fn depends_on_time(&self) -> bool {
        self.0.depends_on_time()
    }

    /// Its value where it is the same everywhere and at any time.
    pub fn as_constant(&self) -> Option<f64> {
        self.0.as_constant()
    }
}

impl From<f64> for Data {
    fn from(value: f64) -> Self {
        Self::new(value)
    }
}

impl Function for f64 {
    fn value(&self, _: &Point) -> f64 {
        *self
    }
    fn depends_on_time(&self) -> bool {
        false
    }
    fn as_constant(&self) -> Option<f64> {
        Some(*self)
    }
}

/// g.
#[derive(Debug)]
struct Gap;

impl Function for Gap {
    fn value(&self, at: &Point) -> f64 {
        at.g
    }
    fn depends_on_time(&self) -> bool {
        false
    }
}

struct GapClosure<F>(F);

impl<F> Debug for GapClosure<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("function of x, t and g")
    }
}

impl<F: Fn(&[f64; 3], f64, f64) -> f64 + Send + Sync> Function for GapClosure<F> {
    fn value(&self, at: &Point) -> f64 {
        (self.0)(&at.x, at.t, at.g)
    }
}

struct Closure<F>(F);

impl<F> Debug for Closure<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("function of x and t")
    }
}

impl<F: Fn(&[f64; 3], f64) -> f64 + Send + Sync> Function for Closure<F> {
    fn value(&self, at: &Point) -> f64 {
        (self.0)(&at.x, at.t)
    }
}

/// Value, gradient and Hessian of a component at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derivatives {
    /// u.
    pub value: f64,
    /// `gradient[j]` = du/dx_j.
    pub gradient: [f64; 3],
    /// `hessian[j][k]` = d2u/dx_j dx_k.
    pub hessian: [[f64; 3]; 3],
}

/// An exact solution with its derivatives, one component after the other.
pub trait Exact: Debug + Send + Sync {
    /// Value of a component.
    fn value(&self, component: usize, at: &Point) -> f64;
    /// Value and gradient of a component.
    fn slope(&self, component: usize, at: &Point) -> Derivatives;
    /// Value, gradient and Hessian of a component.
    fn derivatives(&self, component: usize, at: &Point) -> Derivatives;
    /// Whether it changes with the time.
    fn depends_on_time(&self) -> bool {
        true
    }
    /// Value and gradient of a component at `at`, of the piece that holds at `inside`, a point near it. Solutions of pieces override it, or
    /// have the gradient at `inside`.
    fn continued(&self, component: usize, at: &Point, inside: &Point) -> Derivatives {
        self.slope(component, if self.is_piecewise() { inside } else { at })
    }
    /// Whether it is made of pieces, whose derivatives may jump.
    fn is_piecewise(&self) -> bool {
        false
    }
}

/// Values and gradients of all C components of an exact solution: u, `gradient[(i, j)]` = du_i/dx_j.
pub fn field_slope<const C: usize, const N: usize>(exact: &dyn Exact, at: &Point) -> (Vector<C>, Matrix<C, N>) {
    let all: [Derivatives; C] = std::array::from_fn(|c| exact.slope(c, at));
    (Vector::from_fn(|i, _| all[i].value), Matrix::from_fn(|i, j| all[i].gradient[j]))
}

/// Values and gradients at `at` of all C components of an exact solution, of the piece that holds at `inside`.
pub(super) fn continued_slope<const C: usize, const N: usize>(exact: &dyn Exact, at: &Point, inside: &Point) -> (Vector<C>, Matrix<C, N>) {
    let all: [Derivatives; C] = std::array::from_fn(|c| exact.continued(c, at, inside));
    (Vector::from_fn(|i, _| all[i].value), Matrix::from_fn(|i, j| all[i].gradient[j]))
}

/// Gradients and Hessians of all C components of an exact solution: `gradient[(i, j)]` = du_i/dx_j, `hessian[i][(j, k)]` =
/// d2u_i/dx_j dx_k.
pub(super) fn field_derivatives<const C: usize, const N: usize>(exact: &dyn Exact, at: &Point) -> (Matrix<C, N>, [Matrix<N, N>; C]) {
    let all: [Derivatives; C] = std::array::from_fn(|c| exact.derivatives(c, at));
    (Matrix::from_fn(|i, j| all[i].gradient[j]), std::array::from_fn(|i| Matrix::from_fn(|j, k| all[i].hessian[j][k])))
}
