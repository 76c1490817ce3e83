//! Rings under pressure in plane strain, after Lame: u = (1 + nu)/E ((1 - 2 nu) A r - B / r), sigma_r = A + B / r^2.

/// A ring of one material.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    pub radius: [f64; 2],
    pub young: f64,
    pub poisson: f64,
}

impl Ring {
    /// Radial displacement at `r` under the pressures `p` inside and outside.
    pub fn displacement(&self, p: [f64; 2], r: f64) -> f64 {
        let [a, b] = self.radius.map(|r| r * r);
        let mean = (p[0] * a - p[1] * b) / (b - a);
        let rest = (p[1] - p[0]) * a * b / (b - a);
        (1.0 + self.poisson) / self.young * ((1.0 - 2.0 * self.poisson) * mean * r - rest / r)
    }
}

/// Pressures between rings that fit into one another, with `more` the interference of each pair and the pressures at bore and outside.
///
/// Continuity at every joint, u_outer - u_inner = more, is a tridiagonal system; Gauss elimination without pivoting serves,
/// its matrix is diagonally dominant.
pub fn joints(rings: &[Ring], more: &[f64], ends: [f64; 2]) -> Vec<f64> {
    let n = rings.len() - 1;
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for k in 0..n {
        let r = rings[k].radius[1];
        let (inner, outer) = (rings[k], rings[k + 1]);
        // joint k sees p[k - 1], p[k], p[k + 1]
        let mut row = vec![0.0; n + 1];
        row[k] = outer.displacement([1.0, 0.0], r) - inner.displacement([0.0, 1.0], r);
        let (before, after) = (-inner.displacement([1.0, 0.0], r), outer.displacement([0.0, 1.0], r));
        row[n] = more[k];
        if k > 0 {
            row[k - 1] = before
        } else {
            row[n] -= before * ends[0]
        }
        if k + 1 < n {
            row[k + 1] = after
        } else {
            row[n] -= after * ends[1]
        }
        rows.push(row);
    }
    for k in 0..n {
        for j in k + 1..n {
            let factor = rows[j][k] / rows[k][k];
            for c in k..=n {
                let above = rows[k][c];
                rows[j][c] -= factor * above;
            }
        }
    }
    let mut p = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|c| rows[k][c] * p[c]).sum();
        p[k] = (rows[k][n] - known) / rows[k][k];
    }
    p
}
