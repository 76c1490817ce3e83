//! Contract of [`Geometry`]: derivatives, bounding boxes, independence of batches, and blocks that repeat the map.

use crate::basis::{Block, Order, ShapeTable};
use crate::geometry::{Geometry, MapTable, cell};
use crate::linalg::{Real, Vector, lit, num};

/// Largest number of elements checked, evenly spread.
const ELEMENTS: usize = 60;

/// Up to [`ELEMENTS`] elements of `count`, first and last included.
pub(super) fn chosen(count: usize) -> Vec<usize> {
    let n = count.min(ELEMENTS);
    (0..n).map(|i| if n < 2 { 0 } else { i * (count - 1) / (n - 1) }).collect()
}

/// Points of the cell off its middle and its axes, and one outside.
pub(super) fn sample_points<const D: usize, T: Real>(kind: crate::basis::Cell) -> Vec<Vector<D, T>> {
    let line = [0.13, 0.48, 0.91].map(lit::<T>);
    let mut points = cell::spread::<D, T>(kind, &line);
    points.push(Vector::from_fn(|k, _| lit(1.07 - 0.4 * k as f64)));
    points
}

/// Checks the map `geometry`.
///
/// Rules: x, Jacobian and second derivatives are finite, derivatives are those of x, also outside the cell; they do not
/// depend on the batch or on the order asked for; [`Geometry::bounds`] hold the element, and [`Geometry::all_bounds`] are the same,
/// [`Geometry::extent`] is around them; corner ids shared by elements are at one place;
/// [`MapStructure::map_block`](crate::geometry::MapStructure::map_block) and
/// [`MapStructure::control`](crate::geometry::MapStructure::control), where there are any, repeat the map.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn geometry<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized>(geometry: &G) -> Result<(), String> {
    let eps = T::default_epsilon();
    let (mut full, mut other) = (MapTable::new(), MapTable::new());
    let boxes = geometry.all_bounds();
    if boxes.len() != geometry.num_elements() {
        return Err(format!("all_bounds gives {} boxes for {} elements", boxes.len(), geometry.num_elements()));
    }
    if geometry.extent() != boxes.iter().copied().reduce(|a, b| a.union(&b)) {
        return Err("extent is not the box around all_bounds".into());
    }
    for e in chosen(geometry.num_elements()) {
        let kind = geometry.cell(e);
        let points = sample_points::<D, T>(kind);
        geometry.map(e, &points, Order::Hessians, &mut full);
        if full.x.len() != points.len() || full.jacobian.len() != points.len() || full.hessian.len() != points.len() {
            return Err(format!("element {e}: the table has not one entry per point"));
        }
        let size = geometry.bounds(e).diagonal();
        if !(size.is_finite() && size > T::zero()) {
            return Err(format!("element {e}: its box has the diagonal {size}"));
        }
        if boxes[e] != geometry.bounds(e) {
            return Err(format!(
                "element {e}: all_bounds gives another box than bounds (or its functions are not those of the reference cell they name)"
            ));
        }
        // points far from the origin have larger rounding errors
        let scale = size + full.x.iter().fold(T::zero(), |m, x| m.max(x.amax()));
        for (q, xi) in points.iter().enumerate() {
            let at = format!("element {e}, xi = {xi:?}");
            if !full.x[q].iter().chain(full.jacobian[q].iter()).all(|v| v.is_finite()) {
                return Err(format!("{at}: the map is not finite"));
            }
            geometry.map(e, &[*xi], Order::Hessians, &mut other);
            if other.x[0] != full.x[q] || other.jacobian[0] != full.jacobian[q] || other.hessian[0] != full.hessian[q] {
                return Err(format!("{at}: a single point gives another map than a batch"));
            }
            let h = eps.cbrt();
            for k in 0..D {
                let step = Vector::<D, T>::from_fn(|i, _| if i == k { h } else { T::zero() });
                geometry.map(e, &[xi + step, xi - step], Order::Gradients, &mut other);
                let difference = (other.x[0] - other.x[1]) / (h + h);
                let bend = (0..N).fold(T::one() * scale, |s, c| s + full.hessian[q][c].amax());
                if (difference - full.jacobian[q].column(k)).amax() > h * h * num::<T>(200) * bend {
                    return Err(format!("{at}: dx/dxi_{k} is not the derivative of x"));
                }
                let turn = (other.jacobian[0] - other.jacobian[1]) / (h + h);
                for c in 0..N {
                    for l in 0..D {
                        let error = (turn[(c, l)] - full.hessian[q][c][(k, l)]).abs();
                        if error > h * h * num::<T>(2000) * bend {
                            return Err(format!("{at}: d2x_{c}/dxi_{k}dxi_{l} is not the derivative of the Jacobian"));
                        }
                    }
                }
            }
        }
        for order in [Order::Values, Order::Gradients] {
            geometry.map(e, &points, order, &mut other);
            let same = other.x == full.x && (order == Order::Values || other.jacobian == full.jacobian);
            if !same || other.jacobian.is_empty() == (order == Order::Gradients) || !other.hessian.is_empty() {
                return Err(format!("element {e}: order {order:?} gives another map than second derivatives, or fills more"));
            }
        }
        let bounds = geometry.bounds(e).inflated(scale * eps * num(16));
        geometry.map(e, &cell::grid::<D, T>(kind, 9), Order::Values, &mut other);
        if let Some(x) = other.x.iter().find(|x| bounds.distance(x) > T::zero()) {
            return Err(format!("element {e}: its box does not hold the point {x:?}"));
        }
        if let Some(block) = geometry.map_structure().map_block(e) {
            let x = block_sum(&block.basis, e, &points[..points.len() - 1], &block.control)?;
            if let Some(q) = (0..x.len()).find(|&q| (x[q] - full.x[q]).amax() > scale * eps * num(200)) {
                return Err(format!("element {e}: map_block gives {:?} for the point {:?}", x[q], full.x[q]));
            }
        }
    }
    super::reference::control(geometry)?;
    corners(geometry)
}

/// sum_i N_i control_i over the functions of a block.
fn block_sum<const D: usize, const N: usize, T: Real>(
    block: &Block<'_, D, T>,
    element: usize,
    points: &[Vector<D, T>],
    control: &[Vector<N, T>],
) -> Result<Vec<Vector<N, T>>, String> {
    let counts: [usize; D] = block.axes.map(|a| a.num_functions());
    if counts.iter().product::<usize>() != control.len() {
        return Err(format!("element {element}: map_block has {} points for {counts:?} functions", control.len()));
    }
    let mut rest = element.checked_sub(block.first).ok_or(format!("element {element}: map_block starts after it"))?;
    let mut lines: Vec<(Vec<usize>, ShapeTable<1, T>)> = Vec::new();
    for (k, axis) in block.axes.iter().enumerate() {
        let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
        let e = rest % axis.num_elements();
        rest /= axis.num_elements();
        axis.active(e, &mut ids);
        let line: Vec<Vector<1, T>> = points.iter().map(|p| Vector::<1, T>::new(p[k])).collect();
        axis.tabulate(e, &line, Order::Values, &mut table);
        lines.push((ids, table));
    }
    if rest > 0 {
        return Err(format!("element {element}: map_block ends before it"));
    }
    Ok((0..points.len())
        .map(|q| {
            let (mut sum, mut total) = (Vector::zeros(), T::zero());
            for a in 0..lines.iter().map(|l| l.0.len()).product() {
                let (mut rest, mut stride, mut i, mut n) = (a, 1, 0, T::one());
                for (k, (ids, table)) in lines.iter().enumerate() {
                    let local = rest % ids.len();
                    rest /= ids.len();
                    i += stride * ids[local];
                    stride *= counts[k];
                    n *= table.values(q)[local];
                }
                let n = n * block.weights.map_or_else(T::one, |w| w[i]);
                total += n;
                sum += control[i] * n;
            }
            if block.weights.is_some() { sum / total } else { sum }
        })
        .collect())
}

/// Checks that corner ids shared by elements have the same coordinates.
fn corners<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T> + ?Sized>(geometry: &G) -> Result<(), String> {
    let mut places = std::collections::HashMap::new();
    let (mut ids, mut table) = (Vec::new(), MapTable::new());
    for e in 0..geometry.num_elements() {
        geometry.corners(e, &mut ids);
        if ids.is_empty() {
            continue;
        }
        let points = cell::corners::<D, T>(geometry.cell(e));
        if ids.len() != points.len() {
            return Err(format!("element {e} has {} corner ids for {} corners", ids.len(), points.len()));
        }
        geometry.map(e, &points, Order::Values, &mut table);
        let tolerance = (geometry.bounds(e).diagonal() + table.x[0].amax()) * T::default_epsilon() * num(1000);
        for (&id, x) in ids.iter().zip(&table.x) {
            let first = *places.entry(id).or_insert((e, *x));
            if (first.1 - x).amax() > tolerance {
                return Err(format!("corner {id} is at {:?} on element {} and at {x:?} on element {e}", first.1, first.0));
            }
        }
    }
    Ok(())
}
