//! Master-side sums: the master's own Gauss points, each with the slave point that faces it along the master's normal.
//!
//! A master point x_m with tangent t = x_m' faces the slave point whose closest point it is,
//!
//! ```text
//! (x_s(xi) - x_m(eta)) . t(eta) = 0,
//! ```
//!
//! and differentiating gives the slave's measure in the master's coordinate, with the curvature x_m'' of the master:
//!
//! ```text
//! ds = |x_s'| |dxi/deta| deta,   dxi/deta = (|t|² - (x_s - x_m) . x_m'') / (x_s' . t)
//! ```
//!
//! so the sums tend to the same integrals over the slave as slave-side and merged ones. Elements are integrated from end to end, with no
//! regard to the slave's knots: that is the error of this rule. An element is cut only where a side ends, or where the closest point of
//! the slave jumps; at a kink of the master its range ends where the fan of the vertex is halved, beyond its cell or before.
//! Slave pieces are assigned to master elements as in merged integration. A point on the common end of two slave elements counts half for
//! each: a multiplier may jump there, and rounding must not decide which side is taken.
//! Source: Brivadis, defence slides, Pavia 2017: the master part of B for contact.

use super::merged_curve::{PieceSides, Work};
use super::pairing::{crossing, place_of};
use super::{Coverage, InterfaceQuadrature, Partners, Segments};
use crate::basis::Order;
use crate::coupling::CouplingError;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector, lit};
use crate::parallel;
use std::cmp::Ordering;

/// Ranges on a master element closer than this share of it are one, and end at its end; points closer to the end of a range are on it.
const SAME: f64 = 1e-8;
/// Arcs whose range on the master is at most this share of an element are left out.
const POINT: f64 = 1e-12;

/// Gauss points on the master elements, for the master part of the reaction of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MasterSums<T: Real = f64> {
    /// Gauss points per master element.
    pub points: usize,
    /// Pairing rule.
    pub partners: Partners<T>,
}

impl<T: Real> MasterSums<T> {
    /// Creates the rule for sides in contact, possibly across a gap of at most `reach` (`None`: the size of the slave side).
    pub fn facing(points: usize, reach: Option<T>) -> Self {
        Self { points, partners: Partners::Facing { reach } }
    }
}

/// A part of a slave element that faces one master element.
#[derive(Clone, Copy, Debug)]
struct Arc<T> {
    slave: usize,
    /// Range on the slave element.
    xi: [T; 2],
    /// Foot points of its ends on the master element, ascending.
    eta: [T; 2],
}

impl<const N: usize, T: Real> InterfaceQuadrature<1, N, T> for MasterSums<T> {
    fn segments(&self, slave: &dyn Geometry<1, N, T>, master: &dyn Geometry<1, N, T>) -> Result<Segments<1, T>, CouplingError> {
        if master.num_elements() == 0 {
            return Err(CouplingError::NothingFaces);
        }
        let sides = PieceSides::new(slave, master, self.partners, self.points);
        let found: Vec<Result<Vec<(usize, Arc<T>)>, CouplingError>> =
            parallel::map_init(slave.num_elements(), Work::new, |work, e| arcs(&sides, e, work));
        // the first error in the order of elements, at any number of threads
        let found = found.into_iter().collect::<Result<Vec<_>, _>>()?;
        let mut of_master: Vec<Vec<Arc<T>>> = vec![Vec::new(); master.num_elements()];
        for (owner, arc) in found.into_iter().flatten() {
            of_master[owner].push(arc);
        }
        let summed: Vec<Vec<Summed<T>>> = parallel::map_init(of_master.len(), Work::new, |work, e| sums(&sides, e, &of_master[e], work));
        let mut pieces: Vec<(usize, Summed<T>)> =
            summed.into_iter().enumerate().flat_map(|(e, list)| list.into_iter().map(move |piece| (e, piece))).collect();
        pieces.sort_by_key(|(_, piece)| piece.slave);
        let mut out = listed(slave, pieces);
        out.count(master);
        Ok(out)
    }
}

/// Points of a master element that face one arc.
#[derive(Debug)]
struct Summed<T: Real> {
    slave: usize,
    points: Vec<(Vector<1, T>, Vector<1, T>, T)>,
    farthest: (T, [f64; 3]),
}

/// Collects the pieces into segments in the order of slave elements, with their coverage.
fn listed<const N: usize, T: Real>(slave: &dyn Geometry<1, N, T>, pieces: Vec<(usize, Summed<T>)>) -> Segments<1, T> {
    let lengths = super::Chain::of(slave).lengths;
    let mut covered = vec![T::zero(); lengths.len()];
    let (mut out, mut report) = (Segments::new(), Coverage::default());
    for (master, piece) in pieces {
        covered[piece.slave] += piece.points.iter().fold(T::zero(), |s, p| s + p.2);
        if piece.farthest.0 > report.distance {
            (report.distance, report.at) = piece.farthest;
        }
        out.push_piece(piece.slave, master, piece.points);
    }
    report.slave_measure = lengths.iter().fold(T::zero(), |s, &l| s + l);
    report.covered = out.measure();
    report.share = covered.iter().zip(&lengths).map(|(&c, &l)| if l > T::zero() { (c / l).min(T::one()) } else { T::zero() }).collect();
    out.report = report;
    out
}

/// The arcs of a slave element and the master elements that they face; their ends and feet are finite.
fn arcs<const N: usize, T: Real>(
    sides: &PieceSides<'_, N, T>,
    element: usize,
    work: &mut Work<N, T>,
) -> Result<Vec<(usize, Arc<T>)>, CouplingError> {
    let mut out = Vec::new();
    for (from, to, owner) in sides.pieces(element, work) {
        let Some(owner) = owner else { continue };
        let ends = [from, to].map(Vector::<1, T>::new);
        sides.slave.map(element, &ends, Order::Values, &mut work.slave);
        let x = [work.slave.x[0], work.slave.x[1]];
        if !x.iter().flatten().all(|v| v.is_finite()) {
            return Err(CouplingError::NotFinite { element });
        }
        let mut eta = x.map(|x| {
            // start of Newton's iteration: the nearest of a few points
            sides.master.geometry().map(owner, &work.cuts.samples, Order::Values, &mut work.master);
            let far = |s: usize| (work.master.x[s] - x).norm();
            work.cuts.samples[(1..work.cuts.samples.len()).fold(0, |best, s| if far(s) < far(best) { s } else { best })]
        });
        sides.master.feet(owner, &x, &mut eta, &mut work.master);
        let (a, b) = (eta[0][0], eta[1][0]);
        if !(a.is_finite() && b.is_finite()) {
            return Err(CouplingError::NotFinite { element });
        }
        if (b - a).abs() > lit(POINT) {
            out.push((owner, Arc { slave: element, xi: [from, to], eta: [a.min(b), a.max(b)] }));
        }
    }
    Ok(out)
}

/// The points of a master element: Gauss points of every range that the slave faces without a break.
fn sums<const N: usize, T: Real>(sides: &PieceSides<'_, N, T>, master: usize, arcs: &[Arc<T>], work: &mut Work<N, T>) -> Vec<Summed<T>> {
    let mut arcs = arcs.to_vec();
    // the numbers are finite and so have an order
    arcs.sort_by(|a, b| a.eta[0].partial_cmp(&b.eta[0]).unwrap_or(Ordering::Equal).then(a.slave.cmp(&b.slave)));
    let snapped = |eta: T| {
        let near = |end: T| (eta - end).abs() <= lit(SAME);
        if near(T::zero()) {
            T::zero()
        } else if near(T::one()) {
            T::one()
        } else {
            eta
        }
    };
    let mut out: Vec<Summed<T>> = Vec::new();
    for group in arcs.chunk_by(|a, b| b.eta[0] - a.eta[1] <= lit(SAME)) {
        let (from, to) = (snapped(group[0].eta[0]), snapped(group[group.len() - 1].eta[1]));
        let first = out.len();
        out.extend(group.iter().map(|arc| Summed { slave: arc.slave, points: Vec::new(), farthest: (T::zero(), [0.0; 3]) }));
        let mut found = Vec::new();
        for (point, &weight) in sides.gauss.points.iter().zip(&sides.gauss.weights) {
            let eta = Vector::<1, T>::new(from + (to - from) * point[0]);
            sides.master.geometry().map(master, &[eta], Order::Hessians, &mut work.master);
            let holds = |arc: &Arc<T>| eta[0] >= arc.eta[0] - lit(SAME) && eta[0] <= arc.eta[1] + lit(SAME);
            found.clear();
            for (k, arc) in group.iter().enumerate().filter(|(_, arc)| holds(arc)) {
                let Some((xi, ds, distance)) = partner(sides.slave, arc, &work.master, &mut work.slave) else { continue };
                let piece = &mut out[first + k];
                if distance > piece.farthest.0 {
                    piece.farthest = (distance, place_of(&work.slave.x[0]));
                }
                found.push((k, xi, ds));
            }
            let share = weight * (to - from) / lit(found.len().max(1) as f64);
            found.iter().for_each(|&(k, xi, ds)| out[first + k].points.push((xi, eta, ds * share)));
        }
    }
    out.retain(|piece| !piece.points.is_empty());
    out
}

/// The slave point of an arc that faces the master point in `at`: its coordinate, ds / deta and its distance.
fn partner<const N: usize, T: Real>(
    slave: &dyn Geometry<1, N, T>,
    arc: &Arc<T>,
    at: &MapTable<1, N, T>,
    table: &mut MapTable<1, N, T>,
) -> Option<(Vector<1, T>, T, T)> {
    let (x, tangent) = (at.x[0], Vector::<N, T>::from(at.jacobian[0].column(0)));
    let bend = Vector::<N, T>::from_fn(|i, _| at.hessian[0][i][(0, 0)]);
    let xi = Vector::<1, T>::new(crossing(slave, arc.slave, &x, &tangent, arc.xi, table));
    slave.map(arc.slave, &[xi], Order::Gradients, table);
    let (along, away) = (Vector::<N, T>::from(table.jacobian[0].column(0)), table.x[0] - x);
    let turn = along.dot(&tangent);
    let rate = (tangent.norm_squared() - away.dot(&bend)) / turn;
    let ds = along.norm() * rate.abs();
    (turn != T::zero() && ds.is_finite()).then_some((xi, ds, away.norm()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::BSpline;
    use crate::geometry::{ControlPoints, Oriented};

    /// Straight elements of degree 2 with these ends.
    fn chain(mut ends: Vec<[f64; 2]>, turned: bool) -> ControlPoints<BSpline, 2> {
        if turned {
            ends.reverse();
        }
        let n = ends.len() - 1;
        let at = |k: usize| Vector::<2>::from_fn(|i, _| 0.5 * (ends[k / 2][i] + ends[k.div_ceil(2)][i]));
        ControlPoints { basis: BSpline::uniform(2, n, 0), points: (0..=2 * n).map(at).collect() }
    }

    /// The vertex of two slave elements lies in the middle of a master element, where rules of odd numbers of points have one. Up to rounding it is
    /// beyond one of the slave elements, or both.
    #[test]
    fn points_on_slave_vertices_have_partners_there() {
        for (d, turned) in [0.0, 0.001, 0.1, 0.4, 1.0].into_iter().flat_map(|d| (0..4).map(move |turned| (d, turned))) {
            let [own, other] = [turned % 2 == 1, turned > 1];
            let slave = chain(vec![[1.6 + d, 0.5], [1.8 + d, 0.75], [2.0 + d, 1.0]], own);
            let master = chain((0..=3).map(|k| [1.6 + d + 0.4 * f64::from(k) / 3.0, 0.5 + f64::from(k) / 6.0]).collect(), other);
            let sign = |turned| if turned { -1.0 } else { 1.0 };
            let slave = Oriented { map: slave, outward: vec![-sign(own); 2] };
            let master = Oriented { map: master, outward: vec![sign(other); 3] };
            for points in 3..7 {
                let found = MasterSums::facing(points, None).segments(&slave, &master).unwrap();
                let mut table = MapTable::new();
                let mut moment = 0.0;
                for k in 0..found.num_pieces() {
                    for q in found.points(k) {
                        slave.map(found.slave[k], &[found.slave_xi[q]], Order::Values, &mut table);
                        moment += table.x[0][0] * found.ds[q];
                    }
                }
                let exact = (1.8 + d) * 0.41_f64.sqrt();
                assert!((moment - exact).abs() < 1e-13, "{d} {turned} {points}: {:e}", moment - exact);
            }
        }
    }
}
