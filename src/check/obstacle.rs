//! Contract of [`Obstacle`]: the projection is closest, the normal is unit, the gap is signed.

use crate::contact::Obstacle;
use crate::linalg::{Real, Vector, to_f64};

/// Checks `obstacle` at `points` (those that do not face it are skipped), with defects up to `tolerance` \[length\].
///
/// Targets that are exact to first order only (level sets by f / |grad f|) need points near their surface, and a
/// tolerance of the square of the distance over the radius of curvature.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn obstacle<const D: usize, const N: usize, T: Real>(
    obstacle: &dyn Obstacle<D, N, T>,
    points: &[Vector<N, T>],
    tolerance: f64,
) -> Result<(), String> {
    let hits: Vec<_> = points.iter().map(|x| obstacle.project(x)).collect();
    if hits.iter().all(Option::is_none) {
        return Err("the obstacle faces none of the points".into());
    }
    for (x, hit) in points.iter().zip(&hits) {
        let Some(hit) = hit else { continue };
        if (to_f64(hit.normal.norm()) - 1.0).abs() > 1e-12 {
            return Err(format!("the normal at {x:?} has the length {:?}", hit.normal.norm()));
        }
        let along = (x - hit.x).dot(&hit.normal);
        if to_f64((along - hit.gap).abs()) > tolerance {
            return Err(format!("the gap at {x:?} is {:?}, along the normal it is {along:?}", hit.gap));
        }
        // on the surface the gap is zero and the normal is the same
        if let Some(again) = obstacle.project(&hit.x)
            && (to_f64(again.gap.abs()) > tolerance || to_f64((again.x - hit.x).norm()) > tolerance)
        {
            return Err(format!("the projection {:?} of {x:?} has the gap {:?}: it is not on the surface", hit.x, again.gap));
        }
        // a step out along the normal opens the gap by as much
        let step = T::one() * crate::linalg::lit(1e-3);
        if let Some(out) = obstacle.project(&(hit.x + hit.normal * step))
            && to_f64((out.gap - step).abs()) > tolerance + 1e-6
        {
            return Err(format!("a step of 1e-3 out of the surface at {:?} makes the gap {:?}", hit.x, out.gap));
        }
        let distance = to_f64((x - hit.x).norm());
        if let Some(other) = hits.iter().flatten().find(|other| to_f64((x - other.x).norm()) < distance - tolerance) {
            return Err(format!("{x:?} is projected to {:?}, but {:?} is closer", hit.x, other.x));
        }
    }
    Ok(())
}
