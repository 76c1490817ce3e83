//! Bodies of degree 1 whose material hardly changes its volume.
//!
//! Functions of degree 1 that keep the volume of every element hold too few motions: such bodies are too stiff by a factor that grows with
//! K / G and falls with h^2 only (volumetric locking). What decides is the response of the plane or of space in which the body lives,
//!
//! ```text
//! tr σ(1) / N  over  (σ_xx - σ_yy)(diag(1, -1)) / 2,
//! ```
//!
//! (N λ + 2 G) / (2 G) of isotropic materials: 50 in plane strain at nu = 0.49, 3 in plane stress.

use super::warning::{Subject, Warning};
use crate::linalg::{Matrix, Vector};
use crate::physics::Material;
use crate::problem::model::Model;
use crate::problem::physics::Physics;

/// Largest ratio of both moduli that is not told.
const STIFF: f64 = 45.0;

/// Finds such bodies; where the solution is known its error is measured.
pub(super) fn locking<const S: usize, const N: usize>(model: &Model<S, N>, t: f64) -> Vec<Warning> {
    if model.has_exact() || model.components != N {
        return Vec::new();
    }
    let of = |k: usize| {
        let patch = &model.patches[k];
        let space = &**patch.body.space();
        let linear = (0..space.num_elements()).all(|e| space.degree(e).into_iter().max() == Some(1));
        let middle = patch.extent.filter(|_| linear)?.center();
        let physics = patch.physics_at(t);
        let Physics::Vector(material) = &physics else { return None };
        let ratio = stiffness_ratio(&**material, &middle);
        (ratio > STIFF).then(|| Warning::Locking { of: Subject::body(model, k), ratio })
    };
    (0..model.patches.len()).filter_map(of).collect()
}

/// The stiffness against a change of volume over that against one of shape.
fn stiffness_ratio<const N: usize>(material: &dyn Material<N, N>, x: &Vector<N>) -> f64 {
    let volume = material.respond(x, &Matrix::identity()).stress.trace() / N as f64;
    let shape = Matrix::<N, N>::from_fn(|i, j| if i != j { 0.0 } else { [1.0, -1.0].get(i).copied().unwrap_or(0.0) });
    let stress = material.respond(x, &shape).stress;
    2.0 * volume / (stress[(0, 0)] - stress[(1, 1)])
}
