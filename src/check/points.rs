//! Sample points of reference cells.

use crate::basis::Cell;
use crate::linalg::{Real, Vector, lit, num};

/// `count` points inside the cell, no two on a common coordinate line: an additive sequence, collapsed for simplices.
pub(super) fn inside<const D: usize, T: Real>(cell: Cell, count: usize) -> Vec<Vector<D, T>> {
    const STEP: [f64; 3] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3]; // Roberts' sequence in 3D
    (0..count)
        .map(|i| {
            let mut scale = T::one();
            Vector::from_fn(|k, _| {
                let u = lit::<T>((0.5 + (i + 1) as f64 * STEP[k % 3] + (k / 3) as f64 * 0.37).fract()) * scale;
                if cell == Cell::Simplex {
                    scale -= u;
                }
                u
            })
        })
        .collect()
}

/// The corners of the cell, first axis fastest.
pub(super) fn corners<const D: usize, T: Real>(cell: Cell) -> Vec<Vector<D, T>> {
    (0..1usize << D).filter(|c| cell != Cell::Simplex || c.count_ones() <= 1).map(|c| Vector::from_fn(|k, _| num((c >> k) & 1))).collect()
}

/// A point inside and its images by a stretch of 1.2 about the cell's centre, which leave the cell.
pub(super) fn around<const D: usize, T: Real>(cell: Cell) -> Vec<Vector<D, T>> {
    let all = corners::<D, T>(cell);
    let center = all.iter().fold(Vector::<D, T>::zeros(), |s, c| s + c) / num::<T>(all.len());
    let mut points = inside(cell, 3);
    points.extend(all.iter().map(|c| center + (c - center) * lit::<T>(1.2)));
    points
}

/// A segment across the cell in direction `axis`: (start, direction), the cell for parameters 0 to 1.
pub(super) fn line<const D: usize, T: Real>(cell: Cell, axis: usize) -> (Vector<D, T>, Vector<D, T>) {
    let mut start = inside::<D, T>(cell, 1)[0];
    start[axis] = T::zero();
    let mut direction = Vector::<D, T>::zeros();
    direction[axis] = if cell == Cell::Simplex { T::one() - start.sum() } else { T::one() };
    (start, direction)
}
