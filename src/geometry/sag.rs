//! Deviation (sag) of the facets of a curve or surface from the smooth surface that they approximate.
//!
//! Facets that approximate one smooth surface turn at their common vertices. With n the normal of that surface at a vertex (mean of
//! the facets' own normals m there: in the plane by the reciprocal of their lengths, on surfaces by their angles), an edge from x_i to x_j
//! has its middle off by
//!
//!   w = c / 4,   c = (n_i - m_i) . (x_i - x_j), the larger of both ends         (h² κ / 8 on arcs; positive: the surface is outside)
//!
//! Facets that meet at more than 50 degrees, or on both sides of a kink between planes, belong to different surfaces: a corner, and so a rim, has no curvature of its own, and neither
//! has a pole, where the tangents are dependent up to rounding: the other ends of its edges tell. A curved
//! facet follows its surface better; turns that its neighbours cancel show as a jump of curvature, which adds h² |K - mean K| / 16.
//!
//! Accuracy: true deviation over [`Sag::of`] is at most 1.05 on arcs graded 1:5, 0 on boxes, up to 2.4 on ellipses in few facets.

use super::{Bounds, ClosestPoint, Geometry, Kinks, MapTable, Tree, cell, cross, smooth_pieces, unit_normal};
use crate::basis::{Cell, Order};
use crate::linalg::{Matrix, Real, Vector, lit};
use crate::parallel;

/// Facets whose normals meet at more than 50 degrees belong to different surfaces: the cosine.
const SMOOTH: f64 = 0.642_787_609_686_539_4;
/// Corners nearer than this share of a facet are one vertex.
const SAME_VERTEX: f64 = 1e-7;
/// A facet that leaves its corners' (bi)linear map by less than this share of its size is straight.
const STRAIGHT: f64 = 1e-6;
/// Normals shorter than this share of the squares of the tangents are those of a pole.
const POLE: f64 = 1e-10;

/// The deviation of every facet of a side. (D, N) stands for (N - 1, N).
///
/// # Example
/// Sixteen chords of a circle stay 1 - cos(π / 16) inside of it:
/// ```
/// use faying::{basis::BSpline, geometry::{ControlPoints, Sag}, linalg::Vector};
/// let at = |k: usize| { let a = std::f64::consts::PI * k as f64 / 8.0; Vector::<2>::new(a.cos(), a.sin()) };
/// let circle = ControlPoints { basis: BSpline::uniform(1, 16, 0), points: (0..=16).map(at).collect() };
/// // the tangent turned clockwise points out of the disc
/// let sag = Sag::of(&circle, &[1.0; 16]);
/// assert!((sag.of_facet(3) / (1.0 - (std::f64::consts::PI / 16.0).cos()) - 1.0).abs() < 0.02);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sag<const D: usize, const N: usize, T: Real = f64> {
    greatest: Vec<T>,
    /// Per facet the height of the surface over the middle of every edge; zero where the facet is curved.
    edges: Vec<[T; 4]>,
    /// Per facet the larger facet that it is part of and that `edges` describes; empty if facets are no parts.
    parts: Vec<Part<D, T>>,
}

/// A facet as a part of another: the other's shape, origin and axes in ξ = origin + axes · own coordinate.
type Part<const D: usize, T> = (Cell, Vector<D, T>, Matrix<D, D, T>);

/// A facet at its corners.
struct Facet<const D: usize, const N: usize, T: Real> {
    x: Vec<Vector<N, T>>,
    normal: Vec<Vector<N, T>>,
    /// Curvature tensor at every corner; empty if the facet is straight.
    bend: Vec<Matrix<N, N, T>>,
    size: T,
    cell: Cell,
}

impl<const D: usize, const N: usize, T: Real> Sag<D, N, T> {
    /// Zero deviation, for facets that are the surface itself.
    pub fn none(facets: usize) -> Self {
        Self { greatest: vec![T::zero(); facets], edges: vec![[T::zero(); 4]; facets], parts: Vec::new() }
    }

    /// Estimates the deviation of all facets of `side`; `outward` as of a [trace](crate::space::Trace): +1 or -1 times the cross product
    /// of the tangents.
    pub fn of<G: Geometry<D, N, T> + ?Sized>(side: &G, outward: &[T]) -> Self {
        Self::between(side, outward, Kinks::OfPlanes)
    }

    /// Estimates the deviation as [`of`](Self::of); facets on both sides of these `kinks` belong to different surfaces.
    pub fn between<G: Geometry<D, N, T> + ?Sized>(side: &G, outward: &[T], kinks: Kinks) -> Self {
        let facets: Vec<Facet<D, N, T>> =
            parallel::map_init(side.num_elements(), MapTable::new, |table, e| facet(side, e, outward[e], table));
        let mut piece = vec![0; facets.len()];
        smooth_pieces(side, outward, kinks).iter().enumerate().for_each(|(k, own)| own.iter().for_each(|&f| piece[f] = k));
        let corners: Vec<(usize, usize)> = facets.iter().enumerate().flat_map(|(f, c)| (0..c.x.len()).map(move |k| (f, k))).collect();
        let tree = Tree::new(corners.iter().map(|&(f, k)| Bounds { lo: facets[f].x[k], hi: facets[f].x[k] }).collect());
        let (greatest, edges) = parallel::map(facets.len(), |f| {
            let own = &facets[f];
            let (mut turns, mut jumps) = (Vec::with_capacity(own.x.len()), Vec::with_capacity(own.x.len()));
            for k in 0..own.x.len() {
                let here = Bounds { lo: own.x[k], hi: own.x[k] }.inflated(own.size * lit(SAME_VERTEX));
                let (normal, bend) =
                    mean(&facets, own, k, tree.meeting(&here).into_iter().map(|i| corners[i]).filter(|(g, _)| piece[*g] == piece[f]));
                turns.push(normal - own.normal[k]);
                jumps.push(own.bend.get(k).map_or_else(T::zero, |b| (b - bend).norm()));
            }
            own.deviation(&turns, &jumps)
        })
        .into_iter()
        .unzip();
        Self { greatest, edges, parts: Vec::new() }
    }

    /// Estimate of the greatest deviation of a facet \[length\].
    pub fn of_facet(&self, facet: usize) -> T {
        self.greatest[facet]
    }

    /// The greatest estimate of all facets \[length\].
    pub fn greatest(&self) -> T {
        self.greatest.iter().fold(T::zero(), |most, &s| most.max(s))
    }

    /// The height of the surface over a straight facet of the shape `cell` at `xi`, along the outward normal \[length\].
    pub fn bulge(&self, facet: usize, cell: Cell, xi: &Vector<D, T>) -> T {
        match self.parts.get(facet) {
            None => bulge(&self.edges[facet], cell, xi),
            Some((whole, origin, axes)) => bulge(&self.edges[facet], *whole, &(origin + axes * xi)),
        }
    }

    /// The deviation of some of the facets.
    pub fn of_elements(&self, elements: &[usize]) -> Self {
        Self {
            greatest: elements.iter().map(|&e| self.greatest[e]).collect(),
            edges: elements.iter().map(|&e| self.edges[e]).collect(),
            parts: elements.iter().filter_map(|&e| self.parts.get(e).copied()).collect(),
        }
    }

    /// Transfers the deviation to `parts`, affine parts of the facets `whole` of this estimate: parts do not turn at their new vertices.
    ///
    /// Returns `None` if a facet of `parts` is not part of one of `whole`.
    pub fn of_parts<G: Geometry<D, N, T> + ?Sized, H: Geometry<D, N, T> + ?Sized>(&self, whole: &G, parts: &H) -> Option<Self> {
        let closest = ClosestPoint::<D, N, &G, T>::new(whole);
        let all: Vec<Option<(usize, Part<D, T>)>> = parallel::map_init(parts.num_elements(), MapTable::new, |table, e| {
            let kind = parts.cell(e);
            // inner points: points on an edge may project to a neighbour of the whole
            let center = cell::center::<D, T>(if D == 1 { Cell::Tensor } else { kind });
            let steps: Vec<Vector<D, T>> =
                (0..D).map(|k| center + Vector::<D, T>::from_fn(|i, _| if i == k { lit(STEP) } else { T::zero() })).collect();
            let points: Vec<Vector<D, T>> = std::iter::once(center).chain(steps).collect();
            parts.map(e, &points, Order::Values, table);
            let near = parts.bounds(e).diagonal() * lit(STRAIGHT);
            let feet: Vec<_> = table.x.iter().map(|x| closest.project_within(x, near)).collect::<Option<_>>()?;
            let owner = feet[0].element;
            if feet.iter().any(|f| f.element != owner) {
                return None;
            }
            let mut axes = Matrix::<D, D, T>::zeros();
            for k in 0..D {
                axes.set_column(k, &((feet[k + 1].xi - feet[0].xi) / lit::<T>(STEP)));
            }
            Some((owner, (whole.cell(owner), feet[0].xi - axes * center, axes)))
        });
        let (owners, parts): (Vec<usize>, Vec<Part<D, T>>) = all.into_iter().collect::<Option<Vec<_>>>()?.into_iter().unzip();
        let greatest = owners.iter().map(|&o| self.greatest[o]).collect();
        Some(Self { greatest, edges: owners.iter().map(|&o| self.edges[o]).collect(), parts })
    }
}

/// Distance in local coordinates of the points that locate a facet in another.
const STEP: f64 = 0.125;

/// 4 u (1 - u) w along an edge, blended over quadrilaterals and triangles.
fn bulge<const D: usize, T: Real>(edges: &[T; 4], cell: Cell, xi: &Vector<D, T>) -> T {
    let (one, four) = (T::one(), lit::<T>(4.0));
    if D == 1 {
        return four * xi[0] * (one - xi[0]) * edges[0];
    }
    let (u, v) = (xi[0], xi[1]);
    match cell {
        Cell::Tensor => {
            let along_v = v * (one - v) * ((one - u) * edges[0] + u * edges[1]);
            four * (along_v + u * (one - u) * ((one - v) * edges[2] + v * edges[3]))
        }
        Cell::Simplex => {
            let w = one - u - v;
            four * (w * v * edges[0] + w * u * edges[1] + u * v * edges[2])
        }
    }
}

/// The ends of every edge by local numbers of corners, in the order of [`cell::faces`].
fn edges_of<const D: usize>(cell: Cell) -> &'static [[usize; 2]] {
    match cell {
        _ if D == 1 => &[[0, 1]],
        Cell::Tensor => &[[0, 2], [1, 3], [0, 1], [2, 3]],
        Cell::Simplex => &[[0, 2], [0, 1], [1, 2]],
    }
}

impl<const D: usize, const N: usize, T: Real> Facet<D, N, T> {
    /// Greatest deviation and heights of edges, from n - m and the jump of curvature at every corner.
    fn deviation(&self, turns: &[Vector<N, T>], jumps: &[T]) -> (T, [T; 4]) {
        let mut heights = [T::zero(); 4];
        let (mut most, mut jump) = (T::zero(), T::zero());
        for (height, &[i, j]) in heights.iter_mut().zip(edges_of::<D>(self.cell)) {
            let along = self.x[i] - self.x[j];
            let (a, b) = (turns[i].dot(&along), -turns[j].dot(&along));
            let larger = if a.abs() >= b.abs() { a } else { b };
            *height = larger * lit(0.25);
            most = most.max(height.abs());
            jump = jump.max(along.norm_squared() * jumps[i].max(jumps[j]) / lit(16.0));
        }
        if D > 1 {
            most = (most * lit(4.0 / 3.0)).max(bulge(&heights, self.cell, &cell::center::<D, T>(self.cell)).abs());
        }
        (most + jump, if self.bend.is_empty() { heights } else { [T::zero(); 4] })
    }

    /// Weight of the facet's normal at corner `k`: the reciprocal of its length; of a surface the angle there.
    fn weight(&self, k: usize) -> T {
        if D == 1 {
            return T::one() / (self.x[1] - self.x[0]).norm().max(self.size * T::default_epsilon());
        }
        let next = |which: usize| match self.cell {
            Cell::Tensor => k ^ (1 << which),
            Cell::Simplex => (k + 1 + which) % 3,
        };
        let [a, b] = [0, 1].map(|which| self.x[next(which)] - self.x[k]);
        let both = a.norm() * b.norm();
        if both > T::zero() { (a.dot(&b) / both).max(-T::one()).min(T::one()).acos() } else { T::zero() }
    }
}

/// Mean normal and curvature of the facets that are smooth with `own` at its corner `k`.
fn mean<const D: usize, const N: usize, T: Real>(
    facets: &[Facet<D, N, T>],
    own: &Facet<D, N, T>,
    k: usize,
    there: impl Iterator<Item = (usize, usize)>,
) -> (Vector<N, T>, Matrix<N, N, T>) {
    let (mut normal, mut bend, mut sum) = (Vector::zeros(), Matrix::zeros(), T::zero());
    for (g, c) in there {
        let other = &facets[g];
        if other.normal[c].dot(&own.normal[k]) <= lit(SMOOTH) {
            continue;
        }
        let weight = other.weight(c);
        normal += other.normal[c] * weight;
        if let Some(b) = other.bend.get(c) {
            bend += b * weight;
        }
        sum += weight;
    }
    let length = normal.norm();
    if length > T::zero() { (normal / length, bend / sum) } else { (own.normal[k], own.bend.get(k).copied().unwrap_or_else(Matrix::zeros)) }
}

fn facet<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized>(
    side: &G,
    element: usize,
    outward: T,
    table: &mut MapTable<D, N, T>,
) -> Facet<D, N, T> {
    let kind = side.cell(element);
    let corners = cell::corners::<D, T>(kind);
    let (inside, affine) = (cell::grid::<D, T>(kind, 3), side.map_structure().is_affine(element));
    let points: Vec<Vector<D, T>> = if affine { corners.clone() } else { corners.iter().chain(&inside).copied().collect() };
    side.map(element, &points, Order::Hessians, table);
    let x = table.x[..corners.len()].to_vec();
    let size = Bounds::around(&x).map_or_else(T::zero, |b| b.diagonal());
    let normal_of = |j: &Matrix<N, D, T>| if is_pole(j) { Vector::zeros() } else { unit_normal(j, outward) };
    let normal: Vec<Vector<N, T>> = table.jacobian[..corners.len()].iter().map(normal_of).collect();
    let off = |q: usize| {
        let xi = &points[q];
        let flat = corners.iter().zip(&x).fold(Vector::zeros(), |s: Vector<N, T>, (c, x)| s + x * share(kind, c, xi));
        (table.x[q] - flat).dot(&unit_normal(&table.jacobian[q], outward)).abs()
    };
    let straight = (corners.len()..points.len()).all(|q| off(q) <= size * lit(STRAIGHT));
    let bend = if straight {
        Vec::new()
    } else {
        (0..corners.len()).map(|q| curvature(&table.jacobian[q], &table.hessian[q], &normal[q])).collect()
    };
    Facet { x, normal, bend, size, cell: kind }
}

/// The (bi)linear function of the corner `c` at `xi`.
fn share<const D: usize, T: Real>(kind: Cell, c: &Vector<D, T>, xi: &Vector<D, T>) -> T {
    let one = T::one();
    match kind {
        Cell::Tensor => (0..D).fold(one, |p, k| p * if c[k] > lit(0.5) { xi[k] } else { one - xi[k] }),
        Cell::Simplex => (0..D).find(|&k| c[k] > lit(0.5)).map_or_else(|| one - xi.sum(), |k| xi[k]),
    }
}

/// Whether the tangents of a surface are dependent up to rounding.
fn is_pole<const D: usize, const N: usize, T: Real>(jacobian: &Matrix<N, D, T>) -> bool {
    D == 2 && cross(jacobian).norm() <= jacobian.norm_squared() * lit(POLE)
}

/// J G⁻¹ B G⁻¹ Jᵀ with G = JᵀJ and B = n . x'': the curvature as a tensor of space \[1/length\]; zero where the map is singular.
fn curvature<const D: usize, const N: usize, T: Real>(
    jacobian: &Matrix<N, D, T>,
    hessian: &[Matrix<D, D, T>; N],
    normal: &Vector<N, T>,
) -> Matrix<N, N, T> {
    let g = jacobian.transpose() * jacobian;
    let b = (0..N).fold(Matrix::<D, D, T>::zeros(), |s, i| s + hessian[i] * normal[i]);
    // D is 1 or 2: the adjugate over the determinant
    let (adjugate, determinant) = if D == 1 {
        (Matrix::<D, D, T>::identity(), g[(0, 0)])
    } else {
        let flipped = Matrix::<D, D, T>::from_fn(|r, c| if r == c { g[(1 - r, 1 - c)] } else { -g[(r, c)] });
        (flipped, g[(0, 0)] * g[(1, 1)] - g[(0, 1)] * g[(1, 0)])
    };
    if determinant <= T::zero() || is_pole(jacobian) {
        return Matrix::zeros();
    }
    let up = jacobian * (adjugate / determinant);
    up * b * up.transpose()
}
