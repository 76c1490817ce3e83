//! Connectivity of the elements of a curve, found from the positions of their ends.

use crate::basis::Order;
use crate::geometry::{Bounds, Geometry, MapTable};
use crate::linalg::{Real, Union, Vector, lit, num, to_f64};

/// Ends closer than this share of the shorter element are one vertex.
const SAME_VERTEX: f64 = 1e-7;
/// Two tangents whose sum is shorter than this fold back on each other.
const FOLD: f64 = 1e-3;

/// A point at which elements of a curve end.
#[derive(Clone, Debug)]
pub struct Vertex<const N: usize, T: Real = f64> {
    /// Its position.
    pub x: Vector<N, T>,
    /// The (element, end) pairs that meet here; a single one on a rim (an end of the curve).
    pub at: Vec<(usize, usize)>,
    /// Mean unit tangent, from `at[0]` towards `at[1]`, on a rim out of the curve; `None` where the curve forks or folds.
    pub tangent: Option<Vector<N, T>>,
}

/// The vertices of a curve and the connectivity of its elements.
#[derive(Clone, Debug)]
pub struct Chain<const N: usize, T: Real = f64> {
    /// All vertices.
    pub vertices: Vec<Vertex<N, T>>,
    /// The vertices at xi = 0 and xi = 1 of every element.
    pub ends: Vec<[usize; 2]>,
    /// Diagonal of the box around the curve \[length\].
    pub size: T,
    /// Length of the chord polygon of each element \[length\].
    pub lengths: Vec<T>,
    /// Unit tangents out of the element at xi = 0 and xi = 1, zero where the derivative vanishes.
    pub tangents: Vec<[Vector<N, T>; 2]>,
}

impl<const N: usize, T: Real> Chain<N, T> {
    /// Builds the chain of all elements of `curve`.
    pub fn of(curve: &dyn Geometry<1, N, T>) -> Self {
        let n = curve.num_elements();
        let (mut table, mut lengths, mut box_) = (MapTable::new(), Vec::with_capacity(n), None::<Bounds<N, T>>);
        // (position, outward unit tangent) of end 0 and end 1 of every element
        let mut ends: Vec<(Vector<N, T>, Vector<N, T>)> = Vec::with_capacity(2 * n);
        let points: Vec<Vector<1, T>> = (0..5).map(|k| Vector::<1, T>::new(num::<T>(k) / lit(4.0))).collect();
        for element in 0..n {
            curve.map(element, &points, Order::Gradients, &mut table);
            let bounds = curve.bounds(element);
            box_ = Some(box_.map_or(bounds, |b| b.union(&bounds)));
            lengths.push(table.x.windows(2).fold(T::zero(), |s, w| s + (w[1] - w[0]).norm()));
            for (q, sign) in [(0, -T::one()), (4, T::one())] {
                let tangent = table.jacobian[q].column(0) * sign;
                let norm = tangent.norm();
                ends.push((table.x[q], if norm > T::zero() { tangent / norm } else { tangent }));
            }
        }
        let size = box_.map_or_else(T::zero, |b| b.diagonal());
        let vertex_of = same_places(&ends, &lengths, size);
        let count = vertex_of.iter().map(|&v| v + 1).max().unwrap_or(0);
        let mut at: Vec<Vec<(usize, usize)>> = vec![Vec::new(); count];
        for (k, &v) in vertex_of.iter().enumerate() {
            at[v].push((k / 2, k % 2));
        }
        let vertices = at.into_iter().map(|at| vertex(at, &ends)).collect();
        let tangents = ends.chunks_exact(2).map(|pair| [pair[0].1, pair[1].1]).collect();
        Self { vertices, ends: (0..n).map(|e| [vertex_of[2 * e], vertex_of[2 * e + 1]]).collect(), size, lengths, tangents }
    }

    /// The (element, end) joined to `end` of `element`; `None` on rims and forks.
    pub fn neighbour(&self, element: usize, end: usize) -> Option<(usize, usize)> {
        let at = &self.vertices[self.ends[element][end]].at;
        if at.len() != 2 {
            return None;
        }
        Some(if at[0] == (element, end) { at[1] } else { at[0] })
    }

    /// Elements in order along the curve, and whether each is traversed from xi = 1 to xi = 0.
    ///
    /// Starts at the rim of the element with the lowest number; disconnected parts of the curve follow one another.
    pub fn walk(&self) -> Vec<(usize, bool)> {
        let n = self.ends.len();
        let (mut seen, mut order) = (vec![false; n], Vec::with_capacity(n));
        let rims = (0..n).flat_map(|e| [(e, 0), (e, 1)]).filter(|&(e, end)| self.neighbour(e, end).is_none());
        for (first, end) in rims.chain((0..n).map(|e| (e, 0))).collect::<Vec<_>>() {
            let (mut element, mut entry) = (first, end);
            while !seen[element] {
                seen[element] = true;
                order.push((element, entry == 1));
                match self.neighbour(element, 1 - entry) {
                    Some((next, at)) => (element, entry) = (next, at),
                    None => break,
                }
            }
        }
        order
    }
}

/// The vertex number of every element end: coinciding ends share it.
fn same_places<const N: usize, T: Real>(ends: &[(Vector<N, T>, Vector<N, T>)], lengths: &[T], size: T) -> Vec<usize> {
    let n = ends.len();
    let floor = size * lit(1e-14);
    let tolerance = |k: usize| lengths[k / 2] * lit(SAME_VERTEX) + floor;
    let axis = widest_axis(ends.iter().map(|e| e.0));
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| to_f64(ends[a].0[axis]).total_cmp(&to_f64(ends[b].0[axis])).then(a.cmp(&b)));
    let mut sets = Union::new(n);
    for i in 0..n {
        let a = order[i];
        for &b in &order[i + 1..] {
            if ends[b].0[axis] - ends[a].0[axis] > tolerance(a) {
                break;
            }
            if (ends[a].0 - ends[b].0).norm() <= tolerance(a).min(tolerance(b)) {
                sets.unite(a, b);
            }
        }
    }
    sets.numbers().0
}

fn vertex<const N: usize, T: Real>(at: Vec<(usize, usize)>, ends: &[(Vector<N, T>, Vector<N, T>)]) -> Vertex<N, T> {
    let out = |(e, end): (usize, usize)| ends[2 * e + end].1;
    let x = ends[2 * at[0].0 + at[0].1].0;
    let tangent = match at[..] {
        [only] => Some(out(only)).filter(|t| t.norm() > T::zero()),
        [a, b] => {
            let sum = out(a) - out(b);
            let norm = sum.norm();
            (norm > lit(FOLD)).then(|| sum / norm)
        }
        _ => None,
    };
    Vertex { x, at, tangent }
}

/// The axis along which the points spread most.
fn widest_axis<const N: usize, T: Real>(points: impl Iterator<Item = Vector<N, T>>) -> usize {
    let all: Vec<Vector<N, T>> = points.collect();
    let Some(b) = Bounds::around(&all) else { return 0 };
    let extent = b.hi - b.lo;
    (0..N).max_by(|&a, &b| to_f64(extent[a]).total_cmp(&to_f64(extent[b]))).unwrap_or(0)
}
