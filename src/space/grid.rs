//! Common parts of splines and Lagrange meshes of a patch: elements, exact map, collapsed edges, sides.

use super::refine::{self, SAME_KNOT};
use super::{SideError, SpecError};
use crate::basis::{Basis, Extracted, Rational, Refined, TensorProduct};
use crate::geometry::{ControlNet, ControlPoints, Embedding, Geometry, collapsed_faces};
use crate::linalg::{Matrix, Union, Vector};
use std::sync::Arc;

const AXES: [&str; 3] = ["u", "v", "w"];

/// A face of the parameter box: xi_axis = end (0 or 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SideOf {
    pub axis: usize,
    pub end: usize,
}

impl SideOf {
    /// The name u0, u1, v0 and so on.
    pub fn name(self) -> String {
        format!("{}{}", AXES[self.axis], self.end)
    }

    /// All faces in dimension `n`: u0, u1, v0, ...
    pub fn all(n: usize) -> Vec<Self> {
        (0..2 * n).map(|f| Self { axis: f / 2, end: f % 2 }).collect()
    }

    /// Finds the face of a name or alias in dimension `n`.
    ///
    /// Aliases: left, right = u0, u1; in the plane bottom, top = v0, v1; in space front, back = v0, v1 and bottom, top = w0, w1.
    pub fn find(name: &str, n: usize) -> Option<Self> {
        let alias = match (name, n) {
            ("left", _) => "u0",
            ("right", _) => "u1",
            ("front", 3) | ("bottom", 2) => "v0",
            ("back", 3) | ("top", 2) => "v1",
            ("bottom", 3) => "w0",
            ("top", 3) => "w1",
            (other, _) => other,
        };
        Self::all(n).into_iter().find(|s| s.name() == alias)
    }

    /// The axes that run along the face, in order.
    pub fn along(self, n: usize) -> Vec<usize> {
        (0..n).filter(|&k| k != self.axis).collect()
    }
}

/// A collapsed face: its lines along axis `along` are points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Collapse {
    pub side: SideOf,
    pub along: usize,
}

/// The element grid of a patch with its exact map.
#[derive(Clone, Debug)]
pub(crate) struct ElementGrid<const N: usize> {
    /// Element ends per direction in the parameters of the net.
    pub breakpoints: [Vec<f64>; N],
    /// The net of the exact map.
    net: ControlNet<N, N>,
    /// The exact map of the net on these elements.
    pub exact: Arc<dyn Geometry<N, N>>,
    pub collapsed: Vec<Collapse>,
}

impl<const N: usize> ElementGrid<N> {
    /// Builds the grid of `breakpoints`, to which the knots of the net are added.
    pub fn new(net: &ControlNet<N, N>, breakpoints: &[Vec<f64>; N]) -> Result<Self, SpecError> {
        let mut all: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
        for k in 0..N {
            all[k] = joined(k, net.axes[k].breakpoints(), &breakpoints[k])?;
        }
        let collapsed = collapses(net);
        let net = with_points(net, &collapsed);
        let exact = exact_map(&net, &all);
        Ok(Self { breakpoints: all, net, exact, collapsed })
    }

    /// Elements per direction.
    pub fn counts(&self) -> [usize; N] {
        std::array::from_fn(|k| self.breakpoints[k].len() - 1)
    }

    /// Names of the faces that are neither points nor edges.
    pub fn sides(&self) -> Vec<String> {
        SideOf::all(N).into_iter().filter(|s| !self.is_collapsed(*s)).map(SideOf::name).collect()
    }

    /// Names of the faces that are points or edges.
    pub fn collapsed_sides(&self) -> Vec<String> {
        SideOf::all(N).into_iter().filter(|s| self.is_collapsed(*s)).map(SideOf::name).collect()
    }

    pub fn is_collapsed(&self, side: SideOf) -> bool {
        self.collapsed.iter().any(|c| c.side == side)
    }

    /// Returns the face of a name or alias.
    pub fn side(&self, name: &str) -> Result<SideOf, SideError> {
        let unknown = || SideError::Unknown { side: name.to_string(), known: self.sides().join(", ") };
        let side = SideOf::find(name, N).ok_or_else(unknown)?;
        if self.is_collapsed(side) {
            return Err(SideError::Collapsed { side: name.to_string() });
        }
        Ok(side)
    }

    /// The exact map of a side: at an open end the other functions of the net vanish.
    pub fn side_map<const S: usize>(&self, side: SideOf) -> Arc<dyn Geometry<S, N>> {
        let counts = self.net.axes.each_ref().map(|axis| axis.num_functions());
        let on = on_side(&counts, side);
        let points = on.iter().map(|&i| self.net.points[i]).collect();
        let weights = self.net.weights.as_ref().map(|w| on.iter().map(|&i| w[i]).collect());
        exact_map(&ControlNet { axes: side_axes(&self.net.axes, side), points, weights }, &side_axes(&self.breakpoints, side))
    }

    /// Embeddings of the elements of a side in the cells of the grid, first axis fastest.
    pub fn facets<const S: usize>(&self, side: SideOf) -> Vec<Embedding<S, N>> {
        let along = side.along(N);
        let axes = Matrix::<N, S>::from_fn(|k, s| if along[s] == k { 1.0 } else { 0.0 });
        let origin = Vector::<N>::from_fn(|k, _| if k == side.axis { side.end as f64 } else { 0.0 });
        on_side(&self.counts(), side).into_iter().map(|element| Embedding { element, origin, axes }).collect()
    }
}

/// The map of a net on the elements between `breakpoints`, which hold its knots.
fn exact_map<const D: usize, const N: usize>(net: &ControlNet<D, N>, breakpoints: &[Vec<f64>; D]) -> Arc<dyn Geometry<D, N>> {
    let axes = std::array::from_fn(|k| {
        let axis = &net.axes[k];
        let cells = breakpoints[k].windows(2).map(|w| {
            let (element, _) = axis.find(0.5 * (w[0] + w[1]));
            let (a, b) = axis.interval(element);
            (element, (w[0] - a) / (b - a), (w[1] - w[0]) / (b - a))
        });
        Refined::new(axis.clone(), cells.collect())
    });
    let (product, points) = (TensorProduct::new(axes), net.points.clone());
    match &net.weights {
        Some(w) => Arc::new(ControlPoints { basis: Rational::new::<D>(product, w.clone()), points }),
        None => Arc::new(ControlPoints { basis: product, points }),
    }
}

/// The axes that run along a side.
pub(crate) fn side_axes<const S: usize, const N: usize, A: Clone>(axes: &[A; N], side: SideOf) -> [A; S] {
    std::array::from_fn(|k| axes[if k < side.axis { k } else { k + 1 }].clone())
}

/// The entries of a grid of `counts` that touch a face, first axis fastest.
pub(crate) fn on_side<const N: usize>(counts: &[usize; N], side: SideOf) -> Vec<usize> {
    let at = if side.end == 0 { 0 } else { counts[side.axis] - 1 };
    (0..counts.iter().product()).filter(|&i| split(counts, i)[side.axis] == at).collect()
}

/// The multi-index of entry `i`, first axis fastest.
pub(crate) fn split<const N: usize>(counts: &[usize; N], mut i: usize) -> [usize; N] {
    counts.map(|n| {
        let k = i % n;
        i /= n;
        k
    })
}

/// The entry of a multi-index.
pub(crate) fn join<const N: usize>(counts: &[usize; N], at: &[usize; N]) -> usize {
    (0..N).rev().fold(0, |i, k| i * counts[k] + at[k])
}

/// Numbering of the functions of a tensor grid in which functions on a collapsed edge are one.
#[derive(Clone, Debug)]
pub(crate) struct Merged {
    /// The merged function of each function of the grid.
    pub id: Vec<usize>,
    pub functions: usize,
}

impl Merged {
    /// Merges the functions of a grid of `counts` along collapsed faces.
    pub fn new<const N: usize>(counts: &[usize; N], collapsed: &[Collapse]) -> Self {
        let mut sets = Union::new(counts.iter().product());
        for c in collapsed {
            for i in on_side(counts, c.side) {
                let mut at = split(counts, i);
                at[c.along] = 0;
                // the least number stays the root, so the numbering follows the grid
                sets.unite(i, join(counts, &at));
            }
        }
        let (id, functions) = sets.numbers();
        Self { id, functions }
    }

    /// Whether nothing is merged.
    pub fn is_trivial(&self) -> bool {
        self.functions == self.id.len()
    }
}

/// Merges functions of `basis`: function `ids[i]` is the sum of all functions i with that id. The second value lists the
/// ids in the order of the functions.
pub(crate) fn merge<const D: usize>(basis: impl Basis<D> + 'static, ids: &[usize]) -> (Box<dyn Basis<D>>, Vec<usize>) {
    let mut dofs: Vec<usize> = Vec::new();
    let mut place = std::collections::HashMap::new();
    let local: Vec<usize> = ids
        .iter()
        .map(|&id| {
            *place.entry(id).or_insert_with(|| {
                dofs.push(id);
                dofs.len() - 1
            })
        })
        .collect();
    if dofs.len() == ids.len() {
        return (Box::new(basis), dofs);
    }
    let rows = local.iter().map(|&k| vec![(k, 1.0)]).collect();
    (Box::new(Extracted::new::<D>(basis, dofs.len(), rows)), dofs)
}

/// Merges the breakpoints of a direction with the knots of the geometry, after checking their range and order.
fn joined(direction: usize, knots: &[f64], wanted: &[f64]) -> Result<Vec<f64>, SpecError> {
    let (a, b) = (knots[0], knots[knots.len() - 1]);
    let near = SAME_KNOT * (b - a);
    for (index, &t) in wanted.iter().enumerate() {
        if !t.is_finite() || t < a - near || t > b + near {
            return Err(SpecError::BreakpointOutside { direction, index, value: t, from: a, to: b });
        }
        if index > 0 && t <= wanted[index - 1] {
            return Err(SpecError::BreakpointsFall { direction, index, value: t });
        }
    }
    Ok(refine::joined(knots, wanted))
}

/// The net with its collapsed faces exact: control points that are one up to rounding are one. Otherwise the map would have an inverse at a pole, of
/// the size of one over the rounding, and derivatives there were noise.
fn with_points<const N: usize>(net: &ControlNet<N, N>, collapsed: &[Collapse]) -> ControlNet<N, N> {
    let (mut net, counts) = (net.clone(), net.axes.each_ref().map(|axis| axis.num_functions()));
    for collapse in collapsed {
        let stride = counts[..collapse.along].iter().product::<usize>();
        for i in on_side(&counts, collapse.side) {
            net.points[i] = net.points[i - split(&counts, i)[collapse.along] * stride];
        }
    }
    net
}

/// The collapsed faces of a net.
fn collapses<const N: usize>(net: &ControlNet<N, N>) -> Vec<Collapse> {
    let counts: [usize; N] = std::array::from_fn(|k| net.axes[k].num_functions());
    let faces = collapsed_faces(&counts, &net.points);
    faces.into_iter().map(|f| Collapse { side: SideOf { axis: f.axis, end: f.end }, along: f.along }).collect()
}
