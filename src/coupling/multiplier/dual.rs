//! Dual (biorthogonal) multipliers of any degree: one per function of the slave side, element by element.
//!
//! On an element with functions N_0 .. N_p take polynomials q_k that span P_p, and with s the arc length
//!
//! ```text
//! G_ki = ∫ q_k N_i ds,   d_i = ∫ N_i ds,   psi_j = sum_k A_jk q_k,   A = diag(d) G⁻¹
//! ```
//!
//! so that ∫ psi_j N_i ds = delta_ij d_i on every element, and D of the mortar rows is diagonal with the lumped weights
//! W_i = sum of d_i. The psi_j sum to one: the q_k may be chosen with sum one, then 1ᵀ G = dᵀ because the constant is one
//! of the polynomials, and 1ᵀ A = dᵀ G⁻¹ = 1ᵀ. The psi_j are polynomials where the N_i are rational too.
//!
//! At a constrained end the function N_0 that does not vanish there has no free unknown and gets no multiplier. On its
//! elements the others keep their weights and take one degree less: psi_1 .. psi_p in P_(p-1), dual to N_1 .. N_p. G stays
//! regular: N_1 .. N_p span what vanishes at the end, xi P_(p-1) up to a positive denominator, and a q of P_(p-1)
//! orthogonal to xi q times that denominator is zero. The sum stays one: sum psi_j - 1 lies in P_(p-1) and is orthogonal
//! to N_1 .. N_p, since ∫ sum_j psi_j N_i ds = d_i = ∫ 1 N_i ds.
//!
//! The polynomials in a dual space follow from c_j = ∫ f N_j ds / d_j on each element: f lies in it where these agree between
//! the elements of a function. They do for constants. On straight Lagrange traces they do up to degree p - 1, because
//! Gauss-Lobatto nodes make c_j the nodal value f(x_j) as long as f N_j has degree 2p - 1, and on equal elements up to an
//! even degree p by symmetry; splines and curved sides hold constants only, so lambda converges in L2 with order one
//! at most. [`reproduction`](super::reproduction()) computes the degree that a space reproduces.
//! Source: Wohlmuth, SIAM J. Numer. Anal. 38 (2000) 989-1012; Lamichhane, Wohlmuth, Math. Comp. 76 (2007) 233-249
//! (Gauss-Lobatto nodes).

use super::{MultiplierError, SideEnd};
use crate::basis::{ElementPolynomials, Order, Piecewise, ShapeTable, legendre_polynomials};
use crate::geometry::MapTable;
use crate::linalg::{Real, Vector, measure, to_f64};
use crate::quadrature::{Rule, gauss_legendre};
use crate::space::Space;
use nalgebra::{DMatrix, Dyn, LU};

/// Gauss points per element beyond three per degree, since arc lengths of curved elements are not polynomials.
const POINTS: usize = 16;
/// A lumped weight below this share of the length of its function's elements is not positive.
pub(super) const NO_WEIGHT: f64 = 1e-12;
/// Largest error of duality, as a share of the largest weight.
const NOT_DUAL: f64 = 1e-9;

/// Builds the dual multipliers of the side `space` whose ends in `constrained` have no free unknown.
///
/// Functions are numbered as those of the side, the ones at constrained ends left out.
///
/// # Errors
/// [`MultiplierError::NoDual`] where a lumped weight is not positive or an element has no dual functions,
/// [`MultiplierError::NothingLeft`] where constrained ends leave an element without functions.
pub fn dual<const N: usize, T: Real>(space: &dyn Space<1, N, T>, constrained: &[SideEnd]) -> Result<Piecewise<T>, MultiplierError> {
    let n = space.num_functions();
    let (gone, number, functions) = numbering(space, constrained);
    let (mut weight, mut length, mut home) = (vec![T::zero(); n], vec![T::zero(); n], vec![0; n]);
    let (mut pieces, mut work) = (Vec::with_capacity(space.num_elements()), Work::new());
    for element in 0..space.num_elements() {
        let whole = work.integrate(space, element, &gone);
        for (a, &i) in work.kept.iter().enumerate() {
            weight[i] += work.weights[a];
            length[i] += whole;
            home[i] = element;
        }
        let mut piece = work.piece(element, space.degree(element)[0])?;
        piece.ids.iter_mut().for_each(|i| *i = number[*i]);
        pieces.push(piece);
    }
    for i in (0..n).filter(|&i| !gone[i]) {
        // NaN is not positive either
        if to_f64(weight[i]).is_nan() || to_f64(weight[i]) <= NO_WEIGHT * to_f64(length[i]) {
            let reason = format!("the lumped weight of function {i} on element {} is {:.3e}, not positive", home[i], to_f64(weight[i]));
            return Err(MultiplierError::NoDual { reason, known: String::new() });
        }
    }
    Ok(Piecewise::new(space, functions, pieces))
}

/// Returns flags of the functions without a multiplier, consecutive numbers of the others, and how many there are.
pub(super) fn numbering<const N: usize, T: Real>(space: &dyn Space<1, N, T>, constrained: &[SideEnd]) -> (Vec<bool>, Vec<usize>, usize) {
    let mut gone = vec![false; space.num_functions()];
    for end in constrained {
        gone[function_at(space, end)] = true;
    }
    let (mut number, mut functions) = (Vec::with_capacity(gone.len()), 0);
    for &gone in &gone {
        number.push(functions);
        functions += usize::from(!gone);
    }
    (gone, number, functions)
}

/// The function with the largest value at an end.
fn function_at<const N: usize, T: Real>(space: &dyn Space<1, N, T>, end: &SideEnd) -> usize {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    let at = Vector::<1, T>::new(if end.at == 0 { T::zero() } else { T::one() });
    space.active(end.element, &mut ids);
    space.tabulate(end.element, &[at], Order::Values, &mut table);
    let size = |a: usize| to_f64(table.values(0)[a].abs());
    ids[(0..ids.len()).max_by(|&a, &b| size(a).total_cmp(&size(b))).expect("an element has functions")]
}

/// Integrals of one element; work arrays are reused from element to element.
pub(super) struct Work<T: Real> {
    ids: Vec<usize>,
    /// Functions of the element that have a multiplier.
    pub kept: Vec<usize>,
    /// d_i of the kept functions.
    pub weights: Vec<T>,
    /// G_ki, a row per kept function i.
    pub products: Vec<T>,
    shapes: ShapeTable<1, T>,
    legendre: Vec<T>,
    rule: Option<Rule<1, T>>,
}

impl<T: Real> Work<T> {
    pub fn new() -> Self {
        Self {
            ids: Vec::new(),
            kept: Vec::new(),
            weights: Vec::new(),
            products: Vec::new(),
            shapes: ShapeTable::new(),
            legendre: Vec::new(),
            rule: None,
        }
    }

    /// Fills weights and products with Legendre's polynomials as q_k; returns the length of the element.
    pub fn integrate<const N: usize>(&mut self, space: &dyn Space<1, N, T>, element: usize, gone: &[bool]) -> T {
        space.active(element, &mut self.ids);
        let places: Vec<usize> = (0..self.ids.len()).filter(|&a| !gone[self.ids[a]]).collect();
        self.kept.clear();
        self.kept.extend(places.iter().map(|&a| self.ids[a]));
        let m = places.len();
        let points = 3 * self.ids.len() + POINTS;
        let rule = match self.rule.take() {
            Some(rule) if rule.points.len() == points => rule,
            _ => gauss_legendre::<T>(points),
        };
        let mut map = MapTable::<1, N, T>::new();
        space.evaluate(element, &rule.points, Order::Gradients, &mut self.shapes, &mut map);
        self.weights.clear();
        self.weights.resize(m, T::zero());
        self.products.clear();
        self.products.resize(m * m, T::zero());
        let mut length = T::zero();
        for (q, (xi, &w)) in rule.points.iter().zip(&rule.weights).enumerate() {
            let ds = w * measure(&map.jacobian[q]);
            length += ds;
            legendre_polynomials(m.max(1) - 1, xi[0], &mut self.legendre);
            for (i, &a) in places.iter().enumerate() {
                let value = ds * self.shapes.values(q)[a];
                self.weights[i] += value;
                for k in 0..m {
                    self.products[i * m + k] += self.legendre[k] * value;
                }
            }
        }
        self.rule = Some(rule);
        length
    }

    /// Computes A of the element from Gᵀ Aᵀ = diag(d), with rows scaled to one and one correction.
    pub fn piece(&self, element: usize, degree: usize) -> Result<ElementPolynomials<T>, MultiplierError> {
        let m = self.kept.len();
        if m == 0 {
            return Err(MultiplierError::NothingLeft { element, degree });
        }
        let no_dual = || MultiplierError::NoDual {
            reason: format!("the functions on element {element} have no dual ones among polynomials of degree {}", m - 1),
            known: String::new(),
        };
        let line = |i: usize| &self.products[i * m..(i + 1) * m];
        let scale: Vec<T> = (0..m).map(|i| line(i).iter().fold(T::zero(), |s, v| s.max(v.abs()))).collect();
        if scale.iter().any(|&s| to_f64(s).is_nan() || s == T::zero()) {
            return Err(no_dual());
        }
        let g = DMatrix::<T>::from_fn(m, m, |i, k| line(i)[k] / scale[i]);
        let wanted = DMatrix::<T>::from_fn(m, m, |i, j| if i == j { self.weights[i] / scale[i] } else { T::zero() });
        let lu: LU<T, Dyn, Dyn> = g.clone().lu();
        let first = lu.solve(&wanted).ok_or_else(no_dual)?;
        let correction = lu.solve(&(&wanted - &g * &first)).ok_or_else(no_dual)?;
        let transposed = first + correction;
        let missed = (&wanted - &g * &transposed).amax();
        if to_f64(missed).is_nan() || to_f64(missed) > NOT_DUAL * to_f64(wanted.amax()) {
            return Err(no_dual());
        }
        // a function without weight on this element has no dual part here
        let lives: Vec<usize> = (0..m).filter(|&j| transposed.column(j).amax() != T::zero()).collect();
        Ok(ElementPolynomials {
            ids: lives.iter().map(|&j| self.kept[j]).collect(),
            degree: m - 1,
            coefficients: lives.iter().flat_map(|&j| transposed.column(j).iter().copied().collect::<Vec<T>>()).collect(),
        })
    }
}
