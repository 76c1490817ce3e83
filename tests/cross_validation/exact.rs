//! Exact solutions and varying constants as expressions whose derivatives follow from the rules of calculus.

use faying::linalg::Vector;
use faying::physics::{Assumption, Conductor, Elastic, Hooke, Jet};
use faying::problem::{Derivatives, Exact, Point};
use std::fmt::Debug;
use std::ops::{Add, Mul, Neg, Sub};

/// A value with its gradient and its second derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Expr {
    value: f64,
    gradient: [f64; 3],
    hessian: [[f64; 3]; 3],
}

impl Expr {
    /// A number.
    pub fn number(value: f64) -> Self {
        Self { value, gradient: [0.0; 3], hessian: [[0.0; 3]; 3] }
    }

    /// The coordinates x, y, z of a point.
    pub fn coordinates(x: &[f64]) -> [Self; 3] {
        std::array::from_fn(|k| {
            let mut one = Self::number(x.get(k).copied().unwrap_or(0.0));
            one.gradient[k] = 1.0;
            one
        })
    }

    /// A function of it, by the function's value and first two derivatives.
    fn mapped(self, [f, d, dd]: [f64; 3]) -> Self {
        let g = self.gradient;
        Self {
            value: f,
            gradient: g.map(|a| d * a),
            hessian: std::array::from_fn(|i| std::array::from_fn(|j| dd * g[i] * g[j] + d * self.hessian[i][j])),
        }
    }

    pub fn sin(self) -> Self {
        let (s, c) = self.value.sin_cos();
        self.mapped([s, c, -s])
    }

    pub fn cos(self) -> Self {
        let (s, c) = self.value.sin_cos();
        self.mapped([c, -s, -c])
    }

    /// One over it.
    pub fn inverse(self) -> Self {
        let v = self.value.recip();
        self.mapped([v, -v * v, 2.0 * v * v * v])
    }

    pub fn exp(self) -> Self {
        self.mapped([self.value.exp(); 3])
    }

    /// The value with its gradient, of a constant of a material.
    fn jet<const N: usize>(self) -> Jet<N> {
        Jet::new(self.value, Vector::from_fn(|k, _| self.gradient[k]))
    }
}

impl From<Expr> for Derivatives {
    fn from(e: Expr) -> Self {
        Self { value: e.value, gradient: e.gradient, hessian: e.hessian }
    }
}

impl Add for Expr {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self {
            value: self.value + b.value,
            gradient: std::array::from_fn(|i| self.gradient[i] + b.gradient[i]),
            hessian: std::array::from_fn(|i| std::array::from_fn(|j| self.hessian[i][j] + b.hessian[i][j])),
        }
    }
}

impl Mul for Expr {
    type Output = Self;
    // the product rule
    #[allow(clippy::suspicious_arithmetic_impl)]
    fn mul(self, b: Self) -> Self {
        let (u, v) = (self.gradient, b.gradient);
        let second = |i: usize, j: usize| self.hessian[i][j] * b.value + u[i] * v[j] + u[j] * v[i] + self.value * b.hessian[i][j];
        Self {
            value: self.value * b.value,
            gradient: std::array::from_fn(|i| u[i] * b.value + self.value * v[i]),
            hessian: std::array::from_fn(|i| std::array::from_fn(|j| second(i, j))),
        }
    }
}

impl Neg for Expr {
    type Output = Self;
    fn neg(self) -> Self {
        -1.0 * self
    }
}

impl Sub for Expr {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul<Expr> for f64 {
    type Output = Expr;
    fn mul(self, b: Expr) -> Expr {
        Expr::number(self) * b
    }
}

impl Add<Expr> for f64 {
    type Output = Expr;
    fn add(self, b: Expr) -> Expr {
        Expr::number(self) + b
    }
}

/// An exact solution: all components as a function of x, y, z.
#[derive(Clone)]
pub struct Solved<F>(pub F);

impl<F> Debug for Solved<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("exact solution")
    }
}

impl<const C: usize, F: Fn([Expr; 3]) -> [Expr; C] + Send + Sync> Exact for Solved<F> {
    fn value(&self, component: usize, at: &Point) -> f64 {
        self.derivatives(component, at).value
    }
    fn slope(&self, component: usize, at: &Point) -> Derivatives {
        self.derivatives(component, at)
    }
    fn derivatives(&self, component: usize, at: &Point) -> Derivatives {
        (self.0)(Expr::coordinates(&at.x))[component].into()
    }
    fn depends_on_time(&self) -> bool {
        false
    }
}

/// A conductivity that varies.
pub fn conductor<const N: usize>(k: impl Fn([Expr; 3]) -> Expr + Send + Sync + 'static) -> Conductor<N> {
    Conductor::varying(move |x: &Vector<N>| k(Expr::coordinates(x.as_slice())).jet())
}

/// A Young's modulus that varies.
pub fn elastic<const N: usize>(
    young: impl Fn([Expr; 3]) -> Expr + Send + Sync + 'static,
    poisson: f64,
    assumption: Assumption,
) -> Hooke<N> {
    let constants =
        move |x: &Vector<N>| Elastic::Young { young: young(Expr::coordinates(x.as_slice())).jet(), poisson: Jet::constant(poisson) };
    Hooke::varying(constants, assumption)
}
