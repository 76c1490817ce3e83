//! Least squares with coefficients that are not negative: few equations, many columns.
//!
//!   min |A z - b| over z >= 0
//!
//! Source: Lawson, Hanson, Solving Least Squares Problems, Prentice-Hall 1974, chapter 23, algorithm NNLS.

use nalgebra::{DMatrix, DVector};

/// Correlations of a column with the residual below this part of |b| do not count.
const NO_GAIN: f64 = 1e-13;
/// Singular values below this part of the largest count as zero.
const RANK: f64 = 1e-12;
/// Exchanges allowed per equation; three are usual.
const EXCHANGES: usize = 50;

/// z >= 0 with the least |A z - b|, and the residual b - A z.
///
/// At the solution the residual has no positive product with any column: where it is not zero it separates b from the cone
/// of the columns (Farkas). At most as many entries of z are positive as there are equations.
pub fn nonnegative_least_squares(columns: &[DVector<f64>], b: &DVector<f64>) -> (Vec<f64>, DVector<f64>) {
    let length: Vec<f64> = columns.iter().map(|c| c.norm()).collect();
    let largest = length.iter().fold(0.0, |m: f64, &l| m.max(l));
    let usable: Vec<usize> = (0..columns.len()).filter(|&j| length[j] > RANK * largest).collect();
    let unit: Vec<DVector<f64>> = usable.iter().map(|&j| &columns[j] / length[j]).collect();
    let (mut free, mut value): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
    let rest = |free: &[usize], value: &[f64]| free.iter().zip(value).fold(b.clone(), |r, (&j, &v)| r - &unit[j] * v);
    for _ in 0..EXCHANGES * b.len() {
        let residual = rest(&free, &value);
        let gain = |j: &usize| unit[*j].dot(&residual);
        let best = (0..unit.len()).filter(|j| !free.contains(j)).max_by(|x, y| gain(x).total_cmp(&gain(y)));
        let Some(best) = best.filter(|j| free.len() < b.len() && gain(j) > NO_GAIN * b.norm()) else { break };
        free.push(best);
        value.push(0.0);
        loop {
            let matrix = DMatrix::from_fn(b.len(), free.len(), |i, k| unit[free[k]][i]);
            let svd = matrix.svd(true, true);
            let tolerance = RANK * svd.singular_values.max();
            let Ok(wanted) = svd.solve(b, tolerance) else { break };
            // as far towards the unrestricted optimum as no coefficient becomes negative
            let blocked = (0..free.len()).filter(|&k| wanted[k] <= 0.0);
            let step = blocked.map(|k| value[k] / (value[k] - wanted[k])).filter(|s| s.is_finite()).fold(1.0, f64::min);
            for k in 0..free.len() {
                value[k] += step * (wanted[k] - value[k]);
            }
            let stay: Vec<bool> = (0..free.len()).map(|k| wanted[k] > 0.0 || value[k] > RANK * b.norm()).collect();
            if stay.iter().all(|&s| s) {
                break;
            }
            let mut keep = stay.iter();
            free.retain(|_| *keep.next().expect("one flag per entry"));
            let mut keep = stay.iter();
            value.retain(|_| *keep.next().expect("one flag per entry"));
            if free.is_empty() {
                break;
            }
        }
    }
    let residual = rest(&free, &value);
    let mut z = vec![0.0; columns.len()];
    for (&j, &v) in free.iter().zip(&value) {
        z[usable[j]] = v / length[usable[j]];
    }
    (z, residual)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(x: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(x)
    }

    #[test]
    fn what_the_cone_holds_is_met_and_what_it_does_not_is_projected() {
        // the quarter plane between (1, 0) and (1, 1)
        let cone = [column(&[1.0, 0.0]), column(&[2.0, 2.0]), column(&[3.0, 1.0])];
        let (z, r) = nonnegative_least_squares(&cone, &column(&[5.0, 2.0]));
        assert!(r.norm() < 1e-12 && z.iter().all(|&z| z >= 0.0), "{z:?} {r}");
        // (0, 2) is nearest to (1, 1)
        let (z, r) = nonnegative_least_squares(&cone, &column(&[0.0, 2.0]));
        assert!((r - column(&[-1.0, 1.0])).norm() < 1e-12 && (z[1] - 0.5).abs() < 1e-12, "{z:?}");
        // opposite to all
        let (z, r) = nonnegative_least_squares(&cone, &column(&[-1.0, -1.0]));
        assert!((r - column(&[-1.0, -1.0])).norm() < 1e-12 && z.iter().all(|&z| z == 0.0), "{z:?}");
        assert_eq!(nonnegative_least_squares(&[], &column(&[1.0])).1, column(&[1.0]));
        assert_eq!(nonnegative_least_squares(&[column(&[0.0])], &column(&[1.0])).0, [0.0]);
    }

    #[test]
    fn the_conditions_of_the_minimum_hold_for_many_random_columns() {
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as f64 / (1u64 << 30) as f64 - 1.0
        };
        for trial in 0..200 {
            let (d, m) = (1 + trial % 6, trial % 40);
            let columns: Vec<DVector<f64>> = (0..m).map(|_| DVector::from_fn(d, |_, _| random() + 0.3)).collect();
            let b = DVector::from_fn(d, |_, _| random());
            let (z, r) = nonnegative_least_squares(&columns, &b);
            let made = columns.iter().zip(&z).fold(DVector::zeros(d), |sum, (c, &z)| sum + c * z);
            assert!((&b - made - &r).norm() < 1e-10);
            for (c, &z) in columns.iter().zip(&z) {
                assert!(z >= 0.0 && c.dot(&r) < 1e-9 && (z * c.dot(&r)).abs() < 1e-9, "trial {trial}: {z} {}", c.dot(&r));
            }
        }
    }
}
