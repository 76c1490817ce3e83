//! Merging two grids of one curve: random pairs tile it, the closest point is the closest, the work grows with the elements.
//!
//! `FAYING_MERGING=10000` takes that many pairs of grids; a fixed sample of them otherwise.

use faying::basis::{Elements, Order};
use faying::coupling::InterfaceQuadrature;
use faying::coupling::interface::{MergedCurve, SlaveRule, Tolerance};
use faying::geometry::{Bounds, ClosestPoint, Geometry, MapTable};
use faying::linalg::Vector;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// SplitMix64: the same numbers on every machine.
#[derive(Clone, Debug)]
struct Dice(u64);

impl Dice {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.number()
    }

    fn below(&mut self, n: usize) -> usize {
        (self.number() * n as f64) as usize
    }
}

/// A curve by its rational Bezier points; a straight line and an arc are such curves.
#[derive(Clone, Debug)]
struct Bezier {
    points: Vec<Vector<2>>,
    weights: Vec<f64>,
}

impl Bezier {
    fn line() -> Self {
        Self { points: vec![Vector::<2>::new(0.3, 0.1), Vector::<2>::new(2.3, -0.9)], weights: vec![1.0, 1.0] }
    }

    /// 120 degrees of a circle of radius 1.5.
    fn arc() -> Self {
        let a = std::f64::consts::FRAC_PI_3;
        let at = |angle: f64, r: f64| Vector::<2>::new(r * angle.cos(), r * angle.sin());
        Self { points: vec![at(0.0, 1.5), at(a, 1.5 / a.cos()), at(2.0 * a, 1.5)], weights: vec![1.0, a.cos(), 1.0] }
    }

    /// A free form of degree 2 to 5 over the x axis: waves and weights at random.
    fn free(dice: &mut Dice) -> Self {
        let p = 2 + dice.below(4);
        let points = (0..=p).map(|k| Vector::<2>::new(k as f64 / p as f64, dice.between(-0.4, 0.4))).collect();
        Self { points, weights: (0..=p).map(|_| dice.between(0.4, 2.5)).collect() }
    }

    /// x, x', x'' at t by homogeneous coordinates and de Casteljau's scheme.
    fn at(&self, t: f64) -> [Vector<2>; 3] {
        let (p, n) = (self.points.len() - 1, (self.points.len() - 1) as f64);
        let mut c = [[0.0; 3]; 9];
        for (c, (x, &w)) in c.iter_mut().zip(self.points.iter().zip(&self.weights)) {
            *c = [x[0] * w, x[1] * w, w];
        }
        let (mut first, mut second) = ([0.0; 3], [0.0; 3]);
        for level in (1..=p).rev() {
            if level == 2 {
                second = std::array::from_fn(|k| n * (n - 1.0) * (c[2][k] - 2.0 * c[1][k] + c[0][k]));
            }
            if level == 1 {
                first = std::array::from_fn(|k| n * (c[1][k] - c[0][k]));
            }
            for i in 0..level {
                c[i] = std::array::from_fn(|k| (1.0 - t) * c[i][k] + t * c[i + 1][k]);
            }
        }
        let value = c[0];
        let x = Vector::<2>::new(value[0], value[1]) / value[2];
        let d = (Vector::<2>::new(first[0], first[1]) - x * first[2]) / value[2];
        let dd = (Vector::<2>::new(second[0], second[1]) - d * (2.0 * first[2]) - x * second[2]) / value[2];
        [x, d, dd]
    }
}

/// Elements of a curve between breakpoints s, at t = s + bend s (1 - s): its own parametrisation.
#[derive(Debug)]
struct Side {
    curve: Bezier,
    bend: f64,
    breakpoints: Vec<f64>,
    reversed: bool,
    points: AtomicUsize,
}

impl Side {
    fn new(curve: &Bezier, bend: f64, breakpoints: Vec<f64>, reversed: bool) -> Self {
        Self { curve: curve.clone(), bend, breakpoints, reversed, points: AtomicUsize::new(0) }
    }

    /// From and to of an element in s.
    fn interval(&self, element: usize) -> [f64; 2] {
        let n = self.breakpoints.len() - 1;
        if self.reversed {
            [self.breakpoints[n - element], self.breakpoints[n - element - 1]]
        } else {
            [self.breakpoints[element], self.breakpoints[element + 1]]
        }
    }

    /// The common parameter of s.
    fn common(&self, s: f64) -> f64 {
        s + self.bend * s * (1.0 - s)
    }
}

impl Elements for Side {
    fn num_elements(&self) -> usize {
        self.breakpoints.len() - 1
    }
}

impl Geometry<1, 2> for Side {
    fn map(&self, element: usize, xi: &[Vector<1>], order: Order, table: &mut MapTable<1, 2>) {
        self.points.fetch_add(xi.len(), Ordering::Relaxed);
        let [a, b] = self.interval(element);
        table.reset(xi.len(), order);
        for (q, xi) in xi.iter().enumerate() {
            let s = a + (b - a) * xi[0];
            let (dt, ddt) = ((1.0 + self.bend * (1.0 - 2.0 * s)) * (b - a), -2.0 * self.bend * (b - a) * (b - a));
            let [x, d, dd] = self.curve.at(self.common(s));
            table.x[q] = x;
            if order >= Order::Gradients {
                table.jacobian[q].set_column(0, &(d * dt));
            }
            if order >= Order::Hessians {
                let second = dd * (dt * dt) + d * ddt;
                (0..2).for_each(|i| table.hessian[q][i][(0, 0)] = second[i]);
            }
        }
    }

    fn bounds(&self, element: usize) -> Bounds<2> {
        let mut table = MapTable::new();
        let points: Vec<Vector<1>> = (0..=8).map(|k| Vector::<1>::new(k as f64 / 8.0)).collect();
        self.map(element, &points, Order::Values, &mut table);
        let b = Bounds::around(&table.x).unwrap();
        b.inflated(0.1 * b.diagonal())
    }
}

/// A grid of [0, 1]: uniform, random, or graded over three decades.
fn grid(dice: &mut Dice, n: usize) -> Vec<f64> {
    let kind = dice.below(3);
    let mut at = vec![0.0];
    for _ in 0..n {
        let size = match kind {
            0 => 1.0,
            1 => dice.between(0.05, 1.0),
            _ => 10f64.powf(dice.between(-3.0, 0.0)),
        };
        at.push(at.last().unwrap() + size);
    }
    let whole = at[n];
    at.iter_mut().for_each(|t| *t /= whole);
    at
}

/// A pair of sides on one curve.
fn pair(number: usize) -> [Side; 2] {
    let mut dice = Dice(0x5EED + 7919 * number as u64);
    let curve = match dice.below(3) {
        0 => Bezier::line(),
        1 => Bezier::arc(),
        _ => Bezier::free(&mut dice),
    };
    let count = |dice: &mut Dice| 10f64.powf(dice.between(0.0, 1.6)) as usize;
    let mut counts = [count(&mut dice), count(&mut dice)];
    // one in fifty: a thousand elements on a few
    if number % 50 == 7 {
        counts = [1 + dice.below(2), 1000];
    } else if number % 50 == 8 {
        counts = [1000, 1 + dice.below(2)];
    }
    let grids = counts.map(|n| grid(&mut dice, n));
    let bends = if dice.below(2) == 0 { [0.0; 2] } else { [dice.between(-0.5, 0.5), dice.between(-0.5, 0.5)] };
    let turns = [dice.below(2) == 0, dice.below(2) == 0];
    let [a, b] = grids;
    [Side::new(&curve, bends[0], a, turns[0]), Side::new(&curve, bends[1], b, turns[1])]
}

/// (slave element, master element, share of the slave element) of all overlaps, from the parameters alone.
fn overlaps(slave: &Side, master: &Side) -> Vec<(usize, usize, f64)> {
    let intervals = |side: &Side| -> Vec<(f64, f64, usize)> {
        let mut list: Vec<_> = (0..side.num_elements())
            .map(|e| {
                let [a, b] = side.interval(e).map(|s| side.common(s));
                (a.min(b), a.max(b), e)
            })
            .collect();
        list.sort_by(|a, b| a.partial_cmp(b).unwrap());
        list
    };
    let (own, other) = (intervals(slave), intervals(master));
    let (mut i, mut j, mut found) = (0, 0, Vec::new());
    while i < own.len() && j < other.len() {
        let (lo, hi) = (own[i].0.max(other[j].0), own[i].1.min(other[j].1));
        if hi > lo {
            found.push((own[i].2, other[j].2, (hi - lo) / (own[i].1 - own[i].0)));
        }
        if own[i].1 <= other[j].1 { i += 1 } else { j += 1 }
    }
    found.sort_by_key(|f| (f.0, f.1));
    found
}

/// Pieces this small, as a share of the slave element, may join their neighbour.
const SLIVER: f64 = 1e-9;
/// Largest distance of partners, as a share of the size.
const APART: f64 = 1e-13;

/// What is wrong with the segments of a pair of sides, if anything, and how many there are.
fn check(sides: &[Side; 2], rule: &dyn InterfaceQuadrature<1, 2>, merged: bool) -> Result<usize, String> {
    let [slave, master] = sides;
    let s = rule.segments(slave, master).map_err(|e| e.to_string())?;
    let (mut here, mut there) = (MapTable::new(), MapTable::new());
    let (mut tiled, mut apart) = (vec![0.0; slave.num_elements()], 0.0f64);
    for piece in 0..s.num_pieces() {
        let points = s.points(piece);
        slave.map(s.slave[piece], &s.slave_xi[points.clone()], Order::Gradients, &mut here);
        master.map(s.master[piece], &s.master_xi[points.clone()], Order::Values, &mut there);
        for (k, q) in points.enumerate() {
            // the measure in the slave's own coordinate is free of the curve's quadrature error
            tiled[s.slave[piece]] += s.ds[q] / here.jacobian[k].column(0).norm();
            apart = apart.max((here.x[k] - there.x[k]).norm());
            if s.master_xi[q][0] < -1e-7 || s.master_xi[q][0] > 1.0 + 1e-7 {
                return Err(format!("a point of slave element {} lies outside master element {}", s.slave[piece], s.master[piece]));
            }
        }
    }
    if let Some((e, sum)) = tiled.iter().enumerate().find(|t| (t.1 - 1.0).abs() > 1e-12) {
        return Err(format!("slave element {e} is tiled {sum} times"));
    }
    if apart > APART * 3.0 {
        return Err(format!("partners are {apart:e} apart"));
    }
    if !merged {
        return Ok(s.num_pieces());
    }
    let mut found: Vec<(usize, usize)> = s.slave.iter().copied().zip(s.master.iter().copied()).collect();
    found.sort_unstable();
    if found.windows(2).any(|w| w[0] == w[1]) {
        return Err("a segment is doubled".into());
    }
    let expected = overlaps(slave, master);
    if let Some(lost) = expected.iter().find(|o| o.2 > SLIVER && found.binary_search(&(o.0, o.1)).is_err()) {
        return Err(format!("segment {lost:?} is lost"));
    }
    if let Some(extra) = found.iter().find(|f| expected.binary_search_by_key(*f, |o| (o.0, o.1)).is_err()) {
        let share = (0..s.num_pieces()).filter(|&k| (s.slave[k], s.master[k]) == *extra).map(|k| {
            let xi = &s.slave_xi[s.points(k)];
            (xi[xi.len() - 1][0] - xi[0][0]).abs()
        });
        let share: f64 = share.sum();
        if share > SLIVER {
            return Err(format!("segment {extra:?} does not exist, share {share:e}"));
        }
    }
    Ok(s.num_pieces())
}

#[test]
fn random_pairs_of_grids_tile_their_curve_without_lost_or_doubled_segments() {
    let count: usize = std::env::var("FAYING_MERGING").ok().and_then(|v| v.parse().ok()).unwrap_or(800);
    let (total, worst) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let failures: Vec<String> = (0..count)
        .into_par_iter()
        .filter_map(|number| {
            let sides = pair(number);
            let counts = [sides[0].num_elements(), sides[1].num_elements()];
            worst.fetch_max(counts[0].max(counts[1]) / counts[0].min(counts[1]), Ordering::Relaxed);
            let merged = check(&sides, &MergedCurve::tied(3, Tolerance::Exact), true);
            let slave = check(&sides, &SlaveRule::tied(3, Tolerance::Exact), false);
            match (merged, slave) {
                (Ok(n), Ok(_)) => {
                    total.fetch_add(n, Ordering::Relaxed);
                    None
                }
                (a, b) => Some(format!("pair {number} {counts:?}: merged {a:?}, slave {b:?}")),
            }
        })
        .collect();
    println!(
        "merging ends {{ pairs: {count}, segments: {}, largest ratio: {}, failed: {} }}",
        total.into_inner(),
        worst.into_inner(),
        failures.len()
    );
    assert!(failures.is_empty(), "{} of {count} fail:\n{}", failures.len(), failures[..failures.len().min(20)].join("\n"));
}

// Shifts of the size of round-off make slivers; none is lost, doubled or given away.
#[test]
fn grids_that_nearly_coincide_tile_their_curve() {
    let mut shifts = vec![0.0];
    (1..=16).for_each(|k| shifts.extend([10f64.powi(-k), -(10f64.powi(-k))]));
    let mut dice = Dice(11);
    let curves = [Bezier::line(), Bezier::arc(), Bezier::free(&mut dice), Bezier::free(&mut dice)];
    for curve in &curves {
        for &shift in &shifts {
            for turns in [[false, false], [false, true], [true, false]] {
                let own: Vec<f64> = (0..=8).map(|k| k as f64 / 8.0).collect();
                let other = own
                    .iter()
                    .enumerate()
                    .map(|(k, t)| if k % 8 == 0 { *t } else { t + shift * if k % 3 == 0 { -0.5 } else { 0.6 } })
                    .collect();
                let sides = [Side::new(curve, 0.0, own, turns[0]), Side::new(curve, 0.0, other, turns[1])];
                let found = check(&sides, &MergedCurve::tied(4, Tolerance::Exact), true);
                assert!(found.as_ref().is_ok_and(|n| (8..=16).contains(n)), "shift {shift:e} {turns:?}: {found:?}");
            }
        }
    }
}

/// The least distance by dense samples and golden sections around the best of them.
fn brute_force(side: &Side, x: &Vector<2>) -> f64 {
    let samples = 2000;
    let distance = |t: f64| (side.curve.at(t)[0] - x).norm();
    let all: Vec<f64> = (0..=samples).map(|k| distance(k as f64 / samples as f64)).collect();
    let mut best = f64::INFINITY;
    for k in 0..=samples {
        if (k == 0 || all[k] <= all[k - 1]) && (k == samples || all[k] <= all[k + 1]) {
            let (mut lo, mut hi) = (k.saturating_sub(1) as f64 / samples as f64, (k + 1).min(samples) as f64 / samples as f64);
            for _ in 0..60 {
                let (a, b) = (lo + 0.381966 * (hi - lo), hi - 0.381966 * (hi - lo));
                if distance(a) < distance(b) { hi = b } else { lo = a }
            }
            best = best.min(distance(0.5 * (lo + hi))).min(all[k]);
        }
    }
    best
}

// Newton's method from samples alone finds a local minimum now and then; the bound on the curvature must not let it.
#[test]
fn closest_points_of_wild_rational_curves_are_the_closest() {
    let count: usize = std::env::var("FAYING_MERGING").ok().and_then(|v| v.parse().ok()).unwrap_or(300);
    let failures: Vec<String> = (0..count)
        .into_par_iter()
        .flat_map_iter(|number| {
            let mut dice = Dice(0xC105E57 + 104_729 * number as u64);
            let p = 2 + dice.below(7);
            let points = (0..=p).map(|_| Vector::<2>::new(dice.between(-1.0, 1.0), dice.between(-1.0, 1.0))).collect();
            // a tenth of the control polygon's corners pull a hundred times as much as others
            let weights = (0..=p).map(|_| 10f64.powf(dice.between(-1.0, 1.0))).collect();
            let n = 1 + dice.below(6);
            let side = Side::new(&Bezier { points, weights }, 0.0, grid(&mut dice, n), false);
            let closest = ClosestPoint::<1, 2, _>::new(&side);
            let mut wrong = Vec::new();
            for _ in 0..4 {
                let x = Vector::<2>::new(dice.between(-1.5, 1.5), dice.between(-1.5, 1.5));
                let (found, expected) = (closest.project(&x).unwrap().distance, brute_force(&side, &x));
                if found > expected + 1e-9 {
                    wrong.push(format!("curve {number} of degree {p} in {n}: {found} for {expected}"));
                }
            }
            wrong
        })
        .collect();
    assert!(failures.is_empty(), "{} wrong:\n{}", failures.len(), failures[..failures.len().min(20)].join("\n"));
}

// Evaluations are counted, not time: per element they stay the same from a thousand to a hundred thousand elements.
#[test]
fn the_work_per_element_does_not_grow_with_the_number_of_elements() {
    let mut dice = Dice(3);
    for (curve, largest) in [(Bezier::line(), 10_000), (Bezier::arc(), 10_000), (Bezier::free(&mut dice), 100_000)] {
        let per_element = |n: usize| {
            let uniform = |n: usize| (0..=n).map(|k| k as f64 / n as f64).collect();
            let sides = [Side::new(&curve, 0.0, uniform(n), false), Side::new(&curve, 0.3, uniform(n * 2 / 3), true)];
            let s = MergedCurve::tied(2, Tolerance::Exact).segments(&sides[0], &sides[1]).unwrap();
            let work = sides.iter().map(|s| s.points.load(Ordering::Relaxed)).sum::<usize>() as f64 / s.num_pieces() as f64;
            assert!((s.num_pieces() as f64 / n as f64 - 5.0 / 3.0).abs() < 0.01, "{} pieces", s.num_pieces());
            work
        };
        let work = [1_000, 10_000, largest].map(per_element);
        println!("evaluations per segment: {work:.1?} of 1e3, 1e4, {largest} elements");
        assert!(work.iter().all(|w| *w < 1.2 * work[0]), "{work:?}");
    }
}
