//! The quasi-definite matrix that [`super::direct`] factorises.
//!
//!   [ K + Cᵀ W C   Cᵀ F       ]
//!   [ F C          -F s - e k ]
//!
//! Its upper triangle; the pattern holds all rows, so that it stays while rows open and close.

use super::scale::Scaled;
use crate::linalg::{Columns, Csr, Sparsity, Upper};
use std::sync::Arc;

/// e above: each tenfold smaller one makes the second correction ten times smaller; 1e-7 needs a third.
const REGULARISATION: f64 = 1e-8;

/// The pattern of the factorised matrix and what it was made of.
#[derive(Debug)]
pub(super) struct Layout {
    stiffness: Arc<Sparsity>,
    rows: Arc<Sparsity>,
    pattern: Arc<(Vec<usize>, Vec<usize>)>,
}

/// Upper triangle of the matrix at the file's head; the pattern holds all rows, enforced or not. `layout` is kept from matrix to matrix.
pub(super) fn assemble(layout: &mut Option<Layout>, s: &Scaled<'_>, w: &[f64], f: &[f64]) -> Upper {
    debug_assert!(s.reaction.is_none(), "columns are those of the constraint");
    let (n, m, columns) = (s.num_unknowns(), s.num_rows(), &s.columns);
    let known = layout.as_ref().is_some_and(|l| &l.stiffness == s.stiffness.pattern() && &l.rows == s.rows.pattern());
    if !known {
        *layout = Some(Layout {
            stiffness: s.stiffness.pattern().clone(),
            rows: s.rows.pattern().clone(),
            pattern: Arc::new(pattern(s.stiffness, &s.rows, columns)),
        });
    }
    let pattern = layout.as_ref().expect("made above").pattern.clone();
    let (ptr, cols) = &*pattern;
    let mut vals = vec![0.0; cols.len()];
    let mut place = vec![0usize; n + m];
    for i in 0..n {
        for k in ptr[i]..ptr[i + 1] {
            place[cols[k]] = k;
        }
        let (row, row_vals) = s.stiffness.row(i);
        for (j, &v) in row.zip(row_vals) {
            if j >= i {
                vals[place[j]] += v;
            }
        }
        let (touching, entries) = columns.row(i);
        for (a, &c) in touching.zip(entries) {
            if !s.enforced[a] {
                continue;
            }
            let (row, row_vals) = s.rows.row(a);
            for (j, &v) in row.zip(row_vals) {
                if j >= i {
                    vals[place[j]] += c * w[a] * v;
                }
            }
            vals[place[n + a]] += f[a] * c;
        }
    }
    for a in 0..m {
        vals[ptr[n + a]] = if s.enforced[a] { -f[a] * s.compliance[a] - REGULARISATION * s.k[a] } else { -s.k[a] };
    }
    Upper { pattern, vals }
}

/// Upper triangle of K + Cᵀ C beside Cᵀ, with a diagonal below.
fn pattern(stiffness: &Csr<f64>, rows: &Csr<f64>, columns: &Csr<f64>) -> (Vec<usize>, Vec<usize>) {
    let (n, m) = (stiffness.num_rows(), rows.num_rows());
    let (mut ptr, mut cols) = (vec![0usize], Vec::with_capacity(stiffness.num_entries() / 2 + n + 2 * rows.num_entries() + m));
    let mut seen = vec![usize::MAX; n];
    for i in 0..n {
        let first = cols.len();
        seen[i] = i;
        cols.push(i);
        let mut add = |row: Columns<'_>| {
            for j in row {
                if j > i && seen[j] != i {
                    seen[j] = i;
                    cols.push(j);
                }
            }
        };
        add(stiffness.row(i).0);
        let touching = columns.row(i).0;
        for a in touching {
            add(rows.row(a).0);
        }
        cols[first..].sort_unstable();
        cols.extend(touching.map(|a| n + a));
        ptr.push(cols.len());
    }
    for a in 0..m {
        cols.push(n + a);
        ptr.push(cols.len());
    }
    (ptr, cols)
}
