//! The quasi-definite matrix that [`super::direct`] factorises.
//!
//! ```text
//! [ K + Cᵀ W C   Cᵀ F       ]
//! [ F C          -F s - e k ]
//! ```
//!
//! Its upper triangle; the pattern holds all rows, so that it stays while rows open and close. Rows may be springs alone: they have their
//! part in Cᵀ W C and no multiplier.

use super::scale::Scaled;
use crate::linalg::{Columns, Csr, Sparsity, Upper};
use std::sync::Arc;

/// e above: each tenfold smaller one makes the second correction ten times smaller; 1e-7 needs a third.
pub(super) const REGULARISATION: f64 = 1e-8;

/// The pattern of the factorised matrix and what it was made of.
#[derive(Debug)]
pub(super) struct LdltPattern {
    stiffness: Arc<Sparsity>,
    rows: Arc<Sparsity>,
    /// Rows that are springs alone, ascending; the others have a multiplier.
    springs: Vec<usize>,
    /// Number of each row's multiplier; `None` for springs.
    number: Vec<Option<usize>>,
    pattern: Arc<(Vec<usize>, Vec<usize>)>,
}

impl LdltPattern {
    /// Layout of `s` with the rows `springs` as springs alone; `layout` is reused if it matches.
    pub fn of<'a>(layout: &'a mut Option<Self>, s: &Scaled<'_>, springs: &[usize]) -> &'a Self {
        debug_assert!(s.reaction.is_none(), "columns are those of the constraint");
        let same = |l: &Self| &l.stiffness == s.stiffness.pattern() && &l.rows == s.rows.pattern() && l.springs == springs;
        if !layout.as_ref().is_some_and(same) {
            let mut number: Vec<Option<usize>> = vec![Some(0); s.num_rows()];
            springs.iter().for_each(|&a| number[a] = None);
            number.iter_mut().flatten().zip(0..).for_each(|(number, k)| *number = k);
            let pattern = Arc::new(pattern(s.stiffness, &s.rows, &s.columns, &number));
            let (stiffness, rows) = (s.stiffness.pattern().clone(), s.rows.pattern().clone());
            *layout = Some(Self { stiffness, rows, springs: springs.to_vec(), number, pattern });
        }
        layout.as_ref().expect("made above")
    }

    /// Number of multipliers.
    pub fn multipliers(&self) -> usize {
        self.number.len() - self.springs.len()
    }

    /// Rows that have a multiplier, and its number.
    pub fn numbers(&self) -> impl Iterator<Item = (usize, usize)> {
        self.number.iter().enumerate().filter_map(|(a, number)| number.map(|number| (a, number)))
    }

    /// Coordinates of unknowns, then multipliers; empty if the unknowns have none.
    pub fn places(&self, s: &Scaled<'_>, unknowns: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut all = s.all_places(unknowns);
        if !all.is_empty() && !self.springs.is_empty() {
            all.truncate(unknowns.len());
            all.extend(self.numbers().map(|(a, _)| s.places[a]));
        }
        all
    }

    /// Upper triangle of the matrix of the module docs; rows that are springs have W alone, whether they are enforced or not.
    pub fn assemble(&self, s: &Scaled<'_>, w: &[f64], f: &[f64]) -> Upper {
        let (n, columns) = (s.num_unknowns(), &s.columns);
        let (ptr, cols) = &*self.pattern;
        let mut vals = vec![0.0; cols.len()];
        let mut place = vec![0usize; ptr.len() - 1];
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
                let number = self.number[a];
                if number.is_some() && !s.enforced[a] {
                    continue;
                }
                let (row, row_vals) = s.rows.row(a);
                for (j, &v) in row.zip(row_vals) {
                    if j >= i {
                        vals[place[j]] += c * w[a] * v;
                    }
                }
                if let Some(number) = number {
                    vals[place[n + number]] += f[a] * c;
                }
            }
        }
        for (a, number) in self.numbers() {
            vals[ptr[n + number]] = if s.enforced[a] { -f[a] * s.compliance[a] - REGULARISATION * s.k[a] } else { -s.k[a] };
        }
        Upper { pattern: self.pattern.clone(), vals }
    }

    /// The upper triangle without values.
    pub fn empty(&self) -> Upper {
        Upper { pattern: self.pattern.clone(), vals: Vec::new() }
    }
}

/// Pattern (row pointers, columns) of the upper triangle [ K + Cᵀ C, Cᵀ ; 0, diagonal ], with the columns of Cᵀ that have a number.
fn pattern(stiffness: &Csr<f64>, rows: &Csr<f64>, columns: &Csr<f64>, number: &[Option<usize>]) -> (Vec<usize>, Vec<usize>) {
    let (n, m) = (stiffness.num_rows(), number.iter().flatten().count());
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
        cols.extend(touching.filter_map(|a| number[a]).map(|number| n + number));
        ptr.push(cols.len());
    }
    for a in 0..m {
        cols.push(n + a);
        ptr.push(cols.len());
    }
    (ptr, cols)
}
