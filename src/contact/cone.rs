//! Discrete cones of admissible multipliers, and contact rows transformed to their variables.
//!
//! The cone of normal stresses lambda <= 0 has three discrete forms (seed: M_P, M_W, M_E), each lambda = T mu with mu <= 0:
//!
//! | cone | condition | mu | T |
//! | --- | --- | --- | --- |
//! | P, `coefficients` | lambda_j <= 0 | coefficients | identity |
//! | W, `weights` | ∫ lambda ψ_j ds <= 0 | integrals \[force\] | inverse Gram matrix G_jk = ∫ ψ_j ψ_k ds |
//! | E, `values` | lambda(x_j) <= 0 | values at the Greville points x_j | inverse collocation matrix ψ_k(x_j) |
//!
//! With the gap in weak form r = C u + g the conditions are mu <= 0, Tᵀ r >= 0, product zero in every row: the system of the cone P with
//! rows Tᵀ C, offset Tᵀ g and weights Tᵀ w. So a constraint solver is independent of the cone: rows are transformed before the solve,
//! multipliers after it. Results for lambda (pressure, force, error) refer to the coefficients lambda = T mu; `active`, the sign cases and
//! the Karush-Kuhn-Tucker residuals to mu and the gap of the cone (Tᵀ r)_j / (Tᵀ w)_j \[length\]: lumped (P), the coefficients of the
//! L2 projection of the gap (W, weights one), the gap weighted with the function dual to the values (E).
//!
//! **Properties.** Non-penetration holds in the mean only, against each function of T:
//! - P: the pressure is non-negative everywhere, as the ψ_j are. The mean of the gap with every ψ_j is non-negative.
//! - E: the pressure is non-negative at the Greville points, between them it may change sign. P is a subset of E, as non-negative
//!   coefficients have non-negative values; for degree 0 and 1 they are equal. Gap conditions are weaker: the functions of T have both
//!   signs from degree 2 on.
//! - W: the mean of the pressure with every ψ_j is non-negative, its values need not be: beside the zone it changes sign with the decay
//!   of the inverse Gram matrix. P is a subset of W as well. The L2 projection of the gap has non-negative coefficients, so *it* is
//!   non-negative everywhere. The pressure extends past the active functions: all functions contribute to it.
//! - All three have the same total force if all is closed, and are equal for multipliers constant on elements.
//! - `dual` multipliers: P constrains the mean gap in each function, which is the coefficient of the slave's own displacement; W is
//!   their L2 projection in the dual space itself; they have no Greville points and so no E.
//!
//! Example: half cylinder on a rigid plane after Hertz (half width 0.05 of the radius, largest pressure 0.02747), degree 4 with p/p-2
//! (degree 2), graded elements, level 0 with 12 along the arc; error of lambda in L2 relative to Hertz' pressure, least pressure relative
//! to the largest:
//!
//! | level | P error | least | W error | least | E error | least |
//! | --- | --- | --- | --- | --- | --- | --- |
//! | 0 | 0.179 | 0 | 0.131 | -0.147 | 0.139 | -0.089 |
//! | 1 | 0.076 | 0 | 0.049 | -0.062 | 0.059 | -0.062 |
//! | 2 | 0.021 | 0 | 0.022 | -0.010 | 0.034 | -0.059 |
//!
//! All converge at the rate limited by the square-root end of the pressure; the larger cones are more accurate on coarse elements, at the
//! cost of tension beside the zone. The zone of the active functions is widest for W (half of it 0.048, 0.055 and 0.048 at level 2).
//!
//! **Partly facing sides.** G is integrated where the sides face each other, and only functions that face the opponent belong to T; the
//! others stay open. E needs more: an interpolatory rule cut at the edge of the facing part gives functions whose point lies outside it a
//! negative weight, and a body that lifts off would be pulled back there. Such functions stay open as well; a negative weight on a whole
//! support (Newton-Cotes rules from degree 8 on) is an error.
//!
//! Cost: a solve per unknown of both sides, entries of decayed columns dropped at round-off; at most [`MOST_FUNCTIONS`] functions.
//! Source: Brivadis, defence slides, Pavia 2017.

use super::{ContactError, ContactRows, greville::greville_points};
use crate::basis::{Basis, Order, ShapeTable};
use crate::coupling::Rows;
use crate::linalg::{Csr, ProfileFault, ProfileLu, Real, Triplets, lit, to_f64};
use std::borrow::Cow;

/// Largest number of multipliers of a side for the cones W and E; the setup time is quadratic in it.
pub const MOST_FUNCTIONS: usize = 10_000;
/// Limit of the entries of a triangle of T⁻¹: 800 per function at [`MOST_FUNCTIONS`]; small sides may be full.
const MOST_ENTRIES: usize = 8_000_000;
/// Relative size, against the largest of their column, below which entries of transformed rows are dropped as round-off.
const DROPPED: f64 = 1e-22;
/// Relative size, against the largest, below which weights are not positive.
const NO_WEIGHT: f64 = 1e-12;
/// Uncovered fraction of an element's measure above which the element faces its partner only in part.
const WHOLE: f64 = 1e-9;
/// Values below this at a Greville point are zero.
const NO_VALUE: f64 = 1e-15;

/// The discrete cone of admissible multipliers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cone {
    /// P: coefficients lambda_j <= 0.
    #[default]
    Coefficients,
    /// W: integrals ∫ lambda ψ_j ds <= 0.
    Weights,
    /// E: values lambda(x_j) <= 0 at the Greville points.
    Values,
}

/// T of the cone over its functions; the identity if `inverse` is `None`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ConeTransform<T: Real> {
    functions: Vec<usize>,
    inverse: Option<(Csr<T>, ProfileLu<T>)>,
    weights: Vec<T>,
}

impl<const S: usize, const N: usize, T: Real> ContactRows<S, N, T> {
    /// Sets the cone of the multipliers; `multiplier`: the multiplier functions of the rows.
    ///
    /// # Errors
    /// [`ContactError::NoGreville`] if E has no points, [`ContactError::ConeWeight`] if a function has a non-positive weight in the cone,
    /// [`ContactError::ConeSize`] above [`MOST_FUNCTIONS`].
    pub fn with_cone(mut self, cone: Cone, multiplier: &dyn Basis<S, T>) -> Result<Self, ContactError> {
        self.turn = ConeTransform::identity();
        if cone == Cone::Coefficients {
            return Ok(self);
        }
        let m = self.weights.len();
        if m > MOST_FUNCTIONS {
            return Err(ContactError::ConeSize { functions: m, most: MOST_FUNCTIONS });
        }
        let all = match cone {
            Cone::Weights => self.gram(multiplier),
            _ => collocation(multiplier).ok_or(ContactError::NoGreville)?,
        };
        let whole = self.whole_supports(multiplier);
        let mut functions: Vec<usize> = (0..m).filter(|&j| self.facing[j]).collect();
        // every round leaves out at least one function
        loop {
            let part = restricted(&all, &functions);
            let out: Vec<usize> = match ProfileLu::try_new(&part, MOST_ENTRIES) {
                Err(ProfileFault::TooLarge { .. }) => return Err(ContactError::ConeSize { functions: m, most: MOST_FUNCTIONS }),
                Err(ProfileFault::Pivot { row }) if whole[functions[row]] => {
                    return Err(ContactError::ConeWeight { function: functions[row], weight: 0.0 });
                }
                Err(ProfileFault::Pivot { row }) => vec![row],
                Ok(lu) => {
                    let mut weights: Vec<T> = functions.iter().map(|&j| self.weights[j]).collect();
                    let floor = weights.iter().fold(T::zero(), |m, w| m.max(w.abs())) * lit(NO_WEIGHT);
                    lu.solve_transposed(&mut weights);
                    let floor = if cone == Cone::Weights { lit(NO_WEIGHT) } else { floor };
                    let bad: Vec<usize> = (0..functions.len()).filter(|&k| weights[k] <= floor).collect();
                    if bad.is_empty() {
                        for j in (0..m).filter(|j| functions.binary_search(j).is_err()) {
                            self.facing[j] = false;
                        }
                        self.turn = ConeTransform { functions, inverse: Some((part, lu)), weights };
                        return Ok(self);
                    }
                    let partly: Vec<usize> = bad.iter().copied().filter(|&k| !whole[functions[k]]).collect();
                    if partly.is_empty() {
                        return Err(ContactError::ConeWeight { function: functions[bad[0]], weight: to_f64(weights[bad[0]]) });
                    }
                    partly
                }
            };
            let mut k = 0;
            functions.retain(|_| {
                k += 1;
                !out.contains(&(k - 1))
            });
        }
    }

    /// ∫ ψ_j ψ_k ds over the segments.
    fn gram(&self, multiplier: &dyn Basis<S, T>) -> Csr<T> {
        let m = self.weights.len();
        let (mut gram, mut table, mut ids) = (Triplets::new(m, m), ShapeTable::new(), Vec::new());
        for run in self.segments.runs() {
            let element = self.segments.slave[run.start];
            multiplier.active(element, &mut ids);
            let n = ids.len();
            let mut block = vec![T::zero(); n * n];
            for piece in run {
                let points = self.segments.points(piece);
                multiplier.tabulate(element, &self.segments.slave_xi[points.clone()], Order::Values, &mut table);
                for (k, q) in points.enumerate() {
                    let values = table.values(k);
                    for a in 0..n {
                        for b in 0..n {
                            block[a * n + b] += self.segments.ds[q] * values[a] * values[b];
                        }
                    }
                }
            }
            for a in 0..n {
                (0..n).for_each(|b| gram.push(ids[a], ids[b], block[a * n + b]));
            }
        }
        gram.to_csr()
    }

    /// Whether the whole support of each function faces the opponent.
    fn whole_supports(&self, multiplier: &dyn Basis<S, T>) -> Vec<bool> {
        let (mut whole, mut ids) = (vec![true; self.weights.len()], Vec::new());
        for (element, &share) in self.segments.report.share.iter().enumerate() {
            if share < lit(1.0 - WHOLE) {
                multiplier.active(element, &mut ids);
                ids.iter().for_each(|&j| whole[j] = false);
            }
        }
        whole
    }

    /// Tᵀ C for rows C in the functions of the multiplier: the rows for a constraint solver.
    pub fn transformed<'a>(&self, rows: &'a Rows<T>) -> Cow<'a, Rows<T>> {
        match &self.turn.inverse {
            None => Cow::Borrowed(rows),
            Some((_, lu)) => Cow::Owned(Rows {
                slave: transformed(&rows.slave, &self.turn.functions, lu),
                master: transformed(&rows.master, &self.turn.functions, lu),
            }),
        }
    }

    /// Tᵀ g.
    pub fn transformed_offset(&self) -> Vec<T> {
        self.turn.transposed(self.offset.clone())
    }

    /// Tᵀ w: weights that convert the gaps of the cone to lengths; zero for functions outside the cone.
    pub fn transformed_weights(&self) -> Vec<T> {
        match self.turn.inverse {
            None => self.weights.clone(),
            Some(_) => self.turn.scattered(&self.turn.weights, self.weights.len()),
        }
    }

    /// lambda = T mu.
    pub fn multipliers(&self, mu: &[T]) -> Vec<T> {
        let Some((_, lu)) = &self.turn.inverse else { return mu.to_vec() };
        let mut own = self.turn.gathered(mu);
        lu.solve(&mut own);
        self.turn.scattered(&own, mu.len())
    }

    /// mu = T⁻¹ lambda, the variables that must be non-positive.
    pub fn in_cone(&self, lambda: &[T]) -> Vec<T> {
        let Some((inverse, _)) = &self.turn.inverse else { return lambda.to_vec() };
        let own = self.turn.gathered(lambda);
        let mut mu = vec![T::zero(); own.len()];
        inverse.mul(&own, &mut mu);
        self.turn.scattered(&mu, lambda.len())
    }
}

impl<T: Real> ConeTransform<T> {
    /// T of the cone P.
    pub(super) fn identity() -> Self {
        Self { functions: Vec::new(), inverse: None, weights: Vec::new() }
    }

    fn gathered(&self, all: &[T]) -> Vec<T> {
        self.functions.iter().map(|&j| all[j]).collect()
    }

    fn scattered(&self, own: &[T], m: usize) -> Vec<T> {
        let mut all = vec![T::zero(); m];
        self.functions.iter().zip(own).for_each(|(&j, &v)| all[j] = v);
        all
    }

    /// Tᵀ r of values per function.
    pub(super) fn transposed(&self, r: Vec<T>) -> Vec<T> {
        let Some((_, lu)) = &self.inverse else { return r };
        let mut own = self.gathered(&r);
        lu.solve_transposed(&mut own);
        self.scattered(&own, r.len())
    }
}

/// ψ_k(x_j) at the Greville points x_j.
fn collocation<const S: usize, T: Real>(multiplier: &dyn Basis<S, T>) -> Option<Csr<T>> {
    let points = greville_points(multiplier)?;
    let m = multiplier.num_functions();
    let (mut matrix, mut table, mut ids) = (Triplets::new(m, m), ShapeTable::new(), Vec::new());
    for (j, (element, xi)) in points.iter().enumerate() {
        multiplier.active(*element, &mut ids);
        multiplier.tabulate(*element, &[*xi], Order::Values, &mut table);
        for (&k, &v) in ids.iter().zip(table.values(0)) {
            if v.abs() > lit(NO_VALUE) {
                matrix.push(j, k, v);
            }
        }
    }
    Some(matrix.to_csr())
}

/// Rows and columns of `functions`, in ascending order.
fn restricted<T: Real>(all: &Csr<T>, functions: &[usize]) -> Csr<T> {
    let mut number = vec![usize::MAX; all.num_rows()];
    functions.iter().enumerate().for_each(|(k, &j)| number[j] = k);
    let mut part = Triplets::new(functions.len(), functions.len());
    for (k, &j) in functions.iter().enumerate() {
        let (cols, vals) = all.row(j);
        for (c, &v) in cols.zip(vals) {
            if number[c] != usize::MAX {
                part.push(k, number[c], v);
            }
        }
    }
    part.to_csr()
}

/// Tᵀ C, one solve per column of C.
fn transformed<T: Real>(rows: &Triplets<T>, functions: &[usize], lu: &ProfileLu<T>) -> Triplets<T> {
    let mut number = vec![usize::MAX; rows.rows];
    functions.iter().enumerate().for_each(|(k, &j)| number[j] = k);
    let mut columns: Vec<(usize, usize, T)> =
        rows.entries.iter().filter(|e| number[e.0] != usize::MAX).map(|&(i, j, v)| (j, number[i], v)).collect();
    // stable: duplicate entries are summed in the order they were pushed
    columns.sort_by_key(|e| (e.0, e.1));
    let mut out = Triplets::new(rows.rows, rows.cols);
    let mut column = vec![T::zero(); functions.len()];
    for entries in columns.chunk_by(|a, b| a.0 == b.0) {
        column.fill(T::zero());
        entries.iter().for_each(|e| column[e.1] += e.2);
        lu.solve_transposed(&mut column);
        let floor = column.iter().fold(T::zero(), |m, v| m.max(v.abs())) * lit(DROPPED);
        for (k, &v) in column.iter().enumerate().filter(|(_, v)| v.abs() > floor) {
            out.push(functions[k], entries[0].0, v);
        }
    }
    out
}
