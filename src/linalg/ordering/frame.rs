//! The directions of the grid that a set of vertices lies on.

use super::graph::Subgraph;

/// Number of sampled vertices: `SAMPLES` + n / `SHARE` of n.
const SAMPLES: usize = 8;
const SHARE: usize = 256;
/// Iterations; three orthogonal directions are met to a few degrees after as many.
const STEPS: usize = 6;
/// Tolerance within which a direction is snapped to an axis.
const SNAP: f64 = 1e-6;

/// Three orthogonal unit vectors along which short edges lie, and how well: the mean of sum_k (a_k . d)⁴ over unit edges d, one on a grid
/// without diagonals, 3/5 in space and 3/4 in the plane where edges have all directions.
///
/// a_k <- orthonormal rows of sum w (a_k . d)³ d, the fixed point of the largest sum of fourth powers. Weights fall like the fourth power
/// of the length, so diagonals count little.
pub(super) fn frame(piece: &Subgraph) -> Option<([[f64; 3]; 3], f64)> {
    let n = piece.ids.len();
    let step = n.div_ceil(SAMPLES + n / SHARE);
    let mut edges: Vec<([f64; 3], f64)> = Vec::new();
    let mut from = 0;
    for v in (0..n).step_by(step) {
        let mut least = f64::INFINITY;
        for &u in piece.neighbours(v) {
            let (a, b) = (piece.at[v], piece.at[u as usize]);
            let d = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
            let square = dot(&d, &d);
            if square > 0.0 {
                least = least.min(square);
                edges.push((d.map(|x| x / square.sqrt()), square));
            }
        }
        for (_, weight) in &mut edges[from..] {
            let w = least / *weight;
            *weight = w * w;
        }
        from = edges.len();
    }
    let first = edges.iter().max_by(|a, b| a.1.total_cmp(&b.1))?.0;
    let mut a = completed(first);
    let (mut sum, mut total) = (0.0, 0.0);
    for k in 0..=STEPS {
        let mut g = [[0.0; 3]; 3];
        (sum, total) = (0.0, 0.0);
        for (d, w) in &edges {
            total += w;
            for (row, a) in g.iter_mut().zip(&a) {
                let c = dot(a, d);
                let f = w * c * c * c;
                sum += f * c;
                for x in 0..3 {
                    row[x] += f * d[x];
                }
            }
        }
        if k < STEPS {
            a = orthonormal(g, &a);
        }
    }
    for row in &mut a {
        if let Some(k) = (0..3).find(|&k| 1.0 - row[k].abs() < SNAP) {
            *row = [0.0; 3];
            row[k] = 1.0;
        }
    }
    Some((a, sum / total))
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(&a, &a).sqrt();
    a.map(|x| x / length)
}

/// Two more directions at right angles, one of them in the plane of the first and the axis farthest from it.
fn completed(first: [f64; 3]) -> [[f64; 3]; 3] {
    let k = (0..3).rev().min_by(|&i, &j| first[i].abs().total_cmp(&first[j].abs())).expect("three axes");
    let mut axis = [0.0; 3];
    axis[k] = 1.0;
    let second = unit(cross(&axis, &first));
    [first, second, cross(&first, &second)]
}

/// Orthonormal rows near those of `g`, the longest first; those of `before` if `g` has rank zero.
fn orthonormal(g: [[f64; 3]; 3], before: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut rows = [0, 1, 2];
    rows.sort_by(|&i, &j| dot(&g[j], &g[j]).total_cmp(&dot(&g[i], &g[i])));
    let largest = dot(&g[rows[0]], &g[rows[0]]).sqrt();
    if largest == 0.0 {
        return *before;
    }
    let first = unit(g[rows[0]]);
    let along = dot(&first, &g[rows[1]]);
    let mut second = g[rows[1]];
    (0..3).for_each(|x| second[x] -= along * first[x]);
    if dot(&second, &second).sqrt() < 1e-9 * largest {
        return completed(first);
    }
    let second = unit(second);
    [first, second, cross(&first, &second)]
}
