//! Patterns of matrices with places of their unknowns, made by rules that give the same numbers everywhere.
#![allow(dead_code)]

#[path = "delaunay.rs"]
mod delaunay;

use delaunay::{Congruence, quadratic};

/// Rows of the upper triangle, diagonal included, and a place per unknown.
pub struct Graph {
    pub ptr: Vec<usize>,
    pub cols: Vec<usize>,
    pub places: Vec<[f64; 3]>,
}

impl Graph {
    /// Edges in any order and number; `c` unknowns per vertex.
    fn of(places: &[[f64; 3]], edges: impl Iterator<Item = (usize, usize)>, c: usize) -> Self {
        let mut rows: Vec<Vec<usize>> = (0..places.len()).map(|v| vec![v]).collect();
        edges.for_each(|(a, b)| rows[a.min(b)].push(a.max(b)));
        let (mut ptr, mut cols) = (vec![0], Vec::new());
        for (v, row) in rows.iter_mut().enumerate() {
            row.sort_unstable();
            row.dedup();
            for k in 0..c {
                cols.extend(row.iter().flat_map(|&u| (0..c).map(move |l| c * u + l)).filter(|&j| j >= c * v + k));
                ptr.push(cols.len());
            }
        }
        Self { ptr, cols, places: places.iter().flat_map(|&x| std::iter::repeat_n(x, c)).collect() }
    }
}

/// Vertices of an n0 x n1 x n2 grid tied to all that are at most `p` away in every direction, as splines of degree p; `c` unknowns each.
fn grid(n: [usize; 3], p: usize, c: usize, at: impl Fn([f64; 3]) -> [f64; 3]) -> Graph {
    let id = |i: [usize; 3]| (i[2] * n[1] + i[1]) * n[0] + i[0];
    let all = || (0..n[2]).flat_map(move |k| (0..n[1]).flat_map(move |j| (0..n[0]).map(move |i| [i, j, k])));
    let part = |i: usize, n: usize| if n > 1 { i as f64 / (n - 1) as f64 } else { 0.0 };
    let places: Vec<[f64; 3]> = all().map(|i| at([part(i[0], n[0]), part(i[1], n[1]), part(i[2], n[2])])).collect();
    let near = |i: [usize; 3]| {
        let to = move |k: usize| i[k]..(i[k] + p + 1).min(n[k]);
        let from = move |k: usize| i[k].saturating_sub(p)..(i[k] + p + 1).min(n[k]);
        to(2).flat_map(move |z| from(1).flat_map(move |y| from(0).map(move |x| [x, y, z])))
    };
    Graph::of(&places, all().flat_map(|i| near(i).map(move |j| (id(i), id(j)))), c)
}

/// A quarter of the ring 1 < r < 2, lifted by z.
fn ring([r, a, z]: [f64; 3]) -> [f64; 3] {
    let angle = a * std::f64::consts::FRAC_PI_2;
    [(1.0 + r) * angle.cos(), (1.0 + r) * angle.sin(), z]
}

/// A coil of eight turns, each beside the one before.
fn coil([r, t, _]: [f64; 3]) -> [f64; 3] {
    let (angle, radius) = (16.0 * std::f64::consts::PI * t, 1.0 + 0.4 * r + 4.0 * t);
    [radius * angle.cos(), radius * angle.sin(), 0.0]
}

/// t from 0 to 1 in steps that grow by a factor of 1000 in all.
fn graded(t: f64) -> f64 {
    (1000f64.powf(t) - 1.0) / 999.0
}

/// Points of the unit square or cube by a linear congruence, tied within a distance.
fn scattered(count: usize, dimensions: usize, distance: f64) -> Graph {
    let mut numbers = Congruence::new();
    let places: Vec<[f64; 3]> = (0..count).map(|_| std::array::from_fn(|k| if k < dimensions { numbers.next() } else { 0.0 })).collect();
    let near = |a: usize, b: usize| (0..3).map(|k| (places[a][k] - places[b][k]).powi(2)).sum::<f64>() < distance * distance;
    let pairs: Vec<(usize, usize)> = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).filter(|&(a, b)| near(a, b)).collect();
    Graph::of(&places, pairs.into_iter(), 1)
}

/// Finite elements of degree 2 on a mesh without a grid of about `count` points, denser towards one corner by the square of the distance.
fn unstructured<const M: usize>(count: usize, c: usize) -> Graph {
    let mut numbers = Congruence::new();
    let at = |d: usize, x: f64| if d + 1 < M { x * x } else { 0.0 };
    let points = (0..count).map(|_| std::array::from_fn(|d| at(d, numbers.next()))).collect();
    let (places, pairs) = quadratic::<M>(points);
    Graph::of(&places, pairs.into_iter(), c)
}

/// Two square grids of n and 3n/2 cells, one above the other, and a row of multipliers at the slave's lowest nodes: each tied to its
/// neighbours on both sides, `c` unknowns per node and multiplier.
fn tied(n: usize, c: usize) -> Graph {
    let m = n + n / 2;
    let mut places = Vec::new();
    let mut edges = Vec::new();
    for (cells, base, shift) in [(n, 0usize, 0.0), (m, (n + 1) * (n + 1), -1.0)] {
        for j in 0..=cells {
            for i in 0..=cells {
                places.push([i as f64 / cells as f64, shift + j as f64 / cells as f64, 0.0]);
                let own = base + j * (cells + 1) + i;
                let beside = [(1, 0), (0, 1), (1, 1)].into_iter().filter(|(a, b)| i + a <= cells && j + b <= cells);
                edges.extend(beside.map(|(a, b)| (own, own + b * (cells + 1) + a)));
                if i > 0 && j < cells {
                    edges.push((own, own + cells));
                }
            }
        }
    }
    let first = places.len();
    for i in 0..=n {
        places.push(places[i]);
        let reach = |k: usize, cells: usize| (k as f64 / cells as f64 - i as f64 / n as f64).abs() < 1.5 / n as f64;
        edges.extend((0..=n).filter(|&k| reach(k, n)).map(|k| (k, first + i)));
        let top = (n + 1) * (n + 1) + m * (m + 1);
        edges.extend((0..=m).filter(|&k| reach(k, m)).map(|k| (top + k, first + i)));
    }
    Graph::of(&places, edges.into_iter(), c)
}

/// Square grids of n x n vertices of degree 1 in one plane, each shifted a little, without edges between them.
fn sheets(count: usize, n: usize) -> Graph {
    let id = |k: usize, i: usize, j: usize| (k * n + j) * n + i;
    let all = || (0..count).flat_map(move |k| (0..n).flat_map(move |j| (0..n).map(move |i| (k, i, j))));
    let shift = |k: usize| k as f64 / count as f64;
    let places: Vec<[f64; 3]> = all().map(|(k, i, j)| [i as f64 + shift(k), j as f64 + 0.5 * shift(k), 0.0]).collect();
    let near = |(k, i, j): (usize, usize, usize)| {
        let ahead = [(1, 0), (-1, 1), (0, 1), (1, 1)].into_iter().map(move |(a, b)| (i as isize + a, j + b));
        let inside = ahead.filter(move |&(a, b)| (0..n as isize).contains(&a) && b < n);
        inside.map(move |(a, b)| (id(k, i, j), id(k, a as usize, b)))
    };
    Graph::of(&places, all().flat_map(near), 1)
}

/// The bodies that orders are compared on.
pub fn graphs() -> Vec<(&'static str, Graph)> {
    let flat = |[x, y, _]: [f64; 3]| [x, y, 0.0];
    let turned = |[x, y, z]: [f64; 3]| [0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, z];
    vec![
        ("square, p = 1", grid([120, 120, 1], 1, 1, flat)),
        ("square, turned, p = 2", grid([90, 90, 1], 2, 1, turned)),
        ("square, graded to 1/1000, p = 2", grid([90, 90, 1], 2, 1, |[x, y, _]| [graded(x), graded(y), 0.0])),
        ("ring, p = 1, two components", grid([64, 96, 1], 1, 2, ring)),
        ("ring, p = 3", grid([90, 90, 1], 3, 1, ring)),
        ("ring, p = 5", grid([60, 90, 1], 5, 1, ring)),
        ("strip 1 : 100, p = 2", grid([600, 12, 1], 2, 1, |[x, y, _]| [100.0 * x, y, 0.0])),
        ("cube, p = 1", grid([18, 18, 18], 1, 1, |x| x)),
        ("cube, p = 2", grid([15, 15, 15], 2, 1, |x| x)),
        ("cube, graded to 1/1000, p = 1", grid([18, 18, 18], 1, 1, |x| x.map(graded))),
        ("thick ring, p = 2, three components", grid([10, 16, 10], 2, 3, ring)),
        ("plate 1 : 100, p = 1, three components", grid([40, 40, 3], 1, 3, |[x, y, z]| [100.0 * x, 100.0 * y, z])),
        ("shell 1 : 100, p = 2", grid([50, 50, 4], 2, 1, |[x, y, z]| ring([0.01 * z, x, 1.6 * y]))),
        ("ring of thin cells, p = 2", grid([3, 6000, 1], 2, 1, ring)),
        ("ring of thin cells, p = 3", grid([6, 3000, 1], 3, 1, ring)),
        ("thick ring of thin cells, p = 2", grid([3, 2000, 3], 2, 1, ring)),
        ("coil of thin cells, p = 2", grid([3, 6000, 1], 2, 1, coil)),
        ("three sheets in one place", sheets(3, 50)),
        ("points in the square", scattered(6000, 2, 0.03)),
        ("points in the cube", scattered(3000, 3, 0.12)),
        ("two tied squares with multipliers", tied(60, 2)),
        ("triangles, two components", unstructured::<3>(2500, 2)),
        ("tetrahedra", unstructured::<4>(1500, 1)),
    ]
}
