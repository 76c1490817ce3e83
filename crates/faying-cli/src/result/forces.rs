//! Forces and their moments.

use serde::Serialize;

/// A moment about the origin: one number in the plane, three in space.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Moment {
    /// About z [force length].
    Plane(f64),
    /// About x, y, z [force length].
    Space(Vec<f64>),
}

impl Default for Moment {
    fn default() -> Self {
        Self::Plane(0.0)
    }
}

/// Sum of all forces and moments on the model, zero in equilibrium.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Balance {
    /// Loads + reactions + forces of obstacles \[force\].
    pub force: Vec<f64>,
    /// Their moment about the origin [force length]; elasticity only. Zero as far as the functions of a body have its rotations: those of
    /// Lagrange cells on an exact curved map do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moment: Option<Moment>,
}

/// Resultant of a load, by the rules of integration of the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LoadReport {
    /// The force; of a flux or a source its sum alone \[force\].
    pub force: Vec<f64>,
    /// Its moment about the origin [force length]; elasticity only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moment: Option<Moment>,
}
