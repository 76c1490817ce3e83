//! Merged integration on curves: cuts every slave element where its closest point changes the master element.
//!
//! A master vertex V with mean tangent t defines the plane (x - V) . t = 0. A slave element is cut at the roots of
//!
//! ```text
//! φ(xi) = (x_s(xi) - V) . t
//! ```
//!
//! for the vertices near it. On smooth sides this is where the closest point passes V; at a kink it halves the fan of
//! points whose closest point is V. Where both sides have outward signs, partners oppose each other: where only one of the elements that
//! meet in V opposes the slave, that one ends in V, and the cut is at right angles to its own tangent. Each piece is assigned to the master element of its midpoint; where master elements inside
//! a piece are no neighbours (the closest point jumps), bisection finds the jump. Partners are foot points on the continued
//! curve of the assigned element, never clamped, so a cut misplaced by δ costs O(δ²) even between kinked functions.
//! Neighbouring pieces share their cut, so they tile the slave element exactly. Cost: n log n.

use super::cuts::{Cuts, sliver};
use super::pairing::{MasterCurve, size_of};
use super::slave_pieces::{SlavePieces, join};
use super::{InterfaceQuadrature, Partners, Segments, Tolerance};
use crate::basis::Order;
use crate::coupling::CouplingError;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector, lit};
use crate::parallel;
use crate::quadrature::{Rule, gauss_legendre};

/// Bisections of a jump of the closest point.
const JUMP_STEPS: usize = 50;
/// Largest recursion depth of cuts at jumps.
const JUMP_DEPTH: usize = 6;

/// Gauss points on the pieces that both sides share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MergedCurve<T: Real = f64> {
    /// Gauss points per piece; max(p_slave, p_master) + 1 is exact for products of polynomials on straight sides.
    pub points: usize,
    /// Pairing rule.
    pub partners: Partners<T>,
}

impl<T: Real> MergedCurve<T> {
    /// Creates the rule for tied sides that carry the same curve, or approximate it within `tolerance`.
    pub fn tied(points: usize, tolerance: Tolerance<T>) -> Self {
        Self { points, partners: Partners::Touching(tolerance) }
    }

    /// Creates the rule for sides in contact, possibly across a gap of at most `reach` (`None`: the size of the slave side).
    pub fn facing(points: usize, reach: Option<T>) -> Self {
        Self { points, partners: Partners::Facing { reach } }
    }
}

impl<const N: usize, T: Real> InterfaceQuadrature<1, N, T> for MergedCurve<T> {
    fn segments(&self, slave: &dyn Geometry<1, N, T>, master: &dyn Geometry<1, N, T>) -> Result<Segments<1, T>, CouplingError> {
        if master.num_elements() == 0 {
            return Err(CouplingError::NothingFaces);
        }
        let sides = PieceSides::new(slave, master, self.partners, self.points);
        let parts: Vec<SlavePieces<1, T>> = parallel::map_init(slave.num_elements(), Work::new, |work, e| sides.element(e, work));
        join(parts, master, matches!(self.partners, Partners::Touching(_)))
    }
}

/// Both sides and the rule of a piece.
pub(super) struct PieceSides<'a, const N: usize, T: Real> {
    pub slave: &'a dyn Geometry<1, N, T>,
    pub master: MasterCurve<&'a dyn Geometry<1, N, T>, N, T>,
    slave_size: T,
    partners: Partners<T>,
    pub gauss: Rule<1, T>,
}

/// Work arrays of one thread.
pub(super) struct Work<const N: usize, T: Real> {
    pub slave: MapTable<1, N, T>,
    pub master: MapTable<1, N, T>,
    pub cuts: Cuts<N, T>,
    xi: Vec<Vector<1, T>>,
    eta: Vec<Vector<1, T>>,
    near: Vec<T>,
}

impl<const N: usize, T: Real> Work<N, T> {
    pub fn new() -> Self {
        Self { slave: MapTable::new(), master: MapTable::new(), cuts: Cuts::new(), xi: Vec::new(), eta: Vec::new(), near: Vec::new() }
    }
}

/// A piece of a slave element: from, to, and its master element.
pub(super) type ElementPiece<T> = (T, T, Option<usize>);

impl<'a, const N: usize, T: Real> PieceSides<'a, N, T> {
    pub fn new(slave: &'a dyn Geometry<1, N, T>, master: &'a dyn Geometry<1, N, T>, partners: Partners<T>, points: usize) -> Self {
        let slave_size = size_of(slave);
        let gauss = gauss_legendre::<T>(points.max(1));
        Self { slave, master: MasterCurve::new(master, slave_size), slave_size, partners, gauss }
    }

    /// The pieces that tile a slave element.
    pub fn pieces(&self, element: usize, work: &mut Work<N, T>) -> Vec<ElementPiece<T>> {
        work.cuts.at_vertices(self.slave, element, &self.master, self.partners.outward(self.slave, element), &mut work.slave);
        let mut pieces: Vec<ElementPiece<T>> = Vec::new();
        for k in 1..work.cuts.at.len() {
            self.assign(element, work.cuts.at[k - 1], work.cuts.at[k], JUMP_DEPTH, &mut work.slave, &mut pieces);
        }
        // neighbours with the same master element are one piece: this removes needless cuts
        let mut merged: Vec<ElementPiece<T>> = Vec::with_capacity(pieces.len());
        for piece in pieces {
            match merged.last_mut() {
                Some(last) if last.2 == piece.2 => last.1 = piece.1,
                _ => merged.push(piece),
            }
        }
        merged
    }

    fn element(&self, element: usize, work: &mut Work<N, T>) -> SlavePieces<1, T> {
        let mut part = SlavePieces::new(element);
        for piece in self.pieces(element, work) {
            self.integrate(piece, work, &mut part);
        }
        part
    }

    /// Master element paired with `xi`; `None` past the end of the master or beyond the search radius.
    fn owner(&self, element: usize, xi: T, table: &mut MapTable<1, N, T>) -> Option<usize> {
        let outward = self.partners.outward(self.slave, element);
        let place = match outward {
            None => {
                self.slave.map(element, &[Vector::<1, T>::new(xi)], Order::Values, table);
                self.master.place(&table.x[0])
            }
            Some(_) => {
                self.slave.map(element, &[Vector::<1, T>::new(xi)], Order::Gradients, table);
                self.master.faced_place(&table.x[0], &table.jacobian[0].column(0).into_owned(), outward)
            }
        };
        let place = place.filter(|p| self.partners.face(p, self.master.size()))?;
        let (allowed, _) = self.partners.allowed(self.master.size(), self.slave_size, [T::zero(); 2]);
        // for touching sides the distance is checked later, with the lengths of the piece
        (self.partners.touch() || place.distance <= allowed).then_some(place.element)
    }

    /// Appends the pieces of [from, to]: one, or several if the master element jumps inside.
    fn assign(&self, element: usize, from: T, to: T, depth: usize, table: &mut MapTable<1, N, T>, pieces: &mut Vec<ElementPiece<T>>) {
        let width = to - from;
        let probes = [0.5, 0.02, 0.98].map(|t| from + width * lit::<T>(t));
        let middle = self.owner(element, probes[0], table);
        // the closest point of touching sides moves along with the slave and cannot jump
        let touching = self.partners.touch();
        let mut at = |k: usize| if touching { middle } else { self.owner(element, probes[k], table) };
        let owners = [middle, at(1), at(2)];
        let differ = |a: Option<usize>, b: Option<usize>| match (a, b) {
            (Some(a), Some(b)) => !self.master.are_near(a, b),
            (None, None) => false,
            _ => true,
        };
        let jump = if differ(owners[0], owners[1]) {
            Some((probes[1], probes[0], owners[1]))
        } else if differ(owners[0], owners[2]) {
            Some((probes[0], probes[2], owners[0]))
        } else {
            None
        };
        let sliver = sliver::<T>();
        match jump {
            Some((mut lo, mut hi, before)) if depth > 0 && width > sliver * lit(10.0) => {
                for _ in 0..JUMP_STEPS {
                    let middle = (lo + hi) * lit(0.5);
                    if middle <= lo || middle >= hi {
                        break;
                    }
                    if differ(before, self.owner(element, middle, table)) { hi = middle } else { lo = middle }
                }
                let cut = (lo + hi) * lit(0.5);
                if cut - from > sliver && to - cut > sliver {
                    self.assign(element, from, cut, depth - 1, table, pieces);
                    self.assign(element, cut, to, depth - 1, table, pieces);
                } else {
                    pieces.push((from, to, owners[0]));
                }
            }
            _ => pieces.push((from, to, owners[0])),
        }
    }

    /// Computes the Gauss points of a piece and their partners.
    fn integrate(&self, (from, to, owner): ElementPiece<T>, work: &mut Work<N, T>, part: &mut SlavePieces<1, T>) {
        let width = to - from;
        work.xi.clear();
        work.xi.extend(self.gauss.points.iter().map(|p| Vector::<1, T>::new(from + width * p[0])));
        self.slave.map(part.element, &work.xi, Order::Gradients, &mut work.slave);
        let ds = |q: usize| work.slave.jacobian[q].column(0).norm() * self.gauss.weights[q] * width;
        let measure = (0..work.xi.len()).fold(T::zero(), |s, q| s + ds(q));
        part.measure += measure;
        let Some(owner) = owner else { return };
        work.eta.clear();
        // starting points: the closest of a few points of the master element, found without a search
        self.master.geometry().map(owner, &work.cuts.samples, Order::Values, &mut work.master);
        work.near.clear();
        for x in &work.slave.x {
            let far = |s: usize| (work.master.x[s] - x).norm();
            let nearest = (1..work.cuts.samples.len()).fold(0, |best, s| if far(s) < far(best) { s } else { best });
            work.eta.push(work.cuts.samples[nearest]);
            work.near.push(far(nearest));
        }
        self.master.feet(owner, &work.slave.x, &mut work.eta, &mut work.master);
        let lengths = [chords(&work.cuts.x), self.master.chain().lengths[owner]];
        let (allowed, _) = self.partners.allowed(self.master.size(), self.slave_size, lengths);
        // on strongly curved elements these are too few: Newton's method may diverge, or end at another foot
        let (mut again, outward) = (false, self.partners.outward(self.slave, part.element));
        for (q, x) in work.slave.x.iter().enumerate() {
            let distance = (x - work.master.x[q]).norm();
            let is_foot = distance <= work.near[q] && (distance <= allowed || !self.partners.touch());
            let own = || self.master.faced_place(x, &work.slave.jacobian[q].column(0).into_owned(), outward);
            if !is_foot && let Some(place) = own().filter(|p| p.element == owner) {
                (work.eta[q][0], again) = (place.xi, true);
            }
        }
        if again {
            self.master.feet(owner, &work.slave.x, &mut work.eta, &mut work.master);
        }
        let distance = |(x, y): (&Vector<N, T>, &Vector<N, T>)| (x - y).norm();
        let pairs = || work.slave.x.iter().zip(&work.master.x);
        if matches!(self.partners, Partners::Near(_)) && pairs().any(|p| distance(p) > allowed) {
            return;
        }
        part.covered += measure;
        pairs().for_each(|p| part.see(p.0, distance(p), allowed));
        let points = (0..work.xi.len()).map(|q| (work.xi[q], work.eta[q], ds(q))).collect();
        part.pieces.push((owner, points));
    }
}

/// Length of the polygon through `x`.
fn chords<const N: usize, T: Real>(x: &[Vector<N, T>]) -> T {
    x.windows(2).fold(T::zero(), |s, w| s + (w[1] - w[0]).norm())
}
