//! Multipliers with which errors fall slower than the degree of the slave side lets them.
//!
//! *Dual* functions ψ_j take from f on every element e the coefficient ∫_e f N_j / ∫_e N_j, N_j the functions of the side. A field that is
//! linear in space is held where it has the same coefficient on all elements of N_j, so where the means
//!
//! ```text
//! x_j = ∫ x N_j ds / ∫ N_j ds
//! ```
//!
//! over all of them and over each are one. For Lagrange functions of Gauss-Lobatto points they are; for positive ones (splines) the mean over
//! an element lies inside of it, and the dual space holds constants only: whatever the degree, errors of u fall as at degree 2, those of
//! lambda with order 1. At degree 2 and below nothing is lost to the default.
//!
//! *Mixed* integration sums what the multiplier does to the master over the master's own elements. Where these have vertices of the slave
//! inside, at which its functions jump or kink, the error of u may be left with the order
//!
//! ```text
//! min(k + 1, p)
//! ```
//!
//! for functions that hold polynomials of degree k, p the least degree of both sides: 1 of constants and of dual functions of splines, p of the functions
//! of Lagrange elements themselves. Grids differ; it is reached where masters have twice the size.

use super::kinks::{Breaks, breaks};
use super::warning::{Subject, Warning};
use crate::assembly::gauss_rules;
use crate::basis::{Basis, Order, ShapeTable};
use crate::coupling::interface::slave_segments;
use crate::coupling::multiplier::least_degree;
use crate::linalg::Vector;
use crate::problem::model::{BodySide, Model};
use crate::space::Space;

/// Least degree of a side at which constants are too few.
const CUBIC: usize = 3;
/// Distance of means over the size of an element, weighed by the function, above which linear fields are not held.
const APART: f64 = 0.05;
/// Share of a side's inner edges at which functions jump or kink, from which on they spoil the sums of mixed integration.
const MOST: f64 = 0.5;
/// Share of them that lie inside of the master's elements.
const INSIDE: f64 = 0.1;

/// Finds the ties and contacts with such multipliers.
pub(super) fn low_orders<const S: usize, const N: usize>(model: &Model<S, N>) -> Vec<Warning> {
    let mut found: Vec<Warning> = Vec::new();
    let mut add = |warning: Option<Warning>| {
        if let Some(new) = warning.filter(|new| !found.iter().any(|old| old.repeats(new))) {
            found.push(new);
        }
    };
    for (k, tie) in model.ties.iter().enumerate() {
        for part in &tie.parts {
            add(constants_only(Subject::tie(model, k), &part.slave, part.is_dual));
            let masters: Vec<_> = part.pairings.iter().filter(|p| p.second.is_some()).map(|p| &*p.master).collect();
            add(mixed(Subject::tie(model, k), &part.slave, part.multipliers.first().map(|m| (&**m, part.is_dual)), &masters));
        }
    }
    for (k, contact) in model.contacts.iter().enumerate() {
        for part in &contact.parts {
            add(constants_only(Subject::contact(model, k), &part.slave, part.is_dual));
            let masters: Vec<_> = part.masters.iter().filter(|_| part.second.is_some()).map(|m| &**m).collect();
            add(mixed(Subject::contact(model, k), &part.slave, part.multiplier.as_deref().map(|m| (m, part.is_dual)), &masters));
        }
    }
    found
}

fn constants_only<const S: usize, const N: usize>(of: Subject, slave: &BodySide<S, N>, is_dual: bool) -> Option<Warning> {
    let space = &*slave.trace.space;
    let degree = least_degree::<S, f64>(space);
    (is_dual && degree >= CUBIC && !dual_holds_linear(space)).then(|| Warning::DualConstants { of, slave: slave.label.clone(), degree })
}

/// `multiplier` with whether it is dual; `masters`: those that mixed integration takes the points of.
fn mixed<const S: usize, const N: usize>(
    of: Subject,
    slave: &BodySide<S, N>,
    multiplier: Option<(&dyn Basis<S>, bool)>,
    masters: &[&BodySide<S, N>],
) -> Option<Warning> {
    let (psi, is_dual) = multiplier.filter(|_| !masters.is_empty())?;
    let space = &*slave.trace.space;
    let degree = least_degree::<S, f64>(space);
    let own = (0..psi.num_elements()).flat_map(|e| psi.degree(e)).max()?;
    let Breaks { broken, inside } = breaks(space, psi, masters);
    let held = match is_dual {
        false => own,
        true if dual_holds_linear(space) => degree - 1,
        true => 0,
    };
    let least = masters.iter().map(|m| least_degree::<S, f64>(&*m.trace.space)).fold(degree, usize::min);
    let order = least.min(held + 1);
    (broken > MOST && inside > INSIDE * broken).then(|| Warning::MixedMultiplier {
        of,
        slave: slave.label.clone(),
        degree,
        multiplier: own,
        order,
    })
}

/// Whether the dual functions of a side hold linear fields, but for [`APART`].
fn dual_holds_linear<const S: usize, const N: usize>(space: &dyn Space<S, N>) -> bool {
    let points = slave_segments(space, &gauss_rules(space, 0));
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    // per element and function of it: ∫ N_j, ∫ x N_j, ∫ |N_j|, and the size of the element
    let mut means: Vec<(usize, f64, Vector<N>, f64, f64)> = Vec::new();
    let mut map = crate::geometry::MapTable::new();
    for piece in 0..points.num_pieces() {
        let (element, range) = (points.slave[piece], points.points(piece));
        let (xi, ds) = (&points.slave_xi[range.clone()], &points.ds[range]);
        space.active(element, &mut ids);
        space.tabulate(element, xi, Order::Values, &mut table);
        space.map(element, xi, Order::Values, &mut map);
        let size = ds.iter().sum::<f64>().powf(1.0 / S as f64);
        for (a, &j) in ids.iter().enumerate() {
            let mut own = (j, 0.0, Vector::zeros(), 0.0, size);
            for (q, (x, ds)) in map.x.iter().zip(ds).enumerate() {
                let value = ds * table.values(q)[a];
                own.1 += value;
                own.2 += x * value;
                own.3 += value.abs();
            }
            means.push(own);
        }
    }
    let mut whole = vec![(0.0, Vector::<N>::zeros()); space.num_functions()];
    for (j, weight, moment, ..) in &means {
        whole[*j].0 += weight;
        whole[*j].1 += moment;
    }
    means.iter().all(|(j, weight, moment, magnitude, size)| {
        let (all, sum) = whole[*j];
        (moment - sum * (weight / all)).norm() <= APART * size * magnitude
    })
}
