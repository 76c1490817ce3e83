//! Jets: a value with its first and second derivatives in x, y, z.

/// Value, gradient and Hessian in x, y, z at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Value.
    pub value: f64,
    /// First derivatives.
    pub gradient: [f64; 3],
    /// Second derivatives, symmetric.
    pub hessian: [[f64; 3]; 3],
}
