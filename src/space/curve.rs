//! Hilbert's space-filling curve: points near on it are near in space.
//!
//! Source: J. Skilling, Programming the Hilbert curve, AIP Conf. Proc. 707 (2004) 381.

use crate::linalg::Vector;
use crate::parallel;
use rayon::prelude::*;

/// Base-2 logarithm of the steps of the curve per direction.
const BITS: u32 = 20;

/// Indices of `points` in the order along Hilbert's curve through their box; n log n. Points in one cell of the curve keep
/// their order.
pub(super) fn along<const N: usize>(points: &[Vector<N>]) -> Vec<u32> {
    const { assert!(N == 2 || N == 3, "curves in the plane and in space") }
    let lo = points.iter().fold(Vector::<N>::repeat(f64::INFINITY), |m, x| m.inf(x));
    let hi = points.iter().fold(Vector::<N>::repeat(f64::NEG_INFINITY), |m, x| m.sup(x));
    // one scale for all directions: cells of the curve are squares
    let size = (hi - lo).max();
    let scale = if size > 0.0 { f64::from((1u32 << BITS) - 1) / size } else { 0.0 };
    let key = |x: &Vector<N>| hilbert::<N>(std::array::from_fn(|k| ((x[k] - lo[k]) * scale) as u32));
    let mut keyed: Vec<(u64, u32)> = parallel::map(points.len(), |i| (key(&points[i]), i as u32));
    keyed.par_sort_unstable();
    keyed.into_iter().map(|(_, i)| i).collect()
}

/// Position along the curve of the cell with the integer coordinates `x`.
fn hilbert<const N: usize>(mut x: [u32; N]) -> u64 {
    let top = 1u32 << (BITS - 1);
    let mut bit = top;
    while bit > 1 {
        for k in 0..N {
            if x[k] & bit != 0 {
                x[0] ^= bit - 1;
            } else {
                let turn = (x[0] ^ x[k]) & (bit - 1);
                x[0] ^= turn;
                x[k] ^= turn;
            }
        }
        bit >>= 1;
    }
    for k in 1..N {
        x[k] ^= x[k - 1];
    }
    let mut turn = 0;
    bit = top;
    while bit > 1 {
        if x[N - 1] & bit != 0 {
            turn ^= bit - 1;
        }
        bit >>= 1;
    }
    x.iter_mut().for_each(|x| *x ^= turn);
    (0..BITS).rev().fold(0, |key, b| x.iter().fold(key, |key, x| key << 1 | u64::from(x >> b & 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn neighbours<const N: usize>(n: usize) {
        let points: Vec<Vector<N>> = (0..n.pow(N as u32)).map(|i| Vector::from_fn(|k, _| (i / n.pow(k as u32) % n) as f64)).collect();
        let order = along(&points);
        let mut seen = order.clone();
        seen.sort_unstable();
        assert!(seen.iter().enumerate().all(|(i, &p)| i == p as usize), "every point once");
        for pair in order.windows(2) {
            let step = (points[pair[0] as usize] - points[pair[1] as usize]).abs();
            assert_eq!(step.sum(), 1.0, "the curve goes from a point to its neighbour");
        }
    }

    #[test]
    fn the_curve_meets_every_point_of_a_grid_once_and_steps_to_neighbours() {
        neighbours::<2>(16);
        neighbours::<3>(8);
    }

    #[test]
    fn points_in_one_place_keep_their_order() {
        assert_eq!(along(&[Vector::<2>::new(1.0, 2.0); 4]), [0, 1, 2, 3]);
        assert!(along::<3>(&[]).is_empty());
    }
}
