//! Gauss rules on the unit interval by Newton's method on Jacobi polynomials, for any number of points and any scalar.

use super::Rule;
use crate::linalg::{Real, Vector, lit, num};

/// Value and derivative of the Jacobi polynomial P_n^(a, b) at `x` in [-1, 1], by its three-term recurrence.
fn jacobi<T: Real>(n: usize, a: usize, b: usize, x: T) -> (T, T) {
    let (mut p0, mut d0) = (T::one(), T::zero());
    if n == 0 {
        return (p0, d0);
    }
    let s = a + b;
    let half = lit::<T>(0.5);
    let mut p1 = num::<T>(a + 1) + num::<T>(s + 2) * (x - T::one()) * half;
    let mut d1 = num::<T>(s + 2) * half;
    for k in 2..=n {
        let c0 = num::<T>(2 * k * (k + s) * (2 * k + s - 2));
        let c1 = num::<T>(2 * k + s - 1);
        let cx = num::<T>((2 * k + s) * (2 * k + s - 2));
        let cc = num::<T>(a * a) - num::<T>(b * b);
        let c2 = num::<T>(2 * (k + a - 1) * (k + b - 1) * (2 * k + s));
        let p2 = (c1 * (cx * x + cc) * p1 - c2 * p0) / c0;
        let d2 = (c1 * ((cx * x + cc) * d1 + cx * p1) - c2 * d0) / c0;
        (p0, p1, d0, d1) = (p1, p2, d1, d2);
    }
    (p1, d1)
}

/// Roots of P_n^(a, b) in ascending order: Newton with the roots already found divided out.
fn jacobi_roots<T: Real>(n: usize, a: usize, b: usize) -> Vec<T> {
    let mut roots: Vec<T> = Vec::with_capacity(n);
    let half = lit::<T>(0.5);
    for i in 0..n {
        // Chebyshev's root, moved towards the last root found
        let mut x = -(T::pi() * num::<T>(2 * i + 1) / num::<T>(2 * n)).cos();
        if let Some(&last) = roots.last() {
            x = (x + last) * half;
        }
        for _ in 0..100 {
            let (p, d) = jacobi(n, a, b, x);
            let deflation = roots.iter().fold(T::zero(), |s, &r| s + T::one() / (x - r));
            let step = p / (d - deflation * p);
            x -= step;
            if step.abs() <= T::default_epsilon() {
                break;
            }
        }
        // one plain step: near the root it needs no deflation
        let (p, d) = jacobi(n, a, b, x);
        x -= p / d;
        roots.push(x);
    }
    if a == b {
        // exact symmetry
        for i in 0..n / 2 {
            let r = (roots[n - 1 - i] - roots[i]) * half;
            (roots[i], roots[n - 1 - i]) = (-r, r);
        }
        if n % 2 == 1 {
            roots[n / 2] = T::zero();
        }
    }
    roots
}

/// Gauss-Jacobi rule for ∫_0^1 (1 - u)^a f(u) du, exact for f of degree 2n - 1.
///
///   w_i = 1 / ((1 - x_i^2) P_n'(x_i)^2),  u_i = (1 + x_i) / 2,  P_n = P_n^(a, 0)
pub(super) fn gauss_jacobi<T: Real>(n: usize, a: usize) -> Rule<1, T> {
    let half = lit::<T>(0.5);
    let roots = jacobi_roots::<T>(n, a, 0);
    let weights: Vec<T> = roots
        .iter()
        .map(|&x| {
            let (_, d) = jacobi(n, a, 0, x);
            T::one() / ((T::one() - x) * (T::one() + x) * d * d)
        })
        .collect();
    let points = roots.iter().map(|&x| Vector::<1, T>::new((T::one() + x) * half)).collect();
    Rule { points, weights }
}

/// Gauss-Legendre rule with `n` points on the unit interval, exact for polynomials of degree 2n - 1.
///
/// Points ascend and mirror each other; weights sum to one.
///
/// # Panics
/// If `n` is zero.
///
/// ```
/// let rule = faying::quadrature::gauss_legendre::<f64>(3);
/// let integral: f64 = rule.points.iter().zip(&rule.weights).map(|(x, w)| w * x[0].powi(5)).sum();
/// assert!((integral - 1.0 / 6.0).abs() < 1e-15);
/// ```
pub fn gauss_legendre<T: Real>(n: usize) -> Rule<1, T> {
    assert!(n > 0, "a Gauss rule has at least one point");
    let mut rule = gauss_jacobi::<T>(n, 0);
    let half = lit::<T>(0.5);
    for i in 0..n / 2 {
        let w = (rule.weights[i] + rule.weights[n - 1 - i]) * half;
        (rule.weights[i], rule.weights[n - 1 - i]) = (w, w);
        rule.points[n - 1 - i][0] = T::one() - rule.points[i][0];
    }
    rule
}

/// The `degree + 1` Gauss-Lobatto nodes on the unit interval: both ends and the roots of the derivative of the
/// Legendre polynomial of that degree; equispaced up to degree 2. Degree 0 has the midpoint.
pub fn gauss_lobatto_nodes<T: Real>(degree: usize) -> Vec<T> {
    let half = lit::<T>(0.5);
    if degree == 0 {
        return vec![half];
    }
    let mut nodes = vec![T::zero()];
    // the derivative of P_n is a multiple of P_(n-1)^(1, 1)
    nodes.extend(jacobi_roots::<T>(degree - 1, 1, 1).into_iter().map(|x| (T::one() + x) * half));
    nodes.push(T::one());
    for i in 0..nodes.len() / 2 {
        nodes[degree - i] = T::one() - nodes[i];
    }
    nodes
}
