//! Breakpoints of a direction of a patch: counts, explicit lists, grading, halving.

/// Elements of a direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Divisions {
    /// Their number, rounded up to a multiple of the geometry's spans.
    Total(usize),
    /// Their number per span of the geometry.
    PerSpan(usize),
    /// Increasing breakpoints, the ends of the direction included; the geometry's own are added.
    Breakpoints(Vec<f64>),
}

impl Divisions {
    /// Number of elements of a direction with this many spans of the geometry, each halved `refine` times; for a list an upper bound.
    ///
    /// A floating-point number, because repeated halving exceeds the range of integers.
    ///
    /// # Panics
    /// If there is no span.
    pub fn at_most(&self, spans: usize, refine: usize) -> f64 {
        let elements = match self {
            Self::Total(n) => n.div_ceil(spans) as f64 * spans as f64,
            Self::PerSpan(n) => *n as f64 * spans as f64,
            Self::Breakpoints(list) => (list.len().saturating_sub(1) + spans - 1) as f64,
        };
        elements * f64::exp2(refine as f64)
    }
}

/// Sizes of elements that grow geometrically away from a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grading {
    /// The place, 0..1 of the direction.
    pub toward: f64,
    /// Size of the first element there over the uniform size, 0..1.
    pub ratio: f64,
}

/// Error of a list of breakpoints that does not span its direction.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the breakpoints go from {} to {}, the direction from {} to {}", .list[0], .list[1], .direction[0], .direction[1])]
pub struct DivisionError {
    /// Ends of the list.
    pub list: [f64; 2],
    /// Ends of the direction.
    pub direction: [f64; 2],
}

/// Points closer than this fraction of the direction's length coincide.
const SAME: f64 = 1e-10;

/// Breakpoints of a direction whose geometry has the breakpoints `own`, its ends included; every element is halved `refine` times.
///
/// The geometry's own breakpoints are always among the result, because the map is only smooth between them.
///
/// # Errors
/// [`DivisionError`] where a list does not span the direction.
pub fn divided(own: &[f64], divisions: &Divisions, grading: Option<Grading>, refine: usize) -> Result<Vec<f64>, DivisionError> {
    let (first, last) = (own[0], own[own.len() - 1]);
    let length = last - first;
    let mut points = match divisions {
        Divisions::Total(n) => of_spans(own, n.div_ceil(own.len() - 1), grading),
        Divisions::PerSpan(n) => of_spans(own, *n, grading),
        Divisions::Breakpoints(list) => {
            let (a, b) = (list.first().copied().unwrap_or(first), list.last().copied().unwrap_or(last));
            if (a - first).abs() > SAME * length || (b - last).abs() > SAME * length {
                return Err(DivisionError { list: [a, b], direction: [first, last] });
            }
            let mut all: Vec<f64> = list[1..list.len() - 1].to_vec();
            all.extend_from_slice(&own[1..own.len() - 1]);
            all.sort_by(f64::total_cmp);
            let mut points = vec![first];
            for t in all {
                // the geometry's own value is used instead of a rounded copy of it
                let exact = own.iter().copied().find(|&o| (o - t).abs() <= SAME * length).unwrap_or(t);
                if exact - points[points.len() - 1] > SAME * length {
                    points.push(exact);
                }
            }
            points.push(last);
            points
        }
    };
    for _ in 0..refine {
        points = halved(&points);
    }
    Ok(points)
}

/// Elements of a number per span, graded as a whole.
fn of_spans(own: &[f64], per_span: usize, grading: Option<Grading>) -> Vec<f64> {
    match grading {
        None => uniform(own, per_span),
        Some(g) => graded(own, per_span * (own.len() - 1), g.toward, g.ratio),
    }
}

fn uniform(own: &[f64], per_piece: usize) -> Vec<f64> {
    let mut points = vec![own[0]];
    for piece in own.windows(2) {
        for k in 1..per_piece {
            points.push(piece[0] + (piece[1] - piece[0]) * k as f64 / per_piece as f64);
        }
        points.push(piece[1]);
    }
    points
}

fn halved(points: &[f64]) -> Vec<f64> {
    let mut out = Vec::with_capacity(2 * points.len());
    for pair in points.windows(2) {
        out.push(pair[0]);
        out.push(0.5 * (pair[0] + pair[1]));
    }
    out.push(points[points.len() - 1]);
    out
}

/// `count` elements whose sizes grow geometrically away from `at` (0..1 of the direction); the first has `ratio` of the
/// uniform size. The points nearest to the geometry's own breakpoints are moved there.
fn graded(own: &[f64], count: usize, at: f64, ratio: f64) -> Vec<f64> {
    let (first, last) = (own[0], own[own.len() - 1]);
    let length = last - first;
    let at = at.clamp(0.0, 1.0);
    let left = if at <= SAME {
        0
    } else if at >= 1.0 - SAME {
        count
    } else {
        ((count as f64 * at).round() as usize).clamp(1, count.max(2) - 1)
    };
    let smallest = ratio / count as f64;
    let mut unit: Vec<f64> = growing(left, at, smallest).into_iter().rev().map(|d| at - d).collect();
    unit.push(at);
    unit.extend(growing(count.max(left) - left, 1.0 - at, smallest).into_iter().map(|d| at + d));
    let mut points: Vec<f64> = unit.into_iter().map(|t| first + length * t).collect();
    let n = points.len();
    (points[0], points[n - 1]) = (first, last);
    let mut taken = vec![false; n];
    for &knot in &own[1..own.len() - 1] {
        let free = (1..n - 1).filter(|&k| !taken[k]);
        if let Some(k) = free.min_by(|&a, &b| (points[a] - knot).abs().total_cmp(&(points[b] - knot).abs())) {
            points[k] = knot;
            taken[k] = true;
        }
    }
    points.sort_by(f64::total_cmp);
    points
}

/// Distances 0 < d_1 < ... < d_n = length whose differences grow geometrically from `smallest`; uniform if they would have to shrink.
fn growing(n: usize, length: f64, smallest: f64) -> Vec<f64> {
    if n == 0 {
        return Vec::new();
    }
    let sum = |q: f64| (0..n).fold((0.0, smallest), |(s, h), _| (s + h, h * q)).0;
    if sum(1.0) >= length {
        return (1..=n).map(|k| length * k as f64 / n as f64).collect();
    }
    // sum(q) grows with q: bisection between 1 and a factor that is too large
    let (mut low, mut high) = (1.0, 2.0);
    while sum(high) < length {
        high *= 2.0;
        if n == 1 {
            break;
        }
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if sum(middle) < length { low = middle } else { high = middle }
    }
    let q = 0.5 * (low + high);
    let total = sum(q);
    let (mut out, mut s, mut h) = (Vec::with_capacity(n), 0.0, smallest);
    for _ in 0..n {
        s += h;
        h *= q;
        out.push(length * s / total);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(own: &[f64], n: usize, toward: Option<f64>, ratio: f64) -> Vec<f64> {
        divided(own, &Divisions::Total(n), toward.map(|toward| Grading { toward, ratio }), 0).unwrap()
    }

    #[test]
    fn counts_are_rounded_up_to_the_pieces_of_the_geometry() {
        assert_eq!(of(&[0.0, 0.5, 1.0], 3, None, 1.0), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(divided(&[0.0, 1.0], &Divisions::PerSpan(1), None, 2).unwrap(), [0.0, 0.25, 0.5, 0.75, 1.0]);
    }

    #[test]
    fn graded_sizes_start_with_the_ratio_and_grow_geometrically() {
        let points = of(&[0.0, 1.0], 10, Some(0.0), 0.1);
        let sizes: Vec<f64> = points.windows(2).map(|p| p[1] - p[0]).collect();
        assert!((sizes[0] - 0.01).abs() < 1e-12, "{sizes:?}");
        let q = sizes[1] / sizes[0];
        assert!(q > 1.0 && sizes.windows(2).all(|s| (s[1] / s[0] - q).abs() < 1e-9), "{sizes:?}");
        assert_eq!(points[10], 1.0);
    }

    #[test]
    fn grading_toward_the_middle_is_symmetric_and_keeps_the_knots() {
        let points = of(&[0.0, 0.5, 1.0], 8, Some(0.5), 0.2);
        assert_eq!(points.len(), 9);
        assert_eq!(points[4], 0.5);
        for k in 0..9 {
            assert!((points[k] + points[8 - k] - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_list_keeps_the_knots_of_the_geometry() {
        let list = Divisions::Breakpoints(vec![0.0, 0.2, 1.0]);
        assert_eq!(divided(&[0.0, 0.5, 1.0], &list, None, 0).unwrap(), [0.0, 0.2, 0.5, 1.0]);
        let short = Divisions::Breakpoints(vec![0.0, 0.9]);
        assert!(divided(&[0.0, 1.0], &short, None, 0).is_err());
    }
}
