//! A material constant at a point with its derivative in space.

use crate::linalg::{Real, Vector};
use std::ops::{Add, Div, Mul, Sub};

/// Value and gradient of a material constant that varies in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<const N: usize, T: Real = f64> {
    /// The value.
    pub value: T,
    /// Its gradient, value per length.
    pub gradient: Vector<N, T>,
}

impl<const N: usize, T: Real> Jet<N, T> {
    /// A value and its gradient.
    pub fn new(value: T, gradient: Vector<N, T>) -> Self {
        Self { value, gradient }
    }

    /// Constant `value`, gradient zero.
    pub fn constant(value: T) -> Self {
        Self { value, gradient: Vector::zeros() }
    }
}

impl<const N: usize, T: Real> Add for Jet<N, T> {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self::new(self.value + b.value, self.gradient + b.gradient)
    }
}

impl<const N: usize, T: Real> Sub for Jet<N, T> {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self::new(self.value - b.value, self.gradient - b.gradient)
    }
}

impl<const N: usize, T: Real> Mul for Jet<N, T> {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self::new(self.value * b.value, self.gradient * b.value + b.gradient * self.value)
    }
}

impl<const N: usize, T: Real> Div for Jet<N, T> {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let value = self.value / b.value;
        Self::new(value, (self.gradient - b.gradient * value) / b.value)
    }
}
