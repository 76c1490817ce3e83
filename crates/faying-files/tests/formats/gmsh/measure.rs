//! Measures of cells of any order: Gauss points on the polynomial through the nodes, by plain monomials.

use faying_files::{CellShape, MeshBlock, MeshFile};
use nalgebra::{DMatrix, Matrix3, Vector3};

/// Gauss points and weights on [0, 1].
fn gauss(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 0.0;
            for _ in 0..50 {
                let (mut p, mut q) = (1.0, x);
                for k in 2..=n {
                    (p, q) = (q, ((2 * k - 1) as f64 * x * q - (k - 1) as f64 * p) / k as f64);
                }
                slope = n as f64 * (x * q - p) / (x * x - 1.0);
                x -= q / slope;
            }
            (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Multi-indices with the first axis fastest, written down once more here.
pub fn lattice(shape: CellShape, p: usize) -> Vec<[usize; 3]> {
    let d = shape.dimension();
    let simplex = matches!(shape, CellShape::Triangle | CellShape::Tetrahedron);
    let n = |axis: usize| if axis < d { p + 1 } else { 1 };
    let all = (0..n(2)).flat_map(|k| (0..n(1)).flat_map(move |j| (0..n(0)).map(move |i| [i, j, k])));
    all.filter(|a| !simplex || a[0] + a[1] + a[2] <= p).collect()
}

/// Points in the unit cell with weights.
fn rule(shape: CellShape, n: usize) -> Vec<([f64; 3], f64)> {
    let g = gauss(n);
    let one = vec![(0.0, 1.0)];
    let axis = |k: usize| if k < shape.dimension() { &g } else { &one };
    let mut list = Vec::new();
    for z in axis(2) {
        for y in axis(1) {
            for x in axis(0) {
                let (w, a) = (x.1 * y.1 * z.1, [x.0, y.0, z.0]);
                list.push(match shape {
                    CellShape::Triangle => ([a[0], a[1] * (1.0 - a[0]), 0.0], w * (1.0 - a[0])),
                    CellShape::Tetrahedron => {
                        let (r, s) = (1.0 - a[0], 1.0 - a[1]);
                        ([a[0], a[1] * r, a[2] * r * s], w * r * r * s)
                    }
                    _ => (a, w),
                });
            }
        }
    }
    list
}

/// Measure of every cell and the least ratio of its Jacobian (signed where the cell fills its space, z = 0 in the plane) to the largest.
pub fn cells(mesh: &MeshFile, block: &MeshBlock) -> Vec<(f64, f64)> {
    let (d, p) = (block.shape.dimension(), block.order);
    let nodes = lattice(block.shape, p);
    let n = nodes.len();
    let power = |x: f64, k: usize| x.powi(k as i32);
    let at = |x: [f64; 3], a: [usize; 3]| (0..3).map(|k| power(x[k], a[k])).product::<f64>();
    let vandermonde = DMatrix::from_fn(n, n, |i, j| at(nodes[i].map(|k| k as f64 / p as f64), nodes[j]));
    let inverse = vandermonde.try_inverse().expect("equispaced nodes determine the polynomial");
    let rule = rule(block.shape, p + 3);
    // values of d N_i / d xi_k at the points
    let slopes: Vec<DMatrix<f64>> = (0..d)
        .map(|k| {
            let monomials = DMatrix::from_fn(rule.len(), n, |q, j| {
                let mut a = nodes[j];
                if a[k] == 0 {
                    return 0.0;
                }
                a[k] -= 1;
                (a[k] + 1) as f64 * at(rule[q].0, a)
            });
            monomials * &inverse
        })
        .collect();
    block
        .nodes
        .chunks_exact(n)
        .map(|own| {
            let x = DMatrix::from_fn(n, 3, |i, k| mesh.points[own[i] as usize][k]);
            let columns: Vec<DMatrix<f64>> = slopes.iter().map(|s| s * &x).collect();
            let jacobians: Vec<f64> = (0..rule.len())
                .map(|q| {
                    let v: Vec<Vector3<f64>> = columns.iter().map(|c| Vector3::new(c[(q, 0)], c[(q, 1)], c[(q, 2)])).collect();
                    match d {
                        1 => v[0].norm(),
                        2 if mesh.dimension() == 2 && mesh.points.iter().all(|x| x[2].abs() < 1e-12) => v[0].cross(&v[1])[2],
                        2 => v[0].cross(&v[1]).norm(),
                        _ => Matrix3::from_columns(&v).determinant(),
                    }
                })
                .collect();
            let measure = jacobians.iter().zip(&rule).map(|(j, r)| j * r.1).sum();
            let most = jacobians.iter().fold(0.0f64, |m, j| m.max(j.abs()));
            (measure, jacobians.iter().copied().fold(f64::INFINITY, f64::min) / most)
        })
        .collect()
}

/// Measure of all cells of a dimension, or of those in the group with that label.
pub fn measure(mesh: &MeshFile, dimension: usize, group: Option<&str>) -> f64 {
    let inside = |b: &&MeshBlock| group.is_none_or(|name| b.groups.iter().any(|g| mesh.groups[*g].label() == name));
    mesh.blocks.iter().filter(|b| b.shape.dimension() == dimension).filter(inside).flat_map(|b| cells(mesh, b)).map(|c| c.0.abs()).sum()
}

/// Least Jacobian ratio over all cells of a dimension.
pub fn least(mesh: &MeshFile, dimension: usize) -> f64 {
    let own = mesh.blocks.iter().filter(|b| b.shape.dimension() == dimension);
    own.flat_map(|b| cells(mesh, b)).map(|c| c.1).fold(f64::INFINITY, f64::min)
}
