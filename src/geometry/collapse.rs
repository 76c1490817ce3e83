//! Collapsed faces of control nets.

/// Control points nearer than this share of the size of their net are one point.
const SAME_POINT: f64 = 1e-10;
/// Rounding errors of a coordinate that was computed, in units of its last place.
const ROUNDINGS: f64 = 16.0;

/// A collapsed face of a net: its lines along a direction are points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CollapsedFace {
    /// The direction across the face.
    pub axis: usize,
    /// Whether it is the last face across it (1) or the first (0).
    pub end: usize,
    /// The direction of its lines that are points.
    pub along: usize,
}

/// Returns the collapsed faces of a net of `counts` control points per direction, the first direction fastest.
///
/// Points are one where their coordinates differ by at most 1e-10 of the largest extent of the net, or by the rounding of their size,
/// which decides for small nets far from the origin. Empty where `points` are not as many as `counts` say.
pub fn collapsed_faces<P: AsRef<[f64]>>(counts: &[usize], points: &[P]) -> Vec<CollapsedFace> {
    if points.is_empty() || counts.iter().product::<usize>() != points.len() {
        return Vec::new();
    }
    let (mut size, mut largest) = (0.0f64, 0.0f64);
    for k in 0..points[0].as_ref().len() {
        let at = points.iter().map(|p| p.as_ref()[k]);
        let (lo, hi) = at.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)));
        (size, largest) = (size.max(hi - lo), largest.max(hi.abs()).max(lo.abs()));
    }
    let near = (SAME_POINT * size).max(ROUNDINGS * f64::EPSILON * largest);
    let same = |a: &P, b: &P| a.as_ref().iter().zip(b.as_ref()).all(|(a, b)| (a - b).abs() <= near);
    let stride = |k: usize| counts[..k].iter().product::<usize>();
    let index = |i: usize, k: usize| i / stride(k) % counts[k];
    let mut found = Vec::new();
    for (axis, end) in (0..counts.len()).flat_map(|axis| [(axis, 0), (axis, 1)]) {
        let on_face = |i: &usize| index(*i, axis) == end * (counts[axis] - 1);
        for along in (0..counts.len()).filter(|&k| k != axis) {
            let is_point = |i: usize| same(&points[i], &points[i - index(i, along) * stride(along)]);
            if (0..points.len()).filter(on_face).all(is_point) {
                found.push(CollapsedFace { axis, end, along });
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of a disc of radius `r` at `at`, its centre `off` wide.
    fn disc(r: f64, at: f64, off: f64) -> Vec<[f64; 2]> {
        [[off, 0.0], [off, off], [0.0, off], [r, 0.0], [r, r], [0.0, r]].map(|p| p.map(|x| x + at)).to_vec()
    }

    #[test]
    fn a_centre_is_a_point_to_rounding_at_any_size_and_place() {
        let point = [CollapsedFace { axis: 1, end: 0, along: 0 }];
        for r in [2e-7, 2.0, 2e7] {
            for off in [0.0, 3e-17, 5e-13] {
                for far in [0.0, 1.0, 1e3] {
                    assert_eq!(collapsed_faces(&[3, 2], &disc(r, far * r, off * r)), point, "{r} {off} {far}");
                }
            }
            assert!(collapsed_faces(&[3, 2], &disc(r, 0.0, 1e-9 * r)).is_empty(), "{r}");
        }
        // so far away that the radius has few digits: a centre that was there before the move is there after it
        assert_eq!(collapsed_faces(&[3, 2], &disc(1.0, 1e6, 1e-10)), point);
    }

    #[test]
    fn faces_of_solids_collapse_along_one_direction_or_two() {
        // a wedge: u0 is an edge along w; its lines along v are points
        let wedge = |x: f64, y: f64, z: f64| vec![x, x * y, z];
        let net = |f: &dyn Fn(f64, f64, f64) -> Vec<f64>| -> Vec<Vec<f64>> {
            (0..8).map(|i| f(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2 & 1))).collect()
        };
        assert_eq!(collapsed_faces(&[2, 2, 2], &net(&wedge)), [CollapsedFace { axis: 0, end: 0, along: 1 }]);
        // a pyramid: u0 is a point
        let pyramid = |x: f64, y: f64, z: f64| vec![x, x * y, x * z];
        let faces = [1, 2].map(|along| CollapsedFace { axis: 0, end: 0, along });
        assert_eq!(collapsed_faces(&[2, 2, 2], &net(&pyramid)), faces);
        assert!(collapsed_faces(&[2, 3], &net(&wedge)).is_empty(), "too few points");
    }
}
