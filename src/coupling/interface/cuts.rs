//! Cuts of the elements of one curve at the vertices of another.

use super::chain::Vertex;
use super::pairing::{MasterCurve, crossing};
use crate::basis::Order;
use crate::geometry::{Geometry, MapTable};
use crate::linalg::{Real, Vector, lit, num};

/// Pieces shorter than this share of the element join their neighbour.
const SLIVER: f64 = 1e-12;
/// Samples per element that bracket the cuts.
const SAMPLES: usize = 9;
/// The closest point is the end of a curve if the end is no farther, up to this share of the size.
const SAME_DISTANCE: f64 = 1e-8;

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
}

impl<const N: usize, T: Real> Cuts<N, T> {
    pub fn new() -> Self {
        let samples = (0..SAMPLES).map(|k| Vector::<1, T>::new(num::<T>(k) / num::<T>(SAMPLES - 1))).collect();
        Self { samples, x: Vec::new(), at: Vec::new() }
    }

    /// Computes the roots of (x(xi) - V) . t for all vertices V of `other` near the element, between 0 and 1, slivers left out.
    pub fn at_vertices<G: Geometry<1, N, T>>(
        &mut self,
        curve: &dyn Geometry<1, N, T>,
        element: usize,
        other: &MasterCurve<G, N, T>,
        table: &mut MapTable<1, N, T>,
    ) {
        self.roots(curve, element, other, |_| true, table);
        self.finish();
    }

    /// Computes the cuts where `other`, and so its functions, end.
    pub fn at_rims<G: Geometry<1, N, T>>(
        &mut self,
        curve: &dyn Geometry<1, N, T>,
        element: usize,
        other: &MasterCurve<G, N, T>,
        table: &mut MapTable<1, N, T>,
    ) {
        self.at.clear();
        self.at.extend([T::zero(), T::one()]);
        if other.has_rims() {
            self.roots(curve, element, other, |vertex| vertex.at.len() == 1, table);
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
    }

    fn roots<G: Geometry<1, N, T>>(
        &mut self,
        curve: &dyn Geometry<1, N, T>,
        element: usize,
        other: &MasterCurve<G, N, T>,
        wanted: impl Fn(&Vertex<N, T>) -> bool,
        table: &mut MapTable<1, N, T>,
    ) {
        self.at.clear();
        self.at.extend([T::zero(), T::one()]);
        curve.map(element, &self.samples, Order::Values, table);
        self.x.clear();
        self.x.extend_from_slice(&table.x);
        let stride = self.x.windows(2).fold(T::zero(), |m, w| m.max((w[1] - w[0]).norm()));
        let probed = [0, SAMPLES / 2, SAMPLES - 1].map(|s| other.place(&self.x[s]));
        let far = probed.iter().flatten().fold(T::zero(), |m, p| m.max(p.distance));
        // a vertex that is a closest point is no farther than the closest point of the next probe plus the distance to that probe
        let margin = far + stride * lit(0.25 * SAMPLES as f64);
        for near in other.vertices_in(&curve.bounds(element).inflated(margin)) {
            let vertex = &other.chain().vertices[near];
            let Some(tangent) = vertex.tangent.filter(|_| wanted(vertex)) else { continue };
            for s in 1..SAMPLES {
                let values = [(self.x[s - 1] - vertex.x).dot(&tangent), (self.x[s] - vertex.x).dot(&tangent)];
                if (values[0] < T::zero()) != (values[1] < T::zero()) {
                    let bracket = [self.samples[s - 1][0], self.samples[s][0]];
                    self.at.push(crossing(curve, element, &vertex.x, &tangent, bracket, table));
                }
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
