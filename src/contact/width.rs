//! Contact half-width along one side, or along several consecutive sides.
//!
//! Each function carries pressure or not, so the zone of the active functions ends between elements. The true end a follows from the
//! moments of the pressure's tail, which equilibrium keeps accurate even if single values are not. With s_0 the element boundary nearest
//! to 3.5 sqrt(n) elements before the end, n of them between the middle of the zone and its end, and never before the middle, a and g are
//! such that
//!
//!   ∫ p (s - s_0)^k ds / ∫ p ds over s > s_0   =   the same of sqrt(1 - x²) (1 + g x),   k = 1, 2
//!
//! where x runs from -1 at the other end b to 1 at a: between smooth bodies the pressure ends like a square root; Hertz has g = 0, which is
//! also used if no such pressure is positive. If the zone ends at a corner or an edge of the slave or of its opponent, a is that point, and
//! b its mirror image there. The result lies within one element of the end of the functions' zone.
//!
//! A half cylinder on a plane (a/R from 0.008 to 0.020, degrees 2 and 3, p/p and p/p-2): errors of a below 1 %, of the functions' zone
//! from -9.1 to 7.2 %.

use super::Contact;
use super::curves::Curves;
use crate::basis::Order;
use crate::coupling::interface::Chain;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector, lit, measure, num};
use crate::quadrature::{Rule, gauss_legendre};

/// Relative size of the pressure up to which it is zero: round-off of Nitsche's method and of soft rows.
const NO_PRESSURE: f64 = 1e-6;
/// Elements of a tail over the square root of their number from the middle of the zone to its end: shorter tails deviate less from the
/// pressure of the model, longer ones average out more of the noise of single elements.
const TAIL: f64 = 3.5;
/// Points closer than this fraction of an element coincide.
const SAME_PLACE: f64 = 1e-6;
/// Gauss points of an arc length.
const POINTS: usize = 8;
/// Fixed-point iterations for both ends, which depend on each other; each gains more than a digit.
const ROUNDS: usize = 12;
/// Bisections of an end.
const BISECTIONS: usize = 60;
/// Search interval of the tail's length relative to that of an ellipse, and its number of subintervals.
const AROUND: [f64; 2] = [0.75, 1.35];
const STEPS: usize = 48;
/// Difference of second moments, over the square of the half width, below which they are equal.
const NO_MISS: f64 = 1e-6;

/// A slave side with its contact, the points of it that are closed, and the pressure there.
#[derive(Clone, Copy, Debug)]
pub struct ClosedSide<'a, const N: usize, T: Real = f64> {
    /// The side.
    pub slave: &'a dyn Geometry<1, N, T>,
    /// Its rows and points.
    pub contact: &'a Contact<1, N, T>,
    /// Whether each point of the segments lies in the closed zone, as in [`super::Transmitted`].
    pub closed: &'a [bool],
    /// The pressure at each of them [force/area].
    pub pressure: &'a [T],
}

/// Returns half the extent of the contact zone along the slave sides, an arc length \[length\]; zero if nothing is in contact.
///
/// Sides that meet are one curve: a joint between them is no end. Of curves that do not meet the widest zone counts. All pressed
/// stretches of one curve are one zone; on a closed curve it is the complement of the widest open stretch. With `symmetry` a zone that
/// ends at an end of the curve is mirrored there, so that its extent is half of the whole.
pub fn half_width<const N: usize, T: Real>(sides: &[ClosedSide<'_, N, T>], symmetry: bool) -> T {
    let joined = Curves { elements: sides.iter().flat_map(|s| (0..s.slave.num_elements()).map(|e| (s.slave, e))).collect() };
    let chain = Chain::of(&joined);
    let sections = Section::all(sides, &joined, &chain);
    let walk = chain.walk();
    let (mut widest, mut first) = (T::zero(), 0);
    for k in 0..walk.len() {
        let (element, reversed) = walk[k];
        let next = chain.neighbour(element, usize::from(!reversed)).map(|(e, _)| e);
        if k + 1 < walk.len() && next == Some(walk[k + 1].0) {
            continue;
        }
        let mut curve = walk[first..=k].to_vec();
        let is_loop = chain.neighbour(curve[0].0, usize::from(curve[0].1)).is_some();
        if is_loop {
            let start = amid_widest_open(&sections, &curve);
            curve.rotate_left(start);
        }
        widest = widest.max(Unrolled::of(&sections, &curve).half_width(symmetry && !is_loop));
        first = k + 1;
    }
    widest
}

/// Position in the walk along a closed curve in the middle of its widest stretch of elements that are not pressed.
fn amid_widest_open<T: Real>(sections: &[Section<T>], curve: &[(usize, bool)]) -> usize {
    let n = curve.len();
    let of = |k: usize| &sections[curve[k % n].0];
    let Some(start) = (0..n).find(|&k| of(k).is_pressed()) else { return 0 };
    let (mut best, mut most, mut begin, mut length) = (start, T::zero(), start, T::zero());
    for k in start..=start + n {
        if of(k).is_pressed() {
            if length > most {
                (best, most) = ((begin + k) / 2, length);
            }
            (begin, length) = (k + 1, T::zero());
        } else {
            length += of(k).length;
        }
    }
    best % n
}

/// A point of the segments.
#[derive(Clone, Copy, Debug)]
struct Point<T: Real> {
    /// Arc length.
    s: T,
    /// p ds.
    force: T,
    /// Whether it lies in the zone of the functions.
    pressed: bool,
}

/// A piece of the segments: the stretch that it covers, and its points in order.
#[derive(Clone, Debug)]
struct Piece<T: Real> {
    from: T,
    to: T,
    points: Vec<Point<T>>,
}

/// An element: its length, and the pieces of it that face the opponent, in order.
#[derive(Clone, Debug)]
struct Section<T: Real> {
    length: T,
    pieces: Vec<Piece<T>>,
}

impl<T: Real> Section<T> {
    /// All elements, with arc lengths from their local starts; elements without pressure whose neighbours have none either get no pieces.
    fn all<const N: usize>(sides: &[ClosedSide<'_, N, T>], curve: &dyn Geometry<1, N, T>, chain: &Chain<N, T>) -> Vec<Self> {
        let none = sides.iter().flat_map(|s| s.pressure).fold(T::zero(), |m, p| m.max(*p)) * lit(NO_PRESSURE);
        let mut arc = Arc { curve, rule: gauss_legendre(POINTS), map: MapTable::new() };
        let n = curve.num_elements();
        let mut all: Vec<Self> = (0..n).map(|e| Self { length: arc.to(e, T::one()), pieces: Vec::new() }).collect();
        // (side, piece, element of the curve)
        let (mut pieces, mut carries, mut base) = (Vec::new(), vec![false; n], 0);
        for side in sides {
            let segments = &side.contact.segments;
            for piece in 0..segments.num_pieces() {
                let element = base + segments.slave[piece];
                carries[element] |= segments.points(piece).any(|q| side.pressure[q] != T::zero());
                pieces.push((side, piece, element));
            }
            base += side.slave.num_elements();
        }
        let beside = |e: usize| (0..2).any(|end| chain.neighbour(e, end).is_some_and(|(other, _)| carries[other]));
        for (side, piece, element) in pieces.into_iter().filter(|&(_, _, e)| carries[e] || beside(e)) {
            let segments = &side.contact.segments;
            let (mut points, mut whole, mut moment) = (Vec::new(), T::zero(), T::zero());
            for q in segments.points(piece) {
                let (s, p, ds) = (arc.to(element, segments.slave_xi[q][0]), side.pressure[q], segments.ds[q]);
                points.push(Point { s, force: p * ds, pressed: side.closed[q] && p > none });
                whole += ds;
                moment += s * ds;
            }
            if whole > T::zero() {
                points.sort_by(|a, b| order(a.s, b.s));
                // the centroid of a rule that integrates arc lengths exactly is the midpoint
                let (middle, half) = (moment / whole, whole * lit(0.5));
                all[element].pieces.push(Piece { from: middle - half, to: middle + half, points });
            }
        }
        all.iter_mut().for_each(|s| s.pieces.sort_by(|a, b| order(a.from, b.from)));
        all
    }

    fn is_pressed(&self) -> bool {
        self.pieces.iter().flat_map(|p| &p.points).any(|p| p.pressed)
    }

    /// Returns the section shifted to `start + s`, or to `start - s` if it is walked backwards.
    fn placed(&self, start: T, backwards: bool) -> Self {
        let at = |s: T| if backwards { start - s } else { start + s };
        let mut pieces: Vec<Piece<T>> = self.pieces.clone();
        for piece in &mut pieces {
            piece.points.iter_mut().for_each(|p| p.s = at(p.s));
            (piece.from, piece.to) = (at(piece.from), at(piece.to));
            if backwards {
                piece.points.reverse();
                std::mem::swap(&mut piece.from, &mut piece.to);
            }
        }
        if backwards {
            pieces.reverse();
        }
        Self { length: self.length, pieces }
    }
}

fn order<T: Real>(a: T, b: T) -> std::cmp::Ordering {
    a.partial_cmp(&b).unwrap_or(std::cmp::Ordering::Equal)
}

/// Arc lengths within elements.
struct Arc<'a, const N: usize, T: Real> {
    curve: &'a dyn Geometry<1, N, T>,
    rule: Rule<1, T>,
    map: MapTable<1, N, T>,
}

impl<const N: usize, T: Real> Arc<'_, N, T> {
    /// Arc length from the local start of `element` to `xi`.
    fn to(&mut self, element: usize, xi: T) -> T {
        let points: [Vector<1, T>; POINTS] = std::array::from_fn(|q| self.rule.points[q] * xi);
        self.curve.map(element, &points, Order::Gradients, &mut self.map);
        self.map.jacobian.iter().zip(&self.rule.weights).fold(T::zero(), |sum, (j, &w)| sum + w * xi * measure(j))
    }
}

/// A curve from end to end.
struct Unrolled<T: Real> {
    /// Start of every element, and the end of the last.
    starts: Vec<T>,
    sections: Vec<Section<T>>,
}

/// End of the zone of the active functions towards the end of the curve.
struct End<T: Real> {
    /// Last pressed element, and the first of the consecutive pressed elements up to it.
    last: usize,
    first: usize,
    /// Arc length at which their pieces end.
    at: T,
    /// Whether the part of the slave that faces the opponent ends there.
    is_corner: bool,
    /// Whether it is the end of the curve.
    of_curve: bool,
    /// Bounds of the true end: one element to either side, and no further than what faces the opponent.
    between: [T; 2],
}

/// The pressure behind an element boundary.
struct Tail<T: Real> {
    /// The boundary.
    begin: T,
    /// ∫ p (s - begin) ds / ∫ p ds.
    mean: T,
    /// ∫ p (s - begin)² ds / ∫ p ds.
    square: T,
}

impl<T: Real> Unrolled<T> {
    fn of(sections: &[Section<T>], curve: &[(usize, bool)]) -> Self {
        let mut starts = vec![T::zero()];
        let mut placed = Vec::with_capacity(curve.len());
        for &(element, reversed) in curve {
            let (section, start) = (&sections[element], starts[starts.len() - 1]);
            starts.push(start + section.length);
            placed.push(section.placed(if reversed { start + section.length } else { start }, reversed));
        }
        Self { starts, sections: placed }
    }

    /// Returns the curve seen from the other end: s becomes -s.
    fn mirrored(&self) -> Self {
        let starts = self.starts.iter().rev().map(|&s| -s).collect();
        Self { starts, sections: self.sections.iter().rev().map(|s| s.placed(T::zero(), true)).collect() }
    }

    /// End of the zone; `None` if nothing is pressed.
    fn end(&self) -> Option<End<T>> {
        let last = (0..self.sections.len()).rev().find(|&k| self.sections[k].is_pressed())?;
        let first = (0..last).rev().find(|&k| !self.sections[k].is_pressed()).map_or(0, |k| k + 1);
        let pieces = &self.sections[last].pieces;
        let k = (0..pieces.len()).rev().find(|&k| pieces[k].points.iter().any(|p| p.pressed))?;
        let same = self.sections[last].length * lit(SAME_PLACE);
        let (at, end) = (pieces[k].to, self.starts[self.starts.len() - 1]);
        let next = pieces.get(k + 1).or_else(|| self.sections.get(last + 1).and_then(|s| s.pieces.first()));
        let goes_on = next.is_some_and(|next| next.from <= at + same);
        let is_corner = !goes_on && pieces[k].points.last().is_some_and(|p| p.pressed);
        // no further than what faces the opponent without a break, in this element and the next
        let following = pieces[k + 1..].iter().chain(self.sections.get(last + 1).into_iter().flat_map(|s| &s.pieces));
        let most = following.take_while(|_| goes_on).fold(at, |to, piece| if piece.from <= to + same { piece.to } else { to });
        let between = [at - self.sections[last].length, most.min(end)];
        Some(End { last, first, at, is_corner, of_curve: is_corner && at >= end - same, between })
    }

    /// Moments of the pressure beyond the element boundary at which the tail begins; `None` unless force and moment are positive.
    fn tail(&self, end: &End<T>, middle: T) -> Option<Tail<T>> {
        let half = (end.first..=end.last).filter(|&k| self.starts[k + 1] > middle).count();
        let wanted = middle + (end.at - middle) * lit((1.0 - TAIL / (half as f64).sqrt()).max(0.0));
        let same = (end.at - middle).abs() * lit(SAME_PLACE);
        let mut k = end.first;
        // the first of two at equal distance; a single element has no information about the end within it
        while k + 1 < end.last && (self.starts[k + 1] - wanted).abs() + same < (self.starts[k] - wanted).abs() {
            k += 1;
        }
        let begin = self.starts[k];
        let points = self.sections[k..].iter().flat_map(|s| &s.pieces).flat_map(|p| &p.points);
        let [force, moment, square] = points.fold([T::zero(); 3], |[f, m, s], p| {
            let arm = p.s - begin;
            [f + p.force, m + p.force * arm, s + p.force * arm * arm]
        });
        (force > T::zero() && moment > T::zero()).then(|| Tail { begin, mean: moment / force, square: square / force })
    }

    /// Half the extent of the zone, or all of it if it ends at an end of the curve and `symmetry` continues it there.
    fn half_width(&self, symmetry: bool) -> T {
        let mirrored = self.mirrored();
        let (Some(right), Some(left)) = (self.end(), mirrored.end()) else { return T::zero() };
        let (mut a, mut b) = (right.at, -left.at);
        // one stretch, whose two ends depend on each other; or several
        let is_one = right.first + left.last + 1 == self.sections.len();
        let middle = |corner: bool, end: T, other: T| if corner { other } else { (end + other) * lit(0.5) };
        let [from_left, from_right] = if is_one { [b, -a] } else { [self.starts[right.first], mirrored.starts[left.first]] };
        let (left_corner, right_corner) = (is_one && left.is_corner, is_one && right.is_corner);
        let tails = [
            self.tail(&right, middle(left_corner, a, from_left)).filter(|_| !right.is_corner),
            mirrored.tail(&left, middle(right_corner, -b, from_right)).filter(|_| !left.is_corner),
        ];
        for _ in 0..ROUNDS {
            if let Some(tail) = &tails[0] {
                let other = if is_one { b } else { from_left };
                a = tail.end(if left_corner { other + other - a } else { other }, right.between);
            }
            if let Some(tail) = &tails[1] {
                let other = if is_one { -a } else { from_right };
                b = -tail.end(if right_corner { other + other + b } else { other }, left.between);
            }
        }
        let goes_on = symmetry && (right.of_curve || left.of_curve);
        (a - b).max(T::zero()) * if goes_on { T::one() } else { lit(0.5) }
    }
}

impl<T: Real> Tail<T> {
    /// End a of the pressure of the module docs with these moments and the other end b, clamped to the bounds.
    fn end(&self, b: T, [least, most]: [T; 2]) -> T {
        let ellipse = self.ellipse(b);
        let length = ellipse - self.begin;
        let at = |k: usize| self.begin + length * (lit::<T>(AROUND[0]) + lit::<T>(AROUND[1] - AROUND[0]) * num(k) / num(STEPS));
        let a = (0..STEPS).filter_map(|k| self.root(b, at(k), at(k + 1)));
        let nearest = a.reduce(|x, y| if (y - ellipse).abs() < (x - ellipse).abs() { y } else { x });
        nearest.unwrap_or(ellipse).max(least).min(most)
    }

    /// End a of sqrt((a - s)(s - b)) with this mean.
    fn ellipse(&self, b: T) -> T {
        if b >= self.begin {
            // the whole zone: its mean is the middle
            return (self.begin + self.mean) * lit(2.0) - b;
        }
        // the mean lies between 2/5 and 1/2 of what is left
        let (mut low, mut high) = (self.begin + self.mean * lit(2.0), self.begin + self.mean * lit(2.5));
        for _ in 0..BISECTIONS {
            let a = (low + high) * lit(0.5);
            if mean(self.begin, b, a) < self.mean { low = a } else { high = a }
        }
        (low + high) * lit(0.5)
    }

    /// End between `low` and `high` with both moments and a positive pressure; `None` if there is none.
    fn root(&self, b: T, mut low: T, mut high: T) -> Option<T> {
        let sign = |a: T| self.misses(b, a).map(|(missed, _)| missed > T::zero());
        let first = sign(low)?;
        if first == sign(high)? {
            return None;
        }
        for _ in 0..BISECTIONS {
            let a = (low + high) * lit(0.5);
            if sign(a)? == first { low = a } else { high = a }
        }
        let a = (low + high) * lit(0.5);
        // at a pole the sign changes and nothing is zero
        self.misses(b, a).filter(|(missed, _)| missed.abs() < lit(NO_MISS)).map(|_| a)
    }

    /// Error of the second moment for the end `a` if the first one is met, and g; `None` if 1 + g x has both signs.
    fn misses(&self, b: T, a: T) -> Option<(T, T)> {
        let (middle, half) = ((a + b) * lit(0.5), (a - b) * lit(0.5));
        let from = (self.begin - middle) / half;
        let first = from + self.mean / half;
        let second = from * from + (from * self.mean * lit(2.0) + self.square / half) / half;
        let of = roots(from);
        let g = (first * of[0] - of[1]) / (of[2] - first * of[1]);
        let is_positive = T::one() + g > T::zero() && T::one() + g * from.max(-T::one()) > T::zero();
        let missed = (of[2] + g * of[3]) / (of[0] + g * of[1]) - second;
        (half > T::zero() && is_positive).then_some((missed, g))
    }
}

/// ∫ sqrt(1 - x²) x^k dx over from < x < 1 for k = 0 to 3.
fn roots<T: Real>(from: T) -> [T; 4] {
    let x = from.max(-T::one()).min(T::one());
    let (one, root) = (T::one(), (T::one() - x * x).max(T::zero()).sqrt());
    let cube = root * root * root;
    let angle = x.acos();
    [
        (angle - x * root) * lit(0.5),
        cube / lit(3.0),
        (angle + x * root * (one - x * x * lit(2.0))) * lit(0.125),
        cube * (one / lit(3.0) - root * root * lit(0.2)),
    ]
}

/// ∫ p (s - begin) ds / ∫ p ds of p = sqrt((a - s)(s - b)) over begin < s < a.
fn mean<T: Real>(begin: T, b: T, a: T) -> T {
    let (middle, half) = ((a + b) * lit(0.5), (a - b) * lit(0.5));
    let [force, moment, ..] = roots((begin - middle) / half);
    middle + half * moment / force - begin
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: f64 = 0.1;

    /// ∫ p s^k of p = sqrt((a - s)(s - b)) (1 + g x) from b to `s` for k = 0, 1, 2; x runs from -1 to 1.
    fn moments(s: f64, b: f64, a: f64, g: f64) -> [f64; 3] {
        let (middle, half) = (0.5 * (a + b), 0.5 * (a - b));
        let x = ((s - middle) / half).clamp(-1.0, 1.0);
        let (root, angle) = ((1.0 - x * x).sqrt(), x.asin() + 0.5 * std::f64::consts::PI);
        let cube = root.powi(3);
        let of = [
            0.5 * (x * root + angle),
            -cube / 3.0,
            0.125 * (angle - x * root * (1.0 - 2.0 * x * x)),
            -cube / 3.0 + cube * root * root / 5.0,
        ];
        let [m0, m1, m2] = [0, 1, 2].map(|k| of[k] + g * of[k + 1]);
        let size = half * half;
        [size * m0, size * (middle * m0 + half * m1), size * (middle * middle * m0 + 2.0 * middle * half * m1 + size * m2)]
    }

    /// Twenty elements of a line with zones of pressure, two points with the right moments in each, and `noise` everywhere.
    fn line_of(zones: &[[f64; 2]], g: f64, noise: f64) -> Unrolled<f64> {
        let section = |k: usize| {
            let [from, to] = [k, k + 1].map(|k| SIZE * k as f64);
            let of = |i: usize| -> f64 { zones.iter().map(|&[b, a]| moments(to, b, a, g)[i] - moments(from, b, a, g)[i]).sum() };
            let (force, pressed) = (of(0), of(0) > 1e-9);
            let s = if pressed { of(1) / force } else { from + 0.5 * SIZE };
            let aside = if pressed { (of(2) / force - s * s).max(0.0).sqrt() } else { 0.2 * SIZE };
            let point = |s: f64| Point { s: s - from, force: 0.5 * (force + noise * SIZE), pressed };
            Section { length: SIZE, pieces: vec![Piece { from: 0.0, to: SIZE, points: vec![point(s - aside), point(s + aside)] }] }
        };
        let sections: Vec<Section<f64>> = (0..20).map(section).collect();
        let forth: Vec<(usize, bool)> = (0..20).map(|k| (k, false)).collect();
        Unrolled::of(&sections, &forth)
    }

    /// Zones of elliptic pressure.
    fn line(zones: &[[f64; 2]], noise: f64) -> Unrolled<f64> {
        line_of(zones, 0.0, noise)
    }

    #[test]
    fn zones_of_pressures_that_lean_end_where_they_end() {
        for (k, g) in [-0.6, -0.3, 0.2, 0.5, 0.7].into_iter().enumerate() {
            let (b, a) = (0.41 + 0.013 * k as f64, 1.53 + 0.02 * k as f64);
            let found = line_of(&[[b, a]], g, 0.0).half_width(false);
            assert!((found / (0.5 * (a - b)) - 1.0).abs() < 1e-6, "{g}: {found} instead of {}", 0.5 * (a - b));
        }
    }

    #[test]
    fn integrals_of_roots_are_those_of_sums() {
        for from in [-1.0, -0.4, 0.0, 0.3, 0.95] {
            let (n, found) = (200_000, roots(from));
            for (k, found) in found.into_iter().enumerate() {
                let x = |j: usize| from + (1.0 - from) * (j as f64 + 0.5) / n as f64;
                let sum: f64 = (0..n).map(|j| (1.0 - x(j) * x(j)).sqrt() * x(j).powi(k as i32)).sum();
                assert!((sum * (1.0 - from) / n as f64 - found).abs() < 1e-7, "{from} {k}");
            }
        }
    }

    #[test]
    fn the_mean_of_a_tail_is_that_of_a_sum() {
        for (begin, b, a) in [(0.2, -1.0, 1.0), (0.9, -1.0, 1.0), (-1.0, -1.0, 1.0), (0.3, -5.0, 0.7)] {
            let n = 200_000;
            let (mut sum, mut moment) = (0.0, 0.0);
            for k in 0..n {
                let s = begin + (a - begin) * (k as f64 + 0.5) / f64::from(n);
                let p = ((a - s) * (s - b)).sqrt();
                (sum, moment) = (sum + p, moment + p * (s - begin));
            }
            assert!((mean(begin, b, a) / (moment / sum) - 1.0).abs() < 1e-7, "{begin} {b} {a}");
        }
    }

    #[test]
    fn ends_are_found_within_elements_from_either_end_and_not_from_noise() {
        for k in 0..40 {
            // eleven to twelve elements wide, anywhere
            let (b, a) = (0.41 + 0.01 * f64::from(k), 1.53 + 0.01 * f64::from(k % 7));
            let found = line(&[[b, a]], 0.0).half_width(true);
            assert!((found / (0.5 * (a - b)) - 1.0).abs() < 1e-8, "{b} {a}: {found}");
            let mirrored = line(&[[2.0 - a, 2.0 - b]], 0.0).half_width(false);
            assert!((found - mirrored).abs() < 1e-12, "{b} {a}: {found} {mirrored}");
            let noisy = line(&[[b, a]], 1e-11).half_width(true);
            assert!((found - noisy).abs() < 1e-9, "{b} {a}: {found} {noisy}");
        }
    }

    #[test]
    fn half_models_end_at_the_end_and_several_stretches_are_one_zone() {
        for k in 0..10 {
            let a = 1.0 + 0.013 * f64::from(k);
            let half = line(&[[-a, a]], 0.0);
            let [all, part] = [true, false].map(|symmetry| half.half_width(symmetry));
            assert!((all / a - 1.0).abs() < 1e-8 && part == 0.5 * all, "{a}: {all} {part}");
            // two feet: the inner ends are known to an element
            let both = line(&[[0.213, 0.83], [1.17, 1.7 + 0.013 * f64::from(k)]], 0.0).half_width(false);
            let wanted = 0.5 * (1.487 + 0.013 * f64::from(k));
            assert!((both / wanted - 1.0).abs() < 0.005, "{both} {wanted}");
        }
        // pressed from end to end
        assert!((line(&[[-9.0, 11.0]], 0.0).half_width(false) - 1.0).abs() < 1e-12);
        assert_eq!(line(&[], 0.0).half_width(false), 0.0);
    }

    #[test]
    fn a_closed_curve_begins_where_it_is_open() {
        let empty = |pressed: bool| Section {
            length: SIZE,
            pieces: vec![Piece { from: 0.0, to: SIZE, points: vec![Point { s: 0.05, force: 1.0, pressed }] }],
        };
        let of = |pressed: [bool; 8]| {
            let walk: Vec<(usize, bool)> = (0..8).map(|k| (k, false)).collect();
            amid_widest_open(&pressed.map(empty), &walk)
        };
        let (o, x) = (false, true);
        assert_eq!(of([x, x, o, o, o, o, x, x]), 4);
        assert_eq!(of([o, o, x, x, o, x, x, o]), 0);
        assert_eq!(of([o; 8]), 0);
    }
}
