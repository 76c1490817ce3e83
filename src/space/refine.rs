//! Refinement of breakpoints.

/// Halves every interval of `breakpoints` `times` times.
///
/// # Panics
/// If more than 2^32 intervals would come out.
pub fn halved(breakpoints: &[f64], times: usize) -> Vec<f64> {
    let intervals = breakpoints.len().saturating_sub(1);
    let total = u32::try_from(times).ok().and_then(|t| 1usize.checked_shl(t)).and_then(|pieces| pieces.checked_mul(intervals));
    let total = total.filter(|&n| n as u64 <= 1 << 32).expect("at most 2^32 elements per direction");
    let pieces = total.checked_div(intervals).unwrap_or(1);
    let mut all = Vec::with_capacity(total + 1);
    for w in breakpoints.windows(2) {
        all.extend((0..pieces).map(|i| w[0] + (w[1] - w[0]) * (i as f64 / pieces as f64)));
    }
    all.extend(breakpoints.last());
    all
}

/// Increasing union of `knots` and `breakpoints`; a breakpoint nearer than 1e-10 of the range to a knot is the knot.
pub fn joined(knots: &[f64], breakpoints: &[f64]) -> Vec<f64> {
    let mut all = knots.to_vec();
    if let (Some(a), Some(b)) = (knots.first(), knots.last()) {
        all.extend(breakpoints.iter().copied().filter(|t| knots.iter().all(|k| (k - t).abs() > SAME_KNOT * (b - a))));
    }
    all.sort_by(f64::total_cmp);
    all
}

/// Breakpoints nearer than this share of the range to a knot are that knot.
pub(crate) const SAME_KNOT: f64 = 1e-10;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_keeps_the_old_breakpoints_and_adds_the_middles() {
        assert_eq!(halved(&[0.0, 1.0, 3.0], 1), [0.0, 0.5, 1.0, 2.0, 3.0]);
        assert_eq!(halved(&[0.0, 1.0], 2), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(joined(&[0.0, 0.5, 1.0], &[0.0, 0.2, 0.5 + 1e-13, 1.0]), [0.0, 0.2, 0.5, 1.0]);
    }
}
