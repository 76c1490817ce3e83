//! Quadrature of a slave side against an obstacle that ends within its elements.
//!
//! The points of an element that a rim of the obstacle crosses are those of parts of it: halves of halves until the rim is a straight line in each,
//! along which it is cut. Elements that face the obstacle as a whole, or not at all, keep their rule.

use super::{Obstacle, opposed};
use crate::basis::Order;
use crate::coupling::interface::{Segments, slave_segments};
use crate::geometry::{Bounds, MapTable, cell};
use crate::linalg::Vector;
use crate::parallel;
use crate::quadrature::{PerElement, Quadrature, Rule, simplex_rule};
use crate::space::Trace;
use std::sync::Arc;

/// Most halvings of an element that a rim crosses, until the rim is straight in every part: those that hold its corners are the smallest.
const HALVINGS: usize = 14;
/// Most halvings of an element in the search for an obstacle smaller than it.
const SEARCHES: usize = 7;
/// Most parts of an element at a time that are halved again.
const MOST_PARTS: usize = 2000;
/// Steps of bisection to a rim on an edge, for the shape of the rim and for the integral.
const BISECTIONS: [usize; 2] = [14, 40];
/// A part may hold an obstacle if it is no farther from it than the nearest point of the side, and this share of its size.
const NEAR: f64 = 0.1;
/// Sizes of an obstacle below this share of its largest one are none: it is a surface.
const FLAT: f64 = 1e-9;

/// Height of a rim over its chord, as a share of that, up to which it is straight.
const SAG: f64 = 8e-3;

/// Nothing where a point faces nothing, and the gap where it faces the obstacle \[length\].
type Seen = Option<f64>;

/// A part of an element: its corners, around it.
type Part<const S: usize> = Vec<Vector<S>>;

/// Returns points on every element of `slave`: those of `rules`, but for the elements in which one of `targets` ends.
///
/// `targets`: the obstacle at some of its places. An element is divided where it faces one of them in part, no farther from it than the
/// nearest point of the side and its own size together.
pub fn points_at_rims<const S: usize, const N: usize>(
    slave: &Trace<S, N>,
    targets: &[Box<dyn Obstacle<S, N>>],
    rules: &PerElement<S>,
) -> Segments<S> {
    let boxes = slave.space.all_bounds();
    let first = parallel::map_init(boxes.len(), MapTable::new, |table, e| {
        let points: Vec<Vector<S>> = [rules.rule(e).points.clone(), corners(slave, e)].concat();
        let look = Look { slave, element: e };
        let seen: Vec<Vec<Seen>> = targets.iter().map(|target| look.at(&**target, &points, table)).collect();
        (seen, std::mem::take(&mut table.x))
    });
    let (first, places): (Vec<Vec<Vec<Seen>>>, Vec<Vec<Vector<N>>>) = first.into_iter().unzip();
    let goals: Vec<Goal<'_, S, N>> =
        targets.iter().enumerate().map(|(k, target)| Goal::new(&**target, &places, first.iter().map(|f| &f[k]))).collect();
    let cut = parallel::map_init(boxes.len(), MapTable::new, |table, e| {
        goals.iter().zip(&first[e]).any(|(goal, seen)| goal.asks(seen, &boxes[e])).then(|| {
            let (look, mut out) = (Look { slave, element: e }, Rule::default());
            let degree = 4 * slave.space.degree(e).into_iter().max().unwrap_or(1) + 2;
            let divided = Divided { look, goals: &goals, rule: rules.rule(e), triangles: simplex_rule(degree) };
            divided.divide(corners(slave, e), table, &mut out);
            out
        })
    });
    let (mut all, mut which) = (rules.rules().to_vec(), rules.which().to_vec());
    for (which, rule) in which.iter_mut().zip(cut).filter_map(|(which, rule)| Some((which, rule?))) {
        *which = all.len();
        all.push(Arc::new(rule));
    }
    slave_segments(&*slave.space, &PerElement::new(all, which))
}

/// The corners of an element, around it.
fn corners<const S: usize, const N: usize>(slave: &Trace<S, N>, element: usize) -> Part<S> {
    let mut corners = cell::corners::<S, f64>(slave.space.cell(element));
    if corners.len() == 4 {
        corners.swap(2, 3);
    }
    corners
}

/// The obstacle at one of its places.
struct Goal<'a, const S: usize, const N: usize> {
    target: &'a dyn Obstacle<S, N>,
    /// The least gap of the side.
    least: f64,
    /// The box around the obstacle, and the least distance of points of the side from it.
    extent: Option<(Bounds<N>, f64)>,
    /// The least size of the obstacle \[length\].
    size: f64,
}

impl<'a, const S: usize, const N: usize> Goal<'a, S, N> {
    fn new<'b>(target: &'a dyn Obstacle<S, N>, places: &[Vec<Vector<N>>], seen: impl Iterator<Item = &'b Vec<Seen>>) -> Self {
        let extent = target.extent().map(|b| (b, places.iter().flatten().map(|x| b.distance(x)).fold(f64::INFINITY, f64::min)));
        let sizes = extent.as_ref().map_or_else(Vector::zeros, |(b, _)| b.hi - b.lo);
        let size = sizes.iter().copied().filter(|d| *d > FLAT * sizes.amax()).fold(f64::INFINITY, f64::min);
        Self { target, least: seen.flat_map(|seen| least(seen)).fold(f64::INFINITY, f64::min), extent, size }
    }

    /// Whether a part within `bounds` may hold an obstacle that is smaller than the part.
    fn may_hide(&self, bounds: &Bounds<N>) -> bool {
        let near = |(b, nearest): &(Bounds<N>, f64)| apart(bounds, b) <= nearest + NEAR * bounds.diagonal();
        bounds.diagonal() > 0.5 * self.size && self.extent.as_ref().is_some_and(near)
    }

    /// Whether the element within `bounds`, with points that see this, has to be divided.
    fn asks(&self, seen: &[Seen], bounds: &Bounds<N>) -> bool {
        match mixed(seen) {
            true => least(seen).is_some_and(|gap| gap <= self.least + bounds.diagonal()),
            false => seen.iter().all(Option::is_none) && self.may_hide(bounds),
        }
    }
}

/// Distance of two boxes.
fn apart<const N: usize>(a: &Bounds<N>, b: &Bounds<N>) -> f64 {
    Vector::<N>::from_fn(|k, _| (a.lo[k] - b.hi[k]).max(b.lo[k] - a.hi[k]).max(0.0)).norm()
}

fn mixed(seen: &[Seen]) -> bool {
    seen.iter().any(Option::is_some) && seen.iter().any(Option::is_none)
}

fn least(seen: &[Seen]) -> Option<f64> {
    seen.iter().flatten().copied().reduce(f64::min)
}

/// The crossing of a part of an element by a rim.
struct Cut {
    /// The edges that it crosses, by the numbers of their corners.
    edges: Vec<(usize, usize)>,
    /// Whether each corner faces the obstacle.
    faces: Vec<bool>,
    /// Whether the rim is straight between two crossed edges; in the plane, whether it is one point.
    is_straight: bool,
}

/// The view from an element.
#[derive(Clone, Copy)]
struct Look<'a, const S: usize, const N: usize> {
    slave: &'a Trace<S, N>,
    element: usize,
}

impl<const S: usize, const N: usize> Look<'_, S, N> {
    fn at(&self, target: &dyn Obstacle<S, N>, xi: &[Vector<S>], table: &mut MapTable<S, N>) -> Vec<Seen> {
        self.slave.space.map(self.element, xi, Order::Gradients, table);
        let points = table.x.iter().zip(&table.jacobian);
        points.map(|(x, jacobian)| opposed(target, x, &self.slave.normal(self.element, jacobian)).map(|hit| hit.gap)).collect()
    }
}

/// An element that is divided.
struct Divided<'a, const S: usize, const N: usize> {
    look: Look<'a, S, N>,
    goals: &'a [Goal<'a, S, N>],
    /// The rule of the whole element.
    rule: &'a Rule<S>,
    /// The rule of the triangles of which cut pieces are made.
    triangles: Rule<S>,
}

impl<const S: usize, const N: usize> Divided<'_, S, N> {
    /// Adds the points of the element with the corners `whole`.
    fn divide(&self, whole: Part<S>, table: &mut MapTable<S, N>, out: &mut Rule<S>) {
        let mut parts = vec![whole];
        for level in 0..=HALVINGS {
            let is_last = level == HALVINGS || parts.len() > MOST_PARTS;
            let mut next = Vec::new();
            for part in parts {
                let (crossed, hidden) = self.rims_in(&part, table);
                let halved = match &crossed {
                    Some((cut, _)) if cut.is_straight => false,
                    Some(_) => !is_last,
                    None => hidden && !is_last && level < SEARCHES,
                };
                match crossed {
                    _ if halved => next.extend(halves(&part)),
                    Some((cut, target)) => self.add_cut(&part, &cut, target, table, out),
                    None => self.add_by(&part, self.rule, out),
                }
            }
            parts = next;
        }
    }

    /// The first target that `part` faces in part, with the cut along its rim; and whether a target may hide in the part.
    fn rims_in(&self, part: &Part<S>, table: &mut MapTable<S, N>) -> (Option<(Cut, &dyn Obstacle<S, N>)>, bool) {
        let middle = part.iter().sum::<Vector<S>>() / part.len() as f64;
        // beside the corners, which may lie on the rim itself
        let inner = part.iter().map(|corner| middle + (corner - middle) * 0.999);
        let points: Vec<Vector<S>> = inner.chain([middle]).chain(self.mapped(part, self.rule).points).collect();
        let (mut crossed, mut hidden) = (None, false);
        for goal in self.goals {
            let seen = self.look.at(goal.target, &points, table);
            hidden |= seen.iter().all(Option::is_none) && Bounds::around(&table.x).is_some_and(|bounds| goal.may_hide(&bounds));
            if crossed.is_none() && mixed(&seen) {
                crossed = Some((self.cut(part, goal.target, (&points, &seen), table), goal.target));
            }
        }
        (crossed, hidden)
    }

    /// Finds the edges of `part` that the rim of `target` crosses, and whether it is straight between them; given some points of the part and
    /// what they see.
    fn cut(&self, part: &Part<S>, target: &dyn Obstacle<S, N>, known: (&[Vector<S>], &[Seen]), table: &mut MapTable<S, N>) -> Cut {
        let faces: Vec<bool> = self.look.at(target, part, table).iter().map(Option::is_some).collect();
        let count = part.len();
        let edges = (0..if S == 1 { 1 } else { count }).map(|k| (k, (k + 1) % count));
        let crossed: Vec<(usize, usize)> = edges.filter(|(a, b)| faces[*a] != faces[*b]).collect();
        let mut cut = Cut { edges: crossed, faces, is_straight: false };
        if cut.edges.len() == S {
            let rim = self.rim(part, &cut, target, BISECTIONS[0], table);
            cut.is_straight = match rim[..] {
                [at] => {
                    known.0.iter().zip(known.1).all(|(x, seen)| (x - at).amax() < SAG || seen.is_some() == (cut.faces[0] == (x[0] < at[0])))
                }
                [a, b] => self.is_straight([a, b], cut.faces[cut.edges[0].1], target, known, table),
                _ => false,
            };
        }
        cut
    }

    /// Adds the points of both pieces of `part`, or of the whole where no two edges are crossed.
    fn add_cut(&self, part: &Part<S>, cut: &Cut, target: &dyn Obstacle<S, N>, table: &mut MapTable<S, N>, out: &mut Rule<S>) {
        if cut.edges.len() != S {
            return self.add_by(part, self.rule, out);
        }
        let rim = self.rim(part, cut, target, BISECTIONS[1], table);
        let [first, last] = [cut.edges[0], cut.edges[S - 1]];
        if S == 1 {
            return [[part[0], rim[0]], [rim[0], part[1]]].iter().for_each(|half| self.add_by(half, self.rule, out));
        }
        // around both pieces: from a crossing along the corners to the other one
        let count = part.len();
        let along = |from: usize, to: usize| (0..).map(move |k| (from + k) % count).take((to + count - from) % count + 1);
        for (a, b, from, to) in [(rim[0], rim[1], first.1, last.0), (rim[1], rim[0], last.1, first.0)] {
            let piece: Part<S> = std::iter::once(a).chain(along(from, to).map(|k| part[k])).chain([b]).collect();
            (1..piece.len() - 1).for_each(|k| self.add_by(&[piece[0], piece[k], piece[k + 1]], &self.triangles, out));
        }
    }

    /// The places of the rim of `target` on the edges of a cut, by so many steps of bisection.
    fn rim(&self, part: &Part<S>, cut: &Cut, target: &dyn Obstacle<S, N>, steps: usize, table: &mut MapTable<S, N>) -> Vec<Vector<S>> {
        let mut on_edge = |&(a, b): &(usize, usize)| {
            let (faces, mut near, mut far) = (cut.faces[a], part[a], part[b]);
            for _ in 0..steps {
                let middle = (near + far) * 0.5;
                *(if self.look.at(target, &[middle], table)[0].is_some() == faces { &mut near } else { &mut far }) = middle;
            }
            (near + far) * 0.5
        };
        cut.edges.iter().map(&mut on_edge).collect()
    }

    /// Whether the rim of `target` between the places `ends` is a straight line, with what faces it on its right if `right`: beside some of its
    /// places, and at `known` points.
    fn is_straight(
        &self,
        ends: [Vector<S>; 2],
        right: bool,
        target: &dyn Obstacle<S, N>,
        (points, seen): (&[Vector<S>], &[Seen]),
        table: &mut MapTable<S, N>,
    ) -> bool {
        let chord = ends[1] - ends[0];
        let across = Vector::<S>::from_fn(|k, _| if k == 0 { chord[1] } else { -chord[0] });
        let height = |x: &Vector<S>| across.dot(&(x - ends[0])) / chord.norm_squared();
        let beside: Vec<Vector<S>> =
            [0.1, 0.4, 0.7].into_iter().flat_map(|s| [-SAG, SAG].map(|h| ends[0] + chord * s + across * h)).collect();
        let found = self.look.at(target, &beside, table);
        let agrees = |(x, seen): (&Vector<S>, &Seen)| height(x).abs() < 0.5 * SAG || seen.is_some() == (right == (height(x) > 0.0));
        points.iter().zip(seen).chain(beside.iter().zip(&found)).all(agrees)
    }

    fn add_by(&self, part: &[Vector<S>], rule: &Rule<S>, out: &mut Rule<S>) {
        let mapped = self.mapped(part, rule);
        out.points.extend(mapped.points);
        out.weights.extend(mapped.weights);
    }

    /// A rule on a parallelogram, a triangle or an interval.
    fn mapped(&self, part: &[Vector<S>], rule: &Rule<S>) -> Rule<S> {
        // the first and the last corner are next to that at the origin of the cell
        let axes: [Vector<S>; S] = std::array::from_fn(|k| if k == 0 { part[1] - part[0] } else { part[part.len() - 1] - part[0] });
        let size = if S == 1 { axes[0][0] } else { axes[0][0] * axes[1][1] - axes[0][1] * axes[1][0] };
        let place = |xi: &Vector<S>| (0..S).fold(part[0], |x, k| x + axes[k] * xi[k]);
        Rule { points: rule.points.iter().map(place).collect(), weights: rule.weights.iter().map(|w| w * size.abs()).collect() }
    }
}

/// The halves of an interval, or the quarters of a parallelogram or triangle.
fn halves<const S: usize>(part: &Part<S>) -> Vec<Part<S>> {
    let half = |a: usize, b: usize| (part[a] + part[b]) * 0.5;
    let p = |k: usize| part[k];
    match part.len() {
        2 => vec![vec![p(0), half(0, 1)], vec![half(0, 1), p(1)]],
        3 => {
            let (a, b, c) = (half(0, 1), half(1, 2), half(2, 0));
            vec![vec![p(0), a, c], vec![a, p(1), b], vec![c, b, p(2)], vec![b, c, a]]
        }
        _ => {
            let (a, b, c, d, m) = (half(0, 1), half(1, 2), half(2, 3), half(3, 0), half(0, 2));
            vec![vec![p(0), a, m, d], vec![a, p(1), b, m], vec![d, m, c, p(3)], vec![m, b, p(2), c]]
        }
    }
}
