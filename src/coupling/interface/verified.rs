//! Checks of the segments that a rule returns; coverage is measured by the library, not read from the rule's report.
//!
//! A slave element is covered where the reference measure of its points, sum ds / |J|, is that of its cell; of others
//!
//! ```text
//! share = sum ds / ∫ |J|
//! ```
//!
//! A report that agrees is kept as it is, any other one is replaced.

use super::pairing::place_of;
use super::{Coverage, Segments, Tolerance};
use crate::basis::{Cell, Order};
use crate::coupling::CouplingError;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Matrix, Real, Vector, lit, measure, num, to_f64};
use crate::quadrature::{Quadrature, TensorRule, simplex_rule};

/// Error of the reference measure of an element that is covered, relative to that of its cell.
const WHOLE: f64 = 1e-8;
/// Difference of shares of elements that are covered in part: their lengths are those of few Gauss points.
const PART: f64 = 1e-2;
/// Rounding of distances, as a share of the coordinates, and their relative difference.
const ROUNDING: f64 = 1e-12;
/// Gauss points per direction that measure an element.
const POINTS: usize = 12;
/// Cosine of the angle between a line of partners and the master's normal plane that is rounding.
const UPRIGHT: f64 = 1e-6;
/// Local coordinates by which foot points on the continued element may leave its cell.
const CONTINUED: f64 = 1.001;

impl<const D: usize, T: Real> Segments<D, T> {
    /// Checks lists and numbers of segments of two sides, and measures their coverage where the report does not agree with it.
    ///
    /// # Errors
    /// [`CouplingError::Rule`] for lists that disagree, elements that do not exist or are covered twice, and points that are not finite.
    pub fn verified<const N: usize>(
        mut self,
        slave: &dyn Geometry<D, N, T>,
        master: &dyn Geometry<D, N, T>,
    ) -> Result<Self, CouplingError> {
        self.well_formed(slave.num_elements(), master.num_elements())?;
        let measured = self.measured(slave, master);
        if let Some((element, times)) = measured.counted_twice {
            return Err(CouplingError::Rule(format!("the points of the slave's element {element} measure {times:.6} times the element")));
        }
        if !agree(&self.report, &measured.coverage, measured.coordinates) {
            self.report = Coverage { lost: self.report.lost, ..measured.coverage };
        }
        self.count(master);
        Ok(self)
    }

    /// Checks that lists agree, elements exist and come in order, and numbers are finite.
    ///
    /// # Errors
    /// [`CouplingError::Rule`] with the place.
    pub fn well_formed(&self, slaves: usize, masters: usize) -> Result<(), CouplingError> {
        let fault = |what: String| Err(CouplingError::Rule(what));
        let (pieces, points) = (self.slave.len(), self.ds.len());
        let starts = &self.start;
        let rising = starts.first() == Some(&0) && starts.last() == Some(&points) && starts.windows(2).all(|w| w[0] <= w[1]);
        if self.master.len() != pieces || starts.len() != pieces + 1 || !rising {
            return fault(format!("{pieces} pieces of {points} points have {} masters and the starts {starts:?}", self.master.len()));
        }
        if self.slave_xi.len() != points || self.master_xi.len() != points {
            let (own, other) = (self.slave_xi.len(), self.master_xi.len());
            return fault(format!("{points} weights have {own} points of the slave and {other} of the master"));
        }
        for piece in 0..pieces {
            let (own, other) = (self.slave[piece], self.master[piece]);
            if own >= slaves || other >= masters {
                return fault(format!(
                    "piece {piece} names element {own} of the slave and {other} of the master; they have {slaves} and {masters}"
                ));
            }
            if piece > 0 && own < self.slave[piece - 1] {
                return fault(format!("piece {piece} goes back to element {own} of the slave, from {}", self.slave[piece - 1]));
            }
        }
        let sound = |q: usize| {
            let finite = |xi: &Vector<D, T>| xi.iter().all(|v| v.is_finite());
            self.ds[q].is_finite() && self.ds[q] >= T::zero() && finite(&self.slave_xi[q]) && finite(&self.master_xi[q])
        };
        match (0..points).find(|&q| !sound(q)) {
            Some(q) => fault(format!("point {q} has the weight {:?} at {:?} and {:?}", self.ds[q], self.slave_xi[q], self.master_xi[q])),
            None => Ok(()),
        }
    }

    /// Coverage, as measured from the points.
    fn measured<const N: usize>(&self, slave: &dyn Geometry<D, N, T>, master: &dyn Geometry<D, N, T>) -> Measured<T> {
        let mut sums = vec![[T::zero(); 2]; slave.num_elements()];
        let (mut coverage, mut coordinates) = (Coverage::default(), T::zero());
        self.each_pair(slave, master, |pair| {
            let (ds, element) = (self.ds[pair.point], self.slave[pair.piece]);
            let stretch = measure(&pair.jacobian);
            sums[element][0] += ds;
            sums[element][1] += if stretch > T::zero() { ds / stretch } else { T::zero() };
            let distance = (pair.x - pair.partner).norm();
            coordinates = coordinates.max(pair.x.amax()).max(pair.partner.amax());
            if distance > coverage.distance {
                (coverage.distance, coverage.at) = (distance, place_of(&pair.x));
            }
        });
        let rules = [TensorRule::<D, T>::gauss([POINTS; D]).rule(0).clone(), simplex_rule::<D, T>(2 * POINTS - 1)];
        let (mut table, mut counted_twice) = (MapTable::new(), None);
        for (element, [length, reference]) in sums.into_iter().enumerate() {
            let rule = &rules[usize::from(slave.cell(element) == Cell::Simplex)];
            let cell = rule.weights.iter().fold(T::zero(), |s, &w| s + w);
            if reference > cell * lit(1.0 + PART) {
                counted_twice = Some((element, to_f64(reference / cell)));
            }
            let is_whole = (reference / cell - T::one()).abs() <= lit(WHOLE);
            let own = if is_whole {
                length
            } else {
                slave.map(element, &rule.points, Order::Gradients, &mut table);
                table.jacobian.iter().zip(&rule.weights).fold(T::zero(), |s, (j, &w)| s + measure(j) * w)
            };
            coverage.slave_measure += own;
            coverage.covered += length;
            coverage.share.push(match is_whole {
                true => T::one(),
                false if own > T::zero() => (length / own).min(T::one()),
                false => T::zero(),
            });
        }
        Measured { coverage, coordinates, counted_twice }
    }

    /// Checks that partners of tied sides are no farther apart than `tolerance` allows.
    ///
    /// # Errors
    /// [`CouplingError::Apart`].
    pub fn touching<const N: usize>(
        &self,
        slave: &dyn Geometry<D, N, T>,
        master: &dyn Geometry<D, N, T>,
        tolerance: Tolerance<T>,
    ) -> Result<(), CouplingError> {
        let size = |side: &dyn Geometry<D, N, T>| side.extent().map_or_else(T::zero, |b| b.diagonal());
        let size = size(slave).max(size(master));
        let lengths = [slave, master].map(|side| side.all_bounds().iter().map(|b| b.diagonal()).collect::<Vec<T>>());
        let mut worst: Option<(T, CouplingError)> = None;
        self.each_pair(slave, master, |pair| {
            let distance = (pair.x - pair.partner).norm();
            let allowed = tolerance.within(size, [lengths[0][self.slave[pair.piece]], lengths[1][self.master[pair.piece]]]);
            let ratio = distance / allowed.max(T::default_epsilon());
            if ratio > T::one() && worst.as_ref().is_none_or(|w| ratio > w.0) {
                let (distance, allowed) = (to_f64(distance), to_f64(allowed));
                worst = Some((ratio, CouplingError::Apart { distance, at: place_of(&pair.x), allowed }));
            }
        });
        worst.map_or(Ok(()), |(_, error)| Err(error))
    }

    /// Checks that every point of sides in contact has a partner opposite to it: a foot point on the continued element, or the closest
    /// point of an element at whose end it is.
    ///
    /// # Errors
    /// [`CouplingError::Rule`] with the place.
    pub fn opposite<const N: usize>(&self, slave: &dyn Geometry<D, N, T>, master: &dyn Geometry<D, N, T>) -> Result<(), CouplingError> {
        let mut wrong = None;
        let mut table = MapTable::new();
        let size = master.extent().map_or_else(T::zero, |b| b.diagonal());
        self.each_pair(slave, master, |pair| {
            if wrong.is_some() {
                return;
            }
            let (element, xi) = (self.master[pair.piece], self.master_xi[pair.point]);
            master.map(element, &[xi], Order::Gradients, &mut table);
            let (apart, tangents): (Vector<N, T>, Matrix<N, D, T>) = (pair.x - pair.partner, table.jacobian[0]);
            let rounding = size * lit(ROUNDING.sqrt());
            let (least, most) = (lit::<T>(-CONTINUED), lit::<T>(1.0 + CONTINUED));
            let meets = (0..D).all(|k| {
                let along = apart.dot(&tangents.column(k));
                let upright = along.abs() <= tangents.column(k).norm() * (apart.norm() * lit(UPRIGHT) + rounding);
                let at_end = (xi[k] <= lit(WHOLE) && along <= T::zero()) || (xi[k] >= lit(1.0 - WHOLE) && along >= T::zero());
                (upright || at_end || master.cell(element) == Cell::Simplex && D > 1) && xi[k] >= least && xi[k] <= most
            });
            if !meets {
                let place = place_of(&pair.x);
                wrong = Some(format!("the point at {place:?} is not opposite to its partner at {xi:?} of the master's element {element}"));
            }
        });
        wrong.map_or(Ok(()), |what| Err(CouplingError::Rule(what)))
    }

    /// Calls `visit` for all points.
    fn each_pair<const N: usize>(
        &self,
        slave: &dyn Geometry<D, N, T>,
        master: &dyn Geometry<D, N, T>,
        mut visit: impl FnMut(Pair<D, N, T>),
    ) {
        let (mut here, mut there) = (MapTable::new(), MapTable::new());
        for piece in 0..self.num_pieces() {
            let points = self.points(piece);
            slave.map(self.slave[piece], &self.slave_xi[points.clone()], Order::Gradients, &mut here);
            master.map(self.master[piece], &self.master_xi[points.clone()], Order::Values, &mut there);
            for (k, point) in points.enumerate() {
                visit(Pair { piece, point, x: here.x[k], jacobian: here.jacobian[k], partner: there.x[k] });
            }
        }
    }
}

/// A point of the slave and its partner on the master.
struct Pair<const D: usize, const N: usize, T: Real> {
    piece: usize,
    point: usize,
    x: Vector<N, T>,
    jacobian: Matrix<N, D, T>,
    partner: Vector<N, T>,
}

/// Coverage as measured, the largest coordinate met, and an element that is covered more than once, with how many times.
struct Measured<T: Real> {
    coverage: Coverage<T>,
    coordinates: T,
    counted_twice: Option<(usize, f64)>,
}

/// Whether a report says what was measured.
fn agree<T: Real>(told: &Coverage<T>, found: &Coverage<T>, coordinates: T) -> bool {
    let near = |a: T, b: T, allowed: T| (a - b).abs() <= allowed;
    let shares = told.share.len() == found.share.len()
        && told.share.iter().zip(&found.share).all(|(&a, &b)| {
            let whole = |s: T| s >= T::one() - lit::<T>(WHOLE);
            near(a, b, lit(if whole(a) || whole(b) { WHOLE } else { PART }))
        });
    let rounding = coordinates * lit(ROUNDING);
    shares
        && near(told.covered, found.covered, found.slave_measure * lit(WHOLE))
        && near(told.slave_measure, found.slave_measure, found.slave_measure * lit(PART))
        && near(told.distance, found.distance, found.distance * lit(WHOLE) + rounding * num(16))
}
