//! Further tables for matrices on a reference cell: products of functions, sums over the points, test for affine maps.

use super::points::PointTables;

/// Columns of an element matrix that are summed at once.
pub(super) const TILE: usize = 4;

/// K numbers per function and point, for sums of products: sum_q sum_kl B_ak(q) D_kl(q) B_bl(q).
#[derive(Debug)]
pub(super) struct Products<const K: usize> {
    /// B_ak(q) at `test[a * points + q]`.
    pub test: Vec<[f64; K]>,
    /// B_bl(q) of TILE functions b at once at `trial[tile * points + q]`, zero beyond the last function.
    pub trial: Vec<[[f64; TILE]; K]>,
    pub points: usize,
    pub functions: usize,
}

impl<const K: usize> Products<K> {
    fn new(functions: usize, points: usize, number: impl Fn(usize, usize, usize) -> f64) -> Self {
        let at = |a: usize, q: usize| std::array::from_fn(|k| number(a, q, k));
        let test = (0..functions).flat_map(|a| (0..points).map(move |q| at(a, q))).collect();
        let trial = (0..functions.div_ceil(TILE))
            .flat_map(|tile| (0..points).map(move |q| (tile, q)))
            .map(|(tile, q)| {
                std::array::from_fn(|k| {
                    std::array::from_fn(|t| {
                        let b = tile * TILE + t;
                        if b < functions { number(b, q, k) } else { 0.0 }
                    })
                })
            })
            .collect();
        Self { test, trial, points, functions }
    }

    /// Columns of an element matrix, padded to a multiple of TILE.
    pub fn padded(&self) -> usize {
        self.functions.next_multiple_of(TILE)
    }
}

/// Maximum number of map nodes for the test for affine maps.
const BENT_NODES: usize = 32;
/// Combinations of gradients shorter than this, relative to the largest component of a gradient, count as zero.
const NO_BEND: f64 = 1e-10;

/// An orthonormal basis of the differences grad M(q) - grad M(0), as rows over the `nodes` functions M; `None`
/// for more than [`BENT_NODES`] nodes or functions that do not sum to one.
fn bends<const N: usize>(grads: &[[f64; N]], nodes: usize) -> Option<Vec<f64>> {
    if nodes > BENT_NODES {
        return None;
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let longest = grads.iter().flatten().fold(0.0f64, |m, g| m.max(g.abs()));
    let (first, mut rows) = (grads.get(..nodes)?, Vec::new());
    for grads in grads.chunks_exact(nodes).skip(1) {
        for k in 0..N {
            let mut rest: Vec<f64> = grads.iter().zip(first).map(|(g, first)| g[k] - first[k]).collect();
            // twice, so that what is left is orthogonal to the last bits
            for _ in 0..2 {
                for row in rows.chunks_exact(nodes) {
                    let share = dot(&rest, row);
                    rest.iter_mut().zip(row).for_each(|(r, w)| *r -= share * w);
                }
            }
            let length = dot(&rest, &rest).sqrt();
            if length > NO_BEND * longest {
                rows.extend(rest.iter().map(|r| r / length));
            }
        }
    }
    // the functions do not sum to one: the test would depend on the origin
    let moves = rows.chunks_exact(nodes).any(|row| row.iter().sum::<f64>().abs() > NO_BEND);
    (!moves).then_some(rows)
}

/// The tables of a group.
#[derive(Debug)]
pub(super) struct Tables<const N: usize> {
    /// Tables of functions, map and rule on the reference cell.
    pub at: PointTables<N>,
    /// Values of the functions.
    pub values: Products<1>,
    /// Their gradients.
    pub grads: Products<N>,
    /// Combinations of the map's nodes that vanish if its Jacobian is the same at all points of the rule, `nodes` numbers of sum zero
    /// each; empty for maps of linear functions. `None` if they are not known.
    pub bends: Option<Vec<f64>>,
    /// sum_q w B_ak B_bl at `sums[a * functions + b][k][l]`: enough where D is constant.
    pub sums: Vec<[[f64; N]; N]>,
}

impl<const N: usize> From<PointTables<N>> for Tables<N> {
    fn from(at: PointTables<N>) -> Self {
        let (n, points) = (at.functions, at.weights.len());
        let grad = |a: usize, q: usize, k: usize| at.grads[q * n + a][k];
        let sum = |a: usize, b: usize, k: usize, l: usize| {
            at.weights.iter().enumerate().fold(0.0, |s, (q, &w)| s + w * grad(a, q, k) * grad(b, q, l))
        };
        Self {
            values: Products::new(n, points, |a, q, _| at.values[q * n + a]),
            grads: Products::new(n, points, grad),
            bends: bends(&at.map_grads, at.nodes),
            sums: (0..n * n).map(|ab| std::array::from_fn(|k| std::array::from_fn(|l| sum(ab / n, ab % n, k, l)))).collect(),
            at,
        }
    }
}
