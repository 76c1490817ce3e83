//! Two elastic blocks with a mortar between them, as matrices: what solvers of constrained systems are tried on.
#![allow(dead_code)]

use faying::constraint::{ConstrainedSolution, ConstrainedSystem, RowKind};
use faying::coupling::Rows;
use faying::linalg::{Csr, Operator, Triplets};

/// Two stacked elastic unit squares of bilinear cells, tied or in contact along y = 1 by a mortar with linear multipliers.
/// The lower one is clamped below, the upper one (slave) floats and is loaded on its top.
pub struct Blocks {
    pub stiffness: Csr,
    pub load: Vec<f64>,
    pub rows: Rows,
    pub offset: Vec<f64>,
    pub kind: Vec<RowKind>,
    /// Unknowns of the lower body come first.
    pub lower: usize,
}

impl Blocks {
    /// Cells per direction and Young's modulus of (lower, upper); plane strain, nu = 0.3. `components` of the interface that are tied.
    pub fn new(lower: (usize, f64), upper: (usize, f64), components: &[usize]) -> Self {
        let (nl, nu) = (lower.0, upper.0);
        let clamped = nl + 1; // nodes of the bottom row carry no unknowns
        let node_l = |i: usize, j: usize| j * (nl + 1) + i;
        let id_l = move |node: usize, c: usize| (node >= clamped).then(|| 2 * (node - clamped) + c);
        let count_l = 2 * ((nl + 1) * (nl + 1) - clamped);
        let node_u = |i: usize, j: usize| j * (nu + 1) + i;
        let count = count_l + 2 * (nu + 1) * (nu + 1);
        let mut k = Triplets::new(count, count);
        let mut places = vec![[0.0; 3]; count];
        for (cells, young, upper) in [(nl, lower.1, false), (nu, upper.1, true)] {
            let cell = q1_cell(young, 0.3);
            let id = |node: usize, c: usize| if upper { Some(count_l + 2 * node + c) } else { id_l(node, c) };
            let base = if upper { 1.0 } else { 0.0 };
            for j in 0..=cells {
                for i in 0..=cells {
                    for c in 0..2 {
                        if let Some(u) = id(j * (cells + 1) + i, c) {
                            places[u] = [i as f64 / cells as f64, base + j as f64 / cells as f64, 0.0];
                        }
                    }
                }
            }
            for j in 0..cells {
                for i in 0..cells {
                    let node = |a: usize| (j + a / 2) * (cells + 1) + i + a % 2;
                    for a in 0..8 {
                        for b in 0..8 {
                            if let (Some(p), Some(q)) = (id(node(a / 2), a % 2), id(node(b / 2), b % 2)) {
                                k.push(p, q, cell[a][b]);
                            }
                        }
                    }
                }
            }
        }
        let mut load = vec![0.0; count];
        for i in 0..=nu {
            let share = if i == 0 || i == nu { 0.5 } else { 1.0 } / nu as f64;
            load[count_l + 2 * node_u(i, nu)] = 1e-3 * share;
            load[count_l + 2 * node_u(i, nu) + 1] = -1e-2 * share * (1.0 + i as f64 / nu as f64);
        }
        // D = ∫ psi_j N_i, M = ∫ psi_j N_k on merged pieces; two Gauss points integrate products of linear functions
        let m = (nu + 1) * components.len();
        let (mut slave, mut master) = (Triplets::new(m, count), Triplets::new(m, count));
        let mut points: Vec<f64> = (0..=nl).map(|i| i as f64 / nl as f64).chain((0..=nu).map(|i| i as f64 / nu as f64)).collect();
        points.sort_by(f64::total_cmp);
        points.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
        for piece in points.windows(2) {
            for g in [-1.0, 1.0] {
                let x = 0.5 * (piece[0] + piece[1]) + 0.5 * (piece[1] - piece[0]) * g / 3f64.sqrt();
                let ds = 0.5 * (piece[1] - piece[0]);
                let hats = |cells: usize| {
                    let e = ((x * cells as f64) as usize).min(cells - 1);
                    let t = x * cells as f64 - e as f64;
                    [(e, 1.0 - t), (e + 1, t)]
                };
                for (r, &c) in components.iter().enumerate() {
                    for (j, psi) in hats(nu) {
                        for (i, v) in hats(nu) {
                            slave.push(r * (nu + 1) + j, count_l + 2 * node_u(i, 0) + c, psi * v * ds);
                        }
                        for (i, v) in hats(nl) {
                            if let Some(u) = id_l(node_l(i, nl), c) {
                                master.push(r * (nu + 1) + j, u, -psi * v * ds);
                            }
                        }
                    }
                }
            }
        }
        Self {
            stiffness: k.to_csr().with_dof_coordinates(places),
            load,
            rows: Rows { slave, master },
            offset: vec![0.0; m],
            kind: vec![RowKind::Equal; m],
            lower: count_l,
        }
    }

    pub fn system(&self) -> ConstrainedSystem<'_> {
        ConstrainedSystem {
            stiffness: &self.stiffness,
            load: &self.load,
            constraint: &self.rows,
            reaction: None,
            offset: &self.offset,
            kind: &self.kind,
            compliance: &[],
        }
    }

    /// [K Cᵀ; C 0] as one matrix, for LU.
    pub fn saddle(&self) -> Csr {
        let (n, m) = (self.load.len(), self.offset.len());
        let mut all = Triplets::new(n + m, n + m);
        for i in 0..n {
            let (cols, vals) = self.stiffness.row(i);
            cols.zip(vals).for_each(|(j, &v)| all.push(i, j, v));
        }
        for part in [&self.rows.slave, &self.rows.master] {
            for &(i, j, v) in &part.entries {
                all.push(n + i, j, v);
                all.push(j, n + i, v);
            }
        }
        all.to_csr()
    }
}

/// Stiffness of a square bilinear cell, plane strain, any size; corners (0,0) (1,0) (0,1) (1,1), components alternate.
fn q1_cell(young: f64, poisson: f64) -> [[f64; 8]; 8] {
    let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let mu = young / (2.0 * (1.0 + poisson));
    let mut k = [[0.0; 8]; 8];
    let g = 0.5 / 3f64.sqrt();
    for (x, y) in [(0.5 - g, 0.5 - g), (0.5 + g, 0.5 - g), (0.5 - g, 0.5 + g), (0.5 + g, 0.5 + g)] {
        let grad = [[y - 1.0, x - 1.0], [1.0 - y, -x], [-y, 1.0 - x], [y, x]];
        for a in 0..8 {
            for b in 0..8 {
                let (p, q) = (grad[a / 2], grad[b / 2]);
                let (i, j) = (a % 2, b % 2);
                let dot = if i == j { p[0] * q[0] + p[1] * q[1] } else { 0.0 };
                k[a][b] += 0.25 * (lambda * p[i] * q[j] + mu * p[j] * q[i] + mu * dot);
            }
        }
    }
    k
}

pub fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// Largest difference relative to the largest entry of `b`.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs())) / largest(b).max(f64::MIN_POSITIVE)
}

/// Differences of (lower body, upper body, multipliers), each relative to its own size.
pub fn differences(blocks: &Blocks, a: &ConstrainedSolution, b: &ConstrainedSolution) -> [f64; 3] {
    let k = blocks.lower;
    [
        difference(&a.unknowns[..k], &b.unknowns[..k]),
        difference(&a.unknowns[k..], &b.unknowns[k..]),
        difference(&a.multipliers, &b.multipliers),
    ]
}

/// Contact of the normal component, sliding held by a spring at one node of the upper body.
pub fn contact_blocks(lift: f64) -> Blocks {
    let mut blocks = Blocks::new((7, 1.0), (5, 1.0), &[1]);
    // rows give u_slave - u_master along y: the gap of a body above
    blocks.kind = vec![RowKind::Contact; blocks.offset.len()];
    let n = blocks.load.len();
    for i in (blocks.lower..n).step_by(2) {
        blocks.load[i] = 0.0;
        blocks.load[i + 1] += if i == n - 2 { lift } else { 0.0 };
    }
    let mut k = Triplets::new(n, n);
    for i in 0..n {
        let (cols, vals) = blocks.stiffness.row(i);
        cols.zip(vals).for_each(|(j, &v)| k.push(i, j, v));
    }
    k.push(blocks.lower, blocks.lower, 1.0);
    blocks.stiffness = k.to_csr().with_dof_coordinates(blocks.stiffness.dof_coordinates().to_vec());
    blocks
}
