//! Whether the functions of a multiplier jump or kink between the elements of the slave side, inside of the elements of what it faces.
//!
//! Values, and gradients along the surface and across the edge, are compared on both sides of the middle of every edge that two elements have
//! in common (of curves: of every end). A function jumps or kinks there if they differ by more than half of what they are together; gradients of
//! Lagrange functions do, by all of it, those of smooth splines do not, on curved facets up to what these turn. Edges that lie on borders of the master's elements
//! do no harm to sums over these; each is looked at in three places.

use crate::basis::{Basis, Cell, Order, ShapeTable};
use crate::geometry::{ClosestPoint, MapTable};
use crate::linalg::{Matrix, Vector, inverse};
use crate::problem::model::BodySide;
use crate::space::Space;
use std::collections::{BTreeMap, HashMap};

/// Difference of values or gradients over the sum of their sizes from which on a function jumps or kinks.
const BREAK: f64 = 0.5;
/// Places that agree to this part of the side's size are one.
const SAME: f64 = 1e-7;
/// Local coordinates that are nearer to a border are on it.
const BORDER: f64 = 1e-6;
/// Places on an edge; an edge across the master's grid may meet borders at one of them.
const PLACES: [f64; 3] = [0.5, 0.29, 0.71];

/// Shares of the edges between two elements of a slave side.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Breaks {
    /// At which a function jumps or kinks.
    pub broken: f64,
    /// At which one does, and which lie inside of the master's elements.
    pub inside: f64,
}

/// A function at a point of an edge: value, and gradient along the surface across the edge.
type Values<const N: usize> = BTreeMap<usize, (f64, Vector<N>)>;

/// Ends of the edges of a cell; of an interval, each end twice.
fn edges<const S: usize>(cell: Cell) -> Vec<[Vector<S>; 2]> {
    if S > 1 && cell == Cell::Simplex {
        let vertex = |k: usize| Vector::<S>::from_fn(|i, _| if i + 1 == k { 1.0 } else { 0.0 });
        return (0..=S).flat_map(|a| (0..a).map(move |b| [vertex(a), vertex(b)])).collect();
    }
    let end = |k: usize, at: f64, along: f64| Vector::<S>::from_fn(|i, _| if i == k { at } else { along });
    (0..S).flat_map(|k| [0.0, 1.0].map(|at| [0.0, 1.0].map(|along| end(k, at, along)))).collect()
}

/// Shares of the edges of a slave side at which functions of `psi` jump or kink; zero of a single element.
pub(super) fn breaks<const S: usize, const N: usize>(space: &dyn Space<S, N>, psi: &dyn Basis<S>, masters: &[&BodySide<S, N>]) -> Breaks {
    let size = space.extent().map_or(1.0, |b| b.diagonal()) * SAME;
    let mut seen: HashMap<[i64; N], Values<N>> = HashMap::new();
    let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    let (mut common, mut broken) = (0, Vec::new());
    for e in 0..psi.num_elements() {
        let edges = edges::<S>(space.cell(e));
        let middles: Vec<_> = edges.iter().map(|[a, b]| (a + b) * 0.5).collect();
        space.map(e, &middles, Order::Gradients, &mut map);
        psi.active(e, &mut ids);
        psi.tabulate(e, &middles, Order::Gradients, &mut table);
        for (q, x) in map.x.iter().enumerate() {
            // J (Jᵀ J)^-1 takes a gradient to that along the surface
            let jacobian = &map.jacobian[q];
            let Some(inverse) = inverse(&Matrix::<S, S>::from_fn(|i, j| jacobian.column(i).dot(&jacobian.column(j)))) else { continue };
            // of a curve there is no direction along the edge
            let along = (jacobian * (edges[q][1] - edges[q][0])).try_normalize(0.0).unwrap_or_else(Vector::zeros);
            let across = |g: Vector<N>| g - along * along.dot(&g);
            let functions = ids.iter().zip(table.values(q)).zip(table.grads(q));
            let own: Values<N> = functions.map(|((&j, &v), g)| (j, (v, across(jacobian * (inverse * g))))).collect();
            let key = std::array::from_fn(|k| (x[k] / size).round() as i64);
            let Some(other) = seen.remove(&key) else {
                seen.insert(key, own);
                continue;
            };
            common += 1;
            if break_between(&own, &other) {
                broken.push((e, edges[q]));
            }
        }
    }
    let share = |count: usize| if common == 0 { 0.0 } else { count as f64 / common as f64 };
    let inside = if broken.is_empty() { 0 } else { num_inside(space, &broken, masters) };
    Breaks { broken: share(broken.len()), inside: share(inside) }
}

/// Whether a function jumps or kinks between the values on both sides of a point.
fn break_between<const N: usize>(own: &Values<N>, other: &Values<N>) -> bool {
    let zero = (0.0, Vector::<N>::zeros());
    let pairs: Vec<_> = own.keys().chain(other.keys()).map(|j| [own, other].map(|list| list.get(j).unwrap_or(&zero))).collect();
    let differ = |size: &dyn Fn(&(f64, Vector<N>)) -> f64, apart: &dyn Fn(&[&(f64, Vector<N>); 2]) -> f64| {
        let scale = pairs.iter().flatten().map(|v| size(v)).fold(0.0, f64::max);
        pairs.iter().any(|pair| {
            let sum = size(pair[0]) + size(pair[1]);
            sum > BREAK * scale && apart(pair) > BREAK * sum
        })
    };
    differ(&|v| v.0.abs(), &|[a, b]| (a.0 - b.0).abs()) || differ(&|v| v.1.norm(), &|[a, b]| (a.1 - b.1).norm())
}

/// Number of edges of elements that lie inside of the elements of a master.
fn num_inside<const S: usize, const N: usize>(
    space: &dyn Space<S, N>,
    edges: &[(usize, [Vector<S>; 2])],
    masters: &[&BodySide<S, N>],
) -> usize {
    let closest: Vec<_> = masters.iter().map(|master| (master, ClosestPoint::new(master.trace.oriented()))).collect();
    let mut map = MapTable::new();
    let mut is_inside = |&(e, [a, b]): &(usize, [Vector<S>; 2])| {
        space.map(e, &PLACES.map(|t| a + (b - a) * t), Order::Values, &mut map);
        map.x.iter().any(|x| {
            closest.iter().any(|(master, closest)| {
                let Some(foot) = closest.project(x) else { return false };
                let border = match master.trace.space.cell(foot.element) {
                    Cell::Simplex if S > 1 => foot.xi.iter().copied().fold(1.0 - foot.xi.sum(), f64::min),
                    _ => foot.xi.iter().map(|v| v.min(1.0 - v)).fold(1.0, f64::min),
                };
                border > BORDER
            })
        })
    };
    edges.iter().filter(|edge| is_inside(edge)).count()
}
