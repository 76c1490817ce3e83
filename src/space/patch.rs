//! Spline patches: isogeometric analysis.

use super::grid::{ElementGrid, Merged, merge, on_side, side_axes};
use super::{BasisKind, Body, Dimension, FunctionSpace, PatchSpec, Quality, SideError, Space, SpecError, Trace, quality};
use crate::basis::{BSpline, Basis, Rational, TensorProduct};
use crate::linalg::to_f64;
use std::sync::Arc;

/// Weights that differ by less than this share of the largest are constant.
const SAME_WEIGHT: f64 = 1e-14;

/// A spline patch: NURBS or B-splines over the exact coarse map of its geometry. (S, N) stands for (N - 1, N).
#[derive(Clone, Debug)]
pub struct Patch<const S: usize, const N: usize> {
    grid: ElementGrid<N>,
    axes: [BSpline<f64>; N],
    weights: Option<Vec<f64>>,
    merged: Merged,
    space: Arc<dyn Space<N, N>>,
    quality: Quality<N>,
}

impl<const S: usize, const N: usize> Patch<S, N>
where
    Trace<S, N>: Dimension<S, N>,
{
    /// Builds the patch of `spec`, whose cells and mapping are ignored.
    ///
    /// Knots are the element ends, with continuity min(degree - 1, `continuity`), at the net's own knots at most what the
    /// net has. Functions that meet in a collapsed edge are one function.
    /// # Errors
    /// [`SpecError`] for degrees, continuity and breakpoints out of range, NURBS whose degree cannot carry the weights,
    /// and inverted elements.
    pub fn try_new(spec: &PatchSpec<N>) -> Result<Self, SpecError> {
        Trace::<S, N>::patch(spec)
    }
}

impl<const S: usize, const N: usize> Patch<S, N> {
    /// [`try_new`](Self::try_new), compiled where it is called.
    pub(super) fn made(spec: &PatchSpec<N>) -> Result<Self, SpecError> {
        const { assert!(S + 1 == N, "a patch has sides of one dimension less") };
        spec.check_degree(super::MAX_DEGREE_SPLINE, "splines")?;
        if let Some(continuity) = spec.continuity
            && let Some(direction) = (0..N).find(|&k| continuity >= spec.degree[k])
        {
            return Err(SpecError::Continuity { direction, continuity, degree: spec.degree[direction] });
        }
        let grid = ElementGrid::new(&spec.net, &spec.breakpoints)?;
        let axes: [BSpline<f64>; N] = std::array::from_fn(|k| axis(spec, k, &grid.breakpoints[k]));
        let weights = weights(spec, &axes)?;
        let product = TensorProduct::new(axes.clone());
        let counts = axes.each_ref().map(|a| a.num_functions());
        let merged = Merged::new(&counts, &grid.collapsed);
        let (basis, _) = match &weights {
            Some(w) => merge::<N>(Rational::try_new::<N>(product, w.clone())?, &merged.id),
            None => merge::<N>(product, &merged.id),
        };
        let space: Arc<dyn Space<N, N>> = Arc::new(FunctionSpace { basis, geometry: grid.exact.clone() });
        let quality = quality(&*space)?;
        Ok(Self { grid, axes, weights, merged, space, quality })
    }

    /// The univariate splines per direction.
    pub fn axes(&self) -> &[BSpline<f64>; N] {
        &self.axes
    }

    /// Weights, one per product of univariate splines; `None` for B-splines.
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }

    /// Elements per direction.
    pub fn elements(&self) -> [usize; N] {
        self.grid.counts()
    }

    /// Ends of the elements per direction in the parameters of the geometry.
    pub fn breakpoints(&self) -> &[Vec<f64>; N] {
        &self.grid.breakpoints
    }

    /// Function for a product of univariate splines; products at a collapsed edge share one.
    pub fn function(&self, product: usize) -> usize {
        self.merged.id[product]
    }

    /// Names of the faces that are points or edges.
    pub fn collapsed_sides(&self) -> Vec<String> {
        self.grid.collapsed_sides()
    }

    /// A side by its name.
    pub(super) fn side(&self, side: &str) -> Result<Trace<S, N>, SideError> {
        let side = self.grid.side(side)?;
        let product = TensorProduct::new(side_axes::<S, N, _>(&self.axes, side));
        let counts = self.axes.each_ref().map(|a| a.num_functions());
        let on = on_side(&counts, side);
        let ids: Vec<usize> = on.iter().map(|&i| self.merged.id[i]).collect();
        let (basis, dofs) = match &self.weights {
            // at an open end the other functions vanish, so the weight function there is made of these weights
            Some(w) => merge::<S>(Rational::new::<S>(product, on.iter().map(|&i| w[i]).collect()), &ids),
            None => merge::<S>(product, &ids),
        };
        let space = FunctionSpace { basis, geometry: self.grid.side_map::<S>(side) };
        Ok(Trace::on_boundary(&self.space, Arc::new(space), dofs, self.grid.facets(side)))
    }

    /// Least Jacobian, orientation, degenerate points.
    pub fn quality(&self) -> &Quality<N> {
        &self.quality
    }
}

impl<const S: usize, const N: usize> Body<S, N> for Patch<S, N>
where
    Trace<S, N>: Dimension<S, N>,
{
    fn space(&self) -> &Arc<dyn Space<N, N>> {
        &self.space
    }

    fn known_quality(&self) -> Option<&Quality<N>> {
        Some(&self.quality)
    }

    fn is_exact(&self) -> bool {
        true
    }

    fn sides(&self) -> Vec<String> {
        self.grid.sides()
    }

    fn trace(&self, side: &str) -> Result<Trace<S, N>, SideError> {
        Trace::side_of_patch(self, side)
    }
}

/// The splines of one direction.
fn axis<const N: usize>(spec: &PatchSpec<N>, direction: usize, breakpoints: &[f64]) -> BSpline<f64> {
    let degree = spec.degree[direction];
    let wanted = spec.continuity.map_or(degree as isize - 1, |c| c as isize);
    let net = &spec.net.axes[direction];
    let last = net.breakpoints().len() - 1;
    let continuity: Vec<isize> = breakpoints[1..breakpoints.len() - 1]
        .iter()
        .map(|t| {
            let own = (1..last).find(|&i| net.breakpoints()[i] == *t);
            own.map_or(wanted, |i| wanted.min(net.regularity(i)))
        })
        .collect();
    BSpline::from_breakpoints(degree, breakpoints, &continuity)
}

/// Weights of the refined weight function; `None` for B-splines: as given, if it is constant, or (`Auto`) if not in the spline space.
fn weights<const N: usize>(spec: &PatchSpec<N>, axes: &[BSpline<f64>; N]) -> Result<Option<Vec<f64>>, SpecError> {
    let Some(own) = &spec.net.weights else { return Ok(None) };
    let (least, most) = own.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), &w| (l.min(to_f64(w)), m.max(to_f64(w))));
    if spec.basis == BasisKind::BSpline || most - least <= SAME_WEIGHT * most {
        return Ok(None);
    }
    match (spec.net.weights_on(axes), spec.basis) {
        (Ok(w), _) => Ok(w),
        (Err(_), BasisKind::Auto) => Ok(None),
        (Err(_), _) => {
            let direction = (0..N).find(|&k| spec.degree[k] < spec.net_degree(k)).unwrap_or(0);
            Err(SpecError::DegreeTooLow { direction, degree: spec.degree[direction], needed: spec.net_degree(direction) })
        }
    }
}
