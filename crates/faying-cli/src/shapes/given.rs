//! Nets that a case gives by numbers, and the transformations of nets.

use crate::case::Geometry;
use crate::place::Located;
use crate::registry::Fault;
use faying::geometry::ControlNet;
use faying::linalg::{Matrix, Vector};

/// The first numbers of a list as coordinates; missing ones are zero.
pub(super) fn coordinates<const N: usize>(list: &[f64]) -> [f64; N] {
    std::array::from_fn(|k| list.get(k).copied().unwrap_or(0.0))
}

/// The net of D parameters in N dimensions that a case gives by its numbers.
pub(super) fn nurbs<const D: usize, const N: usize>(
    degree: &[usize],
    knots: &[Located<Vec<f64>>],
    points: &[Vec<f64>],
    weights: Option<&Located<Vec<f64>>>,
) -> Result<ControlNet<D, N>, Fault> {
    let degree = std::array::from_fn(|k| degree.get(k).copied().unwrap_or(1));
    let knots = std::array::from_fn(|k| knots.get(k).map(|list| list.value.clone()).unwrap_or_default());
    let points = points.iter().map(|x| Vector::from(coordinates(x))).collect();
    Ok(ControlNet::from_knots(degree, knots, points, weights.map(|w| w.value.clone()))?)
}

/// Scales and translates a net as `geometry` says, rotated by `turn` between.
pub(super) fn placed<const D: usize, const N: usize>(
    mut net: ControlNet<D, N>,
    geometry: &Geometry,
    turn: Option<Matrix<N, N>>,
) -> ControlNet<D, N> {
    if let Some(factor) = &geometry.scale {
        net = net.scale(factor.value);
    }
    if let Some(turn) = turn {
        net = net.rotate(&turn);
    }
    if let Some(by) = &geometry.translate {
        net = net.translate(&Vector::from(coordinates(&by.value)));
    }
    net
}
