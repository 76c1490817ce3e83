//! Cuts of the elements of one curve at the vertices of another.

use super::chain::Vertex;
use super::pairing::{MasterCurve, crossing, normal};
use crate::basis::Order;
use crate::geometry::{Geometry, MapTable, opposes};
use crate::linalg::{Real, Vector, lit, num};

/// Pieces shorter than this share of the element join their neighbour.
const SLIVER: f64 = 1e-12;
/// Samples per element that bracket the cuts.
const SAMPLES: usize = 9;
/// The closest point is the end of a curve if the end is no farther, up to this share of the size.
const SAME_DISTANCE: f64 = 1e-8;
/// Distance from a cut, in local coordinates, at which it shows whether something is faced.
const ASIDE: f64 = 1e-6;

/// The least length of a piece, as a share of its element.
pub(super) fn sliver<T: Real>() -> T {
    lit::<T>(SLIVER).max(T::default_epsilon() * lit(16.0))
}

/// The cuts of one element; arrays are reused from element to element.
#[derive(Debug)]
pub(super) struct Cuts<const N: usize, T: Real> {
    /// Local coordinates of the samples.
    pub samples: Vec<Vector<1, T>>,
    /// Positions of the samples on the last element.
    pub x: Vec<Vector<N, T>>,
    /// Local coordinates of that element's cuts, ascending from 0 to 1.
    pub at: Vec<T>,
    /// Outward unit normals at the samples of an element that is to be opposed.
    normals: Vec<Vector<N, T>>,
    /// Largest distance of neighbouring samples.
    stride: T,
}

impl<const N: usize, T: Real> Cuts<N, T> {
    pub fn new() -> Self {
        let samples = (0..SAMPLES).map(|k| Vector::<1, T>::new(num::<T>(k) / num::<T>(SAMPLES - 1))).collect();
        Self { samples, x: Vec::new(), at: Vec::new(), normals: Vec::new(), stride: T::zero() }
    }

    /// Computes the roots of (x(xi) - V) . t for all vertices V of `other` near the element, between 0 and 1, slivers left out.
    ///
    /// With the `outward` sign of an element that is to be opposed, also those for the tangents of elements that oppose it and end
    /// beside one that does not.
    pub fn at_vertices<G: Geometry<1, N, T>>(
        &mut self,
        curve: &dyn Geometry<1, N, T>,
        element: usize,
        other: &MasterCurve<G, N, T>,
        outward: Option<T>,
        table: &mut MapTable<1, N, T>,
    ) {
        self.sample(curve, element, outward, table);
        let near = self.near(curve, element, other);
        self.roots(curve, element, other, (&near, |_| true), table);
        self.ends(curve, element, other, &near, table);
        self.finish();
    }

    /// Computes the cuts where `other`, and so its functions, end.
    pub fn at_rims<G: Geometry<1, N, T>>(
        &mut self,
        curve: &dyn Geometry<1, N, T>,
        element: usize,
        other: &MasterCurve<G, N, T>,
        outward: Option<T>,
        table: &mut MapTable<1, N, T>,
    ) {
        self.sample(curve, element, outward, table);
        if !other.has_rims() && self.normals.is_empty() {
            return;
        }
        let near = self.near(curve, element, other);
        if other.has_rims() {
            self.roots(curve, element, other, (&near, |vertex| vertex.at.len() == 1), table);
            self.finish();
            // a plane through the end of a curve meets other parts of the side too
            let slack = other.size() * lit(SAME_DISTANCE);
            let mut ends_here = |c: T| {
                curve.map(element, &[Vector::<1, T>::new(c)], Order::Values, table);
                other.place(&table.x[0]).is_some_and(|p| {
                    let far = |end: usize| {
                        let vertex = &other.chain().vertices[other.chain().ends[p.element][end]];
                        (vertex.at.len() == 1).then(|| (vertex.x - table.x[0]).norm())
                    };
                    (0..2).filter_map(far).any(|d| d <= p.distance + slack)
                })
            };
            self.at.retain(|&c| c == T::zero() || c == T::one() || ends_here(c));
        }
        let rims = self.at.len();
        self.ends(curve, element, other, &near, table);
        if self.at.len() > rims {
            let mut faces = |xi: T| {
                curve.map(element, &[Vector::<1, T>::new(xi)], Order::Gradients, table);
                other.faced_place(&table.x[0], &table.jacobian[0].column(0).into_owned(), outward).is_some()
            };
            let aside = lit::<T>(ASIDE);
            let mut found = self.at.split_off(rims);
            found.retain(|&c| c > aside && c < T::one() - aside && faces(c - aside) != faces(c + aside));
            self.at.append(&mut found);
            self.finish();
        }
    }

    /// Samples an element, with its normals if it has an outward sign; no cuts yet.
    fn sample(&mut self, curve: &dyn Geometry<1, N, T>, element: usize, outward: Option<T>, table: &mut MapTable<1, N, T>) {
        self.at.clear();
        self.at.extend([T::zero(), T::one()]);
        self.normals.clear();
        match outward {
            None => curve.map(element, &self.samples, Order::Values, table),
            Some(outward) => {
                curve.map(element, &self.samples, Order::Gradients, table);
                self.normals.extend(table.jacobian.iter().filter_map(|j| normal(&j.column(0).into_owned(), outward)));
            }
        }
        self.x.clear();
        self.x.extend_from_slice(&table.x);
        self.stride = self.x.windows(2).fold(T::zero(), |m, w| m.max((w[1] - w[0]).norm()));
    }

    /// The vertices of `other` that are near the element, in ascending order.
    fn near<G: Geometry<1, N, T>>(&self, curve: &dyn Geometry<1, N, T>, element: usize, other: &MasterCurve<G, N, T>) -> Vec<usize> {
        let far = [0, SAMPLES / 2, SAMPLES - 1].iter().filter_map(|&s| {
            let opposed = self.normals.get(s).and_then(|normal| other.place_opposed(&self.x[s], normal));
            opposed.map(|p| p.distance).or_else(|| other.distance_bound(&self.x[s]))
        });
        let far = far.fold(T::zero(), T::max);
        // a vertex that is a closest point is no farther than the closest point of the next probe plus the distance to that probe
        let margin = far + self.stride * lit(0.25 * SAMPLES as f64);
        other.vertices_in(&curve.bounds(element).inflated(margin))
    }

    /// Adds the cuts where elements of `other` that oppose this one end beside elements that do not.
    fn ends<G: Geometry<1, N, T>>(
        &mut self,
        curve: &dyn Geometry<1, N, T>,
        element: usize,
        other: &MasterCurve<G, N, T>,
        near: &[usize],
        table: &mut MapTable<1, N, T>,
    ) {
        if self.normals.is_empty() {
            return;
        }
        for &near in near {
            let vertex = &other.chain().vertices[near];
            let opposed = |k: usize, own: &Vector<N, T>| {
                let (e, end) = vertex.at[k];
                other.end_normal(e, end).is_some_and(|normal| opposes(own, &normal))
            };
            let ends = vertex.at.len();
            if !self.normals.iter().any(|n| (1..ends).any(|k| opposed(k, n) != opposed(0, n))) {
                continue;
            }
            for (k, &(e, end)) in vertex.at.iter().enumerate() {
                if self.normals.iter().any(|n| opposed(k, n)) {
                    self.crossings(curve, element, &vertex.x, &other.chain().tangents[e][end], table);
                }
            }
        }
    }

    /// Adds the roots of (x(xi) - `point`) . `tangent`.
    fn crossings(
        &mut self,
        curve: &dyn Geometry<1, N, T>,
        element: usize,
        point: &Vector<N, T>,
        tangent: &Vector<N, T>,
        table: &mut MapTable<1, N, T>,
    ) {
        for s in 1..SAMPLES {
            let values = [(self.x[s - 1] - point).dot(tangent), (self.x[s] - point).dot(tangent)];
            if (values[0] < T::zero()) != (values[1] < T::zero()) {
                let bracket = [self.samples[s - 1][0], self.samples[s][0]];
                self.at.push(crossing(curve, element, point, tangent, bracket, table));
            }
        }
    }

    fn roots<G: Geometry<1, N, T>>(
        &mut self,
        curve: &dyn Geometry<1, N, T>,
        element: usize,
        other: &MasterCurve<G, N, T>,
        (near, wanted): (&[usize], impl Fn(&Vertex<N, T>) -> bool),
        table: &mut MapTable<1, N, T>,
    ) {
        for &near in near {
            let vertex = &other.chain().vertices[near];
            if let Some(tangent) = vertex.tangent.filter(|_| wanted(vertex)) {
                self.crossings(curve, element, &vertex.x, &tangent, table);
            }
        }
    }

    /// Sorts the cuts and removes slivers.
    fn finish(&mut self) {
        self.at.sort_by(|a, b| a.partial_cmp(b).expect("cuts are numbers"));
        let (sliver, mut kept) = (sliver::<T>(), T::zero());
        self.at.retain(|&c| {
            let keep = c == T::zero() || c == T::one() || (c - kept > sliver && T::one() - c > sliver);
            if keep {
                kept = c;
            }
            keep
        });
        self.at.dedup();
    }
}
