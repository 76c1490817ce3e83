//! Fields of quantities, and their values from the solution at a point.

use crate::case::Units;
use faying::linalg::Vector;
use faying::physics::{principal, von_mises};
use faying::problem::PointState;

/// A field on the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FieldName {
    /// The unknown: a component of the displacement, or the scalar of Poisson's equation (`None`).
    U(Option<usize>),
    /// Length of the displacement.
    Norm,
    /// Radial (0) or tangential (1) component of the displacement about a centre.
    PolarU(usize),
    /// Component of k grad u (Poisson).
    Flux(usize),
    /// Component (i, j) of the stress (elasticity).
    Stress(usize, usize),
    /// Component of the stress about a centre: radial 0, tangential 1.
    PolarStress(usize, usize),
    /// Component (i, j) of the strain (elasticity).
    Strain(usize, usize),
    /// Component of the strain about a centre: radial 0, tangential 1.
    PolarStrain(usize, usize),
    /// A principal stress, the largest first.
    Principal(usize),
    /// The equivalent stress of von Mises (elasticity).
    VonMises,
}

impl FieldName {
    /// Whether the field has directions about a centre.
    pub fn is_polar(self) -> bool {
        matches!(self, Self::PolarU(_) | Self::PolarStress(..) | Self::PolarStrain(..))
    }

    /// Its unit: that of a length for displacements, of a force per area for stresses; empty where `units` have no name for it.
    pub fn unit(self, units: &Units) -> String {
        match self {
            Self::U(Some(_)) | Self::Norm | Self::PolarU(_) => units.length.clone(),
            Self::Stress(..) | Self::PolarStress(..) | Self::Principal(_) | Self::VonMises => units.stress(),
            Self::U(None) | Self::Flux(_) | Self::Strain(..) | Self::PolarStrain(..) => String::new(),
        }
    }

    /// Whether it takes derivatives of the unknown.
    pub fn is_derived(self) -> bool {
        !matches!(self, Self::U(_) | Self::Norm | Self::PolarU(_))
    }
}

/// A field, with the centre of its directions if it has one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldAbout<const N: usize> {
    /// The field.
    pub name: FieldName,
    /// The centre; in space the axis through it is that of z.
    pub about: Vector<N>,
}

impl<const N: usize> FieldAbout<N> {
    /// Its value from the solution at a point; at the centre of its directions it has none.
    pub fn value(&self, p: &PointState<N>) -> f64 {
        match self.name {
            FieldName::U(c) => p.u[c.unwrap_or(0)],
            FieldName::Norm => p.u.iter().map(|u| u * u).sum::<f64>().sqrt(),
            FieldName::Flux(c) => p.stress[c],
            FieldName::Stress(i, j) => p.stress[voigt(i, j)],
            FieldName::Strain(i, j) => p.strain[voigt(i, j)],
            FieldName::Principal(k) => principal(&p.stress)[k],
            FieldName::VonMises => von_mises(&p.stress),
            FieldName::PolarU(a) => {
                let e = self.direction(p, a);
                e[0] * p.u[0] + e[1] * p.u[1]
            }
            FieldName::PolarStress(a, b) => self.transformed(p, &p.stress, [a, b]),
            FieldName::PolarStrain(a, b) => self.transformed(p, &p.strain, [a, b]),
        }
    }

    /// The radial (0) or tangential (1) unit vector in the plane of x and y.
    fn direction(&self, p: &PointState<N>, which: usize) -> [f64; 2] {
        let (x, y) = (p.x[0] - self.about[0], p.x[1] - self.about[1]);
        let r = x.hypot(y);
        if which == 0 { [x / r, y / r] } else { [-y / r, x / r] }
    }

    /// e_a . tensor e_b.
    fn transformed(&self, p: &PointState<N>, tensor: &[f64; 6], [a, b]: [usize; 2]) -> f64 {
        let [a, b] = [a, b].map(|which| self.direction(p, which));
        let [xx, yy, _, xy, ..] = *tensor;
        a[0] * (xx * b[0] + xy * b[1]) + a[1] * (xy * b[0] + yy * b[1])
    }
}

/// Index of a component among xx yy zz xy yz xz.
fn voigt(i: usize, j: usize) -> usize {
    match (i.min(j), i.max(j)) {
        (a, b) if a == b => a,
        (0, 1) => 3,
        (1, 2) => 4,
        _ => 5,
    }
}
