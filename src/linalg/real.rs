//! Scalars and the fixed-size vectors and matrices of the crate.

/// A real scalar: `f64`, `f32`, or a dual number. A bound, not an interface; every type that fits has it.
pub trait Real: nalgebra::RealField + num_traits::FromPrimitive + Copy {}
impl<T: nalgebra::RealField + num_traits::FromPrimitive + Copy> Real for T {}

/// A column of `N` numbers.
pub type Vector<const N: usize, T = f64> = nalgebra::SVector<T, N>;
/// `R` rows and `C` columns.
pub type Matrix<const R: usize, const C: usize, T = f64> = nalgebra::SMatrix<T, R, C>;

/// The literal `x` in the scalar `T`.
#[inline]
pub fn lit<T: Real>(x: f64) -> T {
    nalgebra::convert(x)
}

/// A whole number in the scalar `T`.
#[inline]
pub fn num<T: Real>(n: usize) -> T {
    nalgebra::convert(n as f64)
}

/// The value of `x` as `f64`, for orderings, reports and tolerances.
#[inline]
pub fn to_f64<T: Real>(x: T) -> f64 {
    x.to_subset_unchecked()
}
