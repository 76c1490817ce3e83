//! One factor for all sets of contact: the Schur complement of the rows that may close.
//!
//! ```text
//! A = [ K + Eᵀ V E + Cᵀ W C   Eᵀ F ]       E: equalities, V and F theirs (see super::direct);  C: all contact rows, open or closed
//!     [ F E                   -F s - e k ]       W = 1e-2 k / |C|₁²: springs that hold bodies which contact alone supports
//! ```
//!
//! ```text
//! S = C A⁻¹ Cᵀ,   h = C A⁻¹ r,   (S + diag d) nu = h - b,   u = A⁻¹ (r - Cᵀ nu)
//! ```
//!
//! ```text
//! closed rows: d = t / (1 - t W), b = r₂ / (1 - t W), lambda = (nu + W r₂) / (1 - t W),   t = compliance + e k
//! open rows:   d = -1 / W,        b = 0,              lambda = 0                          (the spring gives way)
//! ```
//!
//! This is the system of the set for every W. S + diag d is quasi-definite, and singular exactly if that system is. A is
//! factorised once and S computed by forward elimination alone; a set costs a dense factor and a few substitutions.
//!
//! Source: the Schur complement of a factorised matrix under changes of low rank: Hager, SIAM Review 31 (1989) 221-239.

use super::direct::{Factor, Inverse, MAX_REFINEMENTS, begin, refuse_kernel, weights};
use super::interface_set::Set;
use super::quasidefinite::{LdltPattern, REGULARISATION};
use super::rows_alone::{RowsAlone, ScaledRow};
use super::scale::Scaled;
use crate::linalg::residual::{InverseIteration, RESIDUAL_LIMIT, SAFE_GROWTH};
use crate::linalg::{Border, Buffer, Csr, DenseLdlt, Ldlt, LinearError, Sparsity, Triplets};
use std::sync::Arc;

/// W |C|₁² / k: soft relative to the bodies, far above rounding. The solution does not depend on it.
const SPRINGS: f64 = 1e-2;
/// S is used if S and the dense factors of `SETS` sets cost less than `FACTORS` factors of the whole system.
const SETS: f64 = 8.0;
const FACTORS: f64 = 7.0;
/// Size limit of S: this fraction of the entries of the factor, or `FEW` entries if that is more.
const SHARE: f64 = 0.1;
/// Rows are summed over groups if their complement and this many sets cost less than two factors, and as many sets of all rows as `CROWD`
/// more than one.
const GROUPED: f64 = 4.0;
const CROWD: f64 = 16.0;
/// W |C|₁² / k where rows are summed over groups. What the rows of a group move against their mean keeps its springs, which must be soft
/// relative to the bodies over the length of a group: over n rows these are n times softer than k, and the springs n times stiffer.
const HELD: f64 = 1e-8;
const FEW: usize = 1 << 21;
/// Corrections of a possible zero-energy mode, as S is not accurate enough to identify one.
pub(super) const CORRECTIONS: usize = 2;

/// Counted operations of a solver that keeps one factor for all sets of contact; a multiplication and an addition are two.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InterfaceWork {
    /// Contact rows in the Schur complement.
    pub rows: usize,
    /// Operations of one factor of the whole system.
    pub factor: f64,
    /// Operations of L⁻¹ Cᵀ.
    pub columns: f64,
    /// Operations of C A⁻¹ Cᵀ with it.
    pub complement: f64,
    /// Number of times that both were computed.
    pub complements: usize,
    /// Sets that were solved.
    pub sets: usize,
    /// Operations of all their dense factors.
    pub dense: f64,
}

/// Factor and Schur complement kept from set to set.
#[derive(Debug)]
pub(super) struct Interface {
    /// W |C|₁² / k of contact rows.
    springs: f64,
    ldlt: Ldlt,
    layout: Option<LdltPattern>,
    plan: Option<Plan>,
    held: Option<Held>,
    dense: DenseLdlt,
    /// Numbers of analyses and factorisations of discarded factors.
    before: [usize; 2],
    pub work: InterfaceWork,
}

/// Decision whether to use a Schur complement for a pattern.
#[derive(Debug)]
struct Plan {
    stiffness: Arc<Sparsity>,
    rows: Arc<Sparsity>,
    contact: Vec<usize>,
    /// Parts of the factor reached by the contact rows; `None` if every set has its own factor.
    border: Option<Border>,
}

/// Schur complement of the values factorised last.
#[derive(Debug)]
struct Held {
    rows: Csr<f64>,
    /// Spring of each contact row, weight of each equality.
    w: Vec<f64>,
    /// Whether A is as definite as it has to be and, with S, regular.
    regular: bool,
    /// S; `None` without a border, and if it failed.
    complement: Option<Arc<Buffer<f64>>>,
    /// A⁻¹ r for the load and the equalities of the last system.
    at_load: Option<Vec<f64>>,
}

/// Unknowns, scaled multipliers, residual, condition.
pub(super) type InterfaceSolution = (Vec<f64>, Vec<f64>, f64, f64);

impl Default for Interface {
    fn default() -> Self {
        Self {
            springs: SPRINGS,
            ldlt: Ldlt::new(),
            layout: None,
            plan: None,
            held: None,
            dense: DenseLdlt::default(),
            before: [0; 2],
            work: InterfaceWork::default(),
        }
    }
}

impl Interface {
    /// Number of symbolic analyses so far.
    pub fn num_symbolic_factorizations(&self) -> usize {
        self.before[0] + self.ldlt.num_symbolic_factorizations()
    }

    /// Number of numerical factorisations so far.
    pub fn factorisations(&self) -> usize {
        self.before[1] + self.ldlt.factorisations()
    }

    /// Number of entries of the current factor.
    pub fn factor_entries(&self) -> usize {
        self.ldlt.factor_entries()
    }

    /// Memory in bytes of the factor and the Schur complement, from the analysis alone; `None` if every set has its own factor.
    pub fn predict(&mut self, s: &Scaled<'_>, contact: &[usize], places: &[[f64; 3]]) -> Result<Option<usize>, LinearError> {
        self.plan(s, contact, places)?;
        let Some(border) = self.plan.as_ref().and_then(|plan| plan.border.as_ref()) else { return Ok(None) };
        let layout = LdltPattern::of(&mut self.layout, s, contact);
        let factor = self.ldlt.predict(&layout.empty(), &layout.places(s, places))?;
        Ok(Some(factor + border.bytes() + DenseLdlt::bytes(contact.len())))
    }

    /// Solves `s`, whose contact rows are `contact`, ascending, each with entries; `None` if the set needs its own factor.
    /// `again`: as for [`super::ConstraintSolver::solve_set`].
    ///
    /// # Errors
    /// [`LinearError::Singular`] if the set has a zero-energy mode.
    pub fn solve(
        &mut self,
        s: &Scaled<'_>,
        contact: &[usize],
        places: &[[f64; 3]],
        again: bool,
    ) -> Result<Option<InterfaceSolution>, LinearError> {
        if !again {
            self.plan(s, contact, places)?;
        }
        if self.plan.as_ref().is_none_or(|plan| plan.border.is_none()) {
            // the set gets a factor of its own
            self.give_up();
            return Ok(None);
        }
        if !again || self.held.is_none() {
            self.hold(s, contact, places)?;
        }
        let answer = self.solve_set(s);
        if let Ok(None) = answer {
            // what failed for one set may fail for others
            self.give_up();
        }
        answer
    }

    /// Drops everything, to free memory for non-symmetric systems.
    pub fn forget(&mut self) {
        (self.plan, self.held, self.layout) = (None, None, None);
        self.give_up();
    }

    /// Drops the factor, and rules out S for the current values.
    fn give_up(&mut self) {
        self.before = [self.num_symbolic_factorizations(), self.factorisations()];
        self.ldlt = Ldlt::new();
        if let Some(held) = &mut self.held {
            (held.regular, held.complement) = (false, None);
        }
    }

    /// Decides once per pattern whether to use S.
    fn plan(&mut self, s: &Scaled<'_>, contact: &[usize], places: &[[f64; 3]]) -> Result<(), LinearError> {
        let same = |p: &Plan| &p.stiffness == s.stiffness.pattern() && &p.rows == s.rows.pattern() && p.contact == contact;
        if self.plan.as_ref().is_some_and(same) {
            return Ok(());
        }
        (self.plan, self.held) = (None, None);
        let layout = LdltPattern::of(&mut self.layout, s, contact);
        let (size, m) = (s.num_unknowns() + layout.multipliers(), contact.len());
        let mut border = None;
        // no factor has more entries than a full triangle
        if affordable(m, size * (size + 1) / 2) {
            self.ldlt.analyse_upper(&layout.empty(), &layout.places(s, places))?;
            let (entries, factor) = self.ldlt.size();
            if affordable(m, entries) {
                let found = self.ldlt.border(&s.rows, contact);
                let [columns, complement] = found.operations;
                if pays(&found, factor) {
                    self.work = InterfaceWork { rows: m, factor, columns, complement, ..InterfaceWork::default() };
                    border = Some(found);
                }
            }
        }
        let (stiffness, rows) = (s.stiffness.pattern().clone(), s.rows.pattern().clone());
        self.plan = Some(Plan { stiffness, rows, contact: contact.to_vec(), border });
        Ok(())
    }

    /// Computes factor and Schur complement of `s`; those of the same values are kept.
    fn hold(&mut self, s: &Scaled<'_>, contact: &[usize], places: &[[f64; 3]]) -> Result<(), LinearError> {
        self.factorise(s, contact, places, self.springs)?;
        let waits = self.held.as_ref().is_some_and(|held| held.regular && held.complement.is_none());
        let Some(border) = self.plan.as_ref().and_then(|plan| plan.border.as_ref()).filter(|_| waits) else { return Ok(()) };
        let held = self.held.as_ref().expect("factorised");
        let regular = self.is_held(s, contact, &held.w)?;
        let complement = if regular { Some(Arc::new(self.ldlt.complement(border, &s.rows)?)) } else { None };
        self.work.complements += usize::from(regular);
        self.held.iter_mut().for_each(|held| (held.regular, held.complement) = (regular, complement.clone()));
        Ok(())
    }

    /// Factorises A of `s` with `springs`; a factor of the same values is kept.
    fn factorise(&mut self, s: &Scaled<'_>, contact: &[usize], places: &[[f64; 3]], springs: f64) -> Result<(), LinearError> {
        let layout = LdltPattern::of(&mut self.layout, s, contact);
        let (mut w, f) = weights(s);
        for &a in contact {
            w[a] = spring(s, a, springs);
        }
        let upper = layout.assemble(s, &w, &f);
        let known = self.held.as_ref().is_some_and(|held| held.w == w && held.rows.vals() == s.rows.vals());
        if known && self.held.as_ref().is_some_and(|held| !held.regular) {
            return Ok(());
        }
        let multipliers = layout.multipliers();
        let new = match self.ldlt.factorise_kept(upper, &layout.places(s, places)) {
            Err(LinearError::Singular { .. }) => {
                self.held = Some(Held { rows: s.rows.clone(), w, regular: false, complement: None, at_load: None });
                return Ok(());
            }
            other => other?,
        };
        if known && !new {
            return Ok(());
        }
        self.held = None;
        let regular = self.ldlt.negative() <= multipliers;
        self.held = Some(Held { rows: s.rows.clone(), w, regular, complement: None, at_load: None });
        Ok(())
    }

    /// The contact rows of `s` alone, summed over `groups`; `None` where that takes no less than systems as a whole. Arguments as of
    /// [`Interface::solve`]; `again`: as of [`super::ConstraintSolver::rows_alone`].
    ///
    /// # Errors
    /// [`LinearError`] if the factor fails.
    pub fn alone(
        &mut self,
        s: &Scaled<'_>,
        contact: &[usize],
        groups: &[Vec<usize>],
        places: &[[f64; 3]],
        again: bool,
    ) -> Result<Option<RowsAlone>, LinearError> {
        self.plan(s, contact, places)?;
        let single = groups.len() == contact.len() && groups.iter().zip(contact).all(|(group, &a)| group[..] == [a]);
        let shares = self.plan.as_ref().is_some_and(|plan| plan.border.is_some());
        // many sets of all rows cost less than a factor for groups
        let cheap = || shares && CROWD * dense(contact.len()) < self.ldlt.size().1;
        if single && !shares || !single && (!affordable(groups.len(), 0) || cheap()) {
            return Ok(None);
        }
        let summed = if single { None } else { Some(summed(s, groups)) };
        let border = match &summed {
            None => None,
            Some(rows) => {
                let layout = LdltPattern::of(&mut self.layout, s, contact);
                self.ldlt.analyse_upper(&layout.empty(), &layout.places(s, places))?;
                let border = self.ldlt.border(rows, &(0..groups.len()).collect::<Vec<_>>());
                let [columns, complement] = border.operations;
                if columns + complement + GROUPED * dense(groups.len()) > 2.0 * self.ldlt.size().1 {
                    return Ok(None);
                }
                Some(border)
            }
        };
        match border {
            None => self.hold(s, contact, places)?,
            Some(_) => self.factorise(s, contact, places, HELD)?,
        }
        let layout = self.layout.as_ref().expect("laid out");
        let Some(held) = self.held.as_mut().filter(|held| held.regular) else { return Ok(None) };
        if !again || held.at_load.is_none() {
            let mut x = s.load.to_vec();
            x.resize(x.len() + layout.multipliers(), 0.0);
            let (_, f) = weights(s);
            for (a, number) in layout.numbers().filter(|(a, _)| s.enforced[*a]) {
                x[s.num_unknowns() + number] = -f[a] * s.offset[a];
                let (cols, vals) = s.rows.row(a);
                cols.zip(vals).for_each(|(j, v)| x[j] -= v * held.w[a] * s.offset[a]);
            }
            self.ldlt.apply_inverse(&mut x)?;
            held.at_load = Some(x);
        }
        let at_load = held.at_load.as_deref().expect("computed above");
        let load = |rows: &Csr<f64>, a: usize| {
            let (cols, vals) = rows.row(a);
            cols.zip(vals).map(|(j, v)| v * at_load[j]).sum()
        };
        let soft = |a: usize| s.compliance[a] + REGULARISATION * s.k[a];
        let complement = match (&border, &summed, &held.complement) {
            (Some(border), Some(rows), _) => Arc::new(self.ldlt.complement(border, rows)?),
            (None, None, Some(complement)) => complement.clone(),
            _ => return Ok(None),
        };
        let row = |g: usize| {
            let sum = |of: &dyn Fn(usize) -> f64| groups[g].iter().map(|&a| of(a)).sum::<f64>();
            match &summed {
                None => {
                    let a = contact[g];
                    ScaledRow { load: load(&s.rows, a), spring: held.w[a], soft: soft(a), offset: s.offset[a], factor: s.factor[a] }
                }
                Some(rows) => ScaledRow {
                    load: load(rows, g),
                    spring: 1.0 / sum(&|a| 1.0 / (held.w[a] * s.factor[a].powi(2))),
                    soft: sum(&|a| soft(a) / s.factor[a].powi(2)),
                    offset: sum(&|a| s.offset[a] / s.factor[a]),
                    factor: 1.0,
                },
            }
        };
        let rows = (0..groups.len()).map(row).collect();
        Ok(Some(RowsAlone { complement, rows, dense: DenseLdlt::default() }))
    }

    /// Whether A has no zero-energy mode: inverse iteration on a trial vector does not grow as for such a mode.
    fn is_held(&self, s: &Scaled<'_>, contact: &[usize], w: &[f64]) -> Result<bool, LinearError> {
        let all = Scaled::diagonal_with(s, |a| if contact.binary_search(&a).is_ok() || s.enforced[a] { w[a] } else { 0.0 });
        let mut motion = InverseIteration::begin(&all);
        let layout = self.layout.as_ref().expect("laid out");
        let vector = motion.right_side();
        let mut x = vector.to_vec();
        x.resize(x.len() + layout.multipliers(), 0.0);
        self.ldlt.apply_inverse(&mut x)?;
        vector.copy_from_slice(&x[..s.num_unknowns()]);
        Ok(motion.solved().is_some() && motion.end().growth < SAFE_GROWTH)
    }

    fn solve_set(&mut self, s: &Scaled<'_>) -> Result<Option<InterfaceSolution>, LinearError> {
        let (Some(Plan { border: Some(border), contact, .. }), Some(Held { w, complement: Some(complement), .. }), Some(layout)) =
            (&self.plan, &self.held, &self.layout)
        else {
            return Ok(None);
        };
        let soft = |a: usize| s.compliance[a] + REGULARISATION * s.k[a];
        let diagonal: Vec<f64> =
            contact.iter().map(|&a| if s.enforced[a] { soft(a) / (1.0 - soft(a) * w[a]) } else { -1.0 / w[a] }).collect();
        self.work.sets += 1;
        self.work.dense += dense(contact.len());
        let m = contact.len();
        self.dense.eliminate(m, m, |i, j| complement[j * m + i] + if i == j { diagonal[i] } else { 0.0 })?;
        let (_, f) = weights(s);
        let set = Set { s, layout, border, contact, ldlt: &self.ldlt, dense: &self.dense, w, f };
        let factor = Factor::of(s);
        let (state, more, mut soft) = begin(s, &factor, &set)?;
        if soft.growth > SAFE_GROWTH {
            for _ in 0..CORRECTIONS {
                let (mut r1, mut r2) = (vec![0.0; s.num_unknowns()], vec![0.0; s.num_rows()]);
                s.stiffness.mul(&soft.vector, &mut r1);
                s.rows.mul(&soft.vector, &mut r2);
                r2.iter_mut().zip(&s.enforced).filter(|(_, enforced)| !**enforced).for_each(|(r, _)| *r = 0.0);
                factor.correct_motion(&mut soft.vector, &mut r1, |r1| Ok(set.correct(r1, &r2)?.0))?;
            }
        }
        let condition = refuse_kernel(s, &factor, &soft.vector)?;
        // closed rows must have positive pivots, open ones negative: else the stiffness is indefinite on the null space of the set
        let right = self.dense.pivots().zip(contact).all(|(pivot, &a)| (pivot > 0.0) == s.enforced[a]);
        let answer = if more { state.finished(MAX_REFINEMENTS, |r1, r2| set.correct(r1, r2))? } else { state.end() };
        let (u, l, size) = answer;
        Ok((right && size <= RESIDUAL_LIMIT).then_some((u, l, size, condition)))
    }
}

/// Rows of `s` in the caller's units, summed over `groups`.
fn summed(s: &Scaled<'_>, groups: &[Vec<usize>]) -> Csr<f64> {
    let mut all = Triplets::new(groups.len(), s.num_unknowns());
    for (g, group) in groups.iter().enumerate() {
        for &a in group {
            let (cols, vals) = s.rows.row(a);
            all.entries.extend(cols.zip(vals).map(|(j, v)| (g, j, v / s.factor[a])));
        }
    }
    all.to_csr()
}

/// Operations of the dense factor of m rows.
fn dense(m: usize) -> f64 {
    (m as f64).powi(3) / 3.0
}

/// Whether the Schur complement of a border and eight sets in it take fewer operations than seven factors.
pub(super) fn pays(border: &Border, factor: f64) -> bool {
    let [columns, complement] = border.operations;
    columns + complement + SETS * dense(border.rows.len()) < FACTORS * factor
}

/// Whether S of m rows is within the size limit for a factor with `entries` entries.
pub(super) fn affordable(m: usize, entries: usize) -> bool {
    m * m <= FEW || (m as f64).powi(2) <= SHARE * entries as f64
}

/// W of contact row `a`.
fn spring(s: &Scaled<'_>, a: usize, springs: f64) -> f64 {
    let sum: f64 = s.rows.row(a).1.iter().map(|v| v.abs()).sum();
    (springs * s.k[a] / (sum * sum)).min(0.5 / s.compliance[a])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::{ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Direct, RowKind, SolveError, kinds_of_set};
    use crate::coupling::Rows;
    use crate::linalg::Triplets;
    use crate::linalg::residual::trial_numbers;

    /// Two membranes of n x n nodes, the second above the first, which is held at one side: tied along one side or not, in contact along
    /// another, the contact rows graded and averaged over neighbours.
    struct Sheets {
        stiffness: Csr<f64>,
        load: Vec<f64>,
        rows: Rows<f64>,
        offset: Vec<f64>,
        kind: Vec<RowKind>,
        compliance: Vec<f64>,
    }

    impl Sheets {
        fn new(n: usize, ties: usize, contact: usize, held: bool) -> Self {
            let count = 2 * n * n;
            let mut k = Triplets::new(count, count);
            let mut spring = |i: usize, j: usize, v: f64| {
                k.push(i, i, v);
                k.push(j, j, v);
                k.push(i, j, -v);
                k.push(j, i, -v);
            };
            for body in 0..2 {
                let at = |x: usize, y: usize| body * n * n + y * n + x;
                for y in 0..n {
                    for x in 0..n {
                        // graded: stiffness over two decades
                        let v = [1.0, 30.0][body] * 10f64.powf(2.0 * x as f64 / n as f64);
                        if x + 1 < n {
                            spring(at(x, y), at(x + 1, y), v);
                        }
                        if y + 1 < n {
                            spring(at(x, y), at(x, y + 1), v);
                        }
                    }
                }
            }
            for x in 0..n {
                k.push(x, x, 1.0);
                if held {
                    k.push(count - 1 - x, count - 1 - x, 0.1);
                }
            }
            let m = ties + contact;
            let (mut slave, mut master) = (Triplets::new(m, count), Triplets::new(m, count));
            for a in 0..m {
                // ties along x = 0, contact along y = n - 1 of the first and y = 0 of the second
                let node = |x: usize, body: usize| if a < ties { body * n * n + (1 + x) * n } else { (n * n - n) + body * n + x };
                let x = if a < ties { a } else { (a - ties) * (n - 1) / contact };
                let size = 10f64.powf(-(a as f64) / 4.0);
                for (step, share) in [(0, 0.75), (1, 0.25)] {
                    slave.push(a, node(x + step, 1), size * share);
                    master.push(a, node(x + step, 0), -size * share);
                }
            }
            let numbers = trial_numbers(count + m);
            let places = (0..count).map(|i| [(i % n) as f64, (i / n) as f64, 0.0]).collect();
            Self {
                stiffness: k.to_csr().with_dof_coordinates(places),
                load: numbers[..count].iter().map(|v| v - 0.7).collect(),
                rows: Rows { slave, master },
                offset: (0..m).map(|a| if a < ties { 0.0 } else { numbers[count + a] * 10f64.powf(-(a as f64) / 4.0) }).collect(),
                kind: (0..m).map(|a| if a < ties { RowKind::Equal } else { RowKind::Contact }).collect(),
                compliance: Vec::new(),
            }
        }

        fn system(&self) -> ConstrainedSystem<'_, f64> {
            ConstrainedSystem {
                stiffness: &self.stiffness,
                load: &self.load,
                constraint: &self.rows,
                reaction: None,
                offset: &self.offset,
                kind: &self.kind,
                compliance: &self.compliance,
            }
        }

        fn alone(&self, closed: &[bool]) -> Result<ConstrainedSolution, SolveError> {
            Direct::new().solve(&ConstrainedSystem { kind: &kinds_of_set(&self.kind, closed), ..self.system() })
        }
    }

    fn apart(a: &[f64], b: &[f64]) -> f64 {
        let largest = |x: &mut dyn Iterator<Item = f64>| x.fold(0.0f64, |m, v| m.max(v.abs()));
        largest(&mut a.iter().zip(b).map(|(a, b)| a - b)) / largest(&mut b.iter().copied()).max(1e-300)
    }

    /// Multipliers as forces: rows are graded.
    fn forces(sheets: &Sheets, solution: &ConstrainedSolution) -> Vec<f64> {
        let mut size = vec![0.0; sheets.kind.len()];
        sheets.rows.slave.entries.iter().for_each(|&(a, _, v)| size[a] += v);
        solution.multipliers.iter().zip(size).map(|(l, s)| l * s).collect()
    }

    #[test]
    fn every_set_has_the_answer_of_a_factor_of_its_own_whatever_the_springs() {
        for springs in [1e-4, 1e-2, 1.0, 1e2] {
            for (ties, held, soft) in [(0, false, false), (0, true, false), (5, false, false), (3, false, true)] {
                let (n, contact) = (14, 9);
                let mut sheets = Sheets::new(n, ties, contact, held);
                if soft {
                    // contact rows from stiff to softer than the bodies, a tie that gives way
                    let entry = |a: usize| 10f64.powf(-(a as f64) / 2.0) * [1e-6, 1e-2, 1.0, 1e3][a % 4];
                    sheets.compliance = (0..ties + contact).map(entry).collect();
                }
                let mut direct = Direct::with_interface(Interface { springs, ..Interface::default() });
                for (again, bits) in [511usize, 1, 0b1010_1010, 0b0_0001_1100, 0b1_0000_0001, 0b1_1110_0000, 3]
                    .into_iter()
                    .enumerate()
                    .map(|(k, bits)| (k % 3 > 0, bits))
                {
                    let closed: Vec<bool> = (0..ties + contact).map(|a| a >= ties && bits >> (a - ties) & 1 == 1).collect();
                    let (found, expected) = (direct.solve_set(&sheets.system(), &closed, again).unwrap(), sheets.alone(&closed).unwrap());
                    assert_eq!(found.active, expected.active);
                    let d = [
                        apart(&found.unknowns, &expected.unknowns),
                        apart(&forces(&sheets, &found), &forces(&sheets, &expected)),
                        apart(&found.gap, &expected.gap),
                    ];
                    assert!(d.iter().all(|&d| d < 1e-10), "{springs} {ties} {held} {soft} {bits:b}: {d:?}");
                    assert!(found.residual < 1e-13, "{:e}", found.residual);
                    let (a, b) = (found.condition.unwrap(), expected.condition.unwrap());
                    assert!((a / b - 1.0).abs() < 1e-5, "condition {a} and {b}");
                }
                let work = direct.interface_work();
                assert_eq!(
                    (work.rows, work.sets, work.complements, direct.factorisations(), direct.num_symbolic_factorizations()),
                    (contact, 7, 1, 1, 1)
                );
                // another load and other gaps: the same factor
                sheets.load.iter_mut().for_each(|f| *f = 0.3 - *f);
                sheets.offset.iter_mut().for_each(|g| *g *= 0.5);
                let (closed, again) = (vec![true; ties + contact], false);
                let (found, expected) = (direct.solve_set(&sheets.system(), &closed, again).unwrap(), sheets.alone(&closed).unwrap());
                assert!(apart(&found.unknowns, &expected.unknowns) < 1e-10);
                assert_eq!((direct.factorisations(), direct.interface_work().complements), (1, 1));
            }
        }
    }

    #[test]
    fn a_set_is_singular_exactly_where_its_system_is() {
        for springs in [1e-4, 1e-2, 1.0, 1e2] {
            for (ties, held) in [(0, false), (0, true), (4, false)] {
                let sheets = Sheets::new(14, ties, 9, held);
                let mut direct = Direct::with_interface(Interface { springs, ..Interface::default() });
                // all open leaves the second sheet free unless it is held or tied; one row is enough
                for (again, bits) in [(false, 511usize), (true, 0), (true, 16), (false, 0)] {
                    let closed: Vec<bool> = (0..ties + 9).map(|a| a >= ties && bits >> (a - ties) & 1 == 1).collect();
                    let (found, expected) = (direct.solve_set(&sheets.system(), &closed, again), sheets.alone(&closed));
                    assert_eq!(found.is_err(), bits == 0 && ties == 0 && !held, "{springs} {ties} {held} {bits:b}");
                    match (found, expected) {
                        (Ok(a), Ok(b)) => assert!(apart(&a.unknowns, &b.unknowns) < 1e-10),
                        (a, b) => assert_eq!(a.unwrap_err(), b.unwrap_err()),
                    }
                }
                assert_eq!((direct.factorisations(), direct.interface_work().sets), (1, 4));
            }
        }
    }

    #[test]
    fn other_reactions_negative_energy_and_too_many_rows_have_a_factor_for_every_set() {
        let sheets = Sheets::new(14, 2, 9, false);
        let closed: Vec<bool> = (0..11).map(|a| a % 2 == 0).collect();
        // a reaction that lacks an entry
        let mut reaction = sheets.rows.clone();
        reaction.master.entries.pop();
        let mut direct = Direct::new();
        let found = direct.solve_set(&ConstrainedSystem { reaction: Some(&reaction), ..sheets.system() }, &closed, false).unwrap();
        assert_eq!((found.method.as_str(), direct.interface_work().sets), ("saddle-point, LU", 0));
        // negative energy that no row takes
        let mut negative = Sheets::new(14, 2, 9, false);
        let (cols, vals) = negative.stiffness.row_mut(40);
        cols.zip(vals).filter(|(j, _)| *j == 40).for_each(|(_, v)| *v = -*v);
        let found = direct.solve_set(&negative.system(), &closed, false).unwrap_err();
        assert_eq!(found, negative.alone(&closed).unwrap_err());
        assert!(matches!(found, SolveError::Linear(LinearError::Indefinite { .. })), "{found}");
        // as many rows as unknowns of a chain
        let n = 1600;
        let (mut k, mut rows) = (Triplets::new(n, n), Triplets::new(n, n));
        for i in 0..n {
            k.push(i, i, 2.0);
            rows.push(i, i, 1.0);
            if i > 0 {
                k.push(i, i - 1, -1.0);
                k.push(i - 1, i, -1.0);
            }
        }
        let chain = Sheets {
            stiffness: k.to_csr(),
            load: vec![-1.0; n],
            rows: Rows { slave: rows, master: Triplets::new(n, n) },
            offset: vec![1.0; n],
            kind: vec![RowKind::Contact; n],
            compliance: Vec::new(),
        };
        let closed: Vec<bool> = (0..n).map(|i| i % 3 == 0).collect();
        let mut direct = Direct::new();
        let found = direct.solve_set(&chain.system(), &closed, false).unwrap();
        assert_eq!(found.unknowns, chain.alone(&closed).unwrap().unknowns);
        assert_eq!(direct.interface_work().sets, 0);
        direct.solve_set(&chain.system(), &vec![true; n], true).unwrap();
        assert_eq!(direct.num_symbolic_factorizations(), 1, "no analysis is needed to see that");
    }
}
