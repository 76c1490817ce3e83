//! Slope triangles: below the end of a line, as steep as the whole or half number nearest to its slope there.

/// A right triangle under a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangle {
    /// Left end, right end of the base, and the corner above the right end; on logarithmic axes the way from the first to the last is
    /// straight and has the slope.
    pub corners: [(f64, f64); 3],
    /// The slope, a multiple of one half.
    pub slope: f64,
}

/// Distance of a triangle from its line, as a share of the decades of the vertical axis.
const AWAY: f64 = 0.07;

/// A triangle for every slope that lines have at their ends, under the lowest line that has it; lines go to smaller x. `decades` is the
/// height of the panel.
pub fn triangles<'a>(lines: impl Iterator<Item = &'a [(f64, f64)]>, decades: f64) -> Vec<Triangle> {
    let mut found: Vec<(Triangle, f64)> = Vec::new();
    for line in lines {
        let [.., (x1, y1), (x0, y0)] = *line else { continue };
        if !(x0 < x1 && y0 < y1) {
            continue;
        }
        let slope = (2.0 * (y1 / y0).log10() / (x1 / x0).log10()).round() / 2.0;
        if slope < 0.5 {
            continue;
        }
        // within the last piece of the line
        let along = |s: f64| (x0 * (x1 / x0).powf(s), y0 * (y1 / y0).powf(s));
        let ((left, on), (right, _)) = (along(0.25), along(0.85));
        let base = on * 10f64.powf(-AWAY * decades);
        let corners = [(left, base), (right, base), (right, base * (right / left).powf(slope))];
        let triangle = Triangle { corners, slope };
        match found.iter_mut().find(|(known, _)| known.slope == slope) {
            Some((known, lowest)) if y0 < *lowest => (*known, *lowest) = (triangle, y0),
            Some(_) => {}
            None => found.push((triangle, y0)),
        }
    }
    found.into_iter().map(|(triangle, _)| triangle).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_as_steep_as_the_nearest_half_number_and_stand_below_their_lines() {
        let line = |c: f64, q: f64| -> Vec<(f64, f64)> { (0..3).map(|k| 0.5_f64.powi(k)).map(|h| (h, c * h.powf(q))).collect() };
        let lines = [line(1.0, 2.93), line(0.1, 3.04), line(1.0, 1.45), line(1.0, -0.2), vec![(1.0, 1.0)]];
        let found = triangles(lines.iter().map(Vec::as_slice), 4.0);
        assert_eq!(found.iter().map(|t| t.slope).collect::<Vec<_>>(), [3.0, 1.5]);
        for t in &found {
            let [a, b, c] = t.corners;
            assert!(((c.1 / a.1).ln() / (c.0 / a.0).ln() - t.slope).abs() < 1e-12 && a.1 == b.1 && b.0 == c.0);
        }
        // of the two lines of order three the lower one has it
        assert!(found[0].corners[2].1 < 0.1 * found[0].corners[2].0.powf(3.04));
    }
}
