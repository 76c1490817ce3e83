//! Control nets of NURBS maps, and the same maps on finer knots and in higher degrees.

use crate::basis::{BSpline, Basis, ContainError, Elements, KnotError, WeightError, check_weights};
use crate::linalg::{Real, Vector, num};

/// Error when data do not form a control net, or a net cannot be written in other splines.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NetError {
    /// The knots of one direction are no open knot vector.
    #[error("direction {axis}: {source}")]
    Knots {
        /// The direction, from 0.
        axis: usize,
        /// Cause.
        source: KnotError,
    },
    /// There is not one control point per function.
    #[error("there are {found} control points for {expected} functions ({per_axis:?} per direction); give one per function")]
    Counts {
        /// Number of points.
        found: usize,
        /// Number of functions.
        expected: usize,
        /// Functions per direction.
        per_axis: Vec<usize>,
    },
    /// A control point has a coordinate that is infinite or not a number.
    #[error("the control point at index {index} is not finite")]
    NotFinite {
        /// Its index, from 0.
        index: usize,
    },
    /// A weight is not positive, or there is not one per point.
    #[error(transparent)]
    Weights(#[from] WeightError),
    /// The target splines do not contain the net's.
    #[error("direction {axis}: {source}")]
    Contain {
        /// The direction, from 0.
        axis: usize,
        /// Cause.
        source: ContainError,
    },
}

/// A NURBS map x = sum_i w_i N_i P_i / sum_i w_i N_i; without weights a spline map.
///
/// Points are numbered with the first axis fastest. The net may be left-handed.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlNet<const D: usize, const N: usize, T: Real = f64> {
    /// Splines per direction.
    pub axes: [BSpline<T>; D],
    /// Control points P_i \[length\].
    pub points: Vec<Vector<N, T>>,
    /// Weights w_i of a rational map.
    pub weights: Option<Vec<T>>,
}

impl<const D: usize, const N: usize, T: Real> ControlNet<D, N, T> {
    /// Builds a net from splines, points and weights.
    ///
    /// # Errors
    /// [`NetError`] unless there is one finite point, and one positive weight if any, per function.
    pub fn try_new(axes: [BSpline<T>; D], points: Vec<Vector<N, T>>, weights: Option<Vec<T>>) -> Result<Self, NetError> {
        let per_axis: Vec<usize> = axes.iter().map(BSpline::num_functions).collect();
        let expected = per_axis.iter().product();
        if points.len() != expected {
            return Err(NetError::Counts { found: points.len(), expected, per_axis });
        }
        if let Some(index) = points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(NetError::NotFinite { index });
        }
        if let Some(weights) = &weights {
            check_weights(weights, expected)?;
        }
        Ok(Self { axes, points, weights })
    }

    /// Builds a net from degrees and knot vectors.
    ///
    /// # Errors
    /// [`NetError`] as for [`try_new`](Self::try_new), and for invalid knots.
    pub fn from_knots(
        degree: [usize; D],
        knots: [Vec<T>; D],
        points: Vec<Vector<N, T>>,
        weights: Option<Vec<T>>,
    ) -> Result<Self, NetError> {
        let mut axes = Vec::with_capacity(D);
        for (axis, knots) in knots.into_iter().enumerate() {
            axes.push(BSpline::try_new(degree[axis], knots).map_err(|source| NetError::Knots { axis, source })?);
        }
        let axes: [BSpline<T>; D] = axes.try_into().expect("one spline per direction");
        Self::try_new(axes, points, weights)
    }

    /// Inserts `knots` in direction `axis`, keeping the map; repeat a knot to insert it several times.
    ///
    /// # Errors
    /// [`NetError::Knots`] if a knot lies outside or would be repeated more than degree + 1 times.
    ///
    /// # Panics
    /// If there is no such direction.
    pub fn insert(&self, axis: usize, knots: &[T]) -> Result<Self, NetError> {
        let old = &self.axes[axis];
        let mut all = old.knots().to_vec();
        for &t in knots {
            let k = all.partition_point(|&x| x <= t);
            all.insert(k, t);
        }
        let finer = BSpline::try_new(old.polynomial_degree(), all).map_err(|source| NetError::Knots { axis, source })?;
        self.with_axis(axis, finer)
    }

    /// Elevates the degree of direction `axis` by `times`, keeping the map and its regularity.
    ///
    /// # Panics
    /// If there is no such direction.
    pub fn elevate(&self, axis: usize, times: usize) -> Self {
        let old = &self.axes[axis];
        let regularity: Vec<isize> = (1..old.num_elements()).map(|b| old.regularity(b)).collect();
        let higher = BSpline::from_breakpoints(old.polynomial_degree() + times, old.breakpoints(), &regularity);
        self.with_axis(axis, higher).expect("a higher degree of the same regularity contains the net")
    }

    fn with_axis(&self, axis: usize, spline: BSpline<T>) -> Result<Self, NetError> {
        let mut axes = self.axes.clone();
        axes[axis] = spline;
        self.on_axes(&axes)
    }

    /// Writes the map in the splines `axes`, which may be finer, of higher degree, less smooth.
    ///
    /// Exact in exact arithmetic: homogeneous coordinates (w x, w) are transferred direction by direction.
    ///
    /// # Errors
    /// [`NetError::Contain`] if `axes` do not contain the net's splines.
    pub fn on_axes(&self, axes: &[BSpline<T>; D]) -> Result<Self, NetError> {
        let columns = N + usize::from(self.weights.is_some());
        let mut data = Vec::with_capacity(self.points.len() * columns);
        for (i, x) in self.points.iter().enumerate() {
            let w = self.weights.as_ref().map(|w| w[i]);
            data.extend((x * w.unwrap_or_else(T::one)).iter());
            data.extend(w);
        }
        let data = carry(&self.axes, axes, columns, data)?;
        let weights: Option<Vec<T>> = self.weights.is_some().then(|| data.chunks_exact(columns).map(|c| c[N]).collect());
        let point = |(i, c): (usize, &[T])| {
            let w = weights.as_ref().map_or_else(T::one, |w| w[i]);
            Vector::from_fn(|k, _| c[k] / w)
        };
        let points = data.chunks_exact(columns).enumerate().map(point).collect();
        Ok(Self { axes: axes.clone(), points, weights })
    }

    /// The net's weight function in the splines `axes`, one weight per function; `None` for a net without weights.
    ///
    /// # Errors
    /// [`NetError::Contain`] if `axes` do not contain the net's splines.
    pub fn weights_on(&self, axes: &[BSpline<T>; D]) -> Result<Option<Vec<T>>, NetError> {
        self.weights.as_ref().map(|w| carry(&self.axes, axes, 1, w.clone())).transpose()
    }

    /// Breakpoints with at least `elements[k]` elements in direction k: every span is divided equally, so the number is
    /// rounded up to a multiple of the spans.
    pub fn breakpoints_total(&self, elements: [usize; D]) -> [Vec<T>; D] {
        self.breakpoints_per_span(std::array::from_fn(|k| elements[k].div_ceil(self.axes[k].num_elements())))
    }

    /// Breakpoints that divide every span of direction k into `parts[k]` equal parts; zero counts as one.
    pub fn breakpoints_per_span(&self, parts: [usize; D]) -> [Vec<T>; D] {
        std::array::from_fn(|k| {
            let n = parts[k].max(1);
            let old = self.axes[k].breakpoints();
            let inside = |w: &[T]| (0..n).map(|j| w[0] + (w[1] - w[0]) * num::<T>(j) / num::<T>(n)).collect::<Vec<T>>();
            let mut all: Vec<T> = old.windows(2).flat_map(inside).collect();
            all.extend(old.last().copied());
            all
        })
    }
}

/// Writes the functions whose coefficients in the product of `from` are `data` (`columns` per function) in that of `to`.
fn carry<const D: usize, T: Real>(
    from: &[BSpline<T>; D],
    to: &[BSpline<T>; D],
    columns: usize,
    mut data: Vec<T>,
) -> Result<Vec<T>, NetError> {
    let mut counts: [usize; D] = std::array::from_fn(|k| from[k].num_functions());
    for axis in 0..D {
        if from[axis] == to[axis] {
            continue;
        }
        // entry (before, i, after) of the data: i runs along the axis, `before` is faster
        let before = columns * counts[..axis].iter().product::<usize>();
        let after: usize = counts[axis + 1..].iter().product();
        let n = counts[axis];
        let rows: Vec<Vec<T>> = (0..n)
            .map(|i| (0..after).flat_map(|o| data[(o * n + i) * before..(o * n + i + 1) * before].iter().copied()).collect())
            .collect();
        let rows = from[axis].express_in(&to[axis], &rows).map_err(|source| NetError::Contain { axis, source })?;
        counts[axis] = rows.len();
        data = (0..after).flat_map(|o| rows.iter().flat_map(move |r| r[o * before..(o + 1) * before].iter().copied())).collect();
    }
    Ok(data)
}
