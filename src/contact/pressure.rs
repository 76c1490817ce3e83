//! Contact resultants: pressure, force, moment, and the closed zone.
//!
//! lambda = sum_j lambda_j ψ_j is the normal stress sigma_N <= 0, pressure = -lambda \[force/area\]. With n out of the
//! master the traction on the slave is -lambda n. Dual multipliers oscillate: their pressure is evaluated with other functions of the same
//! integrals ([`crate::coupling::multiplier::Reading`]), forces and moments with their own.
//!
//! The closed zone follows from the functions that carry pressure: χ = sum of ψ_j over mu_j < 0 (the multipliers of the cone, lambda_j for
//! P) is one inside, zero outside, and falls over the overlap of the outermost functions. Its integral is the area; the zone ends where
//! χ = 1/2. The whole support of those functions would add up to half their width at either end.

use super::ContactRows;
use crate::basis::{Basis, Order, ShapeTable};
use crate::linalg::{Real, Vector, lit};

/// Multipliers above this are round-off.
fn threshold<T: Real>(lambda: &[T]) -> T {
    lambda.iter().fold(T::zero(), |m, l| m.max(l.abs())) * lit(-NO_PRESSURE)
}

/// Multipliers below this share of the largest are round-off.
const NO_PRESSURE: f64 = 1e-12;

/// Resultants, pressures and closed zone of a contact side.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactResultants<const N: usize, T: Real = f64> {
    /// Force of the master on the slave \[force; 2D: per thickness\].
    pub force: Vector<N, T>,
    /// Its moment about the origin: (0, 0, m) in 2D.
    pub moment: [T; 3],
    /// Least pressure at the points of the segments.
    pub least_pressure: T,
    /// Largest pressure there.
    pub largest_pressure: T,
    /// ∫ χ ds: measure of the closed zone \[length^S\].
    pub area: T,
    /// Pressure per point of the segments.
    pub pressure: Vec<T>,
    /// Whether each point of the segments lies in the closed zone, χ >= 1/2.
    pub closed: Vec<bool>,
}

impl<const S: usize, const N: usize, T: Real> ContactRows<S, N, T> {
    /// Pressure at the points of the segments for the multipliers `lambda`.
    pub fn pressure(&self, multiplier: &dyn Basis<S, T>, lambda: &[T]) -> Vec<T> {
        self.combined(multiplier, |j| -lambda[j])
    }

    /// sum_j c_j ψ_j at the points of the segments.
    fn combined(&self, multiplier: &dyn Basis<S, T>, coefficient: impl Fn(usize) -> T) -> Vec<T> {
        let mut values = Vec::with_capacity(self.segments.ds.len());
        let (mut table, mut ids) = (ShapeTable::new(), Vec::new());
        for piece in 0..self.segments.num_pieces() {
            let (element, points) = (self.segments.slave[piece], self.segments.points(piece));
            multiplier.active(element, &mut ids);
            multiplier.tabulate(element, &self.segments.slave_xi[points.clone()], Order::Values, &mut table);
            values.extend((0..points.len()).map(|q| ids.iter().zip(table.values(q)).fold(T::zero(), |s, (&j, &v)| s + coefficient(j) * v)));
        }
        values
    }

    /// Force, moment, pressures and zone for the multipliers `lambda`.
    pub fn transmitted(&self, multiplier: &dyn Basis<S, T>, lambda: &[T]) -> ContactResultants<N, T> {
        self.transmitted_as_read(multiplier, multiplier, lambda)
    }

    /// [`ContactRows::transmitted`] with pressures and zone evaluated with the functions `reading`, as many as there are multipliers.
    pub fn transmitted_as_read(&self, multiplier: &dyn Basis<S, T>, reading: &dyn Basis<S, T>, lambda: &[T]) -> ContactResultants<N, T> {
        let mu = self.in_cone(lambda);
        let threshold = threshold(&mu);
        let zone = self.combined(reading, |j| if mu[j] < threshold { T::one() } else { T::zero() });
        self.summed(self.pressure(reading, lambda), &zone, &self.pressure(multiplier, lambda))
    }

    /// Force, moment, pressures and zone for `lambda` at the points of the segments: without functions χ is one where lambda < 0.
    pub fn transmitted_at_points(&self, lambda: &[T]) -> ContactResultants<N, T> {
        let threshold = threshold(lambda);
        let zone: Vec<T> = lambda.iter().map(|&l| if l < threshold { T::one() } else { T::zero() }).collect();
        let pressure: Vec<T> = lambda.iter().map(|&l| -l).collect();
        self.summed(pressure.clone(), &zone, &pressure)
    }

    /// Integrates χ (`zone`) and the pressure `pushes` over the points; extremes are those of `pressure`.
    fn summed(&self, pressure: Vec<T>, zone: &[T], pushes: &[T]) -> ContactResultants<N, T> {
        let mut out = ContactResultants {
            force: Vector::zeros(),
            moment: [T::zero(); 3],
            least_pressure: pressure.iter().copied().reduce(|a, b| a.min(b)).unwrap_or_else(T::zero),
            largest_pressure: pressure.iter().copied().reduce(|a, b| a.max(b)).unwrap_or_else(T::zero),
            area: T::zero(),
            pressure: Vec::new(),
            closed: zone.iter().map(|&chi| chi >= lit(0.5)).collect(),
        };
        for (q, &p) in pushes.iter().enumerate() {
            let ds = self.segments.ds[q];
            let pull = self.frames.normal[q] * (p * ds);
            out.force += pull;
            let at = |v: &Vector<N, T>, k: usize| if k < N { v[k] } else { T::zero() };
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                out.moment[k] += at(&self.frames.x[q], i) * at(&pull, j) - at(&self.frames.x[q], j) * at(&pull, i);
            }
            out.area += zone[q] * ds;
        }
        out.pressure = pressure;
        out
    }
}
