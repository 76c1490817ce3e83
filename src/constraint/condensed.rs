//! Condensation: every row eliminates one slave unknown, and an SPD system is left.
//!
//! ```text
//! C_P u_P = -g - C_R u_R + s l,   u = T y + u_0,   Tᵀ K T y = Tᵀ (f - K u_0),   lambda = -C_Pᵀ⁻¹ (K u - f)_P
//! ```
//!
//! P holds one slave unknown per row, chosen by pivoting: the slave block is not square for multipliers of lower degree
//! or beside fixed ends. A soft row keeps its multiplier as an unknown with s on the diagonal.
//! For biorthogonal multipliers C_P is diagonal and T sparse; for others T is dense along the interface: meant for curves.

use super::penalised::{inverse_diagonal, refuse_motions};
use super::scale::{Scaled, gaps};
use super::{Abilities, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, SolveError};
use crate::linalg::residual::RESIDUAL_LIMIT;
use crate::linalg::{Csr, Ldlt, Limits, LinearError, LinearSolver, Lu, Operator, Upper, conjugate_gradients, gauss_seidel, product};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Relative size of a row's slave entries after elimination below which it determines no slave unknown.
const NO_PIVOT: f64 = 1e-10;
/// Entries of a row below this fraction of its largest one are dropped as round-off in the elimination: they would couple
/// every dual multiplier to all others. Refinement uses the unmodified rows.
const ROUND_OFF: f64 = 1e-13;
/// Residual tolerance of the conjugate gradients of one correction.
const INNER: f64 = 1e-7;
/// Refinements allowed.
const MAX_REFINEMENTS: usize = 10;

/// Solver that eliminates constraints; needs the reaction to be the transposed constraint.
#[derive(Debug, Default)]
pub struct Condensed {
    /// Limits of the conjugate gradients used in place of a factor; `None`: a factor.
    iterative: Option<Limits>,
    ldlt: Ldlt,
    pivots: Lu,
    pivots_transposed: Lu,
}

impl Condensed {
    /// Creates a solver without a factor.
    pub fn new() -> Self {
        Self::default()
    }

    /// Creates a solver of the condensed system by conjugate gradients with symmetric Gauss-Seidel sweeps.
    pub fn iterative(limits: Limits) -> Self {
        Self { iterative: Some(limits), ..Self::default() }
    }

    /// Number of symbolic analyses so far.
    pub fn num_symbolic_factorizations(&self) -> usize {
        self.ldlt.num_symbolic_factorizations()
    }
}

impl ConstraintSolver<f64> for Condensed {
    fn abilities(&self) -> Abilities {
        Abilities::default()
    }

    fn tolerance(&self) -> f64 {
        self.iterative.as_ref().map_or(RESIDUAL_LIMIT, |limits| limits.tolerance)
    }

    fn factors(&self) -> usize {
        self.ldlt.factorisations()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_, f64>) -> Result<ConstrainedSolution<f64>, SolveError> {
        let s = Scaled::of(system)?;
        s.need_symmetry()?;
        let (n, m) = (s.num_unknowns(), s.num_rows());
        let mut slave = vec![false; n];
        for &(_, j, v) in &system.constraint.slave.entries {
            slave[j] |= v != 0.0;
        }
        let enforced: Vec<usize> = (0..m).filter(|&a| s.enforced[a]).collect();
        let reduced = eliminate(&s, &enforced, &slave)?;
        let map = Map::of(&s, &enforced, &reduced, system.stiffness.dof_coordinates());
        let (block, block_transposed) = pivot_blocks(&s, &enforced, &reduced);
        self.pivots.prepare(&block)?;
        self.pivots_transposed.prepare(&block_transposed)?;
        let stiffness = product(&map.transposed, &product(&map.stiffness, &map.t)).with_dof_coordinates(map.places.clone());
        let blocks = (&block, &block_transposed);
        let scale: Vec<f64> = s.diagonal.iter().map(|d| if *d != 0.0 { 1.0 / d.abs() } else { 1.0 }).collect();
        let (method, (u, l, size, iterations)) = if let Some(limits) = self.iterative.clone() {
            let inverse = inverse_diagonal(&stiffness)?;
            refuse_motions(&stiffness, &inverse, &limits)?;
            let answer = s.iterated(&scale, &limits, INNER, |r1, r2, limits| {
                let mut done = 0;
                let (du, dl) = self.correct(&s, &map, &enforced, &reduced, blocks, r1, r2, |b, y| {
                    done = conjugate_gradients(
                        &mut |p, q| {
                            stiffness.apply(p, q);
                            Ok(())
                        },
                        &mut |r, z| {
                            gauss_seidel(&stiffness, &inverse, r, z);
                            Ok(())
                        },
                        b,
                        y,
                        limits,
                    )?;
                    Ok(())
                })?;
                Ok((du, dl, done))
            })?;
            ("condensed, conjugate gradients", answer)
        } else {
            self.ldlt.prepare(&stiffness)?;
            self.ldlt.refuse_negative(&Upper::of(&stiffness), stiffness.num_rows(), stiffness.dof_coordinates())?;
            let (u, l, size) = s.refined(&scale, MAX_REFINEMENTS, |r1, r2| {
                self.correct(&s, &map, &enforced, &reduced, blocks, r1, r2, |b, y| self.ldlt.solve(&stiffness, b, y).map(|_| ()))
            })?;
            if size.is_nan() || size > RESIDUAL_LIMIT {
                return Err(LinearError::Singular { residual: if size.is_finite() { size } else { 1.0 } }.into());
            }
            ("condensed, direct", (u, l, size, 0))
        };
        Ok(ConstrainedSolution {
            gap: gaps(system, &u),
            unknowns: u,
            multipliers: (0..m).map(|a| s.factor[a] * l[a]).collect(),
            active: s.enforced,
            residual: size,
            condition: None,
            method: method.into(),
            iterations,
            active_set: None,
        })
    }
}

impl Condensed {
    /// (du, dl) with K du + Cᵀ dl = r1, C du - s dl = r2, up to rounding.
    fn correct(
        &self,
        s: &Scaled<'_>,
        map: &Map,
        enforced: &[usize],
        reduced: &[Reduced],
        blocks: (&Csr<f64>, &Csr<f64>),
        r1: &[f64],
        r2: &[f64],
        condensed: impl FnOnce(&[f64], &mut [f64]) -> Result<(), LinearError>,
    ) -> Result<(Vec<f64>, Vec<f64>), LinearError> {
        let (n, m) = (s.num_unknowns(), s.num_rows());
        // u_0: particular solution with non-pivot unknowns zero; pivot unknowns satisfy C u = r2
        let wanted: Vec<f64> = enforced.iter().map(|&a| r2[a] / s.k[a]).collect();
        let mut pivots = vec![0.0; enforced.len()];
        self.pivots.solve(blocks.0, &wanted, &mut pivots)?;
        let mut u0 = vec![0.0; n];
        for (row, &value) in reduced.iter().zip(&pivots) {
            u0[row.pivot] = value;
        }
        let mut force = vec![0.0; n];
        s.stiffness.mul(&u0, &mut force);
        let mut right: Vec<f64> = (0..n).map(|i| r1[i] - force[i]).collect();
        right.resize(map.t.num_rows(), 0.0);
        let mut b = vec![0.0; map.t.num_cols()];
        map.transposed.mul(&right, &mut b);
        let mut y = vec![0.0; b.len()];
        condensed(&b, &mut y)?;
        let mut du = vec![0.0; map.t.num_rows()];
        map.t.mul(&y, &mut du);
        du.truncate(n);
        for i in 0..n {
            du[i] += u0[i];
        }
        // multipliers from the equilibrium of the pivots
        s.stiffness.mul(&du, &mut force);
        let missing: Vec<f64> = reduced.iter().map(|row| r1[row.pivot] - force[row.pivot]).collect();
        let mut multiplier = vec![0.0; enforced.len()];
        self.pivots_transposed.solve(blocks.1, &missing, &mut multiplier)?;
        let mut dl = vec![0.0; m];
        for (e, &a) in enforced.iter().enumerate() {
            dl[a] = multiplier[e] / s.k[a]; // the blocks hold rows divided by k
        }
        Ok((du, dl))
    }
}

/// Entries of row `a` divided by k, round-off left out.
fn coupled<'a>(s: &'a Scaled<'_>, a: usize) -> impl Iterator<Item = (usize, f64)> + 'a {
    let (cols, vals) = s.rows.row(a);
    let least = ROUND_OFF * vals.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    cols.zip(vals).filter(move |(_, v)| v.abs() > least).map(move |(j, &v)| (j, v / s.k[a]))
}

/// A row solved for its pivot: u_pivot + sum coefficient u_column = ..; column n + e is the multiplier of soft row e.
#[derive(Debug)]
struct Reduced {
    pivot: usize,
    others: Vec<(usize, f64)>,
}

/// Gauss-Jordan elimination of the enforced rows; each takes its largest slave entry as pivot.
fn eliminate(s: &Scaled<'_>, enforced: &[usize], slave: &[bool]) -> Result<Vec<Reduced>, SolveError> {
    let width = s.num_unknowns() + enforced.len();
    let mut rank = vec![usize::MAX; width]; // row with this column as its pivot
    let mut work = Work { value: vec![0.0; width], used: vec![false; width], columns: Vec::new() };
    let mut reduced: Vec<Reduced> = Vec::with_capacity(enforced.len());
    for (e, &a) in enforced.iter().enumerate() {
        let mut queue = BinaryHeap::new();
        for (j, v) in coupled(s, a) {
            work.add(j, v, &rank, &mut queue);
        }
        if s.compliance[a] > 0.0 {
            work.add(s.num_unknowns() + e, -s.compliance[a] / s.k[a], &rank, &mut queue);
        }
        while let Some(Reverse(r)) = queue.pop() {
            let factor = std::mem::take(&mut work.value[reduced[r].pivot]);
            if factor != 0.0 {
                for &(j, c) in &reduced[r].others {
                    work.add(j, -factor * c, &rank, &mut queue);
                }
            }
        }
        let mut pivot = None;
        let mut largest = NO_PIVOT;
        for &j in &work.columns {
            if j < slave.len() && slave[j] && work.value[j].abs() > largest {
                largest = work.value[j].abs();
                pivot = Some(j);
            }
        }
        let pivot = pivot.ok_or(SolveError::OverConstrained { row: a, rows: enforced.len() })?;
        rank[pivot] = e;
        reduced.push(work.take(pivot));
    }
    // back substitution: no row keeps the pivot of another
    for e in (0..reduced.len()).rev() {
        if reduced[e].others.iter().all(|&(j, _)| rank[j] == usize::MAX) {
            continue;
        }
        let mut queue = BinaryHeap::new();
        let pivot = reduced[e].pivot;
        for (j, c) in std::mem::take(&mut reduced[e].others) {
            work.add(j, c, &rank, &mut queue);
        }
        while let Some(Reverse(r)) = queue.pop() {
            let factor = std::mem::take(&mut work.value[reduced[r].pivot]);
            if factor != 0.0 {
                for &(j, c) in &reduced[r].others {
                    work.add(j, -factor * c, &rank, &mut queue);
                }
            }
        }
        work.value[pivot] = 1.0;
        reduced[e] = work.take(pivot);
    }
    Ok(reduced)
}

/// Dense work row with a list of its used columns.
struct Work {
    value: Vec<f64>,
    used: Vec<bool>,
    columns: Vec<usize>,
}

impl Work {
    /// Adds v to column j; if that is a pivot column, its row is queued.
    fn add(&mut self, j: usize, v: f64, rank: &[usize], queue: &mut BinaryHeap<Reverse<usize>>) {
        if !self.used[j] {
            self.used[j] = true;
            self.columns.push(j);
            if rank[j] != usize::MAX {
                queue.push(Reverse(rank[j]));
            }
        }
        self.value[j] += v;
    }

    /// Returns the row divided by its pivot, and clears the work row.
    fn take(&mut self, pivot: usize) -> Reduced {
        let divisor = self.value[pivot];
        self.columns.sort_unstable();
        let mut others = Vec::new();
        for j in self.columns.drain(..) {
            let v = std::mem::take(&mut self.value[j]);
            self.used[j] = false;
            if j != pivot && v != 0.0 {
                others.push((j, v / divisor));
            }
        }
        self.value[pivot] = 0.0;
        Reduced { pivot, others }
    }
}

/// T, its transpose, and the stiffness over unknowns and the multipliers of soft rows.
struct Map {
    t: Csr<f64>,
    transposed: Csr<f64>,
    stiffness: Csr<f64>,
    places: Vec<[f64; 3]>,
}

impl Map {
    fn of(s: &Scaled<'_>, enforced: &[usize], reduced: &[Reduced], places: &[[f64; 3]]) -> Self {
        let n = s.num_unknowns();
        let index = |i: usize| u32::try_from(i).expect("fewer than 2^32 unknowns");
        let soft: Vec<usize> = (0..enforced.len()).filter(|&e| s.compliance[enforced[e]] > 0.0).collect();
        let mut row_of = vec![usize::MAX; n];
        for (e, row) in reduced.iter().enumerate() {
            row_of[row.pivot] = e;
        }
        // new numbers: free unknowns, then soft multipliers; a pivot has none
        let mut column = vec![u32::MAX; n + enforced.len()];
        let (mut next, mut kept) = (0, Vec::new());
        for i in 0..n {
            if row_of[i] == usize::MAX {
                column[i] = index(next);
                next += 1;
                kept.push(i);
            }
        }
        for &e in &soft {
            column[n + e] = index(next);
            next += 1;
        }
        let (mut ptr, mut cols, mut vals) = (vec![0usize], Vec::new(), Vec::new());
        for i in 0..n {
            if row_of[i] == usize::MAX {
                cols.push(column[i]);
                vals.push(1.0);
            } else {
                for &(j, c) in &reduced[row_of[i]].others {
                    cols.push(column[j]);
                    vals.push(-c);
                }
            }
            ptr.push(cols.len());
        }
        for &e in &soft {
            cols.push(column[n + e]);
            vals.push(1.0);
            ptr.push(cols.len());
        }
        let t = Csr::from_parts(next, ptr, cols, vals);
        let stiffness = if soft.is_empty() {
            s.stiffness.clone()
        } else {
            let (mut ptr, mut cols, mut vals) = (vec![0], Vec::with_capacity(s.stiffness.num_entries()), s.stiffness.vals().to_vec());
            for i in 0..n {
                cols.extend(s.stiffness.row(i).0.map(index));
                ptr.push(cols.len());
            }
            for (k, &e) in soft.iter().enumerate() {
                cols.push(index(n + k));
                vals.push(s.compliance[enforced[e]]);
                ptr.push(cols.len());
            }
            Csr::from_parts(n + soft.len(), ptr, cols, vals)
        };
        let mut new_places = Vec::new();
        if places.len() == n {
            new_places.extend(kept.iter().map(|&i| places[i]));
            new_places.extend(soft.iter().map(|&e| places[reduced[e].pivot]));
        }
        Self { transposed: t.transposed(), t, stiffness, places: new_places }
    }
}

/// C_P and C_Pᵀ with rows of C divided by k.
fn pivot_blocks(s: &Scaled<'_>, enforced: &[usize], reduced: &[Reduced]) -> (Csr<f64>, Csr<f64>) {
    let mut column = vec![usize::MAX; s.num_unknowns()];
    for (e, row) in reduced.iter().enumerate() {
        column[row.pivot] = e;
    }
    let mut block = crate::linalg::Triplets::new(enforced.len(), enforced.len());
    for (e, &a) in enforced.iter().enumerate() {
        for (j, v) in coupled(s, a).filter(|(j, _)| column[*j] != usize::MAX) {
            block.push(e, column[j], v);
        }
    }
    let block = block.to_csr();
    let transposed = block.transposed();
    (block, transposed)
}
