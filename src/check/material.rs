//! Contract of [`Material`]: the tangent is the derivative of the stress and symmetric, and rigid motions need no energy.

use crate::assembly::{Tangent, contract};
use crate::linalg::{Matrix, Real, Vector, lit, num};
use crate::physics::Material;

/// Reproducible pseudo-random numbers between -1 and 1.
fn noise<T: Real>(seed: usize) -> T {
    let bits = (seed as u32).wrapping_mul(2_654_435_761).rotate_left(13).wrapping_mul(0x85eb_ca6b) >> 8;
    lit::<T>(f64::from(bits) / f64::from(1u32 << 23) - 1.0)
}

/// Checks `material` at `places` with displacement gradients of the size `strain`.
///
/// Rules: everything is finite and the modulus positive; no stress at rest; the tangent is the derivative of the stress
/// and symmetric; a linear material has the stress tangent : grad u; a homogeneous one responds alike everywhere; with
/// as many components as dimensions rotations give no stress (small ones for linear materials) and the spatial stress
/// repeats the stress of the model; the divergence is that of the stress of a quadratic field.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn material<const C: usize, const N: usize, T: Real, M: Material<C, N, T> + ?Sized>(
    material: &M,
    places: &[Vector<N, T>],
    strain: T,
) -> Result<(), String> {
    let eps = T::default_epsilon();
    let step = eps.cbrt();
    let loose = step * step * num(100);
    let tight = eps * num(1000);
    let zero = Matrix::<C, N, T>::zeros();
    let first: Option<Tangent<C, N, T>> = places.first().map(|x| material.respond(x, &zero).tangent);
    for (p, x) in places.iter().enumerate() {
        let at = format!("at place {p} ({x:?})");
        let grad = Matrix::<C, N, T>::from_fn(|i, j| strain * noise(101 * p + 7 * i + j + 1));
        let (rest, here) = (material.respond(x, &zero), material.respond(x, &grad));
        let scale = largest(&rest.tangent).max(largest(&here.tangent));
        if !scale.is_finite() || !here.stress.iter().all(|s| s.is_finite()) {
            return Err(format!("stress or tangent is not finite {at}"));
        }
        let modulus = material.modulus(x);
        if !(modulus > T::zero() && modulus.is_finite()) {
            return Err(format!("the modulus {modulus} is not positive {at}"));
        }
        if rest.stress.amax() > tight * scale * strain {
            return Err(format!("there is stress at rest {at}: {}", rest.stress));
        }
        // d sigma / d grad_u(i, j) by central differences
        for i in 0..C {
            for j in 0..N {
                let h = step * strain;
                let moved = |sign: T| {
                    let mut g = grad;
                    g[(i, j)] += sign * h;
                    material.respond(x, &g).stress
                };
                let difference = (moved(T::one()) - moved(-T::one())) / (h + h);
                if (difference - here.tangent[i][j]).amax() > loose * scale {
                    return Err(format!("the tangent for grad_u({i}, {j}) is not the derivative of the stress {at}"));
                }
                for k in 0..C {
                    for l in 0..N {
                        if (here.tangent[i][j][(k, l)] - here.tangent[k][l][(i, j)]).abs() > tight * scale {
                            return Err(format!("the tangent is not symmetric in ({i}, {j}) and ({k}, {l}) {at}"));
                        }
                    }
                }
            }
        }
        if material.is_linear() && (contract(&rest.tangent, &grad) - here.stress).amax() > tight * scale * strain {
            return Err(format!("the material says it is linear, but its stress is not tangent : grad u {at}"));
        }
        if material.is_homogeneous()
            && first.is_some_and(|f| (0..C).any(|i| (0..N).any(|j| (f[i][j] - rest.tangent[i][j]).amax() > tight * scale)))
        {
            return Err(format!("the material says it is homogeneous, but it answers differently {at}"));
        }
        if C == N && C > 1 {
            rotations(material, x, strain, tight * scale).map_err(|e| format!("{e} {at}"))?;
            let spatial = material.spatial_stress(x, &grad);
            let places = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];
            for (&(k, l), &s) in places.iter().zip(&spatial) {
                if k < N && l < N && (s - here.stress[(k, l)]).abs() > tight * scale * strain {
                    return Err(format!("the spatial stress differs from the stress in ({k}, {l}) {at}"));
                }
            }
        }
        divergence(material, x, &grad, strain, step, loose * scale * strain).map_err(|e| format!("{e} {at}"))?;
    }
    Ok(())
}

/// Largest absolute entry of a tangent.
fn largest<const C: usize, const N: usize, T: Real>(tangent: &Tangent<C, N, T>) -> T {
    tangent.iter().flatten().fold(T::zero(), |m, t| m.max(t.amax()))
}

/// Checks that rotations give no stress: small ones for linear materials, finite ones for others.
fn rotations<const C: usize, const N: usize, T: Real, M: Material<C, N, T> + ?Sized>(
    material: &M,
    x: &Vector<N, T>,
    strain: T,
    tolerance: T,
) -> Result<(), String> {
    for i in 0..N {
        for j in i + 1..N {
            let mut grad = Matrix::<C, N, T>::zeros();
            if material.is_linear() {
                grad[(i, j)] = -strain;
                grad[(j, i)] = strain;
            } else {
                // R - I in the plane (i, j)
                let (s, c) = (strain.sin(), strain.cos());
                grad[(i, i)] = c - T::one();
                grad[(j, j)] = c - T::one();
                grad[(i, j)] = -s;
                grad[(j, i)] = s;
            }
            if material.respond(x, &grad).stress.amax() > tolerance * strain {
                return Err(format!("a rotation in the plane ({i}, {j}) gives stress"));
            }
        }
    }
    Ok(())
}

/// The divergence of the stress of a quadratic field, by central differences in space.
fn divergence<const C: usize, const N: usize, T: Real, M: Material<C, N, T> + ?Sized>(
    material: &M,
    x: &Vector<N, T>,
    grad: &Matrix<C, N, T>,
    strain: T,
    step: T,
    tolerance: T,
) -> Result<(), String> {
    let hessian: [Matrix<N, N, T>; C] =
        std::array::from_fn(|i| Matrix::from_fn(|j, k| strain * noise(31 * i + 5 * (j + k) + 3 * j.max(k) + 2)));
    let mut expected = Vector::<C, T>::zeros();
    for l in 0..N {
        let moved = |sign: T| {
            let mut place = *x;
            place[l] += sign * step;
            let grad = Matrix::<C, N, T>::from_fn(|i, j| grad[(i, j)] + hessian[i][(j, l)] * sign * step);
            material.respond(&place, &grad).stress
        };
        let difference = (moved(T::one()) - moved(-T::one())) / (step + step);
        for k in 0..C {
            expected[k] += difference[(k, l)];
        }
    }
    let found = material.divergence(x, grad, &hessian);
    if (found - expected).amax() > tolerance * num(10) {
        return Err(format!("the divergence of the stress is {found}, differences give {expected}"));
    }
    Ok(())
}
