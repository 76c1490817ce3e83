//! Contact half-width along one side, or along several consecutive sides.
//!
//! Each function carries pressure or not, so the zone of the active functions ends between elements. The true end follows from the moments
//! of the pressure's tail ([`super::tail`]), which never begins before the last maximum of the pressure. With n elements between the middle
//! of the zone and its end the tail is that of the last 3.5 sqrt(n), from 0.5 to 0.8 of the way on. Coarse zones need more of it than that:
//! where the pressure has the slope of Hertz', it may begin in the middle. A corner or an edge of the slave or of its opponent at which the zone
//! ends is its end.
//!
//! There is no half width where fewer than four elements lie in the tail, seven if it has to begin before 0.8, or where its end does not lie
//! in the last two elements of the functions' zone or the one after.

use super::several::Several;
use super::tail::Tail;
use crate::basis::Order;
use crate::coupling::interface::{Chain, Segments};
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector, lit, measure};
use crate::quadrature::{Rule, gauss_legendre};

/// Relative size of the pressure up to which it is zero: round-off of Nitsche's method and of soft rows.
const NO_PRESSURE: f64 = 1e-6;
/// Elements of a tail over the square root of their number from the middle of the zone to its end: shorter tails deviate less from the
/// pressure of the model, longer ones average out more of the noise of single elements.
const TAIL: f64 = 3.5;
/// Shares of the way from the middle of the zone to its end between which a tail begins.
const BEGINS: [f64; 2] = [0.5, 0.8];
/// Largest difference of the slope from that of Hertz' pressure, for which the end of a tail of half the zone is within 0.5 %.
const LIKE_HERTZ: f64 = 0.05;
/// Least number of elements of a tail from the last of `BEGINS` on, of a longer one, whose elements are larger beside its zone, and of one
/// like Hertz'.
const FEWEST: usize = 4;
const FEWEST_OF_LONG: usize = 7;
const FEWEST_OF_HERTZ: usize = 6;
/// The pressure has a maximum where it falls from there, on the way in, by this share of its greatest value; less is noise.
const FALL: f64 = 0.05;
/// Strip at an end of a side that its opponent does not face, relative to the element there, up to which a zone ends with the side: facets.
const STRIP: f64 = 0.05;
/// Points closer than this fraction of an element coincide.
const SAME_PLACE: f64 = 1e-6;
/// Gauss points of an arc length.
const POINTS: usize = 8;

/// The reason why a zone has no half width.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoHalfWidth {
    /// Too few elements for the tail of the pressure.
    #[error(
        "{elements} of the elements that are pressed lie in the last fifth before an end of the zone and behind the last maximum of the \
         pressure, too few for an end within an element: refine the side there"
    )]
    FewElements {
        /// Their number.
        elements: usize,
    },
    /// No end near that of the active functions.
    #[error(
        "near an end of the zone the pressure does not fall like a root, which tells where it ends within an element: refine the side there"
    )]
    NoRoot,
    /// An end of the curve that does not move along it: half of a symmetric zone, or all of one.
    #[error(
        "the zone ends at an end of the slave side that does not move along it: half of a symmetric zone, or one that ends there; of a half \
         model set `symmetry`"
    )]
    HeldEnd,
}

/// The behaviour of a zone at an end of the slave sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SideEnd {
    /// It ends there.
    Free,
    /// It goes on beyond, as its mirror image.
    Mirrored,
    /// Either: the end does not move along the side.
    Held,
}

/// A slave side with its contact, the points of it that are closed, and the pressure there.
#[derive(Clone, Copy, Debug)]
pub struct ClosedSide<'a, const N: usize, T: Real = f64> {
    /// The side.
    pub slave: &'a dyn Geometry<1, N, T>,
    /// Its pieces and points, with weights along the curve.
    pub segments: &'a Segments<1, T>,
    /// Whether each point of the segments lies in the closed zone, as in [`super::ContactResultants`].
    pub closed: &'a [bool],
    /// The pressure at each of them [force/area].
    pub pressure: &'a [T],
}

/// Returns half the extent of the contact zone along the slave sides, an arc length \[length\]; zero if nothing is in contact.
///
/// Sides that meet are one curve: a joint between them is no end. Of curves that do not meet the widest zone counts. All pressed
/// stretches of one curve are one zone; on a closed curve it is the complement of the widest open stretch. Where a zone ends at an end of
/// the curve, `side_end` of the side's number, the element and the local coordinate there tells what it does: mirrored, its extent is half
/// of the whole; held, it has no half width unless it ends at a corner on the other side as well.
///
/// # Errors
/// [`NoHalfWidth`] where the pressure, or what is known of the end of a side, does not tell an end.
pub fn half_width<const N: usize, T: Real>(
    sides: &[ClosedSide<'_, N, T>],
    side_end: &dyn Fn(usize, usize, T) -> SideEnd,
) -> Result<T, NoHalfWidth> {
    let places: Vec<(usize, usize)> =
        sides.iter().enumerate().flat_map(|(k, s)| (0..s.slave.num_elements()).map(move |e| (k, e))).collect();
    let end_of = |element: usize, at_one: bool| {
        let (side, own) = places[element];
        side_end(side, own, if at_one { T::one() } else { T::zero() })
    };
    let joined = Several { elements: sides.iter().flat_map(|s| (0..s.slave.num_elements()).map(|e| (s.slave, e))).collect() };
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
        let ends = if is_loop {
            let start = amid_widest_open(&sections, &curve);
            curve.rotate_left(start);
            [SideEnd::Free; 2]
        } else {
            let (from, to) = (curve[0], curve[curve.len() - 1]);
            [end_of(from.0, from.1), end_of(to.0, !to.1)]
        };
        widest = widest.max(Unrolled::of(&sections, &curve).half_width(ends)?);
        first = k + 1;
    }
    Ok(widest)
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
            let segments = side.segments;
            for piece in 0..segments.num_pieces() {
                let element = base + segments.slave[piece];
                carries[element] |= segments.points(piece).any(|q| side.pressure[q] != T::zero());
                pieces.push((side, piece, element));
            }
            base += side.slave.num_elements();
        }
        let beside = |e: usize| (0..2).any(|end| chain.neighbour(e, end).is_some_and(|(other, _)| carries[other]));
        for (side, piece, element) in pieces.into_iter().filter(|&(_, _, e)| carries[e] || beside(e)) {
            let segments = side.segments;
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
    /// Bounds of the true end: the last two elements and the next one, and no further than what faces the opponent.
    between: [T; 2],
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
        let between = [self.starts[last.saturating_sub(1).max(first)], most.min(end)];
        let of_curve = is_corner && at >= end - self.sections[last].length * lit(STRIP);
        Some(End { last, first, at, is_corner, of_curve, between })
    }

    /// The end of a zone with the middle `middle`.
    fn true_end(&self, end: &End<T>, middle: T) -> Result<T, NoHalfWidth> {
        if end.is_corner {
            return Ok(end.at);
        }
        let own = self.end_of_tail(end, middle, self.after_maximum(end, 0));
        // multipliers of the full degree waver from element to element near the end: their maxima are those of means over three
        own.or_else(|why| self.end_of_tail(end, middle, self.after_maximum(end, 1)).map_err(|_| why))
    }

    /// The end of a zone by the pressure from the element `lowest` on.
    fn end_of_tail(&self, end: &End<T>, middle: T, lowest: usize) -> Result<T, NoHalfWidth> {
        let extent = end.at - middle;
        let after = |share: f64| {
            let s = middle + extent * lit(share) - extent.abs() * lit(SAME_PLACE);
            (end.first..=end.last).find(|&k| self.starts[k] >= s).unwrap_or(end.last).max(lowest)
        };
        let half = (end.first..=end.last).filter(|&k| self.starts[k + 1] > middle + extent.abs() * lit(SAME_PLACE)).count();
        let share = 1.0 - TAIL / (half.max(1) as f64).sqrt();
        let within = |a: &T| *a >= end.between[0] && *a <= end.between[1];
        if share < BEGINS[0] {
            let k = after(share.max(0.0));
            let long = (end.last + 1 >= k + FEWEST_OF_HERTZ).then(|| self.tail(k)).flatten();
            let found = long.and_then(|tail| tail.like_hertz(middle)).filter(|(a, slope)| slope.abs() <= lit(LIKE_HERTZ) && within(a));
            if let Some((a, _)) = found {
                return Ok(a);
            }
        }
        let k = after(share.clamp(BEGINS[0], BEGINS[1]));
        let elements = end.last + 1 - k;
        if elements < FEWEST || (elements < FEWEST_OF_LONG && k < after(BEGINS[1])) {
            return Err(NoHalfWidth::FewElements { elements: end.last + 1 - after(BEGINS[1]).min(end.last + 1) });
        }
        self.tail(k).and_then(|tail| tail.end()).filter(within).ok_or(NoHalfWidth::NoRoot)
    }

    /// The pressure from the start of element `first` on; `None` unless its resultant presses.
    fn tail(&self, first: usize) -> Option<Tail<T>> {
        let begin = self.starts[first];
        // functions at the end of the zone reach beyond it
        let points = self.sections[first..].iter().flat_map(|s| &s.pieces).flat_map(|p| &p.points);
        let [force, moment, square] = points.fold([T::zero(); 3], |[f, m, s], p| {
            let arm = p.s - begin;
            [f + p.force, m + p.force * arm, s + p.force * arm * arm]
        });
        (force > T::zero()).then(|| Tail { begin, mean: moment / force, square: square / force })
    }

    /// The element after the last maximum of the mean pressures over an element and `beside` neighbours on both sides, the first element of
    /// the stretch if there is none within it.
    fn after_maximum(&self, end: &End<T>, beside: usize) -> usize {
        let mean = |k: usize| {
            let of = k.saturating_sub(beside).max(end.first)..=(k + beside).min(end.last);
            let pieces = || self.sections[of.clone()].iter().flat_map(|s| &s.pieces);
            let length = pieces().fold(T::zero(), |sum, p| sum + (p.to - p.from));
            let force = pieces().flat_map(|p| &p.points).fold(T::zero(), |sum, p| sum + p.force);
            if length > T::zero() { force / length } else { T::zero() }
        };
        let fall = (end.first..=end.last).map(mean).fold(T::zero(), |most, p| most.max(p)) * lit(FALL);
        let mut most = (T::zero(), end.last);
        for k in (end.first..=end.last).rev() {
            let p = mean(k);
            if p > most.0 {
                most = (p, k);
            } else if p < most.0 - fall {
                return most.1 + 1;
            }
        }
        end.first
    }

    /// Half the extent of the zone, or all of it if it ends at the start or the end of the curve and is mirrored there.
    fn half_width(&self, [start, end]: [SideEnd; 2]) -> Result<T, NoHalfWidth> {
        let mirrored = self.mirrored();
        let (Some(right), Some(left)) = (self.end(), mirrored.end()) else { return Ok(T::zero()) };
        // one stretch, or several, of which the two outer ones have middles of their own; a corner is the middle of a zone that goes on there
        let is_one = right.first + left.last + 1 == self.sections.len();
        let [from_left, from_right] = if is_one { [-left.at, -right.at] } else { [self.starts[right.first], mirrored.starts[left.first]] };
        let middle = |corner: bool, end: T, other: T| if corner && is_one { other } else { (end + other) * lit(0.5) };
        let a = self.true_end(&right, middle(left.is_corner, right.at, from_left))?;
        let b = -mirrored.true_end(&left, middle(right.is_corner, left.at, from_right))?;
        let unknown = |own: &End<T>, kind: SideEnd, other: &End<T>| own.of_curve && kind == SideEnd::Held && !other.is_corner;
        if unknown(&right, end, &left) || unknown(&left, start, &right) {
            return Err(NoHalfWidth::HeldEnd);
        }
        let goes_on = right.of_curve && end == SideEnd::Mirrored || left.of_curve && start == SideEnd::Mirrored;
        Ok((a - b).max(T::zero()) * if goes_on { T::one() } else { lit(0.5) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: f64 = 0.025;

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

    /// Eighty elements of a line with zones of pressure, two points with the right moments in each, and `noise` everywhere.
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
        let sections: Vec<Section<f64>> = (0..80).map(section).collect();
        let forth: Vec<(usize, bool)> = (0..80).map(|k| (k, false)).collect();
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
            let found = line_of(&[[b, a]], g, 0.0).half_width([SideEnd::Free; 2]).unwrap();
            assert!((found / (0.5 * (a - b)) - 1.0).abs() < 3e-3, "{g}: {found} instead of {}", 0.5 * (a - b));
        }
    }

    #[test]
    fn ends_are_found_within_elements_from_either_end_and_not_from_noise() {
        for k in 0..40 {
            // about 45 elements wide, anywhere
            let (b, a) = (0.41 + 0.01 * f64::from(k), 1.53 + 0.01 * f64::from(k % 7));
            let found = line(&[[b, a]], 0.0).half_width([SideEnd::Mirrored; 2]).unwrap();
            assert!((found / (0.5 * (a - b)) - 1.0).abs() < 3e-4, "{b} {a}: {found}");
            let mirrored = line(&[[2.0 - a, 2.0 - b]], 0.0).half_width([SideEnd::Free; 2]).unwrap();
            assert!((found - mirrored).abs() < 1e-12, "{b} {a}: {found} {mirrored}");
            let noisy = line(&[[b, a]], 1e-11).half_width([SideEnd::Mirrored; 2]).unwrap();
            // the fit of two terms amplifies noise that acts far from the zone
            assert!((found - noisy).abs() < 1e-5, "{b} {a}: {found} {noisy}");
        }
    }

    #[test]
    fn half_models_end_at_the_end_and_several_stretches_are_one_zone() {
        for k in 0..10 {
            let a = 1.0 + 0.013 * f64::from(k);
            let half = line(&[[-a, a]], 0.0);
            let [all, part] = [SideEnd::Mirrored, SideEnd::Free].map(|end| half.half_width([end; 2]).unwrap());
            assert!((all / a - 1.0).abs() < 3e-4 && part == 0.5 * all, "{a}: {all} {part}");
            // two feet
            let both = line(&[[0.213, 0.83], [1.17, 1.7 + 0.013 * f64::from(k)]], 0.0).half_width([SideEnd::Free; 2]).unwrap();
            let wanted = 0.5 * (1.487 + 0.013 * f64::from(k));
            assert!((both / wanted - 1.0).abs() < 0.005, "{both} {wanted}");
        }
        // pressed from end to end
        assert!((line(&[[-9.0, 11.0]], 0.0).half_width([SideEnd::Free; 2]).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(line(&[], 0.0).half_width([SideEnd::Free; 2]), Ok(0.0));
    }

    #[test]
    fn zones_of_few_elements_and_ends_without_a_root_have_no_half_width() {
        // two elements on either side of the middle
        assert!(matches!(line(&[[0.951, 1.049]], 0.0).half_width([SideEnd::Free; 2]), Err(NoHalfWidth::FewElements { .. })));
        // the greatest pressure near the end: nothing but the tail after it counts, which is short
        let peaked = line(&[[0.3, 1.5], [1.35, 1.5]], 0.0);
        assert!(peaked.half_width([SideEnd::Free; 2]).is_ok(), "a bump that does not fall");
        let steep = line(&[[0.3, 1.49], [1.4, 1.49], [1.4, 1.49], [1.4, 1.49], [1.4, 1.49], [1.4, 1.49], [1.4, 1.49]], 0.0);
        assert!(
            matches!(steep.half_width([SideEnd::Free; 2]), Err(NoHalfWidth::FewElements { .. })),
            "{:?}",
            steep.half_width([SideEnd::Free; 2])
        );
        // a pressure that ends like a wall
        let wall = |k: usize| {
            let points = [0.2, 0.8].map(|x| Point { s: x * SIZE, force: SIZE, pressed: (40..120).contains(&k) }).to_vec();
            Section { length: SIZE, pieces: vec![Piece { from: 0.0, to: SIZE, points }] }
        };
        let sections: Vec<Section<f64>> = (0..160).map(wall).collect();
        let walk: Vec<(usize, bool)> = (0..160).map(|k| (k, false)).collect();
        assert_eq!(Unrolled::of(&sections, &walk).half_width([SideEnd::Free; 2]), Err(NoHalfWidth::NoRoot));
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
