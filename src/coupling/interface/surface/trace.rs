//! An edge of the master in the chart of a slave facet, as a chain of pieces from its first vertex to its second one.
//!
//! Every piece lies either in the closed cell, as a line or a polynomial of degree 8 through Chebyshev-Lobatto points, or is a chord on the
//! closed outer side of one side of the cell. Pieces end where the edge crosses a side, exactly on it, so that clipping cuts chords only.
//! With d_k the distance to side k and φ = min d_k, crossings are roots of φ: between samples of different sign, and beside small local
//! extrema, where golden section looks for a visit or an exit that samples missed. Outside only the d_k count, not the place along
//! a side: a point far away may be as far from all points of an edge, and chords there only have to wind about the cell as the edge does.

use super::piece::{EdgePiece, NODES, nodes, wedge};
use super::polygon::Polygon;
use crate::linalg::Vector;

/// Deepest halving of an edge.
const DEPTH: usize = 48;
/// Points of an edge after which nothing is halved any more; edges that cross a cell many times take some hundreds.
const MOST_POINTS: usize = 20_000;
/// Halvings of a curved piece.
const CURVE_DEPTH: usize = 8;
/// Error of curved pieces, in local coordinates.
const CURVE_ERROR: f64 = 1e-10;
/// Samples in which crossings are searched.
const SAMPLES: usize = 8;
/// Steps of golden section, which shrink its interval by 1e-4.
const GOLDEN_STEPS: usize = 20;
/// Samples that are looked through before a point is computed again.
const SEEN: usize = 24;
/// Steps of a root.
const ROOT_STEPS: usize = 80;

/// A parameter of the edge and the point there.
type Sample = (f64, Vector<2>);

/// The edge `pull` with the ends `ends`, known before.
pub(super) fn trace(polygon: Polygon, snap: f64, ends: [Vector<2>; 2], pull: &mut dyn FnMut(f64) -> Vector<2>) -> Vec<EdgePiece> {
    let mut tracer = Tracer { polygon, snap, pull, seen: Vec::new(), pieces: Vec::new() };
    tracer.refine((0.0, ends[0]), (1.0, ends[1]), DEPTH);
    tracer.pieces
}

struct Tracer<'p> {
    polygon: Polygon,
    snap: f64,
    pull: &'p mut dyn FnMut(f64) -> Vector<2>,
    /// The last samples: middles are asked for again.
    seen: Vec<Sample>,
    pieces: Vec<EdgePiece>,
}

impl Tracer<'_> {
    fn sample(&mut self, t: f64) -> Sample {
        if let Some(known) = self.seen.iter().rev().take(SEEN).find(|s| s.0 == t) {
            return *known;
        }
        let sample = (t, (self.pull)(t));
        self.seen.push(sample);
        sample
    }

    /// The halvings that are left of `depth`: none once the edge has its most points.
    fn left(&self, depth: usize) -> usize {
        if self.seen.len() < MOST_POINTS { depth } else { 0 }
    }

    fn middle(&mut self, a: &Sample, b: &Sample) -> Sample {
        self.sample(0.5 * (a.0 + b.0))
    }

    fn depth_of(&self, s: &Sample) -> f64 {
        self.polygon.depth(&s.1)
    }

    fn line(&mut self, a: &Sample, b: &Sample) {
        self.pieces.push(EdgePiece::Line(a.1, b.1));
    }

    /// Halves an edge until it is short and little bent, or surely outside.
    fn refine(&mut self, a: Sample, b: Sample, depth: usize) {
        let (m, depth) = (self.middle(&a, &b), self.left(depth));
        for k in 0..self.polygon.sides() {
            let [da, dm, db] = [a, m, b].map(|s| self.polygon.distance(k, &s.1));
            let off = (dm - 0.5 * (da + db)).abs();
            if da.max(dm).max(db) <= -2.0 * off {
                let quarters = [self.middle(&a, &m), self.middle(&m, &b)];
                if quarters.iter().all(|q| self.polygon.distance(k, &q.1) <= 0.0) {
                    self.line(&a, &m);
                    self.line(&m, &b);
                    return;
                }
            }
        }
        let (chord, bend) = ((b.1 - a.1).norm(), (m.1 - (a.1 + b.1) * 0.5).norm());
        if depth > 0 && (chord > 1.6 || bend > 0.15 * chord.max(0.1)) {
            self.refine(a, m, depth - 1);
            self.refine(m, b, depth - 1);
        } else {
            self.resolve(a, b, depth);
        }
    }

    /// Splits an edge where it crosses the cell's boundary.
    fn resolve(&mut self, a: Sample, b: Sample, depth: usize) {
        let mut at = vec![a];
        for i in 1..SAMPLES {
            let s = self.sample(a.0 + (b.0 - a.0) * i as f64 / SAMPLES as f64);
            at.push(s);
        }
        at.push(b);
        let phi: Vec<f64> = at.iter().map(|s| self.level(s)).collect();
        let mut cuts = vec![a];
        for i in 1..=SAMPLES {
            if phi[i - 1] * phi[i] < 0.0 {
                let root = self.root(at[i - 1], at[i]);
                cuts.push(root);
            } else if phi[i - 1].min(phi[i]) < 0.0 && phi[i - 1].max(phi[i]) == 0.0 {
                let end = self.end_on_side(at[i - 1], at[i]);
                cuts.extend(end);
            }
            if i == SAMPLES {
                break;
            }
            if phi[i] == 0.0 {
                cuts.push(at[i]);
            } else if let Some(across) = self.visit(&at[i - 1..=i + 1], [phi[i - 1], phi[i], phi[i + 1]]) {
                let roots = [self.root(at[i - 1], across), self.root(across, at[i + 1])];
                cuts.extend(roots);
            }
        }
        cuts.push(b);
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
        for k in 1..cuts.len() {
            self.between(cuts[k - 1], cuts[k], depth);
        }
    }

    /// φ, zero within snap.
    fn level(&self, s: &Sample) -> f64 {
        let phi = self.depth_of(s);
        if phi.abs() <= self.snap { 0.0 } else { phi }
    }

    /// A sample of the other sign between three samples of one sign, of which the middle one is nearest to the boundary.
    fn visit(&mut self, at: &[Sample], phi: [f64; 3]) -> Option<Sample> {
        let sign = phi[1].signum();
        let [left, here, right] = phi.map(|v| v * sign);
        if !(left > 0.0 && right > 0.0 && here <= left && here <= right) {
            return None;
        }
        // the vertex of the parabola, and twice as far as it falls
        let (slope, curvature) = (0.5 * (right - left), left - 2.0 * here + right);
        let fall = if curvature > 0.0 { 0.5 * slope * slope / curvature } else { 0.0 };
        if here > 2.0 * fall + 0.5 * curvature {
            return None;
        }
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        let (mut lo, mut hi) = (at[0].0, at[2].0);
        let mut inner = [self.sample(hi - golden * (hi - lo)), self.sample(lo + golden * (hi - lo))];
        for _ in 0..GOLDEN_STEPS {
            let values = inner.map(|s| self.level(&s) * sign);
            if let Some(k) = (0..2).find(|&k| values[k] < 0.0) {
                return Some(inner[k]);
            }
            if values[0] < values[1] {
                hi = inner[1].0;
                inner = [self.sample(hi - golden * (hi - lo)), inner[0]];
            } else {
                lo = inner[0].0;
                inner = [inner[1], self.sample(lo + golden * (hi - lo))];
            }
        }
        None
    }

    /// The crossing between two samples of different sign, exactly on its side.
    fn root(&mut self, a: Sample, b: Sample) -> Sample {
        let found = self.root_of(a, b, &|tracer, s| tracer.level(s));
        (found.0, self.polygon.put_on(self.polygon.nearest_side(&found.1), &found.1))
    }

    /// The place at which an edge with one sample on a side and the other outside leaves the side through a corner.
    fn end_on_side(&mut self, a: Sample, b: Sample) -> Option<Sample> {
        let (on, out) = if self.level(&a) == 0.0 { (a, b) } else { (b, a) };
        let k = self.polygon.nearest_side(&out.1);
        if self.polygon.distance(k, &on.1) <= self.snap {
            return None;
        }
        let found = self.root_of(a, b, &|tracer, s| {
            let d = tracer.polygon.distance(k, &s.1);
            if d.abs() <= tracer.snap { 0.0 } else { d }
        });
        Some((found.0, self.polygon.snapped(&self.polygon.put_on(k, &found.1), self.snap)))
    }

    /// The sample between two at which the function `of`, of different sign there, is zero.
    fn root_of(&mut self, a: Sample, b: Sample, of: &dyn Fn(&Self, &Sample) -> f64) -> Sample {
        let (mut lo, mut hi) = (a, b);
        let (mut f_lo, mut f_hi) = (of(self, &lo), of(self, &hi));
        let mut found = if f_lo == 0.0 { lo } else { hi };
        let mut last = 0;
        for step in 0..ROOT_STEPS {
            if f_lo == 0.0 || f_hi == 0.0 {
                break;
            }
            let secant = lo.0 + (hi.0 - lo.0) * (f_lo / (f_lo - f_hi));
            // every fourth step halves: the Illinois variant alone may be slow at kinks of φ
            let t = if step % 4 == 3 { 0.5 * (lo.0 + hi.0) } else { secant };
            if t <= lo.0.min(hi.0) || t >= lo.0.max(hi.0) {
                break;
            }
            let s = self.sample(t);
            let f = of(self, &s);
            found = s;
            if f == 0.0 {
                break;
            }
            if f * f_lo < 0.0 {
                (hi, f_hi) = (s, f);
                f_lo *= if last == 1 { 0.5 } else { 1.0 };
                last = 1;
            } else {
                (lo, f_lo) = (s, f);
                f_hi *= if last == 2 { 0.5 } else { 1.0 };
                last = 2;
            }
        }
        found
    }

    /// A part of the edge without crossings.
    fn between(&mut self, a: Sample, b: Sample, depth: usize) {
        if (b.1 - a.1).amax() <= self.snap {
            return self.line(&a, &b);
        }
        let (m, depth) = (self.middle(&a, &b), self.left(depth));
        let phi = self.level(&m);
        if phi > 0.0 {
            self.inside(a, b, depth, CURVE_DEPTH);
        } else if phi < 0.0 {
            self.outside(a, b, depth);
        } else {
            self.on_boundary(a, m, b, depth);
        }
    }

    /// A part whose middle is on the boundary: along a side, or through a corner.
    fn on_boundary(&mut self, a: Sample, m: Sample, b: Sample, depth: usize) {
        let quarters = [self.middle(&a, &m), self.middle(&m, &b)];
        if depth == 0 || [a, b].iter().chain(&quarters).all(|q| self.level(q) == 0.0) {
            self.line(&a, &m);
            self.line(&m, &b);
        } else {
            self.resolve(a, m, depth - 1);
            self.resolve(m, b, depth - 1);
        }
    }

    fn inside(&mut self, a: Sample, b: Sample, depth: usize, level: usize) {
        let (at, depth) = (nodes(), self.left(depth));
        let mut points = [a.1; NODES];
        points[NODES - 1] = b.1;
        for i in 1..NODES - 1 {
            let s = self.sample(a.0 + (b.0 - a.0) * at[i]);
            if self.depth_of(&s) < -4.0 * self.snap && depth > 0 {
                self.resolve(a, s, depth - 1);
                self.resolve(s, b, depth - 1);
                return;
            }
            points[i] = s.1;
        }
        let along = b.1 - a.1;
        let length = along.norm();
        let is_near = |p: &Vector<2>| wedge(&(p - a.1), &along).abs() <= 0.5 * self.snap * length;
        if points.iter().all(is_near) && points.windows(2).all(|w| (w[1] - w[0]).dot(&along) >= 0.0) {
            return self.line(&a, &b);
        }
        let curve = EdgePiece::Curve(points);
        let mut error = 0.0f64;
        for t in [0.1, 0.43, 0.81] {
            let s = self.sample(a.0 + (b.0 - a.0) * t);
            error = error.max((s.1 - curve.at(t)[0]).amax());
        }
        if error > CURVE_ERROR.max(20.0 * self.snap) && self.left(level) > 0 {
            let m = (0.5 * (a.0 + b.0), points[NODES / 2]);
            self.inside(a, m, depth, level - 1);
            self.inside(m, b, depth, level - 1);
        } else {
            self.pieces.push(curve);
        }
    }

    fn outside(&mut self, a: Sample, b: Sample, depth: usize) {
        let beyond = |k: usize, s: &Sample| self.polygon.distance(k, &s.1) <= self.snap;
        let common = (0..self.polygon.sides()).any(|k| beyond(k, &a) && beyond(k, &b));
        let (m, depth) = (self.middle(&a, &b), self.left(depth));
        if depth == 0 {
            return self.line(&a, &b);
        }
        if self.depth_of(&m) > 4.0 * self.snap {
            self.resolve(a, m, depth - 1);
            self.resolve(m, b, depth - 1);
        } else if common {
            self.line(&a, &b);
        } else {
            self.outside(a, m, depth - 1);
            self.outside(m, b, depth - 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::clip::{COLLINEAR, clip};
    use super::super::piece::area;
    use super::*;

    /// The area of the part of a disc in the square, from its traced circle of two half edges.
    fn disc(center: [f64; 2], r: f64, snap: f64) -> f64 {
        let at = |angle: f64| Vector::<2>::new(center[0] + r * angle.cos(), center[1] + r * angle.sin());
        let mut chain = Vec::new();
        for half in 0..2 {
            let angle = |t: f64| std::f64::consts::PI * (f64::from(half) + t);
            chain.extend(trace(Polygon::Square, snap, [at(angle(0.0)), at(angle(1.0))], &mut |t| at(angle(t))));
        }
        area(&clip(Polygon::Square, chain, COLLINEAR))
    }

    #[test]
    fn discs_that_stick_out_touch_or_hold_the_square_have_their_exact_area() {
        use std::f64::consts::PI;
        let snap = 4e-14;
        // (centre, radius, area within the unit square)
        let segment = |r: f64, h: f64| r * r * (h / r).acos() - h * (r * r - h * h).sqrt();
        let cases = [
            ([0.5, 0.5], 0.3, PI * 0.09),
            ([0.5, 0.0], 0.3, PI * 0.045),
            ([0.0, 0.0], 0.5, PI * 0.0625),
            ([0.5, 0.5], 2.0, 1.0),
            ([0.5, 0.5], 0.5, PI * 0.25),
            ([0.5, 0.5], 0.6, PI * 0.36 - 4.0 * segment(0.6, 0.5)),
            ([0.5, -0.1], 0.3, segment(0.3, 0.1)),
            ([0.5, -0.299], 0.3, segment(0.3, 0.299)),
            ([3.0, 0.5], 1.0, 0.0),
            ([0.5, -2.0], 2.0 + 1e-7, segment(2.0 + 1e-7, 2.0)),
        ];
        for (center, r, expected) in cases {
            let found = disc(center, r, snap);
            assert!((found - expected).abs() < 1e-11, "{center:?} {r}: {found:e} {expected:e}");
        }
    }

    #[test]
    fn edges_that_leave_a_side_through_a_corner_are_the_side_up_to_it() {
        for i in 1..10 {
            for j in 1..10 {
                let (from, to) = (0.1 * f64::from(i), 1.0 + 0.1 * f64::from(j));
                let at = |t: f64| {
                    let p = from + (to - from) * t;
                    Vector::<2>::new(p, 0.3 * (p - 1.0).max(0.0))
                };
                let mut chain = trace(Polygon::Square, 4e-14, [at(0.0), at(1.0)], &mut |t| at(t));
                let corners = [at(1.0), Vector::<2>::new(to, 1.0), Vector::<2>::new(from, 1.0), at(0.0)];
                chain.extend(corners.windows(2).map(|w| EdgePiece::Line(w[0], w[1])));
                let found = area(&clip(Polygon::Square, chain, COLLINEAR));
                assert!((found - (1.0 - from)).abs() < 1e-12, "{from} {to}: {found:e}");
            }
        }
    }

    #[test]
    fn an_edge_that_crosses_a_side_everywhere_ends() {
        let mut count = 0;
        // along a side, within rounding that is taken to be smaller
        let pieces = trace(Polygon::Square, 4e-14, [Vector::<2>::new(-2.0, 0.0), Vector::<2>::new(3.0, 0.0)], &mut |t| {
            count += 1;
            let noise = (t.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
            Vector::<2>::new(5.0 * t - 2.0, 1e-9 * noise)
        });
        assert!(count < 2 * MOST_POINTS, "{count}");
        let ends = [pieces[0].from(), pieces[pieces.len() - 1].to()];
        assert_eq!(ends, [Vector::<2>::new(-2.0, 0.0), Vector::<2>::new(3.0, 0.0)]);
        assert!(pieces.windows(2).all(|w| w[0].to() == w[1].from()));
    }
}
