//! Validation of knot vectors, and the errors of knots and of conversions between spline spaces.

use crate::linalg::{Real, to_f64};

/// Error of an invalid knot vector.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KnotError {
    /// A knot is smaller than the one before it.
    #[error("knots decrease at index {index}: {value} after {before}; knots must not decrease")]
    Decrease {
        /// Index of the smaller knot, from 0.
        index: usize,
        /// Its value.
        value: f64,
        /// The knot before it.
        before: f64,
    },
    /// A knot is repeated more than degree + 1 times.
    #[error("the knot {value} at index {index} is repeated {times} times; at most {allowed} (degree + 1) are allowed")]
    Repeated {
        /// Index of the first of the equal knots, from 0.
        index: usize,
        /// Their value.
        value: f64,
        /// Their multiplicity.
        times: usize,
        /// Maximum multiplicity, degree + 1.
        allowed: usize,
    },
    /// The first or the last knot is repeated too few times.
    #[error(
        "the knot vector is not open: the knot {value} at index {index} is repeated {times} times; both ends need {needed} (degree + 1)"
    )]
    NotOpen {
        /// Index of the first of the equal end knots, from 0.
        index: usize,
        /// Their value.
        value: f64,
        /// Their multiplicity.
        times: usize,
        /// Required multiplicity, degree + 1.
        needed: usize,
    },
    /// There are fewer knots than the degree needs.
    #[error("{found} knots are too few for degree {degree}; an open knot vector has at least {needed}")]
    Counts {
        /// Number of knots given.
        found: usize,
        /// The degree.
        degree: usize,
        /// The least number of knots.
        needed: usize,
    },
    /// A knot is infinite or not a number.
    #[error("the knot at index {index} is not finite")]
    NotFinite {
        /// Its index, from 0.
        index: usize,
    },
}

/// Error of expressing a spline in a space that does not contain it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContainError {
    /// The degree is too low.
    #[error("degree {found} cannot hold splines of degree {needed}; raise it to at least {needed}")]
    Degree {
        /// Degree of the space.
        found: usize,
        /// Degree of the spline.
        needed: usize,
    },
    /// The parameter intervals differ.
    #[error("the knots end at {found}, those of the spline at {needed}")]
    Ends {
        /// End of the space.
        found: f64,
        /// End of the spline.
        needed: f64,
    },
    /// The space is too smooth at a knot of the spline, or has no knot there.
    #[error("the space has {found} continuous derivatives at the knot {knot}, the spline only {needed}; repeat that knot")]
    Continuity {
        /// The knot of the spline.
        knot: f64,
        /// Continuous derivatives of the space there; its degree where there is no knot.
        found: isize,
        /// Continuous derivatives of the spline there.
        needed: isize,
    },
}

/// Checks that `knots` do not decrease, are open, and nowhere repeated more than `degree` + 1 times.
pub(super) fn check<T: Real>(degree: usize, knots: &[T]) -> Result<(), KnotError> {
    if let Some(index) = knots.iter().position(|t| !t.is_finite()) {
        return Err(KnotError::NotFinite { index });
    }
    if let Some(k) = (1..knots.len()).find(|&k| knots[k] < knots[k - 1]) {
        return Err(KnotError::Decrease { index: k, value: to_f64(knots[k]), before: to_f64(knots[k - 1]) });
    }
    let needed = 2 * (degree + 1);
    if knots.len() < needed {
        return Err(KnotError::Counts { found: knots.len(), degree, needed });
    }
    let mut index = 0;
    while index < knots.len() {
        let times = knots[index..].iter().take_while(|&&t| t == knots[index]).count();
        let value = to_f64(knots[index]);
        if times > degree + 1 {
            return Err(KnotError::Repeated { index, value, times, allowed: degree + 1 });
        }
        if times <= degree && (index == 0 || index + times == knots.len()) {
            return Err(KnotError::NotOpen { index, value, times, needed: degree + 1 });
        }
        index += times;
    }
    Ok(())
}
