//! Contact by Nitsche's method: soft rows at the points of the segments, stiffness beside them, no multiplier functions.
//!
//! ```text
//! P(u) = sigma(u) + γ g(u),   lambda = min(0, P(u))      (lambda = sigma, lambda <= 0 <= g, lambda g = 0 in one equation)
//! a(u, v) - ∫ θ/γ sigma(u) sigma(v) ds + ∫ lambda ([v] . n + θ/γ sigma(v)) ds = f(v)
//! ```
//!
//! ```text
//! sigma = -{t} . n,   g = g' + [u] . n,   [u] = u_slave - u_master,   n out of the master
//! ```
//!
//! {t}, its weights, γ and θ are those of [`crate::coupling::nitsche`]: symmetric, unsymmetric, incomplete. With every point closed this is
//! the coupling's normal part. A point q of weight w is one contact row with the compliance w / γ:
//!
//! ```text
//! C_q = w ([.] . n + sigma / γ),   offset w g',   B_q = w ([.] . n + θ sigma / γ)
//! (C u + g)_q = w/γ P = compliance lambda   where closed,
//! ```
//!
//! and open where (C u + g)_q >= 0. So the active set over these rows is the semismooth Newton iteration of the equation above, and the
//! rows may be combined with exact, soft and tied ones. Only the symmetric variant has B = C; K is symmetric for all three.
//!
//! Sources: Chouly, Hild, SIAM J. Numer. Anal. 51 (2013) 1295-1307; Chouly, Hild, Renard, Math. Comp. 84 (2015) 1089-1112 (θ); Chouly,
//! Mlika, Renard, Numer. Math. 139 (2018) 593-631 (two bodies).

use super::{Begun, ContactAt, ContactMethod, MethodError, Needs, PointValues};
use crate::contact::gap::wanted;
use crate::contact::{ContactError, ContactKinematics, ContactRows, Opponent};
use crate::coupling::nitsche::{Entries, PointFluxes, Weights, summed};
use crate::coupling::{CouplingError, Interface, Nitsche, Rows, Segments, Side};
use crate::linalg::{Real, Triplets, Vector, lit};

impl<const S: usize, const N: usize> ContactMethod<S, N> for Nitsche {
    fn needs(&self) -> Needs {
        Needs::FLUXES
    }

    fn check(&self) -> Result<(), MethodError> {
        Ok(self.check_factor()?)
    }

    fn rows(&self, at: &ContactAt<'_, S, N>) -> Result<ContactRows<S, N>, ContactError> {
        ContactRows::nitsche(self, at.slave, at.opponent, at.segments, at.gap, at.unknowns)
    }

    fn begin(&self, rows: &ContactRows<S, N>, _: &dyn Fn(usize) -> f64) -> Begun {
        Begun { compliance: rows.compliance.clone(), eased: true, iteration: None }
    }

    fn values(&self, at: &ContactAt<'_, S, N>, unknowns: &[f64]) -> Option<Result<PointValues, ContactError>> {
        Some(point_values(self, at.slave, at.opponent, at.segments, at.gap, unknowns))
    }
}

/// Numbers in `all` of the points in `kept`, which have the same order.
fn numbers<const S: usize, T: Real>(all: &Segments<S, T>, kept: &Segments<S, T>) -> Vec<usize> {
    let mut of_all = (0..all.num_pieces()).flat_map(|piece| all.points(piece).map(move |q| (all.slave[piece], q)));
    (0..kept.num_pieces())
        .flat_map(|piece| kept.points(piece).map(move |q| (kept.slave[piece], kept.slave_xi[q])))
        .map(|(element, xi)| of_all.find(|&(e, q)| e == element && all.slave_xi[q] == xi).expect("kept points are points of the list").1)
        .collect()
}

impl<const S: usize, const N: usize, T: Real> ContactRows<S, N, T> {
    /// Contact of `slave` and `opponent` by Nitsche's method; both sides need their fluxes.
    ///
    /// Arguments as of [`ContactRows::new`]. There is one row per point of `segments`; those of points that face nothing are open and empty.
    ///
    /// # Errors
    /// [`ContactError::Coupling`] if a flux is missing or has no bound, or the factor is too small for the variant;
    /// [`ContactError::Gap`] if the gap formula has no value.
    pub fn nitsche(
        nitsche: &Nitsche,
        slave: Side<'_, S, N, T>,
        opponent: Opponent<'_, S, N, T>,
        segments: &Segments<S, T>,
        gap: &dyn Fn(&Vector<N, T>, T) -> T,
        unknowns: usize,
    ) -> Result<Self, ContactError> {
        nitsche.check_factor()?;
        let (master, kept, frames) = opponent.faced_by(slave, segments)?;
        let wanted = wanted(&frames, gap)?;
        let row = numbers(segments, &kept);
        let (theta, m) = (lit::<T>(nitsche.theta()), segments.ds.len());
        let empty = || Rows { slave: Triplets::new(m, unknowns), master: Triplets::new(m, unknowns) };
        let (mut rows, mut reaction) = (empty(), empty());
        let (mut offset, mut weights, mut compliance) = (vec![T::zero(); m], vec![T::zero(); m], vec![T::zero(); m]);
        let mut facing = vec![false; m];
        let mut entries: Entries<T> = Vec::new();
        each_piece(nitsche, slave, master, &kept, &frames, |piece, points, gamma| {
            let mut own: Entries<T> = Vec::new();
            for (k, q) in kept.points(piece).enumerate() {
                let (j, w) = (row[q], kept.ds[q]);
                (offset[j], weights[j], compliance[j], facing[j]) = (w * wanted[q], w, w / gamma, true);
                for (f, sign) in [(&mut rows, T::one()), (&mut reaction, theta)] {
                    let parts = [
                        (points.work.jump.as_slice(), points.work.of_slave[0], points.jump(k), w),
                        (points.work.flux.as_slice(), points.work.of_slave[1], points.sigma(k), sign * w / gamma),
                    ];
                    for (unknowns, split, values, factor) in parts {
                        for (i, (&unknown, &v)) in unknowns.iter().zip(values).enumerate() {
                            if v != T::zero() && factor != T::zero() {
                                let part = if i < split { &mut f.slave } else { &mut f.master };
                                part.push(j, unknown, factor * v);
                            }
                        }
                    }
                }
                if theta != T::zero() {
                    let sigma = points.sigma(k);
                    // some functions behind the side have no flux through it
                    let some = |i: &usize| sigma[*i] != T::zero();
                    for a in (0..sigma.len()).filter(some) {
                        let scaled = -theta * w / gamma * sigma[a];
                        own.extend((0..sigma.len()).filter(some).map(|b| (points.work.flux[a], points.work.flux[b], scaled * sigma[b])));
                    }
                }
            }
            entries.extend(summed(own));
        })?;
        let made = Self::at_points((kept, frames, wanted), row, rows, (offset, weights, facing));
        Ok(Self {
            reaction: (theta != T::one()).then_some(reaction),
            compliance,
            stiffness: Some(Triplets { entries: summed(entries), ..Triplets::new(unknowns, unknowns) }),
            ..made
        })
    }
}

/// Returns lambda and gap of Nitsche's method at the points of `segments` that face `opponent`, with the numbers of these points.
fn point_values<const S: usize, const N: usize, T: Real>(
    nitsche: &Nitsche,
    slave: Side<'_, S, N, T>,
    opponent: Opponent<'_, S, N, T>,
    segments: &Segments<S, T>,
    gap: &dyn Fn(&Vector<N, T>, T) -> T,
    unknowns: &[T],
) -> Result<PointValues<T>, ContactError> {
    let (master, kept, frames) = opponent.faced_by(slave, segments)?;
    let wanted = wanted(&frames, gap)?;
    let mut values = PointValues { point: numbers(segments, &kept), lambda: Vec::new(), gap: Vec::new() };
    each_piece(nitsche, slave, master, &kept, &frames, |piece, points, gamma| {
        for (k, q) in kept.points(piece).enumerate() {
            let sum = |dofs: &[usize], values: &[T]| dofs.iter().zip(values).fold(T::zero(), |s, (&i, &v)| s + v * unknowns[i]);
            let gap = wanted[q] + sum(&points.work.jump, points.jump(k));
            let pressed = sum(&points.work.flux, points.sigma(k)) + gamma * gap;
            values.lambda.push(pressed.min(T::zero()));
            values.gap.push(gap);
        }
    })?;
    Ok(values)
}

/// \[u\] . n and sigma(u) at the points of a piece as linear maps of unknowns.
struct Points<'a, const S: usize, T: Real> {
    work: &'a PointFluxes<S, T>,
    jump: &'a [T],
    sigma: &'a [T],
}

impl<const S: usize, T: Real> Points<'_, S, T> {
    /// \[.\] . n at point `k` of the piece: one factor per unknown of `work.jump`.
    fn jump(&self, k: usize) -> &[T] {
        &self.jump[k * self.work.jump.len()..][..self.work.jump.len()]
    }

    /// sigma at point `k` of the piece: one factor per unknown of `work.flux`.
    fn sigma(&self, k: usize) -> &[T] {
        &self.sigma[k * self.work.flux.len()..][..self.work.flux.len()]
    }
}

/// Visits all pieces with their maps and γ.
fn each_piece<const S: usize, const N: usize, T: Real>(
    nitsche: &Nitsche,
    slave: Side<'_, S, N, T>,
    master: Option<Side<'_, S, N, T>>,
    segments: &Segments<S, T>,
    frames: &ContactKinematics<N, T>,
    mut visit: impl FnMut(usize, &Points<'_, S, T>, T),
) -> Result<(), CouplingError> {
    let interface = Interface { slave, master, multiplier: &[], segments, master_segments: None, direction: None };
    let weights = Weights::of(nitsche, &interface)?;
    let (mut work, mut jump, mut sigma) = (PointFluxes::new(), Vec::new(), Vec::new());
    for piece in 0..segments.num_pieces() {
        work.tabulate(&interface, &weights, piece)?;
        let (functions, width) = (work.jump.len() / N, work.flux.len());
        jump.clear();
        sigma.clear();
        for (k, q) in segments.points(piece).enumerate() {
            let n = &frames.normal[q];
            let values = &work.values[k * functions..][..functions];
            jump.extend(values.iter().flat_map(|&v| n.iter().map(move |&c| v * c)));
            sigma.extend((0..width).map(|f| (0..N).fold(T::zero(), |s, c| s - n[c] * work.mean[(k * N + c) * width + f])));
        }
        visit(piece, &Points { work: &work, jump: &jump, sigma: &sigma }, weights.stabilisation[piece]);
    }
    Ok(())
}
