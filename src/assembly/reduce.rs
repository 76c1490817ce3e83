//! Several bodies in one system with the prescribed unknowns eliminated.
//!
//!   u = P v + u0,   Pᵀ K P v = Pᵀ (f - K u0),   C P v + (g + C u0)
//!
//! K has one block per body on the diagonal, in the order of their unknowns, and the stiffness of couplings between them.
//! Free unknowns keep their order; prescribed ones have an empty row in P; an unknown bound by an equation (sliding along
//! an inclined plane, a side that moves as one) has a row of coefficients of free ones.

use super::blocks::Blocks;
use crate::linalg::{Csr, Real, Triplets, lit, to_f64};
use std::collections::BTreeMap;
use std::sync::Arc;

/// sum of terms (unknown, coefficient) = value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Equation<T: Real = f64> {
    /// (unknown, coefficient).
    pub terms: Vec<(usize, T)>,
    /// Right-hand side.
    pub value: T,
}

/// Error of eliminating unknowns.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReductionError {
    /// The prescribed values contradict an equation.
    #[error("the prescribed values contradict equation {equation} by {defect:e}; drop one of them")]
    Contradiction {
        /// Position in the list of equations.
        equation: usize,
        /// Left side minus right side.
        defect: f64,
    },
    /// Sizes disagree.
    #[error("{what}: {found} given, {expected} expected")]
    Shape {
        /// Name of the quantity of the wrong size.
        what: &'static str,
        /// Its size.
        found: usize,
        /// The size that fits.
        expected: usize,
    },
}

/// Row of P: an unknown in terms of the free ones.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Bound<T: Real> {
    /// Free unknown, with its number among the free ones.
    Free(usize),
    /// (free unknown, coefficient) of a bound unknown; empty if it is prescribed.
    Terms(Vec<(usize, T)>),
}

/// The system of the free unknowns.
#[derive(Clone, Debug)]
pub struct Reduced<T: Real = f64> {
    /// Pᵀ K P, with the coordinates of its unknowns.
    pub stiffness: Csr<T>,
    /// Pᵀ (f - K u0).
    pub load: Vec<T>,
    pub(super) bound: Vec<Bound<T>>,
    offset: Vec<T>,
    pub(super) free: Vec<usize>,
}

/// Coefficients below this, relative to the largest of their equation, are zero.
const NO_COEFFICIENT: f64 = 1e-12;
/// Defects below this, relative to the terms of their equation and to the largest prescribed value, are rounding.
const NO_DEFECT: f64 = 1e-9;

impl<T: Real> Reduced<T> {
    /// Reduces the system of `matrices` (a list of the bodies' matrices, or [`Blocks`]) with the right-hand side `load`.
    ///
    /// `prescribed` lists (unknown, value); the first value of an unknown counts. Every equation eliminates the unknown with
    /// the largest coefficient among those still free; redundant equations are skipped.
    ///
    /// # Errors
    /// [`ReductionError`] if sizes disagree or an equation contradicts the prescribed values.
    pub fn try_new<'m>(
        matrices: impl Into<Blocks<'m, T>>,
        load: &[T],
        prescribed: &[(usize, T)],
        equations: &[Equation<T>],
    ) -> Result<Self, ReductionError> {
        let matrices: Blocks<'m, T> = matrices.into();
        let unknowns = matrices.num_unknowns();
        let shape = |what, found| if found == unknowns { Ok(()) } else { Err(ReductionError::Shape { what, found, expected: unknowns }) };
        shape("entries of the load", load.len())?;
        if let Some(between) = matrices.between {
            shape("rows between bodies", between.num_rows())?;
            shape("columns between bodies", between.num_cols())?;
        }
        let highest = prescribed.iter().map(|p| p.0).chain(equations.iter().flat_map(|e| e.terms.iter().map(|t| t.0))).max();
        if let Some(highest) = highest.filter(|&h| h >= unknowns) {
            shape("unknowns that conditions name", highest + 1)?;
        }
        let (bound, offset, free) = eliminate(unknowns, prescribed, equations)?;
        let mut reduced = Self { stiffness: Csr::zeros(Arc::default()), load: Vec::new(), bound, offset, free };
        reduced.stiffness = reduced.matrix(matrices);
        reduced.load = reduced.right_hand_side(matrices, load);
        Ok(reduced)
    }

    /// Number of unknowns before the reduction.
    pub fn num_unknowns(&self) -> usize {
        self.bound.len()
    }

    /// Number of free unknowns.
    pub fn num_free(&self) -> usize {
        self.free.len()
    }

    /// The full number of every free unknown, ascending.
    pub fn free(&self) -> &[usize] {
        &self.free
    }

    /// Whether `unknown` is neither prescribed nor bound.
    pub fn is_free(&self, unknown: usize) -> bool {
        matches!(self.bound[unknown], Bound::Free(_))
    }

    /// C P and C u0 of constraint rows in full unknowns; add C u0 to the offset of the rows.
    pub fn rows(&self, rows: &Triplets<T>) -> (Triplets<T>, Vec<T>) {
        let mut reduced = Triplets::new(rows.rows, self.num_free());
        let mut offset = vec![T::zero(); rows.rows];
        for &(i, j, value) in &rows.entries {
            offset[i] += value * self.offset[j];
            self.each_term(j, |k, coefficient| reduced.push(i, k, value * coefficient));
        }
        (reduced, offset)
    }

    /// u = P v + u0.
    pub fn expand(&self, v: &[T]) -> Vec<T> {
        self.bound
            .iter()
            .zip(&self.offset)
            .map(|(bound, &u0)| match bound {
                Bound::Free(k) => v[*k],
                Bound::Terms(terms) => terms.iter().fold(u0, |s, &(k, c)| s + c * v[k]),
            })
            .collect()
    }

    /// v of a full vector: its free entries.
    pub fn restrict(&self, u: &[T]) -> Vec<T> {
        self.free.iter().map(|&i| u[i]).collect()
    }

    /// Pᵀ (f - K u0) for another load on the same matrices.
    pub fn right_hand_side<'m>(&self, matrices: impl Into<Blocks<'m, T>>, load: &[T]) -> Vec<T> {
        let matrices: Blocks<'m, T> = matrices.into();
        let mut rest = load.to_vec();
        if self.offset.iter().any(|&v| v != T::zero()) {
            for (r, k) in rest.iter_mut().zip(matrices.product(&self.offset)) {
                *r -= k;
            }
        }
        let mut reduced = vec![T::zero(); self.num_free()];
        for (i, &value) in rest.iter().enumerate() {
            self.each_term(i, |k, coefficient| reduced[k] += coefficient * value);
        }
        reduced
    }

    /// r = K u - f + Bᵀ lambda in all unknowns: support reactions on the bodies, zero at free unknowns.
    ///
    /// `reaction` lists parts of B in full unknowns (slave and master rows).
    pub fn residual<'m>(&self, matrices: impl Into<Blocks<'m, T>>, load: &[T], reaction: &[&Triplets<T>], lambda: &[T], u: &[T]) -> Vec<T> {
        let matrices: Blocks<'m, T> = matrices.into();
        let mut r = matrices.product(u);
        for (r, &f) in r.iter_mut().zip(load) {
            *r -= f;
        }
        for part in reaction {
            for &(i, j, value) in &part.entries {
                r[j] += value * lambda[i];
            }
        }
        r
    }

    /// Calls `visit(free unknown, coefficient)` for row `i` of P.
    pub(super) fn each_term(&self, i: usize, mut visit: impl FnMut(usize, T)) {
        match &self.bound[i] {
            Bound::Free(k) => visit(*k, T::one()),
            Bound::Terms(terms) => {
                for &(k, coefficient) in terms {
                    visit(k, coefficient);
                }
            }
        }
    }
}

/// Checks that prescribed values, as (unknown, value), and equations of so many unknowns do not contradict each other.
///
/// # Errors
/// [`ReductionError::Contradiction`].
pub(crate) fn consistent<T: Real>(unknowns: usize, prescribed: &[(usize, T)], equations: &[Equation<T>]) -> Result<(), ReductionError> {
    eliminate(unknowns, prescribed, equations).map(|_| ())
}

/// Rows of P, u0, and the free unknowns.
fn eliminate<T: Real>(
    unknowns: usize,
    prescribed: &[(usize, T)],
    equations: &[Equation<T>],
) -> Result<(Vec<Bound<T>>, Vec<T>, Vec<usize>), ReductionError> {
    // rows in full unknowns first; a bound unknown never stays in another's row
    let mut rows: BTreeMap<usize, BTreeMap<usize, T>> = BTreeMap::new();
    let mut offset = vec![T::zero(); unknowns];
    for &(i, value) in prescribed {
        rows.entry(i).or_insert_with(|| {
            offset[i] = value;
            BTreeMap::new()
        });
    }
    let scale = prescribed.iter().fold(T::zero(), |m, v| m.max(v.1.abs()));
    // rows that depend on an unknown: binding it rewrites only those
    let mut users: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (number, equation) in equations.iter().enumerate() {
        let largest = equation.terms.iter().fold(T::zero(), |m, t| m.max(t.1.abs()));
        let (mut terms, mut rest, mut size) = (BTreeMap::<usize, T>::new(), equation.value, equation.value.abs());
        for &(i, c) in &equation.terms {
            match rows.get(&i) {
                None => *terms.entry(i).or_insert(T::zero()) += c,
                Some(row) => {
                    rest -= c * offset[i];
                    size = size.max((c * offset[i]).abs());
                    for (&j, &d) in row {
                        *terms.entry(j).or_insert(T::zero()) += c * d;
                    }
                }
            }
        }
        terms.retain(|_, c| c.abs() > largest * lit(NO_COEFFICIENT));
        // the largest coefficient is the pivot, the last of equals: u_i - u_0 = 0 binds u_i and no row is rewritten
        let pivot = terms.iter().fold(None, |best: Option<(usize, T)>, (&i, &c)| match best {
            Some(b) if b.1.abs() > c.abs() => Some(b),
            _ => Some((i, c)),
        });
        let Some((pivot, factor)) = pivot else {
            if rest.abs() > size.max(scale) * lit(NO_DEFECT) {
                return Err(ReductionError::Contradiction { equation: number, defect: -to_f64(rest) });
            }
            continue;
        };
        terms.remove(&pivot);
        let row: BTreeMap<usize, T> = terms.into_iter().map(|(i, c)| (i, -c / factor)).collect();
        offset[pivot] = rest / factor;
        for user in users.remove(&pivot).unwrap_or_default() {
            let Some(c) = rows.get_mut(&user).and_then(|r| r.remove(&pivot)) else { continue };
            let shift = c * offset[pivot];
            offset[user] += shift;
            let target = rows.get_mut(&user).expect("it was there");
            for (&i, &d) in &row {
                *target.entry(i).or_insert(T::zero()) += c * d;
                users.entry(i).or_default().push(user);
            }
        }
        for &i in row.keys() {
            users.entry(i).or_default().push(pivot);
        }
        rows.insert(pivot, row);
    }
    let free: Vec<usize> = (0..unknowns).filter(|i| !rows.contains_key(i)).collect();
    let mut bound: Vec<Bound<T>> = Vec::with_capacity(unknowns);
    let mut next = 0;
    for i in 0..unknowns {
        if let Some(row) = rows.get(&i) {
            let number = |j: usize| free.binary_search(&j).expect("rows name free unknowns only");
            bound.push(Bound::Terms(row.iter().map(|(&j, &c)| (number(j), c)).collect()));
        } else {
            bound.push(Bound::Free(next));
            next += 1;
        }
    }
    Ok((bound, offset, free))
}
