//! Terms of lower order of a form: those in which a function stands without its derivative.

use crate::linalg::{Matrix, Real, Vector};

/// Terms that a form adds to grad v : tangent : grad u at a point: grad v : B u + B v : grad u + v . C u.
///
/// The part with B is symmetric in u and v; that with C is where C is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowerOrder<const C: usize, const N: usize, T: Real = f64> {
    /// B: `mixed[e]` is the stress (C x N) that component e of u adds per unit; `None`: zero. Unit: that of the tangent per length.
    pub mixed: Option<[Matrix<C, N, T>; C]>,
    /// C: `value[(c, e)]` is the force along c per unit of component e of u. Unit: that of the tangent per length squared.
    pub value: Matrix<C, C, T>,
}

/// The terms at a physical point.
pub(super) type LowerFn<'a, const C: usize, const N: usize, T> = dyn Fn(&Vector<N, T>) -> LowerOrder<C, N, T> + Send + Sync + 'a;

impl<const C: usize, const N: usize, T: Real> LowerOrder<C, N, T> {
    /// The terms v . `value` u.
    pub fn of_values(value: Matrix<C, C, T>) -> Self {
        Self { mixed: None, value }
    }

    /// The sum of both.
    pub(super) fn plus(self, other: Self) -> Self {
        let mixed = match (self.mixed, other.mixed) {
            (Some(a), Some(b)) => Some(std::array::from_fn(|e| a[e] + b[e])),
            (a, b) => a.or(b),
        };
        Self { mixed, value: self.value + other.value }
    }

    /// B u, a stress, and Bᵀ : grad u + C u, a force, of a field at the point.
    pub(super) fn respond(&self, value: &Vector<C, T>, gradient: &Matrix<C, N, T>) -> (Matrix<C, N, T>, Vector<C, T>) {
        let (mut stress, mut force) = (Matrix::zeros(), self.value * value);
        for (e, b) in self.mixed.iter().flatten().enumerate() {
            stress += b * value[e];
            force[e] += b.dot(gradient);
        }
        (stress, force)
    }

    /// The terms with u = v.
    pub(super) fn square(&self, value: &Vector<C, T>, gradient: &Matrix<C, N, T>) -> T {
        let (stress, force) = self.respond(value, gradient);
        stress.dot(gradient) + force.dot(value)
    }
}
