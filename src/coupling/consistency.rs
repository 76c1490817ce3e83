//! Consistency error of an integration, estimated from a finer one on a solution.
//!
//! With C and B the rows of an integration (B = C unless it is mixed), F the rows of a finer one, and the diagonals
//! W_j = ∫ |ψ_j| ds of the multipliers, M_i = ∫ |N_i| ds of both sides, M_s of the slave's unknowns alone:
//!
//! ```text
//! e = max( |W^-1/2 (C - F) u| / |M_s^1/2 u| ,  |M^-1/2 (B - F)ᵀ lambda| / |W^1/2 lambda| )
//! ```
//!
//! The first part is the error of the constraint, the second that of the equilibrium: the two consistency errors of
//! Strang's lemma, in lumped norms (|W^-1/2 r| is the norm of a functional r on multipliers, |M_s^1/2 u| that of u on the
//! slave side). e is free of units, zero up to round-off where the integration is exact, and falls with its points. Rows that are not
//! closed hold no constraint: of contacts the first part takes the closed rows alone, and the u of the functions that they weigh.
//! An estimate: F is exact only up to its own quadrature. Couplings without rows add a stiffness K, on the finer integration K_F; their
//! forces on the functions of the sides are K u, and
//!
//! ```text
//! e = |M^-1/2 (K - K_F) u| / |M_s^-1/2 K u|,
//! ```
//!
//! the second part with the lumped norm of the forces on the slave in place of that of lambda, which it is at most. Source of the splitting: Brivadis, Buffa, Wohlmuth, Wunderlich,
//! *The influence of quadrature errors on isogeometric mortar methods* (2015).

use super::nitsche::summed;
use super::{Coupling, CouplingError, Interface, Mortar, Rows, Segments, Side};
use crate::basis::{Basis, Order, ShapeTable};
use crate::linalg::{Real, Triplets, Vector, lit};

/// Finer mortar rows of one slave side, and the weights of the norms. As expensive as assembling the rows.
#[derive(Clone, Debug, PartialEq)]
pub struct ConsistencyEstimate<T: Real = f64> {
    rows: Rows<T>,
    /// W, one per row.
    multiplier: Vec<T>,
    /// M of the unknowns of both sides, and whether the slave has them; ascending.
    unknowns: Vec<(usize, T, bool)>,
}

impl<T: Real> ConsistencyEstimate<T> {
    /// Assembles the finer rows from the interfaces of one slave side with all its masters, each with finer segments.
    ///
    /// # Errors
    /// [`CouplingError`] where an interface has no mortar rows.
    pub fn try_new<const S: usize, const N: usize>(interfaces: &[Interface<'_, S, N, T>], unknowns: usize) -> Result<Self, CouplingError> {
        let none = || Triplets::new(0, unknowns);
        let mut all = Self { rows: Rows { slave: none(), master: none() }, multiplier: Vec::new(), unknowns: Vec::new() };
        for interface in interfaces {
            let rows = Mortar.assemble(&Interface { master_segments: None, ..*interface }, unknowns)?.constraint;
            let weights = row_weights(interface);
            if all.multiplier.is_empty() {
                (all.rows, all.multiplier) = (rows, weights);
            } else {
                all.rows.slave.append_below(&rows.slave, 0);
                all.rows.master.append_below(&rows.master, 0);
                all.multiplier.iter_mut().zip(weights).for_each(|(sum, w)| *sum += w);
            }
            all.unknowns.extend(weights_of_sides(interface));
        }
        all.unknowns = joined(all.unknowns);
        Ok(all)
    }

    /// Returns the consistency error e (module docs) of constraint rows C and reaction rows B, `[C, B]`, on a solution u, lambda, whose rows
    /// hold where `closed` says so (`None`: everywhere). A lambda that is smaller than `least` on average [force/area] counts as that large,
    /// a part with zero denominator as zero.
    pub fn estimate(&self, [constraint, reaction]: [&Rows<T>; 2], closed: Option<&[bool]>, u: &[T], lambda: &[T], least: T) -> T {
        let zero = T::zero();
        let holds = |i: usize| closed.is_none_or(|c| c[i]);
        let mut gap = vec![zero; self.multiplier.len()];
        let mut force = vec![zero; self.unknowns.len()];
        let mut weighed = vec![closed.is_none(); self.unknowns.len()];
        let mut add = |rows: &Rows<T>, sign: T, to_gap: bool, to_force: bool| {
            for &(i, j, v) in rows.slave.entries.iter().chain(&rows.master.entries) {
                if to_gap && holds(i) {
                    gap[i] += sign * v * u[j];
                }
                // functions that vanish at all points of the finer rule have no weight
                if let Ok(k) = self.unknowns.binary_search_by_key(&j, |w| w.0) {
                    weighed[k] |= holds(i);
                    if to_force {
                        force[k] += sign * v * lambda[i];
                    }
                }
            }
        };
        add(constraint, T::one(), true, false);
        add(reaction, T::one(), false, true);
        add(&self.rows, -T::one(), true, true);
        let dual = |r: T, w: T| if w > zero { r * r / w } else { zero };
        let sum = |terms: &mut dyn Iterator<Item = T>| terms.fold(zero, |s, v| s + v).sqrt();
        let gap = sum(&mut gap.iter().zip(&self.multiplier).map(|(&r, &w)| dual(r, w)));
        let force = sum(&mut force.iter().zip(&self.unknowns).map(|(&r, w)| dual(r, w.1)));
        let u = sum(&mut self.unknowns.iter().zip(&weighed).filter(|(w, weighed)| w.2 && **weighed).map(|(w, _)| w.1 * u[w.0] * u[w.0]));
        let lambda = sum(&mut self.multiplier.iter().zip(lambda).map(|(&w, &l)| w * l * l));
        let lambda = lambda.max(least * sum(&mut self.multiplier.iter().copied()));
        let share = |defect: T, size: T| if size > zero { defect / size } else { zero };
        share(gap, u).max(share(force, lambda))
    }
}

/// Defect of the stiffness that a coupling without rows adds, against that of a finer integration, in the rows of the functions of both
/// sides. As expensive as assembling the stiffness.
#[derive(Clone, Debug, PartialEq)]
pub struct StiffnessEstimate<T: Real = f64> {
    /// Entries of K - K_F.
    defect: Vec<(usize, usize, T)>,
    /// M of the unknowns of both sides, and whether the slave has them; ascending.
    unknowns: Vec<(usize, T, bool)>,
}

/// Entries of K - K_F below this share of the largest one of K are rounding.
const ROUNDING: f64 = 1e-13;

impl<T: Real> StiffnessEstimate<T> {
    /// Assembles the finer stiffness from the interfaces of one slave side with all its masters, each with finer segments; `own`: K.
    ///
    /// # Errors
    /// [`CouplingError`] of the coupling.
    pub fn try_new<const S: usize, const N: usize>(
        coupling: &dyn Coupling<S, N, T>,
        own: &Triplets<T>,
        interfaces: &[Interface<'_, S, N, T>],
    ) -> Result<Self, CouplingError> {
        let unknowns = joined(interfaces.iter().flat_map(weights_of_sides).collect());
        let mut defect = own.entries.clone();
        for interface in interfaces {
            let finer = coupling.assemble(interface, own.cols)?.stiffness;
            defect.extend(finer.entries.into_iter().map(|(i, j, v)| (i, j, -v)));
        }
        let rounding = own.entries.iter().fold(T::zero(), |m, e| m.max(e.2.abs())) * lit(ROUNDING);
        defect.retain(|e| unknowns.binary_search_by_key(&e.0, |w| w.0).is_ok());
        let mut defect = summed(defect);
        defect.retain(|e| e.2.abs() > rounding);
        Ok(Self { defect, unknowns })
    }

    /// Returns the consistency error e (module docs) of the stiffness `own` on a solution u; zero without forces. Forces that are smaller than
    /// those of tractions of the size `least` [force/area] count as that large.
    pub fn estimate(&self, own: &Triplets<T>, u: &[T], least: T) -> T {
        let norm = |entries: &[(usize, usize, T)], of_slave: bool| {
            let mut forces = vec![T::zero(); self.unknowns.len()];
            for &(i, j, v) in entries {
                if let Ok(k) = self.unknowns.binary_search_by_key(&i, |w| w.0) {
                    forces[k] += v * u[j];
                }
            }
            let counted = forces.iter().zip(&self.unknowns).filter(|(_, w)| w.2 || !of_slave);
            counted.fold(T::zero(), |sum, (f, w)| sum + *f * *f / w.1).sqrt()
        };
        let area = self.unknowns.iter().filter(|w| w.2).fold(T::zero(), |sum, w| sum + w.1);
        let (missed, whole) = (norm(&self.defect, false), norm(&own.entries, true).max(least * area.sqrt()));
        if whole > T::zero() { missed / whole } else { T::zero() }
    }
}

/// The weights M of the unknowns of both sides of an interface.
fn weights_of_sides<const S: usize, const N: usize, T: Real>(interface: &Interface<'_, S, N, T>) -> Vec<(usize, T, bool)> {
    let s = interface.segments;
    let mut weights = unknown_weights(&interface.slave, s, &s.slave, &s.slave_xi, true);
    if let Some(master) = &interface.master {
        weights.extend(unknown_weights(master, s, &s.master, &s.master_xi, false));
    }
    weights
}

/// Sums the weights of equal unknowns, ascending.
fn joined<T: Real>(mut weights: Vec<(usize, T, bool)>) -> Vec<(usize, T, bool)> {
    weights.sort_by_key(|&(unknown, _, _)| unknown);
    weights.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
            kept.2 |= next.2;
        }
        same
    });
    weights
}

/// ∫ |ψ_j| ds per row.
fn row_weights<const S: usize, const N: usize, T: Real>(interface: &Interface<'_, S, N, T>) -> Vec<T> {
    let (segments, components) = (interface.segments, interface.slave.field.components);
    let of = |psi: &dyn Basis<S, T>| sums(psi, segments, &segments.slave, &segments.slave_xi);
    match interface.multiplier {
        [one] if interface.direction.is_none() => of(*one).repeat(components),
        several => several.iter().flat_map(|&psi| of(psi)).collect(),
    }
}

/// (unknown, ∫ |N_i| ds, `is_slave`) for the unknowns of a side with nonzero weight.
fn unknown_weights<const S: usize, const N: usize, T: Real>(
    side: &Side<'_, S, N, T>,
    segments: &Segments<S, T>,
    elements: &[usize],
    xi: &[Vector<S, T>],
    is_slave: bool,
) -> Vec<(usize, T, bool)> {
    let sums = sums(&*side.trace.space, segments, elements, xi);
    let of = |(i, w): (usize, T)| (0..side.field.components).map(move |c| (side.field.unknown(side.trace.dofs[i], c), w, is_slave));
    sums.into_iter().enumerate().filter(|s| s.1 > T::zero()).flat_map(of).collect()
}

/// ∫ |function| ds over the segments, one per function of `basis`, evaluated on `elements` (per piece) at `xi` (per point).
fn sums<const S: usize, T: Real, B: Basis<S, T> + ?Sized>(
    basis: &B,
    segments: &Segments<S, T>,
    elements: &[usize],
    xi: &[Vector<S, T>],
) -> Vec<T> {
    let (mut sums, mut table, mut ids) = (vec![T::zero(); basis.num_functions()], ShapeTable::new(), Vec::new());
    for piece in 0..segments.num_pieces() {
        let points = segments.points(piece);
        basis.active(elements[piece], &mut ids);
        basis.tabulate(elements[piece], &xi[points.clone()], Order::Values, &mut table);
        for (k, q) in points.enumerate() {
            for (&i, &value) in ids.iter().zip(table.values(k)) {
                sums[i] += segments.ds[q] * value.abs();
            }
        }
    }
    sums
}
