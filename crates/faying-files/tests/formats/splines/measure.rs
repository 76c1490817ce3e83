//! Measures of patches and cells by formulas of their own: Cox-de Boor and Lagrange in the plain, tensor Gauss points.

use faying_files::{CellShape, MeshBlock, MeshFile, SplinePatch};

/// Gauss points on [0, 1] by Newton's method.
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    let legendre = |x: f64| {
        let (mut a, mut b) = (1.0, x);
        for k in 2..=n {
            (a, b) = (b, ((2 * k - 1) as f64 * x * b - (k - 1) as f64 * a) / k as f64);
        }
        (b, n as f64 * (x * b - a) / (x * x - 1.0))
    };
    let point = |i: usize| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..50 {
            let (p, d) = legendre(x);
            x -= p / d;
        }
        let (_, d) = legendre(x);
        (0.5 - 0.5 * x, 1.0 / ((1.0 - x * x) * d * d))
    };
    (0..n).map(point).collect()
}

/// Values and slopes of the B-splines at t.
fn splines(p: usize, knots: &[f64], t: f64) -> Vec<(f64, f64)> {
    let last = knots[knots.len() - 1];
    let inside = |i: usize| knots[i] <= t && (t < knots[i + 1] || (t == last && knots[i] < last && knots[i + 1] == last));
    let mut values: Vec<f64> = (0..knots.len() - 1).map(|i| f64::from(u8::from(inside(i)))).collect();
    let over = |a: f64, b: f64| if b == 0.0 { 0.0 } else { a / b };
    let mut below = values.clone();
    for q in 1..=p {
        below = values;
        let n = knots.len() - 1 - q;
        values = (0..n)
            .map(|i| {
                over(t - knots[i], knots[i + q] - knots[i]) * below[i]
                    + over(knots[i + q + 1] - t, knots[i + q + 1] - knots[i + 1]) * below[i + 1]
            })
            .collect();
    }
    let f = p as f64;
    let slope = |i: usize| over(f, knots[i + p] - knots[i]) * below[i] - over(f, knots[i + p + 1] - knots[i + 1]) * below[i + 1];
    (0..values.len()).map(|i| (values[i], if p == 0 { 0.0 } else { slope(i) })).collect()
}

/// Point and tangents of a patch.
pub fn at(patch: &SplinePatch, t: &[f64]) -> ([f64; 3], Vec<[f64; 3]>) {
    let d = patch.degree.len();
    let lines: Vec<Vec<(f64, f64)>> = (0..d).map(|k| splines(patch.degree[k], &patch.knots[k], t[k])).collect();
    let mut sums = vec![[0.0; 4]; d + 1];
    for (i, point) in patch.points.iter().enumerate() {
        let w = patch.weights.as_ref().map_or(1.0, |w| w[i]);
        for (which, sum) in sums.iter_mut().enumerate() {
            let mut rest = i;
            let mut value = w;
            for (k, line) in lines.iter().enumerate() {
                let (v, s) = line[rest % line.len()];
                value *= if which == k + 1 { s } else { v };
                rest /= line.len();
            }
            for k in 0..3 {
                sum[k] += value * point[k];
            }
            sum[3] += value;
        }
    }
    let x: [f64; 3] = std::array::from_fn(|k| sums[0][k] / sums[0][3]);
    let tangent = |s: &[f64; 4]| std::array::from_fn(|k| (s[k] - x[k] * s[3]) / sums[0][3]);
    (x, sums[1..].iter().map(tangent).collect())
}

fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Length, area or volume element with its sign where there is one.
fn element(tangents: &[[f64; 3]]) -> f64 {
    let norm = |a: [f64; 3]| a.iter().map(|x| x * x).sum::<f64>().sqrt();
    match tangents {
        [a] => norm(*a),
        // in a plane of constant z, up to rounding
        [a, b] if a[2].abs() < 1e-12 && b[2].abs() < 1e-12 => cross(a, b)[2],
        [a, b] => norm(cross(a, b)),
        [a, b, c] => cross(a, b).iter().zip(c).map(|(x, y)| x * y).sum(),
        _ => unreachable!("one to three tangents"),
    }
}

fn product(lines: &[Vec<(f64, f64)>], mut visit: impl FnMut(&[f64], f64)) {
    let total: usize = lines.iter().map(Vec::len).product();
    for i in 0..total {
        let mut rest = i;
        let mut weight = 1.0;
        let mut point = Vec::new();
        for line in lines {
            let (x, w) = line[rest % line.len()];
            rest /= line.len();
            weight *= w;
            point.push(x);
        }
        visit(&point, weight);
    }
}

/// The measure of a patch; the map keeps its orientation at all points.
pub fn patch_measure(patch: &SplinePatch, points: usize) -> f64 {
    let rule = gauss(points);
    let line = |knots: &Vec<f64>| {
        let spans = knots.windows(2).filter(|w| w[0] < w[1]);
        spans.flat_map(|w| rule.iter().map(move |(x, g)| (w[0] + (w[1] - w[0]) * x, g * (w[1] - w[0])))).collect()
    };
    let lines: Vec<Vec<(f64, f64)>> = patch.knots.iter().map(line).collect();
    let (mut sum, mut absolute) = (0.0, 0.0);
    product(&lines, |t, w| {
        let e = element(&at(patch, t).1);
        sum += w * e;
        absolute += w * e.abs();
    });
    assert!((sum.abs() - absolute).abs() <= 1e-13 * absolute, "a patch folds over: {sum} of {absolute}");
    absolute
}

/// prod_(q < m) (z - q) / (m - q) with its slope.
fn factor(m: usize, z: f64) -> (f64, f64) {
    (0..m).fold((1.0, 0.0), |(v, s), q| {
        let f = (z - q as f64) / (m - q) as f64;
        (v * f, s * f + v / (m - q) as f64)
    })
}

/// The measure of the cells of a block; the maps keep their orientation.
pub fn block_measure(mesh: &MeshFile, block: &MeshBlock) -> f64 {
    let d = block.shape.dimension();
    let p = block.order;
    let simplex = matches!(block.shape, CellShape::Triangle | CellShape::Tetrahedron);
    let mut lattice = Vec::new();
    product(&vec![(0..=p).map(|i| (i as f64, 1.0)).collect(); d], |i, _| {
        if !simplex || i.iter().sum::<f64>() <= p as f64 {
            lattice.push(i.iter().map(|x| *x as usize).collect::<Vec<_>>());
        }
    });
    let mut rule = Vec::new();
    product(&vec![gauss(8); d], |t, w| {
        let mut x = t.to_vec();
        let mut weight = w;
        if simplex {
            // (a, b (1 - a), c (1 - a)(1 - b))
            let mut left = 1.0;
            for k in 0..d {
                x[k] = left * t[k];
                weight *= left;
                left -= x[k];
            }
        }
        rule.push((x, weight));
    });
    let slope = |i: &[usize], x: &[f64], axis: usize| -> f64 {
        let z = |v: f64| v * p as f64;
        if simplex {
            let first = p - i.iter().sum::<usize>();
            let (v0, s0) = factor(first, z(1.0 - x.iter().sum::<f64>()));
            let others: Vec<(f64, f64)> = i.iter().zip(x).map(|(m, x)| factor(*m, z(*x))).collect();
            let all: f64 = others.iter().map(|o| o.0).product();
            let mine = others.iter().enumerate().map(|(k, o)| if k == axis { o.1 } else { o.0 }).product::<f64>();
            return p as f64 * (v0 * mine - s0 * all);
        }
        let line = |m: usize, x: f64| {
            (0..=p).filter(|q| *q != m).fold((1.0, 0.0), |(v, s), q| {
                let scale = m as f64 - q as f64;
                let f = (z(x) - q as f64) / scale;
                (v * f, s * f + v / scale)
            })
        };
        p as f64 * i.iter().zip(x).enumerate().map(|(k, (m, x))| if k == axis { line(*m, *x).1 } else { line(*m, *x).0 }).product::<f64>()
    };
    let slopes: Vec<Vec<Vec<f64>>> =
        rule.iter().map(|(x, _)| (0..d).map(|a| lattice.iter().map(|i| slope(i, x, a)).collect()).collect()).collect();
    let mut total = 0.0;
    for nodes in block.nodes.chunks_exact(lattice.len()) {
        let (mut sum, mut absolute) = (0.0f64, 0.0f64);
        for ((_, w), slopes) in rule.iter().zip(&slopes) {
            let tangent = |of: &Vec<f64>| std::array::from_fn(|k| nodes.iter().zip(of).map(|(n, s)| s * mesh.points[*n as usize][k]).sum());
            let e = element(&slopes.iter().map(tangent).collect::<Vec<[f64; 3]>>());
            sum += w * e;
            absolute += w * e.abs();
        }
        assert!((sum.abs() - absolute).abs() <= 1e-12 * absolute, "a cell folds over: {sum} of {absolute}");
        total += absolute;
    }
    total
}

/// The measure of the cells of the highest dimension, or of one less.
pub fn mesh_measure(mesh: &MeshFile, below: usize) -> f64 {
    let d = mesh.dimension() - below;
    mesh.blocks.iter().filter(|b| b.shape.dimension() == d).map(|b| block_measure(mesh, b)).sum()
}
