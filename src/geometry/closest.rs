//! The closest point of a map to a point: a tree of boxes, then Newton's method from several starts.
//!
//! Minimises f(xi) = |x(xi) - p|² / 2 over the closed cell of every element that a lower bound cannot rule out. Curves are
//! cut into pieces that are bisected while a bound on the curvature leaves room for a closer point, so the answer is the
//! closest one, not a local one. Surfaces and volumes start from the best points of a grid, points in a volume from the middle of an element.

use super::best_point::Best;
use super::feasible_step::{feasible_step, into_cell};
use super::opposed::Facing;
use super::rim_corners::RimCorners;
use super::{Bounds, Geometry, MapTable, Tree, cell};
use crate::basis::{Cell, Order, ScratchSlot};
use crate::linalg::{Matrix, Real, Vector, lit, num};
use crate::parallel;
use std::cell::RefCell;
use std::sync::OnceLock;

thread_local! {
    /// The table of the last search on this thread.
    static TABLE: RefCell<ScratchSlot> = RefCell::default();
}

/// Pieces of an element of a curve before bisection.
pub(super) const PIECES: usize = 8;
/// Bisections of a piece of a curve that a bound cannot rule out.
pub(super) const DEPTH: usize = 5;
/// Safety factor of the sampled bounds of second and third derivatives, which may miss their peaks.
const BEND_SAFETY: f64 = 2.0;
/// Elements are skipped unless they may be nearer than the best point by this share of the size.
pub(super) const WORTH: f64 = 1e-11;
/// Faces whose centres are this share of the size apart are the same face.
pub(super) const SAME_FACE: f64 = 1e-9;
/// A foot is beyond the rim if the line to it deviates from the right angle by more than this share of the size.
const BEYOND: f64 = 1e-9;
/// Steps of Newton's method; it converges in three to six.
const STEPS: usize = 60;

/// The closest point of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection<const D: usize, const N: usize, T: Real = f64> {
    /// The element.
    pub element: usize,
    /// Local coordinates in it, inside its closed cell.
    pub xi: Vector<D, T>,
    /// The closest point.
    pub x: Vector<N, T>,
    /// Distance to it \[length\].
    pub distance: T,
    /// Whether the closest point is an end (rim) of the curve (surface) and the point lies beyond it: the line between
    /// them is not at right angles to the map. Never set where D = N.
    pub rim: bool,
}

/// Closest-point search on one map, for many queries.
///
/// # Example
/// The point of a straight line nearest to (0.3, 2):
/// ```
/// use faying::{basis::BSpline, geometry::{ClosestPoint, ControlPoints}, linalg::Vector};
/// let points = vec![Vector::<2>::new(0.0, 0.0), Vector::<2>::new(1.0, 0.0)];
/// let line = ControlPoints { basis: BSpline::uniform(1, 1, 0), points };
/// let closest = ClosestPoint::<1, 2, _>::new(&line);
/// let foot = closest.project(&Vector::<2>::new(0.3, 2.0)).expect("a line has points");
/// assert!((foot.x[0] - 0.3).abs() < 1e-15 && (foot.distance - 2.0).abs() < 1e-15 && !foot.rim);
/// ```
#[derive(Clone, Debug)]
pub struct ClosestPoint<const D: usize, const N: usize, G, T: Real = f64> {
    geometry: G,
    tree: Tree<N, T>,
    size: T,
    /// Per element and face of its cell: whether no other element has that face; found when it is first asked for.
    loose: OnceLock<Vec<Vec<bool>>>,
    /// Corners of these faces, found when they are first asked for.
    corners: OnceLock<RimCorners<D, N, T>>,
    /// Per element of a curve: bounds of |x''| and |x'''|.
    bend: Vec<[T; 2]>,
    /// Ends of the pieces of every element of a curve, evaluated once for all queries.
    pub(super) nodes: Vec<[Node<N, T>; PIECES + 1]>,
    /// Normals of an oriented curve, found when they are first asked for; `None` of other maps.
    pub(super) facing: OnceLock<Option<Facing>>,
}

/// x, x' and x'' at an end of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node<const N: usize, T: Real> {
    pub x: Vector<N, T>,
    pub d: Vector<N, T>,
    dd: Vector<N, T>,
}

/// One sample of a curve: parameter, x, |x'|, f', f''.
#[derive(Clone, Copy)]
pub(super) struct Sample<const N: usize, T: Real> {
    pub t: T,
    pub x: Vector<N, T>,
    speed: T,
    pub slope: T,
    curvature: T,
}

impl<const N: usize, T: Real> Node<N, T> {
    /// Point `q` of a table with second derivatives along a curve.
    fn of<const D: usize>(table: &MapTable<D, N, T>, q: usize) -> Self {
        let dd = Vector::from_fn(|c, _| table.hessian[q][c][(0, 0)]);
        Self { x: table.x[q], d: table.jacobian[q].column(0).into_owned(), dd }
    }

    /// Position and derivatives of f(t) = |x - p|² / 2 at this point, which has the parameter `t`.
    pub fn seen(&self, t: T, p: &Vector<N, T>) -> Sample<N, T> {
        let away = self.x - p;
        let square = self.d.norm_squared();
        Sample { t, x: self.x, speed: square.sqrt(), slope: away.dot(&self.d), curvature: square + away.dot(&self.dd) }
    }
}

impl<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T>> ClosestPoint<D, N, G, T> {
    /// Builds the tree over the elements of `geometry` (a reference, a box or an `Arc` will do).
    pub fn new(geometry: G) -> Self {
        let elements = geometry.num_elements();
        let tree = Tree::new(geometry.all_bounds());
        let size = tree.bounds().map_or(T::zero(), |b| b.diagonal());
        let (bend, nodes) = parallel::map_init(if D == 1 { elements } else { 0 }, MapTable::new, |table, e| {
            geometry.map(e, &cell::grid::<D, T>(geometry.cell(e), 2 * PIECES + 1), Order::Hessians, table);
            let second = |q: usize| Vector::<N, T>::from_fn(|c, _| table.hessian[q][c][(0, 0)]);
            let greatest = |values: &mut dyn Iterator<Item = T>| values.fold(T::zero(), T::max) * lit(BEND_SAFETY);
            let bend = greatest(&mut (0..=2 * PIECES).map(|q| second(q).norm()));
            let change = greatest(&mut (0..2 * PIECES).map(|q| (second(q + 1) - second(q)).norm())) * num(2 * PIECES);
            // pieces end at every other point of the grid
            ([bend, change], std::array::from_fn(|i| Node::of(table, 2 * i)))
        })
        .into_iter()
        .unzip();
        Self { geometry, tree, size, loose: OnceLock::new(), corners: OnceLock::new(), bend, nodes, facing: OnceLock::new() }
    }

    /// The map.
    pub fn geometry(&self) -> &G {
        &self.geometry
    }

    /// The tree over the elements' boxes.
    pub fn tree(&self) -> &Tree<N, T> {
        &self.tree
    }

    /// Diagonal of the box around all elements \[length\].
    pub fn size(&self) -> T {
        self.size
    }

    /// The closest point to `x`; `None` if there are no elements or `x` is not finite.
    pub fn project(&self, x: &Vector<N, T>) -> Option<Projection<D, N, T>> {
        self.project_within(x, self.everywhere(x)?)
    }

    /// A reach that holds the whole map; `None` if there are no elements or `x` is not finite.
    fn everywhere(&self, x: &Vector<N, T>) -> Option<T> {
        let far = x.iter().all(|v| v.is_finite()).then(|| self.tree.bounds()).flatten()?;
        Some((far.distance(x) + far.diagonal()) * lit(2.0) + T::one())
    }

    /// An upper bound of the distance of a curve (D = 1) to `x`, above it by no more than half a piece of an element: the distance to the
    /// nearest end of a piece. No map is evaluated. `None` if there are no elements or `x` is not finite.
    pub(crate) fn distance_bound(&self, x: &Vector<N, T>) -> Option<T> {
        let mut least = self.everywhere(x)?;
        self.tree.nearest(x, least, |element| {
            least = self.nodes[element].iter().fold(least, |least, node| least.min((node.x - x).norm()));
            least
        });
        Some(least)
    }

    /// The closest point to `x` as [`project`](Self::project) finds it, without its `rim`.
    pub(crate) fn project_anywhere(&self, x: &Vector<N, T>) -> Option<Projection<D, N, T>> {
        let reach = self.everywhere(x)?;
        self.with_table(|table| self.nearest(x, reach, table))
    }

    /// The closest point to `x` nearer than `reach`; `None` if there is none.
    pub fn project_within(&self, x: &Vector<N, T>, reach: T) -> Option<Projection<D, N, T>> {
        if !x.iter().all(|v| v.is_finite()) {
            return None;
        }
        self.with_table(|table| {
            let found = self.nearest(x, reach, table)?;
            let rim = D < N && self.beyond_rim(&found, x, table);
            Some(Projection { rim, ..found })
        })
    }

    /// Calls `search` with the table of this thread.
    fn with_table<R>(&self, search: impl FnOnce(&mut MapTable<D, N, T>) -> R) -> R {
        let mut table = TABLE.with_borrow_mut(|slot| slot.take::<MapTable<D, N, T>>());
        let found = search(&mut table);
        TABLE.with_borrow_mut(|slot| slot.keep(table));
        found
    }

    fn nearest(&self, x: &Vector<N, T>, reach: T, table: &mut MapTable<D, N, T>) -> Option<Projection<D, N, T>> {
        if let Some(found) = self.inside(x, table).filter(|found| found.distance < reach) {
            return Some(found);
        }
        let mut best = Best { element: 0, xi: Vector::zeros(), x: *x, distance: reach, found: false, sample: None };
        let worth = self.size * lit(WORTH);
        self.tree.nearest(x, reach, |element| {
            if D == 1 {
                self.search_curve(element, x, &mut best, table);
            } else {
                self.search_cell(element, x, &mut best, table);
            }
            (best.distance - worth).max(T::zero())
        });
        if !best.found {
            return None;
        }
        if D == 1 {
            self.polish(x, &mut best, table);
        }
        Some(Projection { element: best.element, xi: best.xi, x: best.x, distance: best.distance, rim: false })
    }

    /// The point of one element closest to `x`, without its `rim`.
    pub(crate) fn project_on(&self, element: usize, x: &Vector<N, T>) -> Projection<D, N, T> {
        let far = T::max_value().unwrap_or_else(T::one);
        let mut best = Best { element, xi: Vector::zeros(), x: *x, distance: far, found: false, sample: None };
        self.search_cell(element, x, &mut best, &mut MapTable::new());
        Projection { element, xi: best.xi, x: best.x, distance: best.distance, rim: false }
    }

    /// The least distance to `x` on one element downhill from `start`, without its `rim`.
    pub(crate) fn descend_from(&self, element: usize, x: &Vector<N, T>, start: Vector<D, T>) -> Projection<D, N, T> {
        let (xi, at, distance) = self.descend(self.geometry.cell(element), element, x, start, &mut MapTable::new());
        Projection { element, xi, x: at, distance, rim: false }
    }

    fn loose(&self) -> &[Vec<bool>] {
        self.loose.get_or_init(|| loose_faces(&self.geometry, self.size * lit(SAME_FACE)))
    }

    fn beyond_rim(&self, best: &Projection<D, N, T>, p: &Vector<N, T>, table: &mut MapTable<D, N, T>) -> bool {
        let kind = self.geometry.cell(best.element);
        let faces = cell::faces::<D, T>(kind);
        let tiny = T::default_epsilon() * lit(8.0);
        let at = |f: usize| match kind {
            Cell::Tensor => (best.xi[f / 2] - num(f % 2)).abs() <= tiny,
            Cell::Simplex if f < D => best.xi[f].abs() <= tiny,
            Cell::Simplex => (best.xi.sum() - T::one()).abs() <= tiny,
        };
        let away = p - best.x;
        let allowed = self.size * lit(BEYOND);
        if !(0..faces.len()).any(|f| at(f) && self.loose()[best.element].get(f).copied().unwrap_or(false)) {
            // an element may touch the rim in a corner alone
            let is_corner = D == 2 && (0..faces.len()).filter(|&f| at(f)).count() == 2;
            let corners = || self.corners.get_or_init(|| RimCorners::of(&self.geometry, self.loose()));
            return is_corner
                && away.norm() > allowed
                && corners().beyond(&self.geometry, &best.x, &away, [self.size * lit(SAME_FACE), allowed]);
        }
        self.geometry.map(best.element, &[best.xi], Order::Gradients, table);
        (0..D).any(|k| {
            let t = table.jacobian[0].column(k);
            let length = t.norm();
            length > T::zero() && (away.dot(&t) / length).abs() > allowed
        })
    }

    pub(super) fn sample(&self, element: usize, t: T, p: &Vector<N, T>, table: &mut MapTable<D, N, T>) -> Sample<N, T> {
        self.geometry.map(element, &[Vector::repeat(t)], Order::Hessians, table);
        Node::of(table, 0).seen(t, p)
    }

    /// Searches every piece of an element of a curve (D = 1) that may hold a closer point.
    fn search_curve(&self, element: usize, p: &Vector<N, T>, best: &mut Best<D, N, T>, table: &mut MapTable<D, N, T>) {
        let samples: [Sample<N, T>; PIECES + 1] = std::array::from_fn(|i| self.nodes[element][i].seen(num::<T>(i) / num(PIECES), p));
        for s in &samples {
            best.offer_sample(element, s, p);
        }
        let worth = self.size * lit(WORTH);
        // bisection takes one piece and leaves two: the list grows by one per depth at most
        let mut pieces = [(T::zero(), samples[0], samples[0], 0); PIECES + DEPTH];
        let mut open = 0;
        for w in samples.windows(2) {
            let below = self.below(element, p, &w[0], &w[1]);
            if below <= best.distance - worth {
                pieces[open] = (below, w[0], w[1], 0);
                open += 1;
            }
        }
        // nearest piece first: a close point rules out the others
        pieces[..open].sort_by(|a, b| b.0.partial_cmp(&a.0).unwrap_or(std::cmp::Ordering::Equal));
        while open > 0 {
            open -= 1;
            let (below, a, b, depth) = pieces[open];
            if below > best.distance - worth {
                continue;
            }
            if a.slope < T::zero() && b.slope > T::zero() {
                self.newton(element, p, (a, b), table, |s| best.offer_sample(element, s, p));
            }
            if self.convex(element, p, &a, &b) || depth == DEPTH || self.below(element, p, &a, &b) > best.distance - worth {
                continue;
            }
            let m = self.sample(element, (a.t + b.t) * lit(0.5), p, table);
            best.offer_sample(element, &m, p);
            for (a, b) in [(a, m), (m, b)] {
                pieces[open] = (self.below(element, p, &a, &b), a, b, depth + 1);
                open += 1;
            }
        }
    }

    /// Lower bound of the distance of `p` to the piece: distance to the chord less |x''| h² / 8.
    pub(super) fn below(&self, element: usize, p: &Vector<N, T>, a: &Sample<N, T>, b: &Sample<N, T>) -> T {
        let chord = b.x - a.x;
        let square = chord.norm_squared();
        let s = if square > T::zero() { ((p - a.x).dot(&chord) / square).clamp(T::zero(), T::one()) } else { T::zero() };
        let h = b.t - a.t;
        (a.x + chord * s - p).norm() - self.bend[element][0] * h * h * lit(0.125)
    }

    /// Whether f'' > 0 on the piece, so that f has no second minimum: |f'''| <= 3 |x'| |x''| + |x - p| |x'''| bounds how far
    /// f'' falls below its mean at the ends.
    pub(super) fn convex(&self, element: usize, p: &Vector<N, T>, a: &Sample<N, T>, b: &Sample<N, T>) -> bool {
        let ([bend, change], h) = (self.bend[element], b.t - a.t);
        let speed = a.speed.max(b.speed) + bend * h * lit(0.5);
        let away = (a.x - p).norm().max((b.x - p).norm()) + speed * h * lit(0.5);
        let slope = speed * bend * lit(3.0) + away * change;
        a.curvature + b.curvature > slope * h
    }

    /// Finds the zero of f' between `a` (f' < 0) and `b` (f' > 0) by Newton's method, bisection where it leaves the bracket; `see` is
    /// shown every iterate, the zero last.
    pub(super) fn newton(
        &self,
        element: usize,
        p: &Vector<N, T>,
        (a, b): (Sample<N, T>, Sample<N, T>),
        table: &mut MapTable<D, N, T>,
        mut see: impl FnMut(&Sample<N, T>),
    ) {
        let (mut lo, mut hi) = (a.t, b.t);
        let mut t = lo + (hi - lo) * (a.slope / (a.slope - b.slope));
        for _ in 0..STEPS {
            let s = self.sample(element, t, p, table);
            see(&s);
            if s.slope == T::zero() {
                break;
            }
            if s.slope < T::zero() {
                lo = t
            } else {
                hi = t
            }
            let step = t - s.slope / s.curvature;
            let next = if s.curvature > T::zero() && step > lo && step < hi { step } else { (lo + hi) * lit(0.5) };
            if (next - t).abs() <= T::default_epsilon() * lit(2.0) {
                break;
            }
            t = next;
        }
    }

    /// Polishes the best point of a curve (D = 1): its distance is accurate to rounding, its parameter only to the root of that.
    ///
    /// Near the foot the distance varies quadratically, so the foot may lie in a piece that was ruled out.
    fn polish(&self, p: &Vector<N, T>, best: &mut Best<D, N, T>, table: &mut MapTable<D, N, T>) {
        let mut at = best.sample.unwrap_or_else(|| self.sample(best.element, best.xi[0], p, table));
        let allowed = best.distance + self.size * lit(WORTH);
        for _ in 0..STEPS {
            if at.curvature <= T::zero() {
                break;
            }
            let t = (at.t - at.slope / at.curvature).clamp(T::zero(), T::one());
            let next = self.sample(best.element, t, p, table);
            let distance = (next.x - p).norm();
            if next.slope.abs() >= at.slope.abs() || distance > allowed {
                break;
            }
            at = next;
            (best.xi, best.x, best.distance) = (Vector::repeat(at.t), at.x, distance);
        }
    }

    /// Searches an element with D > 1: Newton's method with active faces from the best points of a grid.
    fn search_cell(&self, element: usize, p: &Vector<N, T>, best: &mut Best<D, N, T>, table: &mut MapTable<D, N, T>) {
        const STARTS: usize = 3;
        let kind = self.geometry.cell(element);
        let points = cell::grid::<D, T>(kind, 4);
        self.geometry.map(element, &points, Order::Values, table);
        let mut order: Vec<(T, usize)> = table.x.iter().enumerate().map(|(q, x)| ((x - p).norm(), q)).collect();
        order.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        for &(distance, q) in &order {
            best.offer(element, points[q], table.x[q], distance);
        }
        // starts next to each other mostly end in the same point
        let mut starts: Vec<Vector<D, T>> = Vec::new();
        for &(_, q) in &order {
            if starts.len() < STARTS && starts.iter().all(|s| (s - points[q]).amax() > lit(0.34)) {
                starts.push(points[q]);
            }
        }
        let done = self.size * T::default_epsilon() * lit(16.0);
        for start in starts {
            let found = self.descend(kind, element, p, start, table);
            best.offer(element, found.0, found.1, found.2);
            if best.distance <= done {
                break;
            }
        }
    }

    fn descend(
        &self,
        kind: Cell,
        element: usize,
        p: &Vector<N, T>,
        start: Vector<D, T>,
        table: &mut MapTable<D, N, T>,
    ) -> (Vector<D, T>, Vector<N, T>, T) {
        let mut xi = start;
        self.geometry.map(element, &[xi], Order::Hessians, table);
        let mut x = table.x[0];
        for _ in 0..STEPS {
            let (j, away) = (table.jacobian[0], x - p);
            let slope: Vector<D, T> = j.tr_mul(&away);
            let gauss: Matrix<D, D, T> = j.tr_mul(&j);
            let mut full = gauss;
            for c in 0..N {
                full += table.hessian[0][c] * away[c];
            }
            // in turn: full Hessian (quadratic), Gauss-Newton (descends where the map is regular), damped (descends everywhere)
            let mut moved = false;
            let mut damped = gauss;
            for k in 0..D {
                damped[(k, k)] += gauss.trace() * lit(0.1);
            }
            'matrices: for h in [full, gauss, damped] {
                let Some(step) = feasible_step(kind, &xi, &slope, &h) else { continue };
                let mut scale = T::one();
                for _ in 0..30 {
                    let trial = into_cell(kind, xi + step * scale);
                    if (trial - xi).amax() <= T::default_epsilon() {
                        break;
                    }
                    self.geometry.map(element, &[trial], Order::Values, table);
                    if (table.x[0] - p).norm_squared() < away.norm_squared() {
                        xi = trial;
                        moved = true;
                        break 'matrices;
                    }
                    scale *= lit(0.5);
                }
            }
            if !moved {
                break;
            }
            self.geometry.map(element, &[xi], Order::Hessians, table);
            let last = x;
            x = table.x[0];
            if (x - last).norm() <= self.size * T::default_epsilon() * lit(0.5) {
                break;
            }
        }
        (xi, x, (x - p).norm())
    }
}

/// Per element and face: whether no other element has a face with the same centre.
fn loose_faces<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T>>(geometry: &G, tolerance: T) -> Vec<Vec<bool>> {
    let mut table = MapTable::new();
    let mut centers: Vec<Vector<N, T>> = Vec::new();
    let mut start = vec![0];
    for e in 0..geometry.num_elements() {
        let points: Vec<Vector<D, T>> = cell::faces(geometry.cell(e)).into_iter().map(|f| f.center).collect();
        geometry.map(e, &points, Order::Values, &mut table);
        centers.extend_from_slice(&table.x);
        start.push(centers.len());
    }
    let tree = Tree::new(centers.iter().map(|c| Bounds { lo: *c, hi: *c }).collect());
    let alone = |c: &Vector<N, T>| tree.meeting(&Bounds { lo: *c, hi: *c }.inflated(tolerance)).len() == 1;
    start.windows(2).map(|w| centers[w[0]..w[1]].iter().map(alone).collect()).collect()
}

/// The closest point of `target` to `x`; for many queries keep a [`ClosestPoint`].
pub fn closest_point<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized>(
    target: &G,
    x: &Vector<N, T>,
) -> Option<Projection<D, N, T>> {
    ClosestPoint::new(target).project(x)
}
