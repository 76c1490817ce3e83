//! Exact NURBS patches of simple shapes.
//!
//! Arcs are quadratic with one span per started 90 degrees; the middle point of a span of angle 2 a lies at distance
//! r / cos a and has the weight cos a. Source: Piegl, Tiller, The NURBS Book, section 7.3.

use super::{ControlNet, NetError};
use crate::basis::BSpline;
use crate::linalg::Vector;

/// Error when a shape cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A number is not finite.
    #[error("{name} = {value} is not a finite number")]
    NotFinite {
        /// Name of the argument.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A box has no extent along an axis.
    #[error("the box has min = {min} and max = {max} along axis {axis}; max must be larger")]
    Extent {
        /// The axis, 0 for x.
        axis: usize,
        /// Least coordinate.
        min: f64,
        /// Largest coordinate.
        max: f64,
    },
    /// A radius is out of range.
    #[error("{name} = {value} is out of range; {allowed}")]
    Radius {
        /// Name of the radius or width.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Allowed range.
        allowed: &'static str,
    },
    /// An angle is out of range.
    #[error("the sector from {from} to {to} degrees spans {span} degrees; it must span more than 0 and at most 360, either way")]
    Angle {
        /// First angle.
        from: f64,
        /// Last angle.
        to: f64,
        /// The difference.
        span: f64,
    },
    /// The control net is invalid.
    #[error(transparent)]
    TensorField(#[from] NetError),
}

fn finite(name: &'static str, values: &[f64]) -> Result<(), ShapeError> {
    match values.iter().find(|v| !v.is_finite()) {
        Some(&value) => Err(ShapeError::NotFinite { name, value }),
        None => Ok(()),
    }
}

/// Degree 1 on one span.
fn straight() -> BSpline<f64> {
    BSpline::uniform(1, 1, 0)
}

/// The box `min <= x <= max`; u, v, w run along x, y, z.
///
/// # Errors
/// [`ShapeError`] for numbers that are not finite, and where max is not larger than min.
pub fn brick<const N: usize>(min: [f64; N], max: [f64; N]) -> Result<ControlNet<N, N>, ShapeError> {
    finite("min", &min)?;
    finite("max", &max)?;
    if let Some(axis) = (0..N).find(|&k| max[k] <= min[k]) {
        return Err(ShapeError::Extent { axis, min: min[axis], max: max[axis] });
    }
    let points = (0..1usize << N).map(|c| Vector::from_fn(|k, _| if c >> k & 1 == 1 { max[k] } else { min[k] })).collect();
    Ok(ControlNet::try_new(std::array::from_fn(|_| straight()), points, None)?)
}

/// The rectangle `min <= x <= max`; u runs along x, v along y.
///
/// # Errors
/// As [`brick`].
pub fn rectangle(min: [f64; 2], max: [f64; 2]) -> Result<ControlNet<2, 2>, ShapeError> {
    brick(min, max)
}

/// cos and sin of an angle in degrees, exact at multiples of 90.
fn cos_sin(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).round();
    let (s, c) = (degrees - 90.0 * quarters).to_radians().sin_cos();
    match quarters.rem_euclid(4.0) as usize {
        0 => (c, s),
        1 => (-s, c),
        2 => (-c, -s),
        _ => (s, -c),
    }
}

/// The unit arc from `from` to `to` degrees in `spans` pieces: axis, points, weights.
fn arc(from: f64, to: f64, spans: usize) -> (BSpline<f64>, Vec<Vector<2>>, Vec<f64>) {
    let mut knots = vec![0.0; 3];
    for i in 1..spans {
        knots.extend([i as f64 / spans as f64; 2]);
    }
    knots.extend([1.0; 3]);
    let axis = BSpline::try_new(2, knots).expect("knots of an arc are open and increase");
    // multiples of half a span, counted from both ends so that the last angle is `to` itself
    let angle = |i: usize| from + (to - from) * (i as f64 / (2 * spans) as f64);
    let half = ((to - from) / (2 * spans) as f64).to_radians().cos();
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for i in 0..=2 * spans {
        let (c, s) = cos_sin(if i == 2 * spans { to } else { angle(i) });
        let (radius, weight) = if i % 2 == 1 { (1.0 / half, half) } else { (1.0, 1.0) };
        points.push(Vector::<2>::new(c, s) * radius);
        weights.push(weight);
    }
    (axis, points, weights)
}

fn spans_of([from, to]: [f64; 2]) -> Result<usize, ShapeError> {
    finite("angle_deg", &[from, to])?;
    let span = (to - from).abs();
    if span == 0.0 || span > 360.0 * (1.0 + 1e-14) {
        return Err(ShapeError::Angle { from, to, span });
    }
    // rounding of the difference starts no new span
    Ok(((span / 90.0) * (1.0 - 1e-14)).ceil().max(1.0) as usize)
}

/// The patch of straight lines between two rows of points with the same weights; v runs from the first to the second.
fn ruled(axis: BSpline<f64>, rows: [Vec<Vector<2>>; 2], weights: &[f64]) -> Result<ControlNet<2, 2>, ShapeError> {
    let points = rows.concat();
    Ok(ControlNet::try_new([axis, straight()], points, Some([weights, weights].concat()))?)
}

/// Two radii of a ring or a shell: positive, and not the same.
fn check_radii(radius: [f64; 2]) -> Result<(), ShapeError> {
    finite("radius", &radius)?;
    for r in radius {
        if r <= 0.0 {
            return Err(ShapeError::Radius { name: "radius", value: r, allowed: "both radii must be positive" });
        }
    }
    if radius[0] == radius[1] {
        return Err(ShapeError::Radius { name: "radius", value: radius[1], allowed: "the two radii must differ" });
    }
    Ok(())
}

/// A ring sector; u runs along the angle from `angle_deg[0]` to `angle_deg[1]`, v from `radius[0]` to `radius[1]`.
///
/// The angle may fall and the radii may come in either order; the patch is then left-handed.
/// # Errors
/// [`ShapeError`] for numbers that are not finite, radii that are not positive or equal, and a sector of 0 or more than
/// 360 degrees.
pub fn annulus_sector(center: [f64; 2], radius: [f64; 2], angle_deg: [f64; 2]) -> Result<ControlNet<2, 2>, ShapeError> {
    finite("center", &center)?;
    check_radii(radius)?;
    let (axis, unit, weights) = arc(angle_deg[0], angle_deg[1], spans_of(angle_deg)?);
    let c = Vector::<2>::from(center);
    let row = |r: f64| unit.iter().map(|p| c + p * r).collect();
    ruled(axis, [row(radius[0]), row(radius[1])], &weights)
}

/// A disc sector; u runs along the angle, v from the centre (v0, collapsed) to the radius.
///
/// # Errors
/// As [`annulus_sector`].
pub fn disc_sector(center: [f64; 2], radius: f64, angle_deg: [f64; 2]) -> Result<ControlNet<2, 2>, ShapeError> {
    finite("center", &center)?;
    finite("radius", &[radius])?;
    if radius <= 0.0 {
        return Err(ShapeError::Radius { name: "radius", value: radius, allowed: "it must be positive" });
    }
    let (axis, unit, weights) = arc(angle_deg[0], angle_deg[1], spans_of(angle_deg)?);
    let c = Vector::<2>::from(center);
    let rim = unit.iter().map(|p| c + p * radius).collect();
    ruled(axis, [vec![c; unit.len()], rim], &weights)
}

/// A quarter of a square plate with a circular hole at the origin, in the first quadrant.
///
/// u runs around the hole from the x axis to the y axis in two arcs of 45 degrees, v from the hole to the outer edge; v1
/// is both outer edges, with the plate's corner at u = 1/2.
/// # Errors
/// [`ShapeError`] for numbers that are not finite, and unless 0 < radius < half_width.
pub fn plate_with_hole(radius: f64, half_width: f64) -> Result<ControlNet<2, 2>, ShapeError> {
    finite("radius", &[radius])?;
    finite("half_width", &[half_width])?;
    if radius <= 0.0 {
        return Err(ShapeError::Radius { name: "radius", value: radius, allowed: "it must be positive" });
    }
    if half_width <= radius {
        return Err(ShapeError::Radius { name: "half_width", value: half_width, allowed: "it must be larger than the radius of the hole" });
    }
    let (axis, unit, weights) = arc(0.0, 90.0, 2);
    let hole = unit.iter().map(|p| p * radius).collect();
    let l = half_width;
    // a rational span with symmetric weights and a middle point in the middle is straight
    let edge = [[l, 0.0], [l, 0.5 * l], [l, l], [0.5 * l, l], [0.0, l]].map(Vector::<2>::from).to_vec();
    ruled(axis, [hole, edge], &weights)
}

/// An eighth of a spherical shell, the first octant about `center`; u runs along the longitude from the x axis to the y
/// axis, v along the latitude from the equator to the pole, w from `radius[0]` to `radius[1]`.
///
///   `x = center + r (cos v cos u, cos v sin u, sin v)`,  u, v from 0 to 90 degrees
///
/// The pole is a collapsed face: v1 is the line from (0, 0, r0) to (0, 0, r1) and no side. With r0 < r1 the patch is
/// right-handed.
/// # Errors
/// [`ShapeError`] for numbers that are not finite, and radii that are not positive or equal.
pub fn sphere_octant(center: [f64; 3], radius: [f64; 2]) -> Result<ControlNet<3, 3>, ShapeError> {
    finite("center", &center)?;
    check_radii(radius)?;
    let (axis, unit, weights) = arc(0.0, 90.0, 1);
    let c = Vector::<3>::from(center);
    let (mut points, mut all) = (Vec::new(), Vec::new());
    for r in radius {
        // the meridian (cos v, sin v) turned about the z axis: coefficients and weights are products of both arcs'
        for (meridian, wv) in unit.iter().zip(&weights) {
            for (parallel, wu) in unit.iter().zip(&weights) {
                points.push(c + Vector::<3>::new(meridian[0] * parallel[0], meridian[0] * parallel[1], meridian[1]) * r);
                all.push(wu * wv);
            }
        }
    }
    Ok(ControlNet::try_new([axis.clone(), axis, straight()], points, Some(all))?)
}
