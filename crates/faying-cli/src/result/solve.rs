//! The linear algebra of a run, and the size of its system.

use faying::problem::Forecast;
use serde::Serialize;

/// Numbers of unknowns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Unknowns {
    /// Coefficients of all bodies, prescribed ones included.
    pub primal: usize,
    /// Rows of all tied interfaces and contacts.
    pub multipliers: usize,
}

/// The active set iteration.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ActiveSetSummary {
    /// Linear systems solved.
    pub iterations: usize,
    /// Active rows in each of them.
    pub history: Vec<usize>,
    /// Number of active rows, or groups of rows, in each set that the rows alone decided before, without the unknowns.
    pub sets: Vec<usize>,
    /// Rows that violate the contact conditions after each of them.
    pub wrong: Vec<usize>,
    /// Sign cases after each of them, all contacts together: rows lambda <0, =0, >0; columns gap =0, >0, <0.
    pub sign_cases: Vec<[usize; 9]>,
    /// States that were visited twice.
    pub cycles: usize,
    /// The iteration whose state the numbers and the files show, from 1: the last one where it settled, else the one that violates
    /// the contact conditions least; 0 where no system was solved.
    pub best: usize,
    /// Events beside regular steps: cycles, steps that were not taken in full.
    pub notes: Vec<String>,
    /// Multiplier updates of the surrounding augmented Lagrangian iteration, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub updates: Option<usize>,
}

/// The linear algebra of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SolveReport {
    /// Reason why the iteration ended: converged, cycling, iterations, rigid motion left, infeasible load, stopped, singular, not-finite.
    pub reason: String,
    /// Solution method: "saddle-point, direct".
    pub linear: String,
    /// Relative residual of the true system.
    pub residual: f64,
    /// Condition number of the scaled system to a factor of a few: bound on the growth of relative errors of the load; `None` if no
    /// factorisation provides it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub condition: Option<f64>,
    /// Iterations of the linear algebra, summed over the active set; 0 for factorisations alone.
    pub iterations: usize,
    /// Number of factorisations of whole systems.
    pub factors: usize,
    /// The active set iteration, where there is contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub active_set: Option<ActiveSetSummary>,
}

/// Predicted size of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Prediction {
    /// Entries of the stiffness.
    pub entries: u64,
    /// Entries of its factor, within a factor of about 1.5.
    pub factor: u64,
    /// Peak memory in bytes.
    pub memory: u64,
}

impl From<Forecast> for Prediction {
    fn from(forecast: Forecast) -> Self {
        Self { entries: forecast.entries, factor: forecast.factor, memory: forecast.memory }
    }
}
