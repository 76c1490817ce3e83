//! Meshes of triangles and tetrahedra without any grid: Delaunay's, of points by a linear congruence.

use std::collections::BTreeMap;

/// Numbers in 0..1, the same everywhere.
pub struct Congruence(u64);

impl Congruence {
    pub fn new() -> Self {
        Self(1)
    }

    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A simplex of M = d + 1 points with its circumscribed sphere: centre and squared radius.
struct Simplex<const M: usize> {
    vertices: [usize; M],
    centre: [f64; 3],
    square: f64,
}

impl<const M: usize> Simplex<M> {
    fn of(vertices: [usize; M], at: &[[f64; 3]]) -> Self {
        let first = at[vertices[0]];
        // 2 d_i . x = d_i . d_i for the edges d_i from the first vertex; in the plane z = 0 is the third line
        let mut rows = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let mut right = [0.0; 3];
        for i in 1..M {
            let d: [f64; 3] = std::array::from_fn(|k| at[vertices[i]][k] - first[k]);
            rows[i - 1] = d.map(|x| 2.0 * x);
            right[i - 1] = d.iter().map(|x| x * x).sum();
        }
        let whole = determinant(&rows);
        let from_first: [f64; 3] = std::array::from_fn(|k| {
            let mut with = rows;
            (0..3).for_each(|i| with[i][k] = right[i]);
            determinant(&with) / whole
        });
        Self { vertices, centre: std::array::from_fn(|k| first[k] + from_first[k]), square: from_first.iter().map(|x| x * x).sum() }
    }

    fn holds(&self, x: &[f64; 3]) -> bool {
        (0..3).map(|k| (x[k] - self.centre[k]).powi(2)).sum::<f64>() < self.square
    }
}

fn determinant(a: &[[f64; 3]; 3]) -> f64 {
    let minor = |i: usize, j: usize| a[1][i] * a[2][j] - a[1][j] * a[2][i];
    a[0][0] * minor(1, 2) - a[0][1] * minor(0, 2) + a[0][2] * minor(0, 1)
}

/// Delaunay's simplices of points of the unit square (M = 3) or cube (M = 4) in general position, one point after the other.
///
/// Source: Bowyer, Comput. J. 24 (1981) 162-166; Watson, ibid. 167-172.
pub fn delaunay<const M: usize>(points: &[[f64; 3]]) -> Vec<[usize; M]> {
    let n = points.len();
    // one simplex around all
    let mut at = points.to_vec();
    at.push([-50.0, -50.0, if M == 4 { -50.0 } else { 0.0 }]);
    (0..M - 1).for_each(|d| at.push(std::array::from_fn(|k| at[n][k] + if k == d { 300.0 } else { 0.0 })));
    let mut simplices = vec![Simplex::<M>::of(std::array::from_fn(|i| n + i), &at)];
    for p in 0..n {
        // faces of those that hold the point: once on the rim of the hole, twice inside
        let mut faces: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
        simplices.retain(|s| {
            let hit = s.holds(&at[p]);
            for without in (0..M).filter(|_| hit) {
                let mut face: Vec<usize> = (0..M).filter(|&i| i != without).map(|i| s.vertices[i]).collect();
                face.sort_unstable();
                *faces.entry(face).or_default() += 1;
            }
            !hit
        });
        for (face, _) in faces.iter().filter(|f| *f.1 == 1) {
            simplices.push(Simplex::of(std::array::from_fn(|i| if i + 1 < M { face[i] } else { p }), &at));
        }
    }
    simplices.into_iter().map(|s| s.vertices).filter(|v| v.iter().all(|&i| i < n)).collect()
}

/// Nodes of degree 2, corners and middles of edges, of the simplices around `points`; pairs of nodes of one simplex.
pub fn quadratic<const M: usize>(mut points: Vec<[f64; 3]>) -> (Vec<[f64; 3]>, Vec<(usize, usize)>) {
    let mut middles: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let mut pairs = Vec::new();
    for simplex in delaunay::<M>(&points) {
        let mut nodes = simplex.to_vec();
        for (i, &a) in simplex.iter().enumerate() {
            for &b in &simplex[i + 1..] {
                nodes.push(*middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    points.push(std::array::from_fn(|k| 0.5 * (points[a][k] + points[b][k])));
                    points.len() - 1
                }));
            }
        }
        pairs.extend(nodes.iter().flat_map(|&a| nodes.iter().filter(move |&&b| a < b).map(move |&b| (a, b))));
    }
    (points, pairs)
}
