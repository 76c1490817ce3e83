//! Transformations of control nets: scaling, rotation, translation, reversal, extrusion.

use super::ControlNet;
use crate::basis::{BSpline, Basis, Elements};
use crate::linalg::{Matrix, Real, Vector, lit};

impl<const D: usize, const N: usize, T: Real> ControlNet<D, N, T> {
    /// x -> factor x.
    #[must_use]
    pub fn scale(self, factor: T) -> Self {
        self.scale_axes(&Vector::repeat(factor))
    }

    /// x_k -> factors_k x_k.
    #[must_use]
    pub fn scale_axes(mut self, factors: &Vector<N, T>) -> Self {
        self.points.iter_mut().for_each(|x| *x = x.component_mul(factors));
        self
    }

    /// x -> Q x, for instance with Q of [`turn`] or [`turn_about`].
    #[must_use]
    pub fn rotate(mut self, rotation: &Matrix<N, N, T>) -> Self {
        self.points.iter_mut().for_each(|x| *x = rotation * *x);
        self
    }

    /// x -> x + by.
    #[must_use]
    pub fn translate(mut self, by: &Vector<N, T>) -> Self {
        self.points.iter_mut().for_each(|x| *x += by);
        self
    }

    /// Reverses the parameter of direction `axis`, keeping the set of points: a right-handed net becomes left-handed.
    ///
    /// # Panics
    /// If there is no such direction.
    pub fn reverse(&self, axis: usize) -> Self {
        let old = &self.axes[axis];
        let (a, b) = (old.breakpoints()[0], old.breakpoints()[old.num_elements()]);
        // ends stay exact: a + b - a is b only in exact arithmetic
        let mirror = |t: T| {
            if t == a {
                b
            } else if t == b {
                a
            } else {
                a + (b - t)
            }
        };
        let knots = old.knots().iter().rev().map(|&t| mirror(t)).collect();
        let mut axes = self.axes.clone();
        axes[axis] = BSpline::try_new(old.polynomial_degree(), knots).expect("a mirrored knot vector is one");
        let stride: usize = self.axes[..axis].iter().map(BSpline::num_functions).product();
        let n = old.num_functions();
        let from = |i: usize| {
            let along = i / stride % n;
            i + stride * (n - 1 - along) - stride * along
        };
        let points = (0..self.points.len()).map(|i| self.points[from(i)]).collect();
        let weights = self.weights.as_ref().map(|w| (0..w.len()).map(|i| w[from(i)]).collect());
        Self { axes, points, weights }
    }
}

impl<T: Real> ControlNet<2, 2, T> {
    /// The body swept from z = 0 to z = `height` \[length\]; w is z, of degree 1 with one element on [0, 1].
    pub fn extrude(&self, height: T) -> ControlNet<3, 3, T> {
        let at = |z: T| self.points.iter().map(move |x| Vector::<3, T>::new(x[0], x[1], z));
        let points = at(T::zero()).chain(at(height)).collect();
        let weights = self.weights.as_ref().map(|w| w.iter().chain(w).copied().collect());
        let [u, v] = self.axes.clone();
        ControlNet { axes: [u, v, BSpline::uniform(1, 1, 0)], points, weights }
    }
}

/// Cosine and sine of an angle in degrees, exact for multiples of 90.
fn cos_sin<T: Real>(degrees: T) -> (T, T) {
    let full = lit::<T>(360.0);
    let within = degrees - full * (degrees / full).floor();
    for (quarter, c, s) in [(0.0, 1.0, 0.0), (90.0, 0.0, 1.0), (180.0, -1.0, 0.0), (270.0, 0.0, -1.0)] {
        if within == lit(quarter) {
            return (lit(c), lit(s));
        }
    }
    let angle = within * T::pi() / lit(180.0);
    (angle.cos(), angle.sin())
}

/// The rotation of the plane by `degrees`, counterclockwise.
pub fn turn<T: Real>(degrees: T) -> Matrix<2, 2, T> {
    let (c, s) = cos_sin(degrees);
    Matrix::<2, 2, T>::new(c, -s, s, c)
}

/// The rotation of space by `degrees` about `axis` (right-hand rule); `None` if the axis has no direction.
///
///   `Q = c I + s [a]x + (1 - c) a aᵀ`
pub fn turn_about<T: Real>(axis: &Vector<3, T>, degrees: T) -> Option<Matrix<3, 3, T>> {
    let norm = axis.norm();
    if !(norm > T::zero() && norm.is_finite()) {
        return None;
    }
    let a = axis / norm;
    let (c, s) = cos_sin(degrees);
    Some(Matrix::identity() * c + a.cross_matrix() * s + a * a.transpose() * (T::one() - c))
}
