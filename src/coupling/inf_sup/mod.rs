//! The discrete inf-sup constant of a multiplier space on a side (the test of Chapelle and Bathe).
//!
//! ```text
//! beta = min over phi in M, max over w in W of  (phi, w) / (|phi|_M |w|_W)
//! ```
//!
//! W is the trace space without its constrained functions, M the multiplier space; both are real functions on one side,
//! so vector problems are tested component by component. With the Gram matrices G_W, G_M of the norms and
//! B_jk = ∫ ψ_j N_k ds, beta is the smallest singular value of L_M⁻¹ B L_W⁻ᵀ (G = L Lᵀ), its square the smallest
//! eigenvalue of
//!
//! ```text
//! B G_W⁻¹ Bᵀ phi = beta² G_M phi.
//! ```
//!
//! No unknown of the bulk takes part. beta stays away from zero under refinement where the pair is stable.
//!
//! Limits: `f64`, as the factorisations are. More multipliers than trace functions have beta = 0.
//! Source: Chapelle, Bathe, Comput. Struct. 47 (1993) 537-545; Brivadis, Buffa, Wohlmuth, Wunderlich, CMAME 284 (2015) 292-319.

mod dense;
mod iterative;
mod matrices;
mod sequence;

use crate::basis::Basis;
use crate::linalg::LinearError;
use crate::space::Space;

pub use matrices::{Grams, grams};
pub use sequence::{FALLING, FLAT, Verdict, ZERO, degree_exponent, slope, verdict};

/// Largest number of multipliers for which [`Method::Auto`] takes the dense method.
pub const DENSE_LIMIT: usize = 400;

/// Measure of integrals over the side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Measure<'a> {
    /// By the length (area) of the side.
    #[default]
    Physical,
    /// In the parameter, at unit speed: every element has the given measure there, spread evenly over its cell.
    Parametric(&'a [f64]),
}

/// The norms of both spaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Norm {
    /// L2 for both.
    #[default]
    L2,
    /// sum h_e⁻¹ ∫ w² for W and sum h_e ∫ phi² for M, h_e the size of the element; the constant of L2 on uniform grids.
    HHalf,
}

/// Method for the smallest singular value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// Dense up to [`DENSE_LIMIT`] multipliers, iterative beyond.
    #[default]
    Auto,
    /// Singular values of the whole matrix: any size, cubic cost.
    Dense,
    /// Lanczos with shifts on sparse factors: linear cost on curves.
    Iterative,
}

/// Options of the inf-sup test.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Question<'a> {
    /// The measure of integrals.
    pub measure: Measure<'a>,
    /// The norms.
    pub norm: Norm,
    /// The method for the constant.
    pub method: Method,
}

/// The constant with the sizes and the cost of its computation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InfSup {
    /// The constant, in 0..1.
    pub beta: f64,
    /// Functions of W.
    pub functions: usize,
    /// Functions of M.
    pub multipliers: usize,
    /// Largest size of an element: its measure to the power 1/S \[length\].
    pub h: f64,
    /// Linear systems solved; zero for the dense method, and if there are more multipliers than functions.
    pub iterations: usize,
}

/// Error when there is no constant.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InfSupError {
    /// The multiplier has other elements than the side.
    #[error("the multiplier has {found} elements, the side {expected}")]
    Elements {
        /// Elements of the side.
        expected: usize,
        /// Elements of the multiplier.
        found: usize,
    },
    /// There is no multiplier at all.
    #[error("the multiplier space is empty")]
    Empty,
    /// The functions of a space depend on each other, or an integral is not finite.
    #[error("the functions of the {space} depend on each other to working precision")]
    Dependent {
        /// "trace" or "multiplier".
        space: &'static str,
    },
    /// A sparse factorisation failed.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// The iteration did not converge.
    #[error("the smallest eigenvalue did not settle in {iterations} linear systems; the last change was {change:.1e}")]
    NotSettled {
        /// Linear systems solved.
        iterations: usize,
        /// Last relative change of beta².
        change: f64,
    },
}

/// Computes beta of `multiplier` on `space`.
///
/// `functions` gives for every function of `space` its function of W, `None` if it is constrained; two functions of one
/// number are one function of W (closed sides).
///
/// # Errors
/// [`InfSupError`] where a space is degenerate or the iteration does not converge.
///
/// # Panics
/// If `functions` or the sizes of [`Measure::Parametric`] do not have one entry per function, per element.
///
/// # Example
/// Hat functions without their ends against hat functions that are constant on the end elements:
/// ```
/// use faying::coupling::inf_sup::{Question, inf_sup};
/// use faying::coupling::multiplier::{MultiplierKind, build};
/// use faying::{geometry::shapes, space::{Body, Patch, PatchSpec}};
/// let spec = PatchSpec::new(shapes::rectangle([0.0, 0.0], [1.0, 1.0])?).with_degree([1, 1]).with_elements([32, 1]);
/// let side = Patch::<1, 2>::try_new(&spec)?.trace("v0")?;
/// let psi = build(&side.space, MultiplierKind::Lowered(0), &[true, true])?;
/// let last = side.dofs.len() - 1;
/// let inner: Vec<Option<usize>> = (0..=last).map(|i| (i > 0 && i < last).then(|| i - 1)).collect();
/// let found = inf_sup(&*side.space, &inner, &*psi, &Question::default())?;
/// assert!((found.beta - 0.880903).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn inf_sup<const S: usize, const N: usize>(
    space: &dyn Space<S, N>,
    functions: &[Option<usize>],
    multiplier: &dyn Basis<S>,
    question: &Question<'_>,
) -> Result<InfSup, InfSupError> {
    let grams = grams(space, functions, multiplier, question.measure, question.norm)?;
    let (beta, iterations) = grams.smallest(question.method)?;
    let (multipliers, functions) = (grams.multiplier.num_rows(), grams.trace.num_rows());
    Ok(InfSup { beta, functions, multipliers, h: grams.h, iterations })
}

impl Grams {
    /// The smallest generalised singular value, and the number of linear systems solved for it.
    ///
    /// # Errors
    /// [`InfSupError`] where a space is degenerate or the iteration does not converge.
    pub fn smallest(&self, method: Method) -> Result<(f64, usize), InfSupError> {
        let (multipliers, functions) = (self.multiplier.num_rows(), self.trace.num_rows());
        if multipliers == 0 {
            return Err(InfSupError::Empty);
        }
        if multipliers > functions {
            return Ok((0.0, 0));
        }
        match method {
            Method::Auto if multipliers > DENSE_LIMIT => iterative::smallest(self),
            Method::Iterative => iterative::smallest(self),
            _ => dense::smallest(self).map(|beta| (beta, 0)),
        }
    }
}
