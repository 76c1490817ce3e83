//! Numbers of functions across a zone of contact on a surface, in its directions.
//!
//! A function psi_i has the weight m_i = int |psi_i|, the centre c_i and the second moments V_i about it. Over a set of functions, weighted
//! with m_i, let V be the second moments of the centres and W the mean of V_i. B-splines of degree p whose knots are h apart have
//! (p + 1) h^2 / 12, and n of them side by side V = (n^2 - 1) h^2 / 12, so along a direction e
//!
//! ```text
//! n^2 = 1 + (p + 1) (e . V e) / (e . W e)
//! ```
//!
//! Directions are the two in which V + W, the second moments of the zone, is largest. Weights leave to functions that crowd at a pole what
//! they carry.
//!
//! Rings and several strips are wider than what they consist of. A function is inside of the zone if no open one is beside it; along a strip of
//! n >= 2 functions a share f = 1 - 2/n of them is, so that strips have about
//!
//! ```text
//! n = 2 / (1 - f)
//! ```
//!
//! functions across. A disc of n has half of that.

use crate::basis::{Order, ShapeTable};
use crate::contact::ContactRows;
use crate::geometry::MapTable;
use crate::linalg::{Matrix, Vector, measure};
use crate::problem::model::ContactPart;
use crate::quadrature::Quadrature;
use nalgebra::{DMatrix, DVector};
use std::collections::HashMap;

/// Least number of functions across a zone.
pub(super) const FEWEST: usize = 4;
/// Least number across a zone that begins at an end of what faces the opponent; a quarter of a disc has the second moments of a narrower one.
const FEWEST_OF_HALF: usize = 3;

/// Second moments of a zone over those of all that faces, above which the zone does not end in a direction.
const WHOLE: f64 = 0.9;

/// Number of functions across a strip below which it has no inside; of a disc of [`FEWEST`] it is more.
const NO_INSIDE: f64 = 2.4;
/// Distance between the centres of functions side by side, in distances of knots; those across a corner are 1.4 apart.
const BESIDE: f64 = 1.3;
/// Part of the sum of second moments of a function that it has in every direction at least: those of a flat side have none along its normal.
const LEAST_SPREAD: f64 = 0.01;

/// Sums over functions: weight, first and second moments of the centres, own second moments, degrees.
struct ZoneMoments<const N: usize> {
    weight: f64,
    first: Vector<N>,
    second: DMatrix<f64>,
    own: DMatrix<f64>,
    degree: f64,
}

/// Functions of the slave sides of a contact, those that face the opponent and those of them that are closed.
pub(super) struct ZoneExtent<const N: usize> {
    origin: Option<Vector<N>>,
    /// Centres of those that face the opponent, with whether they are closed.
    centres: Vec<(Vector<N>, bool)>,
    /// The closed functions, one by one.
    members: Vec<Member<N>>,
    /// Sums over all that face the opponent.
    facing: ZoneMoments<N>,
    /// Sums over the closed ones.
    closed: ZoneMoments<N>,
}

impl<const N: usize> ZoneMoments<N> {
    fn new() -> Self {
        let none = || DMatrix::zeros(N, N);
        Self { weight: 0.0, first: Vector::zeros(), second: none(), own: none(), degree: 0.0 }
    }

    fn add(&mut self, of: &Function<N>) {
        let centre = of.first / of.weight;
        self.weight += of.weight;
        self.first += of.first;
        self.degree += of.weight * of.degree;
        let square = DMatrix::from_fn(N, N, |i, j| of.weight * centre[i] * centre[j]);
        self.own += &of.second - &square;
        self.second += square;
    }

    /// Second moments of the centres about their mean, and the mean of the functions' own.
    fn moments(&self) -> [DMatrix<f64>; 2] {
        let mean = self.first / self.weight;
        [DMatrix::from_fn(N, N, |i, j| self.second[(i, j)] / self.weight - mean[i] * mean[j]), &self.own / self.weight]
    }
}

/// A closed function: weight and centre, and the matrix G of the distance (d . G d)^1/2 in knots.
struct Member<const N: usize> {
    weight: f64,
    centre: Vector<N>,
    metric: Matrix<N, N>,
    /// Bound of the distance of knots in any direction: that of the trace of the second moments.
    size: f64,
}

impl<const N: usize> Member<N> {
    fn of(of: &Function<N>) -> Option<Self> {
        let centre = of.first / of.weight;
        let own = Matrix::<N, N>::from_fn(|i, j| of.second[(i, j)] / of.weight - centre[i] * centre[j]);
        let square = 12.0 / (of.degree + 1.0) * own.trace();
        let spread = own + Matrix::<N, N>::identity() * (LEAST_SPREAD * own.trace());
        let inverse: DMatrix<f64> = DMatrix::from_fn(N, N, |i, j| spread[(i, j)]).try_inverse()?;
        let metric = Matrix::<N, N>::from_fn(|i, j| inverse[(i, j)] * (of.degree + 1.0) / 12.0);
        Some(Self { weight: of.weight, centre, metric, size: square.sqrt() })
    }
}

/// Weight, first and second moments of a function, and its degree.
struct Function<const N: usize> {
    weight: f64,
    first: Vector<N>,
    second: DMatrix<f64>,
    degree: f64,
}

impl<const N: usize> ZoneExtent<N> {
    pub(super) fn new() -> Self {
        Self { origin: None, centres: Vec::new(), members: Vec::new(), facing: ZoneMoments::new(), closed: ZoneMoments::new() }
    }

    /// Adds the functions of a slave side, or its elements where rows belong to points; `states` says of those that
    /// face the opponent whether they are closed.
    pub(super) fn add<const S: usize>(&mut self, part: &ContactPart<S, N>, rows: &ContactRows<S, N>, states: &[Option<bool>]) {
        let space = &*part.slave.trace.space;
        let psi = part.read_through().filter(|_| rows.row_of_points().is_none());
        let none = || Function { weight: 0.0, first: Vector::zeros(), second: DMatrix::zeros(N, N), degree: 0.0 };
        let mut functions: Vec<Function<N>> = states.iter().map(|_| none()).collect();
        let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
        for e in 0..space.num_elements() {
            let rule = part.slave.rules.rule(e);
            space.map(e, &rule.points, Order::Gradients, &mut map);
            match psi {
                Some(psi) => {
                    psi.active(e, &mut ids);
                    psi.tabulate(e, &rule.points, Order::Values, &mut table);
                }
                None => ids = vec![e],
            }
            let degree = psi.map_or(0, |psi| psi.degree(e).into_iter().max().unwrap_or(0)) as f64;
            for (q, w) in rule.weights.iter().enumerate() {
                let ds = w * measure(&map.jacobian[q]);
                // moments about a point of the side, which keep their digits far from the origin
                let x = map.x[q] - *self.origin.get_or_insert(map.x[q]);
                for (a, &j) in ids.iter().enumerate() {
                    let m = ds * psi.map_or(1.0, |_| table.values(q)[a].abs());
                    let of = &mut functions[j];
                    of.weight += m;
                    of.first += x * m;
                    of.second += DMatrix::from_fn(N, N, |i, k| m * x[i] * x[k]);
                    of.degree = of.degree.max(degree);
                }
            }
        }
        for (of, state) in functions.iter().zip(states).filter(|(of, _)| of.weight > 0.0) {
            let Some(is_closed) = state else { continue };
            self.centres.push((of.first / of.weight, *is_closed));
            self.facing.add(of);
            if *is_closed {
                self.closed.add(of);
                self.members.extend(Member::of(of));
            }
        }
    }

    /// The number of functions across the zone, of the directions in which it ends within what faces the opponent that with the fewest, and how
    /// many there should be; `None` if it ends in neither, or has no area.
    pub(super) fn across(&self) -> Option<(f64, usize)> {
        // decompositions of what is no number need not end
        if !(self.closed.weight > 0.0 && self.facing.weight.is_finite()) {
            return None;
        }
        let ([between, own], [facing, wide]) = (self.closed.moments(), self.facing.moments());
        let degree = self.closed.degree / self.closed.weight;
        let eigen = (&between + &own).symmetric_eigen();
        let mut order: Vec<usize> = (0..N).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let along = |k: &usize| {
            let e: DVector<f64> = eigen.eigenvectors.column(*k).into_owned();
            let of = |m: &DMatrix<f64>| e.dot(&(m * &e));
            let ends = of(&between) + of(&own) < WHOLE * (of(&facing) + of(&wide));
            let least = if self.begins_at_an_end(&e, of(&own).sqrt()) { FEWEST_OF_HALF } else { FEWEST };
            ends.then(|| ((1.0 + (degree + 1.0) * of(&between).max(0.0) / of(&own)).sqrt(), least))
        };
        let few = |(n, least): &(f64, usize)| n / *least as f64;
        order[..2].iter().filter_map(along).filter(|(n, _)| n.is_finite()).min_by(|a, b| few(a).total_cmp(&few(b)))
    }

    /// The number of functions across the strips of which the zone consists, and how many there should be; `None` where they have an inside.
    pub(super) fn across_strips(&self) -> Option<(f64, usize)> {
        let size = self.members.iter().map(|m| m.size).fold(0.0, f64::max) * BESIDE;
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let place = |x: &Vector<N>| -> [i64; N] { std::array::from_fn(|k| (x[k] / size).floor() as i64) };
        let mut open: HashMap<[i64; N], Vec<&Vector<N>>> = HashMap::new();
        self.centres.iter().filter(|(_, closed)| !closed).for_each(|(x, _)| open.entry(place(x)).or_default().push(x));
        let is_inside = |m: &&Member<N>| {
            let at = place(&m.centre);
            let around = (0..3usize.pow(N as u32)).map(|k| std::array::from_fn(|i| at[i] + (k / 3usize.pow(i as u32) % 3) as i64 - 1));
            let mut beside = around.filter_map(|p: [i64; N]| open.get(&p)).flatten();
            !beside.any(|x| {
                let apart = *x - m.centre;
                apart.dot(&(m.metric * apart)) < BESIDE * BESIDE
            })
        };
        let weight = |all: &mut dyn Iterator<Item = &Member<N>>| all.map(|m| m.weight).sum::<f64>();
        let share = weight(&mut self.members.iter().filter(is_inside)) / weight(&mut self.members.iter());
        Some(2.0 / (1.0 - share)).filter(|n| *n < NO_INSIDE).map(|n| (n, FEWEST))
    }

    /// Whether the zone begins where what faces the opponent does, along a direction: half of a zone, at a plane of symmetry or an edge.
    fn begins_at_an_end(&self, along: &DVector<f64>, near: f64) -> bool {
        let range = |all: bool| {
            let at = self.centres.iter().filter(|(_, closed)| all || *closed).map(|(x, _)| (0..N).map(|i| x[i] * along[i]).sum::<f64>());
            at.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], s| [lo.min(s), hi.max(s)])
        };
        let ([lo, hi], [first, last]) = (range(false), range(true));
        lo - first < near || last - hi < near
    }
}
