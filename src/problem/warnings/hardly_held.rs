//! Rigid motions held by soft springs and foundations only.
//!
//! Z: the rigid motions that supports, ties and closed contacts leave without the springs. For a motion z = Z y the springs store yᵀ S y /
//! 2, S = Zᵀ (∫ k (d . u)² ds) Z, and bodies deformed by as much as they move store about yᵀ B y / 2 with B = Zᵀ diag(E_b V_b / L_b²) Z,
//! E_b the modulus, V_b the volume, L_b the size of body b. The eigenvalues of S y = μ B y are the springs' share of the stiffness; a
//! motion with μ much smaller than 1 is dominated by the round-off of the bodies' stiffness, 1e-16 of it times the number of elements
//! squared.

use super::warning::{Subject, Warning};
use crate::basis::Order;
use crate::geometry::{MapTable, cell};
use crate::linalg::{Vector, measure};
use crate::problem::Point;
use crate::problem::model::Model;
use crate::problem::rigid::{RigidModes, RigidRow};
use crate::problem::rigid_bodies::{RigidBodies, unit};
use crate::problem::rigid_rows::closed_forms;
use crate::problem::supports::{Ties, rigid_forms};
use crate::quadrature::Quadrature;
use crate::space;
use nalgebra::{DMatrix, DVector};

/// Springs and foundations with less than this fraction of the stiffness of the bodies they hold are soft.
const SOFT: f64 = 1e-5;

/// Rigid motions that springs alone hold.
pub(super) struct HeldBySprings<const N: usize> {
    pub bodies: RigidBodies,
    pub modes: RigidModes<N>,
    /// Z, orthonormal columns of modes of the bodies.
    pub left: DMatrix<f64>,
    /// ∫ k (d . u)² ds of the modes.
    pub stiffness: DMatrix<f64>,
}

/// The motions that springs and foundations alone hold at time `t`; `None` if there are none.
pub(super) fn held_by_springs<const S: usize, const N: usize>(model: &Model<S, N>, t: f64) -> Option<HeldBySprings<N>> {
    if model.springs.is_empty() && model.foundations.is_empty() {
        return None;
    }
    let bodies = RigidBodies::of(model);
    let (modes, mut forms) = rigid_forms(model, &bodies, None, Ties::Functions);
    forms.extend(closed_forms(model, &modes, &bodies));
    let left = modes.null(&forms);
    if left.ncols() == 0 {
        return None;
    }
    let n = left.nrows();
    let mut springs = DMatrix::<f64>::zeros(n, n);
    let mut table = MapTable::new();
    for spring in &model.springs {
        let space = &*spring.side.trace.space;
        for e in 0..space.num_elements() {
            let body = bodies.of_facet(model, &spring.side, e);
            let rule = spring.side.rules.rule(e);
            space.map(e, &rule.points, Order::Gradients, &mut table);
            for ((x, j), w) in table.x.iter().zip(&table.jacobian).zip(&rule.weights) {
                let k = spring.stiffness.value(&Point::new(x.as_slice()).at_time(t)) * w * measure(j);
                let form = modes.form(&RigidRow { terms: vec![(body, 1.0, *x)], direction: unit(spring.component) });
                modes.add_square(&form, k, &mut springs);
            }
        }
    }
    for foundation in &model.foundations {
        let patch = &model.patches[foundation.body];
        let space = &**patch.body.space();
        let mut table = MapTable::new();
        for e in 0..space.num_elements() {
            let (body, rule) = (bodies.of_element(model, foundation.body, e), patch.rules.rule(e));
            space.map(e, &rule.points, Order::Gradients, &mut table);
            for ((x, j), w) in table.x.iter().zip(&table.jacobian).zip(&rule.weights) {
                let form = modes.form(&RigidRow { terms: vec![(body, 1.0, *x)], direction: unit(foundation.component) });
                modes.add_square(&form, foundation.at(x, t) * w * measure(j), &mut springs);
            }
        }
    }
    Some(HeldBySprings { bodies, modes, left, stiffness: springs })
}

/// Finds the motions that springs hold with too small a fraction of the bodies' stiffness at time `t`.
pub(super) fn hardly_held<const S: usize, const N: usize>(model: &Model<S, N>, t: f64) -> Vec<Warning> {
    let Some(HeldBySprings { bodies, modes, left, stiffness: springs }) = held_by_springs(model, t) else { return Vec::new() };
    let n = left.nrows();
    let stiffness = body_stiffness(model, &bodies, modes.num_bodies());
    let weights = DMatrix::from_fn(n, n, |i, j| if i == j { stiffness[i / modes.modes()] } else { 0.0 });
    let (soft, hard) = (left.transpose() * springs * &left, left.transpose() * weights * &left);
    // B is positive definite: L⁻¹ S L⁻ᵀ has the same eigenvalues
    let Some(factor) = hard.cholesky() else { return Vec::new() };
    let inverse = factor.l().try_inverse().unwrap_or_else(|| DMatrix::identity(soft.nrows(), soft.nrows()));
    let eigen = (&inverse * soft * inverse.transpose()).symmetric_eigen();
    let mut found = Vec::new();
    for (k, &share) in eigen.eigenvalues.iter().enumerate().filter(|(_, share)| **share < SOFT) {
        let motion = &left * (inverse.transpose() * eigen.eigenvectors.column(k));
        found.extend(warning(model, &bodies, &modes, &motion, share));
    }
    found
}

/// Warning for a motion, about the body that moves most.
fn warning<const S: usize, const N: usize>(
    model: &Model<S, N>,
    bodies: &RigidBodies,
    rigid: &RigidModes<N>,
    motion: &DVector<f64>,
    share: f64,
) -> Option<Warning> {
    let modes = rigid.modes();
    let size = |body: usize| motion.rows(modes * body, modes).norm();
    let most = (0..motion.len() / modes).max_by(|&a, &b| size(a).total_cmp(&size(b)).then(b.cmp(&a)))?;
    let patch = Some(bodies.number(model, most)).filter(|k| *k < model.patches.len())?;
    let own = motion.rows(modes * most, modes).into_owned() / size(most);
    let motions = rigid.name(most, &DMatrix::from_column_slice(modes, 1, own.as_slice()));
    Some(Warning::HardlyHeld { of: Subject::body(model, patch), motions, share: share.max(0.0) })
}

/// E V / L² of every body: modulus at the middle of its first element, volume, size; for obstacles the least of the bodies.
fn body_stiffness<const S: usize, const N: usize>(model: &Model<S, N>, bodies: &RigidBodies, count: usize) -> Vec<f64> {
    let mut sums = vec![0.0; count];
    for (k, patch) in model.patches.iter().enumerate() {
        let body = &**patch.body.space();
        let bounds = body.all_bounds().into_iter().reduce(|a, b| a.union(&b));
        let (Some(bounds), true) = (bounds, body.num_elements() > 0) else { continue };
        let center = cell::center::<N, f64>(body.cell(0));
        let mut table = MapTable::new();
        body.map(0, &[center], Order::Values, &mut table);
        let x: Vector<N> = table.x[0];
        let length = bounds.diagonal();
        let volume = if patch.is_revolved() { space::revolved_measure(body) } else { space::measure(body) };
        sums[bodies.of_patch(k)] += patch.physics.modulus(&x) * volume / (length * length);
    }
    // a force-driven obstacle has no stiffness of its own: it takes the least of the bodies
    let least = sums.iter().copied().filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
    sums.iter().map(|&s| if s > 0.0 { s } else { least }).collect()
}
