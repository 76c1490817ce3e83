//! Reference cells: corners, faces, centres, sample points.

use crate::basis::Cell;
use crate::linalg::{Real, Vector, lit, num};

/// A face of a reference cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Face<const D: usize, T: Real = f64> {
    /// Its centre.
    pub center: Vector<D, T>,
    /// Local numbers of its corners, in the order of [`Elements::corners`](crate::basis::Elements::corners).
    pub corners: Vec<usize>,
}

/// The corners of a cell, first axis fastest; the origin and the ends of the axes on a simplex.
pub fn corners<const D: usize, T: Real>(cell: Cell) -> Vec<Vector<D, T>> {
    let unit = |on: &dyn Fn(usize) -> bool| Vector::<D, T>::from_fn(|k, _| if on(k) { T::one() } else { T::zero() });
    match cell {
        Cell::Tensor => (0..1usize << D).map(|c| unit(&|k| c >> k & 1 == 1)).collect(),
        Cell::Simplex => (0..=D).map(|c| unit(&|k| c == k + 1)).collect(),
    }
}

/// The centre of a cell.
pub fn center<const D: usize, T: Real>(cell: Cell) -> Vector<D, T> {
    match cell {
        Cell::Tensor => Vector::repeat(lit(0.5)),
        Cell::Simplex => Vector::repeat(T::one() / num(D + 1)),
    }
}

/// The faces of a cell: xi_k = 0 and xi_k = 1 in turn; on a simplex xi_k = 0 for every k, then sum xi_k = 1.
pub fn faces<const D: usize, T: Real>(cell: Cell) -> Vec<Face<D, T>> {
    let points = corners::<D, T>(cell);
    let face = |ids: Vec<usize>| {
        let sum = ids.iter().fold(Vector::zeros(), |s: Vector<D, T>, &c| s + points[c]);
        Face { center: sum / num::<T>(ids.len().max(1)), corners: ids }
    };
    match cell {
        Cell::Tensor => (0..2 * D).map(|f| face((0..points.len()).filter(|c| c >> (f / 2) & 1 == f % 2).collect())).collect(),
        Cell::Simplex => (0..=D).map(|f| face((0..=D).filter(|&c| c != (f + 1) % (D + 1)).collect())).collect(),
    }
}

/// The face on which all of `points` lie to within `tolerance`; `None` if there is none.
pub fn face_of<const D: usize, T: Real>(cell: Cell, points: &[Vector<D, T>], tolerance: T) -> Option<usize> {
    let on = |value: &dyn Fn(&Vector<D, T>) -> T| points.iter().all(|p| value(p).abs() <= tolerance);
    match cell {
        Cell::Tensor => (0..2 * D).find(|&f| on(&|p| p[f / 2] - num(f % 2))),
        Cell::Simplex => (0..=D).find(|&f| if f < D { on(&|p| p[f]) } else { on(&|p| p.sum() - T::one()) }),
    }
}

/// A grid of `n` points per direction (ends included, n >= 2), laid out on a simplex by xi_k = a_k prod_{j < k} (1 - a_j).
pub fn grid<const D: usize, T: Real>(cell: Cell, n: usize) -> Vec<Vector<D, T>> {
    let line: Vec<T> = (0..n).map(|i| num::<T>(i) / num(n.max(2) - 1)).collect();
    spread(cell, &line)
}

/// All products of the numbers `line`, first axis fastest, laid out on a simplex as in [`grid`].
pub fn spread<const D: usize, T: Real>(cell: Cell, line: &[T]) -> Vec<Vector<D, T>> {
    let n = line.len();
    (0..n.pow(D as u32))
        .map(|q| {
            let mut rest = q;
            let mut scale = T::one();
            Vector::from_fn(|_, _| {
                let a = line[rest % n];
                rest /= n;
                let xi = a * scale;
                if cell == Cell::Simplex {
                    scale *= T::one() - a;
                }
                xi
            })
        })
        .collect()
}

/// Whether `xi` is in the closed cell to within `tolerance`.
pub fn contains<const D: usize, T: Real>(cell: Cell, xi: &Vector<D, T>, tolerance: T) -> bool {
    xi.iter().all(|&v| v >= -tolerance)
        && match cell {
            Cell::Tensor => xi.iter().all(|&v| v <= T::one() + tolerance),
            Cell::Simplex => xi.sum() <= T::one() + tolerance,
        }
}

/// Distance of `xi` from the cell in local coordinates; zero inside.
pub fn outside<const D: usize, T: Real>(cell: Cell, xi: &Vector<D, T>) -> T {
    let beyond = match cell {
        Cell::Tensor => xi.iter().fold(T::zero(), |m, &v| m.max(v - T::one())),
        Cell::Simplex => xi.sum() - T::one(),
    };
    xi.iter().fold(beyond.max(T::zero()), |m, &v| m.max(-v))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_have_their_centre_and_corners_on_them() {
        fn one<const D: usize>(cell: Cell) {
            let corner = corners::<D, f64>(cell);
            let all = faces::<D, f64>(cell);
            assert_eq!(all.len(), if cell == Cell::Tensor { 2 * D } else { D + 1 });
            for (f, face) in all.iter().enumerate() {
                let mut points: Vec<Vector<D>> = face.corners.iter().map(|&c| corner[c]).collect();
                points.push(face.center);
                assert_eq!(face_of(cell, &points, 1e-14), Some(f));
                assert_eq!(face.corners.len(), if cell == Cell::Tensor { 1 << (D - 1) } else { D });
            }
            assert!(contains(cell, &center::<D, f64>(cell), 0.0));
            assert!(grid::<D, f64>(cell, 5).iter().all(|p| contains(cell, p, 1e-14)));
            assert_eq!(face_of(cell, &[center::<D, f64>(cell)], 1e-14), None);
        }
        for cell in [Cell::Tensor, Cell::Simplex] {
            one::<1>(cell);
            one::<2>(cell);
            one::<3>(cell);
        }
    }
}
