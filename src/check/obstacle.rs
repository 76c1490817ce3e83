//! Contract of [`Obstacle`]: the projection is the closest that opposes, the normal is unit, the gap is signed.

use crate::contact::{Hit, Obstacle, opposed};
use crate::linalg::{Real, Vector, lit, num, to_f64};

/// Directions of slave normals per plane of two axes.
const DIRECTIONS: usize = 8;

/// Checks `obstacle` at `points` with slave normals in directions all around, with defects up to `tolerance` \[length\]. What does not
/// oppose a normal is skipped, as contact does.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn obstacle<const D: usize, const N: usize, T: Real>(
    obstacle: &dyn Obstacle<D, N, T>,
    points: &[Vector<N, T>],
    tolerance: f64,
) -> Result<(), String> {
    let mut faced = false;
    for outward in directions::<N, T>() {
        let mut hits = Vec::with_capacity(points.len());
        for x in points {
            let hit = obstacle.project(x, &outward);
            if let Some(hit) = &hit {
                numbers(x, hit)?;
            }
            hits.push(opposed(obstacle, x, &outward));
        }
        for (x, hit) in points.iter().zip(&hits) {
            let Some(hit) = hit else { continue };
            faced = true;
            one(obstacle, (x, &outward), hit, tolerance)?;
            let distance = to_f64((x - hit.x).norm());
            // a point of another hit is a foot of this one only where the line to it is at right angles
            let foot = |other: &Hit<D, N, T>| {
                let away = x - other.x;
                // and at a corner a face that opposes more may be farther
                let as_much = to_f64(other.normal.dot(&outward) - hit.normal.dot(&outward)) <= 1e-9;
                as_much && to_f64((away - other.normal * away.dot(&other.normal)).norm()) <= tolerance
            };
            if let Some(other) = hits.iter().flatten().find(|other| to_f64((x - other.x).norm()) < distance - tolerance && foot(other)) {
                return Err(format!("{x:?} is projected to {:?}, but {:?} is closer", hit.x, other.x));
            }
        }
    }
    if faced { Ok(()) } else { Err("the obstacle faces none of the points".into()) }
}

/// Unit vectors all around, in every plane of two axes.
fn directions<const N: usize, T: Real>() -> Vec<Vector<N, T>> {
    let mut all = Vec::new();
    for a in 0..N {
        for b in 0..a {
            for k in 0..DIRECTIONS {
                let (s, c) = (2.0 * std::f64::consts::PI * num::<f64>(k) / num::<f64>(DIRECTIONS)).sin_cos();
                let mut direction = Vector::<N, T>::zeros();
                (direction[a], direction[b]) = (lit(s), lit(c));
                all.push(direction);
            }
        }
    }
    all
}

/// Checks that a hit has a unit normal and a gap along it.
fn numbers<const D: usize, const N: usize, T: Real>(x: &Vector<N, T>, hit: &Hit<D, N, T>) -> Result<(), String> {
    let length = to_f64(hit.normal.norm());
    if !length.is_finite() || (length - 1.0).abs() > 1e-12 {
        return Err(format!("the normal at {x:?} has the length {length:?}"));
    }
    if !(hit.gap.is_finite() && hit.x.iter().all(|v| v.is_finite())) {
        return Err(format!("the gap at {x:?} is {:?}", hit.gap));
    }
    Ok(())
}

/// Checks the gap of a hit, and that it lies on the surface.
fn one<const D: usize, const N: usize, T: Real>(
    obstacle: &dyn Obstacle<D, N, T>,
    (x, outward): (&Vector<N, T>, &Vector<N, T>),
    hit: &Hit<D, N, T>,
    tolerance: f64,
) -> Result<(), String> {
    let along = (x - hit.x).dot(&hit.normal);
    if to_f64((along - hit.gap).abs()) > tolerance {
        return Err(format!("the gap at {x:?} is {:?}, along the normal it is {along:?}", hit.gap));
    }
    // on the surface the gap is zero and the normal is the same
    if let Some(again) = opposed(obstacle, &hit.x, outward)
        && (to_f64(again.gap.abs()) > tolerance || to_f64((again.x - hit.x).norm()) > tolerance)
    {
        return Err(format!("the projection {:?} of {x:?} has the gap {:?}: it is not on the surface", hit.x, again.gap));
    }
    // a step out along the normal opens the gap by as much
    let step = lit::<T>(1e-3);
    if let Some(out) = opposed(obstacle, &(hit.x + hit.normal * step), outward)
        && to_f64((out.gap - step).abs()) > tolerance + 1e-6
    {
        return Err(format!("a step of 1e-3 out of the surface at {:?} makes the gap {:?}", hit.x, out.gap));
    }
    Ok(())
}
