//! Errors of bodies of revolution.

use super::error::ErrorKind;
use std::fmt::{Formatter, Result};

/// A statement that bodies of revolution do not allow.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum RevolutionError {
    /// An elastic material without a hoop strain in a problem of bodies of revolution.
    NoHoopStrain,
    /// An elastic material with a hoop strain in any other problem.
    HoopStrain,
    /// A body with points of negative radius.
    BeyondAxis {
        /// The first such point \[length\]; coordinates beyond the dimension are zero.
        x: [f64; 3],
    },
    /// A load, springs, a tie or a contact on a side that lies on the axis, which has no area; a radial displacement prescribed there, or a
    /// radial force in a corner there.
    OnAxis,
    /// An obstacle that a force presses away from the axis.
    RadialForce,
}

impl RevolutionError {
    /// Writes the sentence about `name`: the body, side or contact.
    pub(super) fn write(self, f: &mut Formatter<'_>, name: &str) -> Result {
        match self {
            Self::NoHoopStrain => write!(
                f,
                "the material of body \"{name}\" has no hoop strain: bodies of revolution take materials such as Hooke::axisymmetric"
            ),
            Self::HoopStrain => write!(
                f,
                "the material of body \"{name}\" is one of bodies of revolution, and the problem is none: Problem::axisymmetric makes one"
            ),
            Self::BeyondAxis { x: [x, y, _] } => {
                write!(f, "body \"{name}\" has points beyond the axis of revolution, such as x = {x}, y = {y}: x = r is the radius")
            }
            Self::OnAxis => write!(
                f,
                "`{name}` lies on the axis of revolution, where u_x is zero and areas are: nothing acts on it and nothing moves it"
            ),
            Self::RadialForce => write!(
                f,
                "contact \"{name}\": a force presses the obstacle along x = r; rigid bodies of revolution move along the axis alone"
            ),
        }
    }
}

impl From<RevolutionError> for ErrorKind {
    fn from(error: RevolutionError) -> Self {
        Self::Revolution(error)
    }
}
